"""A panel's lock and the verbs that it covers: nothing by hand, whichever way it comes."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from tests.config.reading import errors, panel, read_experiment
from tests.host.rig import served_session
from tests.session.rig import HERE, SessionRig, experiment
from tests.session.test_driver_requests import RequestOutcome, from_a_thread
from woz_tui.config.experiment import ArrowKeySteps, Experiment, Panel
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.contract import Ask
from woz_tui.gate.questions import RequestOrigin
from woz_tui.host.experiment_view import panel_views
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

pytestmark = pytest.mark.safety

LOCKED = "the panel 'Movement' is locked, and with it 'drive'"
ARROW = RequestOrigin("key", "alt+up", "con1")
FILE = panel("{key: h, label: Hello, say: Hi}") + "  - {title: Movement, covers: [screen]}\n"


def with_movement(tmp_path: Path, *, locked: bool = True) -> Experiment:
    """The rig's experiment with a panel that has no actions, but covers driving."""
    made = experiment(tmp_path)
    return replace(
        made, panels=(*made.panels, Panel("Movement", (), HERE, locked, ("drive", "nudge")))
    )


def on_stage(tmp_path: Path, scenario: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
    async def unwatched(rig: SessionRig) -> None:
        rig.session.experiment = with_movement(tmp_path)
        rig.session.bus.unwatched = ""
        await scenario(rig)

    return SessionRig(tmp_path).run(unwatched, 2)


def test_arrow_keys_of_a_locked_panel_are_refused_and_logged(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match=LOCKED) as caught:
            rig.session.send("drive", {"x": 0.1}, "", ARROW)
        assert (caught.value.hint, caught.value.command) == ("find 'Unlock Movement'", "find")
        rig.session.send("play", {"move": "nod"}, "", ARROW)  # nothing covers it

    rig = on_stage(tmp_path, scenario)
    [refused] = rig.of(m.Refused)
    assert (refused.code, refused.reason) == ("locked", LOCKED)
    assert [verb for verb, _ in rig.driver().calls][:1] == ["play"]


def test_unlocked_they_move_and_locked_again_they_do_not(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.lock("Movement", False)
        rig.session.send("drive", {"x": 0.1}, "", ARROW)
        await asyncio.sleep(0)
        rig.session.lock("Movement", True)
        with pytest.raises(RequestError):
            rig.session.send("drive", {"x": 0.2}, "", ARROW)

    rig = on_stage(tmp_path, scenario)
    drives = [args for verb, args in rig.driver().calls if verb == "drive"]
    assert drives == [{"x": 0.1}]


def test_knobs_are_hands_too_and_what_a_driver_does_by_itself_is_not(tmp_path: Path) -> None:
    hand, own = RequestOutcome(), RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        drive = {"x": 0.1}
        from_a_thread(rig, Ask("verb", "drive", drive, source="midi", key="knob 1"), hand)
        from_a_thread(rig, Ask("verb", "drive", drive, source="body"), own)
        await asyncio.sleep(10)

    on_stage(tmp_path, scenario)
    assert hand.told == [(False, LOCKED)]
    assert own.told == [(True, "")]


def test_actions_of_other_panels_still_do_it(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assert rig.session.play("Hello", RequestOrigin("key", "h", "con1"))

    rig = on_stage(tmp_path, scenario)
    assert rig.driver().calls[0][0] == "say"


def test_a_file_names_covered_verbs_and_a_panel_of_them_needs_no_actions(tmp_path: Path) -> None:
    found = read_experiment(tmp_path, FILE)
    assert found.panels[1].covers == ("screen",)
    assert not found.panels[1].locked
    assert [view.covers for view in panel_views(found, {})] == [[], ["screen"]]


def test_a_covered_verb_that_nobody_offers_is_told_at_its_place(tmp_path: Path) -> None:
    said = errors(tmp_path, FILE.replace("covers: [screen]", "covers: [screen, scren]"))
    assert said == ["7:40: Movement > covers[1]: no driver offers 'scren'; did you mean 'screen'?"]
    assert errors(tmp_path, FILE.replace(", covers: [screen]", "")) == [
        "7:5: Movement > actions: is missing (buttons, in this order)"
    ]


def test_a_changed_cover_is_among_the_differences(tmp_path: Path) -> None:
    old = read_experiment(tmp_path, FILE)
    new = read_experiment(tmp_path, FILE.replace("[screen]", "[screen, say]"))
    assert compare(old, new).changes == ("the lock of panel 'Movement' covers screen, say",)


def test_steps_of_the_arrow_keys_are_settings_of_the_file(tmp_path: Path) -> None:
    assert read_experiment(tmp_path, FILE).steps == ArrowKeySteps()
    found = read_experiment(tmp_path, FILE + "steps: {head: 10, drive: 0.25}\n")
    assert found.steps == ArrowKeySteps(head=10, drive=0.25)
    assert errors(tmp_path, FILE + "steps: {head: 0}\n") == [
        "8:9: steps.head: 0 is out of range; allowed is 0.1 to 90 °"
    ]
    assert compare(read_experiment(tmp_path, FILE), found).changes == ("steps changed",)


async def test_consoles_hear_of_the_steps_at_the_start(tmp_path: Path) -> None:
    async with served_session(tmp_path) as rig:
        peer = await rig.connect()
        welcome = await peer.hello()
        assert welcome["settings"]["steps"] == asdict(ArrowKeySteps())
