"""A line to a robot behind a WebSocket, against a server that can freeze, refuse and hang up."""

from __future__ import annotations

import asyncio
import gc
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from typing import Any

import pytest
from aiohttp import web
from robot_simulators.web_robot import WebRobot
from woz_drivers.lines import web_socket_line
from woz_drivers.lines.web_socket_line import AnswerError, WebPlace, WebSocketLine

from woz_tui.drivers.contract import DeviceLostError, DriverError, Health
from woz_tui.testing import RecordingContext, until


class EchoRobot(WebRobot):
    """Says everything twice."""

    def routes(self) -> Sequence[web.AbstractRouteDef]:
        return (web.get("/events", self._events), web.post("/api/{what}", self._answer))

    async def _events(self, request: web.Request) -> web.StreamResponse:
        opened = None
        async for opened, message in self.messages(request):
            if message is not None:
                self.calls.append(("message", message))
                for _ in range(2):
                    await self.tell(opened, message)
        assert opened is not None
        return opened  # type: ignore[no-any-return]

    async def _answer(self, request: web.Request) -> web.Response:
        match request.match_info["what"]:
            case "empty":
                return web.Response()
            case "picture":
                return web.Response(body=b"\x89PNG")
            case "deep":
                return web.Response(body=b"[" * 5000)
        return web.json_response(await request.json())


class LineRig:
    """A line with everything that it reported."""

    def __init__(self, place: str) -> None:
        self.context = RecordingContext()
        self.place = place
        self.path = "/events"
        self.messages: list[Any] = []
        self.lost: list[str] = []
        self.refuses = ""
        self.line = WebSocketLine(
            self.context,
            "parrot",
            self._find,
            get_ready=self._get_ready,
            on_message=self._take,
            on_lost=lambda error: self.lost.append(error.what),
        )

    async def _find(self) -> WebPlace:
        return WebPlace(self.place, self.path)

    async def _get_ready(self) -> str:
        if self.refuses:
            raise DriverError(self.refuses, "ask it")
        await self.line.send({"hello": True})
        return "parrot 1.0"

    def _take(self, message: Any) -> None:
        if "hello" not in message and "word" not in message:
            raise ValueError("no word in it")
        self.messages.append(message)


@pytest.fixture
async def robot() -> AsyncIterator[EchoRobot]:
    async with EchoRobot() as robot:
        yield robot


@asynccontextmanager
async def connected_line(robot: EchoRobot) -> AsyncIterator[LineRig]:
    line_rig = LineRig(robot.address)
    line_rig.line.start()
    try:
        await until(lambda: line_rig.line.ready)
        yield line_rig
    finally:
        await line_rig.line.close()


@pytest.fixture
async def rig(robot: EchoRobot) -> AsyncIterator[LineRig]:
    async with connected_line(robot) as line_rig:
        yield line_rig


async def test_messages_go_both_ways_and_requests_are_answered(rig: LineRig) -> None:
    await rig.line.send({"word": "Lora"})
    await until(lambda: rig.messages.count({"word": "Lora"}) == 2)
    assert await rig.line.request("POST", "/api/echo", json={"a": 1}) == {"a": 1}
    assert await rig.line.request("POST", "/api/empty") is None
    await rig.line.probe()
    assert rig.context.healths[-1][:2] == (Health.CONNECTED, "parrot 1.0")


async def test_what_is_not_understood_is_reported_once_and_left_out(rig: LineRig) -> None:
    await rig.line.send({"nonsense": 1})
    await rig.line.send({"word": "still there"})
    await until(lambda: rig.messages.count({"word": "still there"}) == 2)
    assert len(rig.context.notices) == 1


async def test_refusals_and_odd_answers_are_errors_of_the_request_alone(
    robot: EchoRobot, rig: LineRig
) -> None:
    robot.faults.refused["/api/echo"] = "no voice today"
    with pytest.raises(AnswerError, match="no voice today"):
        await rig.line.request("POST", "/api/echo", json={})
    for odd in ("picture", "deep"):
        with pytest.raises(DriverError, match="JSON"):
            await rig.line.request("POST", f"/api/{odd}")
    assert rig.line.ready


@pytest.mark.parametrize("ends", ["drops", "closes"])
async def test_a_lost_robot_is_found_again(robot: EchoRobot, rig: LineRig, ends: str) -> None:
    if ends == "drops":
        robot.drop()
    else:
        await robot.close()
        await robot.start()
    await until(lambda: rig.lost != [])
    await until(lambda: rig.line.ready)
    states = [health for health, *_ in rig.context.healths]
    assert states[-1] is Health.CONNECTED
    assert Health.LOST in states


async def test_a_silent_robot_is_lost_and_what_is_under_way_ends(
    robot: EchoRobot, rig: LineRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web_socket_line, "_SILENCE_S", 0.2)
    monkeypatch.setattr(web_socket_line, "_PING_S", 0.02)
    robot.freeze()
    with pytest.raises(DeviceLostError):
        await rig.line.probe(within=20)
    await until(lambda: not rig.line.ready)
    with pytest.raises(DeviceLostError):
        await rig.line.send({"word": "late"})
    robot.thaw()
    await until(lambda: rig.line.ready)
    assert ("message", {"word": "late"}) not in robot.calls


async def test_who_refuses_to_get_ready_is_lost_with_its_reason(robot: EchoRobot) -> None:
    line_rig = LineRig(robot.address)
    line_rig.refuses = "wrong key"
    line_rig.line.start()
    await until(lambda: any(health[1] == "wrong key" for health in line_rig.context.healths))
    line_rig.refuses = ""
    await until(lambda: line_rig.line.ready)
    await line_rig.line.close()


async def test_a_robot_that_is_lost_while_it_refuses_leaves_no_error_behind(
    robot: EchoRobot,
) -> None:
    complaints: list[str] = []
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: complaints.append(context["message"]))
    await asyncio.create_task(lost_and_refusing(robot))
    await asyncio.sleep(0)
    gc.collect()
    assert complaints == []


async def lost_and_refusing(robot: EchoRobot) -> None:
    """A line whose reading and whose preparation fail in the same moment."""
    said = asyncio.Event()

    async def get_ready() -> str:
        await line.send({"word": "hello"})
        await said.wait()
        raise DriverError("not today")

    def take(message: object) -> None:
        said.set()
        raise DeviceLostError("it went away")

    async def find() -> WebPlace:
        return WebPlace(robot.address, "/events")

    context, lost = RecordingContext(), asyncio.Event()
    line = WebSocketLine(
        *(context, "parrot", find),
        get_ready=get_ready,
        on_message=take,
        on_lost=lambda error: lost.set(),
    )
    line.start()
    async with asyncio.timeout(10):
        await lost.wait()
    await line.close()


async def test_another_server_at_the_address_is_told_from_none(robot: EchoRobot) -> None:
    line_rig = LineRig(robot.address)
    line_rig.path = "/elsewhere"
    line_rig.line.start()
    await until(lambda: any("404" in health[1] for health in line_rig.context.healths))
    await robot.close()
    line_rig.path = "/events"
    await until(lambda: any("refused" in health[1] for health in line_rig.context.healths))
    await line_rig.line.close()
    assert not line_rig.line.ready


async def test_closing_leaves_no_task_behind(robot: EchoRobot) -> None:
    before = asyncio.all_tasks()
    async with connected_line(robot):
        pass
    await until(lambda: not robot.sockets)
    assert {task for task in asyncio.all_tasks() - before if "parrot" in task.get_name()} == set()


async def test_a_robot_that_takes_nothing_more_is_lost_and_found_again(
    robot: EchoRobot, rig: LineRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(web_socket_line, "_SEND_S", 0.05)
    monkeypatch.setattr(web_socket_line, "_SILENCE_S", 1000.0)
    robot.freeze()
    with pytest.raises(DeviceLostError):
        while True:
            await rig.line.send({"word": "x" * 1_000_000})
    await until(lambda: rig.lost != [])
    robot.thaw()
    await until(lambda: rig.line.ready)


async def test_it_is_not_ready_any_more_when_the_loss_is_told(robot: EchoRobot) -> None:
    line_rig = LineRig(robot.address)
    states: list[bool] = []
    line_rig.line._on_lost = lambda error: states.append(line_rig.line.ready)
    line_rig.line.start()
    await until(lambda: line_rig.line.ready)
    robot.drop()
    await until(lambda: states != [])
    await until(lambda: line_rig.line.ready)
    await line_rig.line.close()
    assert states == [False, False]
    assert not line_rig.line.ready
    with pytest.raises(DeviceLostError):
        line_rig.line.need()


async def test_a_slow_answer_to_a_probe_costs_no_connection(robot: EchoRobot, rig: LineRig) -> None:
    robot.freeze()
    with pytest.raises(DriverError) as raised:
        await rig.line.probe(within=0.05)
    assert not isinstance(raised.value, DeviceLostError)
    robot.thaw()
    await rig.line.probe()
    assert rig.lost == []


async def test_a_name_that_no_host_has_is_told_as_such() -> None:
    line_rig = LineRig("no-such-robot.invalid:80")
    line_rig.line.start()
    await until(lambda: any("no host" in health[1] for health in line_rig.context.healths))
    await line_rig.line.close()
