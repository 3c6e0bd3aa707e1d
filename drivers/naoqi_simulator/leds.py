"""ALLeds: eyes, ears and chest, of a NAO also feet and head."""

from __future__ import annotations

import random
from typing import Any

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld

_EYES = tuple(f"{side}FaceLed{number}" for side in ("Right", "Left") for number in range(1, 9))
_EARS = tuple(f"{side}EarLed{number}" for side in ("Right", "Left") for number in range(1, 11))
_CHEST = ("ChestLed",)
_FEET = ("LeftFootLed", "RightFootLed")
_BRAIN = tuple(f"BrainLed{number}" for number in range(12))
GROUPS = {
    "FaceLeds": _EYES,
    "RightFaceLeds": _EYES[:8],
    "LeftFaceLeds": _EYES[8:],
    "EarLeds": _EARS,
    "ChestLeds": _CHEST,
    "AllLeds": _EYES + _EARS + _CHEST,
}
#: A NAO has lights in its feet and on its head, too.
_NAO_GROUPS = {"FeetLeds": _FEET, "LeftFootLeds": _FEET[:1], "RightFootLeds": _FEET[1:]}
_NAO_GROUPS |= {"BrainLeds": _BRAIN, "AllLeds": GROUPS["AllLeds"] + _FEET + _BRAIN}
_NAMED = {
    **{"white": 0xFFFFFF, "red": 0xFF0000, "green": 0x00FF00, "blue": 0x0000FF},
    **{"yellow": 0xFFFF00, "magenta": 0xFF00FF, "cyan": 0x00FFFF},
}
Color = tuple[float, float, float]
_WHITE: Color = (1.0, 1.0, 1.0)
_DARK: Color = (0.0, 0.0, 0.0)
_RASTA = (0x00FF00, 0xFFFF00, 0xFF0000)
#: How long an animation of the eyes shows one picture.
STEP_S = 0.25


def _color(number: int) -> Color:
    return ((number >> 16 & 255) / 255, (number >> 8 & 255) / 255, (number & 255) / 255)


def _played(about: str, passed: float, led: str) -> Color:
    """What one LED of the eyes shows in an animation after so many seconds."""
    name, *how = about.split()
    if name == "rotateEyes":
        lit = int(passed / float(how[1]) * 8) % 8 + 1
        return _color(int(how[0], 16)) if led.endswith(str(lit)) else _DARK
    step = int(passed / STEP_S)
    if name == "rasta":
        return _color(_RASTA[step % len(_RASTA)])
    return _color(random.Random(f"{step} {led}").randrange(1 << 24))


class Leds(Service):
    """Each LED has a colour (red, green, blue, 0 to 1) and may be on its way to another."""

    name = "ALLeds"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self._fades: dict[str, tuple[Color, Color, float, float]] = {}
        self._groups = GROUPS | (_NAO_GROUPS if world.options.robot == "nao" else {})
        self._set(self._groups["AllLeds"], _WHITE, 0.0)

    def color(self, led: str) -> Color:
        """The colour now; while the eyes play something, of what they play."""
        playing = self._world.going.of("eyes") if led in _EYES else []
        if playing:
            return _played(playing[-1].about, self._world.time.now() - playing[-1].begun, led)
        start, end, begun, seconds = self._fades[led]
        share = 1.0 if seconds <= 0 else min(1.0, (self._world.time.now() - begun) / seconds)
        red, green, blue = (a + share * (b - a) for a, b in zip(start, end, strict=True))
        return red, green, blue

    @offers("fadeRGB(sffff)v")
    async def fade_rgb(self, name: str, red: float, green: float, blue: float, s: float) -> None:
        """Go to a colour within some seconds; returns when it is there."""
        for value in (red, green, blue):
            if not 0 <= value <= 1:
                raise CallRefusedError("ALLeds::fadeRGB\n\tintensities must be within [0.0, 1.0]")
        self._set(self._leds("fadeRGB", name), (red, green, blue), s)
        await self._world.going.last("leds", s, "fadeRGB")

    @offers("fadeRGB(sif)v")
    async def fade_rgb_number(self, name: str, rgb: int, seconds: float) -> None:
        """As above, with 0x00RRGGBB."""
        await self.fade_rgb(name, *_color(rgb), seconds)

    @offers("fadeRGB(ssf)v")
    async def fade_rgb_named(self, name: str, color: str, seconds: float) -> None:
        """As above, with white, red, green, blue, yellow, magenta or cyan."""
        if color not in _NAMED:
            raise CallRefusedError(f"ALLeds::fadeRGB\n\tunknown colour {color}")
        await self.fade_rgb(name, *_color(_NAMED[color]), seconds)

    @offers("fade(sff)v")
    async def fade(self, name: str, intensity: float, seconds: float) -> None:
        """All channels to one intensity within some seconds."""
        await self.fade_rgb(name, intensity, intensity, intensity, seconds)

    @offers("setIntensity(sf)v")
    def set_intensity(self, name: str, intensity: float) -> None:
        """All channels at once: white of this brightness."""
        if not 0 <= intensity <= 1:
            raise CallRefusedError("ALLeds::setIntensity\n\tintensity must be within [0.0, 1.0]")
        self._set(self._leds("setIntensity", name), (intensity,) * 3, 0.0)

    @offers("getIntensity(s)m")
    def get_intensity(self, name: str) -> list[float]:
        """Blue, green, red of the first LED that the name stands for, in this order."""
        return list(reversed(self.color(self._leds("getIntensity", name)[0])))

    @offers("on(s)v")
    def on(self, name: str) -> None:
        """White."""
        self._set(self._leds("on", name), _WHITE, 0.0)

    @offers("off(s)v")
    def off(self, name: str) -> None:
        """Dark."""
        self._set(self._leds("off", name), _DARK, 0.0)

    @offers("reset(s)v")
    def reset(self, name: str) -> None:
        """Back to what they are after switching on."""
        self.on(name)

    @offers("listGroups()[s]")
    def list_groups(self) -> list[str]:
        return sorted(self._groups)

    @offers("randomEyes(f)v")
    async def random_eyes(self, seconds: float) -> None:
        """Random colours in the eyes; nothing ends them early."""
        await self._animate("randomEyes", seconds)

    @offers("rasta(f)v")
    async def rasta(self, seconds: float) -> None:
        """Green, yellow and red; nothing ends them early."""
        await self._animate("rasta", seconds)

    @offers("rotateEyes(iff)v")
    async def rotate_eyes(self, rgb: int, turn_s: float, seconds: float) -> None:
        """A colour going round; nothing ends it early."""
        if turn_s <= 0:
            raise CallRefusedError("ALLeds::rotateEyes\n\ttimeForRotation must be above 0")
        await self._animate(f"rotateEyes {rgb:06x} {turn_s:g}", seconds)

    async def _animate(self, about: str, seconds: float) -> None:
        await self._world.going.last("eyes", seconds, about)

    def animation(self) -> str:
        """What the eyes play now, or nothing."""
        playing = self._world.going.of("eyes")
        return playing[-1].about if playing else ""

    def _leds(self, method: str, name: str) -> tuple[str, ...]:
        everything = self._groups["AllLeds"]
        leds: Any = self._groups.get(name, (name,) if name in everything else ())
        if not leds:
            raise CallRefusedError(f"ALLeds::{method}\n\tunknown group or LED {name}")
        return tuple(leds)

    def _set(self, leds: tuple[str, ...], color: Color, seconds: float) -> None:
        now = self._world.time.now()
        for led in leds:
            start = self.color(led) if led in self._fades else color
            self._fades[led] = (start, color, now, seconds)
