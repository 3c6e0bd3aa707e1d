"""From a byte of a MIDI panel to the setpoint of the joint that it moves.

    python benchmarks/midi_latency.py [--seconds 20] [--rate 50] [--quick]

A real session without a console: a panel on a pseudo-terminal, the driver `midi`, the bus with its
log on disk, the driver `body` with its thread. Four knobs move at once, each sends 100 messages a
second, up and down its whole way. A value has arrived when the joint's setpoint is there or beyond;
values that a newer one overtook count until that one arrives. At the end all four stand still:
a joint that is elsewhere than its knob has lost its last value.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import pty
import sys
import tempfile
import threading
import time
import tty
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from benchmarks.figures import Spread, machine, percentile, table, verdict
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver, DriverContext, PassiveDriver
from woz_tui.drivers.plugins import installed
from woz_tui.log.recorder import Recorder
from woz_tui.motion.body_feeds import SETPOINTS, Setpoints
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import RealClock

GOAL_MS = 20.0
KNOBS = ("a", "b", "c", "d")
MESSAGES_A_SECOND = 100
#: A joint's whole way: one degree for each value, so that no speed limit is in the way.
DEGREES = 128.0
_LOOK_S = 0.0005
#: Seconds that the session is left alone before and after.
SETTLE_S = 0.5

_ROBOT = """
drivers:
  body:
    type: body
    rate: {rate}
    joints:
{joints}
    breathing: {{}}
  panel:
    type: midi
    device: {device}
    take_over: jump
    map:
      controls:
{controls}
  eye:
    type: eye
"""


@dataclass(frozen=True)
class Nothing:
    """The eye has no settings."""


class Eye(PassiveDriver):
    """A driver that looks at the body's setpoints all the time and notes when they changed."""

    Settings = Nothing
    summary = "notes setpoints"
    seen: ClassVar[list[tuple[int, Mapping[str, float]]]] = []

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._feed = context.feed(SETPOINTS, of="body")
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    async def open(self) -> None:
        self._thread.start()

    async def close(self) -> None:
        self._over.set()

    def _look(self) -> None:
        serial = 0
        while not self._over.wait(_LOOK_S):
            latest = self._feed.latest()
            if latest.serial != serial and isinstance(latest.value, Setpoints):
                serial = latest.serial
                self.seen.append((time.monotonic_ns(), latest.value.joints))


@dataclass
class Hand:
    """Four knobs that move at once; what each sent, and when."""

    fd: int
    seconds: float
    sent: list[tuple[int, int, int]] = field(default_factory=list)

    def play(self) -> None:
        """Triangles of different phase, then stand still."""
        pause = 1 / MESSAGES_A_SECOND / len(KNOBS)
        due = time.monotonic()
        for step in range(int(self.seconds * MESSAGES_A_SECOND)):
            for knob in range(len(KNOBS)):
                due += pause
                time.sleep(max(0.0, due - time.monotonic()))
                place = (step + 37 * knob) % 254
                value = place if place <= 127 else 254 - place
                self.sent.append((time.monotonic_ns(), knob, value))
                os.write(self.fd, bytes((0xB0, knob, value)))


def experiment(folder: Path, device: str, rate: float) -> Path:
    """The files of the session."""
    joint = f"{{axis: z, min: 0, max: {DEGREES:g}, speed: 3000}}"
    (folder / "robot.yaml").write_text(
        _ROBOT.format(
            rate=rate,
            device=device,
            joints="\n".join(f"      {name}: {joint}" for name in KNOBS),
            controls="\n".join(
                f"        knob-{name}: {{cc: {number}, kind: knob, control: {name}}}"
                for number, name in enumerate(KNOBS)
            ),
        ),
        encoding="utf-8",
    )
    path = folder / "it.yaml"
    path.write_text("title: it\nrobot: robot.yaml\npanels: [{title: P, actions: []}]\n")
    return path


async def session(folder: Path, hand: Hand, device: str, rate: float) -> tuple[int, int]:
    """Play through a session; how many commands were done, and how many failed."""
    catalogue: dict[str, type[Driver]] = {**installed(), "eye": Eye}
    clock = RealClock()
    recorder = Recorder(folder, "it", clock, on_state=lambda state: None)
    made = Session(
        load(experiment(folder, device, rate), catalogue),
        catalogue,
        SessionIdentity(),
        recorder,
        clock,
    )
    ends: list[m.End] = []
    made.hub.listen(ends.append, m.End)
    await made.open()
    await asyncio.sleep(SETTLE_S)
    await asyncio.to_thread(hand.play)
    await asyncio.sleep(SETTLE_S)
    await made.close("measured", rest=False)
    done = sum(isinstance(end, m.Done) for end in ends)
    return done, len(ends) - done


def angle(value: int) -> float:
    """The setpoint of a knob's value, in degrees."""
    return DEGREES * (value / 128 if value <= 64 else 0.5 + (value - 64) / 126)


def latencies(hand: Hand) -> list[float]:
    """Milliseconds from each message until the setpoint was its own, or that of a newer one."""
    took = []
    for knob, name in enumerate(KNOBS):
        sent = [(at, angle(value)) for at, number, value in hand.sent if number == knob]
        arrived = 0
        for moment, joints in Eye.seen:
            newest = _shown(sent, arrived, moment, joints[name])
            took += [(moment - at) / 1e6 for at, _ in sent[arrived:newest]]
            arrived = newest
        took += [float("inf")] * (len(sent) - arrived)
    return took


def _shown(sent: list[tuple[int, float]], arrived: int, moment: int, setpoint: float) -> int:
    """How many messages had arrived when this setpoint was seen; `arrived` had before."""
    known = arrived
    for index in range(arrived, len(sent)):
        at, wanted = sent[index]
        if at > moment:
            break
        if abs(wanted - setpoint) < 0.02:
            known = index + 1
    return known


def lost(hand: Hand) -> int:
    """How many knobs stand elsewhere than their joints at the end."""
    last = {number: value for _, number, value in hand.sent}
    joints = Eye.seen[-1][1]
    return sum(abs(joints[KNOBS[knob]] - angle(value)) > 0.01 for knob, value in last.items())


def measure(seconds: float, rate: float) -> None:
    """One session, and its table."""
    Eye.seen.clear()
    panel_end, computer_end = pty.openpty()
    tty.setraw(computer_end)
    hand = Hand(panel_end, seconds)
    with tempfile.TemporaryDirectory() as folder:
        done, failed = asyncio.run(session(Path(folder), hand, os.ttyname(computer_end), rate))
    for end in (panel_end, computer_end):
        os.close(end)
    took = latencies(hand)
    spread, p95 = Spread.of(took), percentile(took, 0.95)
    table(
        f"four knobs at {MESSAGES_A_SECOND} messages/s each, a body at {rate:g} Hz",
        ("", "messages", "p50 ms", "p95 ms", "p99 ms", "worst ms", "goal", "last lost", "failed"),
        [
            [
                "byte to setpoint",
                f"{len(hand.sent)} ({done} asked)",
                f"{spread.p50:.1f}",
                f"{p95:.1f}",
                f"{spread.p99:.1f}",
                f"{spread.worst:.1f}",
                f"p95 < {GOAL_MS:g} {verdict(p95, GOAL_MS)}",
                str(lost(hand)),
                str(failed),
            ]
        ],
    )


def main() -> int:
    """Measure at the usual rate of a body and at the doubled one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, action="append")
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    print(machine())
    for rate in arguments.rate or [50.0, 100.0]:
        measure(1.0 if arguments.quick else arguments.seconds, rate)
    return 0


if __name__ == "__main__":
    sys.exit(main())
