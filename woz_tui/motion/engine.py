"""The body's engine: told what people want, asked for the setpoints of a moment.

From the inside out: the primary's pose, cross-faded; compression; smoothing; breathing; safety.
Same shape, moves, seed and inputs at the same ticks: same setpoints and same pictures.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_feeds import BodyState, Sighting
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.body_verbs import CONTROL_KINDS, KINDS, body_verbs
from woz_tui.motion.engine_io import EndedInput, InputResult, Tick
from woz_tui.motion.face_drawing import FaceState, draw, prepare
from woz_tui.motion.joint_control import ARRIVED
from woz_tui.motion.light_frames import LightFrame, blank
from woz_tui.motion.modes import BLINKS, BREATHES, InputKind, Mode, Operator, is_accepted
from woz_tui.motion.move import Move
from woz_tui.motion.pose_blending import Breathing
from woz_tui.motion.pose_sources import LinearMotion, SaccadeFollowing, SourceContext
from woz_tui.motion.safety import finite_number
from woz_tui.motion.verb_handlers import Args, VerbHandlers
from woz_tui.protocol.messages import Json

#: Time that counts between two ticks at most, in seconds; whoever slept longer goes on from there.
LONGEST_S = 10.0
#: Modes in which the head has to hit a target: it neither compresses nor smooths its way.
EXACT = frozenset({Mode.TRACKING, Mode.SACCADE})
#: The share of its breath that a body keeps while its eyes lead: they make up for it, and a whole
#: breath would keep them wandering about the middle.
SACCADE_BREATH = 0.3


class Engine(VerbHandlers):
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
        super().__init__(shape, moves, seed, present)
        self._verbs = {verb.name: verb for verb in body_verbs(shape, moves)}
        self._breath = Breathing(shape)
        self._seen: Sighting | None = None
        self._frozen = ""
        self._t: float | None = None
        self._notices: list[str] = []
        self._failed: set[tuple[str, str]] = set()
        self._rejected: frozenset[str] = frozenset()
        self._wanted: Mapping[str, float] = dict(self._safety.last)
        self._drawn: FaceState | None = None
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

    def learn(self, moves: Mapping[str, Move]) -> None:
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
        mode = self._steering.mode
        if is_accepted(kind, mode, hand):
            return self._acts[verb](read)
        if verb == "control" and kind is InputKind.JOINTS and hand is Operator.WIZARD:
            answer = self._acts[verb](read)
            return InputResult({**answer.sent, "waits": Mode.NORMAL.value})
        what = "a change of mode" if kind is InputKind.MODE else kind.value
        raise RejectedError(f"the mode {mode.value} ignores {what}", "mode: normal ends it")

    def _checked(self, verb: object, args: object) -> Args:
        """The arguments as the verb has them. Of angles, those that make no sense are left out by
        `VerbHandlers` and named, so that the other joints move.
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
        self._seen = seen

    def freeze(self, why: str = "stop") -> None:
        """Stand still at once, without a breath, until `resume`; whatever went on is over."""
        joints = self._safety.last
        still = all(abs(joints[j] - self._wanted[j]) < ARRIVED for j in joints)
        self._safety.restart(joints)
        self._leave(f"stopped: {why}")
        self._steering.freeze(f"stopped: {why}", joints, still)
        self._breath.hold()
        self._face.calm()
        self._wanted = dict(joints)
        self._frozen = why or "stop"

    def resume(self) -> None:
        """Stir again, in the pose where it stands."""
        self._frozen = ""

    def drop(self, token: int, why: str = "cut short") -> None:
        """End the input that `apply` gave this token to, if it still goes on.

        A gaze or pose ends where it is, a move gives the pose from before back, a breakdown the
        emotion.
        """
        if token and token == self._steering.primary.token:
            self._steering.stop(why)
        self._face.drop(token, why)

    def restart(self, present: Mapping[str, float]) -> None:
        """Go on from this pose, in degrees, before the first servo moves."""
        self._leave("the joints are where they are")
        self._safety.restart(present)
        self._steering.restart(self._safety.last)
        self._breath.hold()
        self._wanted = dict(self._safety.last)

    # -- every tick -----------------------------------------------------------------------------

    def tick(self, t: float) -> Tick:
        """The body at `t` (seconds, monotonic). Never raises.

        Time that goes back or is none counts as no time at all; the body holds.
        """
        dt = self._advance(t)
        if not self._frozen:
            self._move(dt)
        steering, face = self._steering, self._face
        self._draw(dt)
        emotion, intensity = face.shown
        return Tick(
            t=self._t or 0.0,
            joints=self._safety.last,
            wanted=self._wanted,
            mode=steering.mode,
            emotion=emotion,
            intensity=intensity,
            face=self._frame,
            brightness=face.brightness,
            move=steering.move,
            ended=self._ended(),
            cues=steering.cues(),
            notices=self._told(),
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
        steering, character = self._steering, self._character
        character.step(dt, steering.mode in EXACT)
        moment = SourceContext(
            dt,
            self._now,
            steering.base,
            self._safety.last,
            self._seen,
            character["tempo"],
            character["speed"],
            character.amplitude.value,
        )
        try:
            pose = steering.step(moment)
        except Exception as error:  # noqa: BLE001 - a stranger's move must not stop the body
            self._drop(error)
            pose = steering.here
        shaped = self._shaping.step(
            pose, character.compression.value, character.smoothing.value, dt
        )
        self._breathe(dt)
        wanted = self._breath.on(shaped)
        joints = self._safety.step(wanted, dt)
        self._wanted = wanted
        self._tell_rejected()
        lagging = {
            name: angle - wanted[name] + shaped[name]
            for name, angle in joints.items()
            if abs(angle - wanted[name]) > ARRIVED
        }
        steering.settle(dt, lagging)

    def _breathe(self, dt: float) -> None:
        character, mode = self._character, self._steering.mode
        size = character["breathing"] if character.breathes and mode in BREATHES else 0.0
        if mode is Mode.SACCADE:
            size *= SACCADE_BREATH
        self._breath.step(dt, character["breathing_rate"], size)

    def _draw(self, dt: float) -> None:
        shape, face, steering = self._shape.face, self._face, self._steering
        try:
            if not self._frozen:
                face.lead(steering.primary.wish)
                primary = steering.primary
                face.led = (
                    primary.eyes(self._safety.last)
                    if isinstance(primary, SaccadeFollowing)
                    else None
                )
                face.step(dt, self._character, steering.mode in BLINKS)
            if shape is None:
                return
            state = face.state()
            if state != self._drawn:
                self._frame, self._drawn = draw(state, shape), state
        except Exception as error:  # noqa: BLE001 - the joints go on without a face
            self._say_once("the face", error)

    # -- what goes wrong ------------------------------------------------------------------------

    def _drop(self, error: Exception) -> None:
        name = self._steering.primary.name or "holding a pose"
        self._say_once(name, error)
        if self._steering.mode is Mode.SACCADE:
            self._eyes_back()
        self._steering.drop(f"{name} failed: {error}")

    def _say_once(self, what: str, error: Exception) -> None:
        kind = type(error).__name__
        if (what, kind) not in self._failed:
            self._failed.add((what, kind))
            self._notices.append(f"{what} failed and was left out: {kind}: {error}")

    def _tell_rejected(self) -> None:
        rejected = self._safety.rejected
        if rejected or self._rejected:
            new = {name: why for name, why in rejected.items() if name not in self._rejected}
            self._rejected = frozenset(rejected)
            self._notices += [f"{name} stays where it is: {why}" for name, why in new.items()]

    def _ended(self) -> tuple[EndedInput, ...]:
        return (*self._steering.ended(), *self._face.ended())

    def _told(self) -> tuple[str, ...]:
        notices, self._notices = [*self._notices, *self._steering.notices], []
        self._steering.notices.clear()
        return tuple(notices)

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
        steering = self._steering
        return dict(steering.here if isinstance(steering.primary, LinearMotion) else steering.base)

    def state(self) -> BodyState:
        """What a control panel must know to agree with the body."""
        return BodyState(
            controls=self._places(),
            mode=self._steering.mode.value,
            emotion=self._face.shown[0],
            move=self._steering.move,
            personality=self._character.name,
        )

    def values(self) -> dict[str, Json]:
        """Everything that can be said about the body but for its joints."""
        face, character = self._face, self._character
        emotion, intensity = face.shown
        return {
            "mode": self._steering.mode.value,
            "move": self._steering.move,
            "emotion": emotion,
            "intensity": intensity,
            "valence": face.valence,
            "arousal": face.arousal,
            "eye_x": face.x,
            "eye_y": face.y,
            "brightness": face.brightness,
            "personality": character.name,
            "changed": character.changed,
            **character.traits,
            "breathing_on": character.breathes,
            "blinking": face.blinks_by_itself,
            "stopped": bool(self._frozen),
        }
