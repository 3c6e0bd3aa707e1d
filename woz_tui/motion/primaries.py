"""Who decides where the body wants to be: exactly one of these at a time.

Each is asked once a tick for the whole pose. None knows of ranges, speeds or of what was before:
that is the layers' and safety's business.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from woz_tui.motion.easing import EASE
from woz_tui.motion.move import Cue, FaceWish, Move
from woz_tui.motion.setpoints import Seen
from woz_tui.motion.shapes import BodyShape
from woz_tui.motion.tracking import Tracker

#: Sums of ticks are this much too short or too long, in seconds; what is due then is due now.
INSTANT_S = 1e-9


@dataclass(slots=True)
class Moment:
    """What a primary may look at.

    `dt` seconds since the last tick, `t` since the engine began; `base` the pose that it works
    on, `joints` where safety has let the joints come, all in degrees. `tempo` in Hz, `speed` and
    `amplitude` are the personality's.
    """

    dt: float
    t: float
    base: Mapping[str, float]
    joints: Mapping[str, float]
    seen: Seen | None
    tempo: float
    speed: float
    amplitude: float


@dataclass(slots=True)
class Wish:
    """What a primary wants of the face; `glance` is added to where the eyes look, -1..1."""

    face: FaceWish | None = None
    glance: tuple[float, float] = (0.0, 0.0)


class Primary(Protocol):
    """One who decides."""

    #: 0 if nobody waits for its end.
    token: int
    #: What it is called in sentences.
    name: str

    @property
    def over(self) -> bool:
        """Whether it has come to its own end."""
        ...

    @property
    def wish(self) -> Wish | None:
        """What it wants of the face, as of the last step."""
        ...

    def step(self, moment: Moment) -> Mapping[str, float]:
        """The pose, in degrees, of every joint."""
        ...


class Hold:
    """Stays at the pose that people want."""

    token = 0
    name = ""
    over = False
    wish: Wish | None = None

    def step(self, moment: Moment) -> Mapping[str, float]:
        """That pose."""
        return moment.base


@dataclass(frozen=True, slots=True)
class Leg:
    """A part of a line: from one pose to another in `seconds`."""

    start: Mapping[str, float]
    goal: Mapping[str, float]
    seconds: float


def legs_of(
    here: Mapping[str, float],
    goals: Sequence[tuple[Mapping[str, float], float]],
    shape: BodyShape,
    easing: str,
) -> list[Leg]:
    """Legs through all goals, each with its seconds or, if they are too few, at full speed."""
    _, peak = EASE[easing]
    names = {name for goal, _ in goals for name in goal}
    start = {name: here[name] for name in names}
    legs = []
    for goal, seconds in goals:
        end = {**start, **goal}
        least = max(
            abs(end[name] - start[name]) * peak / shape.joints[name].speed for name in names
        )
        legs.append(Leg(start, end, max(seconds, least)))
        start = end
    return legs


class Line:
    """Goes along straight lines in the space of joints: gaze, pose, poses, home, the way back."""

    over = False
    wish: Wish | None = None

    def __init__(
        self, name: str, legs: list[Leg], easing: str, token: int = 0, *, returning: bool = False
    ) -> None:
        self.name = name
        self.token = token
        #: Whether it leads to where the body belongs, so that the stop lets it go on.
        self.returning = returning
        self.joints = set(legs[0].start)
        self.seconds = sum(leg.seconds for leg in legs)
        self._legs = legs
        self._ease, _ = EASE[easing]
        self._elapsed = 0.0

    def step(self, moment: Moment) -> Mapping[str, float]:
        """Where the joints are on their way; those that take no part stay."""
        self._elapsed += moment.dt
        pose = dict(moment.base)
        since = self._elapsed
        for leg in self._legs:
            if since < leg.seconds - INSTANT_S:
                break
            since -= leg.seconds
        else:
            self.over = True
            since = leg.seconds
        share = self._ease(since / leg.seconds) if leg.seconds > 0.0 else 1.0
        for joint in self.joints:
            start = leg.start[joint]
            pose[joint] = start + (leg.goal[joint] - start) * share
        return pose


class Playing:
    """Plays a move around the pose that it began at.

    Args:
        move: What to play.
        shape: Shares out what the move wants of roles. A role without joints goes to the eyes:
            pan sideways, nod down.
        speed: Of this time; 1 is as written.
        amplitude: Of this time; 1 is as written.
        token: Named when it is over.
        own_pace: Whether the personality's speed and amplitude do not count.
    """

    def __init__(
        self,
        move: Move,
        shape: BodyShape,
        speed: float,
        amplitude: float,
        token: int,
        *,
        own_pace: bool = False,
    ) -> None:
        self.move = move
        self.name = move.name
        self.token = token
        self.cues: list[Cue] = []
        self.wish: Wish | None = None
        self._shape = shape
        self._speed = speed
        self._amplitude = amplitude
        self._own_pace = own_pace
        self._place = 0.0
        self._cued = -1.0

    @property
    def over(self) -> bool:
        """Whether the move has come to its end."""
        return self._place >= self.move.length - INSTANT_S

    def rate(self, tempo: float, speed: float) -> float:
        """How much of the move passes in a second."""
        pace = self._speed if self._own_pace else self._speed * speed
        return pace * tempo if self.move.beats else pace

    def step(self, moment: Moment) -> Mapping[str, float]:
        """The move's posture at its place now."""
        gone = moment.dt * self.rate(moment.tempo, moment.speed)
        self._place = min(self.move.length, self._place + gone)
        if self.over:
            self._place = self.move.length
        self.cues = [cue for cue in self.move.cues if self._cued < cue.at <= self._place]
        self._cued = self._place
        posture = self.move.at(self._place)
        size = self._amplitude if self._own_pace else self._amplitude * moment.amplitude
        pose = dict(moment.base)
        for joint, angle in posture.places.items():
            if joint in pose:
                pose[joint] = angle
        for joint, angle in posture.joints.items():
            if joint in pose:
                pose[joint] += size * angle
        self.wish = Wish(posture.face, self._shared(posture.roles, size, pose))
        if not all(map(math.isfinite, pose.values())):
            raise ValueError(f"the move {self.name!r} wants an angle that is no number")
        return pose

    def _shared(
        self, roles: Mapping[str, float], size: float, pose: dict[str, float]
    ) -> tuple[float, float]:
        """Adds the roles to the joints that have them; returns what is left for the eyes."""
        eyes = [0.0, 0.0]
        across, down = self._shape.saccade
        for role, angle in roles.items():
            shares = self._shape.roles.get(role)
            if shares:
                for joint, share in shares.items():
                    pose[joint] += size * share * angle
            elif role == "pan":
                eyes[0] += size * angle / across
            elif role == "nod":
                eyes[1] -= size * angle / down
        return eyes[0], eyes[1]


@dataclass
class Following:
    """Follows what the camera sees."""

    tracker: Tracker
    token: int = 0
    name: str = "tracking"
    over: bool = False
    wish: Wish | None = field(default=None)

    def step(self, moment: Moment) -> Mapping[str, float]:
        """Where the tracker wants the joints, and what it feels."""
        tracked = self.tracker.step(moment.t, moment.seen, moment.joints)
        pose = {**moment.base, **tracked.joints}
        if not all(map(math.isfinite, pose.values())):
            raise ValueError("tracking wants an angle that is no number")
        face = FaceWish(emotion=tracked.emotion or None, intensity=tracked.intensity)
        self.wish = Wish(face)
        return pose
