"""The robot's front microphone, sent to this machine and kept as a file."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Mapping
from typing import Any

from woz_drivers.pepper.audio_client import Block, SoundFile, block
from woz_drivers.pepper.camera_files import stamp
from woz_drivers.pepper.link import Unsubscribe
from woz_drivers.pepper.parts import Robot
from woz_drivers.pepper.parts_calls import Endings
from woz_tui.core.driver import DriverError, Outlet
from woz_tui.core.messages import Json

#: How the service of ours begins that the robot sends its sound to. Each has a name of its own: a
#: robot that was cut off holds on to those of before for a while.
SERVICE = "WozTuiMicrophones"
_HEARD_HZ = 48000
#: ALAudioDevice's number for the front microphone, and for samples channel by channel: no.
_FRONT, _NOT_DEINTERLEAVED = 3, 0
#: Sound has to come within this, in seconds.
_PATIENCE_S = 3.0
_FAREWELL_S = 0.5


class Listening:
    """The front microphone's sound on its way into one file in the media folder."""

    def __init__(self, robot: Robot, outlet: Outlet) -> None:
        self._robot = robot
        self._outlet = outlet
        self._path = outlet.media / f"robot-{stamp(outlet.clock.wall())}.wav"
        #: The file as results and messages name it.
        self.file = f"{outlet.media.name}/{self._path.name}"
        self._service = f"{SERVICE}_{secrets.token_hex(4)}"
        self._sound: SoundFile | None = None
        self._first: asyncio.Future[Block] = asyncio.get_running_loop().create_future()
        self._t_us = 0
        self._bad = 0
        self._over = False
        self._withdraw: Unsubscribe | None = None
        self._endings = Endings()

    async def begin(self) -> Mapping[str, Json]:
        """Return when the first sound has come; `t` is the moment of its first sample.

        Raises `DriverError` if none comes.
        """
        self._withdraw = await self._robot.serve(
            self._service, {"processRemote": ("(iimr)", self._heard)}
        )
        try:
            await self._robot.call(
                *("ALAudioDevice", "setClientPreferences"),
                *(self._service, _HEARD_HZ, _FRONT, _NOT_DEINTERLEAVED),
            )
            await self._robot.call("ALAudioDevice", "subscribe", self._service)
            async with asyncio.timeout(_PATIENCE_S):
                first = await asyncio.shield(self._first)
        except TimeoutError:
            raise DriverError(
                f"no sound came within {_PATIENCE_S:g} s", "record_sound works on the robot itself"
            ) from None
        return {**self._told(), "channels": first.channels, "robot_time": first.robot_s}

    def _told(self) -> dict[str, Json]:
        return {"file": self.file, "t": self._outlet.t(self._t_us), "rate": _HEARD_HZ}

    def _heard(self, channels: Any, samples: Any, stamp_: Any, buffer: Any) -> None:
        """What the robot calls for each buffer."""
        came = block(channels, samples, stamp_, buffer)
        if self._over:
            return
        if isinstance(came, str) or (self._sound and came.channels != self._sound.channels):
            self._bad += 1
            if self._bad == 1:
                why = came if isinstance(came, str) else f"{came.channels} channels of a sudden"
                self._outlet.notice("warning", f"a part of the robot's sound is missing: {why}")
            return
        if self._sound is None:
            lasted_us = came.samples * 1_000_000 // _HEARD_HZ
            self._t_us = self._outlet.clock.now_us() - lasted_us
            self._sound = SoundFile(self._path, _HEARD_HZ, came.channels, self._failed)
            self._sound.begin()
            self._first.set_result(came)
        self._sound.put(came.data)

    def _failed(self, why: str) -> None:
        text = f"the robot's sound is not kept any more, {self.file}: {why}"
        self._outlet.notice("error", text, "look at the disk, then play listen off and on")

    async def end(self) -> Mapping[str, Json]:
        """Return when the file is whole. Raises `DriverError` if something of it is missing."""
        await self._leave()
        if self._sound is None:
            return {"file": ""}
        written = await self._sound.finish()
        if written.trouble:
            raise DriverError(
                f"{self.file} ends too early, after {written.frames / _HEARD_HZ:.1f} s:"
                f" {written.trouble}",
                "look at the disk",
            )
        seconds = round(written.frames / _HEARD_HZ, 3)
        return {**self._told(), "seconds": seconds, "missing": self._bad}

    async def _leave(self) -> None:
        """Have the robot send nothing more; the service here is gone in any case."""
        self._over = True
        self._endings.send(self._withdrawn())
        await self._endings.settled()
        await self._endings.close()

    def abandon(self) -> None:
        """End it without waiting: what came is in the file."""
        self._over = True
        self._endings.send(self._withdrawn())
        if self._sound is not None:
            self._sound.end()

    async def close(self) -> None:
        """Return when nothing of it is under way any more."""
        await self._endings.settled()
        await self._endings.close()
        if self._sound is not None:
            await self._sound.finish()

    async def _withdrawn(self) -> None:
        with contextlib.suppress(DriverError):  # it is not there, and sends nothing then
            await self._robot.call(
                "ALAudioDevice", "unsubscribe", self._service, within=_FAREWELL_S
            )
        withdraw, self._withdraw = self._withdraw, None
        if withdraw is not None:
            await withdraw()
