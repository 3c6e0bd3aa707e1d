"""kill -9 of the robot process, again and again, while a program plays as fast as it is answered.

`python -m tests.e2e.crashes --rounds 200` prints what it found; the tests run fewer rounds.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import random
import resource
import sys
import threading
from dataclasses import dataclass

import psutil

from tests.e2e import rounds
from tests.e2e.lab import Lab, Log, until
from tests.e2e.program import Program
from woz_tui.system.session_sockets import answers

EXPERIMENT = """\
title: Crashes
robot: {name: quick, drivers: {robot: {type: simulated, speed: 20}}}
panels:
  - title: All
    actions:
      - {name: say, say: "a few words", when_busy: replace}
      - {name: nod, play: nod, when_busy: replace}
      - {name: mark, mark: here}
      - {name: both, steps: [{eyes: red}, {emotion: happy, volume: 0.3}]}
"""
ACTIONS = ("say", "nod", "mark", "both")
#: The most that is asked before a robot process is killed, and the longest that it lives after
#: that, in seconds: so it dies in the middle of whatever it does.
MOST, LIFE_S = 30, 0.05
#: The longest that a file may become once all disks are full, in bytes.
FULL = (64, resource.RLIM_INFINITY)


@dataclass
class Found(rounds.Found):
    """What the rounds showed."""

    killed: int = 0
    acknowledged: int = 0
    lost: int = 0
    refused: int = 0
    lines: int = 0
    torn: int = 0

    def sentence(self) -> str:
        """All of it."""
        return (
            f"{self.killed} robot processes killed: {self.acknowledged} acknowledged actions,"
            f" {self.lost} of them not in the log, {self.refused} refused, {self.lines} lines,"
            f" {self.torn} torn at the end"
        )


def run(lab: Lab, rounds: int, seed: int, *, full: bool = False) -> Found:
    """Crash `rounds` robot processes, each at another random moment. `full`: at another one, before
    that, no folder takes anything any more.
    """
    dice = random.Random(seed)
    experiment = lab.file("crashes.yaml", EXPERIMENT)
    found = Found()
    for number in range(1, rounds + 1):
        process = lab.woz(
            "host", str(experiment), "--recordings", str(lab.recordings), "--session", f"S{number}"
        )
        path = lab.runtime / "woz" / f"S{number}.sock"
        until(functools.partial(answers, path), "a robot process")
        acknowledged: list[str] = []
        enough = dice.randrange(1, MOST)
        fills = dice.randrange(enough) if full else -1
        killer = threading.Timer(dice.uniform(0.0, LIFE_S), process.kill)
        with Program(path) as program, contextlib.suppress(OSError):  # it is dead
            for asked in itertools.count():
                if asked == fills:
                    psutil.Process(process.pid).rlimit(resource.RLIMIT_FSIZE, FULL)
                if asked == enough:
                    killer.start()
                reply = program.ask("action", action=dice.choice(ACTIONS))
                if not reply["ok"]:
                    found.refused += 1
                elif reply.get("recorded", True):
                    acknowledged.append(str(reply["run"]))
        if killer.ident:
            killer.join()
        else:
            found.complaints.append(f"S{number}: it ended or stood still by itself")
            process.kill()
        process.wait()
        path.unlink()
        _judge(lab, f"S{number}", acknowledged, found)
    return found


def _judge(lab: Lab, session: str, acknowledged: list[str], found: Found) -> None:
    """Compare what was acknowledged with what is in the files."""
    (path,) = (
        each for each in lab.recordings.glob(f"*_{session}.jsonl") if ".samples" not in each.name
    )
    lines, damage = Log(path).whole()
    requested = {line.fields["run"] for line in lines if line.kind == "action.requested"}
    lost = [run for run in acknowledged if run not in requested]
    found.killed += 1
    found.acknowledged += len(acknowledged)
    found.lost += len(lost)
    found.lines += len(lines)
    found.torn += damage.torn
    if lost:
        found.complaints.append(f"{session}: acknowledged and not in the log: {lost}")
    # Each of the two files may end in the middle of a line, and that is all.
    harmless = damage.torn <= 2 and damage.skipped == damage.torn and not damage.unreadable
    if not harmless or damage.nul_bytes:
        found.complaints.append(f"{session}: {'; '.join(damage.sentences())}")
    numbers = [line.seq for line in lines]
    if numbers != list(range(len(numbers))):
        found.complaints.append(f"{session}: gaps in the numbers of its lines")


if __name__ == "__main__":
    sys.exit(rounds.main(run, __doc__, 200, {"full": "fill all disks before"}))
