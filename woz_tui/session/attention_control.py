"""Turns the robot's head to a sound elsewhere, and back to the visitor it talks with.

`woz_tui.sensing.attention` decides; here it gets directions and loudness, and its orders become
`gaze` commands. It takes part only with `attention: {look: true}` and a robot that offers `gaze`
and hears directions. A wizard who turns the head meanwhile has it: it is not turned back.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.experiment import Call, DriverSpec, Experiment
from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import DIRECTION, GAZE, Verb
from woz_tui.protocol import messages as m
from woz_tui.sensing import sample_values
from woz_tui.sensing.attention import Attention, GazeDirection, LookBack, Order, Stay
from woz_tui.sensing.engagement_stream import EngagementFollower
from woz_tui.sensing.state_machine import ENGAGED
from woz_tui.session.engagement_robot import ORIGIN, EngagementRobot, WakeUpTimer


class AttentionController:
    """Turns the head to sounds, and back or not.

    Args:
        robot: Turns its head.
        follower: Says what is heard and who is engaged.
        settings: What the section says.
        news: Called when what it attends to has changed.
    """

    def __init__(
        self,
        robot: EngagementRobot,
        follower: EngagementFollower,
        settings: EngagementSettings,
        news: Callable[[], object],
    ) -> None:
        self._robot = robot
        self._follower = follower
        self._settings = settings.attention
        self._attention = Attention(settings.attention)
        self._news = news
        self._timer = WakeUpTimer(robot.session.hub, self._on_timer)
        self._head = head_of(robot.session.experiment) if settings.attention.look else None
        self._sensor = _direction_beside(robot.session.experiment, self._head) if self._head else ""
        self._direction: float | None = None
        self._before: dict[str, m.Json] = {}
        self._overruled = False

    def fits(self, settings: EngagementSettings) -> bool:
        """Whether it goes on with these settings as it is."""
        return settings.attention == self._settings

    def on_message(self, message: m.Message) -> None:
        """Take in directions of sound, and what the wizard does with the head."""
        if self._head is None:
            return
        head = self._head[0].name
        match message:
            case m.Reading(sensor=sensor, value=float() | int()) if sensor == self._sensor:
                # A direction is that of a sound if it is loud and the robot is silent.
                if self._follower.loud and not self._follower.speaks:
                    self._carry_out(self._attention.sound(message.value, self._now))
                elif not self._attention.away:
                    self._direction = message.value
            case m.Reading(sensor=sensor) if self._follower.sensors.get(sensor) == "presence":
                somebody = sample_values.presence(message.value)
                if somebody is not None and not self._overruled:
                    self._attention.presence(somebody, self._now)
            case m.Command(driver=driver, verb=verb, source=source) if (
                driver == head and verb == GAZE and source != ORIGIN.source
            ):
                self._before = dict(message.args)
                self._overruled = self._attention.away
            case m.StopPressed(scope="all"):
                self._overruled = self._attention.away

    def entered(self, state: str) -> None:
        """The engagement model is in another state."""
        engaged = state in ENGAGED
        self._carry_out(self._attention.engaged(engaged, self._direction, self._now))

    def attend(self, mode: str) -> None:
        if mode != self._attention.mode:
            self._carry_out(self._attention.attend(mode, self._now))

    def close(self) -> None:
        """Stop turning the head."""
        self._head = None
        self._timer.cancel()

    # -- inside ------------------------------------------------------------------------------------

    @property
    def _now(self) -> int:
        return self._robot.session.hub.now()

    def _carry_out(self, order: Order | None) -> None:
        match order:
            case GazeDirection(direction=direction):
                self._overruled = self._robot.is_stopped  # it does not turn, so not back either
                self._turn_head({"yaw": direction, "pitch": 0.0})
            case LookBack(direction=direction) if not self._overruled:
                self._turn_head(self._before or {"yaw": direction or 0.0, "pitch": 0.0})
            case Stay(direction=direction) if not self._overruled:
                self._before = {"yaw": direction, "pitch": 0.0}
        self._timer.set(self._attention.due())
        if self._follower.model.attention != self._attention.shown:
            self._follower.model.attention = self._attention.shown
            self._news()

    def _turn_head(self, args: Mapping[str, m.Json]) -> None:
        if self._head is None or not self._robot.may_move:
            return
        spec, verb = self._head
        known = {argument.name for argument in verb.arguments}
        fitting = {name: _within(verb, name, args[name]) for name in args if name in known}
        self._robot.send(Call(GAZE, fitting, spec.name))

    def _on_timer(self) -> None:
        self._carry_out(self._attention.advance(self._now))


def head_of(experiment: Experiment) -> tuple[DriverSpec, Verb] | None:
    """The first driver that can look into a direction."""
    for spec in experiment.drivers:
        for verb in spec.offer.verbs:
            if verb.name == GAZE:
                return spec, verb
    return None


def _direction_beside(experiment: Experiment, head: tuple[DriverSpec, Verb]) -> str:
    """The sensor with which the same robot hears where a sound is; empty: it has none."""
    robot = head[0].name.rpartition(".")[0]
    published = published_names(experiment.drivers)
    for spec in experiment.drivers:
        if spec.name.rpartition(".")[0] == robot and DIRECTION in spec.offer.sensors:
            return published[spec.name][DIRECTION]
    return ""


def _within(verb: Verb, name: str, value: m.Json) -> m.Json:
    """`value` limited to the range of the verb's argument."""
    span = next((argument.range for argument in verb.arguments if argument.name == name), None)
    if span is None or not isinstance(value, int | float):
        return value
    low = value if span.low is None else max(value, span.low)
    return low if span.high is None else min(low, span.high)
