"""Run a command while its processes stand still now and then, as on a busy machine.

`python -m tools.stalls make test` shows which tests take a machine for one that is never busy.
Python processes below the command are stopped for 0.2 to 0.7 s at random moments; `--seed` chooses
other ones. Left out are those that notice it by themselves (they handle SIGCONT, as the console
does) and those that somebody else has stopped. A test that stops a process in the same moment sees
it go on too early: look whether a red one does.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import psutil

#: How long a process stands still, and the time between two stops in all, in seconds.
SHORTEST_S, LONGEST_S, EVERY_S = 0.2, 0.7, 0.25
#: How often something is done, and new processes are looked for, in seconds.
_TICK_S, _LOOK_S = 0.02, 1.0
#: Programs whose children are left out: they stop with their child and would have to be sent on as
#: well, or (a shell at a terminal) take it for ctrl+z and put it into the background.
_PARENTS_LEFT_OUT = ("nsenter", "unshare", "bash")


def main(arguments: list[str] | None = None) -> int:
    """Run the command; its exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.stalls", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    parser.add_argument("command", nargs=argparse.REMAINDER, help="what to run")
    parsed = parser.parse_args(arguments)
    if not parsed.command:
        parser.error("which command?")
    chance = random.Random(parsed.seed)
    stopped: dict[int, float] = {}  # process -> when it goes on
    candidates: list[int] = []
    looked = float("-inf")
    with subprocess.Popen(parsed.command) as run:
        try:
            while run.poll() is None:
                now = time.monotonic()
                if now - looked > _LOOK_S:
                    candidates, looked = list(_python_processes(run.pid)), now
                for pid in [pid for pid, until in stopped.items() if until <= now]:
                    del stopped[pid]
                    _send(pid, signal.SIGCONT)
                free = [pid for pid in candidates if pid not in stopped]
                if free and chance.random() < _TICK_S / EVERY_S:
                    pid = chance.choice(free)
                    if _may_stop(pid) and _send(pid, signal.SIGSTOP):
                        stopped[pid] = now + chance.uniform(SHORTEST_S, LONGEST_S)
                time.sleep(_TICK_S)
        finally:
            for pid in stopped:
                _send(pid, signal.SIGCONT)
    return run.returncode


def _python_processes(top: int) -> Iterator[int]:
    with contextlib.suppress(psutil.Error):
        for process in psutil.Process(top).children(recursive=True):
            with contextlib.suppress(psutil.Error):
                parent = process.parent()
                if (
                    process.name().startswith("python")
                    and parent
                    and parent.name() not in _PARENTS_LEFT_OUT
                ):
                    yield process.pid


def _may_stop(pid: int) -> bool:
    """Whether it runs, and does not notice at the moment that it goes on."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return False
    status = dict(line.split(":\t", 1) for line in lines if ":\t" in line)
    handles_continue = int(status["SigCgt"], 16) >> (signal.SIGCONT - 1) & 1
    return not status["State"].startswith(("T", "Z")) and not handles_continue


def _send(pid: int, number: signal.Signals) -> bool:
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return False
    return True


if __name__ == "__main__":
    sys.exit(main())
