"""A re-run at its edges: what came too late, what fails, what had no length then."""

from __future__ import annotations

import asyncio
from pathlib import Path

from tests.replay.rerun_rig import (
    KEY,
    RerunRig,
    player_of,
    record_session,
    rerun_over,
    run_again,
    write_log,
)
from tests.replay.test_rerun import tour
from tests.replay.test_rerun_plan import END, START, command, dispatched, done_message
from tests.session.rig import SessionRig
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import plan_of
from woz_tui.replay.rerun_player import RerunPlayer


def test_what_was_left_out_because_it_was_late_is_not_cut_short(tmp_path: Path) -> None:
    async def hasty(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(1.5)
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(0.1)
        rig.session.stop("key")

    log = record_session(tmp_path / "a", hasty)

    async def suspended(rig: RerunRig) -> None:
        player = rig.player = player_of(rig, plan_of(log))
        player.begin()
        await asyncio.sleep(1.1)
        asyncio.get_running_loop().jump(5)  # type: ignore[attr-defined]
        await rerun_over(rig, player)

    player = RerunRig(tmp_path / "b").run(suspended).player
    assert player.over is not None
    assert (player.over.reason, player.sent, player.over.skipped_commands) == ("done", 1, 2)


def test_a_re_run_that_fails_is_over_and_says_why(tmp_path: Path) -> None:
    log = record_session(tmp_path / "a", tour)
    told: list[object] = []

    def send(command: m.Command, on_end: object) -> m.Command:
        raise ValueError("no such thing")

    async def failing(rig: RerunRig) -> None:
        player = rig.player = RerunPlayer(
            plan_of(log), rig.session.hub, send, lambda run, why: None, told.append
        )
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: told.append(context))
        player.begin()
        await rerun_over(rig, player)

    player = RerunRig(tmp_path / "b").run(failing, 30).player
    assert player.over is not None
    assert player.over.reason == "it failed: ValueError: no such thing"
    assert player.sent == 1
    assert told[0] == player.over
    assert len(told) == 2


def test_a_command_that_began_and_was_cut_in_one_moment_is_cut_short(tmp_path: Path) -> None:
    """Beginning comes before the end, also where the log's clock cannot tell them apart."""
    log = write_log(
        tmp_path / "made.jsonl",
        [
            (0, START),
            (1, command("c0", "say", args={"text": "Hello"})),
            (1, dispatched("c0")),
            (1, m.Stopped(command="c0", driver="robot", reason="stop pressed")),
            (2, command("c1", "play", args={"move": "nod"})),
            (2, dispatched("c1")),
            (2.2, done_message("c1")),
            (9, END),
        ],
    )
    rerun = run_again(tmp_path / "b", log)
    ends = rerun.of(m.End)
    assert [type(end).__name__ for end in ends] == ["Stopped", "Done"]
    assert ends[0].reason == "cut short as in the log: stop pressed"


def test_a_last_command_that_is_refused_at_once_is_told_before_the_end(tmp_path: Path) -> None:
    lines: list[tuple[float, m.Message]] = [(0, START)]
    for number in range(2):
        name = f"c{number}"
        move = {"move": f"m{number}"}
        lines += [(number, command(name, "play", args=move)), (number, dispatched(name))]
    log = write_log(
        tmp_path / "made.jsonl",
        [*lines, (5, done_message("c0")), (5, done_message("c1")), (9, END)],
    )

    async def latch(rig: SessionRig) -> None:
        rig.session.bus.latched = True  # nobody presses anything: it is only refused

    rerun = run_again(tmp_path / "b", log, latch)
    told = [type(line) for line in rerun.of(m.RerunSent, m.Refused, m.RerunEnded)]
    assert told == [m.Refused, m.RerunSent, m.Refused, m.RerunSent, m.RerunEnded]
    assert rerun.player.over is not None
    assert (rerun.player.over.reason, rerun.player.over.sent_again) == ("done", 2)


def test_it_begins_once(tmp_path: Path) -> None:
    log = record_session(tmp_path / "a", tour)

    async def begin_again(rig: SessionRig) -> None:
        await asyncio.sleep(60)

    rerun = run_again(tmp_path / "b", log, begin_again)
    rerun.player.begin()
    assert len(rerun.of(m.RerunStarted)) == 1
