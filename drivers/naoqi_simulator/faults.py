"""Faults of the simulated robot on demand, and the record of the calls that it got."""

from __future__ import annotations

import asyncio
import inspect
import json
import os
import signal
import subprocess
import time
import traceback
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

from naoqi_simulator.robot_time import SimulatorTime
from naoqi_simulator.service_table import CallRefusedError, Service, ServiceMethod

#: Faults that last until they are cleared, or for some seconds; `NAME:DETAIL` where one is needed.
LASTING_FAULTS = (
    *("invalid-signature", "slow", "refuse", "refuse-again"),
    *("says-no", "deaf", "moody"),
)
#: Faults that happen once.
SUDDEN = ("killed", "frozen")
#: Faulty or not, this service answers.
UNTOUCHED = "StandIn"


class SimulatedFaults:
    """Which faults are there now, and until when."""

    def __init__(self, time_: SimulatorTime) -> None:
        self._time = time_
        self._until: dict[str, float] = {}
        self._detail: dict[str, str] = {}
        #: Methods that were called since `refuse-again` began.
        self._called: set[str] = set()
        self._healed = asyncio.Event()
        #: What else happens once, on this kind of robot: it is given what stands after the colon.
        self.happens: dict[str, Callable[[str], None]] = {}

    def begin(self, fault: str, seconds: float) -> None:
        """Let a fault be there, for so many seconds of the robot; 0: until `clear`.

        Raises Refused for one that is not known.
        """
        kind, _, detail = fault.partition(":")
        if kind == "none":
            self.clear()
        elif kind == "killed":
            os.kill(os.getpid(), signal.SIGKILL)
        elif kind == "frozen":
            freeze(seconds)
        elif kind in self.happens:
            try:
                self.happens[kind](detail)
            except KeyError:
                raise CallRefusedError(f"no {kind} {detail!r}") from None
        elif kind in LASTING_FAULTS:
            self._until[kind] = self._time.now() + seconds if seconds > 0 else float("inf")
            self._detail[kind] = detail
            self._called.clear()
        else:
            raise CallRefusedError(
                f"no fault {kind!r}; there are none,"
                f" {', '.join((*SUDDEN, *self.happens, *LASTING_FAULTS))}"
            )

    def clear(self) -> None:
        """Nothing is wrong any more; what waits for a deaf robot goes on."""
        self._until.clear()
        self._healed.set()
        self._healed = asyncio.Event()

    def active(self, kind: str) -> bool:
        """Whether this fault is there now."""
        return self._time.now() < self._until.get(kind, -1.0)

    def detail(self, kind: str) -> str:
        """What was said after the colon."""
        return self._detail.get(kind, "")

    def names(self) -> list[str]:
        """All that are there now."""
        return [kind for kind in LASTING_FAULTS if self.active(kind)]

    async def before(self, called: str) -> None:
        """What a call meets before it is carried out. Raises Refused."""
        while self.active("deaf"):
            healed = asyncio.ensure_future(self._healed.wait())
            left = asyncio.ensure_future(
                self._time.sleep(min(3600.0, self._until["deaf"] - self._time.now()))
            )
            try:
                await asyncio.wait({healed, left}, return_when=asyncio.FIRST_COMPLETED)
            finally:
                healed.cancel()
                left.cancel()
        if self.active("slow"):
            # Real milliseconds: a slow network does not know of the robot's pace.
            await asyncio.sleep(float(self.detail("slow") or 500) / 1000)
        for kind in ("refuse", "refuse-again"):
            methods, _, text = self.detail(kind).partition("=")
            spared = kind == "refuse-again" and called not in self._called
            if self.active(kind) and called in methods.split(",") and not spared:
                raise CallRefusedError(text or f"{called.replace('.', '::')}\n\tnot now")
        self._called.add(called)


def freeze(seconds: float) -> None:
    """Stop this process as SIGSTOP does; a child lets it go on after so many real seconds.

    With 0 seconds it stays frozen until somebody sends SIGCONT.
    """
    own = os.getpid()
    if seconds <= 0:
        os.kill(own, signal.SIGSTOP)
        return
    # The shell stops us itself before it counts: were that to come late, after CONT, we would be
    # frozen for ever. It ends at once and leaves the one who waits to init: no child of ours to
    # forget.
    subprocess.run(
        ["/bin/sh", "-c", f"kill -STOP {own}; (sleep {seconds:.3f}; kill -CONT {own}) &"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=True,
    )


Entry = tuple[str, str, str, int]
MOST_ENTRIES = 100_000


class CallRecord:
    """Where every call arrives: it is written down, meets the faults, and is carried out."""

    def __init__(self, faults: SimulatedFaults) -> None:
        self.faults = faults
        #: The latest ones: a robot that is read ten times a second for a day stays small.
        self.entries: deque[Entry] = deque(maxlen=MOST_ENTRIES)
        self.heard: list[Callable[[Entry], None]] = []

    async def enter(self, service: Service, method: ServiceMethod, args: Sequence[Any]) -> Any:
        """Carry out one call. Raises Refused."""
        if service.name != UNTOUCHED:
            entry = (service.name, method.name, as_json(list(args)), time.monotonic_ns())
            self.entries.append(entry)
            for hear in self.heard:
                hear(entry)
            await self.faults.before(f"{service.name}.{method.name}")
        try:
            result = method.run(service, *args)
            return await result if inspect.isawaitable(result) else result
        except CallRefusedError:
            raise
        except Exception as error:
            # A mistake of ours must not look like a robot's answer.
            traceback.print_exc()
            raise CallRefusedError(f"mistake of the stand-in: {error!r}") from error


def as_json(value: object) -> str:
    """Any value of the wire as JSON text; bytes as their number."""

    def other(odd: object) -> object:
        return {"bytes": len(odd)} if isinstance(odd, bytes | bytearray) else str(odd)

    return json.dumps(value, default=other, ensure_ascii=False)
