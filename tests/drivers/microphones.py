"""Microphones for tests: opened on whatever a test sends, and closed at its end."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import Any

from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.sound import room_threshold

from tests.drivers.published_messages import BusJob, PublishedMessages, until
from woz_tui.protocol.messages import Json
from woz_tui.system.clock import Clock


class MicrophoneOpener:
    """Opens microphones that tell what they hear to a hub of their own."""

    def __init__(self, folder: Path, stack: AsyncExitStack) -> None:
        self._folder = folder
        self._stack = stack

    async def open(
        self, clock: Clock, name: str = "it", **settings: Any
    ) -> tuple[Microphone, PublishedMessages]:
        published = PublishedMessages(self._folder, clock)
        microphone_settings = MicrophoneSettings(**settings)
        assert microphone_settings.problems() == []
        microphone = Microphone(name, microphone_settings, published.context)
        self._stack.push_async_callback(microphone.close)
        await microphone.open()
        return microphone, published


@asynccontextmanager
async def microphone_opener(folder: Path) -> AsyncIterator[MicrophoneOpener]:
    async with AsyncExitStack() as stack:
        yield MicrophoneOpener(folder, stack)


async def learning(
    microphone: Microphone, seconds: float
) -> tuple[BusJob, asyncio.Future[Mapping[str, Json]]]:
    """It has begun to listen to the room."""
    job = BusJob(room_threshold.NAME, {"seconds": seconds})
    performing = asyncio.ensure_future(microphone.perform(job))
    await until(lambda: bool(job.announced))
    return job, performing
