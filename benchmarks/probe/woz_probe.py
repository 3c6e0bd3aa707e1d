"""A driver that does nothing but write down when it was called.

It is found like any other driver, by entry point, with this folder on PYTHONPATH. Each call of
`perform` and `stop` appends one line to the journal: nanoseconds of CLOCK_MONOTONIC, then what was
called. With `load` it also publishes what the busiest sensors would: six readings at 30 Hz and 300
log lines a second.
"""

from __future__ import annotations

import asyncio
import math
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

from woz_tui.drivers.contract import (
    Argument,
    Driver,
    DriverContext,
    Health,
    Job,
    Offer,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Doc
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.protocol.messages import Json

READINGS_HZ = 30
FRAMES_HZ = 32
LINES_EACH = 10


@dataclass(frozen=True, slots=True)
class ProbeSettings:
    """Where to write, and whether to be busy."""

    journal: Annotated[str, Doc("file for the calls")]
    load: Annotated[bool, Doc("publish as much as the busiest sensors")] = False


class Probe(Driver):
    """See the module's text."""

    Settings: ClassVar[type] = ProbeSettings
    summary = "writes down when it is called"

    def __init__(self, name: str, settings: ProbeSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._journal = os.open(settings.journal, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        self._task: asyncio.Task[None] | None = None

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return replace(
            super().offer(settings),
            verbs=(
                Verb(
                    "say", "note a call", (Argument("text", "text", required=True),), lane="voice"
                ),
            ),
        )

    def _note(self, what: str) -> None:
        os.write(self._journal, f"{time.monotonic_ns()} {what}\n".encode())

    async def open(self) -> None:
        self.context.health(Health.CONNECTED, "probe")
        if self.settings.load:
            self._task = asyncio.create_task(self._busy())

    async def _busy(self) -> None:
        loop = asyncio.get_running_loop()
        due = loop.time()
        count = 0
        while True:
            phase = count / READINGS_HZ
            self.context.reading("distance", 1.5 + math.sin(phase), unit="m")
            self.context.reading("loudness", abs(math.sin(5 * phase)) / 10)
            self.context.reading("presence", float(count % 3 > 0))
            self.context.reading("gaze", float(count % 2))
            self.context.reading("joint.pan", 90 * math.sin(phase), unit="deg")
            self.context.reading("joint.tilt", 30 * math.cos(phase), unit="deg")
            for line in range(LINES_EACH):
                self.context.notice("info", f"line {count}.{line}")
            count += 1
            due += 1 / READINGS_HZ
            await asyncio.sleep(max(0.0, due - loop.time()))

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self._note(f"perform {job.args['text']}")
        return dict(job.args)

    async def stop(self, scope: Scope) -> None:
        self._note(f"stop {scope.value}")

    async def close(self) -> None:
        if self._task is not None:
            self._task.cancel()
        os.close(self._journal)


@dataclass(frozen=True, slots=True)
class EyeSettings:
    """No settings."""


class Eye(Probe):
    """A camera that claims to see something that wanders to and fro, 32 times a second."""

    Settings: ClassVar[type] = EyeSettings
    summary = "claims to see something"

    def __init__(self, name: str, settings: EyeSettings, context: DriverContext) -> None:
        self._context = context
        self._task: asyncio.Task[None] | None = None

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return replace(super().offer(settings), verbs=())

    async def open(self) -> None:
        self._context.health(Health.CONNECTED, "sees")
        self._task = asyncio.create_task(self._look())

    async def _look(self) -> None:
        loop, feed, frame = asyncio.get_running_loop(), self._context.feed(SEEN), 0
        due = loop.time()
        while True:
            frame += 1
            x = 0.6 * math.sin(frame / FRAMES_HZ)
            feed.put(Sighting(time.monotonic_ns() // 1000, frame, x, 0.0, 0.05))
            due += 1 / FRAMES_HZ
            await asyncio.sleep(max(0.0, due - loop.time()))

    async def stop(self, scope: Scope) -> None:
        return None

    async def close(self) -> None:
        if self._task is not None:
            self._task.cancel()
