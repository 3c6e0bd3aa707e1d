"""What is known of one body at one moment, put together from everything that was heard of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from woz_tui.console.bodies.outlines import BodyOutline, bodies
from woz_tui.console.bodies.views import Pose
from woz_tui.console.figures import age
from woz_tui.console.glyphs import Glyphs
from woz_tui.console.parts import SensorPicture
from woz_tui.console.picture import Picture
from woz_tui.core import messages as m


@dataclass(frozen=True, slots=True)
class SeenBody:
    """A body as it is shown: `old` says how old that is, and is empty as long as it is new."""

    outline: BodyOutline
    face: m.FaceShown | None
    pose: Pose
    values: Mapping[str, m.Json]
    mode: str
    old: str = ""

    def value(self, *names: str) -> m.Json:
        """The first of these values that is known."""
        return next((self.values[name] for name in names if name in self.values), None)


def seen_bodies(picture: Picture, now: int, glyphs: Glyphs) -> list[SeenBody]:
    """Every body of the session, in the robot file's order."""
    return [_seen(picture, outline, now, glyphs) for outline in bodies(picture.outlines)]


def _seen(picture: Picture, outline: BodyOutline, now: int, glyphs: Glyphs) -> SeenBody:
    driver = outline.driver
    values = dict(_flat(picture.bodies.get(driver, {})))
    reached = _angles(picture, outline, "joint")
    wanted = _angles(picture, outline, "setpoint")
    newest = max((sensor.t for sensor in (*reached, *wanted)), default=None)
    lost = picture.health(driver) == "lost"
    stale = bool(picture.lost) or lost or any(picture.is_stale(one, now) for one in reached)
    since = picture.drivers[driver].t if lost else newest
    old = ""
    if stale:
        old = f"{glyphs.stale}{age(now - since)} old" if since is not None else "lost"
    return SeenBody(
        outline,
        picture.faces.get(driver),
        Pose(_placed(outline, reached), _placed(outline, wanted), stale=bool(old)),
        values,
        picture.modes.get(driver) or str(values.get("mode") or "normal"),
        old,
    )


def _angles(picture: Picture, outline: BodyOutline, kind: str) -> list[SensorPicture]:
    """What was heard of this body's joints; a joint's name is the last part of its sensor's."""
    names = (f"{outline.robot}{kind}.{joint}" for joint in outline.home)
    found = (picture.sensors.get(name) for name in names)
    return [sensor for sensor in found if sensor is not None]


def _placed(outline: BodyOutline, sensors: list[SensorPicture]) -> dict[str, float] | None:
    """Degrees by joint; a joint that nobody speaks of stands at home. None: nobody says any."""
    known = {one.name.rpartition(".")[2]: one.value for one in sensors if one.value is not None}
    if not known:
        return None
    return {joint: known.get(joint, home) for joint, home in outline.home.items()}


def _flat(values: Mapping[str, m.Json]) -> Iterator[tuple[str, m.Json]]:
    """Values within values side by side."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value)
        else:
            yield name, value
