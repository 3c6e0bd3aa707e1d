"""What each verb does, once its input counts: arguments to changes and an answer.

Every order reads all of its arguments before it changes anything, so a refused one leaves no
trace.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_shape import BodyShape, JointShape
from woz_tui.motion.control_scales import FACE
from woz_tui.motion.engine_io import InputResult
from woz_tui.motion.face_control import FaceControl
from woz_tui.motion.joint_control import JointController, known_angles, start_pose
from woz_tui.motion.kinematics import Aim, KinematicChain
from woz_tui.motion.modes import Mode
from woz_tui.motion.move import Move
from woz_tui.motion.personality import CurrentPersonality
from woz_tui.motion.pose_blending import PoseFilter
from woz_tui.motion.pose_sources import (
    LinearMotion,
    MovePlayback,
    ObjectFollowing,
    ObjectTracker,
    PoseSource,
    SaccadeFollowing,
    gaze_direction,
)
from woz_tui.motion.safety import Safety, finite_number
from woz_tui.protocol.messages import Json

#: Arguments of an input, checked: their types and ranges are those of the verb (`inputs`), but for
#: the angles of joints.
Args = Mapping[str, Any]
#: No more poses in one input than this, and no pose takes longer than a day, in seconds.
MOST_POSES, LONGEST_S = 1000, 86_400.0
#: A nudge takes at least so long, in seconds: held arrow keys become one even movement.
NUDGE_S = 0.15
#: The move that the mode `demo` plays.
DEMO = "demo"


@dataclass(frozen=True, slots=True)
class UsableAngles:
    """Joint angles that can be used, in degrees, and what differs from those asked for.

    `clamped` holds, by joint, the angle that was asked for; `left_out` why a joint is not moved.
    """

    joints: dict[str, float]
    clamped: dict[str, Json] = field(default_factory=dict)
    left_out: dict[str, Json] = field(default_factory=dict)

    def told(self) -> dict[str, Json]:
        """For an answer, as the servos' driver tells it."""
        sent: dict[str, Json] = {"joints": {k: round(v, 3) for k, v in self.joints.items()}}
        if self.clamped:
            sent["clamped"] = self.clamped
        if self.left_out:
            sent["left_out"] = self.left_out
        return sent


def usable_angles(path: str, value: object, shapes: Mapping[str, JointShape]) -> UsableAngles:
    """What can be used of a mapping joint -> degrees; `RejectedError` if that is nothing."""
    if not isinstance(value, Mapping) or not value:
        raise RejectedError(f"{path} must name joints and degrees, not {repr(value)[:60]}")
    taken = UsableAngles({})
    for name, wish in value.items():
        shape = shapes.get(name) if isinstance(name, str) else None
        angle = finite_number(wish)
        if shape is None:
            taken.left_out[str(name)[:60]] = "no such joint"
        elif angle is None:
            taken.left_out[name] = f"not an angle: {repr(wish)[:60]}"
        else:
            taken.joints[name] = shape.within(angle)
            if taken.joints[name] != angle:
                taken.clamped[name] = angle
    if not taken.joints:
        reasons = "; ".join(f"{name}: {why}" for name, why in list(taken.left_out.items())[:3])
        raise RejectedError(f"{path} moves nothing ({reasons})", f"joints are {', '.join(shapes)}")
    return taken


class VerbHandlers:
    """The parts of one body, and what inputs do to them. The arguments are those of `Engine`."""

    def __init__(
        self,
        shape: BodyShape,
        moves: Mapping[str, Move],
        seed: int,
        present: Mapping[str, float] | None,
    ) -> None:
        pose = start_pose(shape, present)
        self._shape = shape
        self._moves = moves
        self._chain = KinematicChain(shape)
        self._safety = Safety(shape.joints, {**pose, **known_angles(shape, present)})
        self._shaping = PoseFilter(shape.joints, pose)
        self._steering = JointController(shape, self._shaping, pose)
        self._face = face = FaceControl(seed)
        self._character = character = CurrentPersonality(shape.personality, shape.personalities)
        self._tokens = 0
        #: Seconds since the engine began, as of the last tick.
        self._now = 0.0
        self._acts: Mapping[str, Callable[[Args], InputResult]] = {
            "play": self._play,
            "pose": self._pose,
            "poses": self._poses,
            "home": self._home,
            "gaze": self._gaze,
            "nudge": self._nudge,
            "joints": self._joints,
            "control": self._control,
            "mode": self._mode,
            "personality": lambda args: InputResult(character.become(args)),
            "breathing": self._breathing,
            "emotion": lambda args: face.show(args, self._token),
            "affect": lambda args: face.feel(args["valence"], args["arousal"]),
            "look": self._look,
            "brightness": self._brightness,
            "blink": self._blink,
            "blinking": self._blinking,
        }

    def _token(self) -> int:
        self._tokens += 1
        return self._tokens

    # -- moves, gaze, pose ----------------------------------------------------------------------

    def _play(self, args: Args) -> InputResult:
        move = self._moves[args["move"]]
        playing = self._steering.play(move, args["speed"], args["amplitude"], self._token())
        self._face.begin_lead()
        seconds = move.length / playing.rate(self._character["tempo"], self._character["speed"])
        sent = {**args, "move": move.name, "seconds": round(seconds, 3)}
        return InputResult(sent, playing.token, seconds)

    def _pose(self, args: Args) -> InputResult:
        goal = usable_angles("pose.joints", args["joints"], self._shape.joints)
        return self._go("pose", [(goal, args.get("seconds", 0.0))], args)

    def _poses(self, args: Args) -> InputResult:
        poses = [
            (
                usable_angles("poses.joints", pose["joints"], self._shape.joints),
                pose.get("seconds", 0.0),
            )
            for pose in args["poses"][: MOST_POSES + 1]
        ]
        if len(poses) > MOST_POSES or max(seconds for _, seconds in poses) > LONGEST_S:
            raise RejectedError(
                "poses: too many, or too slow", f"{MOST_POSES} of {LONGEST_S:g} s each"
            )
        return self._go("poses", poses, args)

    def _home(self, args: Args) -> InputResult:
        home = {name: joint.home for name, joint in self._shape.joints.items()}
        return self._go("home", [(UsableAngles(home), args["seconds"])], args)

    def _gaze(self, args: Args) -> InputResult:
        point = [args[name] for name in ("x", "y", "z") if name in args]
        if bool(point) == ("yaw" in args or "pitch" in args) or len(point) not in (0, 3):
            raise RejectedError(
                "gaze looks either at a point or in a direction",
                "give x, y and z, or yaw and pitch",
            )
        pose = self._steering.stance.pose
        if point:
            try:
                aim = self._chain.aim_at((point[0], point[1], point[2]), pose)
            except ValueError as error:
                raise RejectedError(f"gaze: {error}") from None
        else:
            yaw, pitch = gaze_direction(self._chain, pose)
            down = args.get("pitch", -pitch)
            aim = self._chain.aim_along(args.get("yaw", yaw), -down, pose)
        return self._look_at(aim, "gaze", args.get("seconds", 0.0), args)

    def _nudge(self, args: Args) -> InputResult:
        pose = self._steering.stance.pose
        yaw, pitch = gaze_direction(self._chain, pose)
        yaw = (yaw + args["yaw"] + 180.0) % 360.0 - 180.0
        pitch = min(90.0, max(-90.0, pitch - args["pitch"]))
        aim = self._chain.aim_along(yaw, pitch, pose)
        if self._steering.move:  # the arrow keys turn whoever dances, and do not end the dance
            self._steering.shift(aim.joints, "nudge")
            return InputResult(_off_the_mark(UsableAngles(dict(aim.joints)).told(), aim))
        return self._look_at(aim, "nudge", NUDGE_S, args)

    def _look_at(self, aim: Aim, name: str, seconds: float, args: Args) -> InputResult:
        answer = self._go(name, [(UsableAngles(dict(aim.joints)), seconds)], args)
        return replace(answer, sent=_off_the_mark(answer.sent, aim))

    def _go(self, name: str, poses: list[tuple[UsableAngles, float]], args: Args) -> InputResult:
        goals = [(goal.joints, seconds) for goal, seconds in poses]
        easing = args.get("easing", self._shape.easing)
        line = self._steering.go(name, goals, self._token(), easing)
        late = line.seconds - sum(seconds for _, seconds in goals)
        told = [goal.told() for goal, _ in poses]
        sent: dict[str, Json] = told[0] if name != "poses" else {"poses": list(told)}
        sent["seconds"] = round(line.seconds, 3)
        if late > 1e-9 and all(seconds > 0.0 for _, seconds in goals):
            sent["late_s"] = round(late, 3)
        return InputResult(sent, line.token, line.seconds)

    def _joints(self, args: Args) -> InputResult:
        taken = usable_angles("joints.joints", args["joints"], self._shape.joints)
        self._steering.put(taken.joints, "joints")
        return InputResult(taken.told())

    # -- controls -------------------------------------------------------------------------------

    def _places(self) -> dict[str, float]:
        """Where every control of the body stands, 0..1."""
        stance = self._steering.stance
        return {
            **{name: stance.place(name) for name in self._shape.joints},
            "zoom": stance.zoom,
            **self._face.places(),
            **self._character.places(),
        }

    def _control(self, args: Args) -> InputResult:
        name = args["control"]
        if ("value" in args) == ("by" in args):
            raise RejectedError("control needs either a value or by how much", "both are 0 to 1")
        wish = args["value"] if "value" in args else self._places()[name] + args["by"]
        place = min(1.0, max(0.0, wish))
        sent: dict[str, Json] = {"control": name, "value": round(place, 4)}
        if place != wish:
            sent["clamped"] = {name: wish}
        if name in self._shape.joints:
            self._steering.turn(name, place, f"control {name}")
        elif name == "zoom":
            self._steering.turn_zoom(place, "control zoom")
        elif name in FACE:
            self._face.turn(name, place)
            self._eyes_moved(name.startswith("eye"))
        else:
            self._character.turn(name, place)
        return InputResult(sent)

    # -- modes ----------------------------------------------------------------------------------

    def _mode(self, args: Args) -> InputResult:
        mode = Mode(args["mode"])
        if mode is Mode.NORMAL:
            self._leave("stopped")
            self._steering.stop("stopped")
            return InputResult({"mode": mode.value})
        # What begins goes on from where everything is: the primary is made first, it may refuse.
        primary = self._primary(mode)
        self._face.stop(f"replaced by {mode.value}")
        self._face.begin_lead()
        self._steering.enter(mode, primary)
        return InputResult({"mode": mode.value})

    def _leave(self, why: str) -> None:
        """What the stop ends besides what moves the joints."""
        self._face.stop(why)
        self._face.begin_lead()
        if self._steering.mode is Mode.SACCADE:
            self._eyes_back()

    def _eyes_back(self) -> None:
        """The eyes are the face's own again, in its middle."""
        self._face.led = None
        self._face.look(0.0, 0.0)

    def _primary(self, mode: Mode) -> PoseSource:
        if mode is Mode.TRACKING:
            tracker = ObjectTracker(self._shape, self._chain)
            tracker.begin(self._now, self._safety.last)
            return ObjectFollowing(tracker)
        if mode is Mode.SACCADE:
            line = isinstance(self._steering.primary, LinearMotion)
            pose = self._steering.here if line else self._steering.stance.pose
            return SaccadeFollowing(self._chain, self._shape, pose, self._face.eyes)
        move = self._moves.get(DEMO)
        if move is None:
            raise RejectedError("there is no demo", f"it is the move called {DEMO!r}")
        return MovePlayback(move, self._shape, 1.0, 1.0, 0, own_pace=True)

    # -- face and ways --------------------------------------------------------------------------

    def _look(self, args: Args) -> InputResult:
        answer = self._face.look(args["x"], args["y"])
        self._eyes_moved(True)
        return answer

    def _eyes_moved(self, moved: bool) -> None:
        """In saccade following they take the head along."""
        primary = self._steering.primary
        if moved and isinstance(primary, SaccadeFollowing):
            primary.look(self._face.x, self._face.y)

    def _brightness(self, args: Args) -> InputResult:
        self._face.brightness = args["level"]
        return InputResult(args)

    def _blink(self, args: Args) -> InputResult:
        self._face.blink()
        return InputResult()

    def _blinking(self, args: Args) -> InputResult:
        self._face.blinks_by_itself = args["on"]
        return InputResult(args)

    def _breathing(self, args: Args) -> InputResult:
        self._character.breathes = args["on"]
        return InputResult(args)


def _off_the_mark(sent: Mapping[str, Json], aim: Aim) -> dict[str, Json]:
    """What is answered, and how far the head's gaze misses if it cannot get there."""
    if aim.reachable:
        return dict(sent)
    return {**sent, "reachable": False, "error_deg": round(aim.error_deg, 2)}
