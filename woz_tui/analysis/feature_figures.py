"""What features count in sessions, and say of it in sentences."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CueRow
from woz_tui.analysis.outcomes import Outcome
from woz_tui.analysis.report_table import ReportTable
from woz_tui.timeline.episodes import Episode
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
class Instant:
    """Something that happened: a marker, a note, a mistake, an answer to a questionnaire."""

    t: int
    label: str
    sort: str
    detail: str = ""


class GatheredFigures:
    """What a feature makes of many sessions, one after the other; made without arguments."""

    def add(self, experiment: str, figures: Any) -> None:
        """Add the `figures.SessionFigures` of a session with participants."""

    def tables(self, experiment: str, totals: Any) -> Iterator[ReportTable]:
        """What reports of an experiment show, behind its means by condition (the `totals`,
        `participant_groups.ConditionTotal`).
        """
        yield from ()

    def outcomes(self, experiment: str, first: Mapping[str, str]) -> Iterable[Outcome]:
        """What people said, to be compared between the conditions of an experiment. `first`: the
        condition that each participant had first.
        """
        return ()

    def remarks(self, experiment: str) -> Iterator[str]:
        """What is wrong with that, in sentences."""
        yield from ()

    def values(self, experiment: str) -> Mapping[str, Any]:
        """What JSON says of an experiment."""
        return {}


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

    def busy(self, figures: Any) -> Collection[str]:
        """Codes of participants who did something by it: they took part."""
        return ()

    def narrowed(self, figures: Any, people: Collection[str]) -> Any:
        """The same figures once it is known who took part."""
        return figures

    def values(self, name: str, figures: Any) -> Mapping[str, Any]:
        """What JSON says of a session. `name`: the feature's; `figures`: None if it has none."""
        return {self.key or name: self.nothing if figures is None else figures}

    def instant(self, episode: Episode) -> Instant | None:
        """What an episode of its own is among the marks of a timeline; None: nothing."""
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

    def attended(self, sessions: Sequence[Any]) -> Iterator[str]:
        """Sentences for the methods section on what participants did. `sessions`: figures of those
        that had any.
        """
        yield from ()

    def suspicion(self, sessions: Sequence[Any], asked: str) -> Iterator[str]:
        """Sentences on what participants answered when they were asked whether they suspected
        a wizard: to the item `asked` (questionnaire.item), otherwise to what the file says.
        """
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
