"""A light of moods: it looks at a body's face and has the lamp glow in the colour of it."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import dataclass
from typing import Annotated

from woz_tui.drivers.contract import Ask, DriverContext, Health, PassiveDriver, Scope
from woz_tui.drivers.fields import Doc, Sibling

COLORS = {"happy": "#ffd000", "sad": "#0040ff", "angry": "#ff0000", "sleepy": "#201008"}
LOOK_S = 0.1


@dataclass(frozen=True, slots=True)
class MoodSettings:
    """Two other drivers of the same robot."""

    follows: Annotated[str, Sibling(), Doc("the body whose face it looks at")]
    lamp: Annotated[str, Sibling(), Doc("the lamp that glows")]


class Mood(PassiveDriver):
    """Has no hardware: it reads one driver and asks for another."""

    Settings = MoodSettings
    summary = "has a lamp glow as a body feels"
    settings: MoodSettings

    def __init__(self, name: str, settings: MoodSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._state = context.feed("state", of=settings.follows)
        self._task: asyncio.Task[None] | None = None
        self._still = False

    async def open(self) -> None:
        """Begin to look."""
        self.context.health(Health.CONNECTED, "looks at the body's face")
        self._task = asyncio.get_running_loop().create_task(self._look())

    async def _look(self) -> None:
        seen, shown = 0, ""
        while True:
            await asyncio.sleep(LOOK_S)
            latest = self._state.latest()
            if self._still or latest.serial == seen:
                continue
            seen = latest.serial
            color = COLORS.get(latest.value.emotion, "#ffffff")
            if color != shown:
                shown = color
                self.context.ask(
                    Ask("verb", "glow", {"color": color}, on=self.settings.lamp), self._told
                )

    def _told(self, carried: bool, why: str) -> None:
        if not carried:
            self.context.notice("warning", f"the lamp does not follow: {why}")

    async def stop(self, scope: Scope) -> None:
        """Ask for nothing more until the stop is released."""
        self._still = self._still or scope is Scope.ALL

    async def resume(self) -> None:
        """Look again."""
        self._still = False

    async def close(self) -> None:
        """End looking."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
