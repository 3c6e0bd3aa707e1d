"""A planner that connects by TCP: its blocks are played, and it is told how it goes.

Source of the two connections: AsapRealizer's TCP adapters. The planner connects to the request port
and sends blocks, one behind the other; the realizer connects to the feedback port of the planner's
machine, and sends feedback there, one element a line.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass

from woz_tui.bridge.xml_elements import XmlElements, XmlElementsError
from woz_tui.client import WozClient
from woz_tui.features.blocks.realizer import BmlRealizer, Feedback
from woz_tui.system.retry_pauses import RetryPauses

#: Without encryption, so for this machine alone.
_HERE = "127.0.0.1"
#: Planners that wait while another one is connected; more are sent away.
_MOST_WAITING = 4
#: A planner opens its feedback port when it has connected, so that it may take some time: seconds.
_FEEDBACK_S = 5.0
#: Feedback that a planner has not read; with more it is left, in bytes.
_MOST_UNREAD = 1 << 20


class PlannerPortError(Exception):
    """Nobody can connect; the text says why."""


@dataclass(frozen=True, slots=True)
class PlannerPorts:
    """The port that planners connect to, and the one that they listen on for feedback; as
    AsapRealizer has them.
    """

    request: int = 7500
    feedback: int = 7501


class TcpPlanner:
    """Plays what comes by TCP from this machine until it is cancelled; one planner at a time, the
    next one waits.

    Args:
        client: The session.
        ports: Where.
        tell: Gets sentences for a person.
    """

    def __init__(self, client: WozClient, ports: PlannerPorts, tell: Callable[[str], None]) -> None:
        self._ports = ports
        self._tell_person = tell
        self._arrived = asyncio.Queue[tuple[asyncio.StreamReader, asyncio.StreamWriter]](
            _MOST_WAITING
        )
        self._realizer = BmlRealizer(client)

    async def run(self) -> None:
        """Serve. Raises `PlannerPortError`, and `WozConnectionError` when the session has ended."""
        ports = self._ports
        try:
            server = await asyncio.start_server(self._arrive, _HERE, ports.request)
        except OSError as error:
            raise PlannerPortError(
                f"cannot listen on {_HERE}:{ports.request}: {error.strerror or error}"
            ) from None
        self._tell_person(
            f"planners connect to {_HERE}:{server.sockets[0].getsockname()[1]}, and get feedback at"
            f" their port {ports.feedback}"
        )
        try:
            await self._realizer.while_session_lasts(self._serve_all())
        finally:
            server.close()
            await self._realizer.close()

    async def _serve_all(self) -> None:
        while True:
            await self._serve(*await self._arrived.get())

    def _arrive(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            self._arrived.put_nowait((reader, writer))
        except asyncio.QueueFull:
            writer.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._tell_person("a planner has connected")
        feedback = None
        try:
            feedback = _FeedbackLine(await self._feedback_connection(), self._tell_person)
            await self._play(reader, feedback.tell)
        except OSError:
            pass  # it has gone
        finally:
            self._tell_person("the planner has gone")
            writer.close()
            if feedback is not None:
                feedback.close()

    async def _play(self, reader: asyncio.StreamReader, tell: Callable[[Feedback], None]) -> None:
        """What comes, until it ends or is no XML."""
        elements = XmlElements()
        try:
            while data := await reader.read(1 << 16):
                for block in elements.feed(data):
                    await self._realizer.perform(block.decode("utf-8", "replace"), tell)
        except XmlElementsError as error:
            tell(Feedback("warningFeedback", {"id": "bml", "type": "PARSING_FAILURE"}, str(error)))

    async def _feedback_connection(self) -> asyncio.StreamWriter | None:
        """For feedback; None, after saying so, if the planner does not listen for it."""
        pauses = RetryPauses()
        try:
            async with asyncio.timeout(_FEEDBACK_S):
                while True:
                    try:
                        return (await asyncio.open_connection(_HERE, self._ports.feedback))[1]
                    except OSError:
                        await asyncio.sleep(pauses.after(False))
        except TimeoutError:
            self._tell_person(
                f"it does not listen on port {self._ports.feedback}: its blocks are played, and it"
                " gets no feedback"
            )
            return None


class _FeedbackLine:
    """To one planner. What its blocks do after it has gone is told to nobody: the next planner has
    blocks of its own, perhaps with the same ids.
    """

    def __init__(
        self, writer: asyncio.StreamWriter | None, tell_person: Callable[[str], None]
    ) -> None:
        self._writer = writer
        self._tell_person = tell_person

    def tell(self, feedback: Feedback) -> None:
        """Send it, if the planner is there and reads."""
        if self._writer is None:
            return
        if self._writer.transport.get_write_buffer_size() > _MOST_UNREAD:
            self._writer.transport.abort()
            self._writer = None
            self._tell_person("the planner does not read its feedback: it gets no more")
            return
        self._writer.write(feedback.xml().encode() + b"\n")

    def close(self) -> None:
        if self._writer is not None:
            self._writer.close()
            self._writer = None
