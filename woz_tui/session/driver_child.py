"""The process of drivers that have one of their own (`network.driver_process`)."""

from __future__ import annotations

import contextlib
import pickle
import sys
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.bus.driver_call import DriverCall, guarded
from woz_tui.drivers.contract import Driver, Health, HealthStatement
from woz_tui.machine.scheduling import ask_for_short_turns
from woz_tui.network.child_line import ParentLine, serve_parent
from woz_tui.network.driver_line import LineError
from woz_tui.network.driver_process import PLACE, ProcessSetup
from woz_tui.network.driver_server import DriverServer
from woz_tui.protocol.messages import DriverFaulted, Notice
from woz_tui.session.driver_faults import DriverFaults
from woz_tui.system.clock import RealClock


class _Session:
    """Is told of errors that nobody waits for, through the driver that they are of."""

    def __init__(self, drivers: Mapping[str, Driver]) -> None:
        self._drivers = drivers

    def publish(self, message: DriverFaulted | Notice) -> None:
        """What is of several drivers all of them say."""
        if isinstance(message, Notice):
            for each in self._drivers.values():
                each.context.notice(
                    message.level, message.text, message.remedy, tells=(*message.tells,)
                )
        elif (driver := self._drivers.get(message.driver)) is not None:
            driver.context.publish(
                HealthStatement(
                    Health.FAULTED, message.detail, message.remedy, tells=(*message.tells,)
                )
            )


async def _guard(call: Callable[[], Awaitable[Any]], driver: str, what: str) -> Any:
    """What the call begins beside itself is known as the driver's."""
    return await guarded(call, DriverCall(driver, what))


def _tell(text: str) -> None:
    """Into the robot process's log."""
    with contextlib.suppress(OSError):  # it is gone
        sys.stderr.write(f"{text}\n")


async def _serve(setup: bytes, parent: ParentLine) -> None:
    told = msgspec.msgpack.decode(setup, type=ProcessSetup)
    try:
        offers = pickle.loads(told.offers)
    except Exception as error:
        raise LineError(f"it cannot be loaded: {type(error).__name__}: {error}") from error
    server = DriverServer(
        *(PLACE, offers),
        folder=Path(told.folder),
        tell=_tell,
        silence_s=told.silence_s,
        beside_session=True,
        guard=_guard,
    )
    faults = DriverFaults(_Session(server.made), RealClock())
    faults.begin(server.made)
    ask_for_short_turns()
    parent.begun()
    await server.run(parent)


if __name__ == "__main__":
    serve_parent(_serve, ParentLine)
