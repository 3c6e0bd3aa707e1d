"""A Furhat's face: gestures, emotions, single parameters, and which face is shown.

The robot's own gestures run on the robot. What consists of face parameters is sent from here, piece
by piece, so that it ends at once with the stop.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping, Sequence
from typing import Any

from woz_drivers.furhat.head import FurhatHead, within
from woz_drivers.furhat.link import Exchange, FurhatLink, FurhatPart
from woz_drivers.furhat.moves import (
    COMMON_GESTURES,
    EMOTIONS,
    FACE_PARAMETERS,
    GESTURES,
    HEAD_MOVES,
    FaceFrame,
    offered_moves,
)
from woz_drivers.furhat.realtime_events import FaceStatus, GestureEnded, GestureStarted
from woz_drivers.furhat.settings import SETTINGS, FurhatSettings
from woz_tui.drivers.argument_values import (
    did_you_mean,
    known_joints,
    number,
    positive,
    text,
    word,
)
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

#: From one message with face parameters to the next, in seconds.
STEP_S = 0.04
#: An emotion comes and goes in this time, in seconds.
_FADE_S = 0.4
#: A gesture must begin within this, in seconds, and lasts no longer than that.
_BEGINS_WITHIN_S, _ENDS_WITHIN_S = 2.0, 30.0
#: About so long the robot's own gestures take.
_LASTS_S = 1.0
_SECONDS = Argument("seconds", "seconds", "0: at once", default=0.0, range=Range(0, 60))
_CONFIGURED = ("visible", "microexpressions", "blinking", "head_sway")


class FurhatFace(FurhatPart):
    """`play`, `emotion`, `pose`, `poses`, `home`, `face`."""

    name = "gesture"
    SETTINGS = (SETTINGS["face"],)

    def __init__(
        self,
        link: FurhatLink,
        settings: FurhatSettings,
        context: DriverContext,
        head: FurhatHead,
    ) -> None:
        super().__init__(link, settings, context)
        self._head = head
        self._gesture: Exchange[GestureEnded] | None = None
        #: What the face holds: of the emotion, over it of poses, over both of a gesture of ours.
        self._emotion: dict[str, float] = {}
        self._posed: dict[str, float] = {}
        self._played: dict[str, float] = {}
        #: What was sent last, and counts up with each stop: what moves the face then ends.
        self._sent: dict[str, float] = {}
        self._stops = 0
        self._wanted_face = settings.face
        self._shown_face = ""
        self._faces: list[str] = []
        self._configured: dict[str, bool] = {}

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """Gestures by name, emotions, face parameters as joints. The joints go from 0 to 1;
        those of neck and gaze are in degrees.
        """
        moves = offered_moves(settings.gestures)
        return Offer(
            verbs=(
                common_verb("play", choices=moves),
                common_verb("pose", "set face parameters", _SECONDS, arrives=True),
                common_verb("poses", "pass through face parameters over time", arrives=True),
                common_verb("home", "a neutral face that looks straight on", _SECONDS),
                common_verb("emotion", choices=tuple(EMOTIONS)),
                Verb(
                    "face",
                    "show another face, or change how it lives",
                    (
                        SETTINGS["face"].taken(default=""),
                        *(Argument(name, "flag", "leave out: as it is") for name in _CONFIGURED),
                    ),
                    lane="face",
                ),
            ),
            joints=FACE_PARAMETERS,
        )

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """What this driver times; the robot's own gestures about so long."""
        if verb == "play":
            move = word(args, "move", offered_moves(self._settings.gestures))
            frames = self._own_frames(move)
            seconds = sum(frame.seconds for frame in frames) if frames else _LASTS_S
            return Forecast(seconds / number(args, "speed", 1.0), () if frames else None)
        if verb in ("pose", "poses"):
            return Forecast(sum(seconds for _, seconds in _timed_poses(verb, args)), ())
        return Forecast(positive(args, "seconds", 0.0), ()) if verb == "home" else Forecast()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Ends when it is over."""
        match job.verb:
            case "play":
                return await self._play(job)
            case "pose" | "poses":
                return await self._poses(job)
            case "home":
                return await self._home(job)
            case "emotion":
                return await self._feel(job)
            case "face":
                return await self._configure(job)
        return await super().perform(job)

    def hold(self, scope: Scope) -> None:
        """What is sent from here ends; the face keeps nothing of a gesture of ours."""
        self._stops += 1
        self._played.clear()

    async def halt(self, scope: Scope) -> Pending:
        """End gestures; the expression stays."""
        gesture = self._gesture
        if gesture is None or gesture.over.done():
            await self._send_face()
            return []
        await self._reset_face()
        return [gesture.over]

    async def connected(self) -> None:
        """Show the face that was wanted, with the expression of before."""
        self._gesture = None
        await self._reset_face()
        if self._configured:
            await self._link.send("request.face.config", **self._configured)
        status = await self._link.ask("request.face.status", FaceStatus)
        self._faces = status.face_list or []
        self._shown_face = status.face_id or ""
        wanted = self._wanted_face
        if wanted and wanted != self._shown_face:
            self._require_listed(wanted)
            await self._link.send("request.face.config", face_id=wanted, **self._configured)
            self._shown_face = wanted

    def shown(self) -> Mapping[str, Json]:
        """Which face it is."""
        return {"face": self._shown_face} if self._shown_face else {}

    # -- gestures ------------------------------------------------------------------------------

    async def _play(self, job: Job) -> dict[str, Json]:
        move = word(job.args, "move", offered_moves(self._settings.gestures))
        speed = number(job.args, "speed", 1.0)
        amplitude = number(job.args, "amplitude", 1.0)
        if frames := self._own_frames(move):
            await self._frames(job, frames, speed, amplitude)
        else:
            gesture = COMMON_GESTURES.get(move, move)
            job.expects(_LASTS_S / speed)
            await self._robot_gesture(gesture, 1.0 / speed, amplitude)
            job.evidence("reported")
            return {"move": move, "gesture": gesture}
        return {"move": move}

    def _own_frames(self, move: str) -> Sequence[FaceFrame]:
        """Of a gesture of the robot file, or one of ours; none: the robot has it."""
        if move in self._settings.gestures:
            return self._settings.frames(move)
        return HEAD_MOVES.get(move, ())

    async def _robot_gesture(self, name: str, duration: float, intensity: float) -> None:
        assert name in GESTURES
        if self._gesture is not None:
            self._link.forget(self._gesture)
        gesture = self._gesture = await self._link.begin(
            *("request.gesture.start", GestureEnded, GestureStarted),
            name=name,
            intensity=intensity,
            duration=duration,
            monitor=True,
        )
        late = DriverError(
            f"the robot did not play the gesture {name}", "does its software have it?"
        )
        try:
            event = await gesture.next(_BEGINS_WITHIN_S, late)
            while not isinstance(event, GestureEnded):
                event = await gesture.next(_ENDS_WITHIN_S, late)
        except asyncio.CancelledError:
            await self._end_on_robot(gesture)
            raise
        except DeviceLostError:
            raise
        except DriverError:
            await self._end_on_robot(gesture)  # what did not begin in time must not begin later
            self._link.forget(gesture)
            raise

    async def _end_on_robot(self, gesture: Exchange[GestureEnded]) -> None:
        if self._link.ready and not gesture.over.done():
            with contextlib.suppress(DeviceLostError):
                await self._reset_face()

    async def _frames(
        self, job: Job, frames: Sequence[FaceFrame], speed: float, amplitude: float
    ) -> None:
        """A gesture of ours; what it changed is as before at its end, however it ends."""
        job.expects(sum(frame.seconds for frame in frames) / speed)
        yaw, pitch = self._head.direction()
        before = turned = self._head.turned_to
        turns = any(frame.yaw or frame.pitch for frame in frames)
        stops = self._stops
        try:
            for frame in frames:
                # What turns the head meanwhile has it: the gesture goes on without.
                if turns and turned == self._head.turned_to:
                    aim = within(yaw + frame.yaw * amplitude, pitch + frame.pitch * amplitude)
                    turned = "", *aim
                    await self._head.look(*aim)
                scaled = _bounded({name: share * amplitude for name, share in frame.face.items()})
                below = {**self._emotion, **self._posed}
                wanted = {name: below.get(name, 0.0) for name in self._played} | scaled
                for name in scaled:
                    self._played.setdefault(name, below.get(name, 0.0))
                await self._ramp(self._played, wanted, frame.seconds / speed)
                if stops != self._stops:
                    return
        except DeviceLostError:
            if before != turned == self._head.turned_to:
                self._head.want(before)
            raise
        finally:
            self._played.clear()
            if self._link.ready:
                with contextlib.suppress(DeviceLostError):
                    await self._send_face()
                    if stops == self._stops and before != turned == self._head.turned_to:
                        await self._head.turn_back(before)

    async def _poses(self, job: Job) -> dict[str, Json]:
        steps = _timed_poses(job.verb, job.args)
        job.expects(sum(seconds for _, seconds in steps))
        stops = self._stops
        for wanted, seconds in steps:
            await self._ramp(self._posed, wanted, seconds)
            if stops != self._stops:
                break
        return {"joints": dict(steps[-1][0])}

    async def _home(self, job: Job) -> dict[str, Json]:
        seconds = positive(job.args, "seconds", 0.0)
        job.expects(seconds)
        await self._head.look(0.0, 0.0)
        await self._ramp(self._posed, {}, 0.0, whole=True)
        await self._ramp(self._emotion, {}, seconds, whole=True)
        await self._reset_face()
        return {"seconds": seconds}

    # -- the expression ------------------------------------------------------------------------

    async def _feel(self, job: Job) -> dict[str, Json]:
        emotion = word(job.args, "emotion", EMOTIONS)
        intensity = min(max(number(job.args, "intensity", 1.0), 0.0), 1.0)
        wanted = {name: share * intensity for name, share in EMOTIONS[emotion].items()}
        await self._ramp(self._emotion, wanted, _FADE_S, whole=True)
        return {"emotion": emotion, "intensity": intensity}

    async def _ramp(
        self,
        layer: dict[str, float],
        wanted: Mapping[str, float],
        seconds: float,
        *,
        whole: bool = False,
    ) -> None:
        """Bring a layer of the face there in so many seconds; `whole`: what is not named goes to 0.

        Ends early at a stop, and the face holds what it has.
        """
        loop = asyncio.get_running_loop()
        names = {*wanted, *(layer if whole else ())}
        start = {name: layer.get(name, 0.0) for name in names}
        begun, stops = loop.time(), self._stops
        while True:
            share = 1.0 if seconds <= 0 else min(1.0, (loop.time() - begun) / seconds)
            for name in names:
                layer[name] = start[name] + (wanted.get(name, 0.0) - start[name]) * share
            await self._send_face()
            if share >= 1.0:
                break
            await asyncio.sleep(min(STEP_S, seconds * (1.0 - share)))
            if stops != self._stops:
                self._link.need()  # it was a stop, or the robot was lost
                return
        for name in names if layer is not self._played else ():
            if layer.get(name) == 0.0:
                del layer[name]

    async def _send_face(self) -> None:
        """What has changed since the last message."""
        wanted = _bounded({**self._emotion, **self._posed, **self._played})
        for name in self._sent:
            wanted.setdefault(name, 0.0)
        changed = {
            name: round(share, 4)
            for name, share in wanted.items()
            if round(share, 4) != self._sent.get(name, 0.0)
        }
        if changed:
            self._sent |= changed
            await self._link.send("request.face.params", params=changed)

    async def _reset_face(self) -> None:
        """End gestures of the robot, which takes the expression along; show that again."""
        self._sent = {}
        await self._link.send("request.face.reset")
        await self._send_face()

    # -- which face ----------------------------------------------------------------------------

    async def _configure(self, job: Job) -> dict[str, Json]:
        face = text({"face": job.args.get("face") or ""}, "face").strip()
        flags = {name: job.args[name] for name in _CONFIGURED if job.args.get(name) is not None}
        if not face and not flags:
            raise RejectedError("nothing to change was named", "give a face, or a flag")
        if face:
            self._require_listed(face)
        sent = {"visibility" if name == "visible" else name: bool(on) for name, on in flags.items()}
        wanted = {"face_id": face} if face else {}
        await self._link.send("request.face.config", **wanted, **sent)
        self._configured |= sent
        if face:
            status = await self._link.ask("request.face.status", FaceStatus, face_list=False)
            self._shown_face = status.face_id or face
            if self._shown_face != face:
                raise DriverError(f"the robot shows {self._shown_face}, not {face}", "try again")
            self._wanted_face = face
        return {"face": self._shown_face, **flags}

    def _require_listed(self, face: str) -> None:
        """Raises `RejectedError` for a face that the robot does not list."""
        if self._faces and face not in self._faces:
            raise RejectedError(
                f"the robot has no face {face!r}", did_you_mean(face, sorted(self._faces))
            )

    def lost(self) -> None:
        """What moves the face ends."""
        self.hold(Scope.ALL)


def _bounded(params: Mapping[str, float]) -> dict[str, float]:
    """Within what each parameter may be."""
    bounded = {}
    for name, share in params.items():
        limits = FACE_PARAMETERS[name]
        bounded[name] = min(max(share, limits.low or 0.0), limits.high or 1.0)
    return bounded


def _checked(joints: Any) -> Mapping[str, float]:
    """Face parameters of a command, or `RejectedError`."""
    if not isinstance(joints, Mapping) or not joints:
        raise RejectedError("no face parameter was named", "such as JAW_OPEN: 0.5")
    return _bounded(known_joints(joints, FACE_PARAMETERS))


def _timed_poses(verb: str, args: Mapping[str, Any]) -> list[tuple[Mapping[str, float], float]]:
    """Each with its seconds."""
    poses = [args] if verb == "pose" else args.get("poses") or []
    steps = [(_checked(one.get("joints")), positive(one, "seconds")) for one in poses]
    if not steps:
        raise RejectedError("there are no poses", "write at least one")
    return steps
