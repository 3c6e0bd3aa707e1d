"""How late live sound is, and whether a stop comes later beside it.

    python benchmarks/live_sound.py [--seconds 20] [--quick]

Blocks of 20 ms carry the time at which they were written. *heard*: from the program that stands for
the microphone to what reads behind `woz listen`. *spoken*: from what writes into `woz talk` to what
stands for the player. *stop*: from the request on a socket to its answer, alone, and beside two who
listen and one who talks.
"""

from __future__ import annotations

import argparse
import asyncio
import base64
import contextlib
import json
import struct
import sys
import tempfile
import time
from asyncio.subprocess import DEVNULL, PIPE
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from benchmarks.figures import Spread, machine, table

RATE, BLOCK_S = 16_000, 0.02
BYTES = 640
_STAMP = struct.Struct("<q")

#: Writes blocks with the time in them, as fast as they are spoken.
MICROPHONE = f"""
import struct, sys, time
begun, count = time.monotonic(), 0
while True:
    sys.stdout.buffer.write(struct.pack("<q", time.monotonic_ns() // 1000) * {BYTES // 8})
    sys.stdout.buffer.flush()
    count += 1
    time.sleep(max(0.0, begun + count * {BLOCK_S} - time.monotonic()))
"""
#: Notes how old each block is that it gets.
PLAYER = f"""
import struct, sys, time
with open(sys.argv[1], "a", buffering=1) as notes:
    while len(block := sys.stdin.buffer.read({BYTES})) == {BYTES}:
        notes.write(f"{{time.monotonic_ns() // 1000 - struct.unpack_from('<q', block)[0]}}\\n")
"""


def stamped() -> bytes:
    """A block that says when it was made."""
    return _STAMP.pack(time.monotonic_ns() // 1000) * (BYTES // 8)


def age_ms(block: bytes) -> float:
    """How old a block is."""
    return float(time.monotonic_ns() // 1000 - _STAMP.unpack_from(block)[0]) / 1000


class Line:
    """A client of the session's socket."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer, self._ref = reader, writer, 0

    @classmethod
    async def opened(cls, path: str, role: str) -> Line:
        """It has been welcomed."""
        line = cls(*await asyncio.open_unix_connection(path, limit=1 << 22))
        line._write(kind="hello", role=role, stream="nothing")
        while (await line._read())["kind"] != "welcome":
            pass
        return line

    async def ask(self, kind: str, **fields: Any) -> dict[str, Any]:
        """The answer."""
        self._ref += 1
        self._write(kind=kind, ref=self._ref, **fields)
        while (answer := await self._read()).get("ref") != self._ref:
            pass
        return answer

    def beat(self) -> None:
        """The wizard is there."""
        self._write(kind="beat")

    def _write(self, **fields: Any) -> None:
        self._writer.write(json.dumps(fields).encode() + b"\n")

    async def _read(self) -> dict[str, Any]:
        answer: dict[str, Any] = json.loads(await self._reader.readline())
        return answer


@contextlib.asynccontextmanager
async def session(folder: Path, notes: Path) -> AsyncIterator[str]:
    """A robot process with a microphone and a loudspeaker made of programs; its socket."""
    file = folder / "live.yaml"
    drivers = {
        "ears": {"type": "microphone", "command": [sys.executable, "-S", "-c", MICROPHONE]},
        "voice": {
            "type": "speech",
            "synthesise": "true {wav}",
            "play": "true {wav}",
            "talk": {"play": [sys.executable, "-S", "-c", PLAYER, str(notes)]},
        },
    }
    actions = [{"key": "t", "label": "Talk", "talk": {}}]
    file.write_text(
        json.dumps(
            {
                "title": "Live sound",
                "robot": {"drivers": drivers},
                "panels": [{"title": "Live", "actions": actions}],
            }
        )
    )
    running = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "woz_tui", "host", str(file), "--announce"),
        *("--recordings", str(folder / "recordings"), "--name", f"live-{time.time_ns()}"),
        stdout=PIPE,
        stdin=DEVNULL,
    )
    assert running.stdout is not None
    try:
        yield json.loads(await running.stdout.readline())["socket"]
    finally:
        running.terminate()
        await running.wait()


async def heard(path: str, seconds: float) -> list[float]:
    """Ages behind `woz listen`, in ms, for so long after the first block has come."""
    running = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "woz_tui", "listen", path, "--format", "raw"),
        stdout=PIPE,
        stderr=DEVNULL,
    )
    assert running.stdout is not None
    ages = [age_ms(await running.stdout.readexactly(BYTES))]
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        ages.append(age_ms(await running.stdout.readexactly(BYTES)))
    running.kill()
    await running.wait()
    return ages


async def spoken(path: str, seconds: float, notes: Path) -> list[float]:
    """Ages at the player, in ms, for so long after the first block has come."""
    running = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "woz_tui", "talk", path), stdin=PIPE, stderr=DEVNULL
    )
    assert running.stdin is not None
    wizard = await Line.opened(path, "wizard")
    await wizard.ask("action", action="Talk", source="key")
    begun, count = time.monotonic(), 0
    until = float("inf")
    while (now := time.monotonic()) < until:
        if until == float("inf") and (await asyncio.to_thread(notes.stat)).st_size:
            until = now + seconds
        running.stdin.write(stamped())
        count += 1
        if count % 25 == 0:
            wizard.beat()
        await asyncio.sleep(max(0.0, begun + count * BLOCK_S - time.monotonic()))
    running.kill()
    await running.wait()
    noted = await asyncio.to_thread(notes.read_text)
    return [int(line) / 1000 for line in noted.split()]


async def stops(path: str, presses: int, *, beside: bool) -> list[float]:
    """Milliseconds from a stop to its answer."""
    line = await Line.opened(path, "program")
    others: list[asyncio.Task[None]] = []
    if beside:
        others = [asyncio.ensure_future(_listen(path)) for _ in range(2)]
        others.append(asyncio.ensure_future(_talk(path)))
        await asyncio.sleep(0.5)
    took = []
    for _ in range(presses):
        began = time.perf_counter()
        await line.ask("stop")
        took.append((time.perf_counter() - began) * 1000)
        await line.ask("release")
        await asyncio.sleep(0.03)
    for other in others:
        other.cancel()
    await asyncio.gather(*others, return_exceptions=True)
    return took


async def _listen(path: str) -> None:
    line, end = await Line.opened(path, "watcher"), 0
    while True:
        end = (await line.ask("sound", after=end)).get("end", end)


async def _talk(path: str) -> None:
    line = await Line.opened(path, "program")
    data = base64.b64encode(bytes(BYTES)).decode()
    while True:
        await line.ask("talk", rate=RATE, data=data)
        await asyncio.sleep(BLOCK_S)


async def measured(seconds: float, presses: int) -> None:
    """Measure, and print the tables."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        notes = folder / "notes"
        notes.touch()
        async with session(folder, notes) as path:
            await asyncio.sleep(1.0)
            late = {
                "heard: microphone to standard output": await heard(path, seconds),
                "spoken: standard input to player": await spoken(path, seconds, notes),
            }
            took: dict[str, list[float]] = {"stop alone": [], "stop beside live sound": []}
            for _ in range(4):  # in turns: the machine is not equally busy all the time
                for name, all_of in took.items():
                    all_of.extend(await stops(path, presses, beside="beside" in name))
    rows = [(name, Spread.of(values)) for name, values in {**late, **took}.items()]
    table(
        "milliseconds",
        ("", "count", "p50", "p99", "worst"),
        [
            (name, str(it.count), f"{it.p50:.1f}", f"{it.p99:.1f}", f"{it.worst:.1f}")
            for name, it in rows
        ],
    )
    print(f"\n{machine()}")


def main() -> None:
    """Read the options."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--presses", type=int, default=50, help="in each of four turns")
    parser.add_argument("--quick", action="store_true", help="just see that it runs")
    options = parser.parse_args()
    quick = options.quick
    asyncio.run(measured(0.5 if quick else options.seconds, 2 if quick else options.presses))


if __name__ == "__main__":
    main()
