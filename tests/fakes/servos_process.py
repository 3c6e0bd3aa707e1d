"""`python -m tests.fakes.servos`: the emulated servos as a process; see `servos`."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
import time
from pathlib import Path

from tests.fakes.servo_motor import KINDS, OVERLOAD, Motor
from tests.fakes.servos import ServoBus


def order(bus: ServoBus, line: str) -> None:
    """Carry out one line of standard input; unknown ones are reported on standard error."""
    word, _, rest = line.strip().partition(" ")
    try:
        if word == "pull":
            bus.pull()
        elif word == "plug":
            bus.plug()
        elif word in ("silent", "alive"):
            bus.servo(int(rest)).silent = word == "silent"
        elif word == "overload":
            bus.servo(int(rest)).raise_alarm(OVERLOAD)
        elif word == "reset":
            bus.servo(int(rest)).reboot(time.monotonic())
        elif word == "brownout":
            number, *how = rest.split()
            named = zip(("seconds", "boot", "fall"), map(float, how), strict=False)
            bus.brownout(int(number), 0, **dict(named))
        elif word == "corrupt":
            bus.faults.corrupt = int(rest)
        elif word == "noise":
            bus.faults.noise = 1
        elif word in ("slow", "latency"):
            setattr(bus.faults, word, float(rest))
        elif word == "witness":
            bus.watch(Path(rest))
        elif word:
            sys.stderr.write(f"unknown order: {line}\n")
    except (KeyError, ValueError) as error:
        sys.stderr.write(f"{line.strip()}: {error!r}\n")


def obey_standard_input(bus: ServoBus) -> None:
    """Carry out orders until nobody can give any more."""
    rest = b""
    # Not sys.stdin: its lock would stand in the way of the program's end.
    while data := os.read(0, 4096):
        *lines, rest = (rest + data).split(b"\n")
        for line in lines:
            order(bus, line.decode("ascii", "replace"))


def main(arguments: list[str] | None = None) -> int:
    """Run as a process; see the module's text."""
    parser = argparse.ArgumentParser(description="Emulated Dynamixel servos")
    parser.add_argument("--link", type=Path, required=True)
    parser.add_argument("--ids", default="11,12,13")
    parser.add_argument("--model", default="XL330-M288", choices=sorted(KINDS))
    parser.add_argument("--protocol", type=int, default=None, choices=(1, 2))
    parser.add_argument("--journal", type=Path, default=None)
    parser.add_argument("--position", action="append", default=[], metavar="ID=COUNTS")
    options = parser.parse_args(arguments)
    if options.protocol not in (None, KINDS[options.model][0]):
        parser.error(f"{options.model} speaks protocol {KINDS[options.model][0]}")
    ids = [int(number) for number in options.ids.split(",")]
    # Blocked here and, by inheritance, in every thread: only `sigwait` below sees them.
    endings = {signal.SIGTERM, signal.SIGINT}
    signal.pthread_sigmask(signal.SIG_BLOCK, endings)
    bus = ServoBus(ids, options.link, model=options.model, journal=options.journal)
    for entry in options.position:
        number, _, counts = entry.partition("=")
        motor = bus.servo(int(number))
        bus.servos[motor.number] = Motor(motor.number, motor.kind, position=float(counts))
    with bus:
        sys.stdout.write(f"ready {options.link}\n")
        sys.stdout.flush()
        threading.Thread(target=obey_standard_input, args=(bus,), daemon=True).start()
        signal.sigwait(endings)
    return 0
