"""Planned against real times of a behaviour planner's block: sync points, words and strokes.

    python benchmarks/bml_timing.py [--blocks 40] [--quick]

On the simulated robot and on EyePi without hardware, one after the other: `woz host` plays blocks
in which a speech has a mark before each word and a nod hangs on a mark. The plan says when each
point will be; the robot says when a word begins and when a stroke comes. The floor is a bare timer:
the planner beside it waits for the moments of the same plan.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
from collections.abc import AsyncIterator

from benchmarks.figures import Spread, machine, table
from benchmarks.round_trips import program
from benchmarks.sessions import ROOT, Bench, bench
from woz_tui.client import WozClient, connect
from woz_tui.features.blocks.kinds import BlockPlanned
from woz_tui.protocol import messages as m

ROBOTS = {"simulated": "the simulated robot", "eyepi": "EyePi without hardware"}
WORDS = ("one", "two", "three", "four", "five", "six", "seven", "eight")
FLOOR, POINTS, SPOKEN, STROKES = "bare timer", "sync points", "words begin", "strokes"
#: After a block, in seconds.
PAUSE_S = 0.3
#: Milliseconds behind the plan, by what was planned.
Late = dict[str, list[float]]


def block(number: int, words: int) -> str:
    """A block of BML; about half a second for each word."""
    text = "".join(f'<sync id="{word}"/>{word} ' for word in WORDS[:words])
    nods = f'<head id="n1" lexeme="NOD" stroke="s:{WORDS[words - 1]}"/>'
    if words == len(WORDS):
        nods = (
            '<head id="n1" lexeme="NOD" stroke="s:three"/>'
            '<head id="n2" lexeme="NOD" start="n1:end + 0.2"/>'
        )
    return (
        f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b{number}">'
        f'<speech id="s"><text>And {text}</text></speech>{nods}</bml>'
    )


async def played(client: WozClient, text: str, late: Late) -> None:
    """Play one block and note how late everything was."""
    stream = client.messages(m.Ack)
    run = await client.begin("bml", {"block": text})
    timers: list[asyncio.Task[None]] = []
    planned: dict[str, float] = {}
    strokes: list[float] = []

    async def wait(moment: float) -> None:
        await asyncio.sleep(moment - client.now())
        late[FLOOR].append((client.now() - moment) * 1e3)

    async for message in stream:
        match message:
            case BlockPlanned(begin=begin):
                if message.problems:
                    raise RuntimeError(message.problems[0].text)
                for behaviour in message.behaviours:
                    for point, at in behaviour.points.items():
                        planned[f"{behaviour.id}:{point}"] = (begin + at) / 1e6
                strokes = sorted(at for name, at in planned.items() if name.endswith(":stroke"))
                timers = [asyncio.create_task(wait(moment)) for moment in planned.values()]
            case m.CommandMark(sort="sync", text=name) if name:
                late[POINTS].append(message.t / 1e3 - planned[name] * 1e3)
            case m.CommandMark(sort="word", text=word) if f"s:{word}" in planned:
                late[SPOKEN].append(message.t / 1e3 - planned[f"s:{word}"] * 1e3)
            case m.CommandMark(sort="stroke"):
                late[STROKES].append(message.t / 1e3 - strokes.pop(0) * 1e3)
            case m.End() if message.command == run.id:
                break
    await run
    await asyncio.gather(*timers)


@contextlib.asynccontextmanager
async def robot(it: Bench, name: str) -> AsyncIterator[WozClient]:
    """A session with this robot, with its connection."""
    file = it.folder / f"{name}.yaml"
    await asyncio.to_thread(
        file.write_text,
        f"title: Bench\nrobot: {ROOT / 'experiments' / 'robots' / name}.yaml\n"
        "panels: [{title: A, actions: [{key: a, label: Hello, say: hello}]}]\n",
    )
    command = ("-m", "woz_tui", "host", str(file), *it.options(), "--announce")
    with program(*command, ready="socket", environ=it.environ()):
        async with connect(it.environ()["WOZ_SOCKET"], name="planner") as client:
            await asyncio.sleep(1.0)  # its drivers are connected
            yield client


async def measured(name: str, blocks: int, words: int) -> Late:
    """All that was late on one robot."""
    late: Late = {key: [] for key in (FLOOR, POINTS, SPOKEN, STROKES)}
    with bench() as it:
        async with robot(it, name) as client:
            await played(client, block(0, 3), {key: [] for key in late})  # not counted: warm
            for number in range(1, blocks + 1):
                await asyncio.sleep(PAUSE_S)
                await played(client, block(number, words), late)
    return late


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--blocks", type=int, default=40, help="on each robot")
    parser.add_argument("--quick", action="store_true", help="only to see that it works")
    arguments = parser.parse_args()
    blocks, words = (1, 3) if arguments.quick else (arguments.blocks, len(WORDS))
    for name, title in ROBOTS.items():
        late = asyncio.run(measured(name, blocks, words))
        floor = Spread.of(late[FLOOR])
        rows = []
        for what, values in late.items():
            spread = Spread.of(values)
            figures = [f"{each:.2f}" for each in (spread.p50, spread.p99, spread.worst)]
            beyond = "" if what == FLOOR else f"{spread.p99 - floor.p99:+.2f}"
            rows.append([what, str(spread.count), *figures, beyond])
        head = ("behind the plan", "count", "p50 ms", "p99 ms", "worst ms", "p99 - floor ms")
        table(f"Blocks of BML on {title}", head, rows)
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
