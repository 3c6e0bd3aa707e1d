"""A NAO's lights: feelings as colours of the eyes; ears, chest, feet and head."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from woz_drivers.naoqi_robot.eyes import LEDS, LONGEST, MARGIN_S, EyeColor, EyesPart
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import color as color_of
from woz_tui.drivers.argument_values import number, positive, word
from woz_tui.drivers.contract import (
    Argument,
    DriverContext,
    Job,
    Offer,
    Verb,
)
from woz_tui.drivers.robot_parts import RefusalAllowed
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

#: What a face shows that has no other means than the colour of its eyes: a choice of ours, warm
#: for what draws near and cold for what draws back.
EMOTIONS = {
    "neutral": "#ffffff",
    "happy": "#ffd000",
    "amazed": "#ff60ff",
    "sad": "#0030ff",
    "angry": "#ff0000",
    "sleepy": "#203060",
}
#: A feeling comes within so long, in seconds; a weak one has this share of its colour in white.
EMOTION_S = 0.4


class NaoEyesPart(EyesPart):
    """The eyes, which also show feelings."""

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Those of the eyes, and `emotion`."""
        summary = "show a feeling by the colour of the eyes"
        emotion = common_verb("emotion", summary, choices=tuple(EMOTIONS), limit_s=10.0)
        offered = super().offer(settings)
        return replace(offered, verbs=(*offered.verbs, emotion))

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Show it."""
        if job.verb != "emotion":
            return await super().perform(job)
        await self._cleaned_up()
        emotion, intensity, color = _feeling(job.args)
        await self.show(color, EMOTION_S)
        return {"emotion": emotion, "intensity": intensity}

    def implied(self, job: Job) -> Mapping[str, Json]:
        """The eyes are to have the colour of the feeling."""
        return {"eyes": _feeling(job.args)[2].text} if job.verb == "emotion" else {}


def _feeling(args: Mapping[str, Json]) -> tuple[str, float, EyeColor]:
    """Its name, its intensity, its colour. Raises `RejectedError`."""
    emotion = word(args, "emotion", tuple(EMOTIONS))
    intensity = min(max(number(args, "intensity", 1.0), 0.0), 1.0)
    return emotion, intensity, blended(EMOTIONS[emotion], intensity)


def blended(color: str, share: float) -> EyeColor:
    """A colour with that share of it, the rest being neutral."""
    full, neutral = EyeColor.of(color).parts, EyeColor.of(EMOTIONS["neutral"]).parts
    red, green, blue = (
        plain + share * (one - plain) for one, plain in zip(full, neutral, strict=True)
    )
    return EyeColor(red, green, blue)


#: Groups of ALLeds (family/nao_technical/leds_naov6), and whether they have colours: the others
#: are of one colour, and take the brightness of what is asked for.
GROUPS = {
    "ears": ("EarLeds", False),
    "chest": ("ChestLeds", True),
    "feet": ("FeetLeds", True),
    "head": ("BrainLeds", False),
}


class LightsPart(NaoqiPart):
    """Ears (blue), head (white), chest and feet (any colour)."""

    name = "lights"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: Asked for last: set again after a loss.
        self._desired: dict[str, EyeColor] = {}

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`leds`."""
        return Offer(
            verbs=(
                Verb(
                    "leds",
                    "colour the lights of ears, chest, feet or head",
                    (
                        Argument("group", "choice", required=True, choices=tuple(GROUPS)),
                        Argument("color", "text", "a name or #rrggbb; off", required=True),
                        Argument("seconds", "seconds", "fade to it", False, 0.0, LONGEST),
                    ),
                    lane="leds",
                    limit_s=60.0,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Show it; a fade takes its time."""
        group = word(job.args, "group", tuple(GROUPS))
        color = EyeColor.of(color_of(job.args, "color"))
        seconds = positive(job.args, "seconds", 0.0)
        job.expects(seconds)
        await self._fade(group, color, seconds)
        self._desired[group] = color
        return {"group": group, "color": color.text}

    async def connected(self) -> None:
        """After a loss: what was shown."""
        for group, color in self._desired.items():
            with RefusalAllowed(self._context, f"the {group} stay as they are"):
                await self._fade(group, color, 0.0)

    async def _fade(self, group: str, color: EyeColor, seconds: float) -> None:
        name, colored = GROUPS[group]
        words = ("fadeRGB", name, *color.parts) if colored else ("fade", name, color.brightness)
        await self._link.call(LEDS, *words, float(seconds), within=seconds + MARGIN_S)
