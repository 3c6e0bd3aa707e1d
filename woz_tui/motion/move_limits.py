"""What a move asks of a body's joints that is beyond their speed: wanted beside sent."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, MoveLayer
from woz_tui.motion.pose_sources import MovePlayback, SourceContext
from woz_tui.motion.safety import LimitedJoint, Limits
from woz_tui.protocol.sentence import Sentence

#: Steps a second in which a move is looked at.
RATE = 100
#: A way of fewer degrees is none; what is missing counts from this share of it, and these degrees.
_LEAST_WAY, _SHARE, _MISSING = 2.0, 0.1, 3.0
#: The highest speed and acceleration of an easing, as a multiple of way / time and way / time
#: squared. A joint that goes at one speed or jumps begins and ends as hard as it can: there the
#: fastest way from rest to rest counts.
_PEAKS: Mapping[str, tuple[float, float]] = {
    "linear": (1.0, 4.0),
    "smooth": (1.5, 6.0),
    "minimum-jerk": (1.875, 10.0 / math.sqrt(3.0)),
    "hold": (1.0, 4.0),
}


@dataclass(frozen=True, slots=True)
class Shortfall:
    """A joint does not get to where a frame wants it.

    `frame` counts from 1 in its `layer`; `way` and `reached` in degrees, `speed` and `limit` in
    degrees a second, `needs` seconds in which it would be reached from rest to rest. `goal`: the
    angle that it wants, where the joint's range ends before it, at `end`.
    """

    layer: str
    frame: int
    joint: str
    way: float
    reached: float
    speed: float
    limit: float
    needs: float
    goal: float | None = None
    end: float = 0.0

    @property
    def sentence(self) -> Sentence:
        """Why, and how far it gets."""
        if self.goal is not None:
            return Sentence(
                "move.range_ends",
                "wants {joint} at {goal:.0f} degrees from the home pose, but its range ends at"
                " {end:g}: it gets {reached:.0f} of {way:.0f} degrees far",
                joint=self.joint,
                goal=self.goal,
                end=self.end,
                reached=self.reached,
                way=self.way,
            )
        asked = (
            Sentence(
                "move.asks_speed",
                "asks {speed:.0f} deg/s of {joint} (at most {limit:g})",
                speed=self.speed,
                joint=self.joint,
                limit=self.limit,
            )
            if self.speed > self.limit
            else Sentence(
                "move.asks_start", "asks too hard a start and stop of {joint}", joint=self.joint
            )
        )
        return Sentence(
            "move.gets_so_far",
            "{asked}: it gets {reached:.0f} of {way:.0f} degrees far, and needs {needs:.2f} s",
            asked=asked,
            reached=self.reached,
            way=self.way,
            needs=self.needs,
        )

    def __str__(self) -> str:
        return str(self.sentence)


def shortfalls(move: KeyframeMove, shape: BodyShape) -> list[Shortfall]:
    """Frames that the joints of a body do not reach in time, played from its home pose as written.

    A frame of which more than 10 % and more than 3 degrees are missing counts, because nobody sees
    less; a `hold` jumps on purpose, and does not.
    """
    timed = [(layer, pair) for layer in move.layers for pair in _ways(layer)]
    if not timed:
        return []
    wanted, sent = _courses(move, shape)
    pace = shape.personality.tempo if move.beats else 1.0
    missing = []
    for layer, (number, before, frame, after) in timed:
        begin, end, until = (
            round(place / pace * RATE) for place in (before, frame.at, after or move.length)
        )
        for joint in _moved(frame, shape):
            limits = Limits.of(shape.joints[joint])
            goal = wanted[joint][end]
            way = goal - wanted[joint][begin]
            course = sent[joint][begin : until + 1]
            reached = max((at - wanted[joint][begin]) * math.copysign(1.0, way) for at in course)
            lack = abs(way) - reached
            if abs(way) < _LEAST_WAY or lack <= max(_MISSING, _SHARE * abs(way)):
                continue
            fastest, hardest = _PEAKS[frame.easing]
            seconds = (frame.at - before) / pace
            needs = abs(way) * fastest / limits.speed
            if limits.acceleration is not None:
                needs = max(needs, math.sqrt(abs(way) * hardest / limits.acceleration))
            speed = abs(way) * fastest / seconds
            end_of_range = limits.clamp(goal)
            missing.append(
                Shortfall(
                    *(layer.name, number, joint, abs(way), max(0.0, reached), speed),
                    *(limits.speed, needs),
                    goal if abs(goal - end_of_range) > _MISSING else None,
                    end_of_range,
                )
            )
    return missing


def _ways(layer: MoveLayer) -> Iterator[tuple[int, float, KeyFrame, float | None]]:
    """Frames that take time, each with its number, the place before it and the one behind it."""
    if layer.muted or layer.share <= 0:
        return
    places = [0.0, *(frame.at for frame in layer.frames)]
    following = [*places[2:], None]
    for number, (frame, before, after) in enumerate(
        zip(layer.frames, places, following, strict=False), start=1
    ):
        if frame.at > before and frame.easing != "hold" and (frame.roles or frame.joints):
            yield number, before, frame, after


def _moved(frame: KeyFrame, shape: BodyShape) -> list[str]:
    """The joints that a frame names, by themselves or by roles."""
    of_roles = itertools.chain.from_iterable(shape.roles.get(role, {}) for role in frame.roles)
    return [*dict.fromkeys((*frame.joints, *of_roles))]


def _courses(
    move: KeyframeMove, shape: BodyShape
) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """What the move wants of each joint at each step, and what is sent."""
    home = {name: joint.home for name, joint in shape.joints.items()}
    joints = {
        name: LimitedJoint(Limits.of(joint), joint.home) for name, joint in shape.joints.items()
    }
    playback = MovePlayback(move, shape, 1.0, 1.0, 0, own_pace=True)
    moment = SourceContext(0.0, 0.0, home, home, None, shape.personality.tempo, 1.0, 1.0)
    wanted: dict[str, list[float]] = {name: [] for name in joints}
    sent: dict[str, list[float]] = {name: [] for name in joints}
    dt = 0.0
    while True:
        moment.dt = dt
        pose = playback.step(moment)
        for name, joint in joints.items():
            wanted[name].append(pose[name])
            sent[name].append(joint.step(pose[name], dt) if dt else joint.position)
        if playback.over:
            return wanted, sent
        dt = 1 / RATE
