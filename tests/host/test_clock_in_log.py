"""The log says where its axis of time lies on the clock of the robot's computer."""

from __future__ import annotations

from pathlib import Path

from tests.host.rig import served_session
from woz_tui.protocol import messages as m


async def test_the_log_has_the_clock_that_a_client_is_told(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        welcome = await peer.hello()
        (start,) = [line for line in host.lines if isinstance(line, m.SessionStart)]
        assert start.clock["monotonic_us"] == welcome["clock_us"]
        assert start.clock["source"] == "monotonic"
