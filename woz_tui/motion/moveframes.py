"""The frames and the samples of a move file's layer."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from woz_tui.core.fields import Range
from woz_tui.experiment.nodes import Items
from woz_tui.experiment.report import quoted
from woz_tui.experiment.settings import resolved
from woz_tui.experiment.spot import Spot, missing, read_number, read_seconds, read_text, read_word
from woz_tui.motion.easing import EASINGS
from woz_tui.motion.inputs import EMOTIONS
from woz_tui.motion.keyframes import PLACE_DECIMALS, KeyFrame, Samples
from woz_tui.motion.shapes import ROLES, BodyShape, JointShape

#: What a frame may say beside names of roles and joints.
FRAME = (
    *("seconds", "beats", "at", "easing", "emotion", "intensity", "eyes", "lid"),
    *("sound", "volume", "roles", "joints"),
)
#: Degrees that a frame may name at most, and seconds or beats it may take.
ANGLES = Range(-360, 360, "deg")
LENGTHS = Range(0, 600)
RATES = Range(0.1, 1000)
UNIT = Range(0, 1)
BOTH = Range(-1, 1)
#: Range of each number of a face.
FEATURE_RANGES: Mapping[str, Range] = {"x": BOTH, "y": BOTH, "lid": UNIT, "intensity": UNIT}

_SAMPLE = re.compile(r"[-+]?(\d{1,9}(\.\d{0,60})?|\.\d{1,60})([eE][-+]?\d{1,3})?")


class FrameReader:
    """Reads one layer's angles and times; `named` collects the roles and joints it met."""

    def __init__(self, shape: BodyShape, *, beats: bool, relative: bool) -> None:
        self._joints = shape.joints
        self._beats = beats
        self._relative = relative
        self.named: set[str] = set()

    def read(self, spot: Spot) -> tuple[KeyFrame, ...]:
        """All frames that are right."""
        entries = spot.list("a list of frames, such as [{seconds: 0.3, nod: 12}]")
        if entries is not None and not entries:
            spot.error("no frame stands here")
        frames: list[KeyFrame] = []
        before = 0.0
        for index, entry in enumerate(entries or ()):
            table = entry.table("a frame, such as {seconds: 0.3, nod: 12}")
            if table is None:
                continue
            place = self._place(entry, table, before, first=index == 0)
            before = before if place is None else place
            frames.append(self._frame(table, before))
        return tuple(frames)

    # -- when -----------------------------------------------------------------------------------

    def _place(
        self, spot: Spot, table: dict[str, Spot], before: float, *, first: bool
    ) -> float | None:
        unit, other = ("beats", "seconds") if self._beats else ("seconds", "beats")
        if (wrong := table.get(other)) is not None:
            said = "true" if self._beats else "false"
            wrong.error(f"this move counts {unit} (beats: {said}); write {unit} here")
            return None
        took, at = table.get(unit), table.get("at")
        if took is not None and at is not None:
            at.error(f"write either {unit}, from the frame before, or at, from the beginning")
            return None
        if at is not None:
            return self._moment(at, before, first=first)
        if took is None:
            missing(table, unit, spot, "how long it takes from the frame before")
            return None
        length = self._duration(took)
        if length is not None and length <= 0 and not first:
            took.error("must be more than 0; only the first frame may be at the very beginning")
            return None
        return None if length is None else round(before + length, PLACE_DECIMALS)

    def _moment(self, spot: Spot, before: float, *, first: bool) -> float | None:
        at = self._duration(spot)
        if at is None or (first and at >= 0) or at > before:
            return None if at is None else round(at, PLACE_DECIMALS)
        spot.error(f"{at:g} is not after the frame before, which is at {before:g}")
        return None

    def _duration(self, spot: Spot) -> float | None:
        return read_number(spot, LENGTHS) if self._beats else read_seconds(spot, LENGTHS)

    # -- what -----------------------------------------------------------------------------------

    def _frame(self, table: dict[str, Spot], at: float) -> KeyFrame:
        roles, joints = self._angles(table)
        easing = table.get("easing")
        return KeyFrame(
            at,
            roles,
            joints,
            easing=(easing and read_word(easing, EASINGS)) or "smooth",
            **_face(table),
            **_sound(table),
        )

    def _angles(self, table: dict[str, Spot]) -> tuple[dict[str, float], dict[str, float]]:
        roles: dict[str, float] = {}
        joints: dict[str, float] = {}
        for name, entry in table.items():
            if name in FRAME:
                continue
            if self.is_joint(name):
                self._put(joints, name, self.joint(entry, name))
            elif name in ROLES:
                self._put(roles, name, read_number(entry, ANGLES))
            else:
                entry.unknown((*ROLES, *self._joints, *FRAME), "a frame may name")
        for name, entry in self._below(table, "roles", ROLES):
            self._put(roles, name, read_number(entry, ANGLES))
        for name, entry in self._below(table, "joints", self._joints):
            self._put(joints, name, self.joint(entry, name))
        return roles, joints

    def _below(
        self, table: dict[str, Spot], key: str, known: Mapping[str, Any] | tuple[str, ...]
    ) -> Iterator[tuple[str, Spot]]:
        spot = table.get(key)
        for name, entry in ((spot.table() if spot is not None else None) or {}).items():
            if name in known:
                yield name, entry
            else:
                entry.unknown(known, f"{key} are")

    def _put(self, angles: dict[str, float], name: str, angle: float | None) -> None:
        self.named.add(name)
        if angle is not None:
            angles[name] = angle

    def is_joint(self, name: str) -> bool:
        """Whether a name alone means a joint: what is both is a role, but among absolute angles."""
        return name in self._joints and (name not in ROLES or not self._relative)

    def joint(self, spot: Spot, name: str) -> float | None:
        """An angle of a joint: inside its range if it is absolute."""
        angle = read_number(spot, ANGLES)
        if angle is not None:
            self.check(spot, name, self._joints[name], (angle,))
        return angle

    def check(self, spot: Spot, name: str, joint: JointShape, angles: tuple[float, ...]) -> None:
        """Report the first angle that the joint cannot have."""
        for angle in angles:
            if not self._relative and not joint.min <= angle <= joint.max:
                spot.error(
                    f"{angle:g} lies outside the joint's range,"
                    f" {joint.min:g} to {joint.max:g} degrees"
                )
                return
            if self._relative and abs(angle) > joint.max - joint.min:
                spot.warning(
                    f"{angle:g} degrees are more than {name!r} can turn in all"
                    f" ({joint.max - joint.min:g})"
                )
                return

    def joints_known(self) -> Mapping[str, JointShape]:
        """The body's joints."""
        return self._joints


def _face(table: dict[str, Spot]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if (spot := table.get("emotion")) is not None:
        found["emotion"] = read_word(spot, EMOTIONS)
    for name in ("intensity", "lid"):
        if (spot := table.get(name)) is not None:
            found[name] = read_number(spot, UNIT)
    if (eyes := table.get("eyes")) is not None:
        for name, entry in (eyes.table("where they look, such as {x: 0.2, y: 0}") or {}).items():
            if name in ("x", "y"):
                found[name] = read_number(entry, BOTH)
            else:
                entry.unknown(("x", "y"), "eyes have")
    return found


def _sound(table: dict[str, Spot]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if (spot := table.get("sound")) is not None:
        text = read_text(spot, "a sound file")
        found["sound"] = resolved(spot, text, must_exist=True) if text else ""
    if (spot := table.get("volume")) is not None:
        if "sound" not in table:
            spot.warning("there is no sound in this frame")
        volume = read_number(spot, UNIT)
        found["volume"] = 1.0 if volume is None else volume
    return found


# -- samples ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ReadSamples:
    """Samples and the roles and joints they name."""

    values: Samples
    named: set[str]


def read_samples(spot: Spot, table: dict[str, Spot], reader: FrameReader) -> ReadSamples | None:
    """The dense part of a layer; None if it has none."""
    groups = [name for name in ("joints", "roles", "face") if name in table]
    if not groups:
        if "rate" in table:
            table["rate"].error("there are no samples: joints, roles or face are missing")
        return None
    rate_spot = missing(table, "rate", spot, "samples each second, or beat")
    rate = None if rate_spot is None else read_number(rate_spot, RATES)
    roles = _lists(table.get("roles"), dict.fromkeys(ROLES, ANGLES), "roles are")
    face = _lists(table.get("face"), FEATURE_RANGES, "samples of a face are")
    joints = _joint_lists(table.get("joints"), reader)
    return ReadSamples(Samples(rate or 1.0, roles, joints, face), {*roles, *joints})


def _joint_lists(spot: Spot | None, reader: FrameReader) -> dict[str, tuple[float, ...]]:
    known = reader.joints_known()
    lists = _lists(spot, dict.fromkeys(known, ANGLES), "joints are")
    for name, entry in spot.entries() if spot is not None else ():
        if name in lists:
            reader.check(entry, name, known[name], lists[name])
    return lists


def _lists(
    spot: Spot | None, ranges: Mapping[str, Range], listing: str
) -> dict[str, tuple[float, ...]]:
    lists = {}
    for name, entry in ((spot.table() if spot is not None else None) or {}).items():
        if name not in ranges:
            entry.unknown(ranges, listing)
            continue
        values = _numbers(entry, ranges[name])
        if values:
            lists[name] = values
    return lists


def _numbers(spot: Spot, allowed: Range) -> tuple[float, ...]:
    """A list of numbers, or a text of numbers with blanks between them."""
    if not isinstance(spot.node, Items):
        return _written(spot, read_text(spot, "numbers") or "", allowed)
    if not spot.node.nodes:
        spot.error("no number stands here")
    read = [read_number(entry, allowed) for entry in spot.items()]
    return tuple(number for number in read if number is not None)


def _written(spot: Spot, text: str, allowed: Range) -> tuple[float, ...]:
    values = []
    for index, word in enumerate(text.split()):
        number = float(word) if _SAMPLE.fullmatch(word) else None
        if number is None or not allowed.contains(number):
            wrong = "is no number" if number is None else f"is out of range; allowed is {allowed}"
            spot.error(f"sample {index + 1}: {quoted(word)} {wrong}")
            return ()
        values.append(number)
    return tuple(values)
