"""The body of a session that is under way: an edit plays there as any move does, under its stop."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

from woz_tui.client import WozClient, WozError, WozRefusedError, WozRun, connect
from woz_tui.console.link.stop_line import StopLine
from woz_tui.protocol import messages as m

#: The verb that plays a move which no file has.
VERB = "play_move"


class SessionBody:
    """One connection to a session.

    Args:
        session: Its code or its socket's path; empty: the only one.
        body: The body that is edited on; the session's is called so, or it has only one.
        tell: Tells what happens there, in a sentence.
        stop_line: Is told where the session is, as long as it is there.
    """

    def __init__(
        self, session: str, body: str, tell: Callable[[str], None], stop_line: StopLine
    ) -> None:
        self._session, self._body, self._tell = session, body, tell
        self._stop_line = stop_line
        self._client: WozClient | None = None
        self._driver = ""
        self._run: WozRun | None = None
        #: Whether the session's stop is pressed.
        self.stopped = False

    async def follow(self) -> None:
        """Stay connected, and tell of the stop, until cancelled or the session ends."""
        try:
            async with connect(self._session, name="edit-move") as client:
                self._driver = body_of(client, self._body)
                self._client = client
                self._stop_line.path = client.path
                self._tell(f"P plays on {self._driver}, escape is its session's stop")
                stops = client.messages(m.StopPressed, m.StopConfirmed, m.StopReleased, held=True)
                try:
                    async for message in stops:
                        self._hear(message)
                finally:
                    await self._leave()
            self._tell("the session has ended")
        except WozError as error:
            self._tell(f"no body to play on: {error}")
        finally:
            self._client = self._stop_line.path = None

    def _hear(self, message: m.Message) -> None:
        match message:
            case m.StopPressed():
                self.stopped = True
                self._tell("stop: R releases it")
            case m.StopConfirmed(confirmed=confirmed, missing=missing):
                late = f", NOT by {', '.join(missing)}" if missing else ""
                self._tell(f"stopped, confirmed by {', '.join(confirmed)}{late}: R releases it")
            case m.StopReleased():
                self.stopped = False
                self._tell("the stop is released")

    async def _leave(self) -> None:
        """What plays there ends with the editor."""
        if self._run is not None and self._run.end is None:
            with contextlib.suppress(WozError, TimeoutError):
                async with asyncio.timeout(1.0):
                    await self._run.cancel()

    async def play(self, text: str) -> None:
        """Play a move, given as the text of its file, in the place of one that plays."""
        if self._client is None:
            self._tell("the session is not there")
            return
        try:
            self._run = run = await self._client.begin(
                VERB, {"move": text}, driver=self._driver, when_busy="replace"
            )
            self._tell(f"plays on {self._driver}")
            await run
            self._tell(f"{self._driver} has played it")
        except WozError as error:
            self._tell(f"{self._driver}: {error}")

    async def stop(self) -> None:
        """Press the session's stop, where the stop line could not; what became of it is told as it
        comes.
        """
        if self._client is None:
            self._tell("the session is not there: its console has the stop")
            return
        try:
            await self._client.stop()
        except WozError as error:
            self._tell(f"the stop may not have come: {error}")

    async def release(self) -> None:
        """Release it, where all have confirmed it."""
        if self._client is not None:
            try:
                await self._client.release()
            except WozError as error:
                self._tell(str(error))


def body_of(client: WozClient, body: str) -> str:
    """The driver of the session that plays moves. Raises `WozRefusedError`."""
    drivers = [view.driver for view in client.description.verbs if view.name == VERB]
    named = [driver for driver in drivers if driver == body]
    if not named and len(drivers) == 1:
        named = drivers
    if not named:
        known = ", ".join(drivers) or "none"
        raise WozRefusedError(f"the session has no body called {body!r}", f"it has {known}: --body")
    return named[0]
