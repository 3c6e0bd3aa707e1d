"""Draws the console with a simulated Pepper: `python -m tools.pepper_pictures [folder]`.

A real session, played in real time: a robot process, a robot behind NAOqi's protocol, a wizard who
sends what keys would send. What a console is told that attaches after twenty seconds is drawn. The
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
from pathlib import Path
from typing import Any

import msgspec

from tests.console.scripted import ScriptedFeed
from tools import EXPERIMENTS, IMAGES
from tools.screenshots import Shot, shoot
from woz_tui.cli.host_start import Launch
from woz_tui.protocol.requests import Welcome

EXPERIMENT = EXPERIMENTS / "pepper.yaml"
#: Seconds from the beginning, and what the wizard asks for then.
COURSE: tuple[tuple[float, dict[str, Any]], ...] = (
    (5.0, {"kind": "script", "play": True}),  # wake up, once it is connected
    (8.0, {"kind": "script", "play": True}),
    (9.8, {"kind": "action", "action": "Green"}),
    (10.0, {"kind": "script", "play": True}),
    (15.0, {"kind": "script", "play": True}),
    (15.2, {"kind": "verb", "verb": "naoqi",
            "args": {"call": "ALBasicAwareness.setEnabled", "args": "[true]"}}),
    (17.5, {"kind": "action", "action": "Think"}),
    (18.2, {"kind": "script", "play": True}),
)  # fmt: skip
MOMENT = 20.0
SHOTS = (("pepper-160x50", 160, 50, ()), ("pepper-80x24", 80, 24, ()), ("robot", 100, 36, ("@",)))


def told() -> Welcome:
    """What a console is told that attaches at the moment."""
    with tempfile.TemporaryDirectory() as folder:
        launch = Launch([str(EXPERIMENT), "--participant", "P01", "--condition", "lively",
                         "--recordings", folder, "--name", "pepper-pictures"])  # fmt: skip
        try:
            return _played(launch.wait().socket)
        finally:
            launch.abandon()


def _played(path: Path) -> Welcome:
    begun = time.monotonic()
    wizard = _connected(path)
    for at, request in COURSE:
        while (left := begun + at - time.monotonic()) > 0:
            _say(wizard, {"kind": "beat"})
            time.sleep(min(left, 0.5))
        source = {} if request["kind"] == "script" else {"source": "key"}
        _say(wizard, {**source, **request})
    while time.monotonic() < begun + MOMENT:
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
    """Play once, draw all."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES
    folder.mkdir(parents=True, exist_ok=True)
    first = msgspec.structs.replace(told(), role="wizard", log="recordings/S01.jsonl")
    for name, width, height, keys in SHOTS:
        shot = Shot(name, width, height, functools.partial(_fed, first), keys=keys)
        asyncio.run(shoot(shot, shot.feed(), folder))


def _fed(first: Welcome) -> ScriptedFeed:
    feed = ScriptedFeed()
    feed.round_trip_us = 23_000
    feed.begin_with(first)
    return feed


if __name__ == "__main__":
    main()
