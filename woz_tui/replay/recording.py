"""A log ready to be played: its lines on one time line, and the state at any moment.

The lines of actions are kept in memory, an hour of them is a few megabytes; samples are fetched
when they are due. Every few seconds of log a copy of the `SessionState` is kept, so that any moment
is a few hundred lines from one.
"""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePath
from typing import Any, Protocol

import msgspec

from woz_tui.log.log_reader import LogLine
from woz_tui.protocol import messages as m
from woz_tui.protocol.envelope import Message
from woz_tui.protocol.welcome import PerceptionView, StudySettings, WelcomeSettings
from woz_tui.replay.bookmarks import (
    Bookmark,
    IdleCuts,
    bookmark_of,
    bookmarks_of,
    is_event,
    monotonic,
)
from woz_tui.session.recent_messages import MOST, RecentMessages
from woz_tui.session.redactor import CoderRedactor, PerceptionFilter, Redactor
from woz_tui.session.session_plan import study_snapshot
from woz_tui.timeline.episodes import EngagementEpisode
from woz_tui.timeline.session_state import SessionState

#: A message, or the fields of a line whose kind this version does not know.
RecordedLine = m.Message | dict[str, Any]

#: A copy of the state is kept after so much of the log's time, after so many lines at the latest.
SNAPSHOT_US, SNAPSHOT_LINES = 5_000_000, 500
#: What the engagement model follows from.
_OF_MODEL = m.EngagementAdopted | m.EngagementChanged | m.SessionPlan | m.Done
#: What is shown of a log that has lost its plan, where its experiment is not at hand either.
_NO_PLAN = m.SessionPlan(
    title="",
    panels=[],
    verbs={},
    variables=[],
    conditions=[],
    keyboard="us",
    drivers=[],
    settings=WelcomeSettings(),
)
#: Lines that show nothing by themselves: a step does not stop at them.
_HOUSEKEEPING = frozenset(
    {"clock", "checkpoint", "recorder.state", "experiment.files", "session.plan"}
)


class SampleSource(Protocol):
    """The samples of a log, in order."""

    @property
    def length_us(self) -> int:
        """The last moment of the session as far as is known; 0 if nothing is."""
        ...

    def between(self, after_us: int, until_us: int) -> Iterable[m.Message]:
        """Those taken after `after_us`, up to and with `until_us`. Some may be left out that
        are replaced by a later one of the same stretch.
        """
        ...

    def at(self, t_us: int) -> Iterable[m.Message]:
        """The last one of each sensor, and of whatever else is soon replaced, at `t_us`."""
        ...


@dataclass(frozen=True, slots=True)
class RecordedMoment:
    """What holds at a moment, in the order in which it came about, and the lines before it.

    `study`: `settings["study"]` of a welcome; empty where the log says nothing of one.
    """

    state: list[m.Message]
    recent: list[m.Message]
    study: StudySettings


class Recording:
    """See the module's text.

    Args:
        lines: Of actions, in order: messages, or lines of a kind that is not known.
        samples: Everything else.
        plan: What consoles were shown, for a log that does not say so.
        reveal: Show also what was kept from the wizard: conditions, what restricted perception hid.
        coded: A coder sees it, who is not to know the condition, whatever the wizard knew.
    """

    def __init__(
        self,
        lines: Iterable[m.Message | LogLine],
        samples: SampleSource,
        plan: m.SessionPlan | None = None,
        *,
        reveal: bool = False,
        coded: bool = False,
    ) -> None:
        found = [_read_line(line) for line in lines]
        shown = (line for line, _ in found if isinstance(line, m.SessionPlan))
        first = next(shown, plan)
        kind = CoderRedactor if coded else Redactor
        redactor = kind(first.settings.study if first is not None else None)
        kept: list[tuple[int, PerceptionFilter]] = []
        if reveal:
            found = [(_revealed(line), t) for line, t in found]
        else:
            found = [*_redacted(found, redactor, kept)]
        self.lines: list[RecordedLine] = [line for line, _ in found]
        self.samples = _RedactedSamples(samples, kept)
        known = samples.length_us
        self.times = monotonic([min(t, known) if known else t for _, t in found])
        self.length_us = max(self.times[-1] if self.times else 0, known)
        #: The first moment at which anything is known.
        self.begin_us = self.times[0] if self.times else 0
        self.start = next((line for line in self.lines if isinstance(line, m.SessionStart)), None)
        self._plans = [
            (index, line)
            for index, line in enumerate(self.lines)
            if isinstance(line, m.SessionPlan)
        ]
        self._plan = plan and (_revealed_plan(plan) if reveal else redactor.plan(plan))
        #: What the viewer has set while watching.
        self.codes: list[Bookmark] = []
        recent = RecentMessages()
        self._recent_indexes = [
            index
            for index, line in enumerate(self.lines)
            if isinstance(line, Message) and recent.lists(line)
        ]
        self._snapshots = [(0, SessionState())]
        self._prepared = (0, SessionState())

    @property
    def marks(self) -> list[Bookmark]:
        """Everything to go to, oldest first."""
        return sorted([*self._log_bookmarks, *self.codes], key=lambda mark: mark.t)

    @cached_property
    def _log_bookmarks(self) -> list[Bookmark]:
        state = SessionState()
        found: list[Bookmark | None] = []
        for line, t in zip(self.lines, self.times, strict=True):
            found.append(bookmark_of(line, t))
            if isinstance(line, _OF_MODEL):
                for episode in state.apply(line):
                    if isinstance(episode, EngagementEpisode) and episode.end is None:
                        found.append(Bookmark(t, "engagement", state.model.state))
        return bookmarks_of(found)

    def cuts(self, most_us: int | None) -> IdleCuts:
        """What is left out where nothing happens for longer than `most_us`."""
        deeds = (t for line, t in zip(self.lines, self.times, strict=True) if is_event(line))
        return IdleCuts(deeds, most_us)

    # -- moments -----------------------------------------------------------------------------

    def index(self, t: int) -> int:
        """How many lines lie before or at `t`."""
        return bisect.bisect_right(self.times, t)

    def step(self, index: int) -> int:
        """The next line from `index` on at which a step stops; their number if there is none."""
        for number in range(index, len(self.lines)):
            if kind_of(self.lines[number]) not in _HOUSEKEEPING:
                return number
        return len(self.lines)

    def plan(self, index: int) -> m.SessionPlan:
        """What consoles were shown after `index` lines."""
        place = bisect.bisect_left(self._plans, index, key=lambda entry: entry[0])
        if self._plans:
            return self._plans[max(0, place - 1)][1]
        if self._plan is None:
            name = self.start.experiment if self.start is not None else ""
            self._plan = msgspec.structs.replace(_NO_PLAN, title=PurePath(name).stem)
        return self._plan

    def moment(self, index: int, t: int) -> RecordedMoment:
        """What held after `index` lines, at `t`."""
        state = self.state(index)
        held = [*state.messages(plan=False), *self.samples.at(t)]
        if state.model.removed:
            held = [message for message in held if not isinstance(message, m.EngagementShown)]
        held.sort(key=lambda message: message.seq)
        settings = self.plan(index).settings.study
        state.study.settings = settings  # the plan need not be a line of the log
        study = study_snapshot(settings, state)
        return RecordedMoment(held, self.recent(index), study)

    def recent(self, index: int) -> list[m.Message]:
        """The last of the first `index` lines that a list of events has."""
        end = bisect.bisect_left(self._recent_indexes, index)
        found = [self.lines[place] for place in self._recent_indexes[max(0, end - MOST) : end]]
        return [line for line in found if isinstance(line, Message)]

    def state(self, index: int) -> SessionState:
        """What held after `index` lines, without samples; the caller's own."""
        while self._prepared[0] < index:
            self.prepare(SNAPSHOT_LINES)
        place = bisect.bisect_right(self._snapshots, index, key=lambda entry: entry[0]) - 1
        begin, kept = self._snapshots[place]
        state = kept.copy()
        self._play(state, begin, index)
        return state

    def _play(self, state: SessionState, begin: int, end: int) -> None:
        for line, t in zip(self.lines[begin:end], self.times[begin:end], strict=True):
            if isinstance(line, Message):
                state.apply(line if line.t == t else msgspec.structs.replace(line, t=t))

    def prepare(self, count: int) -> bool:
        """Work `count` lines ahead; whether there are more."""
        begin, state = self._prepared
        end = min(len(self.lines), begin + count)
        for at in range(begin, end):
            before, _ = self._snapshots[-1]
            late = self.times[at] - self.times[before] >= SNAPSHOT_US
            if late or at - before >= SNAPSHOT_LINES:
                self._snapshots.append((at, state.copy()))
            self._play(state, at, at + 1)
        self._prepared = (end, state)
        return end < len(self.lines)

    def wall(self, index: int) -> tuple[int, str]:
        """A moment of the log, and what the clock on the wall said then: of the last line before
        `index` that tells, or of the first one that does; an empty text if none does.
        """
        for at in (*range(min(index, len(self.lines)) - 1, -1, -1), *range(index, len(self.lines))):
            line = self.lines[at]
            if isinstance(line, Message) and line.ts:
                return self.times[at], line.ts
        return 0, ""


class _RedactedSamples:
    """Samples as the wizard saw them: `kept` says from when on (microseconds) what was kept."""

    def __init__(self, samples: SampleSource, kept: Sequence[tuple[int, PerceptionFilter]]) -> None:
        self._samples = samples
        self._kept = kept
        self._redactor = Redactor()
        self.length_us = samples.length_us

    def between(self, after_us: int, until_us: int) -> Iterable[m.Message]:
        return self._redacted(self._samples.between(after_us, until_us))

    def at(self, t_us: int) -> Iterable[m.Message]:
        return self._redacted([*self._samples.at(t_us)], t_us)

    def _redacted(self, samples: Iterable[m.Message], t_us: int = -1) -> Iterator[m.Message]:
        for sample in samples:
            t = max(sample.t, t_us)
            place = bisect.bisect_right(self._kept, t, key=lambda entry: entry[0])
            self._redactor.perception = self._kept[place - 1][1] if place else PerceptionFilter()
            self._redactor.apply(sample)
            seen: Any = self._redactor.message(sample)
            if seen is not None:
                yield seen


def _redacted(
    lines: Iterable[tuple[RecordedLine, int]],
    redactor: Redactor,
    kept: list[tuple[int, PerceptionFilter]],
) -> Iterator[tuple[RecordedLine, int]]:
    """Lines as the wizard saw them, and in `kept` from when on something was kept."""
    kept.append((-1, redactor.perception))
    for line, t in lines:
        if isinstance(line, dict):  # of a newer version: nobody knows what it tells
            if not redactor:
                yield line, t
            continue
        redactor.apply(line)
        if redactor.perception != kept[-1][1]:
            kept.append((t, redactor.perception))
        seen: Any = redactor.message(line)
        if seen is not None:
            yield seen, t


def _read_line(line: m.Message | LogLine) -> tuple[RecordedLine, int]:
    if not isinstance(line, LogLine):
        return line, line.t
    message = line.message
    return (message if message is not None else line.fields), line.t


def _revealed_plan(plan: m.SessionPlan) -> m.SessionPlan:
    """The plan with nothing kept from whoever sees it."""
    study = msgspec.structs.replace(plan.settings.study, blind={}, perception=PerceptionView())
    settings = msgspec.structs.replace(plan.settings, study=study)
    return msgspec.structs.replace(plan, settings=settings)


def _revealed(line: RecordedLine) -> RecordedLine:
    if isinstance(line, m.SessionPlan):
        return _revealed_plan(line)
    if isinstance(line, m.PerceptionChanged):
        return msgspec.structs.replace(line, hidden=[], blurred=[])
    return line


def kind_of(line: RecordedLine) -> str:
    """The kind of a line, also of one that this version does not know."""
    if isinstance(line, Mapping):
        return str(line.get("kind"))
    return str(line.__struct_config__.tag)


def thinned(samples: Iterable[m.Message]) -> list[m.Message]:
    """Of what replaces each other only the last, in order."""
    last: dict[str, m.Message] = {}
    for sample in samples:
        name = sample.sensor if isinstance(sample, m.Reading) else type(sample).__name__
        last.pop(name, None)
        last[name] = sample
    return [*last.values()]
