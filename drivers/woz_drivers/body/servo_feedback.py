"""What servos show of a body's motions: whether they can carry one out, and whether they have."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from woz_drivers.body.settings import BodySettings
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError, RejectedError
from woz_tui.motion.body_feeds import PRESENT, JointPositions

#: Verbs that move joints.
MOVING = ("play", "pose", "poses", "home", "gaze", "nudge", "joints", "play_move")
#: Older news of the servos count no more, in seconds.
FRESH_S = 0.5
#: So near to its setpoint a joint is there, in degrees.
TOLERANCE = 5.0
#: A joint has followed a motion of so many degrees if it went half of the way itself; a smaller one
#: is lost in what a servo lags behind.
TRAVEL = 10.0
#: A joint whose setpoint moved by so much takes part in a motion that names none, in degrees: more
#: than a breath.
MOVES = 5.0
#: Joints are waited for as long as they come nearer by `NEARER` degrees within `SETTLE_S`: after
#: their torque went on they meet the body slowly.
SETTLE_S, NEARER, LOOK_S = 1.0, 0.5, 0.05
TORQUE_OFF = "torque is off"
TORQUE_REMEDY = "make sure that nobody is in reach, then switch the torque on (`torque: on`)"
_STUCK = "see what holds it, its load, and what its servos say of themselves"


class ServoFeedback:
    """The joints as their servos tell of them, in the body's degrees."""

    def __init__(self, settings: BodySettings, context: DriverContext) -> None:
        self._servos = settings.servos
        self._zero = {name: joint.zero for name, joint in settings.joints.items()}
        self._feed = context.feed(PRESENT, of=settings.servos)

    def joints(self, now: float) -> Mapping[str, float]:
        """Where those are that answer; none if nothing was heard of them lately."""
        positions = self._fresh_positions(now)
        return {
            name: angle - self._zero[name]
            for name, angle in (positions.joints if positions is not None else {}).items()
            if name in self._zero
        }

    def obstacles(self, now: float) -> dict[str, tuple[str, str]]:
        """Joints that cannot move, each with why, and what to do about it."""
        positions = self._fresh_positions(now)
        if positions is None:
            latest = self._feed.latest().value
            lost = latest.unable if isinstance(latest, JointPositions) else {}
            nothing = "is not told of", f"see what {self._servos} says of itself"
            return {name: lost.get(name, nothing) for name in self._zero}
        limp = {
            name: (TORQUE_OFF, TORQUE_REMEDY)
            for name in positions.joints
            if name not in positions.held
        }
        return {
            name: why for name, why in {**limp, **positions.unable}.items() if name in self._zero
        }

    def _fresh_positions(self, now: float) -> JointPositions | None:
        latest = self._feed.latest().value
        fresh = isinstance(latest, JointPositions) and now - latest.t_us / 1e6 <= FRESH_S
        return latest if fresh else None

    def need(self, joints: Iterable[str], now: float) -> None:
        """Return if any of these joints can move, or nobody knows of one that cannot.

        Raises:
            RejectedError: Their torque is off.
            DeviceLostError: None of the servos answers.
            DriverError: They have alarms or other troubles.
        """
        obstacles, present = self.obstacles(now), self.joints(now)
        known = [name for name in joints if name in obstacles or name in present]
        if not known or any(name not in obstacles for name in known):
            return
        text, remedy = joint_troubles({name: obstacles[name] for name in known})
        if {obstacles[name][0] for name in known} == {TORQUE_OFF}:
            raise RejectedError(f"the torque of {', '.join(sorted(known))} is off", remedy)
        raise (DriverError if present else DeviceLostError)(text, remedy)

    def unable(self, now: float) -> tuple[tuple[str, ...], str]:
        """For `DriverContext.unable`: nothing, as long as any joint can move."""
        try:
            self.need(self._zero, now)
        except DriverError as error:
            return MOVING, error.what
        return (), ""


def joint_troubles(why: Mapping[str, tuple[str, str]]) -> tuple[str, str]:
    """What is the matter with joints in a sentence, and what to do about it."""
    sentence = "; ".join(f"{name} {what}" for name, (what, _) in sorted(why.items()))
    return sentence, next((remedy for _, remedy in why.values() if remedy), "")


@dataclass(slots=True)
class _Travel:
    """From where to where an angle went."""

    low: float
    high: float

    def add(self, angle: float) -> None:
        self.low, self.high = min(self.low, angle), max(self.high, angle)

    @property
    def way(self) -> float:
        return self.high - self.low


@dataclass(slots=True)
class MotionWatch:
    """How joints followed one motion: those that it names, or all that it moved.

    `tick` is called in the ticking thread, with the body's setpoints.
    """

    feedback: ServoFeedback
    named: frozenset[str] = frozenset()
    _wanted: dict[str, _Travel] = field(default_factory=dict)
    _seen: dict[str, _Travel] = field(default_factory=dict)
    _setpoints: Mapping[str, float] = field(default_factory=dict)

    def tick(self, now: float, setpoints: Mapping[str, float]) -> None:
        """Take in where joints shall be, and where they are."""
        self._setpoints = setpoints
        for travels, angles in (
            (self._wanted, setpoints),
            (self._seen, self.feedback.joints(now)),
        ):
            for name, angle in angles.items():
                travels.setdefault(name, _Travel(angle, angle)).add(angle)

    def involved(self) -> list[str]:
        """The joints that servos tell of and that take part."""
        return [
            name
            for name, travel in sorted(self._wanted.items())
            if name in self._seen and (name in self.named if self.named else travel.way > MOVES)
        ]

    async def missing(self) -> dict[str, tuple[str, str]]:
        """Joints that did not follow, or are not where they shall be: each with why and a remedy.

        They are waited for as long as they come nearer.
        """
        loop = asyncio.get_running_loop()
        nearest, since = float("inf"), loop.time()
        while True:
            now = loop.time()
            away = self._away(now)
            furthest = max(away.values(), default=0.0)
            if furthest <= TOLERANCE:
                return self._problems(now, {})
            if furthest < nearest - NEARER:
                nearest, since = furthest, now
            elif now - since >= SETTLE_S:
                return self._problems(now, away)
            await asyncio.sleep(LOOK_S)

    def _away(self, now: float) -> dict[str, float]:
        """How far joints that could move are from their setpoints, in degrees."""
        obstacles, present = self.feedback.obstacles(now), self.feedback.joints(now)
        return {
            name: abs(present[name] - self._setpoints[name])
            for name in self.involved()
            if name in present and name not in obstacles
        }

    def _problems(self, now: float, away: Mapping[str, float]) -> dict[str, tuple[str, str]]:
        obstacles, present = self.feedback.obstacles(now), self.feedback.joints(now)
        found: dict[str, tuple[str, str]] = {}
        for name in self.involved():
            wanted, seen = self._wanted[name].way, self._seen[name].way
            if name in obstacles:
                found[name] = obstacles[name]
            elif away.get(name, 0.0) > TOLERANCE:
                goal = self._setpoints[name]
                what = f"stands at {present[name]:.0f} degrees and not at {goal:.0f}"
                found[name] = what, _STUCK
            elif wanted > TRAVEL and seen < wanted / 2:
                found[name] = f"moved by {seen:.0f} of {wanted:.0f} degrees", _STUCK
        return found
