"""The simulated robot, served by a process of its own until it is killed.

python -m tests.network.other_program PORT
"""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

from woz_drivers.simulated import SimulatedRobot

from tests.network.other_computer import OtherComputer


async def serve(port: int) -> None:
    """For as long as the process lives."""
    other = OtherComputer(SimulatedRobot, SimulatedRobot.Settings(), Path())
    await other.start(f"tcp://127.0.0.1:{port}")
    await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(serve(int(sys.argv[1])))
