"""What hands at a gamepad or a Stream Deck ask of the session, and what lets them go."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.hands import HandsPanel
from woz_drivers.hands.settings import HandControl, HandsSettings

from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.drivers.contract import Ask, HandInput, RejectedError, Scope
from woz_tui.protocol.messages import ControlsMoved, Json
from woz_tui.testing import RecordingContext

DRIVE_X = HandControl(verb="drive", argument="x", range=(-1, 1), hold="left-bumper", every=1.0)
DRIVE_TURN = HandControl(
    verb="drive", argument="turn", range=(-90, 90), reversed=True, hold="left-bumper", every=1.0
)
CONTROLS = {
    "south": HandControl(action="Hello"),
    "east": HandControl(key="f13"),
    "west": HandControl(emotion="happy", press="momentary"),
    "select": HandControl(stop="all"),
    "left-trigger": HandControl(mark="now"),
    "right-trigger": HandControl(verb="volume", argument="level"),
    "left-stick-y": DRIVE_X,
    "left-stick-x": DRIVE_TURN,
    "right-stick-x": HandControl(verb="gaze", argument="yaw", range=(-60, 60), reversed=True),
    "right-stick-y": HandControl(verb="gaze", argument="pitch", range=(-20, 20)),
}


class Session(RecordingContext):
    """Answers an ask at once, or with `slow` when the test says so."""

    def __init__(self, clock: LoopClock) -> None:
        super().__init__(Path(), clock)
        self.slow = False
        self.waiting: list[Callable[[bool, str], None]] = []

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        self.asks.append(ask)
        assert done is not None
        if self.slow:
            self.waiting.append(done)
        else:
            done(*self.outcome)


class HandsRig:
    """A driver with a hand in front of it."""

    def __init__(self, driver: HandsPanel, session: Session) -> None:
        self.driver = driver
        self.session = session

    def hold(self, client: str = "con1", /, **values: float) -> None:
        """All that is not at rest now (`left_stick_y` is left-stick-y)."""
        named = {name.replace("_", "-"): value for name, value in values.items()}
        self.driver.take_hand(HandInput(client, named, device="a pad"))

    async def hold_for(self, seconds: float, **values: float) -> None:
        """The same, said again ten times a second."""
        for _ in range(round(seconds * 10)):
            self.hold(**values)
            await asyncio.sleep(0.1)

    def new_requests(self) -> list[tuple[str, str, dict[str, Json]]]:
        """What has been asked for since the last time."""
        asks = [(ask.what, ask.name, dict(ask.args)) for ask in self.session.asks]
        self.session.asks.clear()
        return asks

    def drives(self) -> list[dict[str, Json]]:
        return [args for _, name, args in self.new_requests() if name == "drive"]

    def cancellations(self) -> list[str]:
        return [what for what, _, _ in self.new_requests() if what in ("cancel", "halt")]


async def with_hands(
    driver: HandsPanel, session: Session, scene: Callable[[HandsRig], Awaitable[None]]
) -> None:
    """Play a scene with a device that is at rest."""
    await driver.open()
    rig = HandsRig(driver, session)
    rig.hold()
    try:
        await scene(rig)
    finally:
        await driver.close()


def play(scene: Callable[[HandsRig], Awaitable[None]], **settings: Any) -> None:
    """Play a scene in virtual time."""

    async def go() -> None:
        session = Session(LoopClock(asyncio.get_running_loop()))
        hands_settings = HandsSettings(**{"controls": CONTROLS, **settings})
        assert hands_settings.problems() == []
        await with_hands(HandsPanel("pad", hands_settings, session), session, scene)

    run_virtual(go())


def test_a_button_asks_once_however_often_it_is_said_to_be_held() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(1.0, south=1)
        [ask] = rig.session.asks
        assert (ask.what, ask.name, ask.source, ask.key) == ("action", "Hello", "gamepad", "south")
        rig.hold()
        rig.hold(east=1)
        rig.hold(left_trigger=0.9)
        rig.hold(left_trigger=1.0)
        assert [ask[:2] for ask in rig.new_requests()] == [
            *(("action", "Hello"), ("key", "f13"), ("mark", "now"))
        ]

    play(scene)


def test_what_a_hand_does_is_shown_on_the_scale_of_panels() -> None:
    async def scene(rig: HandsRig) -> None:
        rig.hold(left_stick_y=1, right_stick_x=-1, right_trigger=0.5, south=1)
        await asyncio.sleep(0.2)
        rig.hold()
        await asyncio.sleep(0.2)
        shown = [one for one in rig.session.shown if isinstance(one, ControlsMoved)]
        values = {**shown[0].values}
        assert values == {
            **{"left-stick-y": 127, "right-stick-x": 0, "right-trigger": 64, "south": 127}
        }
        assert shown[-1].values["left-stick-y"] == 64

    play(scene)


def test_both_axes_of_a_stick_set_one_direction_and_the_newest_counts() -> None:
    async def scene(rig: HandsRig) -> None:
        rig.hold(right_stick_x=1, right_stick_y=1)
        assert rig.new_requests() == [("verb", "gaze", {"yaw": -60.0, "pitch": 20.0})]
        rig.session.slow = True
        for share in (0.9, 0.7, 0.6):
            rig.hold(right_stick_x=share)
        assert len(rig.session.asks) == 1
        rig.session.waiting.pop(0)(True, "")
        first, newest = rig.new_requests()
        assert first[2]["yaw"] == yaw_of(0.9)
        assert newest[2]["yaw"] == yaw_of(0.6)
        rig.session.slow = False
        rig.session.waiting.pop(0)(True, "")
        rig.hold()
        assert rig.new_requests() == [("verb", "gaze", {"yaw": 0.0, "pitch": 0.0})]

    play(scene)


def yaw_of(share: float) -> Any:
    """60 degrees to the right, behind a dead zone of 0.15."""
    return pytest.approx(-60 * (share - 0.15) / 0.85, abs=0.1)


def test_nothing_moves_in_the_dead_zone() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(1.0, right_stick_x=0.15, left_stick_y=-0.1, left_bumper=1)
        assert rig.new_requests() == []

    play(scene)


def test_a_stick_drives_by_steps_while_the_dead_mans_button_is_held() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(3.0, left_stick_y=1)
        assert rig.new_requests() == []
        await rig.hold_for(2.5, left_stick_y=1, left_bumper=1)
        assert rig.drives() == [{"x": 1.0, "turn": 0.0}] * 3
        await rig.hold_for(0.5, left_stick_y=1, left_stick_x=-1, left_bumper=1)
        assert rig.drives() == [{"x": 1.0, "turn": 90.0}]
        await rig.hold_for(0.5, left_stick_y=1, left_stick_x=-1)
        assert rig.cancellations() == ["cancel"]
        await rig.hold_for(0.5, left_stick_y=1, left_bumper=1)
        rig.hold(left_bumper=1)
        assert rig.cancellations() == ["cancel"]

    play(scene)


def test_what_is_not_said_again_is_let_go_and_counts_after_a_rest() -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(1.0, left_stick_y=1, left_bumper=1, west=1)
        rig.new_requests()
        await asyncio.sleep(0.6)
        ended = rig.new_requests()
        assert [what for what, *_ in ended if what != "verb"] == ["cancel", "halt"]
        assert ("verb", "emotion", {"emotion": "neutral"}) in ended
        assert "nothing was heard" in rig.session.notices[-1][1]
        await rig.hold_for(2.0, left_stick_y=1, left_bumper=1, west=1)
        assert rig.new_requests() == [], "the line is back, but the fingers have never moved"
        await rig.hold_for(0.3, left_stick_y=1)
        await rig.hold_for(0.3, left_stick_y=1, left_bumper=1)
        assert rig.drives() == [], "the stick was not let go"
        rig.hold(left_stick_y=0.1, left_stick_x=-0.02, left_trigger=0.01)
        rig.hold(left_stick_y=1, left_bumper=1)
        assert rig.drives() == [{"x": 1.0, "turn": 0.0}]

    play(scene)


LOST: dict[str, Callable[[HandsRig], Any]] = {
    "unplugged": lambda rig: rig.driver.take_hand(HandInput("con1", {}, device="")),
    "the connection ends": lambda rig: rig.driver.lose_hand("con1"),
    "another hand takes it": lambda rig: rig.driver.take_hand(
        HandInput("con2", {"south": 1}, device="another", take_over=True)
    ),
}


@pytest.mark.parametrize("how", LOST)
def test_a_hand_that_is_lost_lets_go_of_everything(how: str) -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(0.5, left_stick_y=1, left_bumper=1, west=1)
        rig.new_requests()
        LOST[how](rig)
        ended = rig.new_requests()
        assert ("verb", "emotion", {"emotion": "neutral"}) in ended
        assert [what for what, *_ in ended if what != "verb"] == ["cancel", "halt"]
        health = rig.session.healths[-1][1]
        assert health.startswith("another" if "hand" in how else "no gamepad")
        await asyncio.sleep(3)
        assert rig.new_requests() == [], "a button that was held at its taking over was not pressed"

    play(scene)


def test_a_second_client_is_told_whose_hands_it_is_in() -> None:
    async def scene(rig: HandsRig) -> None:
        with pytest.raises(RejectedError, match="con1"):
            rig.hold("con2", south=1)
        rig.driver.lose_hand("con2")
        rig.hold(south=1)
        assert [ask[:2] for ask in rig.new_requests()] == [("action", "Hello")]
        rig.driver.lose_hand("con1")
        rig.hold("con2")
        rig.hold("con2", south=1)
        assert [ask[:2] for ask in rig.new_requests()] == [("action", "Hello")]

    play(scene)


@pytest.mark.parametrize("scope", Scope)
def test_a_stop_ends_what_is_held_until_it_has_been_let_go(scope: Scope) -> None:
    async def scene(rig: HandsRig) -> None:
        await rig.hold_for(0.5, left_stick_y=1, left_bumper=1, right_stick_x=1)
        await rig.driver.stop(scope)
        await rig.driver.resume()
        rig.new_requests()
        await rig.hold_for(3.0, left_stick_y=1, left_bumper=1, right_stick_x=0.8)
        assert rig.new_requests() == []
        rig.hold()
        rig.hold(left_stick_y=1, left_bumper=1)
        assert rig.drives() == [{"x": 1.0, "turn": 0.0}]

    play(scene)


def test_the_stop_is_asked_for_once_also_when_its_client_has_sent_it_already() -> None:
    async def scene(rig: HandsRig) -> None:
        rig.hold(select=1)
        assert [what for what, *_ in rig.new_requests()] == ["stop"]
        rig.hold()
        await rig.driver.stop(Scope.ALL)
        rig.hold(select=1)
        assert rig.new_requests() == []

    play(scene)


def test_a_refused_drive_is_not_asked_for_again_and_again() -> None:
    async def scene(rig: HandsRig) -> None:
        rig.session.outcome = (False, "no wizard's console is attached")
        await rig.hold_for(4.0, left_stick_y=1, left_bumper=1)
        assert len(rig.drives()) == 1
        [(level, text, _)] = rig.session.notices
        assert level == "warning"
        assert "no wizard's console" in text
        rig.hold(left_stick_y=1)
        await rig.hold_for(4.0, left_stick_y=1, left_bumper=1)
        assert len(rig.drives()) == 1

    play(scene)


def test_an_old_press_is_refused_by_its_age_and_an_old_stick_moves_nothing() -> None:
    async def scene(rig: HandsRig) -> None:
        late = {"south": 1.0, "left-stick-y": 1.0, "left-bumper": 1.0, "right-stick-x": 1.0}
        rig.driver.take_hand(HandInput("con1", late, age_us=2_000_000, stale=True))
        [ask] = rig.session.asks
        assert (ask.name, ask.age_us) == ("Hello", 2_000_000)
        await rig.hold_for(2.0, south=1, left_stick_y=1, left_bumper=1, right_stick_x=1)
        assert len(rig.session.asks) == 1

    play(scene)


@pytest.mark.parametrize(
    ("values", "names"),
    [
        ({"sotuh": 1.0}, "south"),
        ({"key-1": 1.0}, "key-1"),
        ({"south": -1.0}, "south"),
        ({"left-stick-y": -1.01}, "left-stick-y"),
        ({"left-stick-y": float("nan")}, "left-stick-y"),
        ({"right-trigger": float("inf")}, "right-trigger"),
    ],
)
def test_values_that_no_control_has_are_refused_whole(values: dict[str, float], names: str) -> None:
    async def scene(rig: HandsRig) -> None:
        with pytest.raises(RejectedError, match=names):
            rig.driver.take_hand(HandInput("con1", {"south": 1.0, **values}))
        assert rig.new_requests() == []

    play(scene)


def test_a_stick_on_a_body_waits_until_it_has_passed_the_robots_value() -> None:
    pitch = {"left-stick-y": HandControl(control="pitch", hold="left-bumper")}

    async def scene(rig: HandsRig) -> None:
        rig.hold(left_bumper=1, left_stick_y=0.5)
        await asyncio.sleep(0.1)
        shown = [one for one in rig.session.shown if isinstance(one, ControlsMoved)]
        assert shown[-1].waiting == ["left-stick-y"]
        assert rig.new_requests() == []

    play(scene, controls=pitch, on="body")
    play(jump, controls=pitch, take_over="jump")


async def jump(rig: HandsRig) -> None:
    rig.hold(left_stick_y=1)
    assert rig.new_requests() == []
    rig.hold(left_bumper=1, left_stick_y=0.9)
    [(_, verb, args)] = rig.new_requests()
    assert (verb, args["control"]) == ("control", "pitch")
    assert float(str(args["value"])) > 0.9


def test_keys_of_a_stream_deck_are_pressed_and_logged_as_such() -> None:
    keys = {"key-1": HandControl(action="Hello"), "dial-2": HandControl(script=True)}

    async def scene(rig: HandsRig) -> None:
        rig.hold(key_1=1)
        rig.hold(dial_2=1)
        assert [(ask.what, ask.source, ask.key) for ask in rig.session.asks] == [
            *(("action", "stream-deck", "key-1"), ("script", "stream-deck", "dial-2"))
        ]

    play(scene, device="stream-deck", controls=keys)


PROBLEMS: list[tuple[str, HandControl, str]] = [
    ("soth", HandControl(action="Hello"), "controls.soth"),
    ("left-stick-y", HandControl(verb="drive", argument="x", range=(-1, 1)), "hold"),
    (
        "left-stick-y",
        HandControl(verb="drive", argument="x", range=(-1, 1), hold="left-bumper"),
        "every",
    ),
    (
        "left-stick-y",
        HandControl(verb="nudge", argument="yaw", range=(-1, 1), every=0.1),
        "every",
    ),
    ("left-stick-y", HandControl(action="Hello"), "action"),
    ("left-stick-y", HandControl(control="pitch", hold="bumper"), "hold"),
    ("south", HandControl(verb="drive", args={"x": 1}), "controls.south"),
    ("south", HandControl(action="Hello", hold="left-bumper"), "hold"),
    ("south", HandControl(action="Hello", key="h"), "key"),
]


@pytest.mark.parametrize(("name", "control", "where"), PROBLEMS)
def test_what_makes_no_sense_in_a_file_is_told_with_its_place(
    name: str, control: HandControl, where: str
) -> None:
    problems = HandsSettings(controls={name: control}).problems()
    assert len(problems) == 1
    assert where in " ".join(problems[0])
