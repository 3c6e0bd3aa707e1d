"""A driver that says when it was called, for `driver_process`."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from woz_tui.drivers.contract import Driver, Job, Offer, Scope, StopReport, Verb


@dataclass(frozen=True, slots=True)
class TimedSettings:
    """None."""


class Timed(Driver):
    """Does nothing; CLOCK_MONOTONIC of each call is in what it returns."""

    Settings = TimedSettings
    summary = "for a benchmark"

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """One, that is done at once; when it was stopped."""
        return Offer(verbs=(Verb("wave", "wave", lane="hand"),), sensors=("stopped",))

    async def perform(self, job: Job) -> Mapping[str, Any]:
        """When it began."""
        return {"ns": time.monotonic_ns()}

    async def stop(self, scope: Scope) -> StopReport | None:
        """When it was stopped is a reading."""
        self.context.reading("stopped", float(time.monotonic_ns()))
        return None
