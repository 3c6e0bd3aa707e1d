"""One pass over the messages of a session, from which all of its figures come."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from woz_tui.analysis.acts import Acts
from woz_tui.analysis.around import Hardware, Marks, Setting, Stops
from woz_tui.analysis.asked import Asked
from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.cues import WAITING, WINDOW_US, Cues
from woz_tui.analysis.differences import Differences
from woz_tui.analysis.engaged import Engaged
from woz_tui.analysis.figures import Cue, Part, SessionFigures, Trial, Wholeness
from woz_tui.analysis.people import taking_part
from woz_tui.analysis.tally import Tally, part
from woz_tui.core import messages as m


@dataclass(frozen=True, slots=True)
class Options:
    """How figures are computed.

    Attributes:
        window_us: Time after a cue in which an answer counts as one, in microseconds.
        waiting: States of the engagement model that are cues.
        all_trials: Also what happened in trials that were aborted or excluded.
    """

    window_us: int = WINDOW_US
    waiting: Collection[str] = WAITING
    all_trials: bool = False


DEFAULTS = Options()


class Gatherer:
    """Takes messages in the order of the log; `figures` tells what they amount to.

    Memory does not grow with the length of a session except by some 20 bytes for each act, and by a
    row for each cue, state, trial and mark.
    """

    def __init__(self, options: Options = DEFAULTS) -> None:
        self._options = options
        self._course = Course()
        self._cues = Cues(self._course, options.window_us, options.waiting)
        self._acts = Acts(self._course, self._cues.act)
        self._engaged = Engaged(self._course)
        self._asked = Asked(self._course)
        self._stops = Stops(self._course)
        self._marks = Marks(self._course)
        self._hardware = Hardware(self._course)
        self._differences = Differences(self._course)
        self._setting = Setting(self._course)
        self._handlers = _joined(
            self._course.handlers(),
            self._setting.handlers(),
            self._engaged.handlers(),
            self._acts.handlers(),
            self._cues.handlers(),
            self._asked.handlers(),
            self._stops.handlers(),
            self._marks.handlers(),
            self._hardware.handlers(),
            self._differences.handlers(),
        )
        self._finished = False

    def take(self, message: m.AnyMessage) -> None:
        """The next message."""
        self._course.at(message.t)
        for handle in self._handlers.get(type(message), ()):
            handle(message)

    def figures(
        self, path: str = "", stem: str = "", wholeness: Wholeness | None = None
    ) -> SessionFigures:
        """All figures; nothing may be taken any more."""
        self._finish()
        course, setting = self._course, self._setting
        start = setting.start
        trials = course.trials()
        tallies = course.tallies
        counted = [tally for tally in tallies if self._options.all_trials or course.counts(tally)]
        people = taking_part(tallies, trials, self._asked.answers)
        return SessionFigures(
            path=path,
            stem=stem,
            session=start.session if start else "",
            participant=_named(tallies, people),
            participants=tuple(_each(_of(tallies, people))),
            condition=", ".join(_each(tally.condition for tally in tallies)),
            wizard=start.wizard if start else "",
            software=" ".join(filter(None, map(start.software.get, ("name", "version"))))
            if start
            else "",
            schema=start.schema if start else 0,
            experiment=start.experiment if start else "",
            experiment_sha256=start.experiment_sha256 if start else "",
            title=setting.title,
            started=_began(start),
            duration_us=course.t - course.begin,
            ended=setting.ended,
            window_us=self._options.window_us,
            all_trials=self._options.all_trials,
            whole=self._part(counted, trials, people),
            parts=tuple(self._parts(counted, trials, people)),
            cues=tuple(self._told_cues(tallies, people)),
            visits=tuple(self._engaged.visits),
            trials=tuple(trials),
            breaks=tuple(course.breaks),
            stops=tuple(self._stops.stops),
            marks=tuple(self._marks.marks),
            answers=self._asked.answers,
            rounds=self._asked.rounds,
            training=self._cues.training,
            panels=setting.panels,
            profiles=tuple(setting.profiles),
            consoles=tuple(self._hardware.consoles),
            lost_drivers=tuple(self._hardware.lost),
            differences=self._differences.rows(course.counts, people),
            drivers=tuple(self._hardware.drivers),
            restrictions=tuple(setting.restrictions),
            shaping=tuple(setting.shaping),
            reloads=setting.reloads,
            rerun_of=setting.rerun_of,
            order=setting.order,
            order_method=setting.order_method,
            wholeness=wholeness or Wholeness(ended=bool(setting.ended)),
        )

    def _finish(self) -> None:
        if self._finished:
            return
        self._finished = True
        self._course.finish()
        self._acts.finish()
        self._cues.finish()
        self._engaged.finish()
        self._hardware.finish()
        self._differences.finish()

    def _part(self, tallies: list[Tally], trials: list[Trial], people: set[str]) -> Part:
        return part(
            tallies,
            _named(tallies, people),
            ", ".join(_each(tally.condition for tally in tallies)),
            self._trials_of(trials),
        )

    def _parts(self, tallies: list[Tally], trials: list[Trial], people: set[str]) -> Iterable[Part]:
        groups: dict[tuple[str, str], list[Tally]] = {}
        for tally in tallies:
            groups.setdefault((tally.participant, tally.condition), []).append(tally)
        for (participant, condition), found in groups.items():
            of_it = [
                trial
                for trial in trials
                if (trial.participant, trial.condition) == (participant, condition)
            ]
            begun = self._trials_of(of_it)
            yield part(found, participant, condition, begun, counted=participant in people)

    def _trials_of(self, trials: list[Trial]) -> int:
        return sum(self._options.all_trials or trial.counted for trial in trials)

    def _told_cues(self, tallies: list[Tally], people: set[str]) -> list[Cue]:
        cues = [
            cue
            if self._course.counts(tally) and tally.participant in people
            else replace(cue, counted=False)
            for tally in tallies
            for cue in tally.cues
        ]
        return sorted(cues, key=lambda cue: cue.t)


def _joined(*parts: Handlers) -> dict[type[Any], tuple[Callable[..., None], ...]]:
    """All handlers of a kind, in the order given."""
    joined: dict[type[Any], tuple[Callable[..., None], ...]] = {}
    for handlers in parts:
        for kind, handle in handlers.items():
            joined[kind] = (*joined.get(kind, ()), handle)
    return joined


def _each(names: Iterable[str]) -> dict[str, None]:
    """Each name once, in the order of the first time; none that is empty."""
    return dict.fromkeys(name for name in names if name)


def _of(tallies: Iterable[Tally], people: set[str]) -> Iterable[str]:
    return (tally.participant for tally in tallies if tally.participant in people)


def _named(tallies: Sequence[Tally], people: set[str]) -> str:
    """Who took part; all codes that were given if nobody did."""
    found = _each(_of(tallies, people)) or _each(tally.participant for tally in tallies)
    return ", ".join(found)


def _began(start: m.SessionStart | None) -> str:
    if start is None:
        return ""
    return start.clock.get("wall_at_t0", "") or start.ts


def figures_of(messages: Iterable[m.AnyMessage], options: Options = DEFAULTS) -> SessionFigures:
    """The figures of messages that are in memory or come from anywhere."""
    gatherer = Gatherer(options)
    for message in messages:
        gatherer.take(message)
    return gatherer.figures()
