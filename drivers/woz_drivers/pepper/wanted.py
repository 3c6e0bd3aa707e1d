"""What was asked for last of the robot's settings, compared with what the robot says it has."""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.pepper.eyes_color import Color
from woz_drivers.pepper.robot_settings import SETTINGS
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.simulated.values import color as color_of
from woz_tui.core.driver import Rejected
from woz_tui.core.messages import Json

#: Two numbers closer than this are the same: NAOqi counts in single precision.
CLOSE = 0.006
#: Blinking changes the eyes for a moment: only what is so in two readings running is told.
FLEETING = frozenset(("eyes", "eyes_brightness"))
#: Not compared: there is no other robot while one is connected, every animation changes the
#: posture, and what the tablet shows has another name there.
NEVER = frozenset(("robot", "posture", "tablet", "sound", "microphones"))
#: Breathing of the whole body, and what is set behind it for parts of it.
WHOLE = "body_breathing"
PARTS = ("head_breathing", "arms_breathing", "legs_breathing")


class Wanted:
    """By name what was asked for: by the robot file, or by a command since."""

    def __init__(self, settings: PepperSettings) -> None:
        self._by_argument = {
            (one.verb, one.argument): one for one in SETTINGS.values() if one.name not in NEVER
        }
        self._asked = settings.asked(SETTINGS.values())
        if "eyes" in self._asked:
            self._asked["eyes"] = _color(settings.eyes)
        self._doubted: frozenset[str] = frozenset()

    @property
    def asked(self) -> Mapping[str, Json]:
        """All of it."""
        return self._asked

    def note(self, verb: str, args: Mapping[str, Json]) -> None:
        """A command was carried out: what it set is wanted from now on."""
        for argument, value in args.items():
            line = self._by_argument.get((verb, argument))
            if line is not None and value is not None:
                self._asked[line.name] = _color(value) if line.kind == "color" else value
                if line.name == "state":  # it wakes the robot up, or puts it to rest
                    self._asked.pop("awake", None)

    def differing(self, values: Mapping[str, Json]) -> dict[str, Json]:
        """What was asked for, of those settings that the robot has otherwise."""
        found = {
            name: value
            for name, value in self._asked.items()
            if name in values and not _same(name, values[name], value)
        }
        whole = self._asked.get(WHOLE)
        if any(self._asked.get(part, whole) != whole for part in PARTS):
            found.pop(WHOLE, None)  # the parts say what is wanted; what the whole says is open
        doubted = frozenset(found) & FLEETING
        told = {
            name: value
            for name, value in found.items()
            if name not in doubted or name in self._doubted
        }
        self._doubted = doubted
        return told


def _color(value: Json) -> Json:
    try:
        return color_of({"color": value}, "color")
    except Rejected:
        return value


def _same(name: str, has: Json, wants: Json) -> bool:
    if name == "eyes" and isinstance(has, str) and isinstance(wants, str):
        return has == wants or Color.of(has).close_to(Color.of(wants))
    if isinstance(has, bool) or isinstance(wants, bool):
        return has == wants
    if isinstance(has, int | float) and isinstance(wants, int | float):
        return abs(has - wants) <= CLOSE
    return has == wants
