"""A stop of a robot of several parts: which of them confirmed stands at the bottom."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.console import scenes
from tools import guide_session
from woz_tui.console.drawing.cells import length
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.replay.timeline import replay_rows
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.bottom_rows import BarInfo, bar_rows
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.session.session import Session

NOW = scenes.NOW


def stopped_state(*confirmations: m.StopConfirmed) -> ConsoleState:
    state = ConsoleState()
    state.apply([scenes.welcome(), m.StopPressed(source="key", t=NOW), *confirmations], 0)
    return state


def confirmation(
    confirmed: list[str],
    missing: list[str],
    parts: dict[str, list[str]],
    missing_parts: dict[str, list[str]],
) -> m.StopConfirmed:
    return m.StopConfirmed(
        confirmed=confirmed,
        missing=missing,
        elapsed_us=80_000,
        parts=parts,
        missing_parts=missing_parts,
        t=NOW,
    )


def bar(state: ConsoleState, width: int = 80) -> str:
    rows = bar_rows(state, PaintFrame(width, 2, NOW), BarInfo(release="^R"))
    assert [length(row) for row in rows] == [width, width]
    return "".join(text for text, _ in rows[1]).strip()


def test_parts_that_confirmed_are_named_behind_their_driver() -> None:
    parts = {"pepper": ["speech", "motion", "tablet"]}
    state = stopped_state(confirmation(["pepper", "range"], [], parts, {}))
    assert bar(state) == "confirmed: pepper (speech, motion, tablet), range"


def test_a_part_that_is_missing_is_named_and_so_are_those_that_stand_still() -> None:
    stop_confirmed = confirmation(
        ["range"], ["pepper"], {"pepper": ["speech", "motion"]}, {"pepper": ["tablet"]}
    )
    shown = bar(stopped_state(stop_confirmed))
    assert "NOT CONFIRMED: pepper: tablet " in shown
    assert shown.endswith("confirmed: range, pepper (speech, motion)")


@pytest.mark.safety
def test_a_stop_that_was_confirmed_late_says_so_on_the_bar_and_in_the_events() -> None:
    late = m.StopConfirmed(confirmed=["head", "robot"], missing=[], elapsed_us=3_500_000, t=NOW)
    state = stopped_state(late)
    assert bar(state) == "confirmed late, after 3.5 s: head, robot"
    assert bar(state, 40) == "2 of 2 confirmed late, after 3.5 s"
    event = state.events[-1]
    assert (event.mark, event.text) == ("warning", "Stop confirmed late")
    assert event.detail == "after 3.5 s"


@pytest.mark.parametrize(
    ("stalled", "text", "detail"),
    [
        (
            m.ProcessStalled(
                driver="robot", call="perform say", place="x.py:3 in go", duration_us=4_000_000
            ),
            "robot held up the robot process for 4.0 s",
            "perform say, x.py:3 in go",
        ),
        (
            m.ProcessStalled(duration_us=400_000, cause="starved"),
            "Robot process got no processor time for 0.4 s",
            "",
        ),
        (
            m.ProcessStalled(duration_us=9_000_000, cause="stopped"),
            "Robot process was stopped for 9.0 s",
            "",
        ),
    ],
)
def test_who_held_up_the_robot_process_is_an_event(
    stalled: m.ProcessStalled, text: str, detail: str
) -> None:
    state = ConsoleState()
    state.apply([scenes.welcome(), stalled], 0)
    assert (state.events[-1].text, state.events[-1].detail) == (text, detail)


def test_a_driver_that_is_not_connected_is_named_as_not_reached() -> None:
    gone = m.StopConfirmed(
        confirmed=["head"], missing=["robot"], unreached=["robot"], elapsed_us=1, t=NOW
    )
    shown = bar(stopped_state(gone))
    assert "NOT REACHED: robot" in shown
    assert "NOT CONFIRMED" not in shown
    assert shown.endswith("confirmed: head")
    both = m.StopConfirmed(
        confirmed=[], missing=["base", "robot"], unreached=["robot"], elapsed_us=1, t=NOW
    )
    shown = bar(stopped_state(both))
    assert "NOT REACHED: robot" in shown
    assert "NOT CONFIRMED: base" in shown
    assert shown.endswith("confirmed: nobody")


@pytest.mark.parametrize("missing", [["robot"], ["base", "robot"]])
def test_events_and_the_replay_name_what_was_not_reached_too(missing: list[str]) -> None:
    stop_confirmed = m.StopConfirmed(
        confirmed=["head"], missing=missing, unreached=["robot"], elapsed_us=1, t=NOW
    )
    state = stopped_state(stop_confirmed)
    event = state.events[-1]
    assert "not reached" in f"{event.text} {event.detail}".lower()
    assert "robot" in event.detail
    row = replay_rows(state, PaintFrame(120, 2, NOW), BarInfo())[0]
    assert "NOT REACHED: robot" in "".join(text for text, _ in row)


def test_a_driver_without_parts_is_missing_by_its_name_alone() -> None:
    shown = bar(stopped_state(confirmation(["range"], ["pepper"], {}, {})))
    assert "NOT CONFIRMED: pepper " in shown
    assert shown.endswith("confirmed: range")


@pytest.mark.parametrize("width", [40, 60, 80])
def test_what_is_missing_stays_whole_where_there_is_little_room(width: int) -> None:
    many = ["speech", "motion", "animations", "sound", "eyes", "autonomy", "base", "screen"]
    stop_confirmed = confirmation(["range"], ["pepper"], {"pepper": many}, {"pepper": ["tablet"]})
    shown = bar(stopped_state(stop_confirmed), width)
    assert "NOT CONFIRMED: pepper: tablet" in shown
    assert "motion" not in shown
    if width >= 60:
        assert shown.endswith("confirmed: range")


def test_only_parts_of_the_only_driver_confirmed() -> None:
    many = ["speech", "motion", "animations", "sound", "eyes", "autonomy", "base", "screen"]
    stop_confirmed = confirmation([], ["pepper"], {"pepper": many}, {"pepper": ["tablet"]})
    assert bar(stopped_state(stop_confirmed)).endswith("confirmed: only parts")
    assert bar(stopped_state(confirmation([], ["pepper"], {}, {}))).endswith("confirmed: nobody")


def test_where_nothing_moves_nobody_is_missing() -> None:
    assert "nobody" not in bar(stopped_state(confirmation([], [], {}, {})))


def test_who_was_missing_stays_missing_with_its_parts() -> None:
    first = confirmation([], ["pepper"], {"pepper": ["speech"]}, {"pepper": ["motion"]})
    second = confirmation(["pepper"], [], {"pepper": ["speech", "motion"]}, {})
    shown = bar(stopped_state(first, second))
    assert "NOT CONFIRMED: pepper: motion" in shown
    assert shown.endswith("confirmed: pepper (speech)")


def test_the_list_of_events_names_the_part() -> None:
    state = stopped_state(confirmation([], ["pepper"], {}, {"pepper": ["tablet", "eyes"]}))
    assert state.events[-1].detail == "pepper: tablet, eyes"


def test_a_robot_that_is_unplugged_confirms_no_stop(tmp_path: Path) -> None:
    """On every screen: in the session, in one that attaches later, and in the replay of its log."""
    begun: list[bool] = []

    def hand(session: Session, message: m.Message) -> None:
        if isinstance(message, m.DriverConnected) and not begun:
            begun.append(True)
            loop = asyncio.get_running_loop()
            fault: dict[str, m.Json] = {"kind": "disconnect", "seconds": 60.0}
            loop.call_later(2, lambda: session.send("fault", fault, "", RequestOrigin("key")))
            loop.call_later(4, lambda: session.stop("key"))

    lines = guide_session.played(tmp_path, 8.0, hand)
    live = ConsoleState()
    live.apply([scenes.welcome(), *lines], 0)
    late = ConsoleState()
    late.apply([scenes.welcome(state=live.session.messages())], 0)
    for state in (live, late):
        shown = bar(state)
        assert "NOT REACHED: robot" in shown
        assert shown.endswith("confirmed: nobody")
    told = [f"{event.text} {event.detail}" for event in live.events if event.mark == "error"]
    assert "Not reached robot" in told
    assert not [event for event in live.events if event.text == "Stop confirmed"]
    row = replay_rows(live, PaintFrame(120, 2, NOW), BarInfo())[0]
    assert "NOT REACHED: robot" in "".join(text for text, _ in row)
