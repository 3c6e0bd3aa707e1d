"""What drivers look like, from the `outlines` of the welcome: bodies, panels, whole robots.

Written by other hands, perhaps by another version: what cannot be read is left out.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, TypeVar

import msgspec

from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import RobotOutline

if TYPE_CHECKING:
    from woz_tui.motion.kinematics import KinematicChain

_Shape = TypeVar("_Shape")

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


class ControlOutline(msgspec.Struct, frozen=True):
    """A control of a panel; `column` and `row` count from the upper left. `label`: what it does;
    `takes_over`: it waits until it has passed the robot's value.
    """

    name: str
    kind: str
    column: int
    row: int
    label: str = ""
    takes_over: bool = True


class _JointOutline(msgspec.Struct):
    name: str
    home: float = 0.0
    min: float = -90.0
    max: float = 90.0


class _Lights(msgspec.Struct):
    width: Annotated[int, msgspec.Meta(ge=1, le=MOST_LIGHTS)]
    height: Annotated[int, msgspec.Meta(ge=1, le=MOST_LIGHTS)]


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
    joints = _all_of(told.get("joints"), _JointOutline)
    lights = _all_of([told.get("face")], _Lights)
    return BodyOutline(
        driver,
        chain,
        {joint.name: joint.home for joint in joints},
        {joint.name: (joint.min, joint.max) for joint in joints},
        (lights[0].width, lights[0].height) if lights else None,
    )


def _panel(driver: str, told: Mapping[str, Json]) -> PanelOutline | None:
    controls = tuple(_all_of(told.get("controls"), ControlOutline))
    return PanelOutline(driver, str(told.get("name", driver)), controls) if controls else None


def _all_of(told: Json, shape: type[_Shape]) -> list[_Shape]:
    """Those of a list that can be read."""
    found: list[_Shape] = []
    for each in told if isinstance(told, list) else ():
        with contextlib.suppress(msgspec.ValidationError):
            found.append(msgspec.convert(each, shape))
    return found


_READERS = {"body": _body, "panel": _panel}


def body_outlines(outlines: Mapping[str, Outline]) -> list[BodyOutline]:
    return [outline for outline in outlines.values() if isinstance(outline, BodyOutline)]


def panel_outlines(outlines: Mapping[str, Outline]) -> list[PanelOutline]:
    return [outline for outline in outlines.values() if isinstance(outline, PanelOutline)]


def robots_of(told: Mapping[str, Json]) -> dict[str, RobotOutline]:
    """Outlines of whole robots by driver; what cannot be read is left out."""
    read = {driver: RobotOutline.read(outline) for driver, outline in told.items()}
    return {driver: outline for driver, outline in read.items() if outline is not None}
