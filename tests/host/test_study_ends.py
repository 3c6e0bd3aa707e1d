"""The study when a session is about to end, and what a participant at a terminal is to that."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import ServedSession
from tests.host.test_study import hosted, wizard
from woz_tui.config.experiment import SessionSettings
from woz_tui.protocol import messages as m


def test_a_participant_who_comes_and_goes_does_not_keep_the_session(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        over = asyncio.ensure_future(host.host.serve())
        for _ in range(300):
            if over.done():
                break
            guest = await host.connect()
            await guest.hello("participant")
            guest.leave()
            await asyncio.sleep(0.01)
        assert over.done()
        assert over.result() == "abandoned"

    hosted(tmp_path, scenario, SessionSettings(abandon_after=0.3))


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        ("trial", {"what": "begin"}),
        ("assign", {"participant": "P01", "order": ["warm", "cold"]}),
        ("questionnaire", {"questionnaire": "whenever"}),
        ("check", {"check": "the door is shut"}),
    ],
)
def test_nothing_begins_behind_the_end(tmp_path: Path, kind: str, fields: dict[str, Any]) -> None:
    async def scenario(host: ServedSession) -> None:
        peer, _ = await wizard(host)
        await host.session.close("over")
        reply = await peer.ask(kind, **fields)
        assert reply["reason"] == "the session is ending"

    assert isinstance(hosted(tmp_path, scenario)[-1], m.SessionEnd)
