"""The bridge between a broker and a robot's topics, as planners of Twente's university know it.

Source of names and answers: `relay` and `docs/protocol.rst` of HmiRoboUtils in the repository
ArticulatedSocialAgentsPlatform/UTRobotics. There a relay begins when it is asked for; here every
topic of the table is relayed from the beginning, so a planner goes on when the bridge was away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from xml.etree import ElementTree as Xml

from woz_tui.bridge.ros_data import (
    RosDataError,
    RosType,
    RosValue,
    add_fields,
    empty,
    parse_element,
    read_data,
    write_data,
)
from woz_tui.bridge.stomp_connection import StompConnection, StompPlace, stay_connected
from woz_tui.bridge.topic_player import TopicPlayer
from woz_tui.bridge.topic_table import TopicTable
from woz_tui.client import WozClient
from woz_tui.system.tasks import until_first_ends

_PREFIX = "/topic/"
_CONFIG, _STATUS = "bridge_config", "bridge_status"
_INFO, _SERVICE = "bridge_info", "bridge_service"
#: Who a planner says sends a topic's messages: planners (the broker's side), or the robot.
_PLANNER, _ROBOT = "apollo", "ros"
#: So many of the requests in one message are answered.
_MOST_REQUESTS = 100
#: The same sentence is told again only after so many seconds.
_AGAIN_S = 10.0
#: More different ones than this are not told in that time.
_MOST_SENTENCES = 20


class BridgeControl:
    """What a planner asks the bridge itself: relays, types of messages, services."""

    def __init__(self, table: TopicTable) -> None:
        self._table = table

    def answers(self, topic: str, text: str) -> Iterator[tuple[str, str]]:
        """Topics (without prefix and bridge) and texts of the answers to a message."""
        status = Xml.Element("status")
        kind = topic.removeprefix("bridge_")
        answer = Xml.Element(kind)
        try:
            root = parse_element(text)
            if root.tag != kind:
                raise RosDataError(f"expected <{kind}>, not <{str(root.tag)[:40]}>")
            if topic == _CONFIG:
                for relay in islice(root.iterfind("relay"), _MOST_REQUESTS):
                    self._relay(relay, status)
            elif topic == _INFO:
                for request in islice(root.iterfind("request"), _MOST_REQUESTS):
                    self._inform(request, answer, status)
            else:
                for request in islice(root.iterfind("request"), _MOST_REQUESTS):
                    name = request.get("name", "")
                    _error(status, f"this robot has no service {name[:80]!r}")
        except RosDataError as error:
            _error(status, str(error))
        if len(answer):
            yield topic, Xml.tostring(answer, "unicode")
        if len(status):
            yield _STATUS, Xml.tostring(status, "unicode")

    def _relay(self, relay: Xml.Element, status: Xml.Element) -> None:
        publisher, name = relay.get("publisher"), relay.get("name")
        if publisher is None or name is None:
            _error(status, "a relay needs a publisher and a name")
            return
        told = Xml.SubElement(status, "relay", {"publisher": publisher, "name": name})
        sides = {_PLANNER: {*self._table.takes}, _ROBOT: {*self._table.answers}}
        side = sides.get(publisher.lower())
        told.text = "ok" if side is not None and name.strip("/") in side else "failed"
        if side is None:
            _error(status, f"the publisher is {_ROBOT} or {_PLANNER}, not {publisher[:40]!r}")
        elif told.text == "failed":
            _error(status, f"{publisher} sends no topic {name[:80]!r} here")

    def _inform(self, request: Xml.Element, answer: Xml.Element, status: Xml.Element) -> None:
        kind, name = request.get("type", "").lower(), request.get("name", "")
        topics: dict[str, Mapping[str, RosType]] = {
            **{topic: entry.fields for topic, entry in self._table.takes.items()},
            **{topic: entry.types for topic, entry in self._table.answers.items()},
        }
        if kind == "list-pubs-subs-services":
            response = Xml.SubElement(answer, "response", {"type": kind})
            for tag, side in (("pub-topic", self._table.answers), ("sub-topic", self._table.takes)):
                for topic in side:
                    Xml.SubElement(response, tag, {"isrelayed": "True"}).text = f"/{topic}"
        elif kind == "msg-structure" and name.strip("/") in topics:
            response = Xml.SubElement(answer, "response", {"type": kind, "name": name})
            fields = topics[name.strip("/")]
            add_fields(response, {field: empty(each) for field, each in fields.items()})
        elif kind == "msg-structure":
            _error(status, f"nothing is known of the topic {name[:80]!r}")
        elif kind == "srv-structure":
            _error(status, f"this robot has no service {name[:80]!r}")
        else:
            _error(status, f"unknown type of request {kind[:40]!r}")


def _error(status: Xml.Element, text: str) -> None:
    Xml.SubElement(status, "error").text = text


class StompBridge:
    """Plays what planners say on the topics of a table until it is cancelled; connects again by
    itself.

    Args:
        client: The session.
        place: The broker.
        table: The topics.
        tell: Gets sentences for a person.
    """

    def __init__(
        self,
        client: WozClient,
        place: StompPlace,
        table: TopicTable,
        tell: Callable[[str], None],
    ) -> None:
        self._client = client
        self._place = place
        self._table = table
        self._tell_person = tell
        self._control = BridgeControl(table)
        self._player = TopicPlayer(client, table, self._answer, self._complain)
        self._connection: StompConnection | None = None
        self._prefix = _PREFIX + (f"{table.bridge}_" if table.bridge else "")
        self._topics = {topic.replace("/", "."): topic for topic in table.takes}
        #: When each sentence was told last; how many were not since then.
        self._complaints: dict[str, float] = {}
        self._untold = 0

    async def run(self) -> None:
        """Serve until the session ends. Raises `StompRefusedError` when the broker does not let us
        in, `WozConnectionError` when the session is lost.
        """
        await until_first_ends(
            self._player.run(), stay_connected(self._place, self._serve, self._tell_person)
        )

    async def _serve(self, connection: StompConnection) -> None:
        self._connection = connection
        for topic in (*self._topics, _CONFIG, _INFO, _SERVICE):
            connection.subscribe(self._prefix + topic)
        self._tell_person(
            f"connected to {self._place}; {len(self._topics)} topics from {self._prefix}*"
        )
        try:
            async for destination, text in connection.messages():
                await self._take(destination.removeprefix(self._prefix), text)
        finally:
            self._connection = None

    async def _take(self, name: str, text: str) -> None:
        topic = self._topics.get(name)
        if topic is None:
            for to, answer in self._control.answers(name, text):
                self._send(to, answer)
            return
        try:
            await self._player.take(topic, read_data(text))
        except RosDataError as error:
            self._complain(f"{topic}: {error}")

    def _answer(self, topic: str, fields: Mapping[str, RosValue]) -> None:
        self._send(topic.replace("/", "."), write_data(fields))

    def _complain(self, sentence: str) -> None:
        """To the person here and to the planner, unless that was just said."""
        now = self._client.now()
        self._complaints = {
            text: told for text, told in self._complaints.items() if now - told < _AGAIN_S
        }
        if sentence in self._complaints:
            return
        if len(self._complaints) >= _MOST_SENTENCES:
            self._untold += 1
            return
        self._complaints[sentence] = now
        if self._untold:
            sentence, self._untold = f"{sentence} ({self._untold} more before)", 0
        self._tell_person(sentence)
        status = Xml.Element("status")
        _error(status, sentence)
        self._send(_STATUS, Xml.tostring(status, "unicode"))

    def _send(self, name: str, text: str) -> None:
        """To the planner, if it is there: what happened in between is of no use to it later."""
        if self._connection is not None:
            self._connection.send(self._prefix + name, text)
