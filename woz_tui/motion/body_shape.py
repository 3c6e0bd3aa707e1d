"""What a body is made of, as a robot file describes it.

Decoded by the experiment room like any settings, so every mistake in a file gets its line. All
geometry is given for the pose in which every joint stands at 0 degrees, in the robot's own axes:
x forward, y to its left, z up, in metres. Nothing anywhere knows how many joints there are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Protocol

from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section
from woz_tui.motion.easing import PEAK_SPEEDS

Vector = tuple[float, float, float]

#: Directions that a joint's axis may have, as unit vectors.
AXES: Mapping[str, Vector] = {
    "x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}

#: What moves and gestures are written in: they are shared out among joints by `roles`.
#: pan turns the head to its left, nod makes it look down, lean raises it and draws it back (so a
#: negative lean brings it forward), roll cocks it to its right.
ROLES = ("pan", "nod", "lean", "roll")

#: How a gaze or a pose gets from here to there.
GAZE_EASINGS = tuple(PEAK_SPEEDS)

#: Settings that every `Settings` of a body is checked for, beside the joints' own.
_DEGREES = Range(-3600, 3600, "deg")


class Ranged(Protocol):
    @property
    def min(self) -> float: ...

    @property
    def max(self) -> float: ...


def _outside(path: str, joint: Ranged, angle: float | None) -> Iterator[tuple[str, str]]:
    if angle is not None and not joint.min <= angle <= joint.max:
        yield path, f"{angle:g} lies outside {joint.min:g} to {joint.max:g} degrees"


def range_problems(path: str, joint: Ranged, **angles: float | None) -> Iterator[tuple[str, str]]:
    """What is wrong with a joint's range, and with angles that its settings name."""
    if joint.min >= joint.max:
        yield f"{path}.min", f"{joint.min:g} is not below max ({joint.max:g})"
        return
    for key, angle in angles.items():
        yield from _outside(f"{path}.{key}", joint, angle)


def pose_problems(
    path: str, pose: Mapping[str, float], joints: Mapping[str, Ranged]
) -> Iterator[tuple[str, str]]:
    """Joints that there are not, and angles that they cannot have (NaN is none)."""
    for name, angle in pose.items():
        if name in joints:
            yield from _outside(f"{path}.{name}", joints[name], angle)
        else:
            known = ", ".join(joints)
            yield f"{path}.{name}", f"no joint is called {name!r}; there are {known}"


@dataclass(frozen=True, slots=True)
class JointShape:
    """One joint; joints stand in the file from the base up, each on the one before."""

    axis: Annotated[
        str, OneOf(tuple(AXES)), Doc("the axis it turns about with all joints at 0: z, -y ...")
    ]
    min: Annotated[float, _DEGREES, Doc("lowest angle")]
    max: Annotated[float, _DEGREES, Doc("highest angle")]
    speed: Annotated[float, Range(0.1, 3000, "deg/s"), Doc("never faster than this")]
    acceleration: Annotated[
        float | None, Range(1, 1_000_000, "deg/s2"), Doc("never a harder start or stop than this")
    ] = None
    offset: Annotated[
        Vector, Range(-10, 10, "m"), Doc("from the joint before (or the base) to this one")
    ] = (0.0, 0.0, 0.0)
    zero: Annotated[
        float, _DEGREES, Doc("added to every angle on its way to the servo: where its own 0 is")
    ] = 0.0
    home: Annotated[float, _DEGREES, Doc("angle of the home pose")] = 0.0
    start: Annotated[
        float | None, _DEGREES, Doc("angle when direct control begins; empty: home")
    ] = None

    def within(self, angle: float) -> float:
        """The nearest angle inside its range."""
        return min(self.max, max(self.min, angle))


@dataclass(frozen=True, slots=True)
class FaceShape:
    """The matrix of lights, and where the eyes are on it, counted from 0 at its upper left."""

    width: Annotated[int, Range(8, 128), Doc("lights a row")] = 24
    height: Annotated[int, Range(8, 64), Doc("rows")] = 16
    eye_radius: Annotated[float, Range(1, 20), Doc("of an open eye, in lights")] = 3.0
    eyes: Annotated[
        tuple[float, float] | None,
        Doc("columns of the eyes' middles; empty: a quarter from each side"),
    ] = None
    eye_row: Annotated[float | None, Doc("row of the eyes' middles; empty: just above half")] = None


@dataclass(frozen=True, slots=True)
class Personality:
    """How a body does whatever it does. Every value may change at any moment without a jump."""

    tempo: Annotated[
        float, Range(0.1, 5, "Hz"), Doc("beats a second of animations; breathing goes at a quarter")
    ] = 32 / 15
    breathing: Annotated[
        float, Range(0, 45, "deg"), Doc("amplitude of breathing; 0: it holds its breath")
    ] = 180 / 70
    breathing_rate: Annotated[
        float | None, Range(0.01, 3, "Hz"), Doc("breaths a second; empty: a quarter of the tempo")
    ] = None
    blink_rate: Annotated[
        float, Range(0, 120, "/min"), Doc("blinks a minute; 0: it never blinks")
    ] = 12.0
    blink_time: Annotated[float, Range(0.05, 2, "s"), Doc("how long a blink takes")] = 0.5
    blink_irregularity: Annotated[
        float, Range(0, 1), Doc("0: like a clock; 1: pauses between half and one and a half")
    ] = 0.3
    smoothing: Annotated[
        float, Range(0, 5, "s"), Doc("time constant with which joints follow; 0: at once")
    ] = 0.0
    compression: Annotated[
        float, Range(0, 1), Doc("0: the full range; 1: every pose is the middle one")
    ] = 0.0
    speed: Annotated[float, Range(0.1, 5), Doc("speed of animations; 1: as written")] = 1.0
    amplitude: Annotated[float, Range(0, 3), Doc("size of animations; 1: as written")] = 1.0


@dataclass(frozen=True, slots=True)
class Tracking:
    """How a body follows what its camera sees, and how it takes its absence."""

    field_of_view: Annotated[
        tuple[float, float],
        Range(5, 170, "deg"),
        Doc("what the camera sees: width and height of the picture as angles"),
    ] = (62.0, 49.0)
    gain: Annotated[
        float, Range(0.2, 20, "/s"), Doc("how eagerly it turns: 4 is nine tenths in 0.6 s")
    ] = 4.0
    latency: Annotated[
        float, Seconds(0, 0.5), Doc("how old a picture is when it has been looked at")
    ] = 0.06
    happy_in: Annotated[float, Seconds(0.1, 60), Doc("seen for so long it is wholly happy")] = 3.0
    sad_after: Annotated[float, Seconds(0.1, 3600), Doc("unseen for so long it gets sad")] = 3.0
    home_after: Annotated[
        float, Seconds(0.1, 3600), Doc("unseen for so long it goes home, and is neutral again")
    ] = 10.0


def no_roles() -> dict[str, dict[str, float]]:
    """Without `roles` in the file: none; moves then do what they can without joints."""
    return {}


#: The control that moves several joints together and has a setting of its own.
ZOOM = "zoom"
#: What of a face a control may move: those that rest in their middle.
FACE_TARGETS = ("eye-x", "eye-y", "valence", "arousal")


@dataclass(frozen=True, slots=True)
class BodyShape(Section):
    """A whole body: what `Settings` of the driver `body` is built on."""

    joints: Annotated[dict[str, JointShape], Doc("the joints by name, from the base up")]
    roles: Annotated[
        dict[str, dict[str, float]],
        Doc("shares of pan, nod, lean and roll by joint: {pan: {neck: 0.5, head: 0.5}}"),
    ] = field(default_factory=no_roles)
    breathing: Annotated[
        dict[str, float], Doc("share of each joint in breathing; 1 is the whole amplitude")
    ] = field(default_factory=dict)
    zoom: Annotated[
        dict[str, float], Doc("shares of the control `zoom`: joints that it moves together")
    ] = field(default_factory=dict)
    controls: Annotated[
        dict[str, dict[str, float]],
        Doc("controls of its own, by shares of joints, roles and eyes: {curious: {lean: 1}}"),
    ] = field(default_factory=dict)
    eyes: Annotated[
        Vector, Range(-10, 10, "m"), Doc("from the last joint to the middle between the eyes")
    ] = (0.0, 0.0, 0.0)
    view: Annotated[str, OneOf(tuple(AXES)), Doc("where the eyes look with all joints at 0")] = "x"
    face: Annotated[FaceShape | None, Doc("the matrix of lights; empty: it has no face")] = None
    easing: Annotated[str, OneOf(GAZE_EASINGS), Doc("how gaze, pose and home get there")] = "linear"
    crossfade: Annotated[
        float, Range(0, 2, "s"), Doc("time in which one behaviour gives way to another")
    ] = 0.3
    saccade: Annotated[
        tuple[float, float],
        Range(1, 90, "deg"),
        Doc("how far the eyes may lead the head: sideways, up and down"),
    ] = (15.0, 20.0)
    tracking: Annotated[Tracking, Doc("how object tracking behaves")] = field(
        default_factory=Tracking
    )
    personality: Annotated[Personality, Doc("how it is when the session begins")] = field(
        default_factory=Personality
    )
    personalities: Annotated[dict[str, Personality], Doc("named ways to be, for keys")] = field(
        default_factory=dict
    )

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        return [
            *self._joint_problems(),
            *self._share_problems(),
            *self._control_problems(),
            *self._tracking_problems(),
        ]

    def joint_shares(self, control: str) -> dict[str, float]:
        """How much of each joint `zoom` or a control of the body's own moves; none at 0."""
        if control == ZOOM:
            return {name: share for name, share in self.zoom.items() if share}
        shares: dict[str, float] = {}
        for target, share in self.controls[control].items():
            joints = {target: 1.0} if target in self.joints else self.roles.get(target, {})
            for name, part in joints.items():
                shares[name] = shares.get(name, 0.0) + share * part
        return {name: share for name, share in shares.items() if share}

    def face_shares(self, control: str) -> dict[str, float]:
        """The same of the face's controls."""
        of = self.controls.get(control, {})
        return {name: share for name, share in of.items() if name in FACE_TARGETS}

    def _joint_problems(self) -> Iterator[tuple[str, str]]:
        if not self.joints:
            yield "joints", "names no joint"
        for name, joint in self.joints.items():
            yield from range_problems(f"joints.{name}", joint, home=joint.home, start=joint.start)

    def _share_problems(self) -> Iterator[tuple[str, str]]:
        for role in self.roles:
            if role not in ROLES:
                yield f"roles.{role}", f"no move knows it; there are {', '.join(ROLES)}"
            elif not self.roles[role]:
                yield f"roles.{role}", "names no joint; leave the role out if there is none"
        shares = {
            **{f"roles.{role}": joints for role, joints in self.roles.items()},
            "breathing": self.breathing,
            "zoom": self.zoom,
        }
        known = ", ".join(self.joints)
        for path, joints in shares.items():
            for name in joints:
                if name not in self.joints:
                    yield f"{path}.{name}", f"no joint is called {name!r}; there are {known}"

    def _control_problems(self) -> Iterator[tuple[str, str]]:
        for control, targets in self.controls.items():
            path = f"controls.{control}"
            if control in self.joints:
                yield path, f"a joint is called {control!r}, too: its own control has that name"
            if not targets:
                yield path, "moves nothing: name joints, roles or eyes, and their shares"
            for target, share in targets.items():
                if target in FACE_TARGETS and target not in self.joints:
                    if self.face is None:
                        yield f"{path}.{target}", "it has no face"
                    elif not -1 <= share <= 1:
                        yield f"{path}.{target}", "a share of the face goes from -1 to 1"
                elif target not in self.joints and target not in self.roles:
                    known = ", ".join((*self.joints, *self.roles, *FACE_TARGETS))
                    text = f"no joint, role or part of the face is called {target!r}"
                    yield f"{path}.{target}", f"{text}; there are {known}"

    def _tracking_problems(self) -> Iterator[tuple[str, str]]:
        sad, home = self.tracking.sad_after, self.tracking.home_after
        if home <= sad:
            yield "tracking.home_after", f"{home:g} s is not later than sad_after ({sad:g} s)"
