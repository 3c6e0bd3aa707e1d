"""The questionnaire on the wizard's screen."""

from __future__ import annotations

import pytest
from textual.events import Paste
from textual.widgets import TextArea

from tests.console import scenes, studied
from tests.console.driving import Sitting, sitting
from woz_tui.console.glyphs import ASCII
from woz_tui.console.screens.questionnaire import QuestionnaireDialog
from woz_tui.console.study.questionnaire_widget import QuestionnaireSheet
from woz_tui.console.study.questionnaires import items_of
from woz_tui.console.theme import Appearance
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.messages import Json
from woz_tui.protocol.welcome import ENGLISH

SIZES = [(80, 24), (160, 50), (60, 20)]


async def asking(seat: Sitting, questionnaire: dict[str, Json] = studied.ROBOT) -> None:
    """Open the dialog on a questionnaire that has begun."""
    await seat.tell(studied.started(questionnaire))
    await seat.press("asterisk", "q")
    await seat.until(lambda: isinstance(seat.console.dialog, QuestionnaireDialog))
    await seat.settle()
    await seat.settle()


def answers(seat: Sitting) -> list[r.AskAnswer]:
    return [asked for asked in seat.feed.asked if isinstance(asked, r.AskAnswer)]


@pytest.mark.parametrize("size", SIZES)
async def test_all_of_it_is_answered_by_keys(size: tuple[int, int]) -> None:
    async with sitting(studied.welcome(), size=size) as seat:
        await asking(seat)
        assert "there is no right" in seat.drawn()
        await seat.press("enter")
        drawn = seat.drawn()
        for part in ("How pleasant was it", "1 of 4", "not at all", "very much", "7"):
            assert part in drawn, part
        await seat.press("6")
        await seat.pass_time(0.5)
        await seat.press("1", "0", "enter", "4", "2", "enter")
        assert "Anything else?" in seat.drawn()
        await seat.type("It was kind")
        await seat.press("enter")
        assert "It was kind" in seat.drawn()
        assert "finish" in seat.drawn()
        await seat.pass_time(0.8)
        await seat.press("enter")
        ended = seat.feed.last(r.AskQuestionnaire)
        assert isinstance(ended, r.AskQuestionnaire)
        assert ended.what == "done"
        assert [answer.value for answer in answers(seat)] == [6.0, 10.0, 42.0, None]
        assert answers(seat)[-1].text == "It was kind"
        await seat.tell(studied.ended())
        await seat.until(lambda: "Thank you!" in seat.drawn())
        await seat.press("enter", "h", "space")
        assert set(seat.drawn().split()) == {"Thank", "you!", "Please", "wait."}
        await seat.press("ctrl+q")
        await seat.until(lambda: seat.console.dialog is None)
        assert seat.console.keyboard.free


async def test_nothing_of_a_wizard_stands_on_it() -> None:
    async with sitting(studied.welcome(*scenes.sensors())) as seat:
        await asking(seat)
        drawn = seat.drawn()
        for word in ("wizard", "ctrl+q", "Questionnaire", "Museum guide", "P07", "REC"):
            assert word not in drawn


async def test_the_stop_goes_through_it_and_it_goes_on_where_it_was() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        await seat.press("enter", "6")
        await seat.press("escape")
        assert seat.feed.last(r.AskStop) is not None
        await seat.until(lambda: seat.console.dialog is None)
        await seat.tell(studied.answered("pleasant", 6.0), m.StopPressed(source="key"))
        await seat.tell(m.StopConfirmed(confirmed=["head"], missing=[], elapsed_us=3_000))
        await seat.press("ctrl+r", "asterisk", "q")
        await seat.until(lambda: isinstance(seat.console.dialog, QuestionnaireDialog))
        await seat.settle()
        assert "2 of 4" in seat.drawn()


async def test_a_held_digit_answers_one_item_and_leaves_the_next_as_it_is() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        await seat.press("enter", "6")
        before = seat.drawn()
        assert "2 of 4" in before
        await seat.press("6", "6", "6", "enter")
        assert seat.drawn() == before
        assert [answer.item for answer in answers(seat)] == ["pleasant"]


async def test_a_held_digit_writes_nothing_into_a_text_behind_its_item() -> None:
    mixed = {**studied.ROBOT, "items": [studied.SCALES[0], studied.SCALES[3]]}
    async with sitting(studied.welcome()) as seat:
        await asking(seat, mixed)
        await seat.press("enter", "6")
        field = seat.console.screen.query_one(TextArea)
        await seat.until(lambda: field.has_focus)
        await seat.press("6", "6", "enter", "o", "k")
        assert field.text == "ok"
        await seat.pass_time(0.5)
        await seat.press("6", "enter")
        assert [answer.text for answer in answers(seat)] == ["", "ok6"]


async def test_a_held_enter_leaves_out_one_text_and_says_nothing_of_it() -> None:
    texts = [{**studied.SCALES[3], "name": name} for name in ("one", "two", "three")]
    async with sitting(studied.welcome()) as seat:
        await asking(seat, {**studied.ROBOT, "items": texts})
        await seat.press("enter", "left", *["enter"] * 4)
        assert [answer.item for answer in answers(seat)] == ["one"]
        await seat.pass_time(0.5)
        await seat.press("enter")
        assert "press it again" in seat.drawn()
        await seat.pass_time(0.8)
        await seat.press("enter")
        assert [answer.item for answer in answers(seat)] == ["one", "two"]


async def test_pasted_digits_answer_nothing_on_a_scale() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        await seat.press("enter")
        seat.console.post_message(Paste("5555\n5"))
        await seat.settle()
        assert "1 of 4" in seat.drawn()
        assert answers(seat) == []


@pytest.mark.parametrize("size", [(50, 12), (60, 16), (80, 24)])
async def test_a_question_stays_in_sight_above_its_field(size: tuple[int, int]) -> None:
    words = {**studied.ROBOT, "items": [studied.SCALES[3]]}
    async with sitting(studied.welcome(), size=size) as seat:
        await asking(seat, words)
        await seat.press("enter")
        await seat.type("kind")
        drawn = seat.drawn()
        for part in ("Anything else?", "can be skipped", "kind", "enter goes on"):
            assert part in drawn, part


async def test_behind_a_stop_on_the_thanks_nothing_is_offered() -> None:
    told = studied.told(questionnaires=[studied.ROBOT, {**studied.QUICK, "when": "end"}])
    async with sitting(studied.welcome(study=told)) as seat:
        await asking(seat)
        await seat.tell(studied.ended())
        await seat.press("escape")
        await seat.settle()
        assert seat.console.dialog is None
        assert any(isinstance(asked, r.AskStop) for asked in seat.feed.asked)


async def test_the_stop_goes_through_a_text_field() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        await seat.press("enter", "6", "tab")
        await seat.pass_time(0.5)
        await seat.press("4", "2", "enter")
        field = seat.console.screen.query_one(TextArea)
        await seat.until(lambda: field.has_focus)
        await seat.type("half a")
        await seat.press("escape")
        assert seat.feed.last(r.AskStop) is not None
        await seat.until(lambda: seat.console.dialog is None)


async def test_a_text_that_the_wizard_left_is_there_when_she_goes_on() -> None:
    words: dict[str, Json] = {**studied.QUICK, "items": [studied.SCALES[3]]}
    async with sitting(studied.welcome()) as seat:
        await asking(seat, words)
        await seat.press("enter")
        await seat.type("kind")
        await seat.press("ctrl+q")
        await seat.press("asterisk", "q", "enter")
        assert "kind" in seat.drawn()


async def test_no_key_of_the_experiment_plays_meanwhile() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        await seat.press("enter", "h", "f1", "space", "full_stop")
        for kind in (r.AskAction, r.AskScript, r.AskMarker):
            assert seat.feed.last(kind) is None


async def test_back_from_a_text_and_back_to_it() -> None:
    async with sitting(studied.welcome(studied.started())) as seat:
        await seat.tell(
            studied.answered("pleasant", 3.0),
            studied.answered("again", skipped=True),
            studied.answered("sure", 42.0),
            studied.answered("else", text="as before"),
        )
        await seat.press("asterisk", "q")
        await seat.until(lambda: isinstance(seat.console.dialog, QuestionnaireDialog))
        await seat.settle()
        assert "left out" in seat.drawn()
        await seat.press("up", "enter")
        await seat.settle()
        field = seat.console.screen.query_one(TextArea)
        await seat.until(lambda: field.text == "as before" and field.has_focus)
        await seat.press("up")
        await seat.until(lambda: "3 of 4" in seat.drawn())
        assert "[ 42 ]" in seat.drawn()


async def test_a_refusal_is_shown_and_the_item_is_open_again() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        seat.feed.answers[r.AskAnswer] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="the questionnaire 'robot' is not open"
        )
        await seat.press("enter", "6")
        assert ENGLISH.refused in seat.drawn()
        assert "1 of 4" in seat.drawn()


async def test_an_answer_that_was_lost_with_the_line_goes_out_again() -> None:
    async with sitting(studied.welcome(studied.started())) as seat:
        await asking(seat)
        await seat.press("enter")
        seat.feed.answers[r.AskAnswer] = lambda asked, ref: r.Reply(ref=0, ok=True)
        await seat.press("6")
        sent = answers(seat)
        seat.feed.cut("the line was cut")
        await seat.settle()
        seat.console.paint()
        await seat.settle()
        del seat.feed.answers[r.AskAnswer]
        await seat.tell(studied.welcome(studied.started()))
        await seat.until(lambda: isinstance(seat.console.dialog, QuestionnaireDialog))
        await seat.settle()
        again = answers(seat)
        assert len(again) == len(sent) + 1
        assert again[-1].item == sent[-1].item
        assert again[-1].value == sent[-1].value


async def test_signs_of_a_plain_terminal() -> None:
    async with sitting(studied.welcome(), look=Appearance(ASCII, "woz-16")) as seat:
        await asking(seat)
        await seat.press("enter", "right", "right")
        assert seat.drawn().isascii()
        assert "[2]" in seat.drawn()


async def test_nothing_jumps_while_an_answer_is_chosen() -> None:
    async with sitting(studied.welcome()) as seat:
        await asking(seat)
        await seat.press("enter")
        before = seat.drawn().splitlines()
        await seat.press("right", "right", "right")
        after = seat.drawn().splitlines()
        changed = [
            y for y, pair in enumerate(zip(before, after, strict=True)) if len(set(pair)) > 1
        ]
        assert len(changed) <= 1
        assert [line.replace("[", " ").replace("]", " ") for line in after] == before


async def test_the_header_tells_how_far_it_is() -> None:
    async with sitting(studied.welcome(studied.started()), size=(120, 40)) as seat:
        assert "questions 0/4" in seat.text("StatusLines")
        await seat.tell(studied.answered("pleasant", 3.0))
        assert "questions 1/4" in seat.text("StatusLines")
        assert "pleasant" not in seat.text("EventList")
        await seat.tell(studied.ended(reason="declined", count=1))
        assert "questions" not in seat.text("StatusLines")
        assert "declined" in seat.text("EventList")


async def test_the_sheet_says_nothing_before_it_is_put_together() -> None:
    sheet = QuestionnaireSheet(lambda request, reply: None, lambda: 0, ASCII)
    sheet.follow(None, [("Please wait.", "strong")])
    assert sheet.run is None


def test_items_of_another_version_are_left_out() -> None:
    (item,) = items_of([{"name": "x", "low": 5, "high": 9}, {"name": "z", "ends": 3}, "y"])
    assert (item.low, item.high, item.ends) == (5, 9, ("", ""))
    assert items_of("none") == ()
