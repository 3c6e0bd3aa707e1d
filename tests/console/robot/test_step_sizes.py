"""The steps of the arrow keys: from the experiment file, then as the wizard has them."""

from __future__ import annotations

import dataclasses
import math
from typing import Annotated, get_args, get_origin, get_type_hints

import msgspec
import pytest

from tests.console.piloting import piloted_console
from tests.console.robot import pepper
from tests.console.still_feed import StillFeed
from woz_tui.config.experiment import ArrowKeySteps
from woz_tui.console.input.keyboard import ArrowSizes as Pressed
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.robot_settings.step_sizes import STEPS, ArrowSteps, steps_offered
from woz_tui.drivers.fields import Range
from woz_tui.protocol import requests as r

TOLD: dict[str, float] = {"head": 7.0, "hip": 2.0, "drive": 0.25, "turn": 15.0}


def arrows() -> tuple[ArrowSteps, Keyboard]:
    keyboard = Keyboard(StillFeed())
    return ArrowSteps(keyboard), keyboard


def test_limits_are_those_of_an_experiment_file() -> None:
    hints = get_type_hints(ArrowKeySteps, include_extras=True)
    limits = {}
    for name, hint in hints.items():
        assert get_origin(hint) is Annotated
        (limit,) = [each for each in get_args(hint) if isinstance(each, Range)]
        limits[name] = (limit.low, limit.high)
    assert limits == {setting.name: (setting.low, setting.high) for setting in STEPS}
    assert dataclasses.asdict(ArrowKeySteps()) == dataclasses.asdict(Pressed())


def test_the_files_steps_are_adopted_and_the_wizards_stay() -> None:
    steps, keyboard = arrows()
    steps.adopt(TOLD)
    assert keyboard.steps == Pressed(7.0, 2.0, 0.25, 15.0)
    steps.change("head", 3.0)
    steps.adopt(dict(TOLD))  # told again, as after a change of profile
    assert steps.value("head") == 3.0
    steps.adopt({**TOLD, "head": 9.0})  # the file was edited
    assert keyboard.steps.head == 9.0


@pytest.mark.parametrize("told", [{}, {"head": math.nan}, {"head": -1.0}, {"head": 1e9}])
def test_steps_that_cannot_be_read_change_nothing(told: dict[str, float]) -> None:
    steps, keyboard = arrows()
    steps.adopt(told)
    assert keyboard.steps == Pressed()


def test_only_arrows_that_move_something_have_steps() -> None:
    assert [setting.name for setting in steps_offered(["nudge", "say"])] == ["head"]
    assert [setting.name for setting in steps_offered(["drive"])] == ["drive", "turn"]


async def test_an_arrow_key_goes_as_far_as_it_was_told() -> None:
    async with piloted_console(pepper.welcome(steps=TOLD)) as pilot:
        keyboard = pilot.console.keyboard
        assert keyboard.press("left")
        assert keyboard.press("alt+up")
        pilot.console.arrows.change("head", 12.0)
        assert keyboard.press("left")
        asked = [each for each in pilot.feed.asked if isinstance(each, r.AskVerb)]
        assert [each.args for each in asked] == [{"yaw": 7.0}, {"x": 0.25}, {"yaw": 12.0}]


async def test_steps_of_a_file_that_was_read_again() -> None:
    async with piloted_console(pepper.welcome(steps=TOLD)) as pilot:
        first = pepper.welcome()
        panels_changed = r.PanelsChanged(
            title=first.title,
            panels=first.panels,
            script=first.script,
            verbs=first.verbs,
            conditions=first.conditions,
            keyboard=first.keyboard,
            steps={"head": 1.0, "hip": 2.0, "drive": 0.25, "turn": 15.0},
        )
        await pilot.tell(panels_changed)
        assert pilot.console.keyboard.steps.head == 1.0
        pilot.console.arrows.change("head", 4.0)
        await pilot.tell(msgspec.structs.replace(panels_changed, profile="child"))
        assert pilot.console.keyboard.steps.head == 4.0
