"""Blocks that others wrote to examine realizers: read, put in time, and played through ActiveMQ.

What the tester of realizers looks at is asked here in words of ours; its own program is Java, and
is compiled by who wants to run it.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

from tests.fakes.ports import free_port
from tests.host.rig import served_session
from tests.peers.places import place
from tests.peers.test_stomp_broker import PORTS, Broker
from woz_tui.bridge.stomp_connection import StompConnection, StompPlace, connect_stomp
from woz_tui.client import connect
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed
from woz_tui.features.blocks.bml_block import (
    NAMESPACE,
    SYNC_POINTS,
    BmlError,
    BmlWarning,
    read_block,
)
from woz_tui.features.blocks.bml_schedule import BlockSchedule, schedule
from woz_tui.features.blocks.stomp_planner import PlannerTopics, StompPlanner
from woz_tui.testing import until

pytestmark = pytest.mark.peers

PATIENCE_S = 90.0
#: Of what two points may be apart that belong together, in seconds; the tester's own figure.
TOLERANCE_S = 0.1


def _files() -> Iterator[Path]:
    """All files with a block, of the parser and of the tester."""
    for folder in (place("bml-files") / "parser" / "test", place("bml-files") / "tester"):
        for path in sorted(folder.rglob("*.xml")):
            if b"<bml" in path.read_bytes():
                yield path


def _result(path: Path) -> BlockSchedule | BmlError:
    try:
        return schedule(read_block(path.read_text("utf-8", "replace")))
    except BmlError as error:
        return error


def _is_bml_1(path: Path) -> bool:
    return NAMESPACE.encode() in path.read_bytes()


# -- read and put in time ------------------------------------------------------------------------

#: Files of BML 1.0 of which something of BML's core is left out, or all: what the reason says.
LEFT_OUT = {
    "bmlnoid.xml": "no id",
    "speech_retime.xml": "speech1 takes",
    "testgazeoverlap.xml": "same time",
    "testinvalidxml.xml": "no XML",
    "testnod_invalidtime.xml": "the order of nod1's points",
    "testnod_unknownattributes.xml": "unbound prefix",
    "testspeech_endtimed2.xml": "speech1 takes",
    "testspeech_invalidtime.xml": "speech1 takes",
    "testspeech_invalidtimesync.xml": "speech1 takes",
    "testspeech_invalidtimesync2.xml": "speech1 takes",
    "testspeech_unknownbehavior.xml": "unknownbeh:end",
    "testspeech_unknownsync.xml": "speech1:unknown",
    "testspeechinterrupt.xml": "i1:start",  # hangs on an extension
}
#: Files whose comments state times that the block itself contradicts.
WRONG_COMMENTS = {
    *("testlongspeechandnod.xml", "testspeechgestures.xml", "testbeatandnod.xml"),
    *("testnod2x_absolute.xml", "testnod_absolute.xml", "testoffsetchainreversed.xml"),
}


def test_every_block_is_put_in_time_or_refused_with_a_reason() -> None:
    counts: Counter[tuple[str, str]] = Counter()
    left_out: dict[str, str] = {}
    for path in _files():
        result = _result(path)
        sort = "BML 1.0" if _is_bml_1(path) else "draft"
        warnings: tuple[BmlWarning, ...] = ()
        if isinstance(result, BmlError):
            counts[sort, "refused"] += 1
            reason = str(result)
        else:
            warnings = result.warnings
            counts[sort, "with something left out" if warnings else "whole"] += 1
            core = [each for each in warnings if each.kind != "BEHAVIOR_TYPE_NOT_SUPPORTED"]
            reason = core[0].text if core else ""
        if reason and sort == "BML 1.0":
            left_out[path.name] = reason
    assert counts == {
        ("BML 1.0", "whole"): 93,
        ("BML 1.0", "with something left out"): 21,
        ("BML 1.0", "refused"): 3,
        ("draft", "whole"): 22,
        ("draft", "with something left out"): 39,
        ("draft", "refused"): 4,
    }
    assert left_out.keys() == LEFT_OUT.keys()
    for name, words in LEFT_OUT.items():
        assert words in left_out[name]


def test_the_times_that_files_state_are_those_of_the_schedule() -> None:
    held, wrong = 0, set()
    for path in filter(_is_bml_1, _files()):
        result = _result(path)
        if isinstance(result, BlockSchedule):
            for values in _stated(path.read_text("utf-8", "replace"), result):
                if max(values) - min(values) < TOLERANCE_S:
                    held += 1
                else:
                    wrong.add(path.name)
    assert wrong == WRONG_COMMENTS
    assert held > 100


def _stated(text: str, block_schedule: BlockSchedule) -> Iterator[list[float]]:
    """What lines such as `nod1:start = speech1:end + 1 = 5` of the comments come to."""
    for comment in re.findall(r"<!--(.*?)-->", text, re.DOTALL):
        for line in comment.partition("Constraints")[0].splitlines():
            terms = [_term(term.strip(), block_schedule) for term in line.split("=")]
            known = [term for term in terms if term is not None]
            if len(known) == len(terms) > 1:
                yield known


def _term(text: str, block_schedule: BlockSchedule) -> float | None:
    match = re.fullmatch(r"(?:(\w+):(\w+))?\s*([+-]?\s*[\d.]+)?", text)
    if match is None or not text:
        return None
    offset = float((match[3] or "0").replace(" ", ""))
    if not match[1]:
        return offset
    time = block_schedule.times.get((match[1], match[2]))
    return None if time is None else time + offset


# -- played --------------------------------------------------------------------------------------

#: A robot with what the tester's blocks name.
ROBOT = """
name: tester
drivers:
  robot: {type: simulated, moves: {beat: 1.5, sit: 2}}
bml:
  targets: {bluebox: [20, 5]}
"""
EXPERIMENT = """
title: BML tester
robot: robot.yaml
panels: [{title: A, actions: [{key: a, label: Hello, say: hello}]}]
"""


@dataclass(frozen=True)
class PlayedFiles:
    """What is asked of files that are sent one behind the other.

    `orders`: behaviours of the first block -> their sync points in order. `times`: sync points ->
    seconds from the block's start. `together`: pairs, each of which is at the same time.
    `warnings`: how many; None: any. `pause_s`: before the last file.
    """

    files: tuple[str, ...]
    orders: Mapping[str, str | tuple[str, ...]] = field(default_factory=dict)
    times: Mapping[str, float] = field(default_factory=dict)
    together: tuple[tuple[str, str], ...] = ()
    warnings: int | None = 0
    ends: tuple[str, ...] = ("bml1",)
    pause_s: float = 0.0


WORD = ("start", "syncstart1", "end")
WORD_TIMES = {"speech1:start": 6.0, "nod1:end": 9.0}
NOD_AT_WORD = (("speech1:syncstart1", "nod1:start"),)
CASES = (
    PlayedFiles(("empty",)),
    PlayedFiles(("bmlnoid",), warnings=1, ends=()),
    PlayedFiles(("testface",), {"face1": "faceLexeme"}),
    PlayedFiles(("testbeatgesture",), {"g1": "gesture"}),
    PlayedFiles(("testspeech",), {"speech1": "speech"}, {"speech1:start": 0}),
    PlayedFiles(("testspeech2",), {"speech1": WORD}, {"speech1:start": 6}),
    PlayedFiles(
        ("testspeech_nodtimedtosync",), {"speech1": WORD, "nod1": "head"}, WORD_TIMES, NOD_AT_WORD
    ),
    PlayedFiles(
        ("testspeech_nodtimedtosyncinverseorder",),
        {"speech1": WORD, "nod1": "head"},
        WORD_TIMES,
        NOD_AT_WORD,
    ),
    PlayedFiles(
        ("testspeechgesturesync2x",),
        {"beat5": "gesture", "beatstop": "gesture", "speech1": "speech", "speech2": "speech"},
        together=(
            ("speech1:start", "beat5:stroke"),
            ("speech2:start", "beatstop:end"),
            ("beatstop:start", "beat5:end + 3"),
        ),
    ),
    PlayedFiles(("testnodlong",), {"nod1": "head"}, {"nod1:start": 0, "nod1:end": 5}),
    PlayedFiles(("testgaze",), {"gaze1": "gaze"}, {"gaze1:start": 1, "gaze1:end": 10}),
    PlayedFiles(
        ("testgazeoverlap",), {"gaze1": "gaze"}, {"gaze1:start": 1, "gaze1:end": 10}, warnings=1
    ),
    PlayedFiles(("testgazewaist",), {"gaze1": "gaze"}, {"gaze1:start": 1}),
    PlayedFiles(("testgazeshift",), {"gaze1": "gazeShift"}),
    PlayedFiles(("testpoint",), {"point1": "pointing"}, {"point1:start": 1, "point1:end": 10}),
    PlayedFiles(("testpose",), {"pose1": "postureShift"}, {"pose1:start": 5, "pose1:end": 8}),
    PlayedFiles(
        ("testspeechgestures",),
        {
            "welkom": ("start", "deicticheart1", "beat1b1", "end"),
            **dict.fromkeys(("g1", "relaxleft", "transleft"), "gesture"),
        },
        {
            **{"welkom:deicticheart1": 2, "g1:start": 2, "g1:end": 4},
            **{"transleft:start": 0, "transleft:end": 2},
            **{"relaxleft:start": 4.5, "relaxleft:end": 6.8},
        },
    ),
    PlayedFiles(("testshortbeh",)),
    PlayedFiles(
        ("testspeechandnod_synctimed",),
        {"speech1": ("start", "s1", "end"), "nod1": "head"},
        {"speech1:s1": 10},
        (("speech1:start", "nod1:start"),),
    ),
    PlayedFiles(("testspeech", "testspeechappend"), {"speech1": "speech"}, ends=("bml1", "bml2")),
    PlayedFiles(
        ("replace/testlongspeechandnod", "replace/replace"),
        warnings=None,
        ends=("bml1", "bml3"),
        pause_s=0.7,
    ),
    PlayedFiles(
        tuple(f"appendandreplace/{name}" for name in ("testspeech1", "testspeech2", "replace")),
        ends=("bml1", "bml2", "bml3"),
        pause_s=3.0,
    ),
)


async def test_the_testers_blocks_are_played_and_told_as_it_asks(tmp_path: Path) -> None:
    blocks = place("bml-files") / "tester" / "testcases" / "bml-1" / "core"
    broker = Broker("activemq", tmp_path, StompPlace("127.0.0.1", free_port(PORTS)))
    try:
        broker.start()
        found = await asyncio.gather(
            *(
                _problems(case, blocks, broker.place, tmp_path / str(at))
                for at, case in enumerate(CASES)
            )
        )
    finally:
        broker.end()
    assert {
        case.files: problems for case, problems in zip(CASES, found, strict=True) if problems
    } == {}


def _experiment(folder: Path, catalogue: Mapping[str, type[Driver]]) -> Experiment:
    folder.mkdir()
    (folder / "robot.yaml").write_text(ROBOT)
    (folder / "experiment.yaml").write_text(EXPERIMENT)
    return load(folder / "experiment.yaml", catalogue)


async def _problems(case: PlayedFiles, blocks: Path, there: StompPlace, folder: Path) -> list[str]:
    """What is not as asked, with a robot and topics of its own."""
    catalogue = installed()
    experiment = _experiment(folder, catalogue)
    topics = PlannerTopics(f"/topic/request.{folder.name}", f"/topic/feedback.{folder.name}")
    sentences: list[str] = []
    planner = await connect_stomp(there)
    planner.subscribe(topics.feedback)
    told: list[Xml.Element] = []
    async with (
        served_session(folder, made=experiment, catalogue=catalogue) as host,
        connect(host.path) as client,
    ):
        running = [
            asyncio.create_task(StompPlanner(client, there, topics, sentences.append).run()),
            asyncio.create_task(_listen(planner, told)),
        ]
        try:
            await until(lambda: bool(sentences), PATIENCE_S)
            await asyncio.sleep(1.0)  # the broker tells nobody that it has subscribed somebody
            for name in case.files:
                if name == case.files[-1]:
                    await asyncio.sleep(case.pause_s)
                planner.send(topics.request, (blocks / f"{name}.xml").read_text())
            ends = {f"{block}:end" for block in case.ends}
            with contextlib.suppress(TimeoutError):  # what is missing is found below
                await until(lambda: ends <= {each.get("id") for each in told}, PATIENCE_S)
                await until(lambda: _warnings(told) >= (case.warnings or 0), PATIENCE_S)
        finally:
            for task in running:
                task.cancel()
            await asyncio.gather(*running, return_exceptions=True)
            await planner.close()
    return [*_wrong(case, told)]


async def _listen(planner: StompConnection, told: list[Xml.Element]) -> None:
    async for _, text in planner.messages():
        told.append(Xml.fromstring(text))


def _warnings(told: list[Xml.Element]) -> int:
    return sum(each.tag.endswith("warningFeedback") for each in told)


def _wrong(case: PlayedFiles, told: list[Xml.Element]) -> Iterator[str]:
    blocks = [each.get("id", "") for each in told if each.tag.endswith("blockProgress")]
    for moment in ("start", "end"):
        of_blocks = [each for each in blocks if each.endswith(f":{moment}")]
        if of_blocks != [f"{block}:{moment}" for block in case.ends]:
            yield f"blocks {blocks}"
    if case.warnings not in (None, _warnings(told)):
        yield f"{_warnings(told)} warnings"
    points = [each for each in told if each.tag.endswith("syncPointProgress")]
    names = [each.get("id", "") for each in points]
    if len({*names}) != len(names):
        yield "something was told twice"
    times = {
        each.get("id", "").removeprefix("bml1:"): float(each.get("time", "nan")) for each in points
    }
    for behaviour, order in case.orders.items():
        wanted = SYNC_POINTS[order] if isinstance(order, str) else order
        got = tuple(name.rpartition(":")[2] for name in times if name.startswith(f"{behaviour}:"))
        if got != wanted:
            yield f"{behaviour}: {got}"
    for name, time in case.times.items():
        if not abs(times.get(name, float("nan")) - time) < TOLERANCE_S:
            yield f"{name} at {times.get(name)}"
    for pair in case.together:
        one, other = (
            times.get(name, float("nan")) + float(offset or 0)
            for name, _, offset in (each.partition(" + ") for each in pair)
        )
        if not abs(one - other) < TOLERANCE_S:
            yield f"{pair}: {one} and {other}"
