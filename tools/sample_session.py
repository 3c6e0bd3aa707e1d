"""A minute of the demo, played by a wizard's program, in real time: the sample in recordings/.

`python -m tools.sample_session` records it anew: a real robot process with its simulated robot and
visitor, a real socket, a real log.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tools import EXPERIMENTS, ROOT

SAMPLE = ROOT / "recordings" / "sample.jsonl"
DEMO = EXPERIMENTS / "demo.yaml"
#: How long the robot process may take to begin, and to end, in seconds.
BEGINS_S, ENDS_S = 20.0, 30.0

#: Seconds from the beginning, and what the wizard asks for then.
COURSE: tuple[tuple[float, dict[str, Any]], ...] = (
    (3.0, {"kind": "action", "action": "Trial begins", "source": "key", "key": "f8"}),
    (5.0, {"kind": "action", "action": "Hello", "source": "key", "key": "h"}),
    (6.5, {"kind": "action", "action": "Happy", "source": "key", "key": "f2"}),
    (10.0, {"kind": "action", "action": "Welcome", "source": "key", "key": "w"}),
    (14.0, {"kind": "action", "action": "Map", "source": "key", "key": "m"}),
    (17.0, {"kind": "marker", "text": "looks at the map"}),
    (22.0, {"kind": "action", "action": "Exhibit", "source": "key", "key": "x"}),
    (26.0, {"kind": "verb", "verb": "gaze", "args": {"yaw": 15, "pitch": 0}, "source": "key"}),
    (29.0, {"kind": "action", "action": "Quiz", "source": "key", "key": "q"}),
    (33.0, {"kind": "action", "action": "No", "source": "key", "key": "n"}),
    (34.0, {"kind": "mistake", "text": "yes was meant"}),
    (35.0, {"kind": "action", "action": "Yes", "source": "key", "key": "y"}),
    (38.0, {"kind": "action", "action": "Never heard of", "source": "program"}),
    (40.0, {"kind": "action", "action": "Dance", "source": "key", "key": "!"}),
    (41.2, {"kind": "stop", "source": "key"}),
    (42.5, {"kind": "action", "action": "Nod", "source": "key", "key": "1"}),
    (44.0, {"kind": "release", "source": "key"}),
    (45.0, {"kind": "note", "text": "stopped the dance: a child came too near"}),
    (47.0, {"kind": "action", "action": "Whale song", "source": "key", "key": "c 1"}),
    (52.0, {"kind": "verb", "verb": "say", "args": {"text": "Do come again!"}, "source": "key"}),
    (55.0, {"kind": "action", "action": "Bye", "source": "key", "key": "b"}),
    (60.0, {"kind": "end", "reason": "wizard"}),
)


def main() -> int:
    """Record the sample anew."""
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent)
        log = record(folder)
        for path in sorted(log.parent.glob(f"{log.stem}*.jsonl")):
            name = path.name.replace(log.stem, SAMPLE.stem, 1)
            shutil.copyfile(path, SAMPLE.with_name(name))
            sys.stdout.write(f"{name}: {path.stat().st_size // 1024} KiB\n")
    return 0


def record(folder: Path) -> Path:
    """Play the course in a robot process of its own; its log in `folder`."""
    command = [sys.executable, "-m", "woz_tui", "host", str(DEMO)]
    command += ["--session", "S01", "--participant", "P01", "--condition", "warm"]
    command += ["--wizard", "W1", "--seed", "7", "--name", folder.name, "--announce"]
    process = subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, "HOME": str(folder)},  # so that no path of this machine gets into it
        stdout=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
    )
    try:
        assert process.stdout is not None
        said = json.loads(process.stdout.readline())
        _play(Path(said["socket"]))
        process.wait(ENDS_S)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
    return folder / str(said["log"])


def _play(path: Path) -> None:
    """Be the wizard: say hello, ask for what the course has, and keep the line alive."""
    with socket.socket(socket.AF_UNIX) as line:
        line.settimeout(BEGINS_S)
        line.connect(str(path))
        _say(line, {"kind": "hello", "ref": 1, "role": "wizard", "stream": "nothing"})
        began = time.monotonic()
        for ref, (due, ask) in enumerate(_with_beats(), 2):
            time.sleep(max(0.0, began + due - time.monotonic()))
            _say(line, {**ask, "ref": ref})


def _with_beats() -> Iterator[tuple[float, dict[str, Any]]]:
    """The course, with a beat every half second as a console sends it."""
    last = COURSE[-1][0]
    beats = [(number / 2, {"kind": "beat"}) for number in range(1, round(2 * last))]
    return iter(sorted([*COURSE, *beats], key=lambda entry: entry[0]))


def _say(line: socket.socket, request: dict[str, Any]) -> None:
    line.sendall(json.dumps(request).encode() + b"\n")


if __name__ == "__main__":
    sys.exit(main())
