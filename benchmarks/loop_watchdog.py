"""What watching costs an idle robot process: its processor time with the watchdog and without.

python benchmarks/loop_watchdog.py [--seconds 20] [--quick]
"""

from __future__ import annotations

import argparse
import asyncio
import time

from benchmarks.figures import machine
from woz_tui.bus.hub import Hub
from woz_tui.host.loop_watchdog import LoopWatchdog
from woz_tui.protocol.messages import SessionEnd
from woz_tui.system.clock import RealClock

#: Goal: share of one processor.
GOAL = 0.01


async def spent(seconds: float, *, watched: bool) -> float:
    """Processor time of an idle loop, as a share of `seconds`."""
    hub = Hub(RealClock(), lambda message, line: None)
    if watched:
        LoopWatchdog({}, hub)
    began = time.process_time()
    await asyncio.sleep(seconds)
    used = time.process_time() - began
    hub.publish(SessionEnd(reason="measured", sha256=""))
    return used / seconds


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    seconds = 1.0 if arguments.quick else arguments.seconds
    print(machine())
    without = asyncio.run(spent(seconds, watched=False))
    watched = asyncio.run(spent(seconds, watched=True))
    cost = watched - without
    print(f"idle: {without:.3%} of a processor; watched: {watched:.3%}; cost {cost:.3%}")
    print(f"goal: below {GOAL:.0%}, {'met' if cost < GOAL else 'MISSED'}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
