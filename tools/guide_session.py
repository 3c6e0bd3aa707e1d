"""The guide alone with its visitors, twice: does the same happen?

`python -m tools.guide_session [minutes]` plays experiments/guide.yaml in two robot processes side
by side, without a console, and compares the states that each log has; ten minutes by default.
`played` gives a session in virtual time, at once.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from tests.fakes.virtual_time import run_virtual
from tests.session.rig import SessionRig
from tools import EXPERIMENTS
from tools.demo_session import catalogue
from woz_tui.config.loading import load
from woz_tui.log import log_reader
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session

GUIDE = EXPERIMENTS / "guide.yaml"
MINUTES = 10.0
#: When a robot process that has not begun is noticed, and how long it may take to end, in seconds.
BEGINS_S, ENDS_S = 5.0, 30.0
#: Where a robot process says what went wrong.
ERRORS = "errors.txt"
#: Where its log goes on if the disk hangs.
SPILL = "more"


def played(
    folder: Path, seconds: float, hand: Callable[[Session, m.Message], None] | None = None
) -> list[m.Message]:
    """All messages of a session in virtual time; its log and its visitors go into `folder`.

    A `hand` is told each message and may do something about it, as a wizard does.
    """
    return run_virtual(_played(folder, seconds, hand))


async def _played(
    folder: Path, seconds: float, hand: Callable[[Session, m.Message], None] | None
) -> list[m.Message]:
    drivers = catalogue()
    identity = SessionIdentity(participant="G01", condition="alone", wizard="W1", seed=1)
    rig = SessionRig(folder, (), identity, drivers, load(GUIDE, drivers), rests=False)
    if hand is not None:
        rig.session.hub.listen(functools.partial(hand, rig.session))
    async with rig:
        await asyncio.sleep(seconds - asyncio.get_running_loop().time())
    return rig.lines


def path(messages: Sequence[m.Message]) -> list[str]:
    """The states, one after the other."""
    changes = [each for each in messages if isinstance(each, m.EngagementChanged)]
    return [each.was for each in changes[:1]] + [each.now for each in changes]


# -- in real time ---------------------------------------------------------------------------------


def hosted(folders: Sequence[Path], seconds: float) -> list[list[m.Message]]:
    """The logs of sessions that run side by side for `seconds`, one for each folder."""
    with contextlib.ExitStack() as stack:
        hosts = [stack.enter_context(_host(folder)) for folder in folders]
        time.sleep(BEGINS_S)
        for host, folder in zip(hosts, folders, strict=True):
            if host.poll() is not None:
                raise RuntimeError((folder / ERRORS).read_text(encoding="utf-8"))
        time.sleep(max(0.0, seconds - BEGINS_S))
        for host in hosts:
            host.send_signal(signal.SIGTERM)
        for host in hosts:
            host.wait(ENDS_S)
    return [_read(folder) for folder in folders]


def _host(folder: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "woz_tui", "host", str(GUIDE)]
    command += ["--recordings", str(folder), "--session", "S01"]
    command += ["--participant", "G01", "--condition", "alone", "--spill", str(folder / SPILL)]
    command += ["--name", f"{folder.parent.name}-{folder.name}"]
    with (folder / ERRORS).open("wb") as errors:
        return subprocess.Popen(command, stderr=errors, stdin=subprocess.DEVNULL)


def _read(folder: Path) -> list[m.Message]:
    [first] = sorted(folder.glob("*_S01.jsonl"))
    lines = log_reader.read(first, places=[folder, folder / SPILL])
    return [line.message for line in lines if line.message is not None]


def main() -> int:
    """Compare two sessions; 1 if their states differ."""
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else MINUTES
    with tempfile.TemporaryDirectory() as parent:
        folders = [Path(parent) / name for name in ("first", "second")]
        for folder in folders:
            folder.mkdir()
        first, second = (path(messages) for messages in hosted(folders, minutes * 60))
    common = min(len(first), len(second))
    same = first[:common] == second[:common] and abs(len(first) - len(second)) <= 1
    out = sys.stdout.write
    out(f"{minutes:g} minutes, {len(first)} and {len(second)} states: ")
    out("the same\n" if same else "not the same\n")
    for name, states in (("first", first), ("second", second)):
        out(f"{name}: {' '.join(states)}\n")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
