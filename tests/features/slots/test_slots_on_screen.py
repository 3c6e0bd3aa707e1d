"""A slot is filled in where the next sentence stands, before anything is said."""

from __future__ import annotations

import re
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace
from textual.widgets import Input

from tests.console import scenes
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.still_feed import StillFeed
from woz_tui.console.commands import COMMANDS
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, Glyphs
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.input.keyboard import AskedFirst, Keyboard
from woz_tui.features.scripts.kinds import AskScript, ScriptMoved
from woz_tui.features.slots.dialog import SlotDialog
from woz_tui.features.slots.kinds import SlotFilled
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import SlotView, WelcomeSettings
from woz_tui.system.clock import ManualClock

NOW = scenes.NOW
SETTINGS = {
    "colour": SlotView(["red", "blue"], heard=True, keep="participant"),
    "shape": SlotView(),
}
FULL = "Do you like {colour} more than anything else that you have ever seen in your whole life?"


def said(text: str) -> list[list[m.FilledCall] | float]:
    return [[m.FilledCall(verb="say", args={"text": text}, driver="voice")]]


def guide(*script: str, ask: str = "Do you like {colour}?", **welcome: Any) -> r.Welcome:
    """Sentences with no slot, one and two."""
    texts = {"Hello": "Hello there.", "Ask": ask, "Both": "{colour} and {shape}!"}
    slots = {"Hello": [], "Ask": ["colour"], "Both": ["colour", "shape"]}
    actions = [
        ActionView(name=name, label=name, key=key, utterances=[texts[name]], slots=slots[name])
        for name, key in (("Hello", "h"), ("Ask", "a"), ("Both", "c b"))
    ]
    filled = m.ActionsFilled(actions={name: said(text) for name, text in texts.items()}, t=NOW)
    state = [scenes.start(), *welcome.pop("state", ())]
    whole = scenes.welcome(state=[*state, filled], **welcome)
    settings = replace(WelcomeSettings(), slots=SETTINGS)
    shown = [PanelView(title="Speech", actions=actions)]
    return replace(whole, settings=settings, panels=shown, script=[*script] or ["Ask", "Hello"])


def field(pilot: ConsolePilot) -> Input:
    dialog = pilot.console.dialog
    assert isinstance(dialog, SlotDialog)
    return dialog.query_one("#slot", Input)


def rows(pilot: ConsolePilot) -> list[str]:
    """The two rows of the next sentence."""
    return [line.rstrip() for line in pilot.drawn().split("\n")[-3:-1]]


def asked(pilot: ConsolePilot, kind: type[r.Request]) -> list[r.Request]:
    return [request for request in pilot.feed.asked if isinstance(request, kind)]


async def test_two_keys_say_the_line_of_the_script_with_what_is_offered() -> None:
    async with piloted_console(guide()) as pilot:
        assert rows(pilot) == [
            " Do you like  colour ?",
            " 1  red   2  blue   asked for before it is said",
        ]
        await pilot.press("space")
        assert not asked(pilot, AskScript), "nothing is said yet"
        assert re.fullmatch(r" Do you like colour +\?", rows(pilot)[0])
        assert "enter says it" in rows(pilot)[1]
        pilot.clock.advance(0.7)
        await pilot.press("2")
        [request] = asked(pilot, AskScript)
        assert request == AskScript(
            ref=request.ref,
            to=0,
            key="space",
            slots={"colour": "blue"},
            slot_sources={"colour": "offered"},
            slots_took_us=700_000,
        )
        assert pilot.console.dialog is None


async def test_the_key_of_an_action_asks_for_each_slot_and_what_is_typed_is_said() -> None:
    async with piloted_console(guide("Hello")) as pilot:
        await pilot.press("c", "b")
        await pilot.type("deep green")
        await pilot.press("enter")
        assert rows(pilot)[0].startswith(" deep green and shape "), "it says what it asks for"
        await pilot.press("1", "enter")
        [request] = asked(pilot, r.AskAction)
        assert isinstance(request, r.AskAction)
        assert (request.action, request.key) == ("Both", "c b")
        assert request.slots == {"colour": "deep green", "shape": "1"}, "nothing is offered for it"
        assert request.slot_sources == {"colour": "typed", "shape": "typed"}


async def test_tab_takes_words_that_were_heard() -> None:
    async with piloted_console(guide()) as pilot:
        text = m.SpeechText(driver="ears", segment=1, text="I like the blue one, wonderful!", t=NOW)
        own = m.SpeechText(driver="ears", segment=2, text="Hello.", own=True, t=NOW)
        await pilot.tell(replace(text, seq=101), replace(own, seq=102))
        assert "tab  blue" in rows(pilot)[1]
        await pilot.press("a", "tab")
        assert field(pilot).value == "blue", "what the file offers comes first"
        await pilot.press("tab")
        assert field(pilot).value == "wonderful"
        await pilot.press("enter")
        [request] = asked(pilot, r.AskAction)
        assert isinstance(request, r.AskAction)
        assert request.slots == {"colour": "wonderful"}
        assert request.slot_sources == {"colour": "heard"}


async def test_words_that_were_heard_outlast_a_lost_line() -> None:
    """The last lines that come anew may not reach back to them."""
    async with piloted_console(guide()) as pilot:
        text = m.SpeechText(driver="ears", segment=1, text="The blue one, wonderful!", t=NOW)
        await pilot.tell(replace(text, seq=101))
        await pilot.tell(guide())
        await pilot.press("a", "tab")
        assert field(pilot).value == "blue"
        await pilot.press("ctrl+q")
        other = guide()
        lines = [bytes(line).replace(b'"seed":', b'"seed":9') for line in other.state]
        await pilot.tell(replace(other, state=[msgspec.Raw(line) for line in lines]))
        await pilot.press("a", "tab")
        assert field(pilot).value == "", "of another session they are nobody's"


async def test_ctrl_q_leaves_and_escape_stops() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("a")
        await pilot.type("gr")
        await pilot.press("ctrl+q")
        assert pilot.console.dialog is None
        assert not asked(pilot, r.AskStop)
        await pilot.press("a", "escape")
        assert pilot.console.dialog is None
        assert len(asked(pilot, r.AskStop)) == 1
        assert not asked(pilot, r.AskAction)


async def test_nothing_is_not_said_and_the_field_says_why() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("a", "enter")
        assert "colour is empty" in rows(pilot)[1]
        assert not asked(pilot, r.AskAction)


async def test_what_is_kept_is_said_at_once_and_asked_for_anew_behind_the_apostrophe() -> None:
    kept = SlotFilled(
        run="a1", slot="colour", text="red", source="typed", keep="participant", participant="P07"
    )
    async with piloted_console(guide(ask="Do you like red?", state=[replace(kept, t=1)])) as pilot:
        assert "Do you like red?" in rows(pilot)[0]
        await pilot.press("a")
        assert pilot.console.dialog is None
        [request] = asked(pilot, r.AskAction)
        assert isinstance(request, r.AskAction)
        assert request.slots == {}
        await pilot.press("apostrophe", "a")
        assert field(pilot).value == "red"
        await pilot.press("2")
        last = asked(pilot, r.AskAction)[-1]
        assert isinstance(last, r.AskAction)
        assert last.slots == {"colour": "blue"}


async def test_the_finder_asks_too() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("colon")
        await pilot.type("Ask")
        await pilot.press("enter")
        await pilot.press("1")
        [request] = asked(pilot, r.AskAction)
        assert isinstance(request, r.AskAction)
        assert (request.source, request.slots) == ("palette", {"colour": "red"})


async def test_a_line_of_the_script_that_is_over_is_not_asked_for_any_more() -> None:
    async with piloted_console(guide()) as pilot:
        await pilot.press("space")
        await pilot.tell(ScriptMoved(position=1, played=[0], seq=101, t=NOW))
        assert pilot.console.dialog is None


async def test_nobody_is_asked_about_what_is_stopped() -> None:
    stopped = m.StopPressed(scope="all", source="key", t=NOW)
    async with piloted_console(guide(state=[stopped])) as pilot:
        await pilot.press("a")
        assert pilot.console.dialog is None
        assert len(asked(pilot, r.AskAction)) == 1, "the robot process says why it is refused"


@pytest.mark.parametrize("glyphs", [UNICODE, ASCII])
async def test_many_offers_leave_room_for_what_the_keys_do(glyphs: Glyphs) -> None:
    whole = guide()
    long = [f"a rather long colour {number}" for number in range(9)]
    slots = {"colour": SlotView(long), "shape": SlotView()}
    full = replace(whole, settings=replace(whole.settings, slots=slots))
    async with piloted_console(full, look=Appearance(glyphs)) as it:
        assert rows(it)[1].endswith(f"{glyphs.ellipsis} asked for before it is said")
        await it.press("space")
        assert rows(it)[1].endswith(f"{glyphs.ellipsis} enter says it")
        await it.press("ctrl+q", "c", "b", "1")
        hint = glyphs.plain(" type what stands here enter says it · ctrl+q closes")
        assert rows(it)[1] == hint


@pytest.mark.parametrize("size", [(80, 24), (60, 20), (160, 50)])
async def test_a_long_sentence_leaves_room_for_the_field(size: tuple[int, int]) -> None:
    async with piloted_console(guide(ask=FULL), size=size) as pilot:
        before = pilot.drawn().split("\n")
        assert "colour" in before[-3]
        await pilot.press("space")
        await pilot.type("x" * 60)
        drawn = pilot.drawn().split("\n")
        assert all(len(line) == size[0] for line in drawn)
        assert "xxx" in drawn[-3]
        assert "like" in drawn[-3]
        assert before[-1] == drawn[-1], "the hints stay"


def test_what_is_typed_behind_the_key_waits_for_the_field() -> None:
    feed = StillFeed()
    keyboard = Keyboard(feed, ManualClock())
    keyboard.bind(
        {"a": "Ask", "c b": "Both", "b": "Blue"}, {k.chord: c for c in COMMANDS for k in c.keys}
    )
    keyboard.asks_first = {"Ask": "Ask", "Both": "Both", "script_next": "Ask"}
    for chords, what in (("a", "Ask"), ("c b", "Both"), ("space", "script_next")):
        *first, last = chords.split()
        for chord in first:
            assert keyboard.arrive(chord)
        assert not keyboard.arrive(last)
        handled = keyboard.leave_to_screen(last)
        assert not keyboard.arrive("x"), "it belongs into the field"
        over = keyboard.leave_to_screen("x")
        assert keyboard.take_asked_first(last) == AskedFirst(last, chords, what)
        handled()
        over()
        keyboard._clock.advance(2)  # type: ignore[attr-defined]
    assert feed.asked == []
    keyboard.arrive("a", stale=True)
    [late] = feed.asked
    assert isinstance(late, r.AskAction)
    assert late.stale, "what came too late is refused, and in the log"
