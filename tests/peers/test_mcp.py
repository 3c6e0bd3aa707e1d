"""`woz mcp` with the client that the protocol's authors publish."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from pathlib import Path

import pytest

from tests.peers.places import place
from woz_tui.console.link.host_start import Launch

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.peers

#: Runs where the protocol's package is installed.
CLIENT = """
import asyncio, json, os, sys
from mcp import ClientSession, StdioServerParameters, stdio_client

async def main():
    server = StdioServerParameters(command=sys.argv[1], args=["mcp"], env=dict(os.environ))
    async with stdio_client(server) as streams, ClientSession(*streams) as session:
        await session.initialize()
        tools = (await session.list_tools()).tools
        came = {"tools": {tool.name: tool.input_schema for tool in tools}}
        for name, args in json.loads(sys.argv[2]):
            result = await session.call_tool(name, args)
            came.setdefault("calls", []).append([result.is_error, result.content[0].text])
        print(json.dumps(came))

asyncio.run(main())
"""


def test_an_assistant_lists_tools_plays_and_stops_but_does_not_go_on() -> None:
    folder = place("mcp")
    calls = [
        ["say", {"text": "Hello"}],
        ["gaze", {"yaw": 20, "pitch": 0}],
        ["gaze", {"yaw": "x"}],
        ["stop_everything", {}],
        ["say", {"text": "again"}],
        ["release", {}],
    ]
    with tempfile.TemporaryDirectory() as own, pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", own)
        demo = str(ROOT / "experiments" / "demo.yaml")
        launch = Launch([demo, "--recordings", own])
        try:
            launch.wait()
            done = subprocess.run(
                [
                    folder / "bin" / "python",
                    "-c",
                    CLIENT,
                    folder / "bin" / "woz",
                    json.dumps(calls),
                ],
                capture_output=True,
                text=True,
                timeout=100,
                check=False,
                env={**os.environ, "XDG_RUNTIME_DIR": own},
            )
        finally:
            launch.abandon()
    assert done.returncode == 0, done.stderr
    came = json.loads(done.stdout)
    assert came["tools"]["say"]["required"] == ["text"]
    assert [failed for failed, _ in came["calls"]] == [False, False, True, False, True, True]
