"""Scripts beside the rest of a session: refusals, the queue, reloads, trials, profiles."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from tests.fakes.virtual_time import LoopClock
from tests.features.profiles.test_profiles import NOT
from tests.features.profiles.test_profiles import on_stage as with_profile
from tests.session.rig import SessionRig, with_script
from tests.session.study_rig import on_stage as in_study
from tests.session.study_rig import trial_control
from tests.session.test_another_robot import TEXT, staged
from tests.session.test_driver_requests import RequestOutcome, from_a_thread
from tests.session.test_superseding import ACTIONS, ends, scene
from woz_tui.drivers.contract import Ask
from woz_tui.features.scripts.in_session import ScriptController
from woz_tui.features.scripts.kinds import ScriptMoved
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

KEY = RequestOrigin("key", "h", "con1")


def script_of(rig: SessionRig) -> ScriptController:
    return rig.session.features.of(ScriptController)


def on_stage(tmp_path: Path, scenario: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
    """The script is Hello, Welcome."""
    return SessionRig(tmp_path).run(scenario, 5)


def test_script_moves_on_and_ends(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        script_of(rig).play_next(KEY)
        await asyncio.sleep(0.1)
        script_of(rig).play_next(KEY)
        await asyncio.sleep(2)
        with pytest.raises(RequestError, match="no more lines"):
            script_of(rig).play_next(KEY)
        script_of(rig).move(0)
        with pytest.raises(RequestError, match="2 lines"):
            script_of(rig).move(3)

    rig = on_stage(tmp_path, scenario)
    assert [line.position for line in rig.of(ScriptMoved)] == [1, 2, 0]


def test_a_refused_script_line_is_not_skipped(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.stop("key")
        with pytest.raises(RequestError):
            script_of(rig).play_next(KEY)
        assert script_of(rig).now.position == 0

    on_stage(tmp_path, scenario)


def test_a_script_that_became_shorter_moves_its_position_for_everybody(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        script_of(rig).move(2)
        rig.session.adopt(with_script(rig.session.experiment, "Hello"), ["shorter"])
        assert script_of(rig).now.position == 1

    rig = on_stage(tmp_path, scenario)
    moves = [line.position for line in rig.of(ScriptMoved)]
    assert moves == [2, 1]


def test_a_line_of_the_script_that_a_full_queue_refuses_is_not_passed(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        for _ in range(17):
            rig.session.play("Repeat", KEY, "queue")
        with pytest.raises(RequestError, match="queue full"):
            script_of(rig).play_next(KEY)

    rig = scene(tmp_path, play, tuple(a for a in ACTIONS if a.name in ("Repeat", "Hello")))
    assert isinstance(ends(rig)["Hello"], m.ActionRefused)
    assert not [line for line in rig.of(ScriptMoved) if line.position]


def test_the_script_begins_anew_with_trial_and_participant(tmp_path: Path) -> None:
    positions: list[int] = []

    async def scenario(rig: SessionRig) -> None:
        session = rig.session

        async def play() -> None:
            script_of(rig).play_next(KEY)
            positions.append(script_of(rig).now.position)
            await asyncio.sleep(2)

        session.set(participant="P01", condition="warm")
        await play()
        trial_control(session).trial("begin", "")
        await play()
        await play()
        trial_control(session).trial("done", "")
        trial_control(session).trial("begin", "")
        await play()
        trial_control(session).trial("done", "")
        session.set(participant="P02")
        await play()
        session.set(condition="cold")
        await play()
        session.set(trial=3)
        await play()

    in_study(tmp_path, scenario)
    assert positions == [1, 1, 2, 1, 1, 2, 1]


def test_a_step_that_sets_the_trial_leaves_the_script_where_it_is(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.set(participant="P01", condition="warm")
        script_of(rig).play_next(KEY)
        rig.session.send("set", {"trial": 2}, "", KEY)
        await asyncio.sleep(0.1)
        assert (rig.session.identity.trial, script_of(rig).now.position) == (2, 1)

    in_study(tmp_path, scenario)


def test_a_line_that_is_too_old_is_refused_as_an_action_and_not_skipped(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="late"):
            script_of(rig).play_next(KEY, stale="stale: late")
        assert script_of(rig).now.position == 0

    rig = on_stage(tmp_path, scenario)
    assert [line.reason for line in rig.of(m.ActionRefused)] == ["stale: late"]


def test_a_line_that_the_profile_does_not_allow_is_refused(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        script_of(rig).move(1)
        with pytest.raises(RequestError, match=f"'Welcome' {NOT}"):
            script_of(rig).play_next(KEY)

    rig = with_profile(tmp_path, scenario)
    assert [line.action for line in rig.of(m.ActionRefused)] == ["Welcome"]


def test_lines_that_another_robot_plays_without_a_part_of_them_are_played(tmp_path: Path) -> None:
    rig = staged(tmp_path, f"{TEXT}script: [Blue, Hello]\n")
    assert script_of(rig).now.position == 2


def test_a_hand_on_a_panel_plays_the_next_line_unless_it_is_too_old(tmp_path: Path) -> None:
    ears = [RequestOutcome(), RequestOutcome()]

    async def scenario(rig: SessionRig) -> None:
        from_a_thread(rig, Ask("script", source="midi"), ears[0])
        await asyncio.sleep(2)
        assert isinstance(rig.session.clock, LoopClock)
        rig.session.clock.stood_still_us += 5_000_000
        from_a_thread(rig, Ask("script", source="midi"), ears[1])
        await asyncio.sleep(1)

    rig = on_stage(tmp_path, scenario)
    asked = [(line.action, line.source) for line in rig.of(m.ActionRequested)]
    assert asked == [("Hello", "midi"), ("Welcome", "midi")]
    assert [line.action for line in rig.of(m.ActionRefused)] == ["Welcome"]
    assert [told[0] for ear in ears for told in ear.told] == [True, False]
