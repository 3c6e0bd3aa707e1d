"""`woz design FILE`: who gets which conditions, what has been used so far, what comes next."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rich.table import Table
from rich.text import Text

from woz_tui.analysis.text_format import counted
from woz_tui.cli.argument_types import number
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.report_layout import text_table
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.features.study.condition_proposal import (
    ConditionProposal,
    DesignUsage,
    ParticipantHistory,
    propose,
)
from woz_tui.features.study.counterbalancing import block_size, planned, rows
from woz_tui.features.study.design import Design
from woz_tui.features.study.earlier_sessions import EarlierParticipants, EarlierSessions
from woz_tui.features.study.section import DESIGN, design_sentence, order_text
from woz_tui.protocol.messages import Json

ERRORS = CommandErrors(who="woz design")
#: Columns of a page that goes into a file or a pipe.
_PAGE = 120
#: What those are called who have not come yet.
_NEXT = "next"


def add(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=Path, help="experiment file")
    parser.add_argument(
        "--participants",
        type=number(1, 1000, whole=True),
        metavar="N",
        help="number of participants still to come (default: until all rows are used equally)",
    )
    parser.add_argument(
        "--recordings", type=Path, default=Path("recordings"), help="folder of the logs"
    )
    parser.add_argument(
        "--labels", action="store_true", help="show labels only, for a blind wizard"
    )
    parser.add_argument(
        "--format", choices=("text", "json"), default="text", help="json: one object, for programs"
    )


def run(arguments: Namespace) -> int:
    """Print the plan and return 0, or say what is wrong and return 1."""
    return design(arguments, plugins.installed())


def design(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    experiment = load(arguments.file, catalogue)
    order = DESIGN.of(experiment)
    if order is None:
        _complain("the file has no design; add one, such as design: {order: latin-square}")
        return 1
    found = EarlierSessions(arguments.recordings).read(experiment.title, experiment.path.name)
    plan = _plan(experiment, order, found, arguments.participants)
    if arguments.format == "json":
        report = _report(plan, arguments.recordings, labels=arguments.labels)
        print(json_text(report, indent=2))
    else:
        _print(plan, arguments.recordings, labels=arguments.labels)
    for name in found.unreadable:
        _complain(f"{name} cannot be read and is not counted")
    return 0


def _complain(text: str) -> None:
    print(f"woz design: {text}", file=sys.stderr)


# -- the plan -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Plan:
    experiment: Experiment
    design: Design
    found: EarlierParticipants
    used: DesignUsage
    coming: tuple[ConditionProposal, ...]

    @property
    def assigned(self) -> list[ParticipantHistory]:
        """Everybody who was ever given an order."""
        return [each for each in self.found.past if each.method]


def _plan(
    experiment: Experiment, design: Design, found: EarlierParticipants, participants: int | None
) -> _Plan:
    used = DesignUsage(design, experiment.conditions, found.past)
    past = [*found.past]
    coming: list[ConditionProposal] = []
    for _ in range(participants or _missing(used)):
        proposal = propose(f"{_NEXT} {len(coming) + 1}", design, experiment.conditions, past)
        coming.append(proposal)
        past.append(
            ParticipantHistory(
                proposal.participant, proposal.order, proposal.method, proposal.row, done=True
            )
        )
    return _Plan(experiment, design, found, used, tuple(coming))


def _missing(used: DesignUsage) -> int:
    """Participants until every row was used equally often, at least one round of all."""
    times = used.times()
    if used.design.order == "blocks" and used.conditions:
        size = block_size(used.design, used.conditions)
        blocks = max(times, default=-1) // size + 1
        return blocks * size - len(times) or size
    count = len(rows(used.design, used.conditions))
    return max(times.values(), default=0) * count - sum(times.values()) or count


# -- for people -----------------------------------------------------------------------------------


def _print(plan: _Plan, recordings: Path, *, labels: bool) -> None:
    console = TextConsole(page=_PAGE)
    conditions = plan.experiment.conditions
    console.print(Text(plan.experiment.title, style="bold"))
    console.print(Text(design_sentence(plan.design, len(conditions))), soft_wrap=True)
    console.print(f"{planned(plan.design, conditions)} trials for each participant")
    console.print()
    heading = f"so far ({counted(plan.found.logs, 'log')} in {recordings})"
    console.print(Text(heading, style="bold"))
    console.print(_so_far(plan, labels) if plan.assigned else "nobody")
    console.print()
    console.print(Text("next", style="bold"))
    console.print(_coming(plan, labels))


def _so_far(plan: _Plan, labels: bool) -> Table:
    table = text_table("participant", "row", "trials", "order", "", left=5)
    for past in plan.assigned:
        table.add_row(
            past.participant,
            _row(past.row),
            f"{past.over} of {planned(plan.design, plan.experiment.conditions)}",
            _order(plan, past.order, labels),
            _remark(plan, past),
        )
    return table


def _remark(plan: _Plan, past: ParticipantHistory) -> str:
    if not plan.used.fits(past.order):
        return "from another design"
    if not past.counts:
        return "aborted or excluded: this order can be used again"
    return "chosen by hand" if past.method == "hand" else ""


def _coming(plan: _Plan, labels: bool) -> Table:
    table = text_table("", "row", "order", left=3)
    for place, proposal in enumerate(plan.coming, 1):
        table.add_row(str(place), _row(proposal.row), _order(plan, proposal.order, labels))
    return table


def _row(row: int) -> str:
    return str(row + 1) if row >= 0 else "-"


def _order(plan: _Plan, order: tuple[str, ...], labels: bool) -> str:
    blind = plan.design.blind
    if labels:
        return ", ".join(_shown(plan, order, labels)) or "-"
    return order_text(order, blind if set(order) <= set(blind) else {})


def _shown(plan: _Plan, order: tuple[str, ...], labels: bool) -> list[str]:
    """The conditions, or their labels: `?` for those that the file no longer names."""
    blind = plan.design.blind if labels else {}
    return [blind.get(each, "?") for each in order] if blind else [*order]


# -- for programs ---------------------------------------------------------------------------------


def _report(plan: _Plan, recordings: Path, *, labels: bool) -> Json:
    return {
        "file": str(plan.experiment.path),
        "title": plan.experiment.title,
        "recordings": str(recordings),
        "logs": plan.found.logs,
        "planned": planned(plan.design, plan.experiment.conditions),
        "participants": [_past(plan, past, labels) for past in plan.assigned],
        "next": [
            {"row": each.row, "order": [*_shown(plan, each.order, labels)]} for each in plan.coming
        ],
    }


def _past(plan: _Plan, past: ParticipantHistory, labels: bool) -> Json:
    return {
        "participant": past.participant,
        "order": [*_shown(plan, past.order, labels)],
        "method": past.method,
        "row": past.row,
        "over": past.over,
        "counts": past.counts and plan.used.fits(past.order),
    }
