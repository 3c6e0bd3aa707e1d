"""The questionnaire on the wizard's screen."""

from __future__ import annotations

import pytest
from textual.events import Paste
from textual.widgets import TextArea

from tests.console import scenes, study_scene
from tests.console.piloting import ConsolePilot, piloted_console
from tests.features.questionnaires import scene
from woz_tui.console.drawing.glyphs import ASCII
from woz_tui.console.drawing.theme import Appearance
from woz_tui.features.questionnaires.answers import items_of
from woz_tui.features.questionnaires.dialog import QuestionnaireDialog
from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.features.questionnaires.widget import QuestionnaireSheet
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.messages import Json
from woz_tui.protocol.welcome import ENGLISH

SIZES = [(80, 24), (160, 50), (60, 20)]


async def asking(pilot: ConsolePilot, questionnaire: dict[str, Json] = study_scene.ROBOT) -> None:
    """Open the dialog on a questionnaire that has begun."""
    await pilot.tell(scene.questionnaire_started(questionnaire))
    await pilot.press("asterisk", "q")
    await pilot.until(lambda: isinstance(pilot.console.dialog, QuestionnaireDialog))
    await pilot.settle()
    await pilot.settle()


def answers(pilot: ConsolePilot) -> list[AskAnswer]:
    return [asked for asked in pilot.feed.asked if isinstance(asked, AskAnswer)]


@pytest.mark.parametrize("size", SIZES)
async def test_all_of_it_is_answered_by_keys(size: tuple[int, int]) -> None:
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        await asking(pilot)
        assert "there is no right" in pilot.drawn()
        await pilot.press("enter")
        drawn = pilot.drawn()
        for part in ("How pleasant was it", "1 of 4", "not at all", "very much", "7"):
            assert part in drawn, part
        await pilot.press("6")
        await pilot.pass_time(0.5)
        await pilot.press("1", "0", "enter", "4", "2", "enter")
        assert "Anything else?" in pilot.drawn()
        await pilot.type("It was kind")
        await pilot.press("enter")
        assert "It was kind" in pilot.drawn()
        assert "finish" in pilot.drawn()
        await pilot.pass_time(0.8)
        await pilot.press("enter")
        ended = pilot.feed.last(AskQuestionnaire)
        assert isinstance(ended, AskQuestionnaire)
        assert ended.what == "done"
        assert [answer.value for answer in answers(pilot)] == [6.0, 10.0, 42.0, None]
        assert answers(pilot)[-1].text == "It was kind"
        await pilot.tell(scene.questionnaire_ended())
        await pilot.until(lambda: "Thank you!" in pilot.drawn())
        await pilot.press("enter", "h", "space")
        assert set(pilot.drawn().split()) == {"Thank", "you!", "Please", "wait."}
        await pilot.press("ctrl+q")
        await pilot.until(lambda: pilot.console.dialog is None)
        assert pilot.console.keyboard.free


async def test_nothing_of_a_wizard_stands_on_it() -> None:
    async with piloted_console(study_scene.welcome(*scenes.sensors())) as pilot:
        await asking(pilot)
        drawn = pilot.drawn()
        for word in ("wizard", "ctrl+q", "Questionnaire", "Museum guide", "P07", "REC"):
            assert word not in drawn


async def test_the_stop_goes_through_it_and_it_goes_on_where_it_was() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        await pilot.press("enter", "6")
        await pilot.press("escape")
        assert pilot.feed.last(r.AskStop) is not None
        await pilot.until(lambda: pilot.console.dialog is None)
        await pilot.tell(scene.questionnaire_answered("pleasant", 6.0), m.StopPressed(source="key"))
        await pilot.tell(m.StopConfirmed(confirmed=["head"], missing=[], elapsed_us=3_000))
        await pilot.press("ctrl+r", "asterisk", "q")
        await pilot.until(lambda: isinstance(pilot.console.dialog, QuestionnaireDialog))
        await pilot.settle()
        assert "2 of 4" in pilot.drawn()


async def test_a_held_digit_answers_one_item_and_leaves_the_next_as_it_is() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        await pilot.press("enter", "6")
        before = pilot.drawn()
        assert "2 of 4" in before
        await pilot.press("6", "6", "6", "enter")
        assert pilot.drawn() == before
        assert [answer.item for answer in answers(pilot)] == ["pleasant"]


async def test_a_held_digit_writes_nothing_into_a_text_behind_its_item() -> None:
    mixed = {**study_scene.ROBOT, "items": [study_scene.SCALES[0], study_scene.SCALES[3]]}
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot, mixed)
        await pilot.press("enter", "6")
        field = pilot.console.screen.query_one(TextArea)
        await pilot.until(lambda: field.has_focus)
        await pilot.press("6", "6", "enter", "o", "k")
        assert field.text == "ok"
        await pilot.pass_time(0.5)
        await pilot.press("6", "enter")
        assert [answer.text for answer in answers(pilot)] == ["", "ok6"]


async def test_a_held_enter_leaves_out_one_text_and_says_nothing_of_it() -> None:
    texts = [{**study_scene.SCALES[3], "name": name} for name in ("one", "two", "three")]
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot, {**study_scene.ROBOT, "items": texts})
        await pilot.press("enter", "left", *["enter"] * 4)
        assert [answer.item for answer in answers(pilot)] == ["one"]
        await pilot.pass_time(0.5)
        await pilot.press("enter")
        assert "Press again to confirm" in pilot.drawn()
        await pilot.pass_time(0.8)
        await pilot.press("enter")
        assert [answer.item for answer in answers(pilot)] == ["one", "two"]


async def test_pasted_digits_answer_nothing_on_a_scale() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        await pilot.press("enter")
        pilot.console.post_message(Paste("5555\n5"))
        await pilot.settle()
        assert "1 of 4" in pilot.drawn()
        assert answers(pilot) == []


@pytest.mark.parametrize("size", [(50, 12), (60, 16), (80, 24)])
async def test_a_question_stays_in_sight_above_its_field(size: tuple[int, int]) -> None:
    words = {**study_scene.ROBOT, "items": [study_scene.SCALES[3]]}
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        await asking(pilot, words)
        await pilot.press("enter")
        await pilot.type("kind")
        drawn = pilot.drawn()
        for part in ("Anything else?", "optional", "kind", "Enter: next"):
            assert part in drawn, part


async def test_behind_a_stop_on_the_thanks_nothing_is_offered() -> None:
    told = study_scene.study_description(
        questionnaires=[study_scene.ROBOT, {**study_scene.QUICK, "when": "end"}]
    )
    async with piloted_console(study_scene.welcome(study=told)) as pilot:
        await asking(pilot)
        await pilot.tell(scene.questionnaire_ended())
        await pilot.press("escape")
        await pilot.settle()
        assert pilot.console.dialog is None
        assert any(isinstance(asked, r.AskStop) for asked in pilot.feed.asked)


async def test_the_stop_goes_through_a_text_field() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        await pilot.press("enter", "6", "tab")
        await pilot.pass_time(0.5)
        await pilot.press("4", "2", "enter")
        field = pilot.console.screen.query_one(TextArea)
        await pilot.until(lambda: field.has_focus)
        await pilot.type("half a")
        await pilot.press("escape")
        assert pilot.feed.last(r.AskStop) is not None
        await pilot.until(lambda: pilot.console.dialog is None)


async def test_a_text_that_the_wizard_left_is_there_when_she_goes_on() -> None:
    words: dict[str, Json] = {**study_scene.QUICK, "items": [study_scene.SCALES[3]]}
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot, words)
        await pilot.press("enter")
        await pilot.type("kind")
        await pilot.press("ctrl+q")
        await pilot.press("asterisk", "q", "enter")
        assert "kind" in pilot.drawn()


async def test_no_key_of_the_experiment_plays_meanwhile() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        await pilot.press("enter", "h", "f1", "space", "full_stop")
        for kind in (r.AskAction, AskScript, r.AskMarker):
            assert pilot.feed.last(kind) is None


async def test_back_from_a_text_and_back_to_it() -> None:
    async with piloted_console(study_scene.welcome(scene.questionnaire_started())) as pilot:
        await pilot.tell(
            scene.questionnaire_answered("pleasant", 3.0),
            scene.questionnaire_answered("again", skipped=True),
            scene.questionnaire_answered("sure", 42.0),
            scene.questionnaire_answered("else", text="as before"),
        )
        await pilot.press("asterisk", "q")
        await pilot.until(lambda: isinstance(pilot.console.dialog, QuestionnaireDialog))
        await pilot.settle()
        assert "left out" in pilot.drawn()
        await pilot.press("up", "enter")
        await pilot.settle()
        field = pilot.console.screen.query_one(TextArea)
        await pilot.until(lambda: field.text == "as before" and field.has_focus)
        await pilot.press("up")
        await pilot.until(lambda: "3 of 4" in pilot.drawn())
        assert "[ 42 ]" in pilot.drawn()


async def test_a_refusal_is_shown_and_the_item_is_open_again() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        pilot.feed.answers[AskAnswer] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="the questionnaire 'robot' is not open"
        )
        await pilot.press("enter", "6")
        assert ENGLISH.refused in pilot.drawn()
        assert "1 of 4" in pilot.drawn()


async def test_an_answer_that_was_lost_with_the_line_goes_out_again() -> None:
    async with piloted_console(study_scene.welcome(scene.questionnaire_started())) as pilot:
        await asking(pilot)
        await pilot.press("enter")
        pilot.feed.answers[AskAnswer] = lambda asked, ref: r.Reply(ref=0, ok=True)
        await pilot.press("6")
        sent = answers(pilot)
        pilot.feed.cut("the line was cut")
        await pilot.settle()
        pilot.console.paint()
        await pilot.settle()
        del pilot.feed.answers[AskAnswer]
        await pilot.tell(study_scene.welcome(scene.questionnaire_started()))
        await pilot.until(lambda: isinstance(pilot.console.dialog, QuestionnaireDialog))
        await pilot.settle()
        again = answers(pilot)
        assert len(again) == len(sent) + 1
        assert again[-1].item == sent[-1].item
        assert again[-1].value == sent[-1].value


async def test_signs_of_a_plain_terminal() -> None:
    async with piloted_console(study_scene.welcome(), look=Appearance(ASCII, "woz-16")) as pilot:
        await asking(pilot)
        await pilot.press("enter", "right", "right")
        assert pilot.drawn().isascii()
        assert "[2]" in pilot.drawn()


async def test_nothing_jumps_while_an_answer_is_chosen() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot)
        await pilot.press("enter")
        before = pilot.drawn().splitlines()
        await pilot.press("right", "right", "right")
        after = pilot.drawn().splitlines()
        changed = [
            y for y, pair in enumerate(zip(before, after, strict=True)) if len(set(pair)) > 1
        ]
        assert len(changed) <= 1
        assert [line.replace("[", " ").replace("]", " ") for line in after] == before


async def test_the_header_tells_how_far_it_is() -> None:
    async with piloted_console(
        study_scene.welcome(scene.questionnaire_started()), size=(120, 40)
    ) as pilot:
        assert "questions 0/4" in pilot.text("StatusLines")
        await pilot.tell(scene.questionnaire_answered("pleasant", 3.0))
        assert "questions 1/4" in pilot.text("StatusLines")
        assert "pleasant" not in pilot.text("EventList")
        await pilot.tell(scene.questionnaire_ended(reason="declined", count=1))
        assert "questions" not in pilot.text("StatusLines")
        assert "declined" in pilot.text("EventList")


async def test_the_sheet_says_nothing_before_it_is_put_together() -> None:
    sheet = QuestionnaireSheet(lambda request, reply: None, lambda: 0, ASCII)
    sheet.follow(None, [("Please wait.", "strong")])
    assert sheet.run is None


def test_items_of_another_version_are_left_out() -> None:
    (item,) = items_of([{"name": "x", "low": 5, "high": 9}, {"name": "z", "ends": 3}, "y"])
    assert (item.low, item.high, item.ends) == (5, 9, ("", ""))
    assert items_of("none") == ()
