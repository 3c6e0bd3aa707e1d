"""Which face is the one from before, which of them looks at the robot, and who is addressed.

Arithmetic on the lines of the finding program; no thread, no clock. Times are in microseconds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from woz_drivers.faces.face_lines import SeenFace

#: A face that may begin a track has this score at least, and is found in so many pictures.
_BEGINS, _PICTURES = 0.5, 2
#: which lie no farther apart than this (small faces are looked for in every second one).
_WAITS_US = 250_000
#: A face is the one from before if its middle is nearer than this to where that was to be expected,
#: in widths of its box (more with each second that it was not found), and neither is more than so
#: many times as large as the other.
_NEAR, _MORE, _LARGER = 0.8, 0.8, 2.0
#: Motion goes on for so long in a face that is not found, in seconds.
_COASTS_S = 1.0
#: Of a face's speed so much is the newest; pictures closer together than this give none.
_NEWEST, _SHORTEST_S = 0.3, 0.005
#: Width of a face between its sides, in m: the mean of adults (bizygomatic breadth with skin).
FACE_M = 0.14
#: Somebody who looks goes on looking until the gaze is so much farther away, in degrees.
_HYSTERESIS = 5.0
#: Somebody else is addressed once the rule has wanted that for so long, in seconds.
SWITCHES_S = 1.0


@dataclass(slots=True)
class FaceTrack:
    """One person's face over time.

    `angle`: how many degrees the gaze is away from the robot, `looks` the verdict; None: nobody
    knows. `distance` in m, `direction` in degrees to the left.
    """

    id: int
    face: SeenFace
    seen_us: int
    pictures: int = 1
    speed: tuple[float, float] = (0.0, 0.0)
    angle: float | None = None
    looks: bool | None = None
    distance: float = 0.0
    direction: float = 0.0

    def place(self, now_us: int) -> tuple[float, float]:
        """Where its middle is to be expected, in pixels."""
        x, y = middle(self.face)
        ahead = min((now_us - self.seen_us) / 1e6, _COASTS_S)
        return x + self.speed[0] * ahead, y + self.speed[1] * ahead


def middle(face: SeenFace) -> tuple[float, float]:
    """The middle of a face's box, in pixels."""
    return (face.left + face.right) / 2, (face.top + face.bottom) / 2


def _size(face: SeenFace) -> float:
    return max(face.right - face.left, face.bottom - face.top, 1.0)


class FaceTracker:
    """Gives each face a number that stays, whatever else comes and goes."""

    def __init__(self, hold_s: float) -> None:
        """`hold_s`: somebody whose face is not found is still there for so long."""
        self._hold_us = round(hold_s * 1e6)
        self._tracks: list[FaceTrack] = []
        self._last = 0
        #: When the last picture was taken.
        self._updated_us = 0

    def forget(self) -> None:
        """Nobody is there; numbers are never given twice."""
        self._tracks.clear()

    def update(self, faces: Sequence[SeenFace], now_us: int) -> list[FaceTrack]:
        """Take the faces of a picture; all who are there, oldest first."""
        before_us, self._updated_us = self._updated_us, now_us
        self._tracks = [
            one for one in self._tracks if one.seen_us == before_us or self._stays(one, now_us)
        ]
        pairs = sorted(
            (off, index, number)
            for index, track in enumerate(self._tracks)
            for number, face in enumerate(faces)
            if (off := _away(track, face, now_us)) < _NEAR + _MORE * (now_us - track.seen_us) / 1e6
        )
        tracks, found = set[int](), set[int]()
        for _, index, number in pairs:
            if index not in tracks and number not in found:
                tracks.add(index)
                found.add(number)
                self._follow(self._tracks[index], faces[number], now_us)
        self._tracks = [one for one in self._tracks if self._stays(one, now_us)]
        for number, face in enumerate(faces):
            if number not in found and face.score >= _BEGINS:
                self._last += 1
                self._tracks.append(FaceTrack(self._last, face, now_us))
        return [one for one in self._tracks if one.pictures >= _PICTURES]

    def _stays(self, track: FaceTrack, now_us: int) -> bool:
        """One found once alone was none."""
        hold_us = _WAITS_US if track.pictures < _PICTURES else self._hold_us
        return now_us - track.seen_us <= hold_us

    def _follow(self, track: FaceTrack, face: SeenFace, now_us: int) -> None:
        seconds = (now_us - track.seen_us) / 1e6
        if seconds >= _SHORTEST_S:
            (x, y), (was_x, was_y) = middle(face), middle(track.face)
            old, new = 1 - _NEWEST, _NEWEST / seconds
            track.speed = (
                old * track.speed[0] + new * (x - was_x),
                old * track.speed[1] + new * (y - was_y),
            )
        track.face, track.seen_us, track.pictures = face, now_us, track.pictures + 1


def _away(track: FaceTrack, face: SeenFace, now_us: int) -> float:
    """How far a face is from where a track's is expected, in widths; infinite if it is too large
    or small.
    """
    one, other = _size(track.face), _size(face)
    if max(one, other) > _LARGER * min(one, other):
        return math.inf
    x, y = middle(face)
    at_x, at_y = track.place(now_us)
    return math.hypot(x - at_x, y - at_y) / ((one + other) / 2)


def distance_of(face: SeenFace, focal: float) -> float:
    """How far away a face is, in m; `focal`: the lens' focal length in pixels."""
    return FACE_M * focal / max(face.width, 1.0)


def direction_of(face: SeenFace, pixels: int, focal: float) -> float:
    """How many degrees to the left of the middle of a picture of so many pixels a face is."""
    x, _ = middle(face)
    return math.degrees(math.atan2(pixels / 2 - x, focal))


# -- gaze ------------------------------------------------------------------------------------------


def gaze_of(face: SeenFace) -> tuple[float, float] | None:
    """Yaw and pitch of head and eyes together, in degrees; None where it does not tell."""
    if face.yaw is None or face.pitch is None:
        return None
    return face.yaw + (face.eyes_yaw or 0.0), face.pitch


def judge_gaze(track: FaceTrack, neutral: tuple[float, float], within: float) -> None:
    """Find out whether somebody looks at the robot: at most `within` degrees from `neutral`."""
    gaze = gaze_of(track.face)
    if gaze is None:
        track.angle = track.looks = None
        return
    track.angle = math.hypot(gaze[0] - neutral[0], gaze[1] - neutral[1])
    track.looks = track.angle <= within + (_HYSTERESIS if track.looks else 0.0)


# -- who is addressed ------------------------------------------------------------------------------


@dataclass(slots=True)
class AddressedPerson:
    """Whose signs count: whom the wizard has chosen as long as they are there, else by rule the
    nearest who looks, else who was it before, else the nearest.
    """

    id: int | None = None
    by_hand: bool = False
    _other: int | None = field(default=None)
    _since_us: int = field(default=0)

    def choose(self, id_: int | None) -> None:
        """Address this person from now on; None: by the rule."""
        self.by_hand = id_ is not None
        if id_ is not None:
            self.id = id_

    def next_of(self, there: Sequence[FaceTrack]) -> int | None:
        """The person after the one who is addressed, in the order of their numbers."""
        ids = sorted(one.id for one in there)
        later = [one for one in ids if self.id is not None and one > self.id]
        return next(iter(later or ids), None)

    def update(self, there: Iterable[FaceTrack], now_us: int) -> FaceTrack | None:
        """Who it is, of those who are there."""
        tracks = {one.id: one for one in there}
        if self.id not in tracks:
            self.by_hand, self.id = False, _nearest_who_looks(tracks.values(), None)
        wanted = self.id if self.by_hand else _nearest_who_looks(tracks.values(), self.id)
        if wanted == self.id:
            self._other = None
        elif wanted != self._other:
            self._other, self._since_us = wanted, now_us
        elif now_us - self._since_us >= SWITCHES_S * 1e6:
            self.id, self._other = wanted, None
        return None if self.id is None else tracks[self.id]


def _nearest_who_looks(tracks: Iterable[FaceTrack], now: int | None) -> int | None:
    there = [*tracks]
    looking = [one for one in there if one.looks]
    if not looking and now is not None:
        return now
    nearest = min(looking or there, key=lambda one: one.distance, default=None)
    return None if nearest is None else nearest.id
