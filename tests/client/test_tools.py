"""Tools for programs that call by name: what is offered, and what comes of a call."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import jsonschema
import pytest

from tests.client.test_client import PATIENCE_S
from tests.host.rig import Served, served
from woz_tui.client import WozClient, WozRefusedError, connect
from woz_tui.client.tools import LOOK, PLAY, STOP, ToolCaller, tools_of
from woz_tui.protocol.description import ArgumentDescription, VerbDescription


@pytest.fixture
async def host(tmp_path: Path) -> AsyncIterator[Served]:
    async with served(tmp_path) as made:
        yield made


@pytest.fixture
async def woz(host: Served) -> AsyncIterator[WozClient]:
    async with connect(host.path, samples=True) as client:
        yield client


async def test_each_verb_of_the_robot_is_a_tool_and_none_releases_a_stop(woz: WozClient) -> None:
    tools = {tool.name: tool for tool in ToolCaller(woz).tools()}
    assert {"say", "play", PLAY, STOP, LOOK} <= tools.keys()
    assert not tools.keys() & {"release", "unlock", "lock", "set"}
    assert [name for name, tool in tools.items() if tool.only_looks] == [LOOK]
    for tool in tools.values():
        jsonschema.Draft202012Validator.check_schema({**tool.schema})
        assert tool.summary


async def test_a_call_returns_when_it_is_done(host: Served, woz: WozClient) -> None:
    caller = ToolCaller(woz)
    assert (await caller.call("say", {"text": "Hi"}))["sent"] == {"text": "Hi"}
    assert await caller.call(PLAY, {"action": "Hello"}) == {"done": True}
    assert [verb for verb, _ in host.puppet().calls].count("say") == 2
    with pytest.raises(WozRefusedError):
        await caller.call("release", {})


async def test_a_stop_holds_until_a_person_releases_it(host: Served, woz: WozClient) -> None:
    caller = ToolCaller(woz)
    following = asyncio.create_task(caller.follow())
    assert (await caller.call(STOP, {}))["confirmed"] == ["robot"]
    with pytest.raises(WozRefusedError, match="stop"):
        await caller.call("say", {"text": "Hi"})
    await _until_stopped(caller, True)
    host.session.release("key")
    await _until_stopped(caller, False)
    following.cancel()
    await asyncio.gather(following, return_exceptions=True)


async def _until_stopped(caller: ToolCaller, stopped: bool) -> None:
    async with asyncio.timeout(PATIENCE_S):
        while (await caller.call(LOOK, {}))["stopped"] is not stopped:  # noqa: ASYNC110 - by calls
            await asyncio.sleep(0.005)


def test_a_verb_of_several_drivers_is_one_tool_that_asks_which() -> None:
    text = ArgumentDescription(name="text", kind="text", type="string", required=True)
    level = ArgumentDescription(
        name="level", kind="number", type="number", low=0, high=1, default=0.5, unit="of full"
    )
    verbs = [
        VerbDescription(
            name="say", driver=driver, lane="speech", limit_s=60, arguments=[text, level]
        )
        for driver in ("left.voice", "right.voice")
    ]
    say = tools_of(verbs, [])[0].schema
    assert say["required"] == ["text", "driver"]
    assert say["properties"]["driver"]["enum"] == ["left.voice", "right.voice"]
    assert say["properties"]["level"]["maximum"] == 1
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"text": "Hi", "driver": "left.voice", "level": 2}, say)
