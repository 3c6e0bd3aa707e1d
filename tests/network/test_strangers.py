"""Who comes to the port of other computers without a certificate, and what that costs them."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.fakes.ports import free_port
from tests.network.other_computer import (
    PLACE,
    SILENCE_S,
    Arm,
    ArmSettings,
    OtherComputer,
    listens,
    remote_driver,
)
from woz_tui.drivers.contract import Health
from woz_tui.network.certificates import AccessFile, Authority
from woz_tui.network.child_line import ChildLine
from woz_tui.network.driver_router import DriverRouter
from woz_tui.network.front_port import MOST
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.testing import PlainJob, RecordingContext, until

#: The beginning of a handshake that goes wrong.
NONSENSE = b"\x16\x03\x01\x00\x05hello"

pytestmark = pytest.mark.usefixtures("patient_network")


@dataclass
class Listening:
    """A session that waits for its computer."""

    port: int
    access: AccessFile
    remote: RemoteDriver
    context: RecordingContext
    router: DriverRouter
    other: OtherComputer

    async def come(self) -> None:
        """Its computer does."""
        await self.other.start(f"127.0.0.1:{self.port}", self.access)
        await until(lambda: self.context.healths[-1][0] is Health.CONNECTED, 20)

    def stranger(self) -> socket.socket:
        """A connection without a certificate."""
        return socket.create_connection(("127.0.0.1", self.port), 20)


@contextlib.asynccontextmanager
async def listening(folder: Path) -> AsyncIterator[Listening]:
    authority, port, context = Authority(folder / "authority"), free_port(), RecordingContext()
    authority.new(PLACE, 30, "", folder / "arm.access")
    router = DriverRouter(f"127.0.0.1:{port}", [PLACE], authority, SILENCE_S)
    remote = remote_driver(context, router)
    other = OtherComputer(Arm, ArmSettings(), folder)
    await remote.open()
    try:
        await until(lambda: listens(port), 20)
        access = AccessFile.read(folder / "arm.access")
        yield Listening(port, access, remote, context, router, other)
    finally:
        await remote.close()
        await other.end()


@pytest.mark.real_clock
@pytest.mark.parametrize("said", [b"", NONSENSE])
async def test_hundreds_that_come_and_go_keep_no_computer_out(tmp_path: Path, said: bytes) -> None:
    """Zenoh's own listener would look at ten of them in a second."""
    async with listening(tmp_path) as here:
        for _ in range(300):
            with here.stranger() as stranger:
                stranger.sendall(said)
        await here.come()
        assert await here.remote.perform(PlainJob("wave")) == {"waved": 1}


@pytest.mark.real_clock
@pytest.mark.safety
async def test_who_stays_and_says_nothing_makes_room_for_others(tmp_path: Path) -> None:
    async with listening(tmp_path) as here:
        await here.come()
        with contextlib.ExitStack() as held:
            strangers = [held.enter_context(here.stranger()) for _ in range(2 * MOST)]
            assert await asyncio.to_thread(strangers[0].recv, 1) == b""
            line = await here.router.join(PLACE)
            assert isinstance(line, ChildLine)
            descriptors = Path(f"/proc/{line.pid}/fd")
            # What makes room is closed in the next turn of its loop, not in the one that accepts.
            await until(lambda: len([*descriptors.iterdir()]) < 2 * MOST, 20)
            assert await here.remote.perform(PlainJob("wave")) == {"waved": 1}
            assert here.context.healths[-1][0] is Health.CONNECTED
            await here.router.leave()
