"""What waits in the queues: refused when they are full, and emptied without a stop."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import SessionRig, action
from tests.session.test_superseding import (
    ACTIONS,
    KEY,
    ends,
    press_actions,
    say_actions,
    scene,
    spoken_texts,
)
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError


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


HELD = RequestOrigin("key", "r", "con1")
PROGRAM = RequestOrigin("program", "", "con2")
FINDER = RequestOrigin("palette", "", "con1")


def test_a_key_that_is_held_says_its_sentence_once(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Repeat", HELD)
        for _ in range(15):
            with pytest.raises(RequestError, match="'Repeat' is running already") as again:
                rig.session.play("Repeat", HELD)
        assert (again.value.hint, again.value.command) == ("interrupt it", "cut")
        rig.session.play("Hello", KEY)
        with pytest.raises(RequestError, match="'Hello' waits already"):
            rig.session.play("Hello", KEY)
        await asyncio.sleep(5)
        rig.session.play("Repeat", HELD)

    rig = scene(tmp_path, play)
    said = spoken_texts(rig)
    assert [said.count(text) for text in dict.fromkeys(said)] == [2, 1], said
    assert len(rig.of(m.ActionRequested)) == 3


def test_programs_the_finder_and_a_file_that_says_so_queue_an_action_again(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        for origin in (HELD, PROGRAM, FINDER):
            rig.session.play("Repeat", origin)
        rig.session.play("Queued", HELD)
        rig.session.play("Queued", HELD)

    queued = replace(action("Queued", *say_actions("once more")), when_busy="queue")
    said = spoken_texts(scene(tmp_path, play, (*ACTIONS, queued)))
    assert (said.count("Could you say that again?"), said.count("once more")) == (3, 2)


def test_a_key_that_drives_goes_on_while_it_is_held(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        for _ in range(3):
            rig.session.play("Go", HELD)

    rig = SessionRig(tmp_path).run(scenario)
    assert [line.action for line in rig.of(m.ActionRequested)] == ["Go", "Go", "Go"]
