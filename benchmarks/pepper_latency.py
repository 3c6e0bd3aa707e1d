"""From an action that is sent to the method entered in the robot.

    python benchmarks/pepper_latency.py [--calls 400] [--quick]

The simulated Pepper runs in a process of its own and notes when `ALTextToSpeech.setVolume` is
entered. In turns, with a pause drawn at random between them, it is called by

* a bare call of the package `qi`: the floor;
* a Flask route that makes the same call, over a connection that stays open: what a browser's
  button costs;
* `woz host`: the action's line written to its socket, until the method is entered. It is recorded
  in the log before it is sent.

Where the package `qi` has no wheels there is no goal.

Once with nothing else going on, once while states are read: the Flask program reads eight states
once a second, the robot process all of its settings, and five times a second its senses.
"""

from __future__ import annotations

import argparse
import contextlib
import http.client
import importlib.util
import itertools
import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

os.environ["QI_LOG_LEVEL"] = "0"

from benchmarks.figures import Spread, machine, table, verdict
from woz_tui.console.link.host_start import Launch

PROGRAMS = Path(__file__).parent / "programs"
#: Seconds between two calls.
GAPS_S = (0.005, 0.03)
SETTLE_S = 1.5
#: A volume that comes too late is sent so often in all, with so many seconds between.
MOST_LATE, LOST_S = 10, 1.0
QI = importlib.util.find_spec("qi") is not None
#: Polls of the Flask program a second, where states are read.
POLLS = 1.0
_FILE = """\
title: Latency
robot:
  drivers:
    pepper:
      type: pepper
      robots: ["{address}"]
      senses: {senses}
panels:
  - title: Voice
    actions: [{{key: v, label: Volume, volume: 0.5}}]
"""
#: What the robot is asked to sense while nothing else is to go on, and otherwise.
_QUIET = "{rate: 1, sonar: false, people: false, loudness: false, touch: false}"
_SENSES = "{rate: 5}"

#: Sends one volume, returns when it was sent in nanoseconds of CLOCK_MONOTONIC.
Sender = Callable[[float], int]


class Robot:
    """A simulated Pepper in a process of its own, told what to do by its standard input."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self.address: str = self._said()["address"]

    def trace(self) -> dict[str, int]:
        """When each volume arrived, by its six decimals."""
        assert self._process.stdin is not None
        self._process.stdin.write('{"do": "trace"}\n')
        self._process.stdin.flush()
        return {
            f"{json.loads(args)[0]:.6f}": entered
            for service, method, args, entered in self._said()["ok"]
            if (service, method) == ("ALTextToSpeech", "setVolume")
        }

    def _said(self) -> Any:
        assert self._process.stdout is not None
        return json.loads(self._process.stdout.readline())


@contextlib.contextmanager
def robot() -> Iterator[Robot]:
    """One that listens."""
    process = subprocess.Popen(
        [sys.executable, "-m", "naoqi_simulator", "--port", "0", "--control"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        yield Robot(process)
    finally:
        process.kill()
        process.communicate()


def session(address: str) -> Any:
    """A bare session of the package `qi`."""
    import qi  # noqa: PLC0415 - after the variable that keeps it silent

    made = qi.Session()
    made.connect(address)
    return made


def bare(address: str) -> Sender:
    """The floor."""
    opened = session(address)  # kept: its services end with it
    speech = opened.service("ALTextToSpeech")

    def send(value: float) -> int:
        if not opened.isConnected():
            raise RuntimeError("the robot is gone")
        sent = time.monotonic_ns()
        speech.setVolume(value)
        return sent

    return send


@contextlib.contextmanager
def route(address: str, polls: float) -> Iterator[Sender]:
    """A Flask route in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, str(PROGRAMS / "flask_route.py"), address, str(polls)],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    line = http.client.HTTPConnection("127.0.0.1", int(process.stdout.readline()))
    line.connect()
    assert line.sock is not None
    line.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def send(value: float) -> int:
        sent = time.monotonic_ns()
        line.request("POST", f"/volume/{value:.6f}")
        if (answer := line.getresponse().read()) != b"ok":
            raise RuntimeError(f"the route said {answer!r}")
        return sent

    try:
        yield send
    finally:
        line.close()
        process.kill()
        process.communicate()


class FailedError(RuntimeError):
    """A command has failed."""


class Wizard:
    """A wizard's console without a screen."""

    def __init__(self, path: Path) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(str(path))
        self._lines = self._socket.makefile("r", encoding="utf-8")
        self.ask(kind="hello", role="program", stream="actions")
        # What is sent before the robot is connected fails.
        connected = {"kind": "driver.connected", "driver": "pepper"}.items()
        if not any(connected <= line.items() for line in self.until("welcome")["state"]):
            self.until("driver.connected", driver="pepper")

    def ask(self, **request: Any) -> int:
        """Send one line; when it was sent."""
        sent = time.monotonic_ns()
        self._socket.sendall(json.dumps(request).encode() + b"\n")
        return sent

    def until(self, kind: str, **fields: Any) -> dict[str, Any]:
        """The next message of a kind, with these fields. Raises `FailedError` once a command has
        failed.
        """
        for line in self._lines:
            message: dict[str, Any] = json.loads(line)
            if message["kind"] == kind and fields.items() <= message.items():
                return message
            if message["kind"] == "command.failed":
                raise FailedError(message["reason"])
        raise RuntimeError(f"the robot process ended before it said {kind}")

    def volume(self, value: float) -> int:
        """Send one volume and wait until its command has ended; when it was sent. What failed
        because the robot was late is sent again.
        """
        for left in reversed(range(MOST_LATE)):
            sent = self.ask(kind="verb", verb="volume", args={"level": value})
            try:
                self.until("command.done")
            except FailedError:
                if not left:
                    raise
                time.sleep(LOST_S)
            else:
                break
        return sent


@contextlib.contextmanager
def console(address: str, senses: str, settle_s: float) -> Iterator[Sender]:
    """A robot process."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "latency.yaml"
        file.write_text(_FILE.format(address=address, senses=senses))
        launch = Launch([str(file), "--recordings", str(Path(folder) / "log"),
                         "--name", f"latency-{os.getpid()}"])  # fmt: skip
        try:
            wizard = Wizard(launch.wait().socket)
            time.sleep(settle_s)
            yield wizard.volume
        finally:
            launch.abandon()


@dataclass(frozen=True)
class Measured:
    """One road in one scene; milliseconds."""

    name: str
    took: Spread
    lost: int


@contextlib.contextmanager
def roads(address: str, polling: bool, settle_s: float) -> Iterator[dict[str, Sender]]:
    """All roads to one robot, by name."""
    senses, polls = (_SENSES, POLLS) if polling else (_QUIET, 0.0)
    with contextlib.ExitStack() as opened:
        made: dict[str, Sender] = {}
        if QI:
            made["bare qi"] = bare(address)
            made["Flask route"] = opened.enter_context(route(address, polls))
        made["woz"] = opened.enter_context(console(address, senses, settle_s))
        yield made


def scene(polling: bool, calls: int, settle_s: float) -> list[Measured]:
    """All roads in turns."""
    with robot() as pepper, roads(pepper.address, polling, settle_s) as ways:
        sent: dict[str, dict[str, int]] = {name: {} for name in ways}
        values = itertools.count(1)
        draw = random.Random(5)
        for _ in range(calls):
            for name, send in ways.items():
                value = next(values) / 100_000
                sent[name][f"{value:.6f}"] = send(value)
                time.sleep(draw.uniform(*GAPS_S))
        entered = pepper.trace()
    return [_measured(name, times, entered) for name, times in sent.items()]


def _measured(name: str, sent: dict[str, int], entered: dict[str, int]) -> Measured:
    took = [(entered[value] - at) / 1e6 for value, at in sent.items() if value in entered]
    return Measured(name, Spread.of(took), len(sent) - len(took))


def tell(name: str, measured: list[Measured]) -> list[list[str]]:
    """The lines of one scene."""
    flask = next((one.took for one in measured if one.name.startswith("Flask")), None)
    lines = []
    for one in measured:
        goals = ["", ""]
        if flask is not None and one.name.startswith("woz"):
            p50, p99 = one.took.over(flask)
            goals = [f"{p50:.2f} x  {verdict(p50, 1)}", f"{p99:.2f} x  {verdict(p99, 1)}"]
        lines.append(
            [f"{name}: {one.name}", str(one.took.count), f"{one.took.p50:.2f}",
             f"{one.took.p99:.2f}", f"{one.took.worst:.1f}", *goals, str(one.lost)]
        )  # fmt: skip
    return lines


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--calls", type=int, default=400, help="on each road, in each scene")
    parser.add_argument("--quick", action="store_true", help="a few calls")
    arguments = parser.parse_args()
    calls, settle_s = (3, 0.1) if arguments.quick else (arguments.calls, SETTLE_S)
    table(
        "Action sent to method entered, ms (goal: below the Flask route, at p50 and p99)",
        ("", "calls", "p50", "p99", "worst", "p50 / Flask", "p99 / Flask", "lost"),
        [
            line
            for name, polling in (("idle", False), ("polling", True))
            for line in tell(name, scene(polling, calls, settle_s))
        ],
    )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # libqi's threads end in an abort now and then, when the process does
