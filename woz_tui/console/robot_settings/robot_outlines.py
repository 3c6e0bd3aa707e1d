"""Which drivers are whole robots, as the welcome tells it (`outlines` of its settings)."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import RobotOutline


def robots_of(told: Mapping[str, Json]) -> dict[str, RobotOutline]:
    """Outlines of whole robots by driver; what cannot be read is left out."""
    read = {driver: RobotOutline.read(outline) for driver, outline in told.items()}
    return {driver: outline for driver, outline in read.items() if outline is not None}
