"""What waits in the queues: refused when they are full, and emptied without a stop."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.session.rig import Stage
from tests.session.test_superseding import ACTIONS, KEY, ends, pressed, scene, spoken
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import RequestError


def test_a_line_of_the_script_that_a_full_queue_refuses_is_not_passed(tmp_path: Path) -> None:
    async def play(stage: Stage) -> None:
        for _ in range(17):
            stage.session.play("Repeat", KEY)
        with pytest.raises(RequestError, match="queue full"):
            stage.session.script_next(KEY)

    stage = scene(tmp_path, play, tuple(a for a in ACTIONS if a.name in ("Repeat", "Hello")))
    assert isinstance(ends(stage)["Hello"], m.ActionRefused)
    assert not [line for line in stage.lines if isinstance(line, m.ScriptMoved) and line.position]


def test_the_queue_is_emptied_and_what_runs_goes_on(tmp_path: Path) -> None:
    async def play(stage: Stage) -> None:
        for name in ("Repeat", "Map", "Hello", "Wave"):
            stage.session.play(name, KEY)
        await asyncio.sleep(0.1)
        stage.session.empty_queue("wizard con1")
        with pytest.raises(RequestError, match="nothing is queued"):
            stage.session.empty_queue("wizard con1")

    stage = scene(tmp_path, play)
    assert spoken(stage) == ["Could you say that again?"]
    over = ends(stage)
    assert isinstance(over["Wave"], m.ActionDone)
    assert isinstance(over["Hello"], m.ActionStopped)
    assert over["Hello"].reason == "queue emptied by wizard con1"


def test_what_was_queued_after_it_is_played(tmp_path: Path) -> None:
    async def play(stage: Stage) -> None:
        await pressed((0, "Repeat"), (0.1, "Hello"))(stage)
        stage.session.empty_queue("wizard con1")
        stage.session.play("Exhibit", KEY)

    assert "This is the whale." in spoken(scene(tmp_path, play))
