"""One connection to the session, as a console has it, on the loop of the server of pages."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from pathlib import Path

from woz_tui.console.link.host_connection import HostConnection
from woz_tui.console.link.message_feed import GONE, Incoming, Loss
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.requests import AskPicture, Reply, Request
from woz_tui.system.clock import Clock, RealClock

#: Seconds after which no reply is waited for any more.
_REPLY_S = 10.0


def raise_it(what: str, error: BaseException) -> None:
    """Where nobody is told what fails."""
    raise error


class SessionFollower:
    """Keeps a console's state, without a screen. It looks for a lost session by itself.

    Args:
        path: The session's socket.
        role: `watcher` or `participant`.
        explain: As for `HostConnection`.
        clock: The time against which messages age.
        heard: Is given each message, once the state has taken it.
        name: What the wizard's events call it.
        failed: Is told what has failed of it, and why; it goes on.
    """

    def __init__(
        self,
        path: Path,
        role: str,
        explain: Callable[[Loss], Loss] | None = None,
        clock: Clock | None = None,
        *,
        heard: Callable[[Incoming], None] = lambda message: None,
        name: str = "page",
        failed: Callable[[str, BaseException], None] = raise_it,
    ) -> None:
        self._heard, self._failed = heard, failed
        self.state = ConsoleState()
        #: Set whenever something is new; whoever waits for it clears it.
        self.news = asyncio.Event()
        self._clock = clock or RealClock()
        self._feed = HostConnection(
            path, role=role, name=name, explain=explain, clock=self._clock, unattended=True
        )
        self._waiting: dict[int, asyncio.Future[Reply | PictureShown]] = {}
        self._loop = asyncio.get_running_loop()

    @property
    def now(self) -> int:
        """This moment on the session's axis of time."""
        return self.state.now(self._clock.now_us())

    async def start(self) -> None:
        """Connect. Raises `ConnectionError`, in a sentence."""
        await asyncio.to_thread(self._feed.connect)
        self._feed.start(self._came, self._was_lost)

    def close(self) -> None:
        """Leave the session."""
        self._feed.close()

    async def ask(self, request: Request) -> Reply:
        """The session's answer; a refusal where none can come."""
        answer = await self._asked(request)
        return answer if isinstance(answer, Reply) else Reply(ref=0, ok=False, reason=GONE)

    async def picture(self, request: AskPicture) -> PictureShown | None:
        """A camera's picture; None: there is none."""
        answer = await self._asked(request)
        return answer if isinstance(answer, PictureShown) and answer.data else None

    async def _asked(self, request: Request) -> Reply | PictureShown:
        gone = Reply(ref=0, ok=False, reason=GONE)
        if self.state.lost or not self.state.welcomed:
            return gone
        ref = self._feed.ask(request)
        answer: asyncio.Future[Reply | PictureShown] = self._loop.create_future()
        self._waiting[ref] = answer
        try:
            async with asyncio.timeout(_REPLY_S):
                return await answer
        except TimeoutError:
            return gone
        finally:
            self._waiting.pop(ref, None)

    # -- from the connection's own thread -----------------------------------------------------

    def _came(self, batch: list[Incoming]) -> None:
        with contextlib.suppress(RuntimeError):  # the loop is closed: nobody reads any more
            self._loop.call_soon_threadsafe(self._work_in, batch)

    def _was_lost(self, loss: Loss) -> None:
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._lose, loss)

    # -- on the loop -----------------------------------------------------------------------------

    def _work_in(self, batch: list[Incoming]) -> None:
        try:
            self.state.apply(batch, self._clock.now_us())
        except Exception as error:  # noqa: BLE001 - a page without this news is better than none
            self._failed("following the session", error)
        for message in batch:
            if isinstance(message, Reply | PictureShown):
                self._answer(message.ref, message)
            self._heard(message)
        self.news.set()

    def _lose(self, loss: Loss) -> None:
        self.state.lose(loss)
        for ref in [*self._waiting]:
            self._answer(ref, Reply(ref=ref, ok=False, reason=GONE))
        self.news.set()

    def _answer(self, ref: int, reply: Reply | PictureShown) -> None:
        answer = self._waiting.get(ref)
        if answer is not None and not answer.done():
            answer.set_result(reply)
