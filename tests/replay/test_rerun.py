"""A session's commands run again: at the same moments, cut short where they were, and stoppable."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.replay.rerun_rig import (
    HAND,
    KEY,
    NOWHERE,
    played_in,
    player_of,
    record_session,
    rerun_over,
    run_again,
)
from tests.session.rig import SessionRig
from woz_tui.analysis.session_comparison import BY_COMMANDS, compare
from woz_tui.config.experiment import Call
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import plan_of


async def tour(rig: SessionRig) -> None:
    """Speech and moves together, one after the other, and side by side."""
    session = rig.session
    session.play("Hello", KEY)
    await asyncio.sleep(0.4)
    session.play("Welcome", KEY)
    await asyncio.sleep(2.25)
    session.play("Map", KEY)
    session.mark("here", "wizard")
    await asyncio.sleep(4)


def test_every_command_comes_at_its_moment_of_then(tmp_path: Path) -> None:
    log = record_session(tmp_path / "a", tour)
    first = played_in(log)
    rerun = run_again(tmp_path / "b", log)
    assert rerun.player.over is not None
    assert rerun.player.over.reason == "done"
    assert rerun.player.over.sent_again == len(first.commands) == 6
    assert [(rerun_sent.late_us < 10, rerun_sent.due) for rerun_sent in rerun.sent_commands()] == [
        (True, act.moment - first.commands[0].moment + rerun.sent_commands()[0].due)
        for act in first.commands
    ]
    assert rerun.calls() == [
        ("say", {"text": "Hello P07"}),
        ("play", {"move": "nod"}),
        ("say", {"text": "Welcome"}),
        ("say", {"text": "Look at the map"}),
        ("play", {"move": "point"}),
    ]


def test_the_log_names_the_original_and_says_which_command_was_which(tmp_path: Path) -> None:
    log = record_session(tmp_path / "a", tour)
    rerun = run_again(tmp_path / "b", log)
    (started,) = rerun.of(m.RerunStarted)
    assert isinstance(started, m.RerunStarted)
    assert (started.original, started.original_session, started.commands) == ("made", "S01", 6)
    assert started.original_sha256 == plan_of(log).sha256
    comparison = compare(played_in(log), played_in(rerun.log))
    assert comparison.by == BY_COMMANDS
    assert comparison.same
    assert len(comparison.pairs) == 6
    shifts = comparison.shifts
    assert shifts is not None
    assert abs(shifts.drift) < 1


def test_a_second_time_is_like_the_first(tmp_path: Path) -> None:
    log = record_session(tmp_path / "a", tour)
    one = run_again(tmp_path / "b", log)
    two = run_again(tmp_path / "c", log)
    assert one.calls() == two.calls()
    assert compare(played_in(one.log, "one"), played_in(two.log, "two")).same


def test_a_re_run_can_be_run_again(tmp_path: Path) -> None:
    log = record_session(tmp_path / "a", tour)
    one = run_again(tmp_path / "b", log)
    two = run_again(tmp_path / "c", one.log)
    assert one.calls() == two.calls()


def test_markers_are_put_again_and_the_verb_mark_once(tmp_path: Path) -> None:
    rerun = run_again(tmp_path / "b", record_session(tmp_path / "a", tour))
    marks = rerun.of(m.Marker)
    assert [(mark.text, mark.source) for mark in marks] == [("here", "replay"), ("map", "action")]


def test_what_a_replacing_press_cut_short_is_cut_short_again(tmp_path: Path) -> None:
    async def hasty(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.3)
        rig.session.play("Welcome", KEY, "replace")
        await asyncio.sleep(3)

    log = record_session(tmp_path / "a", hasty)
    rerun = run_again(tmp_path / "b", log)
    (cut,) = rerun.of(m.Stopped)
    began = next(line for line in rerun.of(m.Dispatched))
    assert cut.command == began.command
    assert abs(cut.t - began.t - 300_000) < 10
    assert "replaced by" in cut.reason
    assert compare(played_in(log), played_in(rerun.log)).same


def test_a_stop_of_then_cuts_short_without_latching(tmp_path: Path) -> None:
    async def stopped(rig: SessionRig) -> None:
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(0.25)
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key")
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)

    log = record_session(tmp_path / "a", stopped)
    rerun = run_again(tmp_path / "b", log)
    assert not rerun.of(m.StopPressed, m.StopReleased)
    assert len(rerun.of(m.Stopped)) == 2
    assert compare(played_in(log), played_in(rerun.log)).same
    assert ("stop", {"scope": "all"}) not in rerun.driver().calls


def test_a_stop_ends_it_for_good(tmp_path: Path) -> None:
    async def wizard(rig: SessionRig) -> None:
        await asyncio.sleep(1.2)
        rig.session.stop("key")
        await asyncio.sleep(0.1)
        rig.session.release("key")

    rerun = run_again(tmp_path / "b", record_session(tmp_path / "a", tour), wizard)
    assert rerun.player.over is not None
    assert rerun.player.over.reason == "stopped"
    assert rerun.player.over.sent_again == 1
    asked = rerun.of(m.Command)
    assert len(asked) == 1
    assert rerun.kinds(m.StopReleased)


def test_the_wizards_own_hand_counts_beside_it(tmp_path: Path) -> None:
    async def wizard(rig: SessionRig) -> None:
        await asyncio.sleep(2.2)
        rig.session.play("Go", HAND)
        await asyncio.sleep(0)
        rig.session.mistake("", "slipped")

    log = record_session(tmp_path / "a", tour)
    rerun = run_again(tmp_path / "b", log, wizard)
    comparison = compare(played_in(log), played_in(rerun.log))
    assert [act.name for act in comparison.extra] == ["robot.drive"]
    assert not comparison.missing
    (mistake,) = rerun.of(m.Mistake)
    assert isinstance(mistake, m.Mistake)
    assert mistake.action == "Go"  # what the re-run sends is nobody's last press


def test_after_a_standstill_nothing_is_made_up_for_at_once(tmp_path: Path) -> None:
    """A process that was suspended for 3 s leaves out what is too old, and goes on in time."""
    log = record_session(tmp_path / "a", tour)

    async def suspended(rig: SessionRig) -> None:
        player = player_of(rig, plan_of(log))
        player.begin()
        await asyncio.sleep(1.1)
        asyncio.get_running_loop().jump(3)  # type: ignore[attr-defined]
        await rerun_over(rig, player)

    rig = SessionRig(tmp_path / "b").run(suspended)
    skipped, sent = rig.of(m.RerunSkipped), rig.of(m.RerunSent)
    assert skipped
    assert all("late" in line.reason for line in skipped)
    assert all(line.late_us <= 1_500_000 for line in sent)
    assert len(sent) + len(skipped) == 6
    assert sent[-1].late_us < 10


@given(
    st.lists(
        st.tuples(
            st.sampled_from(["say", "play", "drive"]),
            st.sampled_from(["queue", "replace", "refuse"]),
            st.floats(0, 2).map(lambda seconds: round(seconds, 3)),
            st.sampled_from(["", "", "", "stop"]),
        ),
        min_size=1,
        max_size=12,
    )
)
def test_whatever_was_pressed_the_robot_does_the_same_again(
    tmp_path_factory: pytest.TempPathFactory, presses: list[tuple[str, str, float, str]]
) -> None:
    folder = tmp_path_factory.mktemp("again")

    async def pressed(rig: SessionRig) -> None:
        for number, (verb, when_busy, pause, then) in enumerate(presses):
            every: dict[str, dict[str, m.Json]] = {
                "say": {"text": f"sentence {number}"},
                "play": {"move": f"move {number}"},
                "drive": {"x": float(number)},
            }
            rig.session.runner.send(Call(verb, every[verb], "robot", NOWHERE), KEY, when_busy)
            await asyncio.sleep(pause)
            if then == "stop":
                rig.session.stop("key")
                await asyncio.sleep(0.01)
                rig.session.release("key")
        await asyncio.sleep(70)

    log = record_session(folder / "a", pressed)
    plan = plan_of(log)
    rerun = run_again(folder / "b", log)
    comparison = compare(played_in(log), played_in(rerun.log))
    assert comparison.same, comparison
    assert len(comparison.pairs) == len(plan.sent)
    assert len(plan.sent) + len(plan.skipped) == len(presses)
    assert all(abs(pair.shift_us) < 1000 for pair in comparison.pairs)
    twice = run_again(folder / "c", rerun.log)
    assert twice.calls() == rerun.calls()
    comparison = compare(played_in(rerun.log), played_in(twice.log))
    assert comparison.same, comparison
    assert comparison.by == BY_COMMANDS
    assert len(comparison.pairs) == len(plan.sent)
