"""A browser's window as a screen: on a monitor before the participant, or on a tablet."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_drivers.browser_screen import doctor
from woz_drivers.browser_screen.settings import BrowserScreenSettings
from woz_drivers.browser_screen.window import BrowserWindow, NobodyLooksError, NotPaintedError
from woz_tui.drivers import argument_values
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Probe,
    RejectedError,
    Verb,
)
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json
from woz_tui.system.tasks import end_tasks

#: Files that browsers show as pictures.
_PICTURES = frozenset({".png", ".jpg", ".jpeg", ".gif", ".svg", ".webp"})
#: Seconds from one try to listen to the next.
_AGAIN_S = 2.0


class BrowserScreen(PassiveDriver):
    """Shows pictures and words in a browser that has its page open.

    A command is done when the browser says that it has painted, with the milliseconds that this
    took by the page's own clock (`painted_ms`).
    """

    Settings = BrowserScreenSettings
    summary = "a browser's window as a screen for pictures and words"
    facts = DriverFacts(
        needs="a browser on a monitor or a tablet",
        page="drivers/woz_drivers/browser_screen/README.md",
        shown=("loss", "return"),
    )
    settings: BrowserScreenSettings

    def __init__(self, name: str, settings: BrowserScreenSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._window = BrowserWindow(settings, self._came, self._left)
        self._listening: asyncio.Task[None] | None = None
        self._closed = False

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """Pictures and words."""
        limit_s = settings.patience + 5.0
        text = Argument("text", "text", "what is to be read; empty: nothing", required=True)
        screen = common_verb("screen", "show a picture", limit_s=limit_s, evidence="reported")
        words = Verb(
            *("words", "show words in large letters", (text,)),
            lane="screen",
            limit_s=limit_s,
            evidence="reported",
        )
        return Offer(verbs=(screen, words))

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Whether a browser could be let in."""
        return [await asyncio.to_thread(doctor.examine, probe)]

    async def open(self) -> None:
        """Begin to listen."""
        self.context.health(Health.CONNECTING, f"will listen at {self.settings.listen}")
        self._listening = asyncio.create_task(self._listen())

    async def close(self) -> None:
        """Let the browser go."""
        self._closed = True
        await end_tasks(self._listening)
        await self._window.close()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Show it; returns when the browser has painted it."""
        sent: dict[str, Json] = dict(job.args)
        try:
            if job.verb == "words":
                took_ms = await self._window.show("words", argument_values.text(job.args, "text"))
            else:
                took_ms = await self._window.show("picture", file=self._picture(job.args))
        except NobodyLooksError:
            raise DeviceLostError("no browser shows it", self._remedy) from None
        except NotPaintedError as error:
            raise DriverError(str(error), "look at that browser: is its window in front?") from None
        return {**sent, "painted_ms": round(took_ms, 1)}

    def _picture(self, args: Mapping[str, Json]) -> Path:
        file = argument_values.file(args, "file", self.context.folder)
        if "://" in file:
            raise RejectedError("a page elsewhere is not shown", "show a picture of this computer")
        path = Path(file)
        if path.suffix.lower() not in _PICTURES:
            known = ", ".join(sorted(_PICTURES))
            raise RejectedError(f"{path.name} is no picture for a browser", f"there are {known}")
        return path

    # -- the browser ---------------------------------------------------------------------------

    @property
    def _remedy(self) -> str:
        return f"open {self._window.address} in it"

    async def _listen(self) -> None:
        while True:
            try:
                await self._window.listen()
            except OSError as error:
                what = f"{self.settings.listen}: {error.strerror or error}"
                self.context.health(Health.LOST, what, "give it another port (`listen`)")
                await self._window.close()
                await asyncio.sleep(_AGAIN_S)
            else:
                self.context.health(Health.CONNECTING, f"waits for a browser: {self._remedy}")
                return

    def _came(self, address: str) -> None:
        self.context.health(Health.CONNECTED, f"a browser on {address}")

    def _left(self) -> None:
        if not self._closed:
            self.context.health(Health.LOST, "the browser has gone", self._remedy)
