"""A command whose bytes are wanted all the time: how long it may be silent."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from woz_drivers.programs.byte_stream import ByteStream, StreamCommand, StreamListener

from tests.drivers.published_messages import until
from tests.fakes.piped_command import PipedCommand
from woz_tui.drivers.contract import DriverError
from woz_tui.system.clock import ManualClock

#: Bytes that make a beginning.
LEAST = 8


@dataclass
class StreamRig:
    """One stream out of a pipe, and what it told."""

    stream: ByteStream
    pipe: PipedCommand
    clock: ManualClock
    output: bytearray
    silences: list[str]
    ends: list[DriverError]

    async def send(self, data: bytes) -> None:
        """Deliver `data`; return when it has arrived."""
        await until(self.pipe.connected)
        wanted = len(self.output) + len(data)
        self.pipe.send(data)
        await until(lambda: len(self.output) == wanted)


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[StreamRig]:
    pipe, clock = PipedCommand(tmp_path / "pipe"), ManualClock()
    command = StreamCommand(pipe.command, tmp_path, "no milk", "feed the cow", LEAST)
    output, silences, ends = bytearray(), list[str](), list[DriverError]()
    listener = StreamListener(lambda: None, output.extend, silences.append, ends.append)
    stream_rig = StreamRig(
        ByteStream(command, clock, listener), pipe, clock, output, silences, ends
    )
    stream_rig.stream.start()
    yield stream_rig
    await stream_rig.stream.close()


async def test_until_it_has_begun_to_deliver_it_may_be_silent_for_long(rig: StreamRig) -> None:
    await rig.send(b"x" * (LEAST - 1))
    rig.clock.advance(19)
    await until(lambda: bool(rig.silences))
    assert rig.silences[0] == "cat delivers no milk"
    assert rig.ends == []
    rig.clock.advance(2)
    await until(lambda: bool(rig.ends))
    assert (rig.ends[0].what, rig.ends[0].remedy) == (
        "cat ran, but delivered no milk",
        "feed the cow",
    )


async def test_once_it_delivers_it_is_soon_given_up(rig: StreamRig) -> None:
    await rig.send(b"x" * LEAST)
    assert rig.stream.running
    rig.clock.advance(6)
    await until(lambda: bool(rig.ends))
    assert rig.silences == []
    assert not rig.stream.running


async def test_silence_counts_from_a_hold(rig: StreamRig) -> None:
    await rig.send(b"x" * LEAST)
    rig.clock.advance(4)
    rig.stream.hold(False)
    rig.clock.advance(4)
    rig.silences.clear()
    await until(lambda: bool(rig.silences))
    assert rig.ends == []
    assert rig.stream.lasted_us == 4_000_000
