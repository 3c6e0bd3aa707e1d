"""Stops by eight kinds of client, while all of them ask for as much as they are answered.

`python -m tests.e2e.interleavings --rounds 370` prints what it found; the test runs fewer rounds.
In each round another client presses the stop, at another moment; before every third one, one robot
of two is made to confirm it too late. In the log nothing may have gone to a robot between a stop
and its release, and no robot may have confirmed that did not.
"""

from __future__ import annotations

import contextlib
import functools
import random
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.e2e import rounds
from tests.e2e.lab import Lab, Log, until
from tests.e2e.program import Program
from woz_tui.client.blocking import connect
from woz_tui.client.woz_errors import WozError
from woz_tui.system.session_sockets import answers

EXPERIMENT = """\
title: Stops
robot:
  name: two
  drivers:
    left: {type: simulated, speed: 20}
    right: {type: simulated, speed: 20}
session: {stale_after: 30 s, dead_man: 60 s}
panels:
  - title: All
    actions:
      - {name: say, say: a few words, on: left}
      - {name: nod, play: nod, on: right}
      - {name: both, steps: [{say: first, on: left}, {wait: 0.02}, {play: nod, on: right}]}
      - {name: drive, drive: 0.3, on: left}
script: [say, nod, both, drive]
"""
ACTIONS = ("say", "nod", "both", "drive")
ROBOTS = {"left", "right"}
#: The longest that clients play before somebody presses the stop, and how long each pauses between
#: two requests, in seconds.
PLAYS_S, PAUSE_S = 0.15, 0.004

#: What a client asks for as long as it is answered, and how it presses the stop.
Asks = tuple[Callable[[], object], Callable[[], object]]


@dataclass
class Found(rounds.Found):
    """What the rounds showed."""

    stops: int = 0
    requests: int = 0
    dispatched: int = 0
    missing: int = 0

    def sentence(self) -> str:
        """All of it."""
        return (
            f"{self.stops} stops by {len(KINDS)} kinds of client among {self.requests} requests and"
            f" {self.dispatched} commands, {self.missing} confirmations missing"
        )


class Player(threading.Thread):
    """A client of one kind, which plays, and presses the stop when it is told to."""

    def __init__(self, kind: str, path: Path, seed: int) -> None:
        super().__init__(name=kind, daemon=True)
        self.kind = kind
        self.requests = 0
        self.error: BaseException | None = None
        self._path = path
        self._dice = random.Random(seed)
        self._presses, self._pressed, self._over = (threading.Event() for _ in range(3))

    def press(self) -> None:
        """Have it press the stop, and wait until that is answered."""
        self._presses.set()
        until(lambda: self._pressed.is_set() or self.error is not None, f"a stop by {self.kind}")
        self._pressed.clear()

    def leave(self) -> None:
        """It asks for nothing more."""
        self._over.set()
        self.join(10)

    def run(self) -> None:
        """The thread."""
        try:
            with contextlib.ExitStack() as stack:
                play, stop = self._asks(stack)
                while not self._over.is_set():
                    if self._presses.is_set():
                        self._presses.clear()
                        stop()
                        self._pressed.set()
                    play()
                    self.requests += 1
                    self._over.wait(PAUSE_S)
        except BaseException as error:  # noqa: BLE001 - told by the round
            self.error = error

    def _asks(self, stack: contextlib.ExitStack) -> Asks:
        if self.kind == "library":
            woz = stack.enter_context(connect(self._path))

            def press_action() -> None:
                with contextlib.suppress(WozError):  # refused, or stopped
                    woz.press(self._dice.choice(ACTIONS))

            return press_action, woz.stop
        roles = {"wizard", "watcher", "participant"}
        role = self.kind if self.kind in roles else "program"
        client = stack.enter_context(Program(self._path, role=role))
        clock_us = int(client.welcome["t"])

        def ask() -> object:
            match self.kind:
                case "wizard":
                    return client.ask("action", action=self._any(), source="key", key="x")
                case "script":
                    return client.ask("script")
                case "verbs":
                    return client.ask("verb", verb="say", args={"text": "well"}, on="left")
                case "scheduled":
                    at = clock_us + self._dice.randrange(60_000_000)
                    return client.ask("action", action=self._any(), at=at)
                case "one line":
                    return client.ask("action", action=self._any(), when_busy="replace")
            return client.ask("marker", text="here")  # whoever plays nothing

        def one_line() -> None:
            """As the console does beside a full queue: a connection for the stop alone."""
            with Program(self._path) as aside:
                aside.ask("stop")

        press = functools.partial(client.ask, "stop", source=self.kind)
        return ask, one_line if self.kind == "one line" else press

    def _any(self) -> str:
        return self._dice.choice(ACTIONS)


KINDS = (
    *("wizard", "script", "verbs", "scheduled"),
    *("library", "watcher", "participant", "one line"),
)


def run(lab: Lab, rounds: int, seed: int) -> Found:
    """Press `rounds` stops, each by the next kind of client."""
    dice = random.Random(seed)
    host = lab.woz(
        *("host", str(lab.file("stops.yaml", EXPERIMENT))),
        *("--recordings", str(lab.recordings), "--session", "S1"),
    )
    path = lab.runtime / "woz" / "S1.sock"
    until(functools.partial(answers, path), "a robot process")
    players = [Player(kind, path, seed + number) for number, kind in enumerate(KINDS)]
    found = Found(stops=rounds)
    with Program(path, stream="actions") as control:
        for player in players:
            player.start()
        for number in range(rounds):
            fault = {"kind": "deaf", "seconds": 60} if number % 3 == 0 else {"kind": "clear"}
            control.ask("verb", verb="fault", args=fault, on="right")
            threading.Event().wait(dice.uniform(0, PLAYS_S))
            players[number % len(players)].press()
            while not control.ask("release", missing=_missing(control))["ok"]:
                pass  # one more robot has not confirmed it: the next line says which
        for player in players:
            player.leave()
            found.requests += player.requests
            if player.error is not None:
                found.complaints.append(f"{player.kind}: {player.error!r}")
        control.ask("end")
    host.wait()
    judge(lab.log, found)
    return found


def _missing(control: Program) -> list[str]:
    """Who has not confirmed the stop, as soon as that is told."""
    missing: list[str] = control.until(kind="stop.confirmed")["missing"]
    return missing


def judge(log: Log, found: Found) -> None:
    """Look at every line between a stop and its release."""
    lines, _ = log.whole()
    deaf = stopped = False
    for line in lines:
        driver = str(line.fields.get("driver", ""))
        if line.fields.get("scope") == "drive":  # the wizard has left: nothing is latched
            continue
        match line.kind:
            case "command.requested" if line.fields["verb"] == "fault":
                deaf = line.fields["args"]["kind"] == "deaf"
            case "stop.pressed":
                stopped = True
            case "stop.released":
                stopped = False
            case "command.dispatched":
                found.dispatched += 1
                if stopped and driver in ROBOTS:
                    found.complaints.append(f"line {line.seq}: {driver} was asked under a stop")
            case "stop.confirmed":
                confirmed, missing = set(line.fields["confirmed"]), set(line.fields["missing"])
                found.missing += len(missing)
                if confirmed | missing != ROBOTS or (deaf and "right" in confirmed):
                    found.complaints.append(f"line {line.seq}: confirmed by {sorted(confirmed)}")


if __name__ == "__main__":
    sys.exit(rounds.main(run, __doc__, 370))
