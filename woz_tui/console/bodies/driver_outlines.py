"""What drivers look like, from the `outlines` of the welcome: bodies, panels, whole robots.

Written by other hands, perhaps by another version: what cannot be read is left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import RobotOutline

if TYPE_CHECKING:
    from woz_tui.motion.kinematics import KinematicChain

#: A matrix of more lights is no face that could be drawn.
MOST_LIGHTS = 256


@dataclass(frozen=True, eq=False)  # a cache goes by identity
class BodyOutline:
    """A body: its driver, its links, its joints' home pose in degrees, the lights of its face."""

    driver: str
    chain: KinematicChain
    home: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    face: tuple[int, int] | None

    @property
    def robot(self) -> str:
        """What is before the names of its sensors: `left.` of `left.body`."""
        whose, dot, _ = self.driver.rpartition(".")
        return whose + dot

    @property
    def title(self) -> str:
        """Whose body it is: the robot's name, or the driver's where there is one robot."""
        return self.robot.rstrip(".") or self.driver


@dataclass(frozen=True, slots=True)
class ControlOutline:
    """A control of a panel; `column` and `row` count from the upper left. `label`: what it does."""

    name: str
    kind: str
    column: int
    row: int
    label: str


@dataclass(frozen=True, slots=True)
class PanelOutline:
    """A panel of knobs, sliders and buttons."""

    driver: str
    name: str
    controls: tuple[ControlOutline, ...]


Outline = BodyOutline | PanelOutline


def outlines_of(told: Mapping[str, Json]) -> dict[str, Outline]:
    """All outlines that can be read, by driver, in the robot file's order."""
    found: dict[str, Outline] = {}
    for driver, outline in told.items():
        if isinstance(outline, dict):
            read = _READERS.get(str(outline.get("kind")))
            made = read(driver, outline) if read is not None else None
            if made is not None:
                found[driver] = made
    return found


def _body(driver: str, told: Mapping[str, Json]) -> BodyOutline | None:
    # The first painting of a session without a body does not wait for it.
    from woz_tui.motion.kinematics import KinematicChain  # noqa: PLC0415

    try:
        chain = KinematicChain.of_outline(dict(told))
    except (ValueError, KeyError, TypeError):
        return None
    home: dict[str, float] = {}
    limits: dict[str, tuple[float, float]] = {}
    joints = told.get("joints")
    for joint in joints if isinstance(joints, list) else ():
        if isinstance(joint, dict):
            name = str(joint.get("name", ""))
            home[name] = _number(joint.get("home"), 0.0)
            limits[name] = (_number(joint.get("min"), -90.0), _number(joint.get("max"), 90.0))
    return BodyOutline(driver, chain, home, limits, _face(told.get("face")))


def _face(told: Json) -> tuple[int, int] | None:
    match told:
        case {"width": int() as width, "height": int() as height}:
            if 0 < width <= MOST_LIGHTS and 0 < height <= MOST_LIGHTS:
                return width, height
    return None


def _panel(driver: str, told: Mapping[str, Json]) -> PanelOutline | None:
    controls = told.get("controls")
    if not isinstance(controls, list):
        return None
    read = [_control(control) for control in controls if isinstance(control, dict)]
    found = tuple(control for control in read if control is not None)
    return PanelOutline(driver, str(told.get("name", driver)), found) if found else None


def _control(told: Mapping[str, Json]) -> ControlOutline | None:
    match told:
        case {"name": str() as name, "kind": str() as kind, "column": int() as column,
              "row": int() as row}:  # fmt: skip
            return ControlOutline(name, kind, column, row, str(told.get("label") or ""))
    return None


def _number(value: object, instead: float) -> float:
    if isinstance(value, int | float) and math.isfinite(value):
        return float(value)
    return instead


_READERS = {"body": _body, "panel": _panel}


def body_outlines(outlines: Mapping[str, Outline]) -> list[BodyOutline]:
    """The bodies among them."""
    return [outline for outline in outlines.values() if isinstance(outline, BodyOutline)]


def panel_outlines(outlines: Mapping[str, Outline]) -> list[PanelOutline]:
    """The panels among them."""
    return [outline for outline in outlines.values() if isinstance(outline, PanelOutline)]


def robots_of(told: Mapping[str, Json]) -> dict[str, RobotOutline]:
    """Outlines of whole robots by driver; what cannot be read is left out."""
    read = {driver: RobotOutline.read(outline) for driver, outline in told.items()}
    return {driver: outline for driver, outline in read.items() if outline is not None}
