"""What moves a Reachy Mini: poses, moves, emotions, its gaze; its modes and its motors."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from woz_drivers.lines.web_socket_line import AnswerError
from woz_drivers.reachy_mini.body import ReachyBody
from woz_drivers.reachy_mini.daemon_link import DaemonLink, ReachyPart
from woz_drivers.reachy_mini.moves import (
    EMOTIONS,
    LIBRARIES,
    MOVES,
    PoseFrame,
    data_set_and_name,
)
from woz_drivers.reachy_mini.pose import ASLEEP, HOME, Pose, aimed_at, joint_ranges, wanted_joints
from woz_drivers.reachy_mini.senses import ReachySenses
from woz_drivers.reachy_mini.settings import MODES, SETTINGS, ReachyMiniSettings
from woz_tui.drivers.argument_values import did_you_mean
from woz_tui.drivers.background import BackgroundTasks
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

#: How fast it lies down when it is left alone, in seconds.
_LIES_DOWN_S = 2.0
#: The joints have so long to arrive before they are let go, in seconds.
_SETTLES_S = 0.5
#: Between two moves of the mode `demo`, in seconds.
_DEMO_PAUSE_S = 2.0
_FETCH = "give the robot a network once, and restart its daemon: it fetches them"

Sent = Mapping[str, Json]

_BODY, _CONTROL = "body", "control"
_METRES = Range(-100, 100, "m")
_SECONDS = Argument("seconds", "seconds", "0: as fast as it may", False, 0.0, Range(0, 60, "s"))

_WOBBLE = SETTINGS["wobble"].changed_by(
    "let the head move along with speech and sounds, or not", lane=_CONTROL
)
_POWER = (
    SETTINGS["awake"].changed_by(
        "",
        Argument("by_hand", "flag", "on, but the head can be moved by hand", default=False),
    ),
    Verb("wake_up", "switch the motors on and wake up, with a sound", lane=_BODY),
    Verb("go_to_sleep", "lie down, with a sound; the motors go off", lane=_BODY, limit_s=40.0),
)
_RECORDED = Verb(
    "recorded",
    "play a recorded move of the robot, with its sound",
    (Argument("move", "text", "dances/NAME, emotions/NAME, OWNER/DATA-SET/NAME", required=True),),
    lane=_BODY,
    limit_s=120.0,
)
_EMOTION = common_verb(
    "emotion", "show an emotion by posture and antennas", choices=tuple(EMOTIONS), lane=_BODY
)


def _moving(settings: ReachyMiniSettings) -> tuple[Verb, ...]:
    """What a body does in its place, where it follows one."""
    return (
        common_verb("play", choices=settings.playable),
        common_verb("pose", "take a pose: degrees, and mm for the ways", _SECONDS, arrives=True),
        common_verb("poses", arrives=True),
        common_verb("home", "look ahead, upright", _SECONDS, arrives=True),
        common_verb(
            "gaze",
            "look in a direction, or at a point in space",
            Argument("pitch", "number", "down is positive", range=Range(-90, 90, "deg")),
            Argument("x", "number", "metres forward of the head", range=_METRES),
            Argument("y", "number", "to its left", range=_METRES),
            Argument("z", "number", "above the head", range=_METRES),
        ),
        common_verb("nudge"),
        SETTINGS["mode"].changed_by(
            "tracking: the head follows faces; demo: it shows its moves; normal: neither",
            lane="mode",
        ),
    )


class ReachyMotion(ReachyPart):
    """Everything that moves it. `show` is called when a setting has changed by itself."""

    name = "motion"
    SETTINGS = (SETTINGS["awake"], SETTINGS["mode"], SETTINGS["wobble"])

    def __init__(
        self,
        link: DaemonLink,
        settings: ReachyMiniSettings,
        context: DriverContext,
        body: ReachyBody,
        senses: ReachySenses,
        *,
        show: Callable[[], None],
    ) -> None:
        super().__init__(link, settings, context)
        self._body = body
        self._senses = senses
        self._show = show
        self._wobbles = settings.wobble
        self._mode = MODES[0]
        self._demo = self.background("the demo")
        self._leaving = BackgroundTasks("following faces no more")
        #: Recorded moves by library, none of one that is not there; without the library: not asked
        #: for, or nobody answered.
        self._installed: Mapping[str, list[str]] = {}
        #: Moves in place of an emotion that the robot turned out not to have.
        self._lacking: set[str] = set()
        self._asking = self.background("asking what it has")
        self._told_moves = ""
        #: Whether the robot was lost while it was asked for its libraries.
        self._lost_by_asking = False

    @classmethod
    def offer(cls, settings: ReachyMiniSettings) -> Offer:
        """Poses, moves, emotions, gaze, motors; a body that is followed has the verbs of movement
        in its place. Joints are in degrees, or millimetres.
        """
        return Offer(
            joints=joint_ranges(),
            verbs=(
                *(() if settings.follows else _moving(settings)),
                *(_EMOTION, _RECORDED, *_POWER, _WOBBLE),
            ),
        )

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """What this driver times from where the robot stands: not the daemon's own moves."""
        body = self._body
        match verb:
            case "pose":
                wanted = wanted_joints(args["joints"])
                return Forecast(body.seconds_for(wanted, args["seconds"]), ())
            case "home":
                return Forecast(body.seconds_for(HOME, args["seconds"]), ())
            case "poses":
                return Forecast(sum(seconds for _, seconds in _timed_poses(args)), ())
            case "play" if args["move"] not in self._settings.recorded:
                return Forecast(body.gesture_s(*self._gesture(args)), ())
        return Forecast()

    async def perform(self, job: Job) -> Sent:
        """What moves it ends the mode `demo`."""
        if job.verb not in ("mode", "wobble"):
            await self._end_demo()
        match job.verb:
            case "torque":
                return await self._torque(job)
            case "wake_up":
                return await self._wake_up()
            case "go_to_sleep":
                return await self._go_to_sleep()
            case "recorded":
                return await self._play_recorded(str(job.args["move"]))
            case "emotion":
                return await self._emotion(job)
            case "play":
                return await self._play(job)
            case "pose":
                return await self._go(job, wanted_joints(job.args["joints"]))
            case "poses":
                return await self._poses(job)
            case "home":
                return await self._go(job, HOME)
            case "gaze":
                return await self._gaze(job)
            case "nudge":
                return await self._nudge(job)
            case "mode":
                return await self._set_mode(job)
            case "wobble":
                return await self._wobble(job)
        return await super().perform(job)

    def hold(self, scope: Scope) -> None:
        """Nothing moves, also when a robot comes back while the stop is pressed."""
        self._body.hold()
        self._demo.cancel()

    async def halt(self, scope: Scope) -> Pending:
        """End every move; it stands still when poses say so."""
        ended = self._body.begin_end()
        if self._mode == "demo":
            self._take_mode(MODES[0])
        if self._senses.may_track:
            await self._switch_tracking(False)
        self._take_mode(MODES[0])
        await asyncio.shield(ended)
        await self._body.stand_still()
        return ()

    def resume(self) -> None:
        """A body is followed again."""
        self._body.resume()

    async def connected(self) -> None:
        """Ask which moves it has, and follow the body if it is to."""
        self._context.mode(self._mode)
        complete = all(self._installed.get(library) for library in LIBRARIES)
        if self._settings.libraries and not (complete or self._lost_by_asking):
            self._asking.start(self._ask_library())
        self._body.follow()

    def lost(self) -> None:
        """Its own pose counts when it is back."""
        self._mode = MODES[0]
        self._demo.cancel()
        self._body.forget()

    def shown(self) -> Sent:
        """Motors, mode, wobbling."""
        awake = self._link.status.motors == "enabled"
        return {"awake": awake, "mode": self._mode, "wobble": self._wobbles}

    async def close(self) -> None:
        """End what goes on; the robot stays as it is."""
        await self._end_demo()
        await super().close()
        self._leaving.cancel()
        await self._body.close()

    async def rest(self) -> None:
        """Lie down slowly and without a sound, unless the file says no; then the motors go off."""
        if not self._settings.sleeps:
            return
        await self._end_demo()
        motors = self._link.status.motors
        if motors == "disabled":
            return
        if self._senses.may_track:
            with contextlib.suppress(DriverError):  # it lies down all the same
                await self._switch_tracking(False)
        self._take_mode(MODES[0])
        if motors == "gravity_compensation":
            self._body.forget()
            await self._link.set_motors("enabled")
        await self._body.lie_down(ASLEEP, _LIES_DOWN_S)
        await self._link.pause(_SETTLES_S)
        await self._link.set_motors("disabled")

    async def switch_wobbling_and_tracking(self) -> None:
        """What moves the head beside its pose: lying down, the daemon switches all of it off."""
        await self._link.ask("POST", f"media/wobbling/{_able(self._wobbles)}")
        await self._senses.track(self._mode == "tracking")

    async def _ask_library(self) -> None:
        """Say which recorded moves are there, if that is new. A daemon that has none looks for them
        in the network, and says and does nothing in the meantime: one that is lost over it is not
        asked again, nor any in the middle of a connection.
        """
        try:
            self._installed = told = await self._link.installed()
        except DeviceLostError:
            self._lost_by_asking = True
            self._context.notice(
                "warning",
                "the daemon did not say which recorded moves it has",
                "without a network: set `libraries: false`; the driver's own moves need nothing",
            )
            return
        there = [f"{len(moves)} {name}" for name, moves in told.items() if moves]
        absent = [name for name, moves in told.items() if not moves]
        unknown = [name for name in LIBRARIES if name not in told]
        what = "recorded moves on the robot: " + (", ".join(there) or "none")
        what += f"; not installed: {', '.join(absent)}" if absent else ""
        what += f"; it did not say: {', '.join(unknown)}" if unknown else ""
        if what != self._told_moves:
            self._told_moves = what
            self._context.notice("info", what, _FETCH if absent else "")

    # -- moving ----------------------------------------------------------------------------------

    async def _go(self, job: Job, wanted: Mapping[str, float]) -> Sent:
        job.expects(self._body.seconds_for(wanted, job.args["seconds"]))
        return await self._body.go(wanted, job.args["seconds"])

    async def _poses(self, job: Job) -> Sent:
        poses = _timed_poses(job.args)
        job.expects(sum(seconds for _, seconds in poses))
        total = 0.0
        joints: dict[str, float] = {}
        for wanted, seconds in poses:
            sent = await self._body.go(wanted, seconds)
            total, joints = total + sent["seconds"], {**joints, **sent["joints"]}
        return {"joints": joints, "seconds": round(total, 3)}

    async def _play(self, job: Job) -> Sent:
        name = job.args["move"]
        if name in self._settings.recorded:
            return {"move": name, **await self._play_recorded(self._settings.recorded[name])}
        how = self._gesture(job.args)
        job.expects(self._body.gesture_s(*how))
        seconds = await self._body.gesture(*how)
        return {"move": name, "seconds": round(seconds, 3), "amplitude": job.args["amplitude"]}

    def _gesture(self, args: Mapping[str, Any]) -> tuple[Sequence[PoseFrame], Pose, float, float]:
        return MOVES[args["move"]], self._body.pose, args["amplitude"], args["speed"]

    async def _play_recorded(self, move: str) -> Sent:
        data_set, name = data_set_and_name(move)
        there = self._known_beside(move)
        if there is not None and name not in there:
            library = next(ours for ours, theirs in LIBRARIES.items() if theirs == data_set)
            if not there:
                raise RejectedError(
                    f"the robot has no {library}", f"{_FETCH}; `play` and `emotion` need none"
                )
            raise RejectedError(f"{library} have no {name!r}", did_you_mean(name, there))
        await self._body.play(f"recorded-move-dataset/{data_set}/{name}")
        return {"recorded": move}

    async def _emotion(self, job: Job) -> Sent:
        emotion, intensity = job.args["emotion"], job.args["intensity"]
        recorded = self._settings.emotions.get(emotion)
        if recorded and self._may_have(recorded):
            try:
                return {"emotion": emotion, **await self._play_recorded(recorded)}
            except (AnswerError, DeviceLostError) as error:
                if self._known_beside(recorded) is not None:
                    raise
                self._lacking.add(recorded)
                what = f"from now on the driver's own {emotion} is shown, not {recorded}"
                self._context.notice("warning", f"{what}: {error.what}", _FETCH)
                if isinstance(error, DeviceLostError):  # a daemon that looks in the network is lost
                    raise
        frames = EMOTIONS[emotion]
        if self._body.following:
            self._body.need_motors()
            await self._body.express(frames, intensity)
        else:
            looks = {name: self._body.pose[name] for name in ("pan", "tilt", "body")}
            how = (frames, {**HOME, **looks}, intensity, 1.0)
            job.expects(self._body.gesture_s(*how))
            await self._body.gesture(*how)
        return {"emotion": emotion, "intensity": intensity}

    def _may_have(self, move: str) -> bool:
        """Whether the robot has a recorded move, or nobody knows."""
        known = self._known_beside(move)
        return move not in self._lacking if known is None else data_set_and_name(move)[1] in known

    def _known_beside(self, move: str) -> list[str] | None:
        """The moves of its library; None: nobody knows them."""
        known = {LIBRARIES[library]: moves for library, moves in self._installed.items()}
        return known.get(data_set_and_name(move)[0])

    async def _gaze(self, job: Job) -> Sent:
        args = {name: at for name, at in job.args.items() if at is not None}
        if {"x", "y", "z"} & set(args):
            wanted = aimed_at(*(args.get(axis, 0.0) for axis in ("x", "y", "z")))
        else:
            names = {"yaw": "pan", "pitch": "tilt"}
            wanted = {names[key]: at for key, at in args.items() if key in names}
        if not wanted:
            raise RejectedError("neither a direction nor a point was given")
        return await self._aim(wanted)

    async def _nudge(self, job: Job) -> Sent:
        aimed = self._body.pose
        return await self._aim(
            {"pan": aimed["pan"] + job.args["yaw"], "tilt": aimed["tilt"] + job.args["pitch"]}
        )

    async def _aim(self, wanted: Mapping[str, float]) -> Sent:
        if self._mode == "tracking":
            raise RejectedError("the head follows faces", "`mode: normal` first")
        aimed = await self._body.aim(wanted)
        return {"yaw": aimed.get("pan"), "pitch": aimed.get("tilt")}

    # -- modes and motors ------------------------------------------------------------------------

    async def _set_mode(self, job: Job) -> Sent:
        mode, was = job.args["mode"], self._mode
        if mode == "demo":
            self._body.need_motors()
        await self._end_demo()
        if "tracking" in (mode, was):
            await self._switch_tracking(mode == "tracking")
            self._body.forget()
        if mode == "demo":
            self._demo.start(self._show_moves())
        self._take_mode(mode)
        return {"mode": mode, "was": was}

    def _take_mode(self, mode: str) -> None:
        self._mode = mode
        self._context.mode(mode)
        self._show()

    async def _switch_tracking(self, on: bool) -> None:
        """Have the head follow faces or not; not, if this is cancelled or fails on the way."""
        try:
            await self._senses.track(on)
        except (asyncio.CancelledError, DriverError):
            self._leaving.start(self._leave_tracking())
            raise

    async def _leave_tracking(self) -> None:
        with contextlib.suppress(DriverError):
            await self._senses.track(False)
            if self._mode == "tracking":
                self._take_mode(MODES[0])

    async def _show_moves(self) -> None:
        """Play every move and show every emotion, again and again, until one fails."""
        try:
            while True:
                for frames in (*MOVES.values(), *EMOTIONS.values()):
                    await self._body.gesture(frames, HOME, 1.0, 1.0)
                    await self._link.pause(_DEMO_PAUSE_S)
        except DeviceLostError:
            return  # which ends the mode, too
        except DriverError as error:
            self._take_mode(MODES[0])
            self._context.notice("warning", f"the demo has ended: {error.what}", error.remedy)

    async def _end_demo(self) -> None:
        await self._demo.close()
        if self._mode == "demo":
            self._take_mode(MODES[0])

    async def _torque(self, job: Job) -> Sent:
        by_hand = job.args["by_hand"]
        mode = "gravity_compensation" if by_hand else "enabled"
        mode = mode if job.args["on"] else "disabled"
        self._body.forget()
        try:
            await self._link.set_motors(mode)
        finally:
            self._body.follow()
        return {"on": job.args["on"], "motors": mode}

    async def _wake_up(self) -> Sent:
        await self._link.set_motors("enabled")
        await self._body.play("wake_up")
        await self.switch_wobbling_and_tracking()
        return {}

    async def _go_to_sleep(self) -> Sent:
        await self._body.play("goto_sleep")
        await self._link.set_motors("disabled")  # they are: only the newest status may not say so
        await self.switch_wobbling_and_tracking()
        return {}

    async def _wobble(self, job: Job) -> Sent:
        on = job.args["on"]
        await self._link.ask("POST", f"media/wobbling/{_able(on)}")
        self._wobbles = on
        return {"on": on}


def _able(on: bool) -> str:
    return "enable" if on else "disable"


def _timed_poses(args: Mapping[str, Any]) -> list[tuple[Pose, float]]:
    """Each with its seconds."""
    return [
        (wanted_joints(pose["joints"]), max(float(pose.get("seconds", 0.5)), 0.0))
        for pose in args["poses"]
    ]
