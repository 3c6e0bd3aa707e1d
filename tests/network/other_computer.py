"""A driver at another computer: the session's side here, the served side behind a cable."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.remote.network import Cable
from woz_tui.drivers.contract import Driver
from woz_tui.network.driver_line import DriverLine, DriverRouter, connect
from woz_tui.network.driver_server import DriverServer, OfferedDriver
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.testing import RecordingContext

#: A process of a busy machine may be silent for longer than the second of a real one.
SILENCE_S = 3.0
PLACE = "arm-pi"


async def free_port() -> int:
    """One that nobody listens at."""
    server = await asyncio.start_server(lambda *_: None, "127.0.0.1", 0)
    port: int = server.sockets[0].getsockname()[1]
    server.close()
    await server.wait_closed()
    return port


@dataclass
class OtherComputer:
    """Serves one driver; what it says to whoever looks at it is in `lines`."""

    driver: type[Driver]
    settings: Any
    folder: Path
    type: str = "simulated"
    name: str = "arm"
    silence_s: float = SILENCE_S
    lines: list[str] = field(default_factory=list)
    _task: asyncio.Task[None] | None = None
    _line: DriverLine | None = None

    async def start(self, port: int) -> None:
        """Connect to the session through this port."""
        self._line = await asyncio.to_thread(
            connect, f"tcp://127.0.0.1:{port}", None, self.silence_s
        )
        offer = OfferedDriver(self.name, self.type, self.driver, self.settings)
        server = DriverServer(
            PLACE, [offer], folder=self.folder, tell=self.lines.append, silence_s=self.silence_s
        )
        self._task = asyncio.create_task(server.run(self._line))

    async def end(self) -> None:
        """As ctrl+c does."""
        if self._task is not None and self._line is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            await asyncio.to_thread(self._line.close)
            self._task = None


@dataclass
class Pair:
    """Both sides."""

    remote: RemoteDriver
    context: RecordingContext
    other: OtherComputer
    cable: Cable


@contextlib.asynccontextmanager
async def pair(
    driver: type[Driver], settings: Any, folder: Path, *, served: Any = None, **changed: Any
) -> AsyncIterator[Pair]:
    """A driver of this session, opened, and the other computer that serves it with the settings
    `served`, which are the same by themselves.
    """
    port = await free_port()
    router = DriverRouter(f"tcp://127.0.0.1:{port}", [PLACE], silence_s=SILENCE_S)
    context, cable = RecordingContext(folder), Cable(port)
    remote = RemoteDriver(
        *("arm", settings, context),
        local=driver,
        kind="simulated",
        router=router,
        place=PLACE,
    )
    other = OtherComputer(driver, served or settings, folder, **changed)
    await remote.open()
    while remote._line is None:
        await asyncio.sleep(0.01)
    await cable.lay()
    try:
        await other.start(cable.own_port)
        yield Pair(remote, context, other, cable)
    finally:
        await remote.close()
        await other.end()
        await cable.cut()
