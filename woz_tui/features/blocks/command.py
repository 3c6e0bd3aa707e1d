"""`woz bml`: play behaviour blocks of BML 1.0 in a running session, or print their timetable."""

from __future__ import annotations

import asyncio
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from rich.table import Table

from woz_tui.bridge.stomp_connection import StompError
from woz_tui.cli.argument_types import file_or_word, number
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import add_session_choice, joined_session
from woz_tui.cli.stomp_options import add_broker, broker_place
from woz_tui.client import WozError, connect
from woz_tui.config.bundled_files import is_path, robot_files
from woz_tui.config.file_text import SourceFileError, read_source
from woz_tui.config.loading import load_robot_file
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.features.blocks.behaviour_calls import BehaviourCalls
from woz_tui.features.blocks.block_plan import plan
from woz_tui.features.blocks.bml_block import BmlBlock, BmlError, read_block
from woz_tui.features.blocks.kinds import BlockPlanned, PlannedBehaviour
from woz_tui.features.blocks.realizer import BmlRealizer, Feedback
from woz_tui.features.blocks.section import BLOCKS, BlockReader
from woz_tui.features.blocks.stomp_planner import PlannerTopics, StompPlanner
from woz_tui.features.blocks.tcp_planner import PlannerPortError, PlannerPorts, TcpPlanner

ERRORS = CommandErrors(BmlError, PlannerPortError, StompError, ValueError, WozError)
_port = number(1, 0xFFFF, whole=True)
#: The widest picture, in columns.
_WIDTH = 100
#: How points are drawn: where the meaning of a movement or of a face is. The words of a speech at
#: its marks are crosses.
_MARKS = {"stroke": "◆", "attackPeak": "◆"}
#: Points that have a column of their own, or say little beside the stroke.
_PHASES, _HELD = ("start", "end", "strokeStart", "strokeEnd"), ("ready", "relax")
#: Seconds from one number of the axis to the next.
_STEPS_S = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 3600.0)


def add(parser: ArgumentParser) -> None:
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="a block of BML each")
    add_session_choice(parser, "--session")
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="of files: print when everything would happen and what the robot does for it, and"
        " play nothing; without a session by usual durations",
    )
    parser.add_argument(
        "--robot",
        type=file_or_word,
        default="",
        help="with --dry-run and no session: a robot file, or the name of one, in `robots` beside"
        " the block or of woz-tui (default: simulated)",
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
    if arguments.dry_run and not arguments.files:
        print("woz: --dry-run is for files with blocks", file=sys.stderr)
        return 2
    if arguments.feedback and not arguments.files:
        print("woz: --feedback is for files with blocks", file=sys.stderr)
        return 2
    if arguments.robot and (not arguments.dry_run or arguments.session or arguments.access):
        print("woz: --robot is for --dry-run without a session", file=sys.stderr)
        return 2
    work = _bml if arguments.files else _planner
    if arguments.access is None:
        return asyncio.run(work(arguments))
    with joined_session(arguments.access, arguments.session, "woz bml") as session:
        if session is None:
            return 1
        arguments.session = str(session.path)
        return asyncio.run(work(arguments))


async def _planner(arguments: Namespace) -> int:
    place = broker_place(arguments.stomp, arguments) if arguments.stomp else None
    async with connect(arguments.session, name="planner") as client:
        say = partial(print, flush=True)
        if place is None:
            ports = PlannerPorts(arguments.listen, arguments.feedback_port)
            await TcpPlanner(client, ports, say).run()
        else:
            topics = PlannerTopics(arguments.request, arguments.told)
            await StompPlanner(client, place, topics, say).run()
    return 0


async def _bml(arguments: Namespace) -> int:
    texts = [_read(path) for path in arguments.files]
    if arguments.dry_run and not arguments.session:
        robot = arguments.robot or "simulated"
        for path, text in zip(arguments.files, texts, strict=True):
            block = _block(path, text)
            made = plan(block, _calls_of(robot, path.parent)(block.character)).message()
            _print(path, made, f"on {robot}, by usual durations")
        return 0
    async with connect(arguments.session, name="bml") as client:
        told = [_Told(path, xml=arguments.feedback) for path in arguments.files]
        realizers = [BmlRealizer(client, each.tell) for each in told]
        try:
            if arguments.dry_run:
                for path, text, realizer in zip(arguments.files, texts, realizers, strict=True):
                    _block(path, text)
                    made = await realizer.predict(text)
                    _print(path, made, "on the robot of the session")
                return 0
            names = [
                await realizer.perform(text)
                for realizer, text in zip(realizers, texts, strict=True)
            ]
            for realizer, name in zip(realizers, names, strict=True):
                await realizer.until_over(name)
        finally:
            await asyncio.gather(*(realizer.close() for realizer in realizers))
    return 1 if any(each.warned for each in told) else 0


def _read(path: Path) -> str:
    try:
        return read_source(path, str(path)).text
    except SourceFileError as error:
        raise BmlError(f"{path}: {error}") from error


def _block(path: Path, text: str) -> BmlBlock:
    try:
        return read_block(text)
    except BmlError as error:
        raise BmlError(f"{path}: {error}", error.block) from None


class _Told:
    """Prints feedback about the block of a file: as XML, or what a person wants to read."""

    def __init__(self, file: Path, *, xml: bool) -> None:
        self._file = file
        self._xml = xml
        self.warned = False

    def tell(self, feedback: Feedback) -> None:
        """One more."""
        self.warned |= feedback.name == "warningFeedback"
        if self._xml:
            print(feedback.xml(), flush=True)
        elif feedback.name == "warningFeedback":
            at = feedback.attributes
            place = self._file if at["type"] == "PARSING_FAILURE" else at["id"].partition(":")[0]
            print(f"woz: {place}: {feedback.text}", file=sys.stderr)
        elif feedback.name.endswith("Progress"):
            at = feedback.attributes
            print(f"{at['globalTime']:>10} s  {at['id']}", flush=True)


def _calls_of(robot: str, folder: Path) -> Callable[[str], BehaviourCalls]:
    """What behaviours stand for on a robot: its file, or its name, which is looked for in `robots`
    of `folder` and of woz-tui.
    """
    file = Path(robot) if is_path(robot) else robot_files(folder).get(robot)
    if file is None:
        known = ", ".join(robot_files(folder))
        raise ValueError(f"there is no robot {robot!r}; robots are {known}, or name a robot file")
    read = load_robot_file(file, plugins.installed()).sections[BLOCKS]
    assert isinstance(read, BlockReader)
    return read.calls


def _print(path: Path, plan: BlockPlanned, robot: str) -> None:
    """The timetable of a block: a table, a picture, and what is left out."""
    console = TextConsole()
    seconds = plan.duration_us / 1e6
    console.print(f"{path}: block {plan.block}, {seconds:.2f} s {robot}", soft_wrap=True)
    rows = sorted(plan.behaviours, key=lambda each: each.points["start"])
    if rows:
        table = Table("behaviour", "", "what the robot does", "from", "to", "between", box=None)
        table.pad_edge = False
        for row in rows:
            between = " ".join(
                f"{name} {at / 1e6:.2f}"
                for name, at in row.points.items()
                if name not in _PHASES and (name not in _HELD or "stroke" not in row.points)
            )
            first, last = (f"{row.points[name] / 1e6:.2f}" for name in ("start", "end"))
            table.add_row(row.id, row.sort, row.does or "nothing", first, last, between)
        console.print(table)
        console.print()
        for line in _picture(rows, plan.duration_us, console.width):
            console.print(line, soft_wrap=True)
    for problem in plan.problems:
        console.print(f"left out: {problem.text} ({problem.sort})", soft_wrap=True)


def _picture(rows: Sequence[PlannedBehaviour], whole_us: int, width: int) -> Iterator[str]:
    """A line for each behaviour: when it is, with its points; below it an axis in seconds."""
    margin = min(16, max(len(row.id) for row in rows)) + 2
    room = max(10, min(_WIDTH, width - margin - 1))

    def column(at_us: int) -> int:
        return round(at_us * (room - 1) / whole_us) if whole_us else 0

    for row in rows:
        first, last = column(row.points["start"]), column(row.points["end"])
        line = [" "] * first + ["━"] * (last - first + 1)
        for name, at in row.points.items():
            if name not in ("start", "end"):
                line[column(at)] = _MARKS.get(name, "╋" if row.sort == "speech" else "━")
        yield f"{row.id[: margin - 2]:{margin}}{''.join(line)}"
    step = next((each for each in _STEPS_S if whole_us / 1e6 / each * 6 <= room), _STEPS_S[-1])
    axis = ""
    for count in range(int(whole_us / 1e6 / step) + 1):
        axis = f"{axis:{column(round(count * step * 1e6))}}{count * step:g}"
    yield f"{'s':{margin}}{axis}"
