"""The driver: verbs in; poses, sounds and readings of one Reachy Mini out."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from typing import Any

from woz_drivers.lines.web_socket_line import AnswerError
from woz_drivers.reachy_mini import doctor
from woz_drivers.reachy_mini.body import ReachyBody
from woz_drivers.reachy_mini.daemon_link import DaemonLink
from woz_drivers.reachy_mini.moves import (
    EMOTIONS,
    LIBRARIES,
    MOVES,
    PoseFrame,
    data_set_and_name,
)
from woz_drivers.reachy_mini.pose import ASLEEP, HOME, Pose, aimed_at, joint_ranges, wanted_joints
from woz_drivers.reachy_mini.senses import ReachySenses
from woz_drivers.reachy_mini.settings import LOUDSPEAKER, ReachyMiniSettings
from woz_drivers.reachy_mini.sounds import ReachySounds
from woz_drivers.sound import live_talk
from woz_drivers.sound.live_talk import LiveTalk, program_loudspeaker
from woz_drivers.speech.settings import VOICE_ARGUMENTS, voice_remarks
from woz_drivers.speech.voice_list import voices
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.argument_values import did_you_mean
from woz_tui.drivers.background import Background, BackgroundTasks
from woz_tui.drivers.confirmed_stop import confirmed_within
from woz_tui.drivers.contract import (
    UNKNOWN,
    Argument,
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Forecast,
    Job,
    Probe,
    RejectedError,
    Scope,
    StopReport,
    Verb,
    VoiceFound,
    Written,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb, known_by
from woz_tui.drivers.sound_feeds import LISTEN, TALK_UNWRITTEN
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.protocol.robot_outline import RobotOutline, Setting

#: The robot is let go within so many seconds.
FAREWELL_S = 1.0
#: At the end other drivers let go of camera and microphones within so many seconds: the daemon,
#: which takes them back, does not try again.
_OTHERS_END_S = 0.5
#: How fast it lies down when it is left alone, in seconds.
_LIES_DOWN_S = 2.0
#: The joints have so long to arrive before they are let go, in seconds.
_SETTLES_S = 0.5
#: Between two moves of the mode `demo`, in seconds.
_DEMO_PAUSE_S = 2.0
_FETCH = "give the robot a network once, and restart its daemon: it fetches them"
MODES = ("normal", "tracking", "demo")
_SILENT = (
    "no speech and sounds are heard: the daemon runs without media",
    "start it without --no-media, or look at its log; with a simulated robot they are silent",
)

Sent = Mapping[str, Json]

# -- what it can do --------------------------------------------------------------------------------

_BODY, _VOICE, _CONTROL = "body", "voice", "control"
_METRES = Range(-100, 100, "m")
_SECONDS = Argument("seconds", "seconds", "0: as fast as it may", False, 0.0, Range(0, 60, "s"))

_SOUND = (
    common_verb(
        "say",
        "speak a sentence with a voice made on this machine",
        *VOICE_ARGUMENTS,
        markup=("pause",),
    ),
    common_verb("sound", "play a WAV file on the robot", lane=_VOICE),
    common_verb("volume"),
    Verb(
        "wobble",
        "let the head move along with speech and sounds, or not",
        (Argument("on", "flag", required=True),),
        lane=_CONTROL,
    ),
)
_POWER = (
    common_verb(
        "torque",
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
        common_verb(
            "mode",
            "tracking: the head follows faces; demo: it shows its moves; normal: neither",
            choices=MODES,
            lane="mode",
        ),
    )


#: What the console's robot screen shows and changes, each by its verb.
_SETTINGS = (
    Setting(
        name="awake",
        section="Motors",
        label="Motors",
        verb="torque",
        argument="on",
        kind="flag",
        help="on: it holds its pose; off: it is limp",
    ),
    Setting(
        name="mode",
        section="Motors",
        label="Mode",
        verb="mode",
        argument="mode",
        kind="choice",
        choices=list(MODES),
        help="tracking: the head follows faces; demo: it shows its moves",
    ),
    Setting(
        name="volume",
        section="Voice",
        label="Volume",
        verb="volume",
        argument="level",
        kind="number",
        help="of the robot's loudspeaker; empty: it has none",
    ),
    Setting(
        name="wobble",
        section="Voice",
        label="Wobbling",
        verb="wobble",
        argument="on",
        kind="flag",
        help="the head moves along with speech and sounds",
    ),
)

# --------------------------------------------------------------------------------------------------


class ReachyMini(Driver):
    """One Reachy Mini behind its daemon."""

    Settings = ReachyMiniSettings
    summary = "Pollen Robotics' Reachy Mini by its daemon, or a simulated one"
    facts = DriverFacts(
        robot=True,
        needs="the address of its daemon; espeak-ng, or another voice",
        simulated="address: simulated, with a visitor",
        stop="its daemon runs no move, its pose stands still, its sound has ended",
        page="docs/how-to/reachy-mini.md",
        example="address: simulated",
        shown=("stop", "loss", "return", "units"),
    )
    settings: ReachyMiniSettings

    def __init__(self, name: str, settings: ReachyMiniSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._link = DaemonLink(
            settings,
            context,
            get_ready=self._get_ready,
            on_status=self._show_settings,
            on_lost=self._when_lost,
        )
        self._body = ReachyBody(self._link, settings, context)
        self._sounds = ReachySounds(self._link, settings, context)
        self._senses = ReachySenses(
            self._link,
            settings,
            context,
            own_sound=lambda: self._sounds.audible or (self._talk is not None and self._talk.on),
            setpoints=lambda: self._body.setpoint,
        )
        self._talk: LiveTalk | None = None
        if (talk := settings.talk) is not None:
            words = functools.partial(talk.play_words, LOUDSPEAKER)
            self._talk = LiveTalk(talk, context, program_loudspeaker(words, context))
        self._wobbles = settings.wobble
        self._mode = MODES[0]
        self._demo = Background("the demo", context)
        self._leaving = BackgroundTasks("following faces no more")
        #: Recorded moves by library, none of one that is not there; without the library: not asked
        #: for, or nobody answered.
        self._installed: Mapping[str, list[str]] = {}
        #: Moves in place of an emotion that the robot turned out not to have.
        self._lacking: set[str] = set()
        self._asking = Background("asking what it has", context)
        #: Of the robot's loudspeaker, 0 to 1; None: it does not say.
        self._level: float | None = None
        self._shown: dict[str, Json] = {}
        #: Whether it was there and went: nobody knows what it does now.
        self._lost = False
        self._told_silent = False
        self._told_moves = ""
        #: Whether the robot was lost while it was asked for its libraries.
        self._lost_by_asking = False
        self._closed = False
        self._stops = BackgroundTasks("a stop")
        self._performers: dict[str, Callable[[Job], Awaitable[Sent]]] = {
            "say": self._sounds.say,
            "sound": self._sounds.sound,
            "volume": self._volume,
            "wobble": self._wobble,
            "torque": self._torque,
            "wake_up": self._wake_up,
            "go_to_sleep": self._go_to_sleep,
            "recorded": self._recorded,
            "emotion": self._emotion,
            "play": self._play,
            "pose": self._pose,
            "poses": self._poses,
            "home": self._home,
            "gaze": self._gaze,
            "nudge": self._nudge,
            "mode": self._set_mode,
        }
        if self._talk is not None:
            self._performers |= dict.fromkeys(live_talk.NAMES, self._talk.perform)
        self._offered = {verb.name for verb in self.verbs(settings)}

    @classmethod
    def verbs(cls, settings: ReachyMiniSettings) -> tuple[Verb, ...]:
        """Speech, sounds, poses, moves, emotions, gaze, motors; a body that is followed has the
        verbs of movement in its place.
        """
        moving = () if settings.follows else _moving(settings)
        talk = () if settings.talk is None else live_talk.VERBS
        every = (*_SOUND, *talk, *moving, _EMOTION, _RECORDED, *_POWER)
        # Its daemon answers each when it is over, but gets setpoints of where it looks.
        return tuple(known_by("timed", known_by("reported", every), "gaze", "nudge"))

    @classmethod
    def lacks(cls, settings: ReachyMiniSettings) -> Mapping[str, str]:
        """A live voice, unless the file says so; its microphones are another driver's."""
        ears = (
            "its microphones are heard by a driver of `type: microphone` where they are connected;"
            " docs/how-to/reachy-mini.md has the lines"
        )
        return {LISTEN: ears, **(TALK_UNWRITTEN if settings.talk is None else {})}

    @classmethod
    def sensors(cls, settings: ReachyMiniSettings) -> tuple[str, ...]:
        """Joints, a face, the direction of sound, speech; how old a live voice is."""
        talk = () if settings.talk is None else (live_talk.TALK,)
        return (*ReachySenses.sensors(settings), *talk)

    @classmethod
    def joints(cls, settings: ReachyMiniSettings) -> Mapping[str, Range]:
        """Joints with their ranges in degrees, or millimetres."""
        return joint_ranges()

    @classmethod
    def outline(cls, settings: ReachyMiniSettings) -> dict[str, Json]:
        """Settings that can be shown and changed, and moves."""
        verbs = {verb.name for verb in cls.verbs(settings)}
        moves = list(settings.playable) if "play" in verbs else []
        shown = [setting for setting in _SETTINGS if setting.verb in verbs]
        return RobotOutline(settings=shown, moves=moves).as_json()

    @classmethod
    def remarks(cls, settings: ReachyMiniSettings, written: Written) -> Iterable[Finding]:
        """A recorded move that is written as none; what the voice does not take."""
        yield from voice_remarks(settings.voice, written)
        move = written.args.get("move") if written.verb == "recorded" else None
        if isinstance(move, str) and UNKNOWN not in move:
            try:
                data_set_and_name(move)
            except RejectedError as error:
                yield Finding("warning", "move", error.what, error.remedy)

    @classmethod
    async def voices(cls, probe: Probe) -> list[VoiceFound]:
        """Those of the synthesisers of this machine."""
        return await voices(probe.folder)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look whether the daemon is there and what it lacks, without moving anything."""
        return await doctor.examine(probe)

    # -- life ------------------------------------------------------------------------------------

    async def open(self) -> None:
        """Begin to look for the daemon."""
        self._sounds.start()
        if self._talk is not None:
            self._talk.start()
        self._link.start()

    async def prepare_say(self, utterances: list[Mapping[str, Json]]) -> None:
        """Synthesise what will be said, and send it to the robot."""
        await self._sounds.prepare(utterances)

    async def perform(self, job: Job) -> Sent:
        """Carry out a verb. Raises `DeviceLostError` while the daemon is not there."""
        performer = self._performers.get(job.verb) if job.verb in self._offered else None
        if performer is None:
            raise RejectedError(f"a Reachy Mini cannot {job.verb!r}")
        if self._closed:
            raise DeviceLostError("the robot's driver is closed")
        self._link.need()
        if job.verb in _ENDS_DEMO:
            await self._end_demo()
        try:
            return await performer(job)
        finally:
            self._show_settings()

    async def stop(self, scope: Scope) -> StopReport | None:
        """Stand still and fall silent; return which of both was confirmed in time.

        It has no wheels: nothing carries it through the room. Nobody talks through it while no
        wizard watches.
        """
        if self._talk is not None:
            await self._talk.stop()
        if scope is Scope.DRIVE:
            return None
        self._body.hold()  # also a robot that comes back while the stop is pressed
        if not self._link.ready:
            return None
        self._demo.cancel()
        self._stops.cancel()
        ended = self._stops.start(self._body.end_moves())
        parts = {"motion": self._stop_motion(ended), "sound": self._stop_sound(ended)}
        ends = {name: [self._stops.start(stop)] for name, stop in parts.items()}
        return await confirmed_within(confirmed_stop.STOP_S, ends)

    async def _stop_motion(self, ended: asyncio.Future[None]) -> None:
        if self._mode == "demo":
            self._take_mode(MODES[0])
        if self._senses.may_track:
            await self._switch_tracking(False)
        self._take_mode(MODES[0])
        await asyncio.shield(ended)
        await self._body.stand_still()

    async def _stop_sound(self, ended: asyncio.Future[None]) -> None:
        """Now, and when no move is left that begins a sound of its own, as waking up does."""
        await self._sounds.stop()
        await asyncio.shield(ended)
        await self._sounds.stop()

    async def resume(self) -> None:
        """The stop was released: a body is followed again."""
        self._stops.cancel()  # what is asked for from now on must not end by them
        self._body.resume()

    async def rest(self) -> None:
        """Lie down slowly and without a sound; then the motors go off."""
        if not self.settings.sleeps or not self._link.ready:
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

    async def close(self) -> None:
        """Let go of the daemon; the robot stays as it is, and does nothing by itself."""
        if self._closed:
            return
        self._closed = True
        await self._stops.close(0.0)
        await self._end_demo()
        await self._asking.close()
        self._leaving.cancel()
        await self._senses.close()
        await asyncio.gather(self._body.close(), self._sounds.close())
        if self._talk is not None:
            await self._talk.close()
        if self._link.ready:
            with contextlib.suppress(DriverError, TimeoutError):
                async with asyncio.timeout(FAREWELL_S):
                    await self._link.ask("POST", "media/tracking/disable")
                    await self._link.ask("POST", "media/wobbling/disable")
            if self.settings.release_media:
                with contextlib.suppress(DeviceLostError):
                    await self._link.pause(_OTHERS_END_S)
                    await self._hold_media(True)
        await self._link.close()

    # -- the daemon ------------------------------------------------------------------------------

    async def _get_ready(self) -> None:
        """The daemon is there, for the first time or again."""
        self._sounds.forget()
        if self._lost:
            # A daemon that was frozen goes on with what it did, where it would be by now.
            await self._link.end_any()
            await self._link.end_running()
            await self._sounds.stop()
        self._lost = False
        if self.settings.release_media:
            await self._hold_media(False)
        await self._switch_wobbling_and_tracking()
        self._senses.begin()
        self.context.mode(self._mode)
        if self._link.status.silent and not self._told_silent:
            self._told_silent = True
            self.context.notice("warning", *_SILENT)
        self._asking.start(self._ask())
        self._body.follow()

    async def _hold_media(self, held: bool) -> None:
        try:
            await self._link.hold_media(held)
        except DeviceLostError:
            raise
        except DriverError as error:
            self.context.notice("warning", error.what, error.remedy)

    async def _switch_wobbling_and_tracking(self) -> None:
        """What moves the head beside its pose: lying down, the daemon switches all of it off."""
        await self._link.ask("POST", f"media/wobbling/{_able(self._wobbles)}")
        await self._senses.track(self._mode == "tracking")

    def _show_settings(self) -> None:
        """Tell of a change, unless nobody knows."""
        shown: dict[str, Json] = {
            "awake": self._link.status.motors == "enabled",
            "mode": self._mode,
            "volume": self._level,
            "wobble": self._wobbles,
        }
        if self._link.ready and shown != self._shown:
            self._shown = shown
            self.context.show(SettingsShown(values=dict(shown)))

    def _when_lost(self, error: DeviceLostError) -> None:
        self._mode = MODES[0]
        self._lost = True
        if self._talk is not None:
            self._talk.fail(error)
        self._demo.cancel()
        self._body.forget()
        self._senses.lost()

    async def _ask(self) -> None:
        """Ask for what takes the daemon its time."""
        with contextlib.suppress(DeviceLostError):
            self._level = await self._sounds.volume()
            self._show_settings()
        complete = all(self._installed.get(library) for library in LIBRARIES)
        if self.settings.libraries and not (complete or self._lost_by_asking):
            await self._ask_library()

    async def _ask_library(self) -> None:
        """Say which recorded moves are there, if that is new. A daemon that has none looks for them
        in the network, and says and does nothing in the meantime: one that is lost over it is not
        asked again, nor any in the middle of a connection.
        """
        try:
            self._installed = told = await self._link.installed()
        except DeviceLostError:
            self._lost_by_asking = True
            self.context.notice(
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
            self.context.notice("info", what, _FETCH if absent else "")

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
            case "play" if args["move"] not in self.settings.recorded:
                return Forecast(body.gesture_s(*self._gesture(args)), ())
            case "say" | "sound":
                return Forecast(await self._sounds.seconds(verb, args))
        return Forecast()

    # -- moving ----------------------------------------------------------------------------------

    async def _pose(self, job: Job) -> Sent:
        return await self._go(job, wanted_joints(job.args["joints"]))

    async def _home(self, job: Job) -> Sent:
        return await self._go(job, HOME)

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
        if name in self.settings.recorded:
            return {"move": name, **await self._play_recorded(self.settings.recorded[name])}
        return {"move": name, **await self._own_move(job, name)}

    async def _own_move(self, job: Job, name: str) -> Sent:
        how = self._gesture({**job.args, "move": name})
        job.expects(self._body.gesture_s(*how))
        seconds = await self._body.gesture(*how)
        return {"seconds": round(seconds, 3), "amplitude": job.args["amplitude"]}

    def _gesture(self, args: Mapping[str, Any]) -> tuple[Sequence[PoseFrame], Pose, float, float]:
        return MOVES[args["move"]], self._body.pose, args["amplitude"], args["speed"]

    async def _recorded(self, job: Job) -> Sent:
        return await self._play_recorded(str(job.args["move"]))

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
        recorded = self.settings.emotions.get(emotion)
        if recorded and self._may_have(recorded):
            try:
                return {"emotion": emotion, **await self._play_recorded(recorded)}
            except (AnswerError, DeviceLostError) as error:
                if self._known_beside(recorded) is not None:
                    raise
                self._lacking.add(recorded)
                what = f"from now on the driver's own {emotion} is shown, not {recorded}"
                self.context.notice("warning", f"{what}: {error.what}", _FETCH)
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
            self._demo.start(self._show())
        self._take_mode(mode)
        return {"mode": mode, "was": was}

    def _take_mode(self, mode: str) -> None:
        self._mode = mode
        self.context.mode(mode)
        self._show_settings()

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

    async def _show(self) -> None:
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
            self.context.notice("warning", f"the demo has ended: {error.what}", error.remedy)

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

    async def _wake_up(self, job: Job) -> Sent:
        await self._link.set_motors("enabled")
        await self._body.play("wake_up")
        await self._switch_wobbling_and_tracking()
        return {}

    async def _go_to_sleep(self, job: Job) -> Sent:
        await self._body.play("goto_sleep")
        await self._link.set_motors("disabled")  # they are: only the newest status may not say so
        await self._switch_wobbling_and_tracking()
        return {}

    async def _volume(self, job: Job) -> Sent:
        self._level = await self._sounds.set_volume(job.args["level"])
        return {"level": self._level}

    async def _wobble(self, job: Job) -> Sent:
        on = job.args["on"]
        await self._link.ask("POST", f"media/wobbling/{_able(on)}")
        self._wobbles = on
        return {"on": on}


#: What moves it ends the mode `demo`.
_ENDS_DEMO = frozenset(
    verb.name
    for verb in (*_moving(ReachyMiniSettings()), _EMOTION, _RECORDED, *_POWER)
    if verb.name != "mode"
)


def _able(on: bool) -> str:
    return "enable" if on else "disable"


def _timed_poses(args: Mapping[str, Any]) -> list[tuple[Pose, float]]:
    """Each with its seconds."""
    return [
        (wanted_joints(pose["joints"]), max(float(pose.get("seconds", 0.5)), 0.0))
        for pose in args["poses"]
    ]
