"""Our STOMP client, and a planner's blocks, over ActiveMQ and RabbitMQ."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from tests.bridge.rig import CATALOGUE, GENERAL, PREFIX, SEQUENCE, eyepi
from tests.fakes.ports import free_port
from tests.features.blocks.test_stomp_planner import BLOCK, TOPICS
from tests.host.rig import served_session
from tests.peers.places import place
from woz_tui.bridge.ros_data import RosValue, read_data, write_data
from woz_tui.bridge.stomp_bridge import StompBridge
from woz_tui.bridge.stomp_connection import (
    StompError,
    StompPlace,
    StompRefusedError,
    connect_stomp,
)
from woz_tui.client import connect
from woz_tui.features.blocks.stomp_planner import StompPlanner
from woz_tui.system.tasks import end_tasks
from woz_tui.testing import until

pytestmark = pytest.mark.peers

PATIENCE_S = 90.0
#: Ports in a row that a broker may take, see `.ci/peers`.
PORTS = 4


@dataclass
class Broker:
    """A broker of this name with its login, at a port of its own."""

    name: str
    folder: Path
    place: StompPlace
    process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, again at the same port; returns when it listens."""
        log = (self.folder / "output").open("ab")
        with log:
            self.process = subprocess.Popen(
                [place(self.name) / "run", str(self.place.port), str(self.folder)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        ends = time.monotonic() + PATIENCE_S
        while True:
            try:
                socket.create_connection((self.place.host, self.place.port)).close()
            except OSError:
                assert time.monotonic() < ends, (self.folder / "output").read_text()[-2000:]
                time.sleep(0.1)
            else:
                return

    def send_signal(self, number: signal.Signals) -> None:
        """To the broker with all that it started."""
        assert self.process is not None
        os.killpg(self.process.pid, number)

    def end(self, number: signal.Signals = signal.SIGKILL) -> None:
        """End it, by default without a goodbye."""
        if self.process is not None:
            with contextlib.suppress(ProcessLookupError):
                self.send_signal(number)
            self.process.wait(PATIENCE_S)


@pytest.fixture(scope="module", params=["activemq", "rabbitmq"])
def broker(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Broker]:
    name = request.param
    virtual_host = "/" if name == "rabbitmq" else ""
    there = StompPlace("127.0.0.1", free_port(PORTS), "planner", "secret", virtual_host)
    running = Broker(name, tmp_path_factory.mktemp(name), there)
    try:
        running.start()
        yield running
    finally:
        running.end()


async def test_texts_come_unharmed_and_as_texts(broker: Broker) -> None:
    one, other = await connect_stomp(broker.place), await connect_stomp(broker.place)
    one.subscribe("/topic/x")
    text = "<bml>h\u00e9llo : \\ \n end</bml>"
    messages = one.messages()
    received = asyncio.ensure_future(anext(messages))
    async with asyncio.timeout(PATIENCE_S):
        while not received.done():  # the subscription may come after the first
            other.send("/topic/x", text)
            await asyncio.wait([received], timeout=0.2)
    assert received.result() == ("/topic/x", text)
    await one.close()
    await other.close()


async def test_a_planner_plays_the_robot_and_does_so_again_when_its_broker_has_come_back(
    broker: Broker, tmp_path: Path
) -> None:
    sentences: list[str] = []
    async with served_session(tmp_path) as host, connect(host.path) as client:
        running = asyncio.create_task(
            StompPlanner(client, broker.place, TOPICS, sentences.append).run()
        )
        try:
            for number in (signal.SIGKILL, signal.SIGTERM):
                await _plays(f"before-{number}", broker.place)
                sentences.clear()
                await asyncio.to_thread(broker.end, number)
                await until(lambda: any("tried again" in each for each in sentences), PATIENCE_S)
                await asyncio.to_thread(broker.start)
                await until(lambda: sentences[-1].startswith("connected"), PATIENCE_S)
                await _plays(f"after-{number}", broker.place)
            assert running.done() is False
            assert {verb for verb, _ in host.driver().calls} == {"play"}
        finally:
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)


async def _plays(block: str, there: StompPlace) -> None:
    """Send a block until it is heard, and wait for its end."""
    planner = await connect_stomp(there)
    planner.subscribe(TOPICS.feedback)
    feedback, told = planner.messages(), ""
    async with asyncio.timeout(PATIENCE_S):
        heard = asyncio.ensure_future(anext(feedback))
        while not heard.done():
            planner.send(TOPICS.request, BLOCK.format(block))
            await asyncio.wait([heard], timeout=0.5)
        told = heard.result()[1]
        while f"{block}:end" not in told:
            told = (await anext(feedback))[1]
    await planner.close()


async def test_eyepis_own_planner_plays_the_robot(broker: Broker, tmp_path: Path) -> None:
    planner = await connect_stomp(broker.place)
    planner.subscribe(PREFIX + GENERAL)
    experiment, table = eyepi()
    async with (
        served_session(tmp_path, made=experiment, catalogue=CATALOGUE) as host,
        connect(host.path, name="bridge", samples=True) as client,
    ):
        bridge = asyncio.create_task(StompBridge(client, broker.place, table, print).run())
        answers = planner.messages()
        nod: dict[str, RosValue] = {
            "id": "nod",
            "sequence": 3,
            "request": 0.5,
            "requestType": 1,
            "requestCount": 1,
        }
        heard = []
        async with asyncio.timeout(PATIENCE_S):
            first = asyncio.ensure_future(anext(answers))
            while not first.done():  # the bridge's subscription may come after the first
                planner.send(PREFIX + SEQUENCE, write_data(nod))
                await asyncio.wait([first], timeout=2.0)
            text = first.result()[1]
            while read_data(text)["message"] != 3:
                heard.append(read_data(text)["message"])
                text = (await anext(answers))[1]
        assert heard == [1, 1, 2]  # acknowledged, begun, its stroke
        await end_tasks(bridge)
    await planner.close()


async def test_a_broker_that_freezes_is_told(broker: Broker) -> None:
    connection = await connect_stomp(broker.place)
    broker.send_signal(signal.SIGSTOP)
    try:
        with pytest.raises(StompError, match="silent"):
            async with asyncio.timeout(PATIENCE_S):
                await anext(connection.messages())
        await connection.close()
        with pytest.raises(StompError, match="does not answer"):
            await connect_stomp(broker.place)
    finally:
        broker.send_signal(signal.SIGCONT)


@pytest.mark.parametrize(("login", "passcode"), [("planner", "open sesame"), ("nobody", "secret")])
async def test_who_is_not_let_in_is_told_in_words(
    broker: Broker, login: str, passcode: str
) -> None:
    with pytest.raises(StompRefusedError, match=r"(?i)(user|password).*check the login") as caught:
        await connect_stomp(replace(broker.place, login=login, passcode=passcode))
    assert passcode not in str(caught.value)


async def test_a_virtual_host_that_the_broker_lacks_is_told(broker: Broker) -> None:
    if broker.name == "activemq":
        pytest.skip("ActiveMQ has no virtual hosts")
    with pytest.raises(StompRefusedError, match=r"Virtual host '127.0.0.1'.*/ in RabbitMQ"):
        await connect_stomp(replace(broker.place, virtual_host=""))
