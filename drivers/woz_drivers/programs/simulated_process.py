"""The robot of the address `simulated`: a program of ours that speaks the robot's protocol."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from woz_drivers.lines.network_address import host_and_port, joined
from woz_drivers.programs import child_process
from woz_drivers.programs.child_process import Child
from woz_tui.drivers.contract import DeviceLostError, DriverError

#: Stands in a robot file where a robot's address stands otherwise.
SIMULATED = "simulated"
#: Until it must have said where it listens, in seconds: Python starts slowly on a busy machine.
_STARTS_WITHIN_S = 20.0
#: One that runs, but cannot be reached for so long, is started anew, in seconds. Whoever rehearses
#: a frozen robot has this much time.
_HOPELESS_S = 20.0
#: Attempts that lie farther apart than this belong to different losses, in seconds.
_APART_S = 10.0


def robot_place(address: str, usual_port: int, examples: str) -> str:
    """`host:port` of the robot with this address; empty for the simulated one.

    Raises `RejectedError` with what is wrong, and `examples` as its remedy.
    """
    written = address.strip()
    if written.lower() == SIMULATED:
        return ""
    return joined(*host_and_port(written, usual_port, examples))


class SimulatedProcess:
    """Runs `python -m MODULE --port 0 OPTION...`, whose first line is `{"address": "..."}`.

    Started when it is first needed, and again when it has ended, until `close`.
    """

    def __init__(self, module: str, options: Sequence[str], folder: Path) -> None:
        self._module = module
        self._options = options
        self._folder = folder
        self._child: Child | None = None
        self._address = ""
        #: Loop time of the first and of the last attempt to reach it since it was there.
        self._first = self._last = 0.0

    async def address(self) -> str:
        """Where it listens; call it before each attempt to connect. Raises `DeviceLostError` if it
        does not start.
        """
        if self._child is not None and self._child.running and not self._hopeless():
            return self._address
        await self.close()
        self._first = self._last = asyncio.get_running_loop().time()
        line: asyncio.Future[bytes] = asyncio.get_running_loop().create_future()
        running = await self._start(line)
        self._child = running
        try:
            self._address = await self._read_address(running, line)
        except BaseException:
            await self.close()
            raise
        return self._address

    async def find_place(self, place: str) -> str:
        """`place` as `robot_place` gives it, or where this one listens. Raises as `address`."""
        return place or await self.address()

    def _hopeless(self) -> bool:
        """Whether attempt follows attempt for so long that it will not come back by itself."""
        now = asyncio.get_running_loop().time()
        if now - self._last > _APART_S:
            self._first = now
        self._last = now
        return now - self._first > _HOPELESS_S

    async def close(self) -> None:
        """End it and what it started."""
        ended, self._child = self._child, None
        if ended is not None:
            await ended.end()

    async def _start(self, line: asyncio.Future[bytes]) -> Child:
        output = b""

        def collect(data: bytes) -> None:
            nonlocal output
            if line.done():
                return
            output += data
            if b"\n" in output:
                line.set_result(output.partition(b"\n")[0])

        # -P: no modules of the folder of the experiment.
        words = (sys.executable, "-P", "-m", self._module, "--port", "0", *self._options)
        try:
            return await child_process.start(words, self._folder, on_output=collect)
        except DriverError as error:
            raise DeviceLostError(f"the simulated robot: {error.what}", error.remedy) from error

    async def _read_address(self, running: Child, line: asyncio.Future[bytes]) -> str:
        """The address in its first line. Raises `DeviceLostError`."""
        remedy = f"start `python -m {self._module}` yourself to see what is wrong"
        ending = asyncio.create_task(running.wait())
        ending.add_done_callback(lambda _: line.cancel())
        try:
            await asyncio.wait([line], timeout=_STARTS_WITHIN_S)
        finally:
            ending.cancel()
        if not line.done() or line.cancelled():
            reason = running.last_words or "it says nothing"
            raise DeviceLostError(f"the simulated robot does not start: {reason}", remedy)
        try:
            return str(json.loads(line.result())["address"])
        except (ValueError, KeyError, TypeError):
            output = line.result().decode("utf-8", "replace")[:100]
            raise DeviceLostError(
                f"the simulated robot says no address, but {output!r}", remedy
            ) from None
