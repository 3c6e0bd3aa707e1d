"""The process of drivers that have one of their own (`network.driver_process`)."""

from __future__ import annotations

import contextlib
import pickle
import sys
from pathlib import Path

import msgspec

from woz_tui.machine.scheduling import ask_for_short_turns
from woz_tui.network.child_line import ParentLine, serve_parent
from woz_tui.network.driver_line import LineError
from woz_tui.network.driver_process import PLACE, ProcessSetup
from woz_tui.network.driver_server import DriverServer
from woz_tui.session.driver_faults import tell_faults


def _tell(text: str) -> None:
    """Into the robot process's log."""
    with contextlib.suppress(OSError):  # it is gone
        sys.stderr.write(f"{text}\n")


async def _serve(encoded: bytes, parent: ParentLine) -> None:
    setup = msgspec.msgpack.decode(encoded, type=ProcessSetup)
    try:
        offers = pickle.loads(setup.offers)
    except Exception as error:
        raise LineError(f"it cannot be loaded: {type(error).__name__}: {error}") from error
    server = DriverServer(
        *(PLACE, offers),
        folder=Path(setup.folder),
        tell=_tell,
        silence_s=setup.silence_s,
        beside_session=True,
    )
    tell_faults(server.made)
    ask_for_short_turns()
    parent.begun()
    await server.run(parent)


if __name__ == "__main__":
    serve_parent(_serve, ParentLine)
