"""Draws the console with simulated robots: `python -m tools.robot_pictures [folder [robot ...]]`.

Real sessions, played in real time: a robot process, a robot behind the real protocol, a wizard
who sends what keys would send. What a console is told that attaches at a moment is drawn. The
visitor moves on, so no two pictures are the same.
"""

from __future__ import annotations

import asyncio
import functools
import json
import socket
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from tests.console.scripted_feed import ScriptedFeed
from tools import EXPERIMENTS, IMAGES
from tools.screenshots import Shot, shoot
from woz_tui.console.link.host_start import Launch
from woz_tui.protocol.requests import Welcome

#: Seconds from the beginning, and what the wizard asks for then.
Course = Sequence[tuple[float, dict[str, Any]]]


@dataclass(frozen=True)
class RobotPictures:
    """A session and the pictures of its `moment`: name, columns, rows, keys pressed before."""

    experiment: str
    options: tuple[str, ...]
    course: Course
    moment: float
    shots: tuple[tuple[str, int, int, tuple[str, ...]], ...]


def _pressed(at: float, action: str) -> tuple[float, dict[str, Any]]:
    return at, {"kind": "action", "action": action}


PEPPER: Course = (
    (5.0, {"kind": "script", "play": True}),  # wake up, once it is connected
    (8.0, {"kind": "script", "play": True}),
    _pressed(9.8, "Green"),
    (10.0, {"kind": "script", "play": True}),
    (15.0, {"kind": "script", "play": True}),
    (15.2, {"kind": "verb", "verb": "naoqi",
            "args": {"call": "ALBasicAwareness.setEnabled", "args": "[true]"}}),
    _pressed(17.5, "Think"),
    (18.2, {"kind": "script", "play": True}),
)  # fmt: skip
#: The museum guide on any robot.
GUIDE: Course = (
    _pressed(8.0, "Hello"),
    _pressed(11.0, "Happy"),
    _pressed(12.0, "Quiz"),
    _pressed(15.0, "Exhibit"),
)
FIVE: Course = (
    _pressed(8.0, "Awake"),
    _pressed(12.0, "Chorus"),
    _pressed(14.0, "Look left"),
    _pressed(14.5, "Furhat smiles"),
    _pressed(14.8, "Drive on"),
    _pressed(15.0, "ROS drives"),
    _pressed(15.2, "Count"),
)
_WHO = ("--participant", "P01", "--condition")
PICTURES = {
    "pepper": RobotPictures(
        *("pepper.yaml", (*_WHO, "lively"), PEPPER, 20.0),
        (("pepper-160x50", 160, 50, ()), ("pepper-80x24", 80, 24, ()), ("robot", 100, 36, ("@",))),
    ),
    **{
        name: RobotPictures(
            *("demo.yaml", (*_WHO, "warm", "--robot", robot), GUIDE, 16.5),
            ((name, 100, 36, ()),),
        )
        for name, robot in (
            *(("nao", "nao"), ("reachy-mini", "reachy-mini"), ("furhat", "furhat")),
            ("ros", "turtlebot"),
        )
    },
    "all": RobotPictures(
        *("all-robots.yaml", ("--participant", "G1"), FIVE, 17.0), (("all-robots", 80, 24, ()),)
    ),
}


def told(wanted: RobotPictures) -> Welcome:
    """What a console is told that attaches at the moment."""
    with tempfile.TemporaryDirectory() as folder:
        launch = Launch([str(EXPERIMENTS / wanted.experiment), *wanted.options,
                         "--recordings", folder, "--name", "robot-pictures"])  # fmt: skip
        try:
            return _played(launch.wait().socket, wanted)
        finally:
            launch.abandon()


def _played(path: Path, wanted: RobotPictures) -> Welcome:
    begun = time.monotonic()
    wizard = _connected(path)
    for at, request in wanted.course:
        while (left := begun + at - time.monotonic()) > 0:
            _say(wizard, {"kind": "beat"})
            time.sleep(min(left, 0.5))
        source = {} if request["kind"] == "script" else {"source": "key"}
        _say(wizard, {**source, **request})
    while time.monotonic() < begun + wanted.moment:
        _say(wizard, {"kind": "beat"})
        time.sleep(0.25)
    watcher = _connected(path, role="watcher")
    with watcher.makefile("rb") as lines:
        return msgspec.json.decode(lines.readline(), type=Welcome)


def _connected(path: Path, role: str = "wizard") -> socket.socket:
    client = socket.socket(socket.AF_UNIX)
    client.connect(str(path))
    _say(client, {"kind": "hello", "role": role, "stream": "nothing"})
    return client


def _say(client: socket.socket, request: dict[str, Any]) -> None:
    client.sendall(json.dumps(request).encode() + b"\n")


def main() -> None:
    """Play each once, draw its pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES
    folder.mkdir(parents=True, exist_ok=True)
    for robot in sys.argv[2:] or PICTURES:
        first = msgspec.structs.replace(
            told(PICTURES[robot]), role="wizard", log="recordings/S01.jsonl"
        )
        for name, width, height, keys in PICTURES[robot].shots:
            shot = Shot(name, width, height, functools.partial(_fed, first), keys=keys)
            asyncio.run(shoot(shot, shot.feed(), folder))


def _fed(first: Welcome) -> ScriptedFeed:
    feed = ScriptedFeed()
    feed.round_trip_us = 23_000
    feed.begin_with(first)
    return feed


if __name__ == "__main__":
    main()
