"""A command whose bytes are wanted all the time: how long it may be silent."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from woz_drivers.byte_stream import ByteStream, StreamCommand, StreamListener

from tests.drivers.heard import until
from tests.fakes.piped_command import PipedCommand
from woz_tui.drivers.contract import DriverError
from woz_tui.system.clock import ManualClock

#: Bytes that make a beginning.
LEAST = 8


@dataclass
class Stand:
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
async def stand(tmp_path: Path) -> AsyncIterator[Stand]:
    pipe, clock = PipedCommand(tmp_path / "pipe"), ManualClock()
    command = StreamCommand(pipe.command, tmp_path, "no milk", "feed the cow", LEAST)
    output, silences, ends = bytearray(), list[str](), list[DriverError]()
    listener = StreamListener(lambda: None, output.extend, silences.append, ends.append)
    made = Stand(ByteStream(command, clock, listener), pipe, clock, output, silences, ends)
    made.stream.start()
    yield made
    await made.stream.close()


async def test_until_it_has_begun_to_deliver_it_may_be_silent_for_long(stand: Stand) -> None:
    await stand.send(b"x" * (LEAST - 1))
    stand.clock.advance(19)
    await until(lambda: bool(stand.silences))
    assert stand.silences[0] == "cat delivers no milk"
    assert stand.ends == []
    stand.clock.advance(2)
    await until(lambda: bool(stand.ends))
    assert (stand.ends[0].what, stand.ends[0].remedy) == (
        "cat ran, but delivered no milk",
        "feed the cow",
    )


async def test_once_it_delivers_it_is_soon_given_up(stand: Stand) -> None:
    await stand.send(b"x" * LEAST)
    assert stand.stream.running
    stand.clock.advance(6)
    await until(lambda: bool(stand.ends))
    assert stand.silences == []
    assert not stand.stream.running


async def test_silence_counts_from_a_hold(stand: Stand) -> None:
    await stand.send(b"x" * LEAST)
    stand.clock.advance(4)
    stand.stream.hold(False)
    stand.clock.advance(4)
    stand.silences.clear()
    await until(lambda: bool(stand.silences))
    assert stand.ends == []
    assert stand.stream.lasted_us == 4_000_000
