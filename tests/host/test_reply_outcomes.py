"""A reply says what became of its request."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import served_session
from woz_tui.protocol.requests import PROTOCOL

REFUSED: list[dict[str, Any]] = [
    {"verb": "say", "args": {}},
    {"verb": "say", "args": {"text": 7}},
    {"verb": "say", "args": {"text": "x", "loudness": 2}},
    {"verb": "drive", "args": {"x": 1.0}},
]


@pytest.mark.parametrize("fields", REFUSED)
async def test_a_refused_verb_is_not_called_accepted(
    tmp_path: Path, fields: dict[str, Any]
) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        assert (await peer.hello())["protocol"] == PROTOCOL
        reply = await peer.ask("verb", **fields)
        [refused] = [line for line in peer.seen if line["kind"] == "command.refused"]
        assert not reply["ok"]
        assert reply["reason"] == refused["reason"]
        assert (reply["run"], reply["ended"]) == (refused["command"], "command.refused")


async def test_verbs_are_refused_by_the_stop_and_the_reply_says_so(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        await peer.ask("stop")
        reply = await peer.ask("verb", verb="say", args={"text": "Hello"})
        assert (reply["ok"], reply["hint"]) == (False, "release the stop first")
        assert reply["reason"] == "the stop is pressed"


async def test_a_refused_action_is_named_as_the_log_names_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        for name in ("Never", "Helo"):
            reply = await peer.ask("action", action=name)
            assert not reply["ok"]
            refused = peer.seen[-2]
            assert (refused["kind"], refused["run"]) == ("action.refused", reply["run"])


async def test_what_goes_on_has_no_end_in_its_reply(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello()
        reply = await peer.ask("verb", verb="play", args={"move": "fail"})
        assert reply["ok"]
        assert "ended" not in reply
        failed = await peer.kind("command.failed")
        assert failed["command"] == reply["run"]


@pytest.mark.parametrize("role", ["program", "watcher"])
async def test_a_session_describes_what_it_can_be_asked_for(tmp_path: Path, role: str) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.hello(role)
        data = (await peer.ask("describe"))["data"]
        verbs = {verb["name"]: verb for verb in data["verbs"] if verb["driver"] == "robot"}
        assert verbs["say"]["lane"] == "voice"
        assert verbs["say"]["arguments"] == [
            {"name": "text", "kind": "text", "type": "string", "required": True}
        ]
        assert verbs["drive"]["drives"]
        assert verbs["drive"]["arguments"][0]["type"] == "number"
        assert data["sensors"] == [{"name": "distance", "driver": "robot", "unit": "m"}]
