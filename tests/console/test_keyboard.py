from __future__ import annotations

import threading

import pytest

from tests.console.still_feed import StillFeed
from woz_tui.console.commands import COMMANDS, by_key
from woz_tui.console.input.keyboard import (
    EARLY_LIMIT,
    LATE_AT_ONCE,
    LATE_EVERY_S,
    SEQUENCE_S,
    ArrowSizes,
    Keyboard,
)
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol.requests import (
    AskAction,
    AskMarker,
    AskMistake,
    AskStop,
    AskVerb,
)
from woz_tui.system.clock import ManualClock

OWN = {key.chord: command for command in COMMANDS for key in command.keys}
TABLE = {"h": "Hello", "f1": "Happy", "c r": "Circle", "c s": "Square", "x": "Exit", "r": "Red"}


class Rig:
    def __init__(self) -> None:
        self.feed = StillFeed()
        self.clock = ManualClock()
        self.keyboard = Keyboard(
            self.feed, self.clock, ArrowSizes(head=4, hip=2, drive=0.2, turn=15)
        )
        self.keyboard.bind(TABLE, OWN)
        self.pressed: list[tuple[str, str, int]] = []
        self.stale: list[tuple[str, str, int]] = []
        self.prefixes: list[str] = []
        self.keyboard.on_pressed = lambda *press: self.pressed.append(press)
        self.keyboard.on_stale = lambda *press: self.stale.append(press)
        self.keyboard.on_prefix = self.prefixes.append


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_a_bound_key_is_asked_for_and_shown(rig: Rig) -> None:
    assert rig.keyboard.press("h", age_us=7)

    assert rig.feed.asked == [AskAction(action="Hello", source="key", key="h", age_us=7)]
    assert rig.pressed == [("h", "Hello", 1)]


def test_before_there_is_a_session_letters_are_kept_and_nothing_is_played(rig: Rig) -> None:
    rig.keyboard.wait_for_session(["P", "enter"])
    for chord in ("h", "backspace", "0", "f1", "ctrl+d", "7", "enter"):
        assert rig.keyboard.arrive(chord)
    assert not rig.keyboard.arrive("ctrl+q"), "who wants to leave can"
    rig.keyboard.stop("escape")
    assert rig.feed.asked == [AskStop(source="key")]
    assert rig.keyboard.session_came() == "P07"
    assert rig.keyboard.session_came() == ""
    assert rig.keyboard.arrive("h")
    assert isinstance(rig.feed.asked[-1], AskAction)


def test_what_is_typed_early_has_an_end(rig: Rig) -> None:
    rig.keyboard.wait_for_session("x" * 10_000)
    assert len(rig.keyboard.session_came()) == EARLY_LIMIT


def test_an_unbound_key_is_left_to_the_screen(rig: Rig) -> None:
    assert not rig.keyboard.press("q")
    assert rig.feed.asked == []


def test_nothing_is_played_while_a_text_field_has_the_keyboard(rig: Rig) -> None:
    rig.keyboard.free = False

    assert not rig.keyboard.press("h")
    assert not rig.keyboard.press("space")
    assert rig.feed.asked == []


def test_the_stop_works_while_a_text_field_has_the_keyboard(rig: Rig) -> None:
    rig.keyboard.free = False
    rig.keyboard.stop("escape")

    assert rig.feed.asked == [AskStop(source="key")]
    assert rig.pressed == [("escape", "", 1)]


def test_no_table_can_take_the_stop_away(rig: Rig) -> None:
    rig.keyboard.bind({"escape": "Hello", "ctrl+c": "Hello"})

    assert not rig.keyboard.press("escape")
    assert not rig.keyboard.press("ctrl+c")


# -- sequences ------------------------------------------------------------------------------------


def test_two_keys_play_their_action(rig: Rig) -> None:
    assert rig.keyboard.press("c")
    assert rig.prefixes == ["c"]
    assert rig.keyboard.press("r")

    assert [request.key for request in rig.feed.asked if isinstance(request, AskAction)] == ["c r"]
    assert rig.prefixes == ["c", ""]
    assert rig.pressed == [("c r", "Circle", 1)]


def test_the_second_key_must_come_in_time(rig: Rig) -> None:
    rig.keyboard.press("c")
    rig.clock.advance(SEQUENCE_S + 0.1)
    rig.keyboard.tick()
    assert rig.prefixes == ["c", ""]
    rig.keyboard.press("r")

    assert rig.pressed == [("r", "Red", 1)]


def test_a_late_second_key_counts_by_itself_without_any_tick(rig: Rig) -> None:
    rig.keyboard.press("c")
    rig.clock.advance(SEQUENCE_S + 0.1)
    rig.keyboard.press("r")

    assert rig.pressed == [("r", "Red", 1)]


def test_a_key_that_does_not_follow_counts_by_itself(rig: Rig) -> None:
    rig.keyboard.press("c")
    rig.keyboard.press("h")

    assert rig.pressed == [("h", "Hello", 1)]
    assert rig.prefixes == ["c", ""]


def test_the_first_key_again_begins_again(rig: Rig) -> None:
    for key in "ccs":
        rig.keyboard.press(key)

    assert rig.pressed == [("c s", "Square", 1)]


@pytest.mark.parametrize("end", ["stop", "dialog", "bind"])
def test_what_ends_a_sequence(rig: Rig, end: str) -> None:
    rig.keyboard.press("c")
    if end == "stop":
        rig.keyboard.stop("ctrl+c")
    elif end == "dialog":
        rig.keyboard.free = False
        rig.keyboard.free = True
    else:
        rig.keyboard.bind(TABLE)
    rig.pressed.clear()
    rig.keyboard.press("r")

    assert [(chord, action) for chord, action, _ in rig.pressed] == [("r", "Red")]


# -- the console's own keys -----------------------------------------------------------------------


def test_own_keys_that_need_no_dialog(rig: Rig) -> None:
    for chord in ("space", ".", "backspace"):
        assert rig.keyboard.press(chord)

    script = AskScript(key="space")
    assert rig.feed.asked == [script, AskMarker(), AskMistake()]
    assert all(action == "" for _, action, _ in rig.pressed)


def test_own_keys_that_need_a_dialog_are_left_to_the_screen(rig: Rig) -> None:
    for chord, command in OWN.items():
        if command.name in ("say", "find", "note", "help", "leave", "preflight", "release"):
            assert not rig.keyboard.press(chord), command.name


def test_moved_own_keys(rig: Rig) -> None:
    rig.keyboard.bind(TABLE, {";": by_key(COMMANDS)["marker"]})

    assert rig.keyboard.press(";")
    assert not rig.keyboard.press(".")


@pytest.mark.parametrize(
    ("chord", "verb", "args"),
    [
        ("up", "nudge", {"pitch": -4}),
        ("down", "nudge", {"pitch": 4}),
        ("left", "nudge", {"yaw": 4}),
        ("right", "nudge", {"yaw": -4}),
        ("shift+up", "hip", {"pitch": 2}),
        ("shift+right", "hip", {"roll": -2}),
        ("alt+up", "drive", {"x": 0.2}),
        ("alt+down", "drive", {"x": -0.2}),
        ("alt+left", "drive", {"turn": 15}),
        ("alt+right", "drive", {"turn": -15}),
    ],
)
def test_arrows_move_what_the_robot_has(
    rig: Rig, chord: str, verb: str, args: dict[str, float]
) -> None:
    assert not rig.keyboard.press(chord), "no driver offers it yet"
    rig.keyboard.verbs = {"body": ["say", verb]}

    assert rig.keyboard.press(chord)
    (request,) = rig.feed.asked
    assert isinstance(request, AskVerb)
    assert (request.verb, request.args, request.key) == (verb, args, chord)
    assert request.when_busy == "replace"


# -- stale presses --------------------------------------------------------------------------------


def test_a_stale_action_is_asked_for_as_stale_and_listed(rig: Rig) -> None:
    assert rig.keyboard.arrive("h", stale=True)

    assert rig.feed.asked == [AskAction(action="Hello", source="key", key="h", stale=True)]
    assert rig.stale == [("h", "Hello", 1)]
    assert rig.pressed == []


def test_a_stale_step_of_the_script_and_a_stale_arrow_are_in_the_log_too(rig: Rig) -> None:
    rig.keyboard.verbs = {"head": ["nudge"]}

    assert rig.keyboard.arrive("space", age_us=5, stale=True)
    assert rig.keyboard.arrive("up", stale=True)
    script, nudge = rig.feed.asked
    assert script == AskScript(key="space", age_us=5, stale=True)
    assert isinstance(nudge, AskVerb)
    assert (nudge.verb, nudge.stale) == ("nudge", True)
    assert rig.stale == [("space", "script_next", 1), ("up", "head_up", 2)]
    assert rig.pressed == []


@pytest.mark.parametrize("chord", ["ctrl+r", ".", "c", "/", "q"])
def test_other_stale_keys_are_listed_and_do_nothing(rig: Rig, chord: str) -> None:
    rig.keyboard.verbs = {"head": ["nudge"]}

    assert rig.keyboard.arrive(chord, stale=True)
    assert rig.feed.asked == []
    assert [press[0] for press in rig.stale] == [chord]
    assert not rig.prefixes


def test_of_a_flood_of_late_keys_a_few_are_told(rig: Rig) -> None:
    for _ in range(1000):
        assert rig.keyboard.arrive("h", stale=True)
        assert rig.keyboard.arrive("q", stale=True)
    assert len(rig.stale) == LATE_AT_ONCE
    assert len(rig.feed.asked) == LATE_AT_ONCE / 2

    rig.keyboard.stop("escape")
    assert rig.feed.asked[-1] == AskStop(source="key")
    rig.clock.advance(LATE_EVERY_S)
    assert rig.keyboard.arrive("h", stale=True)
    assert len(rig.stale) == LATE_AT_ONCE + 1


def test_a_flood_of_late_keys_that_a_dialog_does_not_take_is_told_a_few_times(rig: Rig) -> None:
    rig.keyboard.takes_late = lambda chord: False
    rig.keyboard.free = False
    for _ in range(1000):
        assert rig.keyboard.arrive("h", stale=True)
    assert len(rig.stale) == LATE_AT_ONCE


# -- order with the screen ------------------------------------------------------------------------


def test_behind_a_key_that_opens_a_dialog_keys_wait_for_the_screen(rig: Rig) -> None:
    keyboard = rig.keyboard
    assert not keyboard.arrive("/")
    first = keyboard.leave_to_screen("/")
    assert not keyboard.arrive("h")
    second = keyboard.leave_to_screen("h")
    first()
    assert not keyboard.arrive("h")
    second()

    assert keyboard.arrive("h")


def test_behind_a_key_that_opens_nothing_nobody_waits(rig: Rig) -> None:
    for chord in ("q", "tab", "|"):
        assert not rig.keyboard.arrive(chord)
        rig.keyboard.leave_to_screen(chord)

    assert rig.keyboard.arrive("h")


def test_behind_a_key_that_cuts_a_run_short_the_rest_waits(rig: Rig) -> None:
    """It cuts what is under way when the screen gets it: nothing new may begin before."""
    assert not rig.keyboard.arrive("ctrl+x")
    handled = rig.keyboard.leave_to_screen("ctrl+x")
    assert not rig.keyboard.arrive("h")
    handled()
    assert rig.keyboard.arrive("h")


def test_the_script_moves_and_plays_in_the_order_of_the_keys(rig: Rig) -> None:
    for chord in (">", "space"):
        assert rig.keyboard.arrive(chord)
    moved, played = rig.feed.asked
    assert isinstance(moved, AskScript) and isinstance(played, AskScript)
    assert (moved.play, moved.by, played.play) == (False, 1, True)


def test_late_keys_are_typed_into_a_dialog_as_far_as_it_says(rig: Rig) -> None:
    rig.keyboard.takes_late = lambda chord: chord != "enter"
    rig.keyboard.free = False
    assert not rig.keyboard.arrive("a", stale=True)
    assert rig.keyboard.arrive("enter", stale=True), "nothing is sent by it"
    assert rig.stale == [("enter", "", 0)]
    assert not rig.keyboard.arrive("enter")


def test_a_key_that_counts_once_counts_when_the_screen_has_it(rig: Rig) -> None:
    keyboard = rig.keyboard
    assert not keyboard.arrive("enter")
    handled = keyboard.leave_to_screen("enter")
    assert not keyboard.press("enter"), "it is the same press, and not held"
    handled()
    assert keyboard.press("enter"), "it is pressed again at once"


def test_the_rest_of_a_held_key_does_nothing_in_the_dialog_that_it_opened(rig: Rig) -> None:
    assert not rig.keyboard.arrive("enter")
    rig.keyboard.leave_to_screen("enter")
    rig.keyboard.free = False
    for _ in range(3):
        rig.clock.advance(0.1)
        assert rig.keyboard.arrive("enter")
    rig.clock.advance(1.0)
    assert not rig.keyboard.arrive("enter"), "pressed on purpose"
    rig.clock.advance(0.1)
    assert not rig.keyboard.arrive("enter"), "the same key twice is typed twice"


def test_the_rest_of_an_enter_that_sent_something_shows_no_failures(rig: Rig) -> None:
    rig.keyboard.free = False
    assert not rig.keyboard.arrive("enter")
    rig.keyboard.free = True
    rig.clock.advance(0.1)
    assert rig.keyboard.arrive("enter")
    rig.clock.advance(1.0)
    assert not rig.keyboard.arrive("enter"), "left to the screen, which shows them"


@pytest.mark.parametrize("free", [True, False])
def test_what_was_typed_before_a_stop_plays_nothing_after_it(rig: Rig, free: bool) -> None:
    keyboard = rig.keyboard
    keyboard.free = free
    handled = [keyboard.leave_to_screen(chord) for chord in "/h"]
    keyboard.stop("escape")
    keyboard.free = True  # the stop closed the dialog
    assert keyboard.arrive("x"), "keys behind the stop count at once"
    assert keyboard.press("/")
    handled[0]()
    assert keyboard.press("h")
    handled[1]()

    assert [type(request) for request in rig.feed.asked] == [AskStop, AskAction]
    assert keyboard.press("h")
    assert len(rig.feed.asked) == 3


def test_the_key_for_suspending_works_in_a_text_field_too(rig: Rig) -> None:
    suspended = []
    rig.keyboard.on_suspend = lambda: suspended.append(True)
    rig.keyboard.free = False

    assert rig.keyboard.arrive("ctrl+z")
    assert suspended == [True]


def test_presses_of_several_threads_all_count(rig: Rig) -> None:
    threads = [
        threading.Thread(target=lambda: [rig.keyboard.press("h") for _ in range(200)])
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert len(rig.feed.asked) == 800
