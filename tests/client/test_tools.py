"""Tools for programs that call by name: what is offered, and what comes of a call."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.client.test_client import PATIENCE_S
from tests.example_counts import many
from tests.host.rig import ServedSession, served_session
from woz_tui.client import WozClient, WozError, WozRefusedError, connect
from woz_tui.client.tools import LOOK, PLAY, STOP, ToolCaller, tools_of
from woz_tui.protocol import messages as m
from woz_tui.protocol.description import ArgumentDescription, VerbDescription
from woz_tui.protocol.messages import Json


@pytest.fixture
async def host(tmp_path: Path) -> AsyncIterator[ServedSession]:
    async with served_session(tmp_path) as served_host:
        yield served_host


@pytest.fixture
async def woz(host: ServedSession) -> AsyncIterator[WozClient]:
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


async def test_a_call_returns_when_it_is_done(host: ServedSession, woz: WozClient) -> None:
    caller = ToolCaller(woz)
    assert (await caller.call("say", {"text": "Hi"}))["sent"] == {"text": "Hi"}
    assert await caller.call(PLAY, {"action": "Hello"}) == {"done": True}
    with pytest.raises(WozRefusedError, match="action"):
        await caller.call(PLAY, {"name": "Hello"})
    assert [verb for verb, _ in host.driver().calls].count("say") == 2
    with pytest.raises(WozRefusedError):
        await caller.call("release", {})


@pytest.mark.parametrize(
    ("name", "args"),
    [
        ("set", {}),
        ("lock", {"panel": "P"}),
        ("unlock", {"panel": "P"}),
        ("say", {"text": "Hi", "driver": "session"}),
        ("say", {"text": "Hi", "driver": "nobody"}),
        ("release", {}),
        ("", {}),
    ],
)
async def test_what_is_no_tool_cannot_be_called_by_name(
    host: ServedSession, woz: WozClient, name: str, args: dict[str, Any]
) -> None:
    """The session's own verbs are the wizard's."""
    with pytest.raises(WozRefusedError, match="no tool"):
        await ToolCaller(woz).call(name, args)
    assert not host.of(m.Command)


#: What a program may send as JSON.
_JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=50),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=9), inner, max_size=4)
    ),
    max_leaves=20,
)
_CALLS = st.lists(
    st.tuples(
        st.sampled_from(["say", "play", PLAY, "set", "release", "__class__"])
        | st.text(max_size=20),
        st.dictionaries(st.sampled_from(["nonsense", "driver", "move", "at"]), _JSON, min_size=1),
    ),
    min_size=20,
    max_size=20,
)


@settings(max_examples=many(5, 100))
@given(calls=_CALLS)
def test_hostile_calls_are_refused_and_the_session_plays_on(
    calls: list[tuple[str, dict[str, Any]]],
) -> None:
    async def run() -> None:
        with tempfile.TemporaryDirectory() as folder:
            async with served_session(Path(folder)) as host, connect(host.path) as woz:
                caller = ToolCaller(woz)
                for name, args in calls:
                    if name not in (STOP, LOOK):
                        with pytest.raises(WozError):
                            await caller.call(name, {"nonsense": 1, **args})
                assert not host.driver().calls
                assert (await caller.call("say", {"text": "Hi"}))["done"]

    asyncio.run(run())


async def test_a_stop_holds_until_a_person_releases_it(host: ServedSession, woz: WozClient) -> None:
    caller = ToolCaller(woz)
    following = asyncio.create_task(caller.follow())
    host.session.bus.halt_driving("nobody watches")  # it holds nothing
    engagement_changed = m.EngagementChanged(
        was="x", now="Present", outcome="", why="", verdicts={}
    )
    host.session.hub.publish(engagement_changed)
    await _until(caller, "engagement", "Present")
    assert not (await caller.call(LOOK, {}))["stopped"]
    assert (await caller.call(STOP, {}))["confirmed"] == ["robot"]
    with pytest.raises(WozRefusedError, match="stop"):
        await caller.call("say", {"text": "Hi"})
    await _until(caller, "stopped", True)
    host.session.release("key")
    await _until(caller, "stopped", False)
    following.cancel()
    await asyncio.gather(following, return_exceptions=True)


async def test_readings_are_texts_or_numbers(host: ServedSession, woz: WozClient) -> None:
    caller = ToolCaller(woz)
    following = asyncio.create_task(caller.follow())
    for sensor, value, text in (
        ("mood", None, "calm"),
        ("identity", 0.9, "V7"),
        ("height", 2.0, ""),
    ):
        host.session.hub.publish(m.reading(sensor, value, text=text, driver="robot"))
    host.session.hub.publish(m.StopPressed(source="key"))
    await _until(caller, "stopped", True)
    readings = (await caller.call(LOOK, {}))["readings"]
    assert readings == {"mood": "calm", "identity": "V7", "height": 2.0}
    following.cancel()
    await asyncio.gather(following, return_exceptions=True)


async def _until(caller: ToolCaller, name: str, value: Json) -> None:
    async with asyncio.timeout(PATIENCE_S):
        while (await caller.call(LOOK, {}))[name] != value:  # noqa: ASYNC110 - by calls
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
