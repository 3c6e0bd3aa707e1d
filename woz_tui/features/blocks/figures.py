"""Which blocks of BML were played in sessions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from woz_tui.analysis.event_rows import moments
from woz_tui.analysis.feature_figures import FeatureFigures
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
        request, planned = each.request, plan_of(each)
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


def plan_of(command: CommandEpisode) -> BlockPlanned | None:
    """The block that a command was planned as, if it was one."""
    return command.planned if isinstance(command.planned, BlockPlanned) else None


def _problem_text(problem: BlockProblem) -> str:
    named = problem.text.startswith(f"{problem.about}:")
    return problem.text if named or not problem.about else f"{problem.about}: {problem.text}"


class BlockFigures(FeatureFigures):
    """A session's blocks."""

    def count(self, timeline: Timeline) -> tuple[BlockRow, ...] | None:
        return tuple(blocks(timeline)) or None


FIGURES = BlockFigures()
