from __future__ import annotations

from collections.abc import Iterable

import msgspec
import pytest
from textual.events import Key
from textual.widget import Widget

from tests.console import scenes
from tests.console.dialogs import (
    CHARACTERS,
    NOW,
    OPENERS,
    OPENING,
    SIZES,
    busy,
    open_dialog,
    stops,
)
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.config.keys.terminals import KITTY
from woz_tui.console.drawing.glyphs import ASCII
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.link.message_feed import LostPart
from woz_tui.console.screens.dialog import Dialog
from woz_tui.console.screens.drivers import DriversDialog
from woz_tui.console.screens.help import HelpDialog
from woz_tui.console.screens.preflight import kind_finding, line_finding
from woz_tui.console.screens.start import trial_error
from woz_tui.drivers.contract import Finding
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r


@pytest.mark.parametrize("size", SIZES)
async def test_every_dialog_opens_fits_and_closes(size: tuple[int, int]) -> None:
    async with piloted_console(busy(), size=size) as pilot:
        for name in OPENERS:
            await open_dialog(pilot, name)
            dialog = pilot.console.dialog
            assert isinstance(dialog, Dialog)
            assert pilot.console.keyboard.free is dialog.plays
            assert dialog.heading in pilot.drawn()
            box = dialog.query_one(".dialog").region
            assert box.right <= size[0], name
            assert box.bottom <= size[1], name
            await pilot.press("ctrl+q")
            assert pilot.console.dialog is None, name
            assert pilot.console.keyboard.free is True
        assert pilot.feed.last(r.AskStop) is None


@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
async def test_the_stop_reaches_the_robot_from_every_dialog_and_closes_it(key: str) -> None:
    async with piloted_console(busy()) as pilot:
        for count, name in enumerate(OPENERS, start=1):
            await open_dialog(pilot, name)
            await pilot.press(key)
            stops = [asked for asked in pilot.feed.asked if isinstance(asked, r.AskStop)]
            assert len(stops) == count, name
            await pilot.until(lambda: pilot.console.dialog is None, name)
            assert pilot.console.keyboard.free is True
            assert "STOP SENT" in pilot.text("StopBar")


async def test_the_stop_right_behind_the_key_that_opens_a_dialog() -> None:
    async with piloted_console(busy()) as pilot:
        for count, name in enumerate(OPENERS.values(), start=1):
            for key in (name, "escape"):
                pilot.console.post_message(Key(key, CHARACTERS.get(key)))
            pilot.console.paint()
            await pilot.until(lambda n=count: stops(pilot) == n)  # type: ignore[misc]
            await pilot.until(lambda: pilot.console.dialog is None)
        assert pilot.console.keyboard.free is True


async def test_the_stop_before_a_dialog_has_been_put_together() -> None:
    async with piloted_console(busy()) as pilot:
        for name in OPENING:
            pilot.console.do(name)
            dialog = pilot.console.dialog
            assert dialog is not None
            assert not dialog.children
            pilot.console._stopping()
            await pilot.settle()
            assert pilot.console.dialog is None, name
            assert pilot.console.keyboard.free is True
        assert pilot.console.is_running
        await open_dialog(pilot, "SayDialog")


async def test_no_experiment_key_plays_while_a_dialog_has_the_keyboard() -> None:
    async with piloted_console(busy()) as pilot:
        for name in OPENERS:
            await open_dialog(pilot, name)
            dialog = pilot.console.dialog
            assert dialog is not None
            if dialog.plays:  # bodies and panels, see test_drawings
                await pilot.press("ctrl+q")
                continue
            await pilot.press("h", "1", "f1")
            assert pilot.feed.last(r.AskAction) is None, name
            await pilot.press("ctrl+q")


async def test_the_stop_is_released_from_within_a_dialog() -> None:
    async with piloted_console(busy()) as pilot:
        confirmed = m.StopConfirmed(confirmed=["head"], missing=[], elapsed_us=3_000)
        await pilot.tell(m.StopPressed(source="program", t=NOW), confirmed)
        await open_dialog(pilot, "NoteDialog")
        await pilot.press("ctrl+r")
        assert pilot.feed.last(r.AskRelease) is not None
        assert pilot.console.dialog is not None


# -- failures, drivers, help -------------------------------------------------------------------


async def test_failures_are_read_and_seen() -> None:
    async with piloted_console(busy()) as pilot:
        assert "1 failed" in pilot.text("StatusLines")
        await pilot.pass_time(1)  # the key is not held
        await open_dialog(pilot, "FailuresDialog")
        assert "servo 2 (pitch) overloaded" in pilot.drawn()
        await pilot.press("enter")
        assert "failed" not in pilot.text("StatusLines")
        assert pilot.console.state.runs.unseen() == []
        await pilot.press("enter")
        assert pilot.console.dialog is None


async def test_a_failure_that_comes_while_others_are_read_is_not_cleared_with_them() -> None:
    async with piloted_console(busy()) as pilot:
        await open_dialog(pilot, "FailuresDialog")
        await pilot.tell(
            *scenes.played_action("a77", "Nod", NOW, 1, how="failed", reason="no power")
        )
        assert "no power" not in pilot.drawn(), "nothing moves under the reader's eyes"
        await pilot.press("enter")
        assert "1 failed" in pilot.text("StatusLines")
        await pilot.pass_time(1)  # the key is not held
        await open_dialog(pilot, "FailuresDialog")
        assert "no power" in pilot.drawn()
        assert "overloaded" not in pilot.drawn()


async def test_the_key_that_says_why_a_robot_is_lost_is_named_and_shows_whole_sentences() -> None:
    why = "the robot does not answer any more: nothing came from 192.168.1.20 for 3 seconds"
    remedy = "is it on, and is this machine in its network? It is asked again every second"
    lost = m.DriverLost(driver="voice", detail=why, remedy=remedy)
    async with piloted_console() as pilot:
        assert "why" not in pilot.text("StatusLines")
        await pilot.tell(lost)
        assert "^D  why" in pilot.text("StatusLines")
        await open_dialog(pilot, "DriversDialog")
        inside = (line.split("│")[1] for line in pilot.drawn().splitlines() if "│" in line)
        drawn = "".join("".join(inside).split())
        assert "".join(why.split()) in drawn
        assert "".join(remedy.split()) in drawn
        assert drawn.index("voice") < drawn.index("head")
        await pilot.tell(m.DriverConnected(driver="voice"))
        assert "why" not in pilot.text("StatusLines")


async def test_driver_details_follow_what_happens() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "DriversDialog")
        assert "3 servos XL330" in pilot.drawn()
        await pilot.tell(m.DriverLost(driver="head", detail="unplugged", remedy="plug in the U2D2"))
        assert "head  lost" in pilot.drawn()
        assert "plug in the U2D2" in pilot.drawn()


async def test_what_changes_while_a_dialog_is_made_is_not_missed() -> None:
    class Slow(DriversDialog):
        """Something is told and painted between its making and its mounting."""

        def body(self) -> Iterable[Widget]:
            yield from super().body()
            lost = m.DriverLost(driver="head", detail="unplugged", remedy="plug in the U2D2")
            self.state.apply([lost], NOW)
            self.console_app.paint()

    async with piloted_console() as pilot:
        pilot.console.open_dialog(Slow())
        await pilot.settle()
        assert "head  lost" in pilot.drawn()


def lines_of_help(pilot: ConsolePilot) -> str:
    """All lines of the list of keys, however high the screen is."""
    dialog = pilot.console.dialog
    assert isinstance(dialog, HelpDialog)
    return "\n".join("".join(text for text, _ in row) for row in dialog.lines())


async def test_help_lists_every_key_with_reserves_and_reasons() -> None:
    async with piloted_console(size=(160, 130)) as pilot:
        await open_dialog(pilot, "HelpDialog")
        listed = lines_of_help(pilot)
        for part in ("stop everything", "type something to say", "Restoration room", "c r"):
            assert part in listed
        assert pilot.console.caps["Call staff"].why[:20] in listed
        assert "instead of ^1" in listed
        assert "^ Ctrl, A- Alt, S- Shift" in pilot.drawn()


async def test_the_keys_list_only_arrows_that_move_something() -> None:
    welcome = msgspec.structs.replace(scenes.welcome(), verbs={"head": ["nudge"]})
    async with piloted_console(welcome) as pilot:
        await open_dialog(pilot, "HelpDialog")
        listed = lines_of_help(pilot)
    assert "head to the left" in listed
    assert "drive forward" not in listed
    assert "lean left" not in listed


# -- start -------------------------------------------------------------------------------------


async def test_the_start_is_asked_only_if_nobody_is_chosen_yet() -> None:
    async with piloted_console(ask_participant=True) as pilot:
        assert pilot.console.dialog is None
    first = scenes.welcome(state=[scenes.start("", "")])
    async with piloted_console(first, ask_participant=True) as pilot:
        await pilot.until(lambda: pilot.console.dialog is not None)
        await pilot.press("enter")
        assert "needs a code" in pilot.drawn()
        await pilot.type("P12")
        await pilot.press("enter")
        assert "Choose a condition" in pilot.drawn()
        await pilot.press("tab", "down", "space", "tab")
        await pilot.type("x")
        await pilot.press("enter")
        assert "whole number" in pilot.drawn()
        await pilot.press("backspace", "4", "enter")
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert (asked.participant, asked.trial) == ("P12", 4)
        assert asked.condition in ("warm", "cold")
        await pilot.until(lambda: pilot.console.dialog is None)


async def test_the_chosen_condition_is_told_by_its_sign() -> None:
    async with piloted_console(look=Appearance(ASCII, "woz-16")) as pilot:
        await open_dialog(pilot, "StartDialog")
        await pilot.until(lambda: "(*) warm" in pilot.drawn())
        assert "( ) cold" in pilot.drawn()
        await pilot.press("tab", "down", "space")
        await pilot.until(lambda: "(*) cold" in pilot.drawn())
        assert "( ) warm" in pilot.drawn()


async def test_the_robot_process_may_refuse_a_participant() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[r.AskSet] = lambda _, ref: r.Reply(
            ref=ref, ok=False, reason="P07 took part before"
        )
        await open_dialog(pilot, "StartDialog")
        await pilot.press("enter")
        await pilot.until(lambda: "P07 took part before" in pilot.drawn())


async def test_the_console_leaves_it_to_the_robot_process_which_codes_there_are() -> None:
    """With some patterns a comparison takes seconds, in which the console would take no key."""
    first = scenes.welcome(settings={"participant_pattern": "(([A-Z]+)+)+[0-9]"})
    async with piloted_console(first) as pilot:
        pilot.feed.answers[r.AskSet] = lambda _, ref: r.Reply(
            ref=ref, ok=False, reason="it does not match the pattern"
        )
        await open_dialog(pilot, "StartDialog")
        await pilot.type("ABCDEFGH")
        await pilot.press("tab", "down", "enter", "shift+tab")
        await pilot.until(lambda: "does not match the pattern" in pilot.drawn())
        await pilot.type("1")  # what was said of another code is not said of this one
        await pilot.until(lambda: "does not match the pattern" not in pilot.drawn())


def test_trials() -> None:
    assert trial_error("") == trial_error("3") == ""
    assert trial_error("-1")


# -- preflight and reload ----------------------------------------------------------------------


async def test_preflight_lists_findings_with_remedies_and_runs_again() -> None:
    findings = [
        {"level": "ok", "subject": "head", "text": "3 servos", "remedy": ""},
        {"level": "error", "subject": "disk", "text": "3 MB free", "remedy": "make room"},
        "not a finding",
    ]
    async with piloted_console(size=(100, 40)) as pilot:
        pilot.feed.answers[r.AskPreflight] = lambda _, ref: r.Reply(ref=ref, ok=True, data=findings)
        await open_dialog(pilot, "PreflightDialog")
        await pilot.until(lambda: "1 error" in pilot.drawn())
        drawn = pilot.drawn()
        assert "connection" in drawn
        assert "This terminal cannot send some key combinations" in drawn
        assert "✓ head" in drawn
        assert "✗ disk" in drawn
        assert "make room" in drawn
        assert "key ctrl+1" in drawn
        findings[1] = {"level": "ok", "subject": "disk", "text": "9 GB free"}
        await pilot.press("enter")
        await pilot.until(lambda: "everything is ready" in pilot.drawn())


def test_preflight_judges_the_line() -> None:
    assert line_finding(23_000) == Finding("ok", "connection", "23 ms there and back")
    assert line_finding(400_000).level == "warning"
    assert line_finding(None).level == "info"
    assert kind_finding(KITTY, "?").level == "ok"


async def test_preflight_says_why_it_could_not_check() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[r.AskPreflight] = lambda _, ref: r.Reply(
            ref=ref, ok=False, reason="busy"
        )
        await open_dialog(pilot, "PreflightDialog")
        await pilot.until(lambda: "busy" in pilot.drawn())


async def test_reload_shows_differences_first_and_applies_on_enter() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[r.AskReload] = lambda _, ref: r.Reply(
            ref=ref, ok=True, data=["Hello: say changed"]
        )
        await open_dialog(pilot, "ReloadDialog")
        await pilot.until(lambda: "Hello: say changed" in pilot.drawn())
        assert [getattr(a, "dry_run", None) for a in pilot.feed.asked] == [True]
        await pilot.press("enter")
        assert [getattr(a, "dry_run", None) for a in pilot.feed.asked] == [True, False]
        await pilot.until(lambda: "File reloaded" in pilot.text("StopBar"))


async def test_reload_of_a_broken_file_shows_its_errors_and_changes_nothing() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[r.AskReload] = lambda _, ref: r.Reply(
            ref=ref, ok=False, reason="the file has 1 error(s)", data=["guide.yaml:3:1: oh"]
        )
        await open_dialog(pilot, "ReloadDialog")
        await pilot.until(lambda: "guide.yaml:3:1: oh" in pilot.drawn())
        assert "applies" not in pilot.drawn(), "there is nothing to apply"
        await pilot.press("enter")
        assert len(pilot.feed.asked) == 1
        assert pilot.console.dialog is None


# -- leaving and losing ------------------------------------------------------------------------


async def test_leaving_stays_by_default() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "LeaveDialog")
        assert "recordings/" in pilot.drawn()
        await pilot.press("enter")
        assert pilot.console.dialog is None
        assert pilot.console.is_running
        assert pilot.feed.asked == []


@pytest.mark.parametrize(("who", "changes"), [("", True), ("_P07", False)])
async def test_leaving_says_that_the_log_gets_another_name(who: str, changes: bool) -> None:
    log = f"logs/2026-03-01T10-00-00{who}_S01.jsonl"
    for role in ("wizard", "watcher"):  # a watcher does not end it
        first = scenes.welcome(role=role)
        async with piloted_console(msgspec.structs.replace(first, log=log)) as pilot:
            await open_dialog(pilot, "LeaveDialog")
            assert ("The participant's code is added" in pilot.drawn()) is (
                changes and role == "wizard"
            )


async def test_leaving_it_running() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "LeaveDialog")
        await pilot.press("down", "enter")
    assert pilot.console.return_value == "detached"
    assert pilot.feed.last(r.AskEnd) is None


async def test_ending_the_session() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "LeaveDialog")
        await pilot.press("down", "down", "enter")
        await pilot.until(lambda: "takes its rest pose" in pilot.drawn())
        assert pilot.console.is_running, "the stop is needed until the robot rests"
        pilot.feed.cut("the session has ended")
        await pilot.until(lambda: pilot.console.return_value is not None)
    assert pilot.console.return_value == "ended"
    assert pilot.feed.last(r.AskEnd) is not None


async def test_a_lost_robot_process_says_so_and_offers_a_restart() -> None:
    restarted: list[int] = []
    async with piloted_console(restart=lambda: restarted.append(1)) as pilot:
        pilot.feed.cut("the robot process closed the connection")
        await pilot.until(lambda: pilot.console.dialog is not None)
        await pilot.settle()
        drawn = pilot.drawn()
        assert "The robot process is gone" in drawn
        assert "closed the connection" in drawn
        assert "recordings/20260301-100000-P07-S01.jsonl" in drawn
        await pilot.press("enter")
        assert restarted == [], "an enter for something else may land here"
        await pilot.press("enter")
        await pilot.until(lambda: pilot.console.dialog is not None)
        await pilot.press("down", "enter")
        assert restarted == [1]
        await pilot.pass_time(20)
        assert "it is starting again" in pilot.text("StopBar")
        pilot.console.explain_loss("it did not start again: guide.yaml:3:1: no such key")
        await pilot.pass_time(20)
        assert "guide.yaml:3:1" in pilot.text("StopBar")
        await pilot.press("enter")
        assert "no such key" in pilot.drawn()
        await pilot.tell(scenes.welcome())
        pilot.console.explain_loss("another one was there before")
        await pilot.settle()
        assert pilot.console.state.lost is None
        assert "is back" in pilot.text("StopBar")


async def test_what_was_too_old_for_a_robot_process_that_woke_is_told() -> None:
    late: list[m.Message] = [
        m.ActionRequested(run="a00007", action="Hello", source="key", key="h", t=NOW + 9_000_000),
        m.ActionRefused(run="a00007", action="Hello", reason="stale: 8.0 s ago", t=NOW + 9_000_000),
    ]
    async with piloted_console() as pilot:
        pilot.feed.cut("silent")
        await pilot.until(lambda: bool(pilot.console.state.lost))
        await pilot.tell(scenes.welcome(recent=late))
        bar = pilot.text("StopBar")
        assert "not played: Hello" in bar
        assert "8.0 s ago" in bar


async def test_a_note_that_is_not_taken_is_told_and_is_there_again() -> None:
    async with piloted_console() as pilot:
        pilot.feed.cut("silent")
        await pilot.until(lambda: pilot.console.dialog is not None)
        await pilot.press("ctrl+q", "comma")
        await pilot.type("the visitor left")
        await pilot.press("enter")
        assert "connection to the robot process was lost" in pilot.text("StopBar")
        await pilot.tell(scenes.welcome())
        pilot.feed.answers[r.AskNote] = lambda asked, ref: r.Reply(ref=ref, ok=False, reason="full")
        for _ in range(2):
            await open_dialog(pilot, "NoteDialog")
            assert "the visitor left" in pilot.drawn()
            await pilot.press("enter")
        del pilot.feed.answers[r.AskNote]
        await open_dialog(pilot, "NoteDialog")
        await pilot.press("enter")
        await open_dialog(pilot, "NoteDialog")
        assert "the visitor left" not in pilot.drawn()


async def test_the_bar_of_a_loss_tells_what_can_be_done_whatever_was_told_before() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[r.AskMarker] = lambda asked, ref: r.Reply(ref=0, ok=True)  # never comes
        await pilot.press("z", "full_stop")
        pilot.feed.cut("silent")
        await pilot.until(lambda: pilot.console.dialog is not None)
        assert "what can be done" in pilot.text("StopBar")


@pytest.mark.parametrize("part", LostPart)
async def test_what_is_lost_and_what_the_robot_does_meanwhile_is_told(part: LostPart) -> None:
    async with piloted_console(restart=lambda: None) as pilot:
        pilot.feed.cut("why it is", part)
        await pilot.until(lambda: pilot.console.dialog is not None)
        await pilot.settle()
        for text in (part.title, "why it is", part.robot[:30], "own switch"):
            assert text in pilot.drawn()
        assert ("Start the robot process" in pilot.drawn()) is (part is LostPart.PROCESS)
        assert part.title in pilot.text("StopBar")
        assert part.sign in pilot.drawn()
        await pilot.press("escape")
        await pilot.until(lambda: "STOP NOT DELIVERED" in pilot.text("StopBar"))
        assert "own switch" in pilot.text("StopBar")
        assert part.robot[:60] in pilot.text("StopBar")


async def test_more_that_becomes_known_of_a_loss_is_shown() -> None:
    async with piloted_console() as pilot:
        pilot.feed.cut("nothing has come for 3 s", LostPart.ANSWER)
        await pilot.until(lambda: pilot.console.dialog is not None)
        pilot.feed.cut("robot:8765 was cut off", LostPart.LINE)
        await pilot.until(lambda: "robot:8765 was cut off" in pilot.drawn())
        assert LostPart.LINE.title in pilot.drawn()
        assert LostPart.ANSWER.title not in pilot.drawn()
        await pilot.tell(scenes.welcome())
        await pilot.until(lambda: pilot.console.dialog is None)
        assert LostPart.LINE.back in pilot.text("StopBar")


async def test_a_robot_process_that_comes_back_by_itself_closes_the_dialog() -> None:
    async with piloted_console() as pilot:
        pilot.feed.cut("silent")
        await pilot.until(lambda: pilot.console.dialog is not None)
        assert "Start the robot" not in pilot.drawn()
        await pilot.tell(scenes.welcome())
        await pilot.until(lambda: pilot.console.dialog is None)
        await pilot.press("h")
        assert pilot.feed.last(r.AskAction) is not None


async def test_a_stop_that_cannot_be_delivered_says_so() -> None:
    async with piloted_console() as pilot:
        pilot.feed.cut("silent")
        await pilot.until(lambda: pilot.console.dialog is not None)
        await pilot.press("escape")
        await pilot.until(lambda: "STOP NOT DELIVERED" in pilot.text("StopBar"))
        await pilot.press("enter")
        await pilot.until(lambda: pilot.console.dialog is not None)
