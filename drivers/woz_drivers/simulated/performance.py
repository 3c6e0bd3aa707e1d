"""What each verb does to the simulated body, face and voice."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Collection, Mapping
from pathlib import Path
from typing import Protocol

from woz_drivers.simulated import values
from woz_drivers.simulated.body import Body
from woz_drivers.simulated.moves import known, roles
from woz_drivers.simulated.settings import Settings
from woz_drivers.simulated.speech import utterance
from woz_drivers.simulated.verbs import ANIMATIONS
from woz_tui.core.driver import DriverError, Job, Rejected
from woz_tui.core.messages import Json

Sent = Mapping[str, Json]

#: How long the face takes to change, and a screen or a colour, in seconds.
FACE_SECONDS, SCREEN_SECONDS = 0.3, 0.1

#: A face is looked at so long before it is known, in seconds.
FACE_LEARNT_SECONDS = 1.0

#: Joints that lag behind their track get this much longer to arrive, in seconds.
LAG = 1.5


class Stage(Protocol):
    """What a performance needs from the robot around it."""

    async def spend(self, job: Job, seconds: float, done: Callable[[], bool] | None = None) -> None:
        """Let `seconds` of the simulated world pass, less once `done`; raises what breaks it."""
        ...

    def spoke(self, text: str, seconds: float) -> None:
        """The robot begins to say `text`, for `seconds`."""
        ...

    def learn_face(self, name: str) -> None:
        """The present visitor is called `name`. Raises `DriverError` if that cannot be."""
        ...

    async def learn_room(self, job: Job) -> Sent:
        """Learn the threshold of speech. Raises `DriverError` if that cannot be."""
        ...

    def mode_changed(self, mode: str) -> None:
        """The robot is now in `mode`."""
        ...


class Performance:
    """The acts, by verb."""

    def __init__(self, settings: Settings, body: Body, folder: Path, stage: Stage) -> None:
        self._settings = settings
        self._body = body
        self._folder = folder
        self._stage = stage
        self._moves = known(settings)
        self._roles = roles(settings)
        self.volume = 0.7
        self.mode = settings.modes[0]
        self.emotion = settings.emotions[0]
        self._acts: dict[str, Callable[[Job], Awaitable[Sent]]] = {
            "say": self._say,
            "sound": self._sound,
            "volume": self._set_volume,
            "play": self._play,
            "pose": self._pose,
            "poses": self._poses,
            "home": self._home,
            "torque": self._torque,
            "gaze": self._gaze,
            "nudge": self._nudge,
            "hip": self._hip,
            "emotion": self._emotion,
            "eyes": self._eyes,
            "screen": self._screen,
            "drive": self._drive,
            "mode": self._mode,
            "learn_face": self._learn_face,
            "listen_room": stage.learn_room,
        }

    async def act(self, job: Job) -> Sent:
        """Carry out `job`; returns what was really done."""
        return await self._acts[job.verb](job)

    # -- voice and sound ------------------------------------------------------------------------

    async def _say(self, job: Job) -> Sent:
        said = utterance(values.text(job.args, "text"), self._settings.characters_per_second)
        if not said.text:
            raise Rejected("nothing to say", "give the utterance a text")
        self._stage.spoke(said.text, said.seconds)
        await self._stage.spend(job, said.seconds)
        return {"text": said.text, "seconds": round(said.seconds, 3), "volume": self.volume}

    async def _sound(self, job: Job) -> Sent:
        path = values.file(job.args, "file", self._folder)
        seconds = values.sound_seconds(path)
        await self._stage.spend(job, seconds)
        return {"file": job.args["file"], "seconds": round(seconds, 3)}

    async def _set_volume(self, job: Job) -> Sent:
        self.volume = min(max(values.number(job.args, "level"), 0.0), 1.0)
        return {"level": self.volume}

    async def _learn_face(self, job: Job) -> Sent:
        name = values.text(job.args, "name").strip()
        if not name:
            raise Rejected("a face needs a name", "give a code, such as V7")
        await self._stage.spend(job, FACE_LEARNT_SECONDS)
        self._stage.learn_face(name)
        return {"name": name}

    # -- body -----------------------------------------------------------------------------------

    async def _play(self, job: Job) -> Sent:
        name = values.word(job.args, "move", self._moves)
        speed = values.number(job.args, "speed", 1.0)
        amplitude = values.positive(job.args, "amplitude", 1.0)
        if speed <= 0:
            raise Rejected(f"speed must be more than 0, got {speed:g}")
        move = self._moves[name]
        seconds = move.seconds / speed
        poses = [(share * seconds, self._from_home(pose, amplitude)) for share, pose in move.keys]
        if any(goals for _, goals in poses):
            self._need_torque()
        self._body.trace(poses)
        await self._move(job, seconds, {name for _, goals in poses for name in goals})
        return {"move": name, "seconds": round(seconds, 3), "amplitude": amplitude}

    async def _pose(self, job: Job) -> Sent:
        goals = values.pose(job.args.get("joints"), self._body.joints)
        seconds = values.positive(job.args, "seconds")
        return await self._go(job, goals, seconds)

    async def _home(self, job: Job) -> Sent:
        return await self._go(job, self.home_pose(), values.positive(job.args, "seconds"))

    async def _poses(self, job: Job) -> Sent:
        self._need_torque()
        at = 0.0
        path = []
        for seconds, goals in values.poses(job.args.get("poses"), self._body.joints):
            at += max(seconds, 0.02)
            path.append((at, goals))
        self._body.trace(path)
        names = {name for _, goals in path for name in goals}
        await self._move(job, at, names)
        return {"joints": self._angles(names), "seconds": round(at, 3)}

    async def _go(self, job: Job, goals: Mapping[str, float], seconds: float) -> Sent:
        self._need_torque()
        needed = self._body.go(goals, seconds)
        await self._move(job, needed, goals)
        return {"joints": self._angles(goals), "seconds": round(needed, 3)}

    async def _move(self, job: Job, seconds: float, names: Collection[str]) -> None:
        """Wait until the tracks are through and the joints there; broken off, they stand still."""
        try:
            await self._stage.spend(job, seconds)
            if not self._body.still(names):
                await self._stage.spend(job, LAG, lambda: self._body.still(names))
        except (DriverError, asyncio.CancelledError):
            self._body.hold(names)
            raise

    async def _torque(self, job: Job) -> Sent:
        self._body.torque = values.flag(job.args, "on")
        if not self._body.torque:
            self._body.hold(self._body.joints)
        return {"on": self._body.torque}

    async def _gaze(self, job: Job) -> Sent:
        given = [role for role in ("yaw", "pitch") if job.args.get(role) is not None]
        wanted = {role: values.number(job.args, role) for role in given if role in self._roles}
        return self._aim(wanted)

    async def _nudge(self, job: Job) -> Sent:
        return self._step({role: values.number(job.args, role) for role in ("yaw", "pitch")})

    async def _hip(self, job: Job) -> Sent:
        steps = {"hip": values.number(job.args, "pitch"), "roll": values.number(job.args, "roll")}
        sent = self._step(steps)
        return {{"hip": "pitch"}.get(role, role): degrees for role, degrees in sent.items()}

    def _step(self, steps: Mapping[str, float]) -> Sent:
        for role, step in steps.items():
            if step and role not in self._roles:
                raise Rejected(f"this robot has no joint for {role}", "see `woz check` for joints")
        steps = {role: step for role, step in steps.items() if step}
        return self._aim(
            {role: self._body.joints[self._roles[role]].goal + step for role, step in steps.items()}
        )

    def _aim(self, wanted: Mapping[str, float]) -> Sent:
        self._need_torque()
        self._body.jump({self._roles[role]: degrees for role, degrees in wanted.items()})
        return {role: round(self._body.joints[self._roles[role]].goal, 2) for role in wanted}

    def _from_home(self, pose: Mapping[str, float], amplitude: float) -> dict[str, float]:
        return {
            name: self._settings.joints[name].home + pose[role] * amplitude
            for role, name in self._roles.items()
            if role in pose
        }

    def home_pose(self) -> dict[str, float]:
        """Degrees by joint of the home pose."""
        return {name: joint.home for name, joint in self._settings.joints.items()}

    def _angles(self, names: Collection[str]) -> Json:
        return {name: round(self._body.joints[name].present, 2) for name in sorted(names)}

    def _need_torque(self) -> None:
        if not self._body.torque:
            raise Rejected("the motors are limp", "switch them on first: `torque: on`")

    # -- face, screen, base ---------------------------------------------------------------------

    async def _emotion(self, job: Job) -> Sent:
        emotion = values.word(job.args, "emotion", self._settings.emotions)
        intensity = min(max(values.number(job.args, "intensity", 1.0), 0.0), 1.0)
        await self._stage.spend(job, FACE_SECONDS)
        self.emotion = emotion
        return {"emotion": emotion, "intensity": intensity}

    async def _eyes(self, job: Job) -> Sent:
        color = values.color(job.args, "color")
        animation = values.word({"animation": "steady", **job.args}, "animation", ANIMATIONS)
        await self._stage.spend(job, SCREEN_SECONDS)
        return {"color": color, "animation": animation}

    async def _screen(self, job: Job) -> Sent:
        values.file(job.args, "file", self._folder)
        await self._stage.spend(job, SCREEN_SECONDS)
        return {"file": job.args["file"]}

    async def _drive(self, job: Job) -> Sent:
        x, y, turn = (values.number(job.args, name) for name in ("x", "y", "turn"))
        seconds = max(
            (x * x + y * y) ** 0.5 / self._settings.drive_speed,
            abs(turn) / self._settings.turn_speed,
        )
        base = self._body.base
        begin = (base.x, base.y)
        base.drive(self._body.now, seconds, x, y, turn)
        try:
            await self._stage.spend(job, seconds)
        finally:
            base.freeze()
        way = ((base.x - begin[0]) ** 2 + (base.y - begin[1]) ** 2) ** 0.5
        return {"x": x, "y": y, "turn": turn, "seconds": round(seconds, 3), "way": round(way, 3)}

    async def _mode(self, job: Job) -> Sent:
        was = self.mode
        self.mode = values.word(job.args, "mode", self._settings.modes)
        self._stage.mode_changed(self.mode)
        return {"mode": self.mode, "was": was}
