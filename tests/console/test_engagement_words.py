"""The model in the list of events, the palette, the list of keys and the preflight."""

from __future__ import annotations

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import engagement_scene, scenes
from tests.console.dialogs import open_dialog
from tests.console.piloting import piloted_console
from woz_tui.config.engagement_words import STATES
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS
from woz_tui.console.drawing.cells import length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, PaintFrame
from woz_tui.console.screens.preflight import sign_findings
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import (
    SHORT,
    path_row,
    short_state,
    state_sentence,
)
from woz_tui.console.state.event_sentences import EventLine
from woz_tui.console.state.wizard_overrides import is_override, override_text
from woz_tui.console.widgets.event_list import event_row
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW


def event_lines(*messages: m.Message) -> list[EventLine]:
    """The lines that messages get."""
    state = ConsoleState()
    state.apply([scenes.welcome()], 0)
    before = len(state.events)
    state.apply(messages, 0)
    return list(state.events)[before:]


def line(message: m.Message) -> tuple[str, str, str]:
    (event,) = event_lines(message)
    return event.mark, event.text, event.detail


# -- events ---------------------------------------------------------------------------------------


def test_a_change_is_a_line_and_a_forced_one_is_marked() -> None:
    """E7: what the wizard forced is marked."""
    change = engagement_scene.engagement_changed(
        "Wait", "PersonDetected", "human_presence", "present", 0
    )
    assert line(change) == ("info", "somebody there, not engaged", "present")
    forced = msgspec.structs.replace(change, forced=True)
    assert line(forced) == ("forced", "somebody there, not engaged", "by hand: present")
    for hand in ("forced", "stepped"):
        by_name = msgspec.structs.replace(forced, why=f"{hand} by the wizard: present")
        assert line(by_name)[2] == "by hand: present"
    (event,) = event_lines(forced)
    for glyphs in (UNICODE, ASCII):
        row = event_row(event, ConsoleState(), PaintFrame(60, 1, NOW, glyphs))
        assert glyphs.forced in "".join(piece for piece, _ in row)


def test_what_a_state_brings_with_it_is_no_line_unless_it_fails() -> None:
    name = "on RobotThinks"
    assert event_lines(*scenes.played_action("r1", name, NOW, 0.1)) == []
    assert event_lines(*scenes.played_action("r2", name, NOW, 0.1, how="stopped")) == []
    (failed,) = event_lines(
        *scenes.played_action("r3", name, NOW, 0.1, how="failed", reason="no eyes")
    )
    assert (failed.mark, failed.text, failed.detail) == ("failed", name, "no eyes")
    assert len(event_lines(*scenes.played_action("r4", "Hello", NOW, 0.1))) == 1


def test_what_was_heard_is_a_line_and_so_is_what_was_not_understood() -> None:
    speech_text = m.SpeechText(driver="mic", segment=1, text="hello robot", t=NOW)
    assert line(speech_text) == ("heard", "“hello robot”", "heard")
    late = m.SpeechText(
        driver="mic", segment=1, text="hello", took_us=1_260_000, overlap=True, t=NOW
    )
    assert line(late) == ("heard", "“hello”", "heard 1.3 s later, into the robot's sentence")
    own = m.SpeechText(driver="mic", segment=1, text="hello visitor", own=True, t=NOW)
    assert event_lines(own) == [], "its action is a line already"
    nothing = m.SpeechText(driver="mic", segment=1, text="", t=NOW)
    assert line(nothing) == ("info", "Speech not understood", "")
    failed = m.SpeechText(driver="mic", segment=1, text="", detail="whisper: no model", t=NOW)
    assert line(failed) == ("warning", "Speech not understood", "whisper: no model")


def test_a_segment_is_a_line_only_where_it_could_not_be_kept() -> None:
    speech_ended = m.SpeechEnded(driver="mic", segment=1, began=1, ended=2, file="a.wav", t=NOW)
    assert event_lines(speech_ended, m.SpeechStarted(driver="mic", segment=2, began=3, t=NOW)) == []
    lost = msgspec.structs.replace(speech_ended, file="", detail="the disk is full")
    assert line(lost) == ("warning", "Speech not saved", "the disk is full")


@pytest.mark.parametrize(
    ("what", "more", "wanted"),
    [
        ("met", {}, ("Visitor v3 is back", "")),
        ("learnt", {"about": {"age_group": "child"}}, ("Visitor v3 is new", "child")),
        ("profile", {"about": {"address": "formal"}}, ("Visitor v3 is described", "formal")),
        ("renamed", {"was": "v2"}, ("Visitor v2 is v3 now", "")),
        ("forgotten", {}, ("Visitor v3 forgotten", "")),
    ],
)
def test_what_happens_to_a_visitor_is_a_line(
    what: str, more: dict[str, object], wanted: tuple[str, str]
) -> None:
    message = m.VisitorChanged(visitor="v3", what=what, t=NOW)
    assert line(msgspec.structs.replace(message, **more))[1:] == wanted


def test_the_store_is_followed_through_renames_and_oblivion() -> None:
    state = ConsoleState()
    learnt = m.VisitorChanged(visitor="v2", what="learnt", about={"age_group": "child"}, t=1)
    renamed = m.VisitorChanged(visitor="v3", what="renamed", was="v2", t=2)
    state.apply([learnt, renamed], 0)
    assert state.engaged.visitors == {"v3": {"age_group": "child"}}
    state.apply([m.VisitorChanged(visitor="v3", what="forgotten", t=3)], 0)
    assert state.engaged.visitors == {}


@pytest.mark.parametrize(
    ("verb", "args", "words"),
    [
        ("toggle", {"sign": "gaze"}, "gaze the other way, by hand"),
        ("sense", {"sign": "presence", "value": "on"}, "presence yes, by hand"),
        ("sense", {"sign": "distance", "value": "0.8"}, "distance 0.8 m, by hand"),
        ("sense", {"sign": "gaze", "value": "sensor"}, "gaze back to its sensor"),
        ("sense", {"sign": "all", "value": "sensor"}, "all signs back to their sensors"),
        ("sense", {"sign": "identity", "value": "v3"}, "identity v3, by hand"),
        ("force", {"to": "Handshake"}, "force Handshake"),
        ("engagement", {"run": "hold"}, "engagement held"),
        ("filter", {"sign": "gaze", "kind": "joint", "threshold": 0.7},
         "filter of gaze joint 0.7"),
        ("social_distance", {"metres": 1.0}, "near: up to 1 m"),
        ("attend", {"mode": "Unengaged"}, "attention Unengaged"),
        ("handshake", {"what": "ok", "code": "v3"}, "handshake ok v3"),
        ("visitor", {"code": "v3", "age_group": "child"}, "visitor v3, child"),
    ],
)  # fmt: skip
def test_an_order_is_told_in_words(verb: str, args: dict[str, m.Json], words: str) -> None:
    assert override_text(verb, args) == words
    command = m.Command(
        command="c1", verb=verb, args=args, driver="engagement", source="key", t=NOW
    )
    assert event_lines(command)[0].text == words


def test_a_verb_of_another_driver_keeps_its_own_words() -> None:
    for verb in ENGAGEMENT_VERBS:
        ours = m.Command(command="c1", verb=verb, args={}, driver="engagement", source="key", t=NOW)
        assert is_override(ours)
        assert not is_override(msgspec.structs.replace(ours, driver="gripper"))
    force = m.Command(command="c1", verb="force", args={"n": 2}, driver="gripper", source="key")
    assert event_lines(force)[0].text == "force n 2"


def test_a_toggled_sign_is_told_as_it_is_then() -> None:
    command = m.Command(
        command="c1", verb="toggle", args={"sign": "gaze"}, driver="engagement", source="key", t=NOW
    )
    done = m.Done(
        command="c1",
        driver="engagement",
        sent={"sign": "gaze", "value": "off"},
        latency_us=1,
        duration_us=2,
        t=NOW,
    )
    (event,) = event_lines(command, done)
    assert (event.text, event.mark) == ("gaze no, by hand", "done")


@given(
    st.sampled_from([*sorted(ENGAGEMENT_VERBS), "odd"]),
    st.dictionaries(
        st.sampled_from(["sign", "value", "to", "run", "code", "what", "metres", "kind"]),
        st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(), st.just([1])),
    ),
)
def test_any_arguments_make_a_line(verb: str, args: dict[str, m.Json]) -> None:
    assert isinstance(override_text(verb, args), str)


def test_every_state_has_a_sentence_and_none_says_its_name() -> None:
    told = {state_sentence(state, "V2") for state in STATES}
    assert len(told) == len(STATES)
    for state in STATES:
        assert state not in state_sentence(state, "V2")
        assert state_sentence(state, "V2").isascii()
    assert "visitor V2" in state_sentence("EngagedWithKnown", "V2")
    for nobody in ("", "Unknown"):
        assert state_sentence("EngagedWithKnown", nobody) == "visitor, engaged"


# -- the path ------------------------------------------------------------------------------


@given(
    st.lists(st.sampled_from([*STATES, "stop", "odd" * 9, "日本"]), max_size=12), st.integers(1, 80)
)
def test_the_path_keeps_to_its_room_and_ends_with_the_present(trail: list[str], width: int) -> None:
    row = path_row(engagement_scene.engagement_shown("Wait", trail=trail), width, UNICODE)
    last = short_state(trail[-1] if trail else "Wait")
    assert row[-1] == (last, "strong")
    assert length(row) <= max(width, length((row[-1],)) + 4)


def test_every_state_is_told_from_the_others_by_its_short_name() -> None:
    assert len({short_state(state) for state in STATES}) == len(STATES)
    assert set(SHORT) == {*STATES, "stop"}


# -- palette, keys, preflight -------------------------------------------------------------------


async def test_the_palette_finds_what_the_hand_does() -> None:
    async with piloted_console(engagement_scene.welcome(), size=(100, 36)) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("hold it in this state")
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert (asked.verb, asked.args, asked.on) == ("engagement", {"run": "hold"}, "engagement")
        assert asked.source == "palette"
        await open_dialog(pilot, "FindDialog")
        await pilot.type("force a state")
        await pilot.press("enter")
        assert type(pilot.console.dialog).__name__ == "ForceDialog"
        await pilot.press("enter")
        assert pilot.console.keyboard.free


async def test_without_a_model_nothing_of_it_is_offered() -> None:
    async with piloted_console(size=(100, 120)) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("hold it in this state")
        assert "hold it in this state" not in pilot.drawn().replace("hold it in this state", "", 1)
        await pilot.press("ctrl+q")
        await open_dialog(pilot, "HelpDialog")
        assert "Engagement by hand" not in pilot.drawn()


async def test_the_list_of_keys_tells_the_hands() -> None:
    async with piloted_console(engagement_scene.welcome(), size=(120, 140)) as pilot:
        await open_dialog(pilot, "HelpDialog")
        shown = pilot.drawn()
        assert "Engagement by hand  after = and Tab" in shown
        assert "force a state, whatever the signs say" in shown


def test_the_preflight_names_signs_that_nobody_gives() -> None:
    state = ConsoleState()
    assert sign_findings(state) == []
    state.apply([engagement_scene.welcome()], 0)
    (well,) = sign_findings(state)
    assert (well.level, well.text) == ("ok", "presence, gaze, distance are sensed")
    never = m.SignShown(stale=True, verdict=0, places=8)
    state.apply([engagement_scene.engagement_shown(signs=engagement_scene.signs(gaze=never))], 0)
    (missing,) = sign_findings(state)
    assert (missing.level, missing.text) == ("warning", "no sensor gives gaze yet")
    hand = m.SignShown(verdict=1, places=8, forced=True)
    state.apply([engagement_scene.engagement_shown(signs=engagement_scene.signs(gaze=hand))], 0)
    (some,) = sign_findings(state)
    assert some.level == "ok"
    assert some.text == "presence, distance are sensed, gaze is given by hand"
    all_by_hand = dict.fromkeys(("presence", "gaze", "distance"), hand)
    state.apply([engagement_scene.engagement_shown(signs=engagement_scene.signs(**all_by_hand))], 0)
    (finding,) = sign_findings(state)
    assert (finding.level, finding.text) == ("ok", "presence, gaze, distance are given by hand")
