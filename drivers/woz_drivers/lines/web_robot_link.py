"""A robot behind a WebSocket: one in the network, or a simulated one in a process of its own."""

from __future__ import annotations

import abc
from typing import Any

from woz_drivers.lines.web_socket_line import WebPlace, WebSocketLine
from woz_drivers.programs.simulated_process import SimulatedProcess
from woz_tui.drivers.contract import DeviceLostError, DriverContext


class WebRobotLink(abc.ABC):
    """The link of a robot of parts (a `RobotLink`).

    A robot's own makes it ready, understands what it says, and ends what is under way when it is
    gone.

    Args:
        context: The driver's.
        shown: What the robot is called in sentences.
        simulated: The process that is the robot where there is no `place`.
        place: `host:port` of the robot; empty: the simulated one.
        path: Where its WebSocket is; begins with a slash.
    """

    def __init__(
        self,
        context: DriverContext,
        shown: str,
        simulated: SimulatedProcess,
        place: str = "",
        path: str = "/",
    ) -> None:
        self.shown = shown
        self._context = context
        self._simulated = simulated
        self._place = place
        self._path = path
        self._line = WebSocketLine(
            context,
            shown,
            self._find,
            get_ready=self._get_ready,
            on_message=self._take,
            on_lost=self._lost,
        )

    @property
    def ready(self) -> bool:
        """Whether the robot is connected, and was made ready."""
        return self._line.ready

    def need(self) -> None:
        """Raise `DeviceLostError` with the present reason unless the robot is `ready`."""
        self._line.need()
        if not self.ready:
            raise DeviceLostError(f"{self.shown} is not ready yet", "wait until it is")

    def start(self) -> None:
        """Begin to look for the robot."""
        self._line.start()

    async def close(self) -> None:
        """Let go of the robot; a simulated one ends."""
        await self._line.close()
        await self._simulated.close()

    async def _find(self) -> WebPlace:
        return WebPlace(await self._simulated.find_place(self._place), self._path)

    @abc.abstractmethod
    async def _get_ready(self) -> str:
        """Make the robot ready after an opening; returns what is shown of it.

        Raises `DriverError` where it cannot be made ready: then it is lost for that reason.
        """

    @abc.abstractmethod
    def _take(self, message: Any) -> None:
        """A message of the robot. Raises `ValueError` for what makes no sense."""

    @abc.abstractmethod
    def _lost(self, error: DeviceLostError) -> None:
        """The robot is gone; once for each opening that ended, before the next one."""
