"""Proposals of many sessions: what wizards made of them, by wizard, source and condition."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from woz_tui.analysis.feature_figures import GatheredFigures
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE
from woz_tui.features.proposals.figures import SET_HEADS, ProposalFigures, SetRow, set_cells


class GatheredProposals(GatheredFigures):
    """The sets of all sessions, without those of trials that do not count."""

    def __init__(self) -> None:
        #: By experiment, then wizard, who proposes and condition.
        self._sets: dict[str, dict[tuple[str, str, str], list[SetRow]]] = {}

    def add(self, experiment: str, figures: SessionFigures) -> None:
        found = figures.features.get("proposals")
        if not isinstance(found, ProposalFigures):
            return
        sets = self._sets.setdefault(experiment, {})
        for each in found.sets:
            if each.counted:
                who = each.who or each.source
                sets.setdefault((figures.wizard, who, each.condition), []).append(each)

    def tables(self, experiment: str, totals: Any) -> Iterator[ReportTable]:
        rows = [
            (LogText(wizard or NONE), LogText(who), LogText(condition), *set_cells(sets))
            for (wizard, who, condition), sets in sorted(self._sets.get(experiment, {}).items())
        ]
        yield ReportTable("Proposals by wizard", ("Wizard", *SET_HEADS), rows, words=3)
