"""Sources of a body's pose, one at a time: holding, lines, moves, tracking, saccade following.

Each is asked once a tick for the whole pose. None knows of ranges, speeds or of what was before:
that is the layers' and safety's business.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from woz_tui.motion.body_feeds import Sighting
from woz_tui.motion.body_shape import BodyShape, Vector
from woz_tui.motion.easing import EASINGS, PEAK_SPEEDS, low_pass
from woz_tui.motion.kinematics import KinematicChain, cross
from woz_tui.motion.move_types import FaceChange, Move, SoundCue, stroke_of

# -- tracking -------------------------------------------------------------------------------------
# Object tracking: the head turns to what the camera sees, and the face tells how that feels.
#
# Every picture says where its object is from where the head was when it was taken; the two together
# are a place that stays when the head moves on. So the head approaches that place, and neither the
# age of a picture nor the speed of the joints makes it swing.

#: Without a sighting for longer than this, in seconds, joy does not grow any more.
_GAP_S = 0.5
#: The time constant of the way home, in seconds.
_HOME_S = 0.6
#: A joint's turn that moves the gaze by less than this share counts as this much: where the head
#: looks straight down, panning turns the picture and leads nowhere.
_LEAST_EFFECT = 0.2
_UP: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class TrackingResult:
    """What tracking wants at one moment: every joint, in degrees and in range; what it feels.

    An empty `emotion` (and no `intensity`) leaves the face as it is. `homing`: nothing was seen
    for so long that it has given up.
    """

    joints: Mapping[str, float]
    emotion: str = ""
    intensity: float | None = None
    homing: bool = False


class ObjectTracker:
    """Follows one object, from `begin` on. Times are seconds of any clock that runs forward."""

    def __init__(self, shape: BodyShape, chain: KinematicChain) -> None:
        self._shape = shape
        self._settings = shape.tracking
        self._chain = chain
        self._home = {name: joint.home for name, joint in shape.joints.items()}
        self.begin(0.0, self._home)

    def begin(self, t: float, joints: Mapping[str, float]) -> None:
        """Start at `t` from the pose `joints`, in degrees, having seen nothing yet."""
        known = {name: angle for name, angle in joints.items() if math.isfinite(angle)}
        self._wanted = self._bounded({**self._home, **known})
        self._goal = dict(self._wanted)
        self._past: deque[tuple[float, Mapping[str, float]]] = deque()
        self._frame: int | None = None
        self._t = self._sighted = t
        self._joy: float | None = None

    def step(self, t: float, seen: Sighting | None, joints: Mapping[str, float]) -> TrackingResult:
        """What is wanted at `t`, from what the camera saw last and where the joints are now.

        A picture counts once, by its `frame`. A camera that falls silent sees nothing.
        """
        elapsed = t - self._t
        elapsed = elapsed if math.isfinite(elapsed) and elapsed > 0 else 0.0
        self._t += elapsed
        self._remember(joints)
        unseen = self._t - self._sighted
        sighting = self._sighting(seen)
        if sighting is not None:
            if self._joy is None or unseen >= self._settings.sad_after:
                self._joy = 0.0
            self._sighted, unseen = self._t, 0.0
            self._turn_to(*sighting)
        if self._joy is not None and unseen <= _GAP_S:
            self._joy = min(1.0, self._joy + elapsed / self._settings.happy_in)
        sad, home = self._settings.sad_after, self._settings.home_after
        if unseen >= home:
            self._goal = dict(self._home)
            self._approach(elapsed / _HOME_S)
            return TrackingResult(dict(self._wanted), "neutral", 0.0, homing=True)
        self._approach(elapsed * self._settings.gain)
        if unseen >= sad:
            return TrackingResult(dict(self._wanted), "sad", (unseen - sad) / (home - sad))
        if self._joy is None:
            return TrackingResult(dict(self._wanted))
        return TrackingResult(dict(self._wanted), "happy", self._joy)

    # -- seeing --------------------------------------------------------------------------------

    def _sighting(self, seen: Sighting | None) -> tuple[float, float] | None:
        """Where a new picture has the object: degrees to the left and up of its middle."""
        if seen is None or seen.frame == self._frame:
            return None
        self._frame = seen.frame
        if seen.x is None or seen.y is None or not math.isfinite(seen.x + seen.y):
            return None
        across, down = self._settings.field_of_view
        return -_angle(seen.x, across), -_angle(seen.y, down)

    def _remember(self, joints: Mapping[str, float]) -> None:
        """Keep the poses of as long as a picture is old."""
        now = {
            name: joints[name] if math.isfinite(joints.get(name, math.nan)) else wanted
            for name, wanted in self._wanted.items()
        }
        self._past.append((self._t, now))
        while len(self._past) > 1 and self._past[1][0] <= self._t - self._settings.latency:
            self._past.popleft()

    # -- turning -------------------------------------------------------------------------------

    def _turn_to(self, left: float, up: float) -> None:
        """The goal is the pose of the picture, turned by what it shows."""
        pose = dict(self._past[0][1])
        for role, angle in (("pan", left), ("nod", -up)):
            effect = self._effect(role, pose)
            if effect is not None:
                for joint, share in self._shape.roles[role].items():
                    pose[joint] += share * angle / effect
        self._goal = self._bounded(pose)

    def _effect(self, role: str, pose: Mapping[str, float]) -> float | None:
        """Degrees by which the gaze turns left (pan) or down (nod) for one degree of a role.

        None if the body has no such role. In a chain this is hardly ever 1: shares need not add up,
        axes may point either way, and the head may look down while it pans.
        """
        shares = self._shape.roles.get(role)
        if not shares:
            return None
        nudged = {name: angle + shares.get(name, 0.0) for name, angle in pose.items()}
        _, gaze = self._chain.ray(pose)
        _, moved = self._chain.ray(nudged)
        left = _across(gaze)
        axis = left if role == "pan" else cross(left, gaze)
        effect = math.degrees(sum((b - a) * c for a, b, c in zip(gaze, moved, axis, strict=True)))
        return math.copysign(max(abs(effect), _LEAST_EFFECT), effect)

    def _approach(self, time_constants: float) -> None:
        share = 1 - math.exp(-time_constants)
        for name, goal in self._goal.items():
            self._wanted[name] += share * (goal - self._wanted[name])

    def _bounded(self, pose: Mapping[str, float]) -> dict[str, float]:
        return {name: joint.within(pose[name]) for name, joint in self._shape.joints.items()}


def _angle(place: float, width: float) -> float:
    """The angle at which something is seen that lies at `place` (-1..1) of a flat picture."""
    edge = math.tan(math.radians(width / 2))
    return math.degrees(math.atan(min(max(place, -1.0), 1.0) * edge))


def _across(gaze: Vector) -> Vector:
    """The unit vector to the left of where the eyes look, level."""
    left = cross(_UP, gaze)
    length = math.hypot(*left)
    if length < 1e-6:  # straight up or down
        return (0.0, 1.0, 0.0)
    return (left[0] / length, left[1] / length, left[2] / length)


# --------------------------------------------------------------------------------------------------

#: Sums of ticks are this much too short or too long, in seconds; what is due then is due now.
INSTANT_S = 1e-9


@dataclass(slots=True)
class SourceContext:
    """What a source of the pose may use.

    `dt` seconds since the last tick, `t` since the engine began; `base` the pose that it works
    on, `joints` where safety has let the joints come, all in degrees. `tempo` in Hz, `speed` and
    `amplitude` are the personality's.
    """

    dt: float
    t: float
    base: Mapping[str, float]
    joints: Mapping[str, float]
    seen: Sighting | None
    tempo: float
    speed: float
    amplitude: float


@dataclass(slots=True)
class FaceOverlay:
    """What a source wants of the face; `glance` is added to where the eyes look, -1..1."""

    face: FaceChange | None = None
    glance: tuple[float, float] = (0.0, 0.0)


class PoseSource:
    """Decides about the pose, tick by tick; by default the pose that people want."""

    #: 0 if nobody waits for its end.
    token = 0
    #: What it is called in sentences.
    name = ""
    #: Whether it has come to its own end.
    over = False
    #: What it wants of the face, as of the last step.
    face_overlay: FaceOverlay | None = None

    def step(self, moment: SourceContext) -> Mapping[str, float]:
        """The pose, in degrees, of every joint."""
        return moment.base


class Hold(PoseSource):
    """Stays at the pose that people want."""


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
    peak = PEAK_SPEEDS[easing]
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


class LinearMotion(PoseSource):
    """Goes along straight lines in the space of joints: gaze, pose, poses, home, the way back."""

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
        self._ease = EASINGS[easing]
        self._elapsed = 0.0

    def step(self, moment: SourceContext) -> Mapping[str, float]:
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


class MovePlayback(PoseSource):
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
        self.cues: list[SoundCue] = []
        #: Whether this moment is its stroke.
        self.strikes = False
        self._stroke = stroke_of(move)
        self._shape = shape
        self._speed = speed
        self._amplitude = amplitude
        self._own_pace = own_pace
        self._place = 0.0
        self._cued = -1.0

    def rate(self, tempo: float, speed: float) -> float:
        """How much of the move passes in a second."""
        pace = self._speed if self._own_pace else self._speed * speed
        return pace * tempo if self.move.beats else pace

    def foreseen(self, tempo: float, speed: float) -> tuple[float, float | None]:
        """How many seconds it takes, and after how many its stroke comes, from its beginning."""
        rate = self.rate(tempo, speed)
        return self.move.length / rate, None if self._stroke is None else self._stroke / rate

    def step(self, moment: SourceContext) -> Mapping[str, float]:
        """The move's posture at its place now."""
        passed = moment.dt * self.rate(moment.tempo, moment.speed)
        self._place = min(self.move.length, self._place + passed)
        self.over = self._place >= self.move.length - INSTANT_S
        if self.over:
            self._place = self.move.length
        self.cues = [cue for cue in self.move.cues if self._cued < cue.at <= self._place]
        stroke = self._stroke
        self.strikes = stroke is not None and self._cued < stroke <= self._place
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
        self.face_overlay = FaceOverlay(posture.face, self._shared(posture.roles, size, pose))
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


class ObjectFollowing(PoseSource):
    """Follows what the camera sees."""

    name = "tracking"

    def __init__(self, tracker: ObjectTracker) -> None:
        self.tracker = tracker

    def step(self, moment: SourceContext) -> Mapping[str, float]:
        """Where the tracker wants the joints, and what it feels."""
        tracked = self.tracker.step(moment.t, moment.seen, moment.joints)
        pose = {**moment.base, **tracked.joints}
        if not all(map(math.isfinite, pose.values())):
            raise ValueError("tracking wants an angle that is no number")
        face = FaceChange(emotion=tracked.emotion or None, intensity=tracked.intensity)
        self.face_overlay = FaceOverlay(face)
        return pose


# -- saccade --------------------------------------------------------------------------------------
# Saccade following: the eyes jump to where they shall look, the head comes after them.
#
# The head is a low-pass in the space of joints towards the pose that looks there; the eyes make up
# for whatever the head still lacks, so the gaze in space stays on its target all the way, and they
# are back in the middle of the face when the head has arrived. Where joints end, the eyes keep the
# rest, as far as they can turn.

#: Time constant with which the head follows, in seconds.
FOLLOWS_S = 0.25
#: Where the eye position's ends (1 and -1) lie: degrees sideways, up and down, from straight
#: ahead of the pose in which the mode began.
SPAN = (60.0, 40.0)
#: No gaze goes further up or down than this, in degrees: there is no "sideways" at the zenith.
STEEPEST = 89.0


def gaze_direction(chain: KinematicChain, joints: Mapping[str, float]) -> tuple[float, float]:
    """Where the head looks: yaw to its left, pitch upwards, in degrees."""
    _, (x, y, z) = chain.ray(joints)
    return math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, math.hypot(x, y)))


class SaccadeFollowing(PoseSource):
    """The primary of the mode.

    Args:
        chain: Of the body.
        shape: How far the eyes may lead the head.
        pose: Where the joints are; straight ahead of it is the middle of the eye position.
        eyes: Where the eyes look on the face now; the head begins by following them.
    """

    name = "saccade"

    def __init__(
        self,
        chain: KinematicChain,
        shape: BodyShape,
        pose: Mapping[str, float],
        eyes: tuple[float, float],
    ) -> None:
        self._chain = chain
        self._lead = shape.saccade
        self._begun = dict(pose)
        self._pose = dict(pose)
        self._goal: Mapping[str, float] = self._begun
        self._ahead = gaze_direction(chain, pose)
        self._target = self._ahead
        if eyes != (0.0, 0.0):
            self._turn_to(eyes, self._lead)

    def look_at(self, x: float, y: float) -> None:
        """Look there, -1..1 of `SPAN`."""
        self._turn_to((x, y), SPAN)

    def step(self, moment: SourceContext) -> Mapping[str, float]:
        """Where the head has got to."""
        for joint, angle in self._goal.items():
            self._pose[joint] = low_pass(self._pose[joint], angle, FOLLOWS_S, moment.dt)
        return self._pose

    def eyes(self, joints: Mapping[str, float]) -> tuple[float, float]:
        """Where the eyes look on the face, -1..1, with the head at `joints`."""
        yaw, pitch = gaze_direction(self._chain, joints)
        across = (self._target[0] - yaw + 180.0) % 360.0 - 180.0
        return _unit(across / self._lead[0]), _unit((self._target[1] - pitch) / self._lead[1])

    def _turn_to(self, place: tuple[float, float], span: tuple[float, float]) -> None:
        yaw = (self._ahead[0] + place[0] * span[0] + 180.0) % 360.0 - 180.0
        pitch = min(STEEPEST, max(-STEEPEST, self._ahead[1] + place[1] * span[1]))
        self._target = (yaw, pitch)
        # From the pose of the beginning, so that the same place is the same pose each time.
        away = place != (0.0, 0.0)
        self._goal = self._chain.aim_along(yaw, pitch, self._begun).joints if away else self._begun


def _unit(value: float) -> float:
    return min(1.0, max(-1.0, value))
