"""Blocks of BML in reports."""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.analysis.feature_report import CommandPicture, FeatureReport
from woz_tui.analysis.report_table import AlarmText, LogText, ReportTable
from woz_tui.analysis.text_format import clock, duration
from woz_tui.features.blocks.figures import BlockRow, plan_of
from woz_tui.timeline.episodes import CommandEpisode


class BlockReport(FeatureReport):
    """Each block, and what it consisted of."""

    def session_tables(self, figures: tuple[BlockRow, ...]) -> Iterator[ReportTable]:
        """Whose they were, how they went, and what of them was not played as asked."""
        rows = [
            (
                *(clock(row.begin), LogText(row.block), LogText(row.asker), LogText(row.outcome)),
                AlarmText("; ".join(filter(None, (row.reason, *row.left_out)))),
                duration(None if row.end is None else row.end - row.begin),
                str(row.behaviours),
            )
            for row in figures
        ]
        heads = ("At", "Block", "By", "Ended", "Not played", "Lasted", "Behaviours")
        yield ReportTable("Behaviour blocks (BML)", heads, rows, words=5)

    def picture(self, command: CommandEpisode) -> CommandPicture | None:
        planned = plan_of(command)
        if planned is None:
            return None
        facts = [(each.id, each.does or each.sort) for each in planned.behaviours]
        return CommandPicture(planned.block, facts)


REPORT = BlockReport()
