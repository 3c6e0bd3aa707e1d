"""Reactions to cues over many sessions, with all cues in the denominator.

The times that are left are no sample of all: a cue that nobody answered has none, one that was
answered early has none either, and the window cuts what would have been late. So no mean of them.
"""

from __future__ import annotations

import bisect
import statistics
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CUE_RESULTS
from woz_tui.analysis.figures import Reactions
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE, duration, percent

#: Seconds within which the share of answers is told.
WITHIN_S = (1, 2, 3, 5)
#: Of more cues than this share answered early, the cue comes late: nobody is that quick.
EARLY_SHARE = 0.1


#: The picture's heading, and what stands below it.
REACTIONS = "Cues answered in time"
REACTION_WORDS = (
    "Of all cues that stayed open (neither superseded nor cut), the share that was answered within "
    "a time. What was answered early is there at 0 s; what is missing at the end was missed."
)


@dataclass(slots=True)
class ReactionTotals:
    """The cues of one condition, of all participants whom means include."""

    window_us: int = 0
    results: Counter[str] = field(default_factory=Counter)
    times: Durations = field(default_factory=Durations)
    #: Participant -> all of their times.
    own: dict[str, Durations] = field(default_factory=dict)

    def add(self, who: str, found: Reactions, window_us: int) -> None:
        """Add the cues of a part."""
        self.window_us = window_us
        self.results.update(found.results)
        self.times.extend(found.times)
        self.own.setdefault(who, Durations()).extend(found.times)

    @property
    def cues(self) -> int:
        return self.results.total()

    @property
    def stayed_open(self) -> int:
        """Those that could be answered to the end of the window: neither superseded nor cut."""
        return self.cues - self.results["superseded"] - self.results["cut"]

    @property
    def early(self) -> int:
        """Those that were answered early."""
        return self.results["answered_early"]

    @property
    def answered(self) -> int:
        """Those that were answered within the window, or early."""
        return self.times.n + self.early

    @property
    def median_us(self) -> float | None:
        """The median of the participants' medians; None: nobody answered in time."""
        medians = [each.median for each in self.own.values() if each.median is not None]
        return statistics.median(medians) if medians else None

    def share_within(self, seconds: float) -> float | None:
        """The share of cues that were answered so soon, or early, of all that stayed open; None:
        there are none, or the window is shorter.
        """
        if not self.stayed_open or seconds * 1e6 > self.window_us:
            return None
        soon = bisect.bisect_right(self.times.values, round(seconds * 1e6))
        return (soon + self.early) / self.stayed_open

    @property
    def is_early(self) -> bool:
        """Whether so many were answered early that the cue itself comes late."""
        return self.early > EARLY_SHARE * self.cues


_TITLES = {
    "answered": "Answered",
    "answered_early": "Early",
    "missed": "Missed",
    "superseded": "Superseded",
    "cut": "Cut short",
}


def reactions_table(found: dict[str, ReactionTotals]) -> ReportTable:
    """By condition."""
    rows = [
        [
            LogText(condition or "none"),
            str(each.cues),
            *(str(each.results[result] or "") for result in CUE_RESULTS),
            str(sum(1 for times in each.own.values() if times)),
            duration(each.median_us),
            *(percent(each.share_within(seconds)) for seconds in WITHIN_S),
        ]
        for condition, each in sorted(found.items())
        if each.cues
    ]
    windows: Sequence[str] = sorted({f"{each.window_us / 1e6:g} s" for each in found.values()})
    heads = ["Condition", "Cues", *(_TITLES[result] for result in CUE_RESULTS), "People"]
    heads += ["Median", *(f"in {seconds} s" for seconds in WITHIN_S)]
    window = " and ".join(windows) or NONE
    title = f"Reactions to cues (window {window}); shares of all that stayed open"
    return ReportTable(title, heads, rows)


def early_sentences(found: dict[str, ReactionTotals]) -> list[str]:
    """Warnings of cues that come late."""
    return [
        f"{condition or 'none'}: {percent(each.early / each.cues)} of the cues "
        f"were answered early: the cue (the end of speech) is told late; the wizard is not that "
        f"quick"
        for condition, each in sorted(found.items())
        if each.is_early
    ]
