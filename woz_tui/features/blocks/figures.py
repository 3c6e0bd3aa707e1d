"""Which blocks of BML were played in sessions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from woz_tui.analysis.event_rows import moments
from woz_tui.analysis.feature_figures import CommandPicture, FeatureFigures
from woz_tui.analysis.report_table import AlarmText, LogText, ReportTable
from woz_tui.analysis.text_format import clock, duration
from woz_tui.features.blocks.kinds import BML, BlockPlanned, BlockProblem, BlockTrouble
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import CommandEpisode
from woz_tui.timeline.timeline import Timeline


@dataclass(frozen=True, slots=True)
class BlockRow:
    """A block of BML: its id (empty: it was not planned), the action or the program that asked for
    it, how many behaviours it had; `left_out`: what was not played as it was asked for, and why.
    """

    begin: int
    end: int | None
    block: str
    asker: str
    outcome: str
    reason: str
    behaviours: int
    left_out: tuple[str, ...]


def blocks(timeline: Timeline) -> Iterator[BlockRow]:
    """All blocks of BML, those on keys and those of planners."""
    attached = (line for _, line in moments(timeline, m.ConsoleAttached))
    names = {line.console: line.name for line in attached if line.name}
    troubles: dict[str, list[BlockProblem]] = {}
    for _, trouble in moments(timeline, BlockTrouble):
        troubles.setdefault(trouble.command, []).append(trouble.problem)
    for each in timeline.of(CommandEpisode):
        request, planned = each.request, _plan(each)
        if request.driver != BML:
            continue
        problems = [*(planned.problems if planned else ()), *troubles.get(request.command, ())]
        yield BlockRow(
            begin=each.begin,
            end=None if each.cut else each.end,
            block=planned.block if planned else "",
            asker=request.action or names.get(request.console, request.source),
            outcome="" if each.cut else each.outcome,
            reason=each.reason,
            behaviours=len(planned.behaviours) if planned else 0,
            left_out=tuple(_problem_text(problem) for problem in problems),
        )


def _plan(command: CommandEpisode) -> BlockPlanned | None:
    return command.planned if isinstance(command.planned, BlockPlanned) else None


def _problem_text(problem: BlockProblem) -> str:
    named = problem.text.startswith(f"{problem.about}:")
    return problem.text if named or not problem.about else f"{problem.about}: {problem.text}"


class BlockFigures(FeatureFigures):
    """A session's blocks."""

    def count(self, timeline: Timeline) -> tuple[BlockRow, ...] | None:
        return tuple(blocks(timeline)) or None

    def tables(self, figures: tuple[BlockRow, ...]) -> Iterator[ReportTable]:
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
        planned = _plan(command)
        if planned is None:
            return None
        facts = [(each.id, each.does or each.sort) for each in planned.behaviours]
        return CommandPicture(planned.block, facts)


FIGURES = BlockFigures()
