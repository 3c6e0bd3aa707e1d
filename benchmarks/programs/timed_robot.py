"""A simulated robot behind HTTP and WebSocket that notes when each call was taken.

    python benchmarks/programs/timed_robot.py MODULE:CLASS [PORT]

The first line says where it listens: `{"address": "..."}`. Each line on standard input is answered
with all calls so far: `[[name, arguments, nanoseconds of CLOCK_MONOTONIC], ...]`.
"""

from __future__ import annotations

import asyncio
import importlib
import json
import sys
import time
from typing import Any

from robot_simulators.web_robot import WebRobot


class TimedCalls(list[tuple[str, Any]]):
    """A list of calls that knows when each was put into it."""

    def __init__(self) -> None:
        super().__init__()
        self.times: list[int] = []

    def append(self, call: tuple[str, Any]) -> None:
        self.times.append(time.monotonic_ns())
        super().append(call)


async def serve(robot: WebRobot, port: int) -> None:
    calls = TimedCalls()
    robot.calls = calls
    await robot.start(port=port)
    print(json.dumps({"address": robot.address}), flush=True)
    while await asyncio.to_thread(sys.stdin.readline):
        known = [[*call, at] for call, at in zip(calls, calls.times, strict=True)]
        print(json.dumps(known, default=str), flush=True)


if __name__ == "__main__":
    module, _, kind = sys.argv[1].partition(":")
    made: WebRobot = getattr(importlib.import_module(module), kind)()
    asyncio.run(serve(made, int(sys.argv[2]) if len(sys.argv) > 2 else 0))
