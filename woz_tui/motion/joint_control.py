"""Decides which source moves the joints in which mode, and leads over from one to the next.

Priorities and resumption are decided here; docs/explanation/decisions/010-layers-of-motion.md has
them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from woz_tui.motion.body_shape import ZOOM, BodyShape, JointShape
from woz_tui.motion.easing import PEAK_SPEEDS
from woz_tui.motion.engine_io import EndedInput
from woz_tui.motion.modes import Mode
from woz_tui.motion.move_types import Move, SoundCue
from woz_tui.motion.pose_blending import CrossFade, PoseFilter
from woz_tui.motion.pose_sources import (
    Hold,
    LinearMotion,
    MovePlayback,
    PoseSource,
    SourceContext,
    legs_of,
)
from woz_tui.motion.safety import finite_number

# -- desired pose ----------------------------------------------------------------------------------
# The pose that people want: one angle for each joint, and what moves several of them on top.
#
# It is what the joint controls and every gaze and pose write, what moves are played around, and
# where the body returns to when a mode ends.


class ControlMix:
    """A control that moves several joints together by shares of one angle.

    When the first of them reaches its limit the others stop too, so that they always move as one.

    Attributes:
        value: Where it is wanted, -1..1; 0 is none.
    """

    def __init__(self, joints: Mapping[str, JointShape], shares: Mapping[str, float]) -> None:
        self._joints = joints
        self.shares = shares
        #: The whole way to one side: half of the narrowest joint's range.
        self._reach = min(
            (
                (joints[name].max - joints[name].min) / 2 / abs(share)
                for name, share in shares.items()
            ),
            default=0.0,
        )
        self.value = 0.0

    @property
    def place(self) -> float:
        """Place of the control, 0..1; the middle is none."""
        return (self.value + 1.0) / 2.0

    def followed(self, pose: Mapping[str, float]) -> float:
        """The value as far as every joint can follow it from `pose`."""
        low, high = self._range(pose, 1.0)
        return min(high, max(low, self.value))

    def added(self, pose: Mapping[str, float]) -> dict[str, float]:
        """The pose with this control on top."""
        way = self.followed(pose) * self._reach
        return {
            name: shape.within(pose[name] + way * self.shares.get(name, 0.0))
            for name, shape in self._joints.items()
        }

    def taken_out(self, pose: Mapping[str, float], value: float) -> dict[str, float]:
        """The pose without this control, which is at `value` from now on, or as near as fits."""
        low, high = self._range(pose, -1.0)
        self.value = min(high, max(low, value))
        return {
            name: angle - self.value * self._reach * self.shares.get(name, 0.0)
            for name, angle in pose.items()
        }

    def _range(self, pose: Mapping[str, float], sign: float) -> tuple[float, float]:
        """Values, -1..1, that keep `pose + sign * value` inside all ranges; always about 0."""
        low, high = -1.0, 1.0
        for name, share in self.shares.items():
            shape, step = self._joints[name], sign * share * self._reach
            ends = ((shape.min - pose[name]) / step, (shape.max - pose[name]) / step)
            low, high = max(low, min(ends)), min(high, max(ends))
        return min(0.0, low), max(0.0, high)


class DesiredPose:
    """The pose wanted, in degrees: the joints' own controls, then `zoom`, then the controls of the
    file, each as far as what is left of the joints' ranges lets it.
    """

    def __init__(self, shape: BodyShape, pose: Mapping[str, float]) -> None:
        self._joints = shape.joints
        self.mixes = {
            name: ControlMix(shape.joints, shape.joint_shares(name))
            for name in (ZOOM, *shape.controls)
        }
        self._base = {name: joint.within(pose[name]) for name, joint in self._joints.items()}
        #: Every joint's angle. Do not change it.
        self.pose: Mapping[str, float] = dict(self._base)

    def place(self, joint: str) -> float:
        """Place of a joint's own control, 0 (its lowest angle) to 1."""
        shape = self._joints[joint]
        return (self._base[joint] - shape.min) / (shape.max - shape.min)

    def turn(self, joint: str, place: float) -> None:
        """Move a joint's own control."""
        shape = self._joints[joint]
        self._base[joint] = shape.within(shape.min + place * (shape.max - shape.min))
        self._update()

    def turn_mix(self, control: str, place: float) -> None:
        """Move a control of several joints."""
        self.mixes[control].value = 2.0 * place - 1.0
        self._update()

    def aim(self, angles: Mapping[str, float]) -> None:
        """Want these angles, mixes included; they give way where they would not fit."""
        followed, pose = [], dict(self._base)
        for mix in self.mixes.values():
            followed.append(mix.followed(pose) if mix.shares else mix.value)
            pose = mix.added(pose)
        own = {**self.pose, **angles}
        for mix, value in reversed([*zip(self.mixes.values(), followed, strict=True)]):
            own = mix.taken_out(own, value)
        self._base = {name: self._joints[name].within(angle) for name, angle in own.items()}
        self._update()

    def _update(self) -> None:
        pose: dict[str, float] = self._base
        for mix in self.mixes.values():
            pose = mix.added(pose)
        self.pose = pose


def known_angles(shape: BodyShape, present: Mapping[str, float] | None) -> dict[str, float]:
    """Where the joints are, as far as that is known: those of the body, finite angles only."""
    angles = {name: finite_number(angle) for name, angle in (present or {}).items()}
    return {name: a for name, a in angles.items() if name in shape.joints and a is not None}


def start_pose(shape: BodyShape, present: Mapping[str, float] | None = None) -> dict[str, float]:
    """The pose to begin with: where the joints are, as far as that is known, else their start."""
    known = known_angles(shape, present)
    return {
        name: joint.within(known.get(name, joint.home if joint.start is None else joint.start))
        for name, joint in shape.joints.items()
    }


# --------------------------------------------------------------------------------------------------

#: In how long the body returns from a mode to the pose that the controls want, in seconds.
RETURN_S = 1.0
#: A joint counts as arrived this near to where it is wanted, in degrees; after so many seconds a
#: movement is over even if a joint never gets there.
ARRIVED, PATIENCE_S = 0.5, 2.0


class JointController:
    """The pose that joints shall have, in degrees, from one source at a time.

    Attributes:
        mode: Changed by `enter`, by `stop` and by the end of a demo.
        desired: The pose people want.
        source: What decides about the pose now.
        last_pose: The pose that was wanted last: where new lines begin.
    """

    def __init__(
        self,
        shape: BodyShape,
        pose_filter: PoseFilter,
        pose: Mapping[str, float],
    ) -> None:
        self.mode = Mode.NORMAL
        self.desired = DesiredPose(shape, pose)
        self.source: PoseSource = Hold()
        self.last_pose: dict[str, float] = dict(self.desired.pose)
        self.easing = shape.easing
        self._shape = shape
        self._pose_filter = pose_filter
        self._fade = CrossFade(shape.crossfade)
        self._source_is_new = False
        #: The pose in which a mode began; it does not follow the controls.
        self._base: Mapping[str, float] | None = None
        self._lagging: Mapping[str, float] = {}
        self._waited_s = 0.0
        self._ended: list[EndedInput] = []
        self._cues: tuple[SoundCue, ...] = ()
        self._stroke = 0
        self.notices: list[str] = []

    # -- what people want -----------------------------------------------------------------------

    @property
    def base(self) -> Mapping[str, float]:
        """The pose that the source works on."""
        return self.desired.pose if self._base is None else self._base

    @property
    def move(self) -> str:
        """The move being played, or empty."""
        return self.source.name if isinstance(self.source, MovePlayback) else ""

    def turn(self, joint: str, place: float, by: str) -> None:
        """A joint's own control; in modes it only counts for the way back."""
        self.desired.turn(joint, place)
        self._release_joints({joint}, by)

    def turn_mix(self, control: str, place: float, by: str) -> None:
        """A control of several joints; in modes it only counts for the way back."""
        self.desired.turn_mix(control, place)
        self._release_joints(set(self.desired.mixes[control].shares), by)

    def set_angles(self, angles: Mapping[str, float], by: str) -> None:
        """Joints directly, under whatever is being played."""
        self.desired.aim(angles)
        self._release_joints(set(angles), by)

    def shift(self, angles: Mapping[str, float], by: str) -> None:
        """As `set_angles`, but what is played leans over to its new pose in the time of a fade."""
        pose = self.desired.pose
        before = {joint: pose[joint] for joint in angles}
        self.set_angles(angles, by)
        for joint, angle in before.items():
            self._fade.more(joint, angle - self.desired.pose[joint])

    def _release_joints(self, joints: set[str], by: str) -> None:
        """Take joints out of a line: they are where people want them now."""
        line = self.source
        if self.mode is not Mode.NORMAL or not isinstance(line, LinearMotion):
            return
        for joint in joints & line.joints:
            line.joints.discard(joint)
            self._fade.add(joint, self.last_pose[joint] - self.desired.pose[joint])
        if not line.joints:
            self._set_source(Hold(), f"replaced by {by}", fading=False)

    # -- who decides ----------------------------------------------------------------------------

    def go(
        self,
        name: str,
        goals: Sequence[tuple[Mapping[str, float], float]],
        token: int,
        easing: str = "",
    ) -> LinearMotion:
        """Go through poses, each in its seconds (0: the soonest), from where the body is."""
        self._start()
        line = self.line(name, goals, token, easing)
        self._set_source(line, f"replaced by {name}")
        for goal, _ in goals:
            self.desired.aim(goal)
        return line

    def line(
        self,
        name: str,
        goals: Sequence[tuple[Mapping[str, float], float]],
        token: int,
        easing: str = "",
    ) -> LinearMotion:
        """The way that `go` would take from here; nothing moves along it."""
        easing = easing if easing in PEAK_SPEEDS else self.easing
        return LinearMotion(name, legs_of(self._here(), goals, self._shape, easing), easing, token)

    def play(self, move: Move, speed: float, amplitude: float, token: int) -> MovePlayback:
        """Play a move around the pose of this moment, from its beginning."""
        self._end_line_here()
        playing = MovePlayback(move, self._shape, speed, amplitude, token)
        self._set_source(playing, f"replaced by {move.name}")
        return playing

    def enter(self, mode: Mode, source: PoseSource) -> None:
        """Begin a mode: `source` decides until the stop or its own end."""
        base = self.last_pose if isinstance(self.source, LinearMotion) else self.desired.pose
        self._set_source(source, f"replaced by {mode.value}")
        self._base = dict(base)
        self.mode = mode

    def stop(self, why: str) -> None:
        """End whatever goes on and return to the pose wanted; a way back is not interrupted."""
        if isinstance(self.source, LinearMotion) and self.source.returning:
            return
        seconds = RETURN_S if self.mode is not Mode.NORMAL else self._shape.crossfade
        self._end_line_here()
        self._return(seconds, why)

    def freeze(self, why: str, joints: Mapping[str, float], still: bool) -> None:
        """End whatever goes on and want the pose in which the joints are.

        `still`: they are where people want them, but for the breath: then that pose remains.
        """
        remains = still and isinstance(self.source, Hold)
        self._set_source(Hold(), why, fading=False)
        self._fade.clear()
        self._base, self.mode = None, Mode.NORMAL
        self._pose_filter.restart(joints)
        self.last_pose = {
            name: self._pose_filter.undo(name, angle) for name, angle in joints.items()
        }
        if remains:
            self._fade.begin(self.last_pose, self.desired.pose, self.last_pose)
        else:
            self.desired.aim(self.last_pose)

    def restart(self, present: Mapping[str, float]) -> None:
        """Begin anew in this pose."""
        self.freeze("the joints are where they are", start_pose(self._shape, present), False)

    def drop(self, why: str) -> None:
        """The source failed: hold the pose that is wanted."""
        self._base = None
        if self.mode is not Mode.NORMAL:
            self.mode = Mode.NORMAL
            self._return(RETURN_S, why)
        else:
            self._set_source(Hold(), why)

    def _end_line_here(self) -> None:
        """A line that is under way ends where it is."""
        if isinstance(self.source, LinearMotion):
            start = self._start()
            self.desired.aim({name: start[name] for name in self.source.joints})

    def _return(self, seconds: float, why: str) -> None:
        """Lead back to the pose wanted, in a straight line."""
        self._base, self.mode = None, Mode.NORMAL
        start, goal = self._start(), dict(self.desired.pose)
        if all(abs(start[name] - angle) < 1e-9 for name, angle in goal.items()):
            self._set_source(Hold(), why)
            return
        legs = legs_of(start, [(goal, seconds)], self._shape, "linear")
        self._set_source(LinearMotion("return", legs, "linear", returning=True), why)

    def _start(self) -> dict[str, float]:
        """Where lines begin: what was wanted last, or where a joint is that could not follow."""
        self.last_pose = self._here()
        self._pose_filter.restart(self._lagging)
        self._lagging = {}
        return self.last_pose

    def _here(self) -> dict[str, float]:
        undo = self._pose_filter.undo
        return {**self.last_pose, **{j: undo(j, angle) for j, angle in self._lagging.items()}}

    def _set_source(self, source: PoseSource, why: str, *, fading: bool = True) -> None:
        if self.source.token:
            self._ended.append(EndedInput(self.source.token, why))
        self.source = source
        self._source_is_new = fading
        self._waited_s = 0.0

    # -- every tick -----------------------------------------------------------------------------

    def step(self, moment: SourceContext) -> dict[str, float]:
        """The pose wanted now. An exception is the primary's; nothing has changed then."""
        wanted = self.source.step(moment)
        if self._source_is_new:
            self._source_is_new = False
            lines = self.source.joints if isinstance(self.source, LinearMotion) else set()
            self._fade.begin(self.last_pose, wanted, set(wanted) - lines)
        self.last_pose = self._fade.over(wanted, moment.dt)
        if isinstance(self.source, MovePlayback):
            self._cues = tuple(self.source.cues)
            self._stroke = self.source.token if self.source.strikes else 0
        return self.last_pose

    def settle(self, dt: float, lagging: Mapping[str, float]) -> None:
        """After safety: `lagging` are joints that are elsewhere than wanted, and where they are."""
        self._lagging = lagging
        source = self.source
        if not source.over:
            return
        if isinstance(source, LinearMotion):
            self._waited_s += dt
            if not lagging.keys() & source.joints or self._waited_s > PATIENCE_S:
                self._set_source(Hold(), "", fading=False)
            return
        if self.mode is not Mode.NORMAL:
            self.notices.append(f"the {self.mode.value} is over")
            self._return(RETURN_S, "")
        elif isinstance(source, MovePlayback) and source.move.stays:
            self.desired.aim(self.last_pose)
            self._set_source(Hold(), "")
        else:
            self._return(self._shape.crossfade, "")

    def cues(self) -> tuple[SoundCue, ...]:
        """What happens at this moment of a move."""
        cues, self._cues = self._cues, ()
        return cues

    def stroke(self) -> int:
        """The input whose stroke this moment is, by token; 0: none."""
        stroke, self._stroke = self._stroke, 0
        return stroke

    def ended(self) -> list[EndedInput]:
        """Inputs that ended since the last call."""
        ended, self._ended = self._ended, []
        return ended
