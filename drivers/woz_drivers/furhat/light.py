"""The ring of LEDs at a Furhat's neck: `eyes` colours it, since its eyes are drawn."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping

from woz_drivers.furhat.link import FurhatLink, FurhatPart
from woz_drivers.furhat.settings import SETTINGS, FurhatSettings
from woz_tui.drivers.argument_values import color, word
from woz_tui.drivers.contract import DeviceLostError, DriverContext, Job, Offer, Scope
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import EYE_ANIMATIONS
from woz_tui.protocol.messages import Json

#: Seconds between two blinks of the lids, and of each half of a light that comes and goes.
_OPEN_S, _HALF_S = 3.5, 0.6


class FurhatLight(FurhatPart):
    """One colour for the whole ring."""

    SETTINGS = (SETTINGS["eyes"],)

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._color = color({"color": settings.led}, "color") if settings.led else ""
        self._animation = "steady"
        self._loop = self.background("the light")

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """`eyes`."""
        return Offer(
            verbs=(SETTINGS["eyes"].changed_by("colour the LED ring", lane="light", limit_s=5.0),)
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Show the colour at once."""
        shown = color(job.args, "color")
        animation = word(
            {"animation": job.args.get("animation", "steady")}, "animation", EYE_ANIMATIONS
        )
        self._loop.cancel()
        await self._link.send("request.led.set", color=shown)
        self._color, self._animation = shown, animation
        self._begin_loop()
        return {"color": shown, "animation": animation}

    def hold(self, scope: Scope) -> None:
        """It comes and goes no more, also when the robot is back."""
        self._loop.cancel()
        self._animation = "steady"

    async def halt(self, scope: Scope) -> Pending:
        """The light stays, also one that was just dark."""
        if self._color:
            await self._link.send("request.led.set", color=self._color)
        return []

    async def connected(self) -> None:
        """Show what was asked for last."""
        if self._color:
            await self._link.send("request.led.set", color=self._color)
            self._begin_loop()

    def lost(self) -> None:
        """Nothing blinks until it is back."""
        self._loop.cancel()

    def shown(self) -> Mapping[str, Json]:
        """The colour, if one was asked for."""
        return {"eyes": self._color} if self._color else {}

    def _begin_loop(self) -> None:
        self._loop.cancel()
        if self._animation != "steady":
            self._loop.start(self._repeat())

    async def _repeat(self) -> None:
        with contextlib.suppress(DeviceLostError):  # it begins anew when the robot is back
            while True:
                if self._animation == "blink":
                    await asyncio.sleep(_OPEN_S)
                    await self._link.send("request.gesture.start", name="Blink")
                else:
                    for shown in ("#000000", self._color):
                        await asyncio.sleep(_HALF_S)
                        await self._link.send("request.led.set", color=shown)
