"""Whether the robot is alive: it is asked whenever nothing was heard of it."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Protocol

from woz_drivers.pepper.link import Gone, Said, Unanswered
from woz_tui.core.driver import Lost

#: A call is sent only if the robot was heard so lately, else it is asked first, in seconds: calls
#: made together ask once. What is sent in this time after a robot froze runs when it wakes.
FRESH_S = 0.02
#: For so long after something the wizard did the robot is asked this often, in seconds: what comes
#: next need not wait for an answer first.
ALERT_S, ALERT_BEAT_S = 2.0, 0.012
#: A question open for longer means: silent, nothing is sent, in seconds.
SILENT_S = 0.25
#: A question open for so long means: gone, in seconds; less with a lazy heartbeat, so that both
#: together stay below `KNOWN_S`.
ANSWER_S = 1.0
KNOWN_S = 1.9
#: If this process itself slept for so long, the answer may lie in its own socket, in seconds.
_OVERSLEPT_S = 0.1


class Asked(Protocol):
    """What is asked: a `Link`."""

    async def ask(self, within: float) -> None:
        """See `Link.ask`."""
        ...


class Pulse:
    """The life of one link, by the time of the event loop."""

    def __init__(self, link: Asked, heartbeat: float) -> None:
        self._link = link
        self._loop = asyncio.get_running_loop()
        self._heartbeat = heartbeat
        self._patience = min(ANSWER_S, KNOWN_S - heartbeat)
        self._heard = self._loop.time()
        self._question: asyncio.Task[None] | None = None
        self._asked = 0.0
        self._alert_until = 0.0
        #: Since when nothing was heard with a question open.
        self._unanswered: float | None = None

    @property
    def silent(self) -> bool:
        """Whether a question has been open for too long."""
        since = self._unanswered
        return since is not None and self._loop.time() - since > SILENT_S

    def heard(self) -> None:
        """Something came from the robot."""
        self._heard = self._loop.time()
        self._unanswered = None if self._question is None else self._heard

    def alert(self) -> None:
        """The wizard plays: be ready for the next key."""
        self._alert_until = self._loop.time() + ALERT_S

    @property
    def _beat(self) -> float:
        """How long the robot may be silent now before it is asked."""
        alert = self._loop.time() < self._alert_until
        return min(ALERT_BEAT_S, self._heartbeat) if alert else self._heartbeat

    async def until_dead(self) -> str:
        """Watch; returns why the robot counts as gone."""
        limit, overslept = self._heartbeat + self._patience, False
        while True:
            quiet = self._loop.time() - self._heard
            if (left := self._beat - quiet) > 0:
                await asyncio.sleep(left)
                continue
            try:
                # Less where it has answered something else since it was asked before.
                await asyncio.shield(self._ask(max(SILENT_S, min(self._patience, limit - quiet))))
            except Unanswered:
                if self._heard > self._asked:
                    continue
                if overslept or not self._has_overslept():
                    return f"the robot has not answered for {self._loop.time() - self._heard:.1f} s"
                overslept = True
            except Gone as gone:
                return str(gone)
            else:
                overslept = False

    async def fresh(self) -> None:
        """Return at once if the robot was heard just now, else when it answers a question.

        Raises `Lost` at once if it is silent, later if it stays so, or `Gone`.
        """
        if self._loop.time() - self._heard > FRESH_S:
            await self._answer_within(self._patience)

    async def ask(self) -> None:
        """Ask now; return on the answer. Raises `Lost` if it does not come at once, or `Gone`."""
        await self._answer_within(SILENT_S)

    async def _answer_within(self, seconds: float) -> None:
        if self.silent:
            raise _silent()
        try:
            # Not `wait_for`: until Python 3.12 a cancellation that comes together with the answer
            # is lost in it, and what a stop has just ended would be sent.
            async with asyncio.timeout(seconds):
                await asyncio.shield(self._ask(self._patience))
        except (TimeoutError, Unanswered):
            raise _silent() from None

    # -- the question --------------------------------------------------------------------------

    def _ask(self, patience: float) -> asyncio.Task[None]:
        """The open question, or a new one."""
        if self._question is None:
            self._asked = self._loop.time()
            if self._unanswered is None:
                self._unanswered = self._asked
            self._question = self._loop.create_task(self._asking(patience))
            self._question.add_done_callback(self._answered)
        return self._question

    async def _asking(self, patience: float) -> None:
        with contextlib.suppress(Said):  # that is an answer, too
            await self._link.ask(patience)
        self.heard()

    def _answered(self, question: asyncio.Task[None]) -> None:
        self._question = None
        # Its error is fetched here, where nobody may be waiting for it.
        if not question.cancelled() and question.exception() is None:
            self._unanswered = None

    def _has_overslept(self) -> bool:
        """Whether the answer may have come while this process did not run."""
        return self._loop.time() - self._asked - self._patience > _OVERSLEPT_S


def _silent() -> Lost:
    return Lost(
        "the robot does not answer at the moment; nothing was sent",
        "wait: it is asked all the time, and found again by itself",
    )
