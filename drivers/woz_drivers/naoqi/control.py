"""`--control`: the service StandIn by JSON lines on standard input and output."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from collections.abc import Callable, Mapping
from typing import Any

from woz_drivers.naoqi.pepper import Pepper
from woz_drivers.naoqi.standin import StandIn
from woz_drivers.naoqi.table import Refused

#: A line may carry a whole set of values.
_LIMIT = 1 << 22


class Control:
    """Reads orders, answers each with `{"ok": ...}` or `{"error": ...}`, in order."""

    def __init__(self, pepper: Pepper, out: int) -> None:
        self._standin, self._out = pepper.standin, out

    async def run(self, ended: asyncio.Event) -> None:
        """Until nobody can give orders any more; then the robot ends, too."""
        reader = asyncio.StreamReader(limit=_LIMIT)
        loop = asyncio.get_running_loop()
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
        while line := await reader.readline():
            self._answer(line)
        ended.set()

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
