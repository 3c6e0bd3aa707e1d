"""What features count in sessions, and say of it in reports."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from woz_tui.analysis.durations import Durations
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


class FeatureFigures:
    """A feature's figures of a session. What `count` returns is given to the others.

    Attributes:
        key: What JSON calls them; empty: by the feature's name.
        measures: Main figures, which stand behind all others.
    """

    key: ClassVar[str] = ""
    measures: ClassVar[tuple[TimesMeasure, ...]] = ()

    def count(self, timeline: Timeline) -> Any:
        """The figures of one session; None: there is nothing to say."""
        return None

    def times(self, timeline: Timeline) -> Iterator[tuple[Context, str, int]]:
        """Durations in microseconds: the context in which each counts, and what it is one of."""
        yield from ()

    def circumstances(self, figures: Any) -> Iterator[str]:
        """Sentences on the circumstances of a session, for its report."""
        yield from ()

    def methods(self, sessions: Sequence[Any]) -> Iterator[str]:
        """Sentences for the methods section. `sessions`: figures of those that had any."""
        yield from ()

    def methods_of_times(self, times: Mapping[str, Durations]) -> Iterator[str]:
        """Sentences for the same on `times`, added up over all that means include."""
        yield from ()
