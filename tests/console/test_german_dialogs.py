"""The dialogs in German: no sentence is English, and what has room in English has room."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial

import pytest

from tests.console import scenes
from tests.console.dialogs import OPENERS, busy, open_dialog
from tests.console.piloting import piloted_console
from tools.screen_sentences import sentences
from woz_tui.config.file_position import FilePosition, Problem
from woz_tui.config.screen_language import catalogue, use, word, worded
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.sentence import Sentence

#: Sections of what dialogs, finder, help and the lowest line say.
SECTIONS = (
    *(
        "app",
        "bodies",
        "camera",
        "dialog",
        "drivers",
        "failures",
        "find",
        "hand",
        "help",
        "hint",
        "keys",
    ),
    *("knobs", "leave", "lost", "mistake", "move", "note", "peek", "preflight", "queue"),
    *("release", "reload", "robot", "say", "start", "terminal", "typed", "unrecorded"),
)
#: Of features, which have their own sections.
OTHERS = {"ProfileDialog", "TrialDialog", "PhasesDialog"}
#: Shorter ones are words that other texts have, too.
WORDS = 12
#: Cells of the preflight's first column.
SUBJECT = 14
#: Cells of the lower edge of a dialog on a screen of 80 columns.
EDGE = 66
DIALOGS = sorted({*OPENERS} - OTHERS)


@pytest.fixture(autouse=True)
def german() -> Iterator[None]:
    use("de")
    yield
    use("en")


def english_left(drawn: str) -> set[str]:
    """Sentences of ours that stand there in English."""
    ours, there = catalogue("de"), " ".join(drawn.split())
    return {
        text
        for code, text in sentences().items()
        if code.partition(".")[0] in SECTIONS and "{" not in text
        if len(text) >= WORDS and text != ours[code] and text in there
    }


async def test_dialogs_are_german_and_their_edges_have_room() -> None:
    async with piloted_console(busy(), size=(80, 24)) as pilot:
        for name in DIALOGS:
            await open_dialog(pilot, name)
            dialog = pilot.console.dialog
            assert dialog is not None
            heading = word(dialog.heading)
            await pilot.until(lambda heading=heading: heading in pilot.drawn(), name)  # type: ignore[misc]
            assert not english_left(pilot.drawn()), name
            subtitles = [str(box.border_subtitle) for box in dialog.query(".dialog")]
            assert all(subtitle in pilot.drawn() for subtitle in subtitles), subtitles
            await pilot.press("ctrl+q")


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_keys_are_named_in_german(size: tuple[int, int]) -> None:
    async with piloted_console(busy(), size=size) as pilot:
        assert "Stopp" in pilot.text("StopBar")
        assert not english_left(pilot.text("StopBar"))
        await open_dialog(pilot, "HelpDialog")
        assert "den Stopp lösen" in pilot.drawn()


@pytest.mark.parametrize("typed", ["beenden", "leave"])
async def test_a_command_is_found_by_its_german_and_its_english_words(typed: str) -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type(typed)
        await pilot.press("enter")
        await pilot.until(lambda: type(pilot.console.dialog).__name__ == "LeaveDialog")
        assert "Sitzung beenden: der Roboter ruht" in pilot.drawn()


async def test_the_question_before_a_release_is_german() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await pilot.tell(m.StopPressed(scope="all", source="key", t=scenes.NOW))
        await pilot.press("ctrl+r")
        await pilot.until(lambda: "Stopp lösen?" in pilot.drawn())
        assert "noch nicht bestätigt" in pilot.drawn()
        assert not english_left(pilot.drawn())


async def test_what_the_console_tells_is_german() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        await pilot.press("f20")
        await pilot.until(lambda: "ist nicht belegt" in pilot.drawn())


async def test_what_is_wrong_with_the_file_is_german() -> None:
    place = FilePosition("guide.yaml", 3, 1)
    lost = Sentence("check.no_action", "there is no action {name}{near}", name="'Wave'", near="")
    problems = [Problem(place, "then", lost), Problem(place, "port", "nobody is there")]
    data = [problem.sentence for problem in problems]

    def answer(_: r.Request, ref: int) -> r.Reply:
        line = codec.encode(r.Reply(ref=ref, ok=False, reason="no", data=[*data]))
        came = worded(codec.decode_incoming(line))
        assert isinstance(came, r.Reply)
        return came

    async with piloted_console(size=(80, 24)) as pilot:
        pilot.feed.answers[r.AskReload] = answer
        await open_dialog(pilot, "ReloadDialog")
        await pilot.until(lambda: "guide.yaml:3:1: then: es gibt keine Aktion" in pilot.drawn())
        assert "guide.yaml:3:1: port: nobody is there" in pilot.drawn()


def test_subjects_of_the_preflight_fit_their_column() -> None:
    subjects = ("key", "keys", "engagement", "connection", "keyboard")
    words = [catalogue("de")[f"preflight.{each}"].format(key="ctrl+x") for each in subjects]
    words += [catalogue("de")[f"terminal.{each}"] for each in ("terminal", "characters", "colours")]
    assert all(len(each) <= SUBJECT for each in words)


@pytest.mark.parametrize("texts_of", [sentences, partial(catalogue, "de")], ids=["en", "de"])
def test_the_keys_of_a_dialog_fit_its_edge_at_80_columns(
    texts_of: Callable[[], Mapping[str, str]],
) -> None:
    texts = texts_of()
    hints = {code: text for code, text in texts.items() if " · " in text and "ctrl+q" in text}
    wide = {"robot.hint"}  # a dialog over the whole width
    assert {code for code, text in hints.items() if len(text) > EDGE} <= wide


async def test_why_another_key_is_to_be_pressed_is_german() -> None:
    async with piloted_console(busy(), size=(160, 50)) as pilot:
        await open_dialog(pilot, "PreflightDialog")
        await pilot.until(lambda: "sendet dieselben Bytes wie" in pilot.drawn())
        assert not english_left(pilot.drawn())
