"""Proposals of many sessions: what wizards made of them, and whether they saved time.

That they did is said of trials of which chance has drawn half (`trials: half`) alone. What was
taken was taken because it fitted: its times say nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from woz_tui.analysis.feature_figures import GatheredFigures
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.intervals import Estimate, paired_difference
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE
from woz_tui.features.proposals.figures import ProposalFigures, SetRow
from woz_tui.features.proposals.model_figures import in_s
from woz_tui.features.proposals.report import SET_HEADS, set_cells


@dataclass
class _Drawn:
    """Trials with and without proposals, and reaction times in them by participant."""

    trials: dict[bool, int] = field(default_factory=lambda: {True: 0, False: 0})
    times: dict[bool, dict[str, list[int]]] = field(default_factory=lambda: {True: {}, False: {}})

    def medians(self, offered: bool) -> dict[str, float]:
        """By participant."""
        return {who: median(times) for who, times in self.times[offered].items()}

    def difference(self) -> Estimate | None:
        """With less without, in seconds, of those who have both."""
        without, given = self.medians(False), self.medians(True)
        both = [who for who in without if who in given]
        return paired_difference([(without[who] / 1e6, given[who] / 1e6) for who in both])


class GatheredProposals(GatheredFigures):
    """The sets of all sessions, without those of trials that do not count."""

    def __init__(self) -> None:
        #: By experiment, then wizard, who proposes and condition.
        self._sets: dict[str, dict[tuple[str, str, str], list[SetRow]]] = {}
        self._drawn: dict[str, _Drawn] = {}

    def add(self, experiment: str, figures: SessionFigures) -> None:
        found = figures.features.get("proposals")
        if not isinstance(found, ProposalFigures):
            return
        sets = self._sets.setdefault(experiment, {})
        for each in found.sets:
            if each.counted:
                who = each.who or each.source
                sets.setdefault((figures.wizard, who, each.condition), []).append(each)
        if found.drawn:
            self._add_drawn(self._drawn.setdefault(experiment, _Drawn()), found, figures)

    def _add_drawn(self, drawn: _Drawn, found: ProposalFigures, figures: SessionFigures) -> None:
        for trial in figures.trials:
            offered = found.drawn.get((trial.participant, trial.trial))
            if offered is not None and not trial.left_out:
                drawn.trials[offered] += 1
        for cue in figures.cues:
            offered = found.drawn.get((cue.participant, cue.trial))
            if offered is None or cue.echo or not cue.counted or cue.reaction_us is None:
                continue
            drawn.times[offered].setdefault(cue.participant, []).append(cue.reaction_us)

    def tables(self, experiment: str, totals: Any) -> Iterator[ReportTable]:
        rows = [
            (LogText(wizard or NONE), LogText(who), LogText(condition), *set_cells(sets))
            for (wizard, who, condition), sets in sorted(self._sets.get(experiment, {}).items())
        ]
        yield ReportTable("Proposals by wizard", ("Wizard", *SET_HEADS), rows, words=3)
        if (drawn := self._drawn.get(experiment)) is not None:
            yield _saved(drawn)

    def values(self, experiment: str) -> Mapping[str, Any]:
        drawn = self._drawn.get(experiment)
        estimate = drawn.difference() if drawn is not None else None
        return {} if estimate is None else {"proposals_reaction_difference_s": estimate}


def _saved(drawn: _Drawn) -> ReportTable:
    """Reaction times with and without proposals, in trials of which chance has drawn half."""
    rows: list[tuple[str, ...]] = []
    for offered, name in ((True, "proposals offered"), (False, "nothing offered")):
        times, people = drawn.times[offered], drawn.medians(offered)
        count = sum(map(len, times.values()))
        middle = in_s(median(people.values()) if people else None)
        rows.append((name, str(drawn.trials[offered]), str(len(people)), str(count), middle))
    if (estimate := drawn.difference()) is not None:
        half = ""
        if estimate.half is not None:
            low, high = (estimate.mean + sign * estimate.half for sign in (-1, 1))
            half = f" [{low:.2f}, {high:.2f}]"
        rows.append(("difference", "", str(estimate.n), "", f"{estimate.mean:+.2f} s{half}"))
    heads = ("Trials drawn by chance", "Trials", "Participants", "Answers", "Reaction, median")
    return ReportTable("Reaction times with and without proposals", heads, rows, words=1)
