"""Records notes in a process whose files may not grow beyond a few lines (RLIMIT_FSIZE)."""

from __future__ import annotations

import resource
import signal
import sys
from pathlib import Path

from woz_tui.bus.hub import Hub
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock

LARGEST = 4_000


def main() -> None:
    folder, stem, count = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST, LARGEST))
    clock = RealClock()
    recorder = Recorder(folder / "recordings", stem, clock, spill=folder / "spill")
    hub = Hub(clock, recorder.record)
    for number in range(count):
        hub.publish(m.Note(text=f"note {number}"))
        if not recorder.sync(20):
            sys.exit(3)
    sys.exit(0 if recorder.close() else 4)


if __name__ == "__main__":
    main()
