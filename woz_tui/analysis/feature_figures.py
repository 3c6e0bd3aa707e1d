"""What features count in sessions, and say of it in reports."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CueRow
from woz_tui.analysis.report_table import ReportTable
from woz_tui.timeline.episodes import CommandEpisode
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context


@dataclass(frozen=True, slots=True, kw_only=True)
class TimesMeasure:
    """A main figure out of durations that a feature tells, `times` by name; the rest is as in
    `measures.Measure`. `title`: what people read, where the name would not do.
    """

    name: str
    unit: str
    meaning: str
    short: str
    times: str
    of: Callable[[Durations], float | None]
    title: str = ""


@dataclass(frozen=True, slots=True)
class ApartKind:
    """A kind of session in which nobody takes part.

    `what`: such a session, in a sentence. `key`: what `woz report --json` calls all of them.
    `meaning`: of the column that says of a session that it is one.
    """

    what: str
    key: str
    meaning: str


@dataclass(frozen=True, slots=True)
class ApartSession:
    """A session in which nobody took part; `figures`: what the feature counted in it."""

    wizard: str
    session: str
    started: str
    figures: Any


@dataclass(frozen=True, slots=True)
class CommandPicture:
    """How a command is drawn over time: its label, and names and values of what it consists of."""

    label: str
    facts: Sequence[tuple[str, str]] = ()


class FeatureFigures:
    """A feature's figures of a session. What `count` returns is given to the others.

    Attributes:
        key: What JSON calls them; empty: by the feature's name.
        nothing: What JSON says of a session of which there is nothing to say.
        measures: Main figures, which stand behind all others.
        apart: Given: a session with such figures is one in which nobody takes part.
        cue_types: Types of cues that `cues` finds, and what each is.
    """

    key: ClassVar[str] = ""
    nothing: ClassVar[Any] = ()
    measures: ClassVar[tuple[TimesMeasure, ...]] = ()
    apart: ClassVar[ApartKind | None] = None
    cue_types: ClassVar[Mapping[str, str]] = {}

    def count(self, timeline: Timeline) -> Any:
        """The figures of one session; None: there is nothing to say."""
        return None

    def times(self, timeline: Timeline) -> Iterator[tuple[Context, str, int]]:
        """Durations in microseconds: the context in which each counts, and what it is one of."""
        yield from ()

    def cues(self, timeline: Timeline) -> Iterable[tuple[Context, CueRow]]:
        """Cues that the feature gave, and what became of them, each with its line's context."""
        return ()

    def circumstances(self, figures: Any) -> Iterator[str]:
        """Sentences on the circumstances of a session, for its report."""
        yield from ()

    def methods(self, sessions: Sequence[Any]) -> Iterator[str]:
        """Sentences for the methods section. `sessions`: figures of those that had any."""
        yield from ()

    def methods_of_times(self, times: Mapping[str, Durations]) -> Iterator[str]:
        """Sentences for the same on `times`, added up over all that means include."""
        yield from ()

    def wizards(self, sessions: Sequence[ApartSession], wizards: Sequence[str]) -> Iterator[str]:
        """Sentences for the methods section on the wizards of the sessions with participants, from
        those in which nobody took part.
        """
        yield from ()

    def tables(self, figures: Any) -> Iterator[ReportTable]:
        """Tables for the report of a session."""
        yield from ()

    def picture(self, command: CommandEpisode) -> CommandPicture | None:
        """How a command of the feature's performer is drawn; None: by its verb."""
        return None
