"""The main screen in German: nothing of it is left in English, nothing is cut that was not."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from tests.console import engagement_scene, scenes
from tests.console.dialogs import OPENERS
from tests.console.piloting import piloted_console
from tools.screen_sentences import sentences
from woz_tui.config.screen_language import catalogue, use
from woz_tui.console.drawing.glyphs import UNICODE
from woz_tui.console.engagement.state_diagram import PLACES
from woz_tui.console.state.engagement_text import short_state
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

#: What the main screen says itself.
SECTIONS = ("status", "panels", "meters", "events", "rows", "engagement", "link", "stop", "runs")
SMALL, LARGE = (80, 24), (160, 50)
#: Words of fewer letters are names and units as well.
LEAST = 5


@pytest.fixture(autouse=True)
def english_again() -> Iterator[None]:
    yield
    use("en")


def left_in_english(drawn: str) -> set[str]:
    """The English of these sections that stands on the screen, as far as German says it
    otherwise.
    """
    german = catalogue("de")
    whole = {
        text
        for code, text in sentences().items()
        if code.partition(".")[0] in SECTIONS and text != german[code]
    }
    parts = {piece.strip(" ,:.;()") for text in whole for piece in re.split(r"\{[^}]*\}", text)}
    # What the scene calls its things, and words of the reasons that the engagement model gives.
    names = {"robot", "program", "voice", "visitor", "looks", "speaks", "speech", "ended"}
    return {
        part
        for part in parts - names
        if len(part) >= LEAST and re.search(rf"(?<!\w){re.escape(part)}(?!\w)", drawn)
    }


def scene(name: str) -> tuple[r.Welcome, tuple[m.Message, ...]]:
    """The first message, and what comes then."""
    now = scenes.NOW
    stop = m.StopPressed(source="key", t=now)
    confirmed = m.StopConfirmed(
        confirmed=["body"], missing=["head"], elapsed_us=80_000, scope="all", t=now + 80_000
    )
    match name:
        case "playing":
            return scenes.welcome(recent=[*scenes.history(), *scenes.speaking()]), ()
        case "stopped":
            return scenes.welcome(), (stop, confirmed)
        case "model":
            welcome = engagement_scene.welcome(*engagement_scene.way(), engagement_scene.waits())
            return welcome, ()
    raise ValueError(name)


async def drawn(name: str, size: tuple[int, int], *keys: str) -> str:
    welcome, later = scene(name)
    async with piloted_console(welcome, size=size) as pilot:
        await pilot.tell(*later)
        await pilot.press(*keys)
        rows = pilot.drawn().rstrip().splitlines()
        return "\n".join(rows[:-1])  # without the keys, whose words are not of these sections


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("playing", SMALL),
        ("stopped", SMALL),
        ("model", SMALL),
        ("model", LARGE),
    ],
)
async def test_nothing_is_left_in_english_and_no_more_is_cut(
    name: str, size: tuple[int, int]
) -> None:
    english = await drawn(name, size)
    assert left_in_english(english), "or this test would not find any"
    use("de")
    german = await drawn(name, size)
    assert not left_in_english(german)
    assert german.count(UNICODE.ellipsis) <= english.count(UNICODE.ellipsis)


async def test_the_engagement_model_in_full_is_german_and_no_more_is_cut() -> None:
    english = await drawn("model", SMALL, OPENERS["EngagementDialog"])
    use("de")
    german = await drawn("model", SMALL, OPENERS["EngagementDialog"])
    assert "Zeichen   gemessen" in german
    assert not left_in_english(german)
    assert german.count(UNICODE.ellipsis) <= english.count(UNICODE.ellipsis)


async def test_a_lost_robot_process_is_told_in_german() -> None:
    use("de")
    async with piloted_console(scenes.welcome()) as pilot:
        pilot.feed.cut("nichts")
        await pilot.until(lambda: "ROBOTERPROZESS WEG" in pilot.text("StatusLines"))
        assert not left_in_english(pilot.text("StatusLines"))


def test_states_of_the_diagram_are_no_longer_than_in_english() -> None:
    english = {state: short_state(state) for state in PLACES}
    use("de")
    assert not [state for state in PLACES if len(short_state(state)) > len(english[state])]


def test_what_stands_where_the_time_of_an_event_does_has_its_width() -> None:
    assert len(catalogue("de")["events.model"]) <= len("model")
