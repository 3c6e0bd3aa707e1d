"""A simulated Reachy Mini: the daemon of reachy_mini 1.12, as far as clients of ours use it.

Requests, answers, messages and their oddities are those of the vendor's daemon with `--mockup-sim`
(routers/move.py, state.py, media.py, motors.py, daemon.py, io/protocol.py, io/ws_server.py), which
the tests of tests/peers compare with it: several moves run at once and fight, an unknown uuid is
answered with 500 and a connection that is closed, targets are ignored while a move runs. Sound,
camera and microphones, which the vendor's simulation has not, are an assumption: a sound lasts as
long as its file, and a visitor is seen and heard.
"""

from __future__ import annotations

import asyncio
import io
import math
import sys
import uuid
import wave
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from aiohttp import web
from naoqi_simulator.robot_time import SimulatorTime
from naoqi_simulator.visitor import SimulatedVisitors

from robot_simulators.web_robot import WebRobot, run_as_program

#: Poses a second, and seconds from one status to the next, of the robot's time.
RATE, STATUS_S = 50.0, 1.0
#: However fast its time passes, poses are so far apart in real seconds.
_SHORTEST_S = 0.01
MOTORS = ("enabled", "disabled", "gravity_compensation")
#: The vendor's "yaw delta": the body follows a head that is turned farther, in radians.
_TWIST = math.radians(65)
_MOST_BODY = math.radians(160)
#: Half of what its camera sees, across, in radians.
_HALF_VIEW = math.radians(50)
#: Recorded moves by data set, with their seconds.
DATA_SETS: Mapping[str, Mapping[str, float]] = {
    "pollen-robotics/reachy-mini-dances-library": {
        "simple_nod": 2.0,
        "side_to_side_sway": 4.0,
        "groovy_sway_and_roll": 4.0,
        "yeah_nod": 3.0,
    }
}


@dataclass(frozen=True, slots=True)
class WirePose:
    """Where it is: head x, y, z, roll, pitch, yaw (m, rad), antennas right and left, body."""

    head: tuple[float, ...] = (0.0,) * 6
    antennas: tuple[float, float] = (-0.1745, 0.1745)
    body: float = 0.0

    def towards(self, goal: WirePose, share: float) -> WirePose:
        """The pose at a share of the way to another one."""

        def mixed(a: Sequence[float], b: Sequence[float]) -> Any:
            return tuple(x + (y - x) * share for x, y in zip(a, b, strict=True))

        return WirePose(
            mixed(self.head, goal.head),
            mixed(self.antennas, goal.antennas),
            self.body + (goal.body - self.body) * share,
        )

    def solved(self) -> WirePose:
        """As the kinematics have it: the body follows the head."""
        yaw = self.head[5]
        body = min(max(self.body, yaw - _TWIST), yaw + _TWIST)
        return WirePose(self.head, self.antennas, min(max(body, -_MOST_BODY), _MOST_BODY))


ASLEEP = WirePose((-0.021, 0.001, -0.044, 0.0, 0.4257, 0.0), (-3.05, 3.05), 0.0)


@dataclass(slots=True)
class SoundBeingPlayed:
    """What the loudspeaker plays."""

    file: str
    ends: float


@dataclass(slots=True)
class DaemonFaults:
    """What the daemon answers otherwise: path to the text of the body, and oddities.

    Attributes:
        answers: Path to what is answered with 200 in place of the truth.
        locked: Targets are ignored although no move runs (upstream issue 1401).
        drifts: It moves without a move, by so many radians a second.
        short: Gotos end at this share of their time, as on a busy machine.
        nan: Poses hold values that are no numbers.
        poses: Whether it tells poses.
        state: What it says of its own state.
        held: Path to what its requests wait for, before they are carried out.
        hangs_up: Path to how many of its requests are carried out, but not answered: it hangs up.
    """

    answers: dict[str, str] = field(default_factory=dict)
    locked: bool = False
    drifts: float = 0.0
    short: float = 1.0
    nan: bool = False
    poses: bool = True
    state: str = "running"
    held: dict[str, asyncio.Event] = field(default_factory=dict)
    hangs_up: dict[str, int] = field(default_factory=dict)


class ReachyMiniSimulator(WebRobot):
    """Use it as `async with ReachyMiniSimulator() as robot: robot.address`.

    Attributes:
        pose: Where it is.
        motors: One of `MOTORS`.
        volume: Of the loudspeaker, in percent.
        played: Files that were played, in order.
        face, doa: What it sees and hears, where there are no visitors.
        media: Whether it has sound, camera and microphones.
        released: Whether it has let go of camera and microphones; sounds are played all the same.
        oddities: What it answers otherwise than it should.
    """

    def __init__(
        self, time: SimulatorTime | None = None, visitors: SimulatedVisitors | None = None
    ) -> None:
        super().__init__(time, visitors)
        self.pose = WirePose()
        self.target = WirePose()
        self.motors = "enabled"
        self.volume = 60
        self.played: list[str] = []
        self.sound: SoundBeingPlayed | None = None
        self.face: tuple[float, float] | None = None
        self.doa: tuple[float, bool] | None = (math.pi / 2, False)
        self.media = True
        self.released = False
        self.simulated = True
        self.wobbling = False
        self.tracking = 0.0
        self.oddities = DaemonFaults()
        self.data_sets = dict(DATA_SETS)
        self._moves: dict[str, asyncio.Task[None]] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._stop_requested = False
        self._sounds: dict[str, float] = {}

    def routes(self) -> Sequence[web.AbstractRouteDef]:
        """Those of the daemon that are there."""
        return [
            web.get("/ws/sdk", self._sdk),
            web.get("/api/daemon/status", self._answer(self._status)),
            web.get("/api/state/full", self._answer(self._full)),
            web.get("/api/state/doa", self._answer(self._doa)),
            web.get("/api/motors/status", self._answer(lambda: {"mode": self.motors})),
            web.post("/api/motors/set_mode/{mode}", self._set_motors),
            web.get("/api/move/running", self._answer(self._running)),
            web.post("/api/move/goto", self._goto),
            web.post("/api/move/set_target", self._set_target),
            web.post("/api/move/stop", self._stop),
            web.post("/api/move/play/wake_up", self._wake_up),
            web.post("/api/move/play/goto_sleep", self._goto_sleep),
            web.get("/api/move/recorded-move-datasets/list/{owner}/{name}", self._list_data_set),
            web.post(
                "/api/move/play/recorded-move-dataset/{owner}/{name}/{move}", self._play_recorded
            ),
            web.post("/api/media/release", self._release),
            web.post("/api/media/acquire", self._release),
            web.get("/api/media/status", self._answer(self._media)),
            web.post("/api/media/play_sound", self._play_sound),
            web.post("/api/media/stop_sound", self._stop_sound),
            web.post("/api/media/sounds/upload", self._upload),
            web.get("/api/media/sounds", self._answer(lambda: {"files": sorted(self._sounds)})),
            web.post("/api/media/wobbling/{state}", self._wobbling),
            web.post("/api/media/tracking/enable", self._track),
            web.post("/api/media/tracking/disable", self._track_no_more),
            web.get("/api/media/tracking/face", self._answer(self._tracked)),
            web.get("/api/volume/current", self._answer(self._volume)),
        ]

    async def live(self) -> None:
        """Take setpoints, tell poses, and a status every second."""
        status_s = self.time.now()
        await self.tell_all(self._status())
        while True:
            await self._awake.wait()
            now = self.time.now()
            if self.oddities.drifts:
                head = (*self.target.head[:5], self.target.head[5] + self.oddities.drifts / RATE)
                self.target = WirePose(head, self.target.antennas, self.target.body)
            if self.motors == "enabled":
                self.pose = self._aimed().solved()
            await self._tell_pose()
            if now - status_s >= STATUS_S:
                status_s = now
                await self.tell_all(self._status())
            await self._tick()

    async def _tick(self) -> None:
        began = self.time.now()
        await asyncio.sleep(_SHORTEST_S)
        left = began + 1 / RATE - self.time.now()
        if left > 0:
            await self.time.sleep(left)

    async def close(self) -> None:
        """End all moves, too, but without telling anybody."""
        await super().close()
        for move in (*self._moves.values(), *self._tasks):
            move.cancel()

    # -- what it tells ---------------------------------------------------------------------------

    async def _sdk(self, request: web.Request) -> web.StreamResponse:
        opened = web.StreamResponse()
        async for opened, message in self.messages(request):  # noqa: B007  # it is what is answered
            if isinstance(message, dict):
                await self._command(message)
        return opened

    async def _tell_pose(self) -> None:
        if not self.oddities.poses:
            return
        pose = self.pose
        head: list[Any] = [pose.body, *([0.5, -0.5] * 3)]
        matrix: list[list[Any]] = _matrix(pose.head)
        if self.oddities.nan:
            matrix[0][0] = None
            head[0] = math.nan
        await self.tell_all(
            {
                "type": "joint_positions",
                "head_joint_positions": head,
                "antennas_joint_positions": list(pose.antennas),
            }
        )
        await self.tell_all({"type": "head_pose", "head_pose": matrix})

    def _status(self) -> dict[str, Any]:
        return {
            "type": "daemon_status",
            "robot_name": "reachy_mini",
            "state": self.oddities.state,
            "wireless_version": False,
            "desktop_app_daemon": False,
            "simulation_enabled": False,
            "mockup_sim_enabled": self.simulated,
            "no_media": not self.media,
            "media_released": self.released,
            "camera_specs_name": "",
            "backend_status": {"motor_control_mode": self.motors, "error": None},
            "error": None,
            "wlan_ip": None,
            "version": "1.12.0",
            "hardware_id": None,
            "face_target": self._tracked()["face_target"],
        }

    def _full(self) -> dict[str, Any]:
        names = ("x", "y", "z", "roll", "pitch", "yaw")
        return {
            "control_mode": self.motors,
            "head_pose": dict(zip(names, self.pose.head, strict=True)),
            "head_joints": None,
            "body_yaw": self.pose.body,
            "antennas_position": list(self.pose.antennas),
            "timestamp": None,
            "passive_joints": None,
            "doa": self._doa(),
            "imu": None,
        }

    @property
    def moving(self) -> bool:
        return bool(self._moves or self._tasks)

    def _running(self) -> list[dict[str, str]]:
        return [{"uuid": move} for move in self._moves]

    def _media(self) -> dict[str, bool]:
        available = self.media and not self.released
        return {"available": available, "released": self.released, "no_media": not self.media}

    def _volume(self) -> dict[str, Any]:
        return {"volume": self.volume, "platform": "Linux", "device": "simulated"}

    def _doa(self) -> dict[str, Any] | None:
        """0 is left, a quarter turn ahead, half a turn right."""
        person = self.visitors.at(self.time.now()) if self.visitors is not None else None
        if not self.media or self.doa is None:
            return None
        if person is not None:
            return {"angle": math.pi / 2 - person.angle, "speech_detected": person.talking}
        angle, speech = self.doa
        return {"angle": angle, "speech_detected": speech}

    def _tracked(self) -> dict[str, Any]:
        face = self._seen_face() if self.tracking else None
        x, y = face or (None, None)
        roll, now = (None, None) if face is None else (0.0, self.time.now())
        target = {"detected": face is not None, "x": x, "y": y, "roll": roll, "ts": now}
        return {"status": "ok", "face_target": target}

    def _seen_face(self) -> tuple[float, float] | None:
        """From -1, the picture's left edge and top, to 1."""
        if not self.media or self.released:
            return None
        if self.visitors is None:
            return self.face
        person = self.visitors.at(self.time.now())
        if person is None or not person.looking:
            return None
        aside = person.angle - self.pose.head[5]
        return None if abs(aside) > _HALF_VIEW else (-aside / _HALF_VIEW, 0.0)

    def _aimed(self) -> WirePose:
        """The target, drawn towards a face that is tracked."""
        face = self._seen_face() if self.tracking >= 0.5 else None
        if face is None:
            return self.target
        yaw = self.pose.head[5] - 0.2 * face[0] * _HALF_VIEW
        return WirePose((*self.target.head[:5], yaw), self.target.antennas, self.target.body)

    # -- moves -----------------------------------------------------------------------------------

    def _begun(self, name: str, work: Callable[[], Any]) -> web.Response:
        move = str(uuid.uuid4())
        if not self.moving:
            self._stop_requested = False

        async def run() -> None:
            try:
                await work()
            finally:
                self._moves.pop(move, None)

        self._moves[move] = asyncio.create_task(run(), name=name)
        return web.json_response({"uuid": move})

    async def _travel(self, goal: WirePose, seconds: float) -> None:
        """By the minimum jerk, from where it is; another move at the same time fights with it."""
        start, began = self.pose, self.time.now()
        while (spent := self.time.now() - began) < seconds * self.oddities.short:
            if self._stop_requested:
                return
            u = spent / seconds
            self.target = start.towards(goal, u * u * u * (10 - 15 * u + 6 * u * u))
            await self._awake.wait()
            await self._tick()
        if self.oddities.short == 1.0:
            self.target = goal

    async def _goto(self, request: web.Request) -> web.Response:
        body = await self._body(request)
        try:
            goal, seconds = self._goal(body), float(body["duration"])
        except (KeyError, TypeError, ValueError) as error:
            return web.json_response({"detail": repr(error)}, status=422)
        return self._begun("goto", lambda: self._travel(goal, seconds))

    def _goal(self, body: Mapping[str, Any], prefix: str = "") -> WirePose:
        """A whole pose; what is left out stays as it is."""
        head, antennas = body.get(f"{prefix}head_pose"), body.get(f"{prefix}antennas")
        yaw = body.get(f"{prefix}body_yaw")
        names = ("x", "y", "z", "roll", "pitch", "yaw")
        right, left = antennas if antennas is not None else self.pose.antennas
        return WirePose(
            tuple(float(head.get(name, 0.0)) for name in names) if head else self.pose.head,
            (float(right), float(left)),
            self.pose.body if yaw is None else float(yaw),
        )

    async def _set_target(self, request: web.Request) -> web.Response:
        body = await self._body(request)
        if self.moving or self.oddities.locked:
            return web.json_response({"status": "ignored", "reason": "move_running"})
        if body:
            self.target = self._goal(body, "target_")
        return web.json_response({"status": "ok"})

    async def _command(self, message: Mapping[str, Any]) -> None:
        """A message of `/ws/sdk`, which is not answered."""
        match message:
            case {"type": "set_full_target", **rest}:
                self.calls.append(("set_full_target", message))
                if self.moving or self.oddities.locked:
                    return
                head, antennas = rest.get("head"), rest.get("antennas") or self.target.antennas
                body = rest.get("body_yaw")
                self.target = WirePose(
                    _six(head) if head else self.target.head,
                    (antennas[0], antennas[1]),
                    self.target.body if body is None else body,
                )
            case {"type": "task", "uuid": str(task), "req": dict(wanted)}:
                self.calls.append(("task", message))
                self._begin_task(task, wanted)
            case {"type": "stop_move"}:
                self.calls.append(("stop_move", None))
                self._stop_requested = self.moving
            case {"type": "set_volume", "volume": int(volume)}:
                self.calls.append(("set_volume", volume))
                self.volume = volume

    def _begin_task(self, task: str, wanted: Mapping[str, Any]) -> None:
        """A goto of the vendor's own client: in no list of moves, and its end is told to all."""
        head, antennas = wanted.get("head"), wanted.get("antennas") or self.pose.antennas
        body = wanted.get("body_yaw")
        goal = WirePose(
            _six(head) if head else self.pose.head,
            (antennas[0], antennas[1]),
            self.pose.body if body is None else body,
        )
        if not self.moving:
            self._stop_requested = False

        async def run() -> None:
            await self._travel(goal, float(wanted["duration"]))
            progress = {"uuid": task, "finished": True, "error": None}
            now = datetime.now(UTC).isoformat()
            await self.tell_all({"type": "task_progress", **progress, "timestamp": now})

        running = asyncio.create_task(run(), name="task")
        self._tasks.add(running)
        running.add_done_callback(self._tasks.discard)

    async def _stop(self, request: web.Request) -> web.Response:
        body = await self._body(request)
        move = self._moves.pop(str(body.get("uuid")), None)
        if move is None:
            answer = web.Response(status=500, text="Internal Server Error")
            answer.force_close()
            return answer
        move.cancel()
        await asyncio.gather(move, return_exceptions=True)
        return web.json_response({"message": f"Stopped move with UUID: {body['uuid']}"})

    async def _wake_up(self, request: web.Request) -> web.Response:
        await self._body(request)

        async def wake() -> None:
            home = WirePose()
            await self._travel(home, 1.0)
            self._begin_sound("wake_up.wav", 1.0)
            await self._travel(WirePose((0.0, 0.0, 0.0, math.radians(20), 0.0, 0.0)), 0.2)
            await self._travel(home, 0.2)

        return self._begun("wake_up", wake)

    async def _goto_sleep(self, request: web.Request) -> web.Response:
        await self._body(request)

        async def sleep() -> None:
            self.wobbling, self.tracking = False, 0.0
            self._begin_sound("go_sleep.wav", 2.0)
            await self._travel(ASLEEP, 2.0)
            await self.time.sleep(2.0)
            self.motors = "disabled"

        return self._begun("goto_sleep", sleep)

    async def _list_data_set(self, request: web.Request) -> web.Response:
        await self._body(request)
        moves = self.data_sets.get("/".join(request.match_info.values()))
        if moves is None:
            return web.Response(status=500, text="Internal Server Error")
        return web.json_response(sorted(moves))

    async def _play_recorded(self, request: web.Request) -> web.Response:
        await self._body(request)
        parts = request.match_info
        data_set = self.data_sets.get(f"{parts['owner']}/{parts['name']}")
        if data_set is None:
            return web.Response(status=500, text="Internal Server Error")
        seconds = data_set.get(parts["move"])
        if seconds is None:
            return web.json_response({"detail": f"Move {parts['move']} not found"}, status=404)

        async def sway() -> None:
            here = self.pose
            for roll in (0.2, -0.2, 0.0):
                goal = WirePose((*here.head[:3], roll, *here.head[4:]), here.antennas, here.body)
                await self._travel(goal, seconds / 3)

        return self._begun(parts["move"], sway)

    # -- motors and media ------------------------------------------------------------------------

    async def _set_motors(self, request: web.Request) -> web.Response:
        await self._body(request)
        mode = request.match_info["mode"]
        if mode not in MOTORS:
            return web.json_response({"detail": "no such mode"}, status=422)
        if mode == "enabled" and self.motors != mode:
            self.target = self.pose
        self.motors = mode
        return web.json_response({"status": f"motors changed to {mode} mode"})

    async def _release(self, request: web.Request) -> web.Response:
        await self._body(request)
        self.released = self.media and request.path.endswith("release")
        return web.json_response({"status": "ok"})

    def _begin_sound(self, file: str, seconds: float) -> None:
        if self.media:
            self.played.append(file)
            self.sound = SoundBeingPlayed(file, self.time.now() + seconds)

    async def _play_sound(self, request: web.Request) -> web.Response:
        file = str((await self._body(request)).get("file"))
        if file in self._sounds:  # else it says nothing, and plays nothing
            self._begin_sound(file, self._sounds[file])
        return web.json_response({"status": "ok"})

    async def _stop_sound(self, request: web.Request) -> web.Response:
        await self._body(request)
        self.sound = None
        return web.json_response({"status": "ok"})

    async def _upload(self, request: web.Request) -> web.Response:
        self.calls.append((request.path, {}))
        await self._hold(request)
        part = await (await request.multipart()).next()
        name = getattr(part, "filename", None)
        content = await part.read() if part is not None and name else b""  # type: ignore[union-attr]
        try:
            with wave.open(io.BytesIO(content), "rb") as sound:
                seconds = sound.getnframes() / sound.getframerate()
        except (wave.Error, EOFError):
            text = "Unsupported or invalid audio file"
            return web.json_response({"detail": text}, status=400)
        self._sounds[str(name)] = seconds
        path = f"/tmp/reachy_mini_sounds/{name}"
        return web.json_response({"status": "ok", "path": path})

    async def _wobbling(self, request: web.Request) -> web.Response:
        await self._body(request)
        self.wobbling = request.match_info["state"] == "enable"
        return web.json_response({"status": "ok"})

    async def _track(self, request: web.Request) -> web.Response:
        body = await self._body(request)
        self.tracking = float(body.get("weight", 1.0)) if self.media else 0.0
        status = "ok" if self.media else "unavailable"
        return web.json_response({"status": status, "enabled": self.media})

    async def _track_no_more(self, request: web.Request) -> web.Response:
        await self._body(request)
        self.tracking = 0.0
        return web.json_response({"status": "ok", "enabled": False})

    # -- requests --------------------------------------------------------------------------------

    async def _body(self, request: web.Request) -> dict[str, Any]:
        """Its JSON, kept among the calls."""
        body = await request.json() if request.can_read_body else {}
        self.calls.append((request.path, body))
        await self._hold(request)
        return body if isinstance(body, dict) else {}

    async def _hold(self, request: web.Request) -> None:
        held = self.oddities.held.get(request.path)
        if held is not None:
            await held.wait()
        if self.oddities.hangs_up.get(request.path, 0) > 0:
            self.oddities.hangs_up[request.path] -= 1
            assert request.transport is not None
            request.transport.abort()

    def _answer(self, value: Callable[[], Any]) -> Callable[[web.Request], Any]:
        async def answer(request: web.Request) -> web.Response:
            self.calls.append((request.path, {}))
            await self._hold(request)
            odd = self.oddities.answers.get(request.path)
            if odd is not None:
                return web.Response(text=odd, content_type="application/json")
            return web.json_response(value())

        return answer


def _matrix(head: Sequence[float]) -> list[list[float]]:
    """4 x 4 from x, y, z, roll, pitch, yaw."""
    x, y, z, roll, pitch, yaw = head
    sr, cr, sp, cp = math.sin(roll), math.cos(roll), math.sin(pitch), math.cos(pitch)
    sy, cy = math.sin(yaw), math.cos(yaw)
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, x],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, y],
        [-sp, cp * sr, cp * cr, z],
        [0.0, 0.0, 0.0, 1.0],
    ]


def _six(flat: Sequence[float]) -> tuple[float, ...]:
    """x, y, z, roll, pitch, yaw of a 4 x 4 matrix in one row."""
    roll = math.atan2(flat[9], flat[10])
    pitch = math.atan2(-flat[8], math.hypot(flat[9], flat[10]))
    return (flat[3], flat[7], flat[11], roll, pitch, math.atan2(flat[4], flat[0]))


if __name__ == "__main__":
    sys.exit(run_as_program("reachy_mini", ReachyMiniSimulator))
