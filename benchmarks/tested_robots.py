"""Simulated robots in processes of their own, and the call by which each is measured.

Every call has a number in its arguments, so that it is known again at the robot: a volume, a
colour, an angle.
"""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import aiohttp
from qimessaging import NaoqiClient

TIMED = Path(__file__).parent / "programs" / "timed_robot.py"
#: Makes the call with this number.
Send = Callable[[int], Awaitable[object]]


@dataclass(frozen=True)
class TestedRobot:
    """A robot and one quick call of it.

    Attributes:
        name: Its driver's type.
        simulator: The command that starts it, a port behind it; None: free.
        settings: Of the driver, for an address.
        verb: What is called; `args` gives its arguments for a number.
        number: The number of a call that the robot has taken; None: it is another one.
        client: A bare client that makes the same call.
        long: A command that goes on for a minute or more.
        unique: Whether no number comes again, so that a late call is known.
    """

    name: str
    simulator: tuple[str, ...]
    settings: Callable[[str], dict[str, Any]]
    verb: str
    args: Callable[[int], dict[str, Any]]
    number: Callable[[list[Any]], int | None]
    client: Callable[[str], AbstractAsyncContextManager[Send]]
    long: tuple[str, Mapping[str, Any]] = ("say", {"text": "word " * 2000})
    unique: bool = True


class SimulatorProcess:
    """One that runs; `address` as its driver wants it."""

    def __init__(self, robot: TestedRobot, port: int = 0) -> None:
        self._robot = robot
        naoqi = "naoqi_simulator" in robot.simulator
        words = ["--port", str(port)] if naoqi else [str(port)]
        self._process = subprocess.Popen(
            [sys.executable, *robot.simulator, *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._naoqi = naoqi
        self.address: str = self._line()["address"]
        self.port = int(self.address.rpartition(":")[2])

    def taken(self) -> list[tuple[int, int]]:
        """The numbered calls so far: number, and when it was taken (CLOCK_MONOTONIC, ns)."""
        assert self._process.stdin is not None
        self._process.stdin.write('{"do": "trace"}\n')
        self._process.stdin.flush()
        told = self._line()
        calls = [
            (self._robot.number(call), at) for *call, at in (told["ok"] if self._naoqi else told)
        ]
        return [(number, at) for number, at in calls if number is not None]

    def send_signal(self, number: signal.Signals) -> None:
        """Freeze it (SIGSTOP), let it go on (SIGCONT)."""
        self._process.send_signal(number)

    def kill(self) -> None:
        """End it without a word."""
        self._process.kill()
        self._process.communicate()

    def _line(self) -> Any:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"the simulated {self._robot.name} has ended")
        return json.loads(line)


@contextlib.contextmanager
def simulated(robot: TestedRobot) -> Iterator[SimulatorProcess]:
    """A process that is gone afterwards."""
    process = SimulatorProcess(robot)
    try:
        yield process
    finally:
        process.kill()


# -- one robot after the other ---------------------------------------------------------------------


def naoqi(name: str, settings: Callable[[str], dict[str, Any]], *options: str) -> TestedRobot:
    """A robot with NAOqi: its volume."""

    @contextlib.asynccontextmanager
    async def client(address: str) -> AsyncIterator[Send]:
        host, _, port = address.rpartition("/")[2].rpartition(":")
        opened = await NaoqiClient.open(host, int(port))
        try:
            yield lambda number: opened.call(
                "ALTextToSpeech", "setVolume", number / 1_000_000, within=2
            )
        finally:
            await opened.close()

    def number(call: list[Any]) -> int | None:
        service, method, args = call
        if (service, method) != ("ALTextToSpeech", "setVolume"):
            return None
        return round(float(json.loads(args)[0]) * 1_000_000)

    return TestedRobot(
        name,
        ("-m", "naoqi_simulator", "--control", *options),
        settings,
        "volume",
        lambda number: {"level": number / 1_000_000},
        number,
        client,
    )


def over_web_socket(
    path: str, message: Callable[[int], Mapping[str, Any]]
) -> Callable[[str], AbstractAsyncContextManager[Send]]:
    """A bare client that sends `message(number)` over one WebSocket."""

    @contextlib.asynccontextmanager
    async def client(address: str) -> AsyncIterator[Send]:
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(f"ws://{address}{path}") as opened,
        ):
            yield lambda number: opened.send_json(message(number))

    return client


def furhat() -> TestedRobot:
    """The colour of its ring."""

    def number(call: list[Any]) -> int | None:
        name, args = call
        return int(args["color"][1:], 16) if name == "request.led.set" else None

    return TestedRobot(
        "furhat",
        (str(TIMED), "robot_simulators.furhat:FurhatSimulator"),
        lambda address: {"address": address},
        "eyes",
        lambda number: {"color": f"#{number:06x}"},
        number,
        over_web_socket(
            "/v1/events", lambda number: {"type": "request.led.set", "color": f"#{number:06x}"}
        ),
    )


def reachy_mini() -> TestedRobot:
    """Its volume, in per cent: its numbers come again."""

    def number(call: list[Any]) -> int | None:
        name, percent = call
        return int(percent) if name == "set_volume" else None

    return TestedRobot(
        "reachy-mini",
        (str(TIMED), "robot_simulators.reachy_mini:ReachyMiniSimulator"),
        lambda address: {"address": address},
        "volume",
        lambda number: {"level": number % 100 / 100},
        number,
        over_web_socket("/ws/sdk", lambda number: {"type": "set_volume", "volume": number}),
        long=("pose", {"joints": {"pan": 30.0}, "seconds": 60.0}),
        unique=False,
    )


def ros() -> TestedRobot:
    """The turning of its base."""
    topic, kind = "/cmd_vel", "geometry_msgs/Twist"
    verbs = {
        "turning": {
            "publish": topic,
            "type": kind,
            "message": {"angular": {"z": "{speed}"}},
            "arguments": {"speed": {"kind": "number"}},
        },
        "say": {
            "publish": "/tts",
            "type": "std_msgs/String",
            "message": {"data": "{text}"},
            "ends": {"subscribe": "/tts/speaking", "begun": True, "ended": False},
            "within": 600,
        },
    }

    def number(call: list[Any]) -> int | None:
        name, message = call
        if name != "publish" or message["topic"] != topic:
            return None
        return round(float(message["msg"]["angular"]["z"]) * 1_000_000)

    def published(number: int) -> dict[str, Any]:
        speed = {"angular": {"z": number / 1_000_000}}
        return {"op": "publish", "topic": topic, "msg": speed}

    @contextlib.asynccontextmanager
    async def client(address: str) -> AsyncIterator[Send]:
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(f"ws://{address}/") as opened,
        ):
            await opened.send_json({"op": "advertise", "topic": topic, "type": kind})
            yield lambda number: opened.send_json(published(number))

    return TestedRobot(
        "ros",
        (str(TIMED), "robot_simulators.rosbridge:RosbridgeSimulator"),
        lambda address: {"address": address, "verbs": verbs},
        "turning",
        lambda number: {"speed": number / 1_000_000},
        number,
        client,
    )


QUIET = {"rate": 1, "sonar": False, "people": False, "loudness": False, "touch": False}
ROBOTS = (
    naoqi("pepper", lambda address: {"robots": [address], "senses": QUIET}),
    naoqi("nao", lambda address: {"address": address}, "--robot", "nao"),
    reachy_mini(),
    furhat(),
    ros(),
)
