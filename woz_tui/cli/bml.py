"""`woz bml`: play behaviour blocks of BML 1.0 in a running session, or print their timetable."""

from __future__ import annotations

import asyncio
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from rich.table import Table

from woz_tui.bml.bml_block import BmlBlock, BmlError, read_block
from woz_tui.bml.bml_schedule import BlockSchedule, schedule
from woz_tui.bml.realizer import BmlRealizer, Feedback
from woz_tui.bml.stomp_connection import StompError
from woz_tui.bml.stomp_planner import PlannerTopics, StompPlanner
from woz_tui.bml.tcp_planner import PlannerPortError, PlannerPorts, TcpPlanner
from woz_tui.cli.argument_types import number
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.cli.stomp_options import add_broker, broker_place
from woz_tui.client import WozError, connect
from woz_tui.console.text_console import TextConsole
from woz_tui.system import files

_port = number(1, 0xFFFF, whole=True)
#: The widest picture, in columns.
_WIDTH = 40


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="a block of BML each")
    parser.add_argument("--session", default="", help="session code (default: the only one)")
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="print when everything would happen, and play nothing; without a session by usual"
        " durations",
    )
    parser.add_argument(
        "--feedback", action="store_true", help="print the feedback as XML, one element a line"
    )
    parser.add_argument(
        "--stomp",
        default="",
        metavar="HOST[:PORT]",
        help="play what a planner sends over this message broker, until ctrl+c",
    )
    ports = PlannerPorts()
    parser.add_argument(
        "--listen",
        nargs="?",
        const=ports.request,
        type=_port,
        metavar="PORT",
        help=f"play what a planner on this machine sends to this port (default {ports.request}),"
        " until ctrl+c",
    )
    parser.add_argument(
        "--feedback-port",
        type=_port,
        default=ports.feedback,
        metavar="PORT",
        help=f"with --listen: the planner's port for feedback (default {ports.feedback})",
    )
    topics = PlannerTopics()
    parser.add_argument("--request", default=topics.request, help="topic of the blocks")
    parser.add_argument("--told", default=topics.feedback, help="topic of the feedback")
    add_broker(parser)


def run(arguments: Namespace) -> int:
    """Play the blocks as their composition says; returns when all have ended."""
    if sum(map(bool, (arguments.files, arguments.stomp, arguments.listen))) != 1:
        print("woz: name files with blocks, or --stomp HOST, or --listen", file=sys.stderr)
        return 2
    work = _bml if arguments.files else _planner
    return with_error_sentences(
        lambda: asyncio.run(work(arguments)),
        *(BmlError, PlannerPortError, StompError, ValueError, WozError),
    )


async def _planner(arguments: Namespace) -> int:
    place = broker_place(arguments.stomp, arguments) if arguments.stomp else None
    async with connect(arguments.session, name="planner") as client:
        if place is None:
            ports = PlannerPorts(arguments.listen, arguments.feedback_port)
            await TcpPlanner(client, ports, print).run()
        else:
            topics = PlannerTopics(arguments.request, arguments.told)
            await StompPlanner(client, place, topics, print).run()
    return 0


async def _bml(arguments: Namespace) -> int:
    texts = [_read(path) for path in arguments.files]
    if arguments.dry_run and not arguments.session:
        for path, text in zip(arguments.files, texts, strict=True):
            _print(path, schedule(_block(path, text)))
        return 0
    async with connect(arguments.session, name="bml") as client:
        told = _Told(xml=arguments.feedback)
        realizer = BmlRealizer(client, told.tell)
        if arguments.dry_run:
            for path, text in zip(arguments.files, texts, strict=True):
                _print(path, await realizer.plan(_block(path, text)))
            return 0
        try:
            blocks = [await realizer.perform(text.decode("utf-8", "replace")) for text in texts]
            for block in filter(None, blocks):
                await realizer.until_over(block)
        finally:
            await realizer.close()
    return 1 if told.warned else 0


def _read(path: Path) -> bytes:
    with files.open_regular(path) as file:
        return file.read()


def _block(path: Path, text: bytes) -> BmlBlock:
    try:
        return read_block(text)
    except BmlError as error:
        raise BmlError(f"{path}: {error}", error.block) from None


class _Told:
    """Prints feedback: as XML, or what a person wants to read."""

    def __init__(self, *, xml: bool) -> None:
        self._xml = xml
        self.warned = False

    def tell(self, feedback: Feedback) -> None:
        """One more."""
        self.warned |= feedback.name == "warningFeedback"
        if self._xml:
            print(feedback.xml(), flush=True)
        elif feedback.name == "warningFeedback":
            print(f"woz: {feedback.attributes['id']}: {feedback.text}", file=sys.stderr)
        elif feedback.name.endswith("Progress"):
            at = feedback.attributes
            print(f"{at['globalTime']:>10} s  {at['id']}", flush=True)


def _print(path: Path, plan: BlockSchedule) -> None:
    """The timetable of a block: a row for each behaviour, with a picture of when it is."""
    console = TextConsole()
    width = max(10, min(_WIDTH, console.width - 66))
    console.print(f"{path}: block {plan.block.id}, {plan.seconds:.2f} s", soft_wrap=True)
    table = Table("behaviour", "", "from", "to", "points between", "", box=None, pad_edge=False)
    scale = width / plan.seconds if plan.seconds else 0.0
    for behaviour in sorted(plan.block.behaviours, key=lambda each: plan.times[each.id, "start"]):
        points = plan.points(behaviour.id)
        begin, end = points["start"], points["end"]
        between = " ".join(
            f"{name} {at:.2f}" for name, at in points.items() if name not in ("start", "end")
        )
        bar = " " * round(begin * scale) + "━" * max(1, round((end - begin) * scale))
        table.add_row(behaviour.id, behaviour.kind, f"{begin:.2f}", f"{end:.2f}", between, bar)
    console.print(table)
    for warning in plan.warnings:
        console.print(f"left out: {warning.text}", soft_wrap=True)
