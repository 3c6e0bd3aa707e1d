"""What waits in the queues: refused when they are full, and emptied without a stop."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.session.rig import SessionRig
from tests.session.test_superseding import ACTIONS, KEY, ends, press_actions, scene, spoken_texts
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import RequestError


def test_a_line_of_the_script_that_a_full_queue_refuses_is_not_passed(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        for _ in range(17):
            rig.session.play("Repeat", KEY)
        with pytest.raises(RequestError, match="queue full"):
            rig.session.script_next(KEY)

    rig = scene(tmp_path, play, tuple(a for a in ACTIONS if a.name in ("Repeat", "Hello")))
    assert isinstance(ends(rig)["Hello"], m.ActionRefused)
    assert not [line for line in rig.of(m.ScriptMoved) if line.position]


def test_the_queue_is_emptied_and_what_runs_goes_on(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        for name in ("Repeat", "Map", "Hello", "Wave"):
            rig.session.play(name, KEY)
        await asyncio.sleep(0.1)
        rig.session.empty_queue("the wizard")
        with pytest.raises(RequestError, match="nothing is queued"):
            rig.session.empty_queue("the wizard")

    rig = scene(tmp_path, play)
    assert spoken_texts(rig) == ["Could you say that again?"]
    over = ends(rig)
    assert isinstance(over["Wave"], m.ActionDone)
    assert isinstance(over["Hello"], m.ActionStopped)
    assert over["Hello"].reason == "queue emptied by the wizard"


def test_what_was_queued_after_it_is_played(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        await press_actions((0, "Repeat"), (0.1, "Hello"))(rig)
        rig.session.empty_queue("the wizard")
        rig.session.play("Exhibit", KEY)

    assert "This is the whale." in spoken_texts(scene(tmp_path, play))
