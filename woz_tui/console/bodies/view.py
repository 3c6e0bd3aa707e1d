"""The state of one body, put together from its joints, setpoints, face, mode and health."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from woz_tui.config.screen_language import say
from woz_tui.console.bodies.link_views import Pose
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.number_text import age
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.driver_outlines import BodyOutline, body_outlines
from woz_tui.console.state.view_models import SensorView
from woz_tui.protocol import messages as m


@dataclass(frozen=True, slots=True)
class BodyView:
    """A body to be drawn; `old` says how old its data is, and is empty while it is fresh."""

    outline: BodyOutline
    face: m.FaceShown | None
    pose: Pose
    values: Mapping[str, m.Json]
    mode: str
    old: str = ""
    #: What of it the wizard does not get to see: face, joints.
    hidden: frozenset[str] = frozenset()

    def value(self, *names: str) -> m.Json:
        """The first of these values that the body has published."""
        return next((self.values[name] for name in names if name in self.values), None)


def body_views(state: ConsoleState, now: int, glyphs: Glyphs) -> list[BodyView]:
    """Every body of the session, in the robot file's order."""
    session = state.session
    views = []
    for outline in body_outlines(state.outlines):
        driver = outline.driver
        body, mode = session.bodies.get(driver), session.modes.get(driver)
        values = dict(_flattened(body.values if body is not None else {}))
        reached = _sensors(state, outline, "joint")
        wanted = _sensors(state, outline, "setpoint")
        newest = max((sensor.t for sensor in (*reached.values(), *wanted.values())), default=None)
        lost = state.health(driver) == "lost"
        if state.perception.hides("joints"):
            reached, wanted = {}, {}  # not even how old they are
        stale = lost or any(state.is_stale(one, now) for one in reached.values())
        since = state.drivers[driver].t if lost else newest
        old = ""
        if stale or state.lost:
            old = say("body.lost", "lost")
            if since is not None:
                aged = say("meters.old", "{age} old", age=age(now - since))
                old = f"{glyphs.stale}{aged}"
        view = BodyView(
            outline,
            session.faces.get(driver),
            Pose(_joint_angles(outline, reached), _joint_angles(outline, wanted), stale=bool(old)),
            values,
            (mode.now if mode is not None else "") or str(values.get("mode") or "normal"),
            old,
            state.perception.hidden,
        )
        views.append(view)
    return views


def _sensors(state: ConsoleState, outline: BodyOutline, kind: str) -> dict[str, SensorView]:
    """The newest sensor of each joint of this robot, from whichever of its drivers; where
    several publish it, the body's own counts.
    """
    found: dict[str, SensorView] = {}
    for name in state.sensors:
        head, _, joint = name.rpartition(".")
        if head.rpartition(".")[2] != kind or joint not in outline.home:
            continue
        sensor = state.sensor(name)
        if sensor is None or not sensor.driver.startswith(outline.robot):
            continue
        if joint not in found or sensor.driver == outline.driver:
            found[joint] = sensor
    return found


def _joint_angles(
    outline: BodyOutline, sensors: Mapping[str, SensorView]
) -> dict[str, float] | None:
    """Degrees by joint; a joint without a sensor is at home. None: no joint has a value."""
    known = {joint: one.value for joint, one in sensors.items() if one.value is not None}
    if not known:
        return None
    return {joint: known.get(joint, home) for joint, home in outline.home.items()}


def _flattened(values: Mapping[str, m.Json]) -> Iterator[tuple[str, m.Json]]:
    """Values within values side by side."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flattened(value)
        else:
            yield name, value
