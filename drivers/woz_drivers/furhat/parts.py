"""What the parts of a Furhat's driver have in common: verbs, sensors, a share of the stop."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, ClassVar

from woz_drivers.furhat.link import FurhatLink
from woz_drivers.furhat.settings import FurhatSettings
from woz_tui.drivers.contract import DriverContext, Forecast, Job, RejectedError, Verb
from woz_tui.protocol.messages import Json


class FurhatPart:
    """One part. Made once a session, survives reconnections; by itself it offers nothing."""

    #: What the stop calls it; empty: it has nothing to stop.
    name: ClassVar[str] = ""

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        self._link = link
        self._settings = settings
        self._context = context

    @classmethod
    def verbs(cls, settings: FurhatSettings) -> tuple[Verb, ...]:
        """The verbs that it offers."""
        return ()

    @classmethod
    def sensors(cls, settings: FurhatSettings) -> tuple[str, ...]:
        """The sensors that it publishes."""
        return ()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """How one of its verbs would go; by itself nothing is known."""
        return Forecast()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out one of its verbs."""
        raise RejectedError(f"{self.name or 'this part'} cannot {job.verb}")

    def hold(self) -> None:
        """The stop, here: begin and send nothing more of what went on, also when it is back."""

    async def halt(self) -> list[asyncio.Future[Any]]:
        """The stop, there: send what ends it; returns what has to come before it has ended."""
        return []

    async def connected(self) -> None:
        """The robot is there, for the first time or again: apply what was asked for.

        Raises `DriverError` for what it did not take.
        """

    def lost(self) -> None:
        """The robot is gone."""

    def shown(self) -> Mapping[str, Json]:
        """Its settings by name, as far as they are known."""
        return {}

    async def close(self) -> None:
        """End what goes on. Never raises."""
