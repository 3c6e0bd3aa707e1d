"""A session as lanes of intervals and instants: what is drawn of it, on a terminal or a page.

Times are microseconds on the axis of `t`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any

from woz_tui.analysis.event_rows import PREFLIGHT, is_direct, moments, of_robot, value_text
from woz_tui.analysis.feature_figures import FeatureFigures, Instant
from woz_tui.analysis.feature_report import CommandPicture, reports
from woz_tui.config.performers import composers
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol import messages as m
from woz_tui.timeline import episodes as e
from woz_tui.timeline.session_state import LATEST_TIME
from woz_tui.timeline.timeline import Timeline

#: Sorts of lanes, in the order in which they are drawn.
LANES = ("trial", "phase", "engagement", "speech", "panel", "stop", "driver", "setting", "mark")


@dataclass(frozen=True, slots=True)
class Interval:
    """Something that lasted.

    Attributes:
        begin: When it began.
        end: When it ended; the log's last moment if its end is not in the log (`cut`).
        label: Action, state, trial, driver.
        sort: action, state, trial, phase, break, speech, stop, lost or differing (a robot's
            setting).
        outcome: Of actions and commands as of their episodes; of trials as in the log, or why
            they are left out; else empty.
        source: Of actions: key, script ...; of stops where they came from.
        detail: What else there is to say: a reason, a sentence that was understood.
        run: Of actions: their id.
        cut: Its end is not in the log.
        facts: Names and values of what else a picture can tell, of actions what was said, the
            arguments, and how long the driver took to start: `(("say", "Hello"), ("latency",
            "12 ms"))`.
    """

    begin: int
    end: int
    label: str
    sort: str
    outcome: str = ""
    source: str = ""
    detail: str = ""
    run: str = ""
    cut: bool = False
    facts: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class TimelineLane:
    """One row of the picture. `name` is the panel's title, or what the lane is about."""

    name: str
    sort: str
    intervals: tuple[Interval, ...] = ()
    instants: tuple[Instant, ...] = ()


@dataclass(frozen=True, slots=True)
class SensorCurve:
    """A sensor's values, thinned to means over equal steps of time; None where nothing was read."""

    sensor: str
    unit: str
    step_us: int
    values: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class TimelineDrawing:
    """All lanes of a session; a lane without anything in it is left out."""

    duration_us: int
    lanes: tuple[TimelineLane, ...] = ()
    curves: tuple[SensorCurve, ...] = field(default=())


#: Sensors whose values are drawn, if samples are read.
CURVES = ("distance", "loudness")
#: Places a curve may have; beyond, two become one.
PLACES = 2048
#: The step with which a curve begins, in microseconds.
_STEP = 50_000
#: Name of the lane of commands that belong to no action: a sentence typed on the spot.
DIRECT = "(improvised)"
#: Name of the lane of what planners play.
PLANNER = "(planner)"
#: Facts of one action, and characters of one.
_FACTS, _WORDS = 12, 200
#: A lane: its sort, its name.
_Key = tuple[str, str]


def drawing_of(timeline: Timeline, curves: SensorCurves | None = None) -> TimelineDrawing:
    """All lanes of a timeline that is finished; what has no end lasts to its last moment."""
    intervals: dict[_Key, list[Interval]] = {}
    instants: dict[_Key, list[Instant]] = {}
    of_runs = _commands(timeline)
    for each in timeline.episodes:
        lane, make = _DRAWN.get(type(each), (_MARKS, None))
        interval = make(each) if make is not None else None
        if isinstance(each, e.ActionEpisode):
            lane = ("panel", each.request.panel or f"({each.source})")
            interval = _action(each, of_runs.get(each.request.run, ()))
        if isinstance(each, e.TrialEpisode):
            lane, interval = ("trial", "trials"), _trial(each, timeline.left_out(each))
        if isinstance(each, e.CommandEpisode) and each.request.driver in composers():
            lane, interval = ("panel", PLANNER), _composed(each)
        if interval is not None:
            intervals.setdefault(lane, []).append(interval)
        if (instant := _instant(each)) is not None:
            instants.setdefault(_MARKS, []).append(instant)
    panels = _panels(timeline)
    keys = sorted(
        dict.fromkeys((*intervals, *instants)),
        key=lambda key: (LANES.index(key[0]), panels.get(key[1], len(panels))),
    )
    lanes = (
        TimelineLane(
            *(key[1], key[0]),
            tuple(sorted(intervals.get(key, ()), key=attrgetter("begin", "end"))),
            tuple(instants.get(key, ())),
        )
        for key in keys
    )
    end = timeline.end if curves is None else max(timeline.end, curves.t)
    return TimelineDrawing(end, tuple(lanes), tuple(curves or ()))


def _panels(timeline: Timeline) -> dict[str, int]:
    """Panels, and at which place consoles showed each at first."""
    plans = (plan.panels for _, plan in moments(timeline, m.SessionPlan) if plan.panels)
    return {panel.title: at for at, panel in enumerate(next(plans, ()))}


def _interval(each: e.Episode, label: str, sort: str, **more: Any) -> Interval:
    end = each.begin + each.duration
    return Interval(each.begin, end, label, sort, cut=each.cut, **more)


# -- panels ---------------------------------------------------------------------------------------


def _commands(timeline: Timeline) -> dict[str, list[e.CommandEpisode]]:
    """The commands to robots of each run."""
    found: dict[str, list[e.CommandEpisode]] = {}
    for each in timeline.of(e.CommandEpisode):
        if each.request.run and of_robot(each):
            found.setdefault(each.request.run, []).append(each)
    return found


def _action(action: e.ActionEpisode, commands: Iterable[e.CommandEpisode]) -> Interval:
    own = [each for each in commands if each.request.command in action.commands][:_FACTS]
    facts = [(each.seq, _fact(each)) for each in own]
    return _act(action, facts, run=action.request.run)


def _direct(command: e.CommandEpisode) -> Interval | None:
    """One without an action has a bar of its own."""
    return _act(command, [(command.seq, _fact(command))]) if is_direct(command) else None


def _composed(command: e.CommandEpisode) -> Interval | None:
    """A planner's; one on a key is what its action does."""
    if command.request.run:
        return None
    drawn = (each.picture(command) for each in reports())
    picture = next(filter(None, drawn), CommandPicture(command.label))
    facts = [(command.seq, fact) for fact in picture.facts[:_FACTS]]
    return replace(_act(command, facts), label=picture.label)


def _act(
    act: e.ActionEpisode | e.CommandEpisode, facts: list[tuple[int, tuple[str, str]]], run: str = ""
) -> Interval:
    """What its commands were is told in the order of the lines, as is when the first began."""
    if act.dispatched is not None and act.latency_us is not None:
        latency = f"{act.latency_us / 1000:.1f} ms"
        facts = sorted([*facts, (act.dispatched.seq, ("latency", latency))])
    return _interval(
        act,
        act.label,
        "action",
        source=act.source,
        run=run,
        outcome=act.outcome,
        detail=act.reason,
        facts=tuple(fact for _, fact in facts),
    )


def _fact(command: e.CommandEpisode) -> tuple[str, str]:
    return command.label, in_words(command.request.args)


def in_words(args: Mapping[str, m.Json]) -> str:
    """Arguments in a few words: a lone one as it is, more of them with their names."""
    if len(args) == 1:
        words = value_text(*args.values())
    else:
        words = ", ".join(f"{name} {value_text(value)}" for name, value in args.items())
    return words if len(words) <= _WORDS else words[: _WORDS - 1] + "…"


# -- other lanes ----------------------------------------------------------------------------------


def _trial(trial: e.TrialEpisode, left_out: str) -> Interval:
    outcome = left_out or (trial.ended.outcome if trial.ended is not None else "")
    label, detail = f"trial {trial.label}", trial.context.condition
    return _interval(trial, label, "trial", outcome=outcome, detail=detail)


def _phase(phase: e.StageEpisode) -> Interval:
    return _interval(phase, phase.label, "phase", source=phase.source)


def _break(pause: e.BreakEpisode) -> Interval:
    return _interval(pause, "break", "break", detail=pause.started.text)


def _state(state: e.ModelStateEpisode) -> Interval:
    why = state.entered.why if state.entered is not None else ""
    return _interval(state, state.label, "state", detail=why)


def _speech(spoken: e.UtteranceEpisode) -> Interval | None:
    """Without its beginning and its end nobody knows how long it was; the robot's own voice has its
    place among the actions.
    """
    if spoken.own or (spoken.started is None and spoken.ended is None):
        return None
    text = (spoken.text.text or spoken.text.detail) if spoken.text is not None else ""
    return _interval(spoken, f"utterance {spoken.label}", "speech", detail=text)


def _stop(stop: e.StopEpisode) -> Interval:
    return _interval(stop, "stop", "stop", source=stop.source, detail=stop.label)


def _lost(lost: e.LostDriverEpisode) -> Interval:
    return _interval(lost, lost.label, "lost", detail=lost.reason)


def _differing(setting: e.SettingEpisode) -> Interval | None:
    if not setting.differs:
        return None
    facts = (("had", value_text(setting.value)), ("wanted", value_text(setting.wanted)))
    return _interval(
        setting, setting.label, "differing", facts=(("driver", setting.driver), *facts)
    )


_MARKS: _Key = ("mark", "marks")
#: What is drawn as an interval, on which lane, and how; actions have a lane for each panel.
_DRAWN: Mapping[type[e.Episode], tuple[_Key, Callable[[Any], Interval | None]]] = {
    e.CommandEpisode: (("panel", DIRECT), _direct),
    e.StageEpisode: (("phase", "phases"), _phase),
    e.BreakEpisode: (("trial", "trials"), _break),
    e.ModelStateEpisode: (("engagement", "engagement"), _state),
    e.UtteranceEpisode: (("speech", "visitor speaks"), _speech),
    e.StopEpisode: (("stop", "stop"), _stop),
    e.LostDriverEpisode: (("driver", "drivers lost"), _lost),
    e.SettingEpisode: (("setting", "settings differ"), _differing),
}


def _instant(each: e.Episode) -> Instant | None:
    """What it is on the lane of marks; None: nothing."""
    if not isinstance(each, e.MomentEpisode):
        found: Instant | None = None
        for name, figures in pieces("figures", FeatureFigures).items():
            found = found or answer_of(name, None, figures.instant, each)
        return found
    match each.message:
        case m.Marker(text=text, source=source) as marker if source != PREFLIGHT:
            return Instant(marker.moment, text, "marker", source)
        case m.Note(text=text):
            return Instant(each.begin, text, "note")
        case m.Mistake(action=action, text=text):
            return Instant(each.begin, action, "mistake", text)
        case m.ConsoleLost(console=console, why=why):
            return Instant(each.begin, console, "console lost", why)
    return None


# -- curves ---------------------------------------------------------------------------------------


class SensorCurves:
    """Takes the values of sensors that are drawn."""

    def __init__(self) -> None:
        #: When the last value came, or the one that came latest.
        self.t = 0
        self._sensors: dict[str, _Thinned] = {}

    def takes(self, sensor: str) -> Callable[[m.Reading], None] | None:
        """What takes the readings of a sensor; None: it is not drawn."""
        return self.add if sensor.rpartition(".")[2] in CURVES else None

    def add(self, sample: m.Reading) -> None:
        """The next reading of a sensor that is drawn."""
        if self.t < sample.t < LATEST_TIME:
            self.t = sample.t
        found = self._sensors.get(sample.sensor)
        if found is None:
            found = self._sensors[sample.sensor] = _Thinned(sample.unit)
        if sample.value is not None:
            found.add(self.t, sample.value)

    def __iter__(self) -> Iterator[SensorCurve]:
        for sensor, each in sorted(self._sensors.items()):
            yield each.curve(sensor)


class _Thinned:
    """Means over steps that double whenever there would be too many of them."""

    def __init__(self, unit: str) -> None:
        self._unit = unit
        self._step = _STEP
        self._sums: dict[int, tuple[float, int]] = {}

    def add(self, t: int, value: float) -> None:
        while t // self._step >= PLACES:
            self._halve()
        total, count = self._sums.get(t // self._step, (0.0, 0))
        self._sums[t // self._step] = (total + value, count + 1)

    def _halve(self) -> None:
        halved: dict[int, tuple[float, int]] = {}
        for place, (total, count) in self._sums.items():
            before = halved.get(place // 2, (0.0, 0))
            halved[place // 2] = (before[0] + total, before[1] + count)
        self._sums, self._step = halved, self._step * 2

    def curve(self, sensor: str) -> SensorCurve:
        last = max(self._sums, default=-1)
        values = tuple(
            self._sums[place][0] / self._sums[place][1] if place in self._sums else None
            for place in range(last + 1)
        )
        return SensorCurve(sensor, self._unit, self._step, values)
