"""What moves for as long as a hand is away from the middle, such as a 6-D mouse."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Awaitable, Callable
from typing import Any

import pytest
from woz_drivers.hands import HandsPanel
from woz_drivers.hands.settings import HandControl, HandsSettings

from tests.drivers.hands.test_hands_driver import HandsRig, Session, with_hands
from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.drivers.contract import HandInput, Scope
from woz_tui.motion.body_feeds import STATE, BodyState
from woz_tui.protocol.messages import Json

YAW = HandControl(verb="gaze", argument="yaw", range=(-60, 60), hold="button-1", rate=40)
PITCH = HandControl(
    verb="gaze", argument="pitch", range=(-20, 20), hold="button-1", rate=20, reversed=True
)
LEAN = HandControl(control="lean", on="body", hold="button-1", rate=0.5)
CONTROLS = {"turn-y": YAW, "turn-x": PITCH, "push-z": LEAN}


def play(scene: Callable[[HandsRig], Awaitable[None]], stands: BodyState | None = None) -> None:
    """A 6-D mouse in virtual time, in front of a body that stands so."""

    async def go() -> None:
        session = Session(LoopClock(asyncio.get_running_loop()))
        settings = HandsSettings(device="spacemouse", controls=CONTROLS, dead_zone=0.0)
        assert settings.problems() == []
        driver = HandsPanel("mouse", settings, session)
        if stands is not None:
            session.feed(STATE, of="body").put(stands)
        await with_hands(driver, session, scene)

    run_virtual(go())


def last(rig: HandsRig) -> dict[str, Json]:
    return rig.new_requests()[-1][2]


@pytest.mark.toolkit("X4")
def test_a_push_moves_it_on_and_rest_leaves_it_there() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(1.0, turn_y=1, turn_x=0.5, button_1=1)
        [ask, *_] = rig.session.asks
        assert (ask.name, ask.source) == ("gaze", "spacemouse")
        where = last(rig)
        assert where == pytest.approx({"yaw": 40, "pitch": -10}, abs=5)
        rig.hold(button_1=1)
        await rig.hold_for(1.0, button_1=1)
        assert rig.new_requests() == []
        await rig.hold_for(0.5, turn_y=-1, button_1=1)
        assert last(rig)["yaw"] == pytest.approx(float(str(where["yaw"])) - 20, abs=5)

    play(scene)


@pytest.mark.toolkit("X4")
def test_without_the_dead_mans_button_nothing_moves() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(1.0, turn_y=1)
        assert rig.new_requests() == []
        await rig.hold_for(0.5, turn_y=1, button_1=1)
        assert rig.new_requests()
        await rig.hold_for(1.0, turn_y=1)
        # The press of the button itself is looked at once more at its end.
        assert rig.new_requests() == []

    play(scene)


def test_a_hand_that_is_not_heard_any_more_moves_nothing() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(0.5, turn_y=1, button_1=1)
        await asyncio.sleep(1.0)
        rig.new_requests()
        await asyncio.sleep(1.0)
        assert rig.new_requests() == []

    play(scene)


@pytest.mark.toolkit("X4")
def test_the_stop_ends_it_until_the_hand_was_at_rest() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(0.5, turn_y=1, button_1=1)
        await rig.driver.stop(Scope.ALL)
        rig.new_requests()
        await rig.hold_for(0.5, turn_y=1, button_1=1)
        await rig.driver.resume()
        await rig.hold_for(0.5, turn_y=1, button_1=1)
        assert rig.new_requests() == []
        rig.hold()
        await rig.hold_for(0.5, turn_y=1, button_1=1)
        assert rig.new_requests()

    play(scene)


def test_a_control_goes_on_from_where_the_body_stands() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(0.4, push_z=1, button_1=1)
        assert last(rig) == pytest.approx({"control": "lean", "value": 1.0}, abs=0.05)
        await rig.hold_for(0.4, push_z=1, button_1=1)
        assert [ask["value"] for _, _, ask in rig.new_requests()] in ([], [1.0])

    play(scene, BodyState({"lean": 0.8}, "normal", "neutral", "", ""))


def test_a_refusal_is_told_once_and_counts_until_it_is_let_go() -> None:
    async def scene(rig: HandsRig) -> None:
        rig.session.outcome = (False, "locked")
        await rig.hold_for(1.0, turn_y=1, button_1=1)
        assert len(rig.new_requests()) == 1
        [told] = [text for _, text, _ in rig.session.notices if "locked" in text]
        assert told.endswith("(gaze) moves nothing: locked")
        rig.hold()
        await rig.hold_for(0.3, turn_y=1, button_1=1)
        assert len(rig.new_requests()) == 1

    play(scene)


@pytest.mark.toolkit("X4")
@pytest.mark.parametrize("seed", range(8))
def test_no_hand_leaves_the_range(seed: int) -> None:
    """Whatever is pushed for however long."""
    dice = random.Random(seed)

    async def scene(rig: HandsRig) -> None:
        for _ in range(60):
            values = {name: dice.uniform(-1, 1) for name in CONTROLS} | {"button-1": 1.0}
            rig.driver.take_hand(HandInput("con1", values, device="a mouse"))
            await asyncio.sleep(dice.choice((0.01, 0.1, 0.45)))
        for _, name, args in rig.new_requests():
            assert name in ("gaze", "control")
            assert all(
                low <= float(str(args[what])) <= high
                for what, low, high in (("yaw", -60, 60), ("pitch", -20, 20), ("value", 0, 1))
                if what in args
            )

    play(scene)


@pytest.mark.parametrize(
    ("control", "settings", "sentence"),
    [
        ("turn-y", {"hold": ""}, "dead man's button"),
        ("turn-y", {"every": 1.0}, "steps or a rate"),
        ("turn-y", {"control": "lean", "verb": "", "argument": "", "take_over": "soft"}, "begins"),
        ("turn-y", {"verb": "drive", "argument": "turn"}, "driving needs every"),
        ("button-2", {}, "is for sticks and triggers"),
        ("turn-q", {}, "did you mean 'turn-"),
    ],
)
def test_what_makes_no_sense_is_named(
    control: str, settings: dict[str, Any], sentence: str
) -> None:
    words = {"verb": "gaze", "argument": "yaw", "hold": "button-1", "rate": 40.0, **settings}
    if "control" in settings:
        words["range"] = (0.0, 1.0)
    made = HandsSettings(device="spacemouse", controls={control: HandControl(**words)})
    assert any(sentence in text for _, text in made.problems())
