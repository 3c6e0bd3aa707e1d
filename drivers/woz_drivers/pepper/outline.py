"""What the console shows of a Pepper and may change: its settings, animations, tags, robots."""

from __future__ import annotations

from dataclasses import replace

from woz_drivers.pepper import tags
from woz_drivers.pepper.address import SIMULATED
from woz_drivers.pepper.animations import MOVES
from woz_drivers.pepper.robot_settings import SETTINGS
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import RobotOutline


def outline(settings: PepperSettings) -> dict[str, Json]:
    """As the driver tells it."""
    robots = tuple(dict.fromkeys((*settings.robots, SIMULATED)))
    named = {**SETTINGS, "robot": replace(SETTINGS["robot"], choices=robots)}
    return RobotOutline(
        settings=[setting.line() for setting in named.values()],
        robots=list(robots),
        moves=list(MOVES),
        tags=tags.offered(),
        camera=True,
    ).told()
