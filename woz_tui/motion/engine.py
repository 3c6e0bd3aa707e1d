"""The body's engine: takes inputs by verb, and gives setpoints and the face tick by tick.

From the inside out: the pose of one source, cross-faded; compression; smoothing; breathing; safety.
Same shape, moves, seed and inputs at the same ticks: same setpoints and same pictures.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_feeds import BodyState, Sighting
from woz_tui.motion.body_shape import BodyShape, JointShape
from woz_tui.motion.body_verbs import CONTROL_KINDS, KINDS, body_verbs
from woz_tui.motion.control_scales import FACE
from woz_tui.motion.engine_io import InputResult, Tick
from woz_tui.motion.face_control import FaceControl
from woz_tui.motion.face_drawing import FaceState, draw, prepare
from woz_tui.motion.joint_control import ARRIVED, JointController, known_angles, start_pose
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.kinematics import Aim, KinematicChain
from woz_tui.motion.light_frames import LightFrame, blank
from woz_tui.motion.modes import BLINKS, BREATHES, InputKind, Mode, Operator, is_accepted
from woz_tui.motion.move_files import MoveFileError, read_move_text
from woz_tui.motion.move_types import Move
from woz_tui.motion.personality import CurrentPersonality
from woz_tui.motion.pose_blending import Breathing, PoseFilter
from woz_tui.motion.pose_sources import (
    LinearMotion,
    MovePlayback,
    ObjectFollowing,
    ObjectTracker,
    PoseSource,
    SaccadeFollowing,
    SourceContext,
    gaze_direction,
)
from woz_tui.motion.safety import Safety, finite_number
from woz_tui.protocol.messages import Json

#: Arguments of an input, checked: their types and ranges are those of the verb (`inputs`), but for
#: the angles of joints.
Args = Mapping[str, Any]
#: No more poses in one input than this, and no pose takes longer than a day, in seconds.
MOST_POSES, LONGEST_POSE_S = 1000, 86_400.0
#: A nudge takes at least so long, in seconds: held arrow keys become one even movement.
NUDGE_S = 0.15
#: Inputs of which is known beforehand how long they take.
FORESEEN = frozenset({"play", "play_move", "pose", "poses", "home", "gaze"})
#: The move that the mode `demo` plays.
DEMO = "demo"
#: Time that counts between two ticks at most, in seconds; whoever slept longer goes on from there.
LONGEST_S = 10.0
#: Modes in which the head has to hit a target: it neither compresses nor smooths its way.
EXACT = frozenset({Mode.TRACKING, Mode.SACCADE})
#: The share of its breath that a body keeps while its eyes lead: they make up for it, and a whole
#: breath would keep them wandering about the middle.
SACCADE_BREATH = 0.3


@dataclass(frozen=True, slots=True)
class UsableAngles:
    """Joint angles that can be used, in degrees, and what differs from those asked for.

    `clamped` holds, by joint, the angle that was asked for; `left_out` why a joint is not moved.
    """

    joints: dict[str, float]
    clamped: dict[str, Json] = field(default_factory=dict)
    left_out: dict[str, Json] = field(default_factory=dict)

    def to_json(self) -> dict[str, Json]:
        """As an answer has it, like that of the servos' driver."""
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


class Engine:
    """One body.

    Args:
        shape: What it is made of; `shape.problems()` must be empty.
        moves: What it can play, by name; `demo` is what the mode demo plays.
        seed: Of everything that happens by chance (when it blinks).
        present: Where its joints are, in degrees, if that is known: it begins there.
    """

    def __init__(
        self,
        shape: BodyShape,
        moves: Mapping[str, Move],
        *,
        seed: int = 0,
        present: Mapping[str, float] | None = None,
    ) -> None:
        pose = start_pose(shape, present)
        self._shape = shape
        self._moves = moves
        self._chain = KinematicChain(shape)
        self._safety = Safety(shape.joints, {**pose, **known_angles(shape, present)})
        self._pose_filter = PoseFilter(shape.joints, pose)
        self._joint_controller = JointController(shape, self._pose_filter, pose)
        self._face = FaceControl(seed, self._token)
        self._personality = CurrentPersonality(shape.personality, shape.personalities)
        #: The text of a move that was given whole, and that move.
        self._given: tuple[str | None, Move] = None, KeyframeMove("", "", ())
        self._tokens = 0
        #: Seconds since the engine began, as of the last tick.
        self._now = 0.0
        self._handlers: Mapping[str, Callable[[Args], InputResult]] = {
            "play": self._play,
            "play_move": self._play_move,
            "pose": self._pose,
            "poses": self._poses,
            "home": self._home,
            "gaze": self._gaze,
            "nudge": self._nudge,
            "joints": self._joints,
            "control": self._control,
            "mode": self._mode,
            "personality": self._personality.become,
            "breathing": self._breathing,
            "emotion": self._face.show,
            "affect": self._affect,
            "look": self._eyes_to,
            "brightness": self._brightness,
            "blink": self._blink,
            "blinking": self._blinking,
        }
        self._verbs = {verb.name: verb for verb in body_verbs(shape, moves)}
        self._breath = Breathing(shape)
        self._sighting: Sighting | None = None
        self._frozen = ""
        #: Whether the present input is only asked how long it would take.
        self._predicts = False
        self._t: float | None = None
        self._notices: list[str] = []
        self._failed: set[tuple[str, str]] = set()
        self._rejected: frozenset[str] = frozenset()
        self._wanted: Mapping[str, float] = dict(self._safety.last)
        self._drawn_state: FaceState | None = None
        self._frame: LightFrame | None = None
        if shape.face is not None:
            prepare(shape.face)
            self._frame = blank(shape.face.width, shape.face.height)

    # -- inputs ---------------------------------------------------------------------------------

    def apply(
        self, verb: str, args: Mapping[str, Json], hand: Operator = Operator.WIZARD
    ) -> InputResult:
        """Do what somebody wants, from the next tick on.

        Raises `RejectedError`, and nothing else, if that makes no sense or does not count now; then
        nothing has changed.
        """
        try:
            return self._apply(verb, args, hand)
        except RejectedError:
            raise
        except Exception as error:
            raise RejectedError(f"{verb!r} failed inside: {error!r}") from error

    def predict(self, verb: str, args: Mapping[str, Json]) -> InputResult:
        """How many seconds a move, pose or gaze would take if it were asked for now, and when its
        stroke would come.

        Nothing changes. Raises `RejectedError` as `apply`.
        """
        if verb not in FORESEEN:
            return InputResult()
        self._predicts = True
        try:
            return self.apply(verb, args)
        finally:
            self._predicts = False

    def set_moves(self, moves: Mapping[str, Move]) -> None:
        """Play these moves from now on; one under way goes on as it began."""
        self._verbs = {verb.name: verb for verb in body_verbs(self._shape, moves)}
        self._moves = moves

    def _apply(self, verb: str, args: Mapping[str, Json], hand: Operator) -> InputResult:
        read = self._checked(verb, args)
        if verb == "control":
            kind = CONTROL_KINDS.get(read["control"], InputKind.JOINTS)
        else:
            kind = InputKind.STOP if read.get("mode") == Mode.NORMAL.value else KINDS[verb]
        if self._frozen:
            raise RejectedError(
                f"the robot stands still ({self._frozen})", "release the stop first"
            )
        mode = self._joint_controller.mode
        if is_accepted(kind, mode):
            return self._handlers[verb](read)
        if verb == "control" and kind is InputKind.JOINTS and hand is Operator.WIZARD:
            answer = self._handlers[verb](read)
            return InputResult({**answer.sent, "waits": Mode.NORMAL.value})
        what = "a change of mode" if kind is InputKind.MODE else kind.value
        raise RejectedError(f"the mode {mode.value} ignores {what}", "mode: normal ends it")

    def _checked(self, verb: object, args: object) -> Args:
        """The arguments as the verb has them. Of angles, those that make no sense are left out by
        `usable_angles` and named, so that the other joints move.
        """
        found = self._verbs.get(verb) if isinstance(verb, str) else None
        if found is None:
            raise RejectedError(f"this body cannot {verb!r}", f"it can {', '.join(self._verbs)}")
        if not isinstance(args, Mapping):
            raise RejectedError(f"{found.name}: arguments are names and values, not {args!r}")
        given, angles = dict(args), {}
        if verb in ("pose", "joints"):
            found = replace(found, arguments=found.arguments[1:])
            angles = {"joints": given.pop("joints", None)}
        seconds = given.get("seconds")
        if isinstance(seconds, int | float) and not seconds > 0:  # no time: as fast as it may
            given["seconds"] = 0.0
        try:
            return {**angles, **checked(found, given)}
        except ArgumentError as error:
            raise RejectedError(str(error)) from None

    def see(self, seen: Sighting | None) -> None:
        """What the camera saw last."""
        self._sighting = seen

    def freeze(self, why: str = "stop") -> None:
        """Stand still at once, without a breath, until `resume`; whatever went on is over."""
        joints = self._safety.last
        still = all(abs(joints[j] - self._wanted[j]) < ARRIVED for j in joints)
        self._safety.restart(joints)
        self._end_activities(f"stopped: {why}")
        self._joint_controller.freeze(f"stopped: {why}", joints, still)
        self._breath.hold()
        self._face.rest()
        self._wanted = dict(joints)
        self._frozen = why or "stop"

    def resume(self) -> None:
        """Move again, from the pose where it stands."""
        self._frozen = ""

    def drop(self, token: int, why: str = "cut short") -> None:
        """End the input that `apply` gave this token to, if it still goes on.

        A gaze or pose ends where it is, a move gives the pose from before back, a breakdown the
        emotion.
        """
        if token and token == self._joint_controller.source.token:
            self._joint_controller.stop(why)
        self._face.drop(token, why)

    def restart(self, present: Mapping[str, float]) -> None:
        """Go on from this pose, in degrees, before the first servo moves."""
        self._end_activities("the joints are where they are")
        self._safety.restart(present)
        self._joint_controller.restart(self._safety.last)
        self._breath.hold()
        self._wanted = dict(self._safety.last)

    def _token(self) -> int:
        self._tokens += 1
        return self._tokens

    # -- moves, gaze, pose ----------------------------------------------------------------------

    def _play(self, args: Args) -> InputResult:
        return self._play_any(self._moves[args["move"]], args)

    def _play_move(self, args: Args) -> InputResult:
        text = args["move"]
        if text != self._given[0]:
            self.read_move(text)
        return self._play_any(self._given[1], args)

    def read_move(self, text: str) -> None:
        """Read what `play_move` will be given, so that no tick waits for it. Raises
        `RejectedError`.
        """
        try:
            self._given = text, read_move_text(text, self._shape)
        except MoveFileError as error:
            raise RejectedError(f"this is no move: {error.problems[0]}") from None

    def _play_any(self, move: Move, args: Args) -> InputResult:
        pace = self._personality["tempo"], self._personality["speed"]
        if self._predicts:
            foreseen = MovePlayback(move, self._shape, args["speed"], args["amplitude"], 0)
            seconds, stroke = foreseen.foreseen(*pace)
            return InputResult(seconds=seconds, stroke=stroke)
        playing = self._joint_controller.play(move, args["speed"], args["amplitude"], self._token())
        self._face.begin_overlay()
        seconds, stroke = playing.foreseen(*pace)
        sent = {**args, "move": move.name, "seconds": round(seconds, 3)}
        return InputResult(sent, playing.token, seconds, stroke)

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
        if len(poses) > MOST_POSES or max(seconds for _, seconds in poses) > LONGEST_POSE_S:
            raise RejectedError(
                "poses: too many, or too slow", f"{MOST_POSES} of {LONGEST_POSE_S:g} s each"
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
        pose = self._joint_controller.desired.pose
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
        pose = self._joint_controller.desired.pose
        yaw, pitch = gaze_direction(self._chain, pose)
        yaw = (yaw + args["yaw"] + 180.0) % 360.0 - 180.0
        pitch = min(90.0, max(-90.0, pitch - args["pitch"]))
        aim = self._chain.aim_along(yaw, pitch, pose)
        if self._joint_controller.move:
            # The arrow keys turn a body that dances, and do not end the dance.
            self._joint_controller.shift(aim.joints, "nudge")
            return InputResult(_with_gaze_error(UsableAngles(dict(aim.joints)).to_json(), aim))
        return self._look_at(aim, "nudge", NUDGE_S, args)

    def _look_at(self, aim: Aim, name: str, seconds: float, args: Args) -> InputResult:
        answer = self._go(name, [(UsableAngles(dict(aim.joints)), seconds)], args)
        return replace(answer, sent=_with_gaze_error(answer.sent, aim))

    def _go(self, name: str, poses: list[tuple[UsableAngles, float]], args: Args) -> InputResult:
        goals = [(goal.joints, seconds) for goal, seconds in poses]
        easing = args.get("easing", self._shape.easing)
        if self._predicts:
            return InputResult(seconds=self._joint_controller.line(name, goals, 0, easing).seconds)
        line = self._joint_controller.go(name, goals, self._token(), easing)
        late = line.seconds - sum(seconds for _, seconds in goals)
        answers = [goal.to_json() for goal, _ in poses]
        sent: dict[str, Json] = answers[0] if name != "poses" else {"poses": list(answers)}
        sent["seconds"] = round(line.seconds, 3)
        if late > 1e-9 and all(seconds > 0.0 for _, seconds in goals):
            sent["late_s"] = round(late, 3)
        return InputResult(sent, line.token, line.seconds)

    def _joints(self, args: Args) -> InputResult:
        taken = usable_angles("joints.joints", args["joints"], self._shape.joints)
        self._joint_controller.set_angles(taken.joints, "joints")
        return InputResult(taken.to_json())

    # -- controls -------------------------------------------------------------------------------

    def _places(self) -> dict[str, float]:
        """Where every control of the body stands, 0..1."""
        desired = self._joint_controller.desired
        return {
            **{name: desired.place(name) for name in self._shape.joints},
            **{name: mix.place for name, mix in desired.mixes.items()},
            **self._face.places(),
            **self._personality.places(),
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
            self._joint_controller.turn(name, place, f"control {name}")
        elif name in self._joint_controller.desired.mixes:
            self._turn_mix(name, place)
        elif name in FACE:
            self._face.turn(name, place)
            self._eyes_moved(name.startswith("eye"))
        else:
            self._personality.turn(name, place)
        return InputResult(sent)

    def _turn_mix(self, name: str, place: float) -> None:
        """A control that moves several joints, and the face where the mode lets it be moved."""
        self._joint_controller.turn_mix(name, place, f"control {name}")
        for part, share in self._shape.face_shares(name).items():
            if is_accepted(CONTROL_KINDS[part], self._joint_controller.mode):
                self._face.turn(part, 0.5 + share * (place - 0.5))
                self._eyes_moved(part.startswith("eye"))

    # -- modes ----------------------------------------------------------------------------------

    def _mode(self, args: Args) -> InputResult:
        mode = Mode(args["mode"])
        if mode is Mode.NORMAL:
            self._end_activities("stopped")
            self._joint_controller.stop("stopped")
            return InputResult({"mode": mode.value})
        # What begins goes on from where everything is: the primary is made first, it may refuse.
        primary = self._primary(mode)
        self._face.end_crash(f"replaced by {mode.value}")
        self._face.begin_overlay()
        self._joint_controller.enter(mode, primary)
        return InputResult({"mode": mode.value})

    def _end_activities(self, why: str) -> None:
        """End what the stop ends besides the source of the pose."""
        self._face.end_crash(why)
        self._face.begin_overlay()
        if self._joint_controller.mode is Mode.SACCADE:
            self._centre_eyes()

    def _centre_eyes(self) -> None:
        """The eyes are the face's own again, in its middle."""
        self._face.led = None
        self._face.look_at(0.0, 0.0)

    def _primary(self, mode: Mode) -> PoseSource:
        if mode is Mode.TRACKING:
            tracker = ObjectTracker(self._shape, self._chain)
            tracker.begin(self._now, self._safety.last)
            return ObjectFollowing(tracker)
        if mode is Mode.SACCADE:
            line = isinstance(self._joint_controller.source, LinearMotion)
            pose = self._joint_controller.last_pose if line else self._joint_controller.desired.pose
            return SaccadeFollowing(self._chain, self._shape, pose, self._face.eyes)
        move = self._moves.get(DEMO)
        if move is None:
            raise RejectedError("there is no demo", f"it is the move called {DEMO!r}")
        return MovePlayback(move, self._shape, 1.0, 1.0, 0, own_pace=True)

    # -- face and ways --------------------------------------------------------------------------

    def _affect(self, args: Args) -> InputResult:
        return self._face.show_affect(args["valence"], args["arousal"])

    def _eyes_to(self, args: Args) -> InputResult:
        answer = self._face.look_at(args["x"], args["y"])
        self._eyes_moved(True)
        return answer

    def _eyes_moved(self, moved: bool) -> None:
        """In saccade following they take the head along."""
        primary = self._joint_controller.source
        if moved and isinstance(primary, SaccadeFollowing):
            primary.look_at(self._face.x, self._face.y)

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
        self._personality.breathes = args["on"]
        return InputResult(args)

    # -- every tick -----------------------------------------------------------------------------

    def tick(self, t: float) -> Tick:
        """The body at `t` (seconds, monotonic). Never raises.

        Time that goes back or is none counts as no time at all; the body holds.
        """
        dt = self._advance(t)
        if not self._frozen:
            self._move(dt)
        controller, face = self._joint_controller, self._face
        self._draw(dt)
        emotion, intensity = face.shown
        notices, self._notices = (*self._notices, *controller.notices), []
        controller.notices.clear()
        return Tick(
            t=self._t or 0.0,
            joints=self._safety.last,
            wanted=self._wanted,
            mode=controller.mode,
            emotion=emotion,
            intensity=intensity,
            face=self._frame,
            brightness=face.brightness,
            move=controller.move,
            ended=(*controller.ended(), *face.ended()),
            stroke=controller.stroke(),
            cues=controller.cues(),
            notices=notices,
        )

    def _advance(self, t: float) -> float:
        time = finite_number(t)
        if time is None:
            return 0.0
        before, self._t = self._t, time
        dt = 0.0 if before is None else min(max(time - before, 0.0), LONGEST_S)
        self._now += dt
        return dt

    def _move(self, dt: float) -> None:
        controller, personality = self._joint_controller, self._personality
        personality.step(dt, controller.mode in EXACT)
        moment = SourceContext(
            dt,
            self._now,
            controller.base,
            self._safety.last,
            self._sighting,
            personality["tempo"],
            personality["speed"],
            personality.amplitude.value,
        )
        try:
            pose = controller.step(moment)
        except Exception as error:  # noqa: BLE001 - a stranger's move must not stop the body
            self._drop(error)
            pose = controller.last_pose
        shaped = self._pose_filter.step(
            pose, personality.compression.value, personality.smoothing.value, dt
        )
        self._breathe(dt)
        wanted = self._breath.on(shaped)
        joints = self._safety.step(wanted, dt)
        self._wanted = wanted
        self._note_rejected()
        lagging = {
            name: angle - wanted[name] + shaped[name]
            for name, angle in joints.items()
            if abs(angle - wanted[name]) > ARRIVED
        }
        controller.settle(dt, lagging)

    def _breathe(self, dt: float) -> None:
        personality, mode = self._personality, self._joint_controller.mode
        size = personality["breathing"] if personality.breathes and mode in BREATHES else 0.0
        if mode is Mode.SACCADE:
            size *= SACCADE_BREATH
        self._breath.step(dt, personality["breathing_rate"], size)

    def _draw(self, dt: float) -> None:
        shape, face, controller = self._shape.face, self._face, self._joint_controller
        try:
            if not self._frozen:
                face.set_overlay(controller.source.face_overlay)
                primary = controller.source
                face.led = (
                    primary.eyes(self._safety.last)
                    if isinstance(primary, SaccadeFollowing)
                    else None
                )
                face.step(dt, self._personality, controller.mode in BLINKS)
            if shape is None:
                return
            state = face.state()
            if state != self._drawn_state:
                self._frame, self._drawn_state = draw(state, shape), state
        except Exception as error:  # noqa: BLE001 - the joints go on without a face
            self._notify_once("the face", error)

    # -- what goes wrong ------------------------------------------------------------------------

    def _drop(self, error: Exception) -> None:
        name = self._joint_controller.source.name or "holding a pose"
        self._notify_once(name, error)
        if self._joint_controller.mode is Mode.SACCADE:
            self._centre_eyes()
        self._joint_controller.drop(f"{name} failed: {error}")

    def _notify_once(self, what: str, error: Exception) -> None:
        kind = type(error).__name__
        if (what, kind) not in self._failed:
            self._failed.add((what, kind))
            self._notices.append(f"{what} failed and was left out: {kind}: {error}")

    def _note_rejected(self) -> None:
        rejected = self._safety.rejected
        if rejected or self._rejected:
            new = {name: why for name, why in rejected.items() if name not in self._rejected}
            self._rejected = frozenset(rejected)
            self._notices += [f"{name} stays where it is: {why}" for name, why in new.items()]

    # -- what is known --------------------------------------------------------------------------

    @property
    def eyes(self) -> tuple[float, float]:
        """Where the eyes are seen to look on the face, -1..1: to its left, up."""
        return self._face.eyes

    @property
    def blinking(self) -> bool:
        """Whether a blink is going on."""
        return self._face.blinking

    @property
    def held(self) -> Mapping[str, float]:
        """The pose that hands hold the body in, in degrees: what moves and modes are played on,
        or where a gaze or a pose has led so far.
        """
        controller = self._joint_controller
        return dict(
            controller.last_pose if isinstance(controller.source, LinearMotion) else controller.base
        )

    def speak(self, level: float) -> None:
        """The robot's voice is so loud now, 0..1: so wide is the mouth open."""
        self._face.mouth = finite_number(level) or 0.0

    def state(self) -> BodyState:
        """What a control panel must know to agree with the body."""
        return BodyState(
            controls=self._places(),
            mode=self._joint_controller.mode.value,
            emotion=self._face.shown[0],
            move=self._joint_controller.move,
            personality=self._personality.name,
        )

    def values(self) -> dict[str, Json]:
        """The body's state but for its joints, by name, as messages and logs have it."""
        face, personality = self._face, self._personality
        emotion, intensity = face.shown
        return {
            "mode": self._joint_controller.mode.value,
            "move": self._joint_controller.move,
            "emotion": emotion,
            "intensity": intensity,
            "valence": face.valence,
            "arousal": face.arousal,
            "eye_x": face.x,
            "eye_y": face.y,
            "brightness": face.brightness,
            "personality": personality.name,
            "changed": personality.changed,
            **personality.traits,
            "breathing_on": personality.breathes,
            "blinking": face.blinks_by_itself,
            "stopped": bool(self._frozen),
        }


def _with_gaze_error(sent: Mapping[str, Json], aim: Aim) -> dict[str, Json]:
    """The answer, with the angle by which the gaze misses a target that it cannot reach."""
    if aim.reachable:
        return dict(sent)
    return {**sent, "reachable": False, "error_deg": round(aim.error_deg, 2)}
