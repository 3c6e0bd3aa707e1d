"""From the messages of a session to its timeline."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from woz_tui.analysis.acts import ACTION_ENDS
from woz_tui.analysis.known import Known, Stretch, worded
from woz_tui.analysis.series import LONGEST
from woz_tui.analysis.timeline import LANES, Curve, Instant, Interval, Lane, Timeline
from woz_tui.core import messages as m
from woz_tui.experiment.verbs import PERFORMERS

#: Sensors whose values are drawn, if samples are read.
CURVES = ("distance", "loudness")
#: Places a curve may have; beyond, two become one.
PLACES = 2048
#: The step with which a curve begins, in microseconds.
_STEP = 50_000
#: How a command that belongs to no action can end, as an action's outcome.
_COMMAND_ENDS: dict[type[m.Message], str] = {
    m.Done: "done",
    m.Failed: "failed",
    m.TimedOut: "failed",
    m.Refused: "refused",
    m.Stopped: "stopped",
    m.Superseded: "stopped",
}
#: Name of the lane of commands that belong to no action: a sentence typed on the spot.
DIRECT = "(direct)"
#: Facts of one action, and characters of one.
_FACTS, _WORDS = 12, 200
#: A lane: its sort, its name.
_Key = tuple[str, str]


@dataclass(slots=True)
class _Open:
    lane: _Key
    interval: Interval


class Drawing:
    """Takes messages in the order of the log, samples too if curves are wanted."""

    def __init__(self) -> None:
        self._t = 0
        self._intervals: dict[_Key, list[Interval]] = {}
        self._instants: dict[_Key, list[Instant]] = {}
        self._open: dict[tuple[str, str], _Open] = {}
        self._panels: list[str] = []
        self._speech: dict[tuple[str, int], int] = {}
        self._curves: dict[str, _Thinned] = {}
        #: First command of a run -> the run.
        self._first: dict[str, str] = {}
        self._settings: Known[None] = Known(None, lambda each: bool(each.differs))
        self._handlers: dict[type[Any], Callable[..., None]] = {
            m.SessionPlan: self._plan,
            m.ActionRequested: self._requested,
            m.Command: self._command,
            m.Dispatched: self._dispatched,
            **dict.fromkeys(ACTION_ENDS, self._ended),
            **dict.fromkeys(_COMMAND_ENDS, self._command_ended),
            m.EngagementChanged: self._engagement,
            m.SpeechEnded: self._speech_ended,
            m.SpeechText: self._speech_text,
            m.TrialStarted: self._trial,
            m.TrialEnded: self._trial_ended,
            m.BreakStarted: self._break,
            m.BreakEnded: self._break_ended,
            m.StopPressed: self._stop,
            m.StopReleased: self._released,
            m.DriverLost: self._lost,
            m.DriverFaulted: self._lost,
            m.DriverConnected: self._found,
            m.SettingsShown: self._told_settings,
            m.Marker: self._marker,
            m.Note: self._note,
            m.Mistake: self._mistake,
            m.QuestionnaireStarted: self._asked,
            m.ConsoleLost: self._console_lost,
            m.Reading: self._reading,
        }

    def take(self, message: m.AnyMessage) -> None:
        """The next message."""
        if self._t < message.t < LONGEST:
            self._t = message.t
        handle = self._handlers.get(type(message))
        if handle is not None:
            handle(message)

    def timeline(self) -> Timeline:
        """All lanes; what has no end lasts to the log's last moment."""
        for each in list(self._open):
            self._close(each, cut=True)
        self._settings.finish(self._t)
        if self._settings.over:
            lane = self._intervals.setdefault(("setting", "settings differ"), [])
            lane += map(_differing, self._settings.over)
        keys = {**dict.fromkeys(self._intervals), **dict.fromkeys(self._instants)}
        order = {title: place for place, title in enumerate(self._panels)}
        keys_in_order = sorted(
            keys, key=lambda key: (LANES.index(key[0]), order.get(key[1], len(order)))
        )
        return Timeline(
            duration_us=self._t,
            lanes=tuple(self._lane(key) for key in keys_in_order),
            curves=tuple(each.curve(sensor) for sensor, each in sorted(self._curves.items())),
        )

    def _lane(self, key: _Key) -> Lane:
        intervals = sorted(self._intervals.get(key, ()), key=lambda each: (each.begin, each.end))
        instants = sorted(self._instants.get(key, ()), key=lambda each: each.t)
        return Lane(key[1], key[0], tuple(intervals), tuple(instants))

    # -- lasting ------------------------------------------------------------------------------

    def _begin(self, key: tuple[str, str], lane: _Key, interval: Interval) -> None:
        self._close(key, cut=True)
        self._open[key] = _Open(lane, interval)

    def _close(self, key: tuple[str, str], *, cut: bool = False, **changes: str) -> None:
        found = self._open.pop(key, None)
        if found is not None:
            kept = {name: value for name, value in changes.items() if value}
            ended = replace(found.interval, end=self._t, cut=cut, **kept)  # type: ignore[arg-type]
            self._intervals.setdefault(found.lane, []).append(ended)

    def _interval(self, label: str, sort: str, **more: Any) -> Interval:
        return Interval(begin=self._t, end=self._t, label=label, sort=sort, **more)

    def _plan(self, message: m.SessionPlan) -> None:
        self._panels = self._panels or [panel.title for panel in message.panels]

    def _requested(self, message: m.ActionRequested) -> None:
        panel = message.panel or f"({message.source})"
        interval = self._interval(
            message.action, "action", source=message.source, run=message.run, outcome="open"
        )
        self._begin(("run", message.run), ("panel", panel), interval)

    def _ended(self, message: m.ActionEnd) -> None:
        self._close(("run", message.run), outcome=ACTION_ENDS[type(message)], detail=message.reason)

    def _command(self, message: m.Command) -> None:
        """What it does becomes a fact of its action; without an action it has a bar of its own."""
        if message.passing or message.driver in PERFORMERS:
            return
        if not message.run:
            self._direct(message)
            return
        found = self._open.get(("run", message.run)) if message.run else None
        if found is None:
            return
        if len(found.interval.facts) < _FACTS:
            fact = (message.verb, told(message.args))
            found.interval = replace(found.interval, facts=(*found.interval.facts, fact))
            self._first.setdefault(message.command, message.run)

    def _direct(self, message: m.Command) -> None:
        fact = (message.verb, told(message.args))
        interval = self._interval(
            message.verb, "action", source=message.source, outcome="open", facts=(fact,)
        )
        self._begin(("command", message.command), ("panel", DIRECT), interval)

    def _command_ended(self, message: m.End) -> None:
        self._close(
            ("command", message.command),
            outcome=_COMMAND_ENDS[type(message)],
            detail=message.reason,
        )

    def _dispatched(self, message: m.Dispatched) -> None:
        run = self._first.pop(message.command, "")
        found = self._open.get(("run", run) if run else ("command", message.command))
        if found is not None and all(name != "latency" for name, _ in found.interval.facts):
            fact = ("latency", f"{message.latency_us / 1000:.1f} ms")
            found.interval = replace(found.interval, facts=(*found.interval.facts, fact))

    def _engagement(self, message: m.EngagementChanged) -> None:
        key, lane = ("engagement", ""), ("engagement", "engagement")
        if key not in self._open and lane not in self._intervals:
            self._open[key] = _Open(lane, Interval(0, 0, message.was, "state"))
        self._close(key)
        self._begin(key, lane, self._interval(message.now, "state", detail=message.why))

    def _trial(self, message: m.TrialStarted) -> None:
        detail = message.condition
        interval = self._interval(f"trial {message.trial}", "trial", detail=detail)
        self._begin(("trial", ""), ("trial", "trials"), interval)

    def _trial_ended(self, message: m.TrialEnded) -> None:
        self._close(("trial", ""), outcome=message.outcome)

    def _break(self, message: m.BreakStarted) -> None:
        interval = self._interval("break", "break", detail=message.text)
        self._begin(("break", ""), ("trial", "trials"), interval)

    def _break_ended(self, message: m.BreakEnded) -> None:
        self._close(("break", ""))

    def _stop(self, message: m.StopPressed) -> None:
        if ("stop", "") not in self._open:
            interval = self._interval("stop", "stop", source=message.source, detail=message.scope)
            self._begin(("stop", ""), ("stop", "stop"), interval)

    def _released(self, message: m.StopReleased) -> None:
        self._close(("stop", ""))

    def _told_settings(
        self, message: m.SettingsShown | m.DriverLost | m.DriverFaulted | m.DriverConnected
    ) -> None:
        self._settings.take(message, self._t, message.seq)

    def _lost(self, message: m.DriverLost | m.DriverFaulted) -> None:
        self._told_settings(message)
        if ("driver", message.driver) not in self._open:
            interval = self._interval(message.driver, "lost", detail=message.detail)
            self._begin(("driver", message.driver), ("driver", "drivers lost"), interval)

    def _found(self, message: m.DriverConnected) -> None:
        self._told_settings(message)
        self._close(("driver", message.driver))

    def _speech_ended(self, message: m.SpeechEnded) -> None:
        end = min(max(0, message.ended), self._t)
        begin = min(max(0, message.began), end)
        lane = self._intervals.setdefault(("speech", "visitor speaks"), [])
        self._speech[message.driver, message.segment] = len(lane)
        lane.append(Interval(begin, end, f"utterance {message.segment}", "speech"))

    def _speech_text(self, message: m.SpeechText) -> None:
        place = self._speech.get((message.driver, message.segment))
        if place is not None:
            lane = self._intervals["speech", "visitor speaks"]
            lane[place] = replace(lane[place], detail=message.text or message.detail)

    # -- at once ------------------------------------------------------------------------------

    def _instant(self, label: str, sort: str, detail: str = "") -> None:
        self._instants.setdefault(("mark", "marks"), []).append(
            Instant(self._t, label, sort, detail)
        )

    def _marker(self, message: m.Marker) -> None:
        if message.source != "preflight":
            self._instant(message.text, "marker", message.source)

    def _note(self, message: m.Note) -> None:
        self._instant(message.text, "note")

    def _mistake(self, message: m.Mistake) -> None:
        self._instant(message.action, "mistake", message.text)

    def _asked(self, message: m.QuestionnaireStarted) -> None:
        self._instant(message.title or message.questionnaire, "questionnaire")

    def _console_lost(self, message: m.ConsoleLost) -> None:
        self._instant(message.console, "console lost", message.why)

    def _reading(self, message: m.Reading) -> None:
        if message.sensor not in CURVES:
            return
        found = self._curves.get(message.sensor)
        if found is None:
            found = self._curves[message.sensor] = _Thinned(message.unit)
        if message.value is not None:
            found.add(self._t, message.value)


def _differing(each: Stretch[None]) -> Interval:
    assert each.state is not None
    facts = (("had", worded(each.state.value)), ("wanted", worded(each.state.wanted)))
    return Interval(
        each.begin,
        each.end,
        each.name,
        "differing",
        cut=each.cut,
        facts=(("driver", each.driver), *facts),
    )


def told(args: Mapping[str, m.Json]) -> str:
    """Arguments in a few words: a lone one as it is, more of them with their names."""
    if len(args) == 1:
        [value] = args.values()
        words = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    else:
        words = ", ".join(
            f"{name} {value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)}"
            for name, value in args.items()
        )
    return words if len(words) <= _WORDS else words[: _WORDS - 1] + "…"


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

    def curve(self, sensor: str) -> Curve:
        last = max(self._sums, default=-1)
        values = tuple(
            self._sums[place][0] / self._sums[place][1] if place in self._sums else None
            for place in range(last + 1)
        )
        return Curve(sensor, self._unit, self._step, values)
