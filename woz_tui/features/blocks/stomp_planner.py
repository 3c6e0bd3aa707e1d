"""A planner behind a message broker: its blocks are played, and it is told how it goes."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import quote_plus, unquote_plus

from woz_tui.bridge.stomp_connection import StompConnection, StompPlace, stay_connected
from woz_tui.client import WozClient
from woz_tui.features.blocks.realizer import BmlRealizer, Feedback


@dataclass(frozen=True, slots=True)
class PlannerTopics:
    """Where blocks come from and feedback goes to; as AsapRealizer has them."""

    request: str = "/topic/asap.bml.request"
    feedback: str = "/topic/asap.bml.feedback"


class StompPlanner:
    """Plays what comes over a broker until it is cancelled; connects again by itself.

    Args:
        client: The session.
        place: The broker.
        topics: Its topics.
        tell: Gets sentences for a person.
    """

    def __init__(
        self,
        client: WozClient,
        place: StompPlace,
        topics: PlannerTopics,
        tell: Callable[[str], None],
    ) -> None:
        self._place = place
        self._topics = topics
        self._tell_person = tell
        self._connection: StompConnection | None = None
        #: Whether the planner wraps its blocks in JSON: it is answered in the same way.
        self._wraps = False
        self._realizer = BmlRealizer(client, self._tell)

    async def run(self) -> None:
        """Serve. Raises `StompRefusedError` when the broker does not let us in, and
        `WozConnectionError` when the session has ended.
        """
        try:
            connected = stay_connected(self._place, self._serve, self._tell_person)
            await self._realizer.while_session_lasts(connected)
        finally:
            await self._realizer.close()

    async def _serve(self, connection: StompConnection) -> None:
        self._connection = connection
        connection.subscribe(self._topics.request)
        self._tell_person(f"connected to {self._place}; blocks come from {self._topics.request}")
        try:
            async for _, text in connection.messages():
                await self._realizer.perform(self._unwrapped(text))
        finally:
            self._connection = None

    def _unwrapped(self, text: str) -> str:
        """The block: as it is, or from `{"bml": {"content": ...}}`, which some planners send."""
        self._wraps = text.lstrip().startswith("{")
        if not self._wraps:
            return text
        try:
            return unquote_plus(str(json.loads(text)["bml"]["content"]))
        except (ValueError, KeyError, TypeError, RecursionError):
            return text  # it is refused as what it is

    def _tell(self, feedback: Feedback) -> None:
        """To the planner, if it is there: what happened in between is of no use to it later."""
        if self._connection is None:
            return
        text = feedback.xml()
        if self._wraps:
            text = json.dumps({"feedback": {"content": quote_plus(text)}})
        self._connection.send(self._topics.feedback, text)
