"""The lights of the eyes: a colour, one that blinks or comes and goes, and three animations.

A brightness below 1 dims every colour that is shown. Blinking is done from here, so that it ends
at once with the next command and with the stop. The three animations are the robot's own; NAOqi
has no call that ends one, so they are asked for a second at a time: after a stop the colour of
before is set at once, and again when the second is over.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.robot_settings import SETTINGS
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import color as color_of
from woz_tui.drivers.argument_values import number, positive, word
from woz_tui.drivers.background import forget_outcome
from woz_tui.drivers.contract import (
    Argument,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending, RefusalAllowed
from woz_tui.drivers.robot_verbs import EYE_ANIMATIONS
from woz_tui.protocol.messages import Json

LEDS = "ALLeds"
GROUP, FIRST_LIGHT = "FaceLeds", "RightFaceLed1"
LANE = "face"
KINDS = ("rasta", "random", "rotate")
#: Blinking lids, in seconds: open, and closed.
OPEN_S, CLOSED_S = 3.5, 0.15
#: A light that comes and goes, in seconds: each of its two fades.
FADE_S = 0.6
#: One turn of the rotating light, and how long a colour takes that comes by itself: the file's on
#: connect, and that of before after an animation. As in WoZ4U's program.
TURN_S, COMES_S = 1.0, 0.5
#: With a voice that is made here they are so often another brightness, and never dimmer.
GLOW_S, DIMMEST = 0.1, 0.2
#: An animation is asked for in pieces so long: one turn of the rotating light.
SLICE_S = TURN_S
LONGEST = Range(0, 3600, "s")
#: A fade's call returns when the fade is over; it may take so much longer.
MARGIN_S = 5.0


class EyesPart(NaoqiPart):
    """Both eyes together."""

    name = "eyes"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: Shown last by command, undimmed; None: whatever the robot shows by itself.
        self._shown: EyeColor | None = None
        self._level = 1.0
        #: Held while a colour is on its way: the one of before a loss never covers a newer one.
        self._changing = asyncio.Lock()
        self._loop: asyncio.Task[None] | None = None
        self._animated = False

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """A colour, an animation, the brightness."""
        return Offer(
            verbs=(
                SETTINGS["eyes"].changed_by(
                    "",
                    Argument("seconds", "seconds", "fade to it", False, 0.0, LONGEST),
                    limit_s=60.0,
                ),
                Verb(
                    "eyes_animation",
                    "play an animation of the eyes; afterwards the previous colour returns",
                    (
                        Argument("kind", "choice", required=True, choices=KINDS),
                        Argument("seconds", "seconds", "how long", False, 3.0, LONGEST),
                        Argument("color", "text", "of the rotating light", False, "white"),
                    ),
                    lane=LANE,
                    limit_s=60.0,
                ),
                SETTINGS["eyes_brightness"].changed_by(
                    "dim the eyes", lane=LANE, limit_s=5.0, brief=True
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Show it; a fade and an animation take their time."""
        await self._cleaned_up()
        match job.verb:
            case "eyes":
                return await self._color(job)
            case "eyes_animation":
                return await self._animation(job)
            case "eyes_brightness":
                level = min(max(number(job.args, "level"), 0.0), 1.0)
                await self._dim(level)
                return {"level": level}
        return await super().perform(job)

    async def halt(self, scope: Scope) -> Pending:
        """Hold a steady light; nothing to do where nothing moves."""
        if not (self._loop or self._animated):
            return None
        await self._steady(await self._before(), 0.0)
        return ()

    async def connected(self) -> None:
        """Show what the robot file says; after a loss, what was shown."""
        self.lost()
        seconds = 0.0
        if self._settings.eyes and self._shown is None:
            self._shown = EyeColor.of(color_of({"color": self._settings.eyes}, "color"))
            seconds = COMES_S
        async with self._changing:
            if self._shown is None:
                return
            with RefusalAllowed(self._context, "the eyes stay as they are"):
                await self._fade(self._shown, seconds)

    def lost(self) -> None:
        """Blinking ends."""
        self._end_loop()
        self._animated = False

    async def read(self) -> Mapping[str, Json]:
        """The colour (undimmed where it is the one asked for) and the brightness, 0 to 1.

        While the light blinks or plays, both are those that it does so with.
        """
        if self._shown is not None and (self._loop or self._animated):
            return {"eyes": self._shown.text, "eyes_brightness": round(self._level, 3)}
        visible = EyeColor.read_back(await self._link.ask(LEDS, "getIntensity", FIRST_LIGHT))
        if visible is None:
            return {}
        if self._shown is not None and visible.close_to(self._shown.dimmed(self._level)):
            return {"eyes": self._shown.text, "eyes_brightness": round(self._level, 3)}
        return {"eyes": visible.text, "eyes_brightness": round(visible.brightness, 3)}

    async def close(self) -> None:
        """End what blinks; the light stays."""
        loop = self._loop
        self._end_loop()
        if loop is not None:
            await asyncio.wait([loop])
        await super().close()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """How long a fade or an animation takes."""
        default = 3.0 if verb == "eyes_animation" else 0.0
        known = verb in ("eyes", "eyes_animation")
        return Forecast(positive(args, "seconds", default), ()) if known else Forecast()

    # -- verbs -----------------------------------------------------------------------------------

    async def _color(self, job: Job) -> dict[str, Json]:
        shown = EyeColor.of(color_of(job.args, "color"))
        animation = word(
            {"animation": job.args.get("animation", "steady")}, "animation", EYE_ANIMATIONS
        )
        seconds = positive(job.args, "seconds", 0.0)
        job.expects(seconds)
        await self.show(shown, seconds)
        if animation != "steady":
            self._loop = asyncio.get_running_loop().create_task(
                self._repeat(animation), name="robot eyes"
            )
        return {"color": shown.text, "animation": animation}

    async def show(self, shown: EyeColor, seconds: float) -> None:
        """A steady colour; returns when the fade is over."""
        async with self._changing:
            await self._steady(shown, seconds)
            self._shown = shown  # not before: what failed must not come after a loss

    async def _animation(self, job: Job) -> dict[str, Json]:
        kind = word(job.args, "kind", KINDS)
        seconds = positive(job.args, "seconds", 3.0)
        light = EyeColor.of(color_of({"color": job.args.get("color", "white")}, "color"))
        self._end_loop()
        before = await self._before()
        job.expects(seconds)
        self._animated = True
        left = seconds
        try:
            while left > 0:
                await self._slice(kind, light, min(left, SLICE_S), before)
                left = round(left - SLICE_S, 6)
        except DriverError:
            self._animated = False
            raise
        self._animated = False
        await self._fade(before, COMES_S)
        return {"kind": kind, "seconds": seconds}

    async def _dim(self, level: float) -> None:
        """Dim what is shown. NAOqi's own way to do that turns every colour into white."""
        shown = await self._before()
        self._level = level
        if shown.grey:
            await self._link.call(LEDS, "setIntensity", GROUP, level * shown.brightness)
        elif not self._loop:
            await self._fade(shown, 0.0)
        self._shown = shown

    # -- lights ----------------------------------------------------------------------------------

    async def _slice(self, kind: str, light: EyeColor, seconds: float, before: EyeColor) -> None:
        """A piece of an animation. Cut short, the colour of before comes back behind it."""
        match kind:
            case "rasta":
                call = self._link.call(LEDS, "rasta", seconds, within=seconds + MARGIN_S)
            case "random":
                call = self._link.call(LEDS, "randomEyes", seconds, within=seconds + MARGIN_S)
            case _:
                call = self._link.call(
                    *(LEDS, "rotateEyes", light.number, TURN_S, seconds), within=seconds + MARGIN_S
                )
        playing = asyncio.get_running_loop().create_task(call, name="robot eyes")
        # Cut short on a robot that is gone, nobody asks how it ended.
        playing.add_done_callback(forget_outcome)
        try:
            await asyncio.shield(playing)
        except asyncio.CancelledError:
            self._clean_up.start(self._after(playing, before))
            raise

    async def _after(self, playing: asyncio.Task[object], before: EyeColor) -> None:
        """NAOqi ends no animation early: cover it now, and once more when it is over."""
        await self._fade(before, 0.0)
        await asyncio.wait([playing])
        playing.exception()
        self._animated = False
        await self._fade(before, 0.0)

    async def _steady(self, shown: EyeColor, seconds: float) -> None:
        """Hold this colour: nothing blinks any more."""
        moved = self._loop is not None
        self._end_loop()
        await self._fade(shown, seconds)
        if moved:  # NAOqi carries calls out side by side: the loop's last one may have come later
            await self._fade(shown, 0.0)

    async def _fade(self, shown: EyeColor, seconds: float) -> None:
        red, green, blue = shown.dimmed(self._level).parts
        await self._link.call(
            *(LEDS, "fadeRGB", GROUP, red, green, blue, float(seconds)), within=seconds + MARGIN_S
        )

    async def _before(self) -> EyeColor:
        """The colour asked for last, otherwise what is seen now."""
        if self._shown is not None:
            return self._shown
        visible = EyeColor.read_back(await self._link.call(LEDS, "getIntensity", FIRST_LIGHT))
        return WHITE if visible is None else visible

    async def _repeat(self, animation: str) -> None:
        """Blink, or let the light come and go, until it is ended or the robot is gone."""
        try:
            while self._loop is asyncio.current_task():
                if animation == "blink":
                    await asyncio.sleep(OPEN_S)
                    await self._fade(BLACK, 0.0)
                    await asyncio.sleep(CLOSED_S)
                    await self._fade(self._shown or WHITE, 0.0)
                else:
                    await self._fade(BLACK, FADE_S)
                    await self._fade(self._shown or WHITE, FADE_S)
        except DriverError as error:
            self._loop = None
            what = "blinking" if animation == "blink" else "coming and going"
            self._context.notice("warning", f"the eyes stopped {what}: {error.what}")

    @contextlib.asynccontextmanager
    async def glowing(self, levels: Sequence[float]) -> AsyncIterator[None]:
        """Be as bright as a sound is loud, each `GLOW_S`, while it plays; then as before. Eyes that
        do something by themselves go on with that.
        """
        if self._loop is not None or self._animated:
            yield
            return
        before = await self._before()
        loop = self._loop = asyncio.get_running_loop().create_task(
            self._glow(before, levels), name="robot eyes"
        )
        try:
            yield
        finally:
            # Ended by another colour, or by the stop: then that is shown.
            if self._loop is loop:
                self._clean_up.start(self._steady(before, 0.0))

    async def _glow(self, shown: EyeColor, levels: Sequence[float]) -> None:
        try:
            for level in levels:
                await self._fade(shown.dimmed(DIMMEST + (1 - DIMMEST) * level), GLOW_S)
        except DriverError:
            return  # it is heard all the same

    def _end_loop(self) -> None:
        if self._loop is not None:
            self._loop.cancel()
            self._loop = None


# -- colours ---------------------------------------------------------------------------------------

#: Two readings of one colour may differ so much in a part: LEDs have 256 steps, some fewer.
CLOSE = 3 / 255


@dataclass(frozen=True, slots=True)
class EyeColor:
    """Red, green and blue from 0 to 1."""

    red: float
    green: float
    blue: float

    @classmethod
    def of(cls, text: str) -> EyeColor:
        """From `#rrggbb`."""
        red, green, blue = bytes.fromhex(text.removeprefix("#"))
        return cls(red / 255, green / 255, blue / 255)

    @classmethod
    def read_back(cls, intensities: object) -> EyeColor | None:
        """From what `ALLeds.getIntensity` says of a light: blue, green, red. None: unreadable."""
        levels = [memory.number(part) for part in memory.items(intensities)]
        parts = [min(max(part, 0.0), 1.0) for part in levels if part is not None]
        if len(parts) != 3 or len(levels) != 3:
            return None
        blue, green, red = parts
        return cls(red, green, blue)

    @property
    def text(self) -> str:
        """As `#rrggbb`."""
        return "#" + "".join(f"{round(part * 255):02x}" for part in self.parts)

    @property
    def parts(self) -> tuple[float, float, float]:
        """Red, green, blue."""
        return self.red, self.green, self.blue

    @property
    def number(self) -> int:
        """As 0xRRGGBB."""
        return int(self.text[1:], 16)

    @property
    def brightness(self) -> float:
        """That of its brightest part."""
        return max(self.parts)

    @property
    def grey(self) -> bool:
        """Whether it is white of some brightness."""
        return self.red == self.green == self.blue

    def dimmed(self, level: float) -> EyeColor:
        """The same colour at a share of its brightness."""
        return EyeColor(self.red * level, self.green * level, self.blue * level)

    def close_to(self, other: EyeColor) -> bool:
        """Whether nobody could tell them apart."""
        pairs = zip(self.parts, other.parts, strict=True)
        return all(abs(one - two) <= CLOSE for one, two in pairs)


BLACK, WHITE = EyeColor(0, 0, 0), EyeColor(1, 1, 1)
