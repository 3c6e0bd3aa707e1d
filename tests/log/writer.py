"""Writes logs until it is killed: one child process for each line on standard input.

Run as a program. Answers with the child's pid, then with the number of each recorded line as
soon as `publish` has returned, and with `dead` when the child is gone.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from woz_tui.bus.hub import Hub
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock


def write_for_ever(folder: Path, stem: str) -> None:
    clock = RealClock()
    recorder = Recorder(folder, stem, clock, spill=folder / "spill")
    hub = Hub(clock, recorder.record)
    os.write(1, f"pid {os.getpid()}\n".encode())
    while True:
        number = hub.publish(m.Note(text="x" * 100)).seq
        os.write(1, f"{number}\n".encode())
        number = hub.publish(m.reading("distance", 1.0)).seq
        os.write(1, f"{number}\n".encode())


def main() -> None:
    folder = Path(sys.argv[1])
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            write_for_ever(folder, line.strip())
        os.waitpid(child, 0)
        os.write(1, b"dead\n")


if __name__ == "__main__":
    main()
