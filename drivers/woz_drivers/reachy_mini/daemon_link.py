"""The vendor's daemon: its requests by name, and its pose, which it sends fifty times a second.

Requests go to `/api`; the WebSocket `/ws/sdk` takes setpoints without an answer, and sends
`joint_positions`, `head_pose` and, once a second, `daemon_status`.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass, replace
from typing import Any

import aiohttp

from woz_drivers.lines.web_robot_link import WebRobotLink
from woz_drivers.lines.web_socket_line import AnswerError
from woz_drivers.programs.simulated_process import SimulatedProcess
from woz_drivers.reachy_mini.moves import LIBRARIES
from woz_drivers.reachy_mini.pose import (
    LIMITS,
    Pose,
    body_from_joints,
    goto_body,
    head_from_matrix,
    target_message,
)
from woz_drivers.reachy_mini.settings import ReachyMiniSettings
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError
from woz_tui.drivers.robot_parts import RobotPart

WEB_SOCKET = "/ws/sdk"
#: Answers come after some milliseconds; a stop must have all of its own within its half second.
QUICK_S = 0.4
#: An upload of a sound, and a list of moves that the daemon may have to read from its disk.
UPLOAD_S, LIST_S = 20.0, 5.0
#: Its camera and microphones are let go, or opened again, before it answers.
MEDIA_S = 4.0
#: It stands still when it has moved by no more than so much, in degrees or millimetres, in so many
#: seconds, and at least so many poses were seen in them. In the physical simulation the head swings
#: by half a degree for some tenths of a second after a move was broken off.
STILL_BY, STILL_S, STILL_POSES = 0.8, 0.1, 4
#: The newest pose says nothing of where the joints are when it is older, in seconds.
RECENT_S = 0.5
_REMEDY = "look at the daemon's own log; restart the daemon"


@dataclass(frozen=True, slots=True)
class DaemonStatus:
    """What the daemon says of itself once a second. `motors`: enabled, disabled or
    gravity_compensation. `silent`: it has neither sound nor camera; `released`: it has let go of
    its camera and microphones, and plays sounds all the same.
    """

    name: str = ""
    version: str = ""
    state: str = ""
    motors: str = ""
    simulated: bool = False
    silent: bool = False
    released: bool = False
    error: str = ""


class DaemonLink(WebRobotLink):
    """One daemon, looked for until `close`.

    `get_ready()` is awaited after each opening, when a pose has come; `on_status()` is
    called with each status that comes, once a second; `on_lost` is called once for
    each opening that ended.
    """

    def __init__(
        self,
        settings: ReachyMiniSettings,
        context: DriverContext,
        *,
        get_ready: Callable[[], Coroutine[Any, Any, None]],
        on_status: Callable[[], None],
        on_lost: Callable[[DeviceLostError], None],
    ) -> None:
        simulated = SimulatedProcess(
            "robot_simulators.reachy_mini", ("--pace", f"{settings.pace:g}"), context.folder
        )
        shown = settings.address if settings.place else "the simulated Reachy Mini"
        super().__init__(context, shown, simulated, settings.place, WEB_SOCKET)
        self._settings = settings
        self._prepare = get_ready
        self._on_status = on_status
        self._on_lost = on_lost
        #: Set while no robot is there.
        self._gone = asyncio.Event()
        self.status = DaemonStatus()
        self._has_media = True
        self._pose: dict[str, float] = {}
        #: Poses of the last moments with the loop time at which each came.
        self._poses: deque[tuple[float, Pose]] = deque(maxlen=32)
        self._complete = asyncio.Event()

    @property
    def pose(self) -> Pose:
        """Where the joints are, by the newest message."""
        return dict(self._pose)

    @property
    def tells_poses(self) -> bool:
        """Whether the newest pose is of this moment."""
        now = asyncio.get_running_loop().time()
        return bool(self._poses) and now - self._poses[-1][0] <= RECENT_S

    def _lost(self, error: DeviceLostError) -> None:
        self._gone.set()
        self._on_lost(error)

    async def _get_ready(self) -> str:
        self._gone.clear()
        self._pose.clear()
        self._poses.clear()
        self._complete.clear()
        status = await self.ask("GET", "daemon/status")
        if not isinstance(status, dict) or status.get("type") != "daemon_status":
            raise DriverError(
                f"{self._settings.address} is no daemon of a Reachy Mini, or a very old one",
                "check the address; update the robot: docs/how-to/reachy-mini.md",
            )
        self._has_media = await self._ask_media()
        self._take_status(status)
        self._need_running()
        try:
            async with asyncio.timeout(2.0):
                await self._complete.wait()
        except TimeoutError:
            raise DriverError("the daemon tells no pose of the robot", _REMEDY) from None
        await self._prepare()
        simulated = ", simulated" if self.status.simulated else ""
        return f"{self.status.name}, daemon {self.status.version}{simulated}"

    def _need_running(self) -> None:
        if self.status.state != "running":
            raise DeviceLostError(
                f"the daemon does not run the robot: {self.status.error or self.status.state}",
                "start the robot in the vendor's app, or: POST /api/daemon/start?wake_up=true",
            )

    # -- what it says ----------------------------------------------------------------------------

    def _take(self, message: Any) -> None:
        """A message of the WebSocket. Raises `ValueError` for what makes no sense."""
        match message:
            case {"type": "head_pose", "head_pose": list(matrix)}:
                self._pose |= head_from_matrix(matrix)
            case {
                "type": "joint_positions",
                "head_joint_positions": list(head),
                "antennas_joint_positions": list(antennas),
            }:
                self._pose |= body_from_joints(head, antennas)
            case {"type": "daemon_status"}:
                self._take_status(message)
                try:
                    self._need_running()
                except DeviceLostError as error:
                    self._line.lose(error)
                else:
                    self._on_status()
                return
            case {"type": str()}:
                return
            case _:
                raise ValueError("a message without a type")
        if len(self._pose) == len(LIMITS):
            self._poses.append((asyncio.get_running_loop().time(), dict(self._pose)))
            self._complete.set()

    def _take_status(self, message: Mapping[str, Any]) -> None:
        status = read_status(message)
        self.status = replace(status, silent=status.silent or not self._has_media)

    async def _ask_media(self) -> bool:
        """Whether it has sound: one that could not start its media says so nowhere else."""
        try:
            status = await self.ask("GET", "media/status")
        except AnswerError:
            return True  # an old one
        return (
            not isinstance(status, dict)
            or bool(status.get("available", True))
            or bool(status.get("released"))
        )

    def still_since(self, began: float) -> bool:
        """Whether poses that came after `began`, in loop time, say that nothing moves."""
        now = asyncio.get_running_loop().time()
        if now - began < STILL_S:
            return False
        poses = [pose for at, pose in self._poses if at >= now - STILL_S]
        return len(poses) >= STILL_POSES and all(
            max(pose[name] for pose in poses) - min(pose[name] for pose in poses) <= STILL_BY
            for name in LIMITS
        )

    async def pause(self, seconds: float) -> None:
        """Wait so long, in seconds of the robot. Raises `DeviceLostError` as soon as it is lost."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds / self._settings.pace):
                await self._gone.wait()
            self._line.need()

    # -- what it is asked ------------------------------------------------------------------------

    async def ask(
        self, method: str, path: str, *, json: Any = None, data: Any = None, within: float = 2.0
    ) -> Any:
        """The answer to a request below `/api`, which does no harm when it is carried out twice.

        The daemon hangs up after an error of its own, which the next request over that connection
        finds out: it is then made once more.

        Raises:
            DeviceLostError: The daemon is not connected, or was lost meanwhile.
            DriverError: It refused, did not answer in time, or answered nonsense.
        """
        url = f"/api/{path}"
        try:
            return await self._line.request(method, url, json=json, data=data, within=within)
        except DriverError as error:
            if not _hung_up(error):
                raise
        return await self._line.request(method, url, json=json, data=data, within=within)

    async def setpoint(self, pose: Pose) -> None:
        """Send a pose to be taken now. Raises `DeviceLostError`."""
        await self._line.send(target_message(pose))

    async def goto(self, pose: Pose, seconds: float) -> str:
        """Begin a move; its uuid."""
        return await self._begun("move/goto", goto_body(pose, seconds))

    async def play(self, name: str) -> str:
        """Begin a move that the daemon has: `wake_up`, `goto_sleep`, or a recorded one as
        `recorded-move-dataset/OWNER/DATA-SET/NAME`; its uuid.
        """
        return await self._begun(f"move/play/{name}", None, LIST_S)

    async def _begun(self, path: str, body: Any, within: float = 2.0) -> str:
        """Begin a move. Where the daemon hung up nobody knows whether it has: every move is ended
        before it is begun once more.
        """
        url = f"/api/{path}"
        try:
            answer = await self._line.request("POST", url, json=body, within=within)
        except DriverError as error:
            if not _hung_up(error):
                raise
            await self.end_running()
            answer = await self._line.request("POST", url, json=body, within=within)
        match answer:
            case {"uuid": str(uuid)}:
                return uuid
        raise DriverError(f"the daemon began no move, but answered {path} otherwise", _REMEDY)

    async def running(self) -> list[str]:
        """The uuids of all moves under way, whoever began them."""
        answer = await self.ask("GET", "move/running", within=QUICK_S)
        match answer:
            case list():
                return [one["uuid"] for one in answer if isinstance(one, dict) and "uuid" in one]
        raise DriverError("the daemon does not say which moves run", _REMEDY)

    async def end(self, uuid: str) -> None:
        """End a move; one that has ended meanwhile is answered with an error, which counts not."""
        try:
            await self.ask("POST", "move/stop", json={"uuid": uuid}, within=QUICK_S)
        except AnswerError as error:
            if error.status < 500:
                raise

    async def end_running(self) -> None:
        """End the moves that are under way now, whoever began them."""
        for uuid in await self.running():
            await self.end(uuid)

    async def end_any(self) -> None:
        """Have every move end at its next step, also one within another; without an answer."""
        await self._line.send({"type": "stop_move"})

    async def set_motors(self, mode: str) -> None:
        """enabled, disabled or gravity_compensation."""
        await self.ask("POST", f"motors/set_mode/{mode}")
        self.status = replace(self.status, motors=mode)

    async def send_volume(self, percent: int) -> None:
        """Set the loudspeaker's volume; unlike the request of that name it plays no sound."""
        await self._line.send({"type": "set_volume", "volume": percent})

    async def hold_media(self, held: bool) -> None:
        """Have the daemon take camera and microphones, or let go of them for other programs.

        Raises `DriverError` if it does not. A daemon that never had them has let go of them.
        """
        try:
            await self.ask("POST", f"media/{'acquire' if held else 'release'}", within=MEDIA_S)
            status = await self.ask("GET", "media/status")
        except AnswerError as error:
            if error.status not in (404, 405):
                raise
            raise DriverError(
                "the daemon is too old to let go of its camera and microphones",
                "update the robot, or start its daemon with --no-media",
            ) from None
        otherwise = "released" if held else "available"
        if not isinstance(status, dict) or status.get(otherwise) is not False:
            raise DriverError(
                f"the daemon {'has not taken' if held else 'keeps'} its camera and microphones",
                _REMEDY,
            )
        self.status = replace(self.status, released=status.get("released") is True)

    async def installed(self) -> dict[str, list[str]]:
        """The recorded moves of each library of which the daemon tells, by our name of the library;
        none, where it has not got it.
        """
        found = {}
        for library, data_set in LIBRARIES.items():
            try:
                moves = await self.ask(
                    "GET", f"move/recorded-move-datasets/list/{data_set}", within=LIST_S
                )
            except AnswerError:
                moves = []
            except DeviceLostError:
                raise
            except DriverError:
                continue  # nobody knows
            if isinstance(moves, list):
                found[library] = sorted(str(move) for move in moves)
        return found


class ReachyPart(RobotPart[DaemonLink, ReachyMiniSettings]):
    """One part of a Reachy Mini: its verbs, its settings, its share of the stop."""


def _hung_up(error: DriverError) -> bool:
    """Whether a request found its connection closed, while the robot itself is there."""
    cause = error.__cause__
    return not isinstance(error, DeviceLostError) and isinstance(
        cause, aiohttp.ClientConnectionError | ConnectionError
    )


def read_status(status: Mapping[str, Any]) -> DaemonStatus:
    """What a `daemon_status` says; what is missing or of another type is left empty."""
    backend = status.get("backend_status")
    backend = backend if isinstance(backend, dict) else {}

    def text(value: Any) -> str:
        return value if isinstance(value, str) else ""

    return DaemonStatus(
        name=text(status.get("robot_name")) or "Reachy Mini",
        version=text(status.get("version")) or "of unknown version",
        state=text(status.get("state")),
        motors=text(backend.get("motor_control_mode")),
        simulated=any(
            status.get(name) is True for name in ("simulation_enabled", "mockup_sim_enabled")
        ),
        silent=status.get("no_media") is True,
        released=status.get("media_released") is True,
        error=text(status.get("error")) or text(backend.get("error")),
    )
