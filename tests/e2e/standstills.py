"""Console and robot process stand still together, with keys pressed before and meanwhile.

`python -m tests.e2e.standstills --rounds 20` prints how old what was played had become. In every
other round the robot process goes on before the console. It is no test of the suite: a process that
is stopped between its look at a key and the command plays the key when it goes on.
"""

from __future__ import annotations

import os
import random
import sys
import time
from dataclasses import dataclass, field
from datetime import datetime

import psutil

from tests.e2e import rounds
from tests.e2e.lab import Lab, Log, until
from tests.fakes.terminal import FakeTerminal

EXPERIMENT = """\
title: Standstills
robot: simulated
session: {dead_man: 10 s, abandon_after: 60 s, stale_after: 1.5 s}
panels:
  - title: All
    actions:
      - {key: a, label: Early, mark: early}
      - {key: b, label: Begin, mark: begin}
      - {key: c, label: Middle, mark: middle}
      - {key: d, label: Late, mark: late}
      - {key: z, label: Sound, mark: sound}
"""
STALE_S = 1.5
#: How long both stand still, and how long one of them does after the other.
STILL_S, APART_S = 1.6, (0.0, 0.4)
#: Keys by the moment at which they are pressed, in seconds from the standstill's beginning; the
#: first one, `a`, just before it.
KEYS = {"b": 0.05, "c": 0.8, "d": 1.4}
LABELS = {"a": "Early", "b": "Begin", "c": "Middle", "d": "Late"}
#: A clock's reading and the writing of a line lie between what was decided and what is read.
EPS_S = 0.02


@dataclass
class Found(rounds.Found):
    """How old the keys were that were played, and what became of the others."""

    ages: list[float] = field(default_factory=list)
    refused: int = 0
    unseen: int = 0
    pressed: int = 0

    def sentence(self) -> str:
        """All of it."""
        oldest = max(self.ages, default=0.0)
        return (
            f"{self.pressed} keys around standstills of {STILL_S} s: {len(self.ages)} played, the"
            f" oldest {oldest:.3f} s old, {self.refused} refused, {self.unseen} not seen"
        )


@dataclass
class _Round:
    """Keys around one standstill: when each was pressed, and the lines of the log before it."""

    before: int
    order: str
    apart: float
    pressed: dict[str, float] = field(default_factory=dict)


def run(lab: Lab, rounds: int, seed: int) -> Found:
    """Freeze both processes of one session again and again."""
    dice = random.Random(seed)
    terminal = lab.run(lab.file("standstills.yaml", EXPERIMENT))
    console, host = psutil.Process(terminal.process.pid), lab.host_process()
    orders = {"console first": (console, host), "robot first": (host, console)}
    played = [
        _stand_still(terminal, lab.log, *[*orders.items()][number % 2], dice.uniform(*APART_S))
        for number in range(rounds)
    ]
    return _judge(lab.log, played)


def _stand_still(
    terminal: FakeTerminal, log: Log, order: str, both: tuple[psutil.Process, ...], apart: float
) -> _Round:
    """The first of `both` goes on so many seconds before the other."""
    one = _Round(len(log.lines()), order, apart)

    def press(key: str) -> None:
        one.pressed[LABELS[key]] = time.time()
        os.write(terminal.master, key.encode())  # at once, whatever the program asks the terminal

    press("a")
    for process in both:
        process.suspend()
    start = time.monotonic()
    for key, moment in KEYS.items():
        _wait(start + moment)
        press(key)
    _wait(start + STILL_S)
    for process in both:
        process.resume()
        _wait(time.monotonic() + apart)
    sound = len(log.lines("action.done", action="Sound"))
    until(lambda: _sounds(terminal, log) > sound, "a key that is played again")
    return one


def _judge(log: Log, played: list[_Round]) -> Found:
    """Look at what became of every key."""
    found, lines = Found(), log.lines()
    refused = {line.fields["run"] for line in log.lines("action.refused")}
    for one, end in zip(played, [*(each.before for each in played[1:]), len(lines)], strict=True):
        asked = {
            str(line.fields["action"]): line
            for line in lines[one.before : end]
            if line.kind == "action.requested"
        }
        for label, at in one.pressed.items():
            found.pressed += 1
            if (line := asked.get(label)) is None:
                found.unseen += 1
            elif line.fields["run"] in refused:
                found.refused += 1
            else:
                age = datetime.fromisoformat(str(line.fields["ts"])).timestamp() - at
                found.ages.append(age)
                if age > STALE_S + EPS_S:
                    found.complaints.append(
                        f"{label} was played {age:.3f} s after its key ({one.order},"
                        f" {one.apart:.2f} s apart)"
                    )
    return found


def _sounds(terminal: FakeTerminal, log: Log) -> int:
    """Press a key until one has been played: those right after a standstill may be refused."""
    terminal.send("z")
    _wait(time.monotonic() + 0.3)
    return len(log.lines("action.done", action="Sound"))


def _wait(moment: float) -> None:
    while (left := moment - time.monotonic()) > 0:
        time.sleep(left)


if __name__ == "__main__":
    sys.exit(rounds.main(run, __doc__, 20))
