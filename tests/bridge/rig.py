"""A broker, EyePi in a session without hardware, and the bridge between them."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from woz_drivers.simulated import SimulatedRobot

from tests.drivers.body.rig import SteppedBody
from tests.fakes.stomp_broker import StompBroker
from tests.host.rig import ServedSession, served_session
from woz_tui.bridge.ros_data import RosValue, read_data, write_data
from woz_tui.bridge.stomp_bridge import StompBridge
from woz_tui.bridge.stomp_connection import StompPlace
from woz_tui.bridge.topic_table import TopicTable, load_table
from woz_tui.client import connect
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver
from woz_tui.protocol import messages as m
from woz_tui.system.tasks import until_first_ends
from woz_tui.testing import until

PATIENCE_S = 40.0
EXPERIMENT = Path(__file__).parents[2] / "experiments" / "eyepi.yaml"
PREFIX = "/topic/ramsocialrobot_"
GENERAL, PREDICTION = "ram.asap.feedback.general", "ram.asap.feedback.prediction"
SEQUENCE = "ram.animation.hmmm.sequence"
CATALOGUE: Mapping[str, type[Driver]] = {"body": SteppedBody, "simulated": SimulatedRobot}


#: A test that waits looks at all that came again and again.
_read = functools.cache(read_data)


@functools.cache
def eyepi() -> tuple[Experiment, TopicTable]:
    """The robot and its topics, read once for all tests."""
    return load(EXPERIMENT, CATALOGUE), load_table("eyepi")


@dataclass
class Planner:
    """A planner of EyePi's: it speaks XML on topics."""

    broker: StompBroker
    host: ServedSession
    sentences: list[str] = field(default_factory=list)

    def send(self, topic: str, fields: Mapping[str, RosValue]) -> None:
        """A message on a topic, with dots."""
        self.send_text(topic, write_data(fields))

    def send_text(self, topic: str, text: str) -> None:
        """Any text on a topic, as ActiveMQ hands it on."""
        self.broker.publish(PREFIX + topic, text)

    def ask(
        self, ident: str, sequence: int, *, kind: int = 1, seconds: float = 0.3, count: int = 1
    ) -> None:
        """Ask for a sequence."""
        request = {"requestType": kind, "request": seconds, "requestCount": count}
        self.send(SEQUENCE, {"id": ident, "sequence": sequence, **request})

    def texts(self, topic: str) -> list[str]:
        """What came on a topic."""
        return self.broker.sent(PREFIX + topic)

    def messages_on(self, topic: str) -> list[dict[str, RosValue]]:
        """The messages that came on a topic."""
        return [_read(text) for text in self.texts(topic)]

    def general(self, ident: str) -> list[tuple[RosValue, RosValue, RosValue]]:
        """Type, message and reason of all feedback about an id."""
        return [
            (each["type"], each["message"], each["reason"])
            for each in self.messages_on(GENERAL)
            if each["id"] == ident
        ]

    async def until(self, holds: Callable[[], bool]) -> None:
        """Wait for it."""
        await until(holds, PATIENCE_S)

    async def sequence_ended(self, ident: str) -> None:
        """Until a sequence has ended."""
        await self.until(lambda: (2, 3, 0) in self.general(ident))

    def commands(self, *verbs: str) -> list[m.Command]:
        """What was asked of the robot."""
        lines = self.host.of(m.Command)
        return [line for line in lines if not verbs or line.verb in verbs]


@contextlib.asynccontextmanager
async def late_line(session: Path, folder: Path, seconds: float) -> AsyncIterator[Path]:
    """A socket that leads to the session: what is asked there arrives so much later."""

    async def carry(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, by: float) -> None:
        while data := await reader.read(1 << 16):
            await asyncio.sleep(by)
            writer.write(data)

    async def join(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        answers, asks = await asyncio.open_unix_connection(session)
        await until_first_ends(carry(reader, asks, seconds), carry(answers, writer, 0.0))
        asks.close()
        writer.close()

    path = folder / "late.sock"
    async with await asyncio.start_unix_server(join, path):
        yield path


@contextlib.asynccontextmanager
async def bridged(tmp_path: Path, *, late_s: float = 0.0) -> AsyncIterator[Planner]:
    """The robot and its planner, until the block ends; `late_s`: so long the session hears nothing
    of what the bridge asks.
    """
    experiment, table = eyepi()
    async with (
        StompBroker() as broker,
        served_session(tmp_path, made=experiment, catalogue=CATALOGUE) as host,
        late_line(host.path, tmp_path, late_s) as line,
        connect(line, name="bridge", samples=True) as client,
    ):
        planner = Planner(broker, host)
        place = StompPlace("127.0.0.1", broker.port)
        bridge = StompBridge(client, place, table, planner.sentences.append)
        running = asyncio.create_task(bridge.run())
        try:
            await planner.until(lambda: broker.subscribed)
            yield planner
        finally:
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)
