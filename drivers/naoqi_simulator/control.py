"""`--control`: the service StandIn by JSON lines on standard input and output."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import threading
from collections.abc import Callable, Mapping
from typing import Any

from naoqi_simulator.pepper import Pepper
from naoqi_simulator.standin import StandIn
from naoqi_simulator.table import Refused


class Control:
    """Reads orders, answers each with `{"ok": ...}` or `{"error": ...}`, in order."""

    def __init__(self, pepper: Pepper, out: int) -> None:
        self._standin, self._out = pepper.standin, out

    async def run(self) -> None:
        """Until nobody can give orders any more; then the robot ends, too."""
        lines: asyncio.Queue[bytes] = asyncio.Queue()
        loop = asyncio.get_running_loop()
        # A thread, because standard input may be a file; a daemon, because nothing ends its read.
        threading.Thread(target=_read_lines, args=(loop, lines), daemon=True).start()
        while line := await lines.get():
            self._answer(line)

    def _answer(self, line: bytes) -> None:
        try:
            answer: dict[str, Any] = {"ok": carry_out(self._standin, json.loads(line))}
        except Refused as refused:
            answer = {"error": str(refused)}
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            answer = {"error": f"not understood: {line!r}: {error!r}"}
        data = json.dumps(answer).encode() + b"\n"
        while data:
            data = data[os.write(self._out, data) :]


def _read_lines(loop: asyncio.AbstractEventLoop, lines: asyncio.Queue[bytes]) -> None:
    """Hand on every line of standard input, and nothing at its end."""
    rest = b""
    # The loop may be gone before the last line.
    with contextlib.suppress(RuntimeError):
        while data := os.read(0, 1 << 16):
            *whole, rest = (rest + data).split(b"\n")
            for line in whole:
                if line.strip():
                    loop.call_soon_threadsafe(lines.put_nowait, line)
        loop.call_soon_threadsafe(lines.put_nowait, b"")


def carry_out(standin: StandIn, order: Mapping[str, Any]) -> Any:
    """Carry out one order: `{"do": "get", "name": "state"}`. Raises Refused."""
    orders: Mapping[str, Callable[[], Any]] = {
        "trace": standin.trace,
        "clear": standin.clear,
        "get": lambda: json.loads(standin.get(order["name"])),
        "set": lambda: standin.set(order["name"], json.dumps(order["value"])),
        "touch": lambda: standin.touch(order["x"], order["y"]),
        "person": lambda: standin.person(json.dumps(order["who"])),
        "fault": lambda: standin.fault(order["kind"], order.get("seconds", 0.0)),
    }
    if order["do"] not in orders:
        raise Refused(f"no order {order['do']!r}; there is {', '.join(orders)}")
    return orders[order["do"]]()
