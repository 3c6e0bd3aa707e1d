"""A driver that gets in the way of the robot process; found by entry point, as any other.

`rudeness` says how: see the code.
"""

from __future__ import annotations

import asyncio
import ctypes
import sys
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from woz_tui.drivers.contract import (
    Argument,
    DriverContext,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Verb,
)
from woz_tui.drivers.fields import Doc
from woz_tui.protocol.messages import Json

EXPERIMENT = """\
title: Rude
robot: {name: rude, drivers: {voice: {type: rude, process: shared, rudeness: "%s"}}}
panels:
  - title: Speech
    actions: [{key: h, label: Hello, say: "Hello"}]
"""


@dataclass(frozen=True, slots=True)
class RudeSettings:
    """How rude."""

    rudeness: Annotated[str, Doc("what it does wrong")] = ""


class Rude(PassiveDriver):
    """See the module's text."""

    Settings = RudeSettings
    summary = "for tests"

    def __init__(self, name: str, settings: RudeSettings, context: DriverContext) -> None:
        self._rudeness = settings.rudeness
        super().__init__(name, settings, context)
        if self._rudeness == "greets":
            sys.stdout.write("Hello from the community of a library!\n{}\n42\n")
        if self._rudeness == "raises":
            raise LookupError("no such thing")
        if self._rudeness == "exits":
            sys.exit(7)

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(
            verbs=(Verb("say", "", (Argument("text", "text", required=True),), lane="voice"),)
        )

    async def open(self) -> None:
        self.context.health(Health.CONNECTED, "rude")
        if self._rudeness == "talks on":
            threading.Thread(target=self._talk, daemon=True).start()

    def _talk(self) -> None:
        while True:
            self.context.reading("loudness", time.monotonic())
            self.context.notice("info", "still here")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        while self._rudeness == "deaf":
            try:
                await asyncio.sleep(3600)
            except asyncio.CancelledError:
                continue
        if self._rudeness == "blocks in say":
            time.sleep(3)  # noqa: ASYNC251 - that is the rudeness
        if self._rudeness == "keeps the interpreter":
            ctypes.PyDLL(None).usleep(1_500_000)
        if self._rudeness == "blocks in a timer":
            asyncio.get_running_loop().call_later(0.1, self._block)
        return {}

    def _block(self) -> None:
        time.sleep(1)

    async def close(self) -> None:
        if self._rudeness == "blocks":
            time.sleep(3600)  # noqa: ASYNC251 - that is the rudeness
        if self._rudeness == "leaves a thread":
            threading.Thread(target=time.sleep, args=(3600,)).start()


def installed(folder: Path, rudeness: str) -> Path:
    """An experiment with it; `folder` has to be on PYTHONPATH."""
    info = folder / "woz_rude-0.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: woz-rude\nVersion: 0.0\n")
    (info / "entry_points.txt").write_text(f"[woz_tui.drivers]\nrude = {__name__}:Rude\n")
    experiment = folder / "rude.yaml"
    experiment.write_text(EXPERIMENT % rudeness)
    return experiment
