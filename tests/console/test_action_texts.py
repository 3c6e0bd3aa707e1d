"""What an action says, wherever it stands: beside its label, in finder, peek and events."""

from __future__ import annotations

import msgspec
import pytest
from textual.widgets import OptionList

from tests.console import scenes
from tests.console.dialogs import open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.scripted_feed import raw
from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.features.scripts.kinds import AskScript, ScriptMoved
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import StudySettings, WelcomeSettings

NOW = scenes.NOW
KRILL = "Whales eat four tonnes of krill a day."


def call(verb: str, **more: object) -> m.FilledCall:
    return msgspec.convert({"verb": verb, **more}, m.FilledCall)


def says(text: str) -> list[m.FilledCall]:
    return [call("say", args={"text": text}, driver="voice")]


FILLED = m.ActionsFilled(
    t=NOW,
    actions={
        "Food": [says(KRILL)],
        "Look": [[call("gaze", args={"yaw": 20.0, "pitch": 0.0})]],
        "Show": [
            [*says("This is the krill tank."), call("play", args={"move": "point-left"})],
            0.5,
            [call("gaze", args={"yaw": 0.0})],
        ],
        "Secret": [
            [
                call(
                    "say",
                    args={"text": HIDDEN_TEXT},
                    tells=["condition"],
                    unfilled={"text": HIDDEN_TEXT},
                )
            ]
        ],
    },
)


def guide(*recent: m.Message, blind: bool = False) -> r.Welcome:
    actions = [
        ActionView(name="Look", label="Look at the krill", key="l", verbs=["gaze"]),
        ActionView(name="Food", label="Food", key="f", verbs=["say"]),
        ActionView(name="Show", label="Tank", key="c r", verbs=["say", "play", "gaze"]),
        ActionView(name="Secret", label="Secret", key="s", verbs=["say"]),
    ]
    study = StudySettings(blind={"A": "A", "B": "B"} if blind else {})
    return msgspec.structs.replace(
        scenes.welcome(state=[scenes.start(), FILLED, *recent]),
        panels=[PanelView(title="Whales", actions=actions)],
        script=["Show", "Secret"],
        settings=WelcomeSettings(study=study),
    )


def finder_lines(pilot: ConsolePilot) -> list[str]:
    return [
        str(option.prompt)
        for option in pilot.console.screen.query_one("#found", OptionList).options
    ]


async def test_the_finder_sorts_by_label_then_by_what_is_said() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("krill")
        names = [line[7:].split("  ")[0] for line in finder_lines(pilot)]
        assert names[:3] == ["Look at the krill", "Food", "Tank"]
        assert "Whales eat four" in finder_lines(pilot)[1]
        await pilot.press("down", "enter")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "Food"


async def test_a_command_of_the_console_keeps_its_name() -> None:
    """Enter would make the robot speak where the wizard wants to write a note."""
    loud = msgspec.structs.replace(FILLED, actions={"Food": [says("Please note the teeth.")]})
    async with piloted_console(guide(loud)) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("note")
        first, second = finder_lines(pilot)[:2]
        assert "write a note" in first
        assert "Food" in second


async def test_the_finder_says_that_it_found_nothing_and_enter_then_does_nothing() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("xyzzy")
        assert finder_lines(pilot) == ["Nothing found: other letters, or ctrl+q"]
        await pilot.press("enter")
        assert type(pilot.console.dialog).__name__ == "FindDialog"


async def test_enter_in_the_finder_asks_before_it_locks_a_panel() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("lock")
        assert "Lock Whales" in finder_lines(pilot)[0]
        await pilot.press("enter", "enter")
        assert pilot.console.dialog is None
        assert pilot.feed.last(r.AskLock) is None
        await open_dialog(pilot, "FindDialog")
        await pilot.type("lock")
        await pilot.press("enter")
        assert "Lock Whales? Its keys then play nothing." in pilot.drawn()
        await pilot.press("down", "enter")
        assert isinstance(pilot.feed.last(r.AskLock), r.AskLock)


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("help", "list of all keys"),
        ("volume", "the robot's settings"),
        ("stop", "stop everything"),
        ("end", "quit: end the session or leave"),
    ],
)
async def test_the_finder_knows_other_words_for_the_consoles_commands(word: str, line: str) -> None:
    loud = {"Food": [says("Please help me to stop the volume at the end.")]}
    first = guide(msgspec.structs.replace(FILLED, actions=loud))
    async with piloted_console(first) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type(word)
        assert line in finder_lines(pilot)[0]
        await pilot.press("enter")
        if word == "stop":
            assert isinstance(pilot.feed.last(r.AskStop), r.AskStop)


async def test_a_word_that_is_nowhere_carries_out_no_command() -> None:
    """`terrible` has the letters of `the robot's body`, scattered: enter would have opened it."""
    first = guide()
    repairs = [ActionView(name="repair interrupt", label="interrupt", verbs=["say"])]
    settings = msgspec.structs.replace(first.settings, repairs=repairs)
    async with piloted_console(msgspec.structs.replace(first, settings=settings)) as pilot:
        await open_dialog(pilot, "FindDialog")
        for letters in ("ert", "trob", "obo", "rerup", "nte"):
            await pilot.type(letters)
            names = [line[7:45].strip() for line in finder_lines(pilot)]
            assert not {"the robot's body", "repair: interrupt", "write a note"} & {*names}
            await pilot.press(*["backspace"] * len(letters))
        for letters, name in (("bod", "body"), ("robot's", "body"), ("write no", "note")):
            await pilot.type(letters)
            assert any(name in line for line in finder_lines(pilot))
            await pilot.press(*["backspace"] * len(letters))


async def test_a_repair_is_found_and_peeked_at_by_what_it_says() -> None:
    first = guide(msgspec.structs.replace(FILLED, actions={"repair yes": [says("Yes, indeed.")]}))
    view = ActionView(name="repair yes", label="yes", verbs=["say"])
    settings = msgspec.structs.replace(first.settings, repairs=[view])
    async with piloted_console(msgspec.structs.replace(first, settings=settings)) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("indeed")
        assert "“Yes, indeed.”" in finder_lines(pilot)[0]
        await pilot.press("ctrl+q")
        await open_dialog(pilot, "PeekDialog")
        await pilot.press("left_parenthesis")
        assert "Yes, indeed." in pilot.drawn()


async def test_the_finder_has_no_hit_for_what_is_kept() -> None:
    async with piloted_console(guide(blind=True)) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type(HIDDEN_TEXT)
        assert not any("Secret" in line for line in finder_lines(pilot))
        await pilot.press("backspace", "backspace", "backspace")
        await pilot.type("secret")
        assert HIDDEN_TEXT not in finder_lines(pilot)[0]


def played(pilot: ConsolePilot) -> list[str]:
    return [asked.action for asked in pilot.feed.asked if isinstance(asked, r.AskAction)]


async def test_a_peek_shows_steps_and_sentence_and_plays_nothing() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "PeekDialog")
        shown = pilot.drawn()
        assert "Tank" in shown  # the script's next line, before any key
        assert "Spc plays it next" in shown or "Space plays it next" in shown
        await pilot.press("f")
        assert KRILL in pilot.drawn()
        assert "any key closes this" in pilot.drawn()
        await pilot.press("apostrophe")
        assert pilot.console.dialog is None
        await pilot.press("apostrophe", "c")
        assert "waits for its second key" in pilot.drawn()
        await pilot.press("r")
        shown = pilot.drawn()
        for part in ("“This is the krill tank.”", "play point-left", "wait 0.5 s", "gaze yaw 0"):
            assert part in shown
        assert not played(pilot)


async def test_a_peek_ends_with_the_next_key_which_does_what_it_does() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("apostrophe", "f", "l")
        assert pilot.console.dialog is None
        assert played(pilot) == ["Look"]
        await pilot.press("apostrophe", "space")
        assert pilot.console.dialog is None
        assert isinstance(pilot.feed.last(AskScript), AskScript)
        await pilot.press("apostrophe", "slash")
        assert type(pilot.console.dialog).__name__ == "SayDialog"
        await pilot.press("ctrl+q", "apostrophe", "z")
        assert pilot.console.dialog is None
        assert "z is not assigned" in pilot.drawn()
        await pilot.press("apostrophe", "l", "c", "r")
        assert played(pilot) == ["Look", "Show"]


async def test_the_key_that_a_peek_shows_plays_when_pressed_again_but_not_held() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("apostrophe", "f", "f", "f")
        assert KRILL in pilot.drawn()
        assert not played(pilot)
        pilot.clock.advance(2)
        await pilot.press("f")
        assert pilot.console.dialog is None
        assert played(pilot) == ["Food"]


async def test_escape_stops_from_a_peek() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "PeekDialog")
        await pilot.press("escape")
        assert isinstance(pilot.feed.last(r.AskStop), r.AskStop)
        assert pilot.console.dialog is None


async def test_what_is_kept_is_named_as_kept() -> None:
    async with piloted_console(guide(ScriptMoved(position=1), blind=True)) as pilot:
        assert "what it says is kept from you" in pilot.text("StopBar")
        await open_dialog(pilot, "PeekDialog")
        await pilot.press("s")
        assert "what it says is kept from you" in pilot.drawn()


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_wide_screens_show_the_sentence_beside_the_label(size: tuple[int, int]) -> None:
    async with piloted_console(guide(), size=size) as pilot:
        beside = "Food  “Whales eat four tonnes" in pilot.text("ActionPanels")
        assert beside == (size[0] > 100)
        assert "Secret  “" not in pilot.text("ActionPanels")


async def test_the_event_row_of_what_was_said_has_the_text() -> None:
    async with piloted_console(guide(), size=(160, 50)) as pilot:
        await pilot.tell(*pressed_action("a1", "Food", KRILL))
        assert "Food “Whales eat four tonnes" in pilot.text("EventList")
        await pilot.tell(m.ActionDone(run="a1", action="Food", t=NOW + 2_400_000))
        row = pilot.text("EventList").splitlines()[1]
        assert "Food “Whales eat four tonnes" in row
        assert row.rstrip().endswith("2.4 s")


async def test_the_screen_says_what_was_marked_as_a_mistake() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.tell(*pressed_action("a1", "Food", KRILL))
        await pilot.tell(*pressed_action("a2", "Look", ""))  # it waits behind that
        mine = pilot.console.state.console
        await pilot.tell(m.Mistake(run="a1", action="Food", console=mine, t=NOW))
        assert "Marked as a mistake: Food “Whales eat four" in pilot.text("StopBar")
        await pilot.tell(m.Mistake(run="gone", action="Look", console=mine, t=NOW))
        assert "Marked as a mistake: Look at the krill" in pilot.text("StopBar")
        await pilot.tell(m.Mistake(run="a1", action="Food", console="con9", t=NOW))
        assert "Look at the krill" in pilot.text("StopBar"), "another wizard's is theirs"


async def test_the_event_of_a_mistake_has_what_was_said() -> None:
    async with piloted_console(guide(), size=(160, 50)) as pilot:
        await pilot.tell(
            m.Command(
                command="c1", driver="robot", verb="say", args={"text": "Hi."}, source="key", t=NOW
            ),
            m.Mistake(run="c1", action="say", t=NOW),
        )
        assert "Mistake: “Hi.”" in pilot.text("EventList")


async def test_what_is_kept_is_not_told_of_a_mistake() -> None:
    async with piloted_console(guide(blind=True)) as pilot:
        await pilot.tell(*pressed_action("a1", "Secret", HIDDEN_TEXT, ("condition",)))
        mine = pilot.console.state.console
        await pilot.tell(m.Mistake(run="a1", action="Secret", console=mine, t=NOW))
        row = pilot.text("StopBar")
        assert "Marked as a mistake: Secret" in row
        assert HIDDEN_TEXT not in row


async def test_how_long_a_kept_text_took_is_kept_too() -> None:
    async with piloted_console(guide(blind=True), size=(160, 50)) as pilot:
        told = pressed_action("a1", "Secret", HIDDEN_TEXT, ("condition",))
        await pilot.tell(*told, m.ActionDone(run="a1", action="Secret", t=NOW + 2_400_000))
        row = pilot.text("EventList").splitlines()[1]
        assert row.split()[1:] == ["✓", "Secret"]


async def test_what_depends_on_the_condition_is_just_running() -> None:
    """Also while a gesture beside it has a length that anybody may know."""
    secret = [call("say", args={"text": HIDDEN_TEXT}, tells=["condition"]), call("play", args={})]
    filled = msgspec.structs.replace(FILLED, actions={"Secret": [secret]})
    wave = m.Command(command="c2", run="a1", verb="play", args={}, source="key", t=NOW, seq=9002)
    for blind in (True, False):
        async with piloted_console(guide(filled, blind=blind), size=(160, 50)) as pilot:
            told = pressed_action("a1", "Secret", HIDDEN_TEXT, ("condition",))
            dispatched = m.Dispatched(command="c2", driver="robot", latency_us=0, t=NOW)
            await pilot.tell(*told, wave, dispatched)
            await pilot.tell(m.Progress(command="c2", expected_us=2_000_000, t=NOW))
            assert ("left" in pilot.text("EventList")) is not blind
            button = next(
                line for line in pilot.text("ActionPanels").splitlines() if "Secret" in line
            )
            assert ("2.0" in button) is not blind


async def test_a_late_console_has_text_and_sentence() -> None:
    first = msgspec.structs.replace(guide(), recent=raw(pressed_action("a1", "Food", KRILL)))
    async with piloted_console(first, size=(160, 50)) as pilot:
        assert "Food “Whales eat four" in pilot.text("EventList")
        assert "This is the krill tank." in pilot.text("StopBar")


def pressed_action(
    run: str, action: str, text: str, tells: tuple[str, ...] = ()
) -> list[m.Message]:
    return [
        m.ActionRequested(run=run, action=action, source="key", t=NOW, seq=9000),
        m.Command(
            command="c1",
            run=run,
            action=action,
            verb="say",
            args={"text": text},
            driver="voice",
            source="key",
            tells=tells,
            unfilled={"text": HIDDEN_TEXT} if tells else {},
            t=NOW,
            seq=9001,
        ),
    ]


def on_button(pilot: ConsolePilot, label: str) -> str:
    return next(line for line in pilot.text("ActionPanels").splitlines() if f" {label} " in line)


async def test_a_button_shows_what_its_run_says_and_not_what_the_next_would_say() -> None:
    """Of an action with several wordings the next one is ready as soon as one is played."""
    wordings = ("Please go on.", "What else?", "Tell me more.")
    first, second, third = (scenes.actions_filled("Food", text) for text in wordings)
    async with piloted_console(guide(), size=(120, 30)) as pilot:
        await pilot.tell(msgspec.structs.replace(first, t=NOW))
        action_requested = m.ActionRequested(run="r1", action="Food", source="key", t=NOW)
        await pilot.tell(action_requested, msgspec.structs.replace(second, t=NOW))
        assert wordings[0] in on_button(pilot, "Food")  # before any command: it is held back
        command = m.Command(
            command="c1",
            run="r1",
            action="Food",
            verb="say",
            args={"text": wordings[0]},
            source="key",
            t=NOW,
        )
        await pilot.tell(command, msgspec.structs.replace(action_requested, run="r2"))
        assert wordings[0] in on_button(pilot, "Food")
        await pilot.tell(msgspec.structs.replace(third, t=NOW))
        await pilot.tell(m.ActionDone(run="r1", action="Food", t=NOW))
        assert wordings[1] in on_button(pilot, "Food")  # the second waits
        await pilot.tell(m.ActionDone(run="r2", action="Food", t=NOW))
        assert "✓" in on_button(pilot, "Food")
        assert wordings[1] in on_button(pilot, "Food")
        await pilot.tell(m.Marker(t=NOW + 60_000_000))
        assert "✓" not in on_button(pilot, "Food")
        assert wordings[2] in on_button(pilot, "Food")
