"""Items of every kind at a terminal of 80 x 24: what is drawn, what keys do, what is sent."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import pytest
from textual.widgets import TextArea

from tests.config.catalogue import CATALOGUE
from tests.console import study_scene
from tests.console.piloting import ConsolePilot, piloted_console
from tests.features.questionnaires.test_questionnaire_screen import answers, asking
from woz_tui.config.loading import load
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.protocol.messages import Json
from woz_tui.protocol.welcome import Questionnaire

FILE = Path(__file__).parents[2] / "config" / "good" / "questionnaire-items.yaml"


def asked() -> Questionnaire:
    (found,) = QUESTIONNAIRES.of(load(FILE, CATALOGUE)).questionnaires
    return found


def only(*names: str, **changes: Any) -> dict[str, Json]:
    """A questionnaire of these items, as a session puts it."""
    items = {item.name: item for item in asked().items}
    found: list[Json] = [
        msgspec.to_builtins(msgspec.structs.replace(items[name], **changes)) for name in names
    ]
    found = msgspec.json.decode(msgspec.json.encode(found))
    return {**study_scene.ROBOT, "items": found, "introduction": ""}


async def begin(pilot: ConsolePilot, *names: str, **changes: Any) -> None:
    await asking(pilot, only(*names, **changes))
    await press(pilot, "enter")


async def press(pilot: ConsolePilot, *keys: str) -> None:
    """Keys, each long enough after the one before that it is no part of the same press."""
    for key in keys:
        await pilot.press(key)
        await pilot.pass_time(0.8)


SIZES = pytest.mark.parametrize("size", [(80, 24), (160, 50)])


@SIZES
async def test_opposites_stand_on_the_side_that_chance_chose(size: tuple[int, int]) -> None:
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        await begin(pilot, "natural", "often", flipped=True)
        drawn = pilot.drawn()
        assert "The robot was" in drawn
        assert drawn.index("natural") < drawn.index("fake")
        await press(pilot, "2")
        assert answers(pilot)[0].value == 2.0  # the second from natural (3)


@SIZES
async def test_each_point_has_its_label_and_no_number(size: tuple[int, int]) -> None:
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        await begin(pilot, "often", "age")
        drawn = pilot.drawn()
        for part in ("never", "seldom", "often", "Tab: does not fit"):
            assert part in drawn, part
        await press(pilot, "right", "right", "enter")
        assert answers(pilot)[0].value == 2.0


async def test_a_way_without_an_answer_is_chosen_behind_tab() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "often", "age")
        await press(pilot, "tab")
        for part in ("1  does not fit", "2  left out"):
            assert part in pilot.drawn(), part
        await press(pilot, "up", "tab", "1")
        assert [(each.skipped, each.reason) for each in answers(pilot)] == [
            (True, "does_not_apply")
        ]
        assert "How old are you?" in pilot.drawn()


async def test_a_soft_item_asks_once_more() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "age", "since")
        await press(pilot, "tab")
        assert "Press Tab once more to leave it open." in pilot.drawn()
        assert answers(pilot) == []
        await press(pilot, "tab")
        assert [(each.skipped, each.reason) for each in answers(pilot)] == [(True, "")]


async def test_a_slider_has_no_mark_until_one_is_set() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "effort", "age")
        await press(pilot, "enter")
        assert "A number from 0 to 100, please." in pilot.drawn()
        await press(pilot, "3", "7", "enter")
        assert "In steps of 5, please: 35 or 40." in pilot.drawn()
        await press(pilot, "home", "right", "right", "enter")
        assert [each.value for each in answers(pilot)] == [10.0]


async def test_numbers_and_months_are_typed() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "age", "since")
        await press(pilot, "9", "enter")
        assert "A number from 18 to 99, please." in pilot.drawn()
        await press(pilot, "backspace", "3", "1")
        assert "[ 31 ] years" in pilot.drawn()
        await press(pilot, "enter", "2", "0", "2", "6", "1", "3", "enter")
        assert "such as 2026-11" in pilot.drawn()
        await press(pilot, "backspace", "1", "enter")
        assert [(each.value, each.text) for each in answers(pilot)] == [
            (31.0, ""),
            (None, "2026-11"),
        ]


@SIZES
async def test_several_choices_and_one_in_words(size: tuple[int, int]) -> None:
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        await begin(pilot, "known", "which", "age")
        for part in ("1  yes", "2  no", "3  unsure", "1 of 2"):
            assert part in pilot.drawn(), part
        await press(pilot, "1")
        assert "2 of 3" in pilot.drawn()  # the answer has opened another question
        await press(pilot, "enter")
        assert "Please choose at least one of these." in pilot.drawn()
        await press(pilot, "space", "3")
        for part in ("[x] a vacuum cleaner", "[ ] a toy", "[x] other"):
            assert part in pilot.drawn(), part
        await press(pilot, "enter")
        assert "Please say which:" in pilot.drawn()
        await pilot.until(lambda: pilot.console.screen.query_one(TextArea).has_focus)
        await pilot.type("a mower")
        await pilot.press("enter")
        told = answers(pilot)[-1]
        assert (told.ticked, told.text) == ([1, 6], "a mower")


async def test_going_back_and_answering_otherwise_closes_what_hung_on_it() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "known", "which", "age")
        await press(pilot, "1", "1", "enter", "up", "up", "2")
        assert "How old are you?" in pilot.drawn()
        assert "2 of 2" in pilot.drawn()
        await press(pilot, "3", "1", "enter")
        drawn = pilot.drawn()
        assert ("Which ones?" in drawn, "finish" in drawn) == (False, True)
        await press(pilot, "up", "up", "enter")
        assert "Have you used a robot?" in pilot.drawn()
        await press(pilot, "1")
        drawn = pilot.drawn()
        assert ("Which ones?" in drawn, "a vacuum cleaner" in drawn) == (True, True)


async def test_an_instruction_is_read_and_not_counted() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "page-1", "age")
        assert "Think of the last task." in pilot.drawn()
        assert "of 1" not in pilot.drawn()
        await press(pilot, "enter")
        assert "1 of 1" in pilot.drawn()
        await press(pilot, "up")
        assert "Think of the last task." in pilot.drawn()


async def test_how_many_questions_there_are_is_told_where_answers_decide_it() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await asking(pilot, only("known", "which", "age"))
        assert "2-3 questions." in pilot.drawn()


async def test_no_number_is_told_of_a_scale_without_numbers() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await begin(pilot, "natural", numbers=False, flipped=False)
        assert "and enter · " in pilot.drawn()
        await press(pilot, "enter")
        assert "Please choose one of these." in pilot.drawn()
        await press(pilot, "9")
        drawn = pilot.drawn()
        assert "Please choose one of these." in drawn
        assert "1 to 7" not in drawn
        assert "from 1" not in drawn
