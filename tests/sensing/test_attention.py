"""E8: the modes in which a robot attends to what is not the engaged visitor."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.engagement import AttentionSettings
from woz_tui.config.engagement_words import MODES
from woz_tui.sensing.attention import (
    Attention,
    GazeDirection,
    LookBack,
    Order,
    Stay,
    direction_words,
)

SECOND = 1_000_000
SETTINGS = AttentionSettings(seconds=2.0, within=15.0, camera="head")


def attention(mode: str, *, engaged: float | None = None) -> Attention:
    """One whose visitor, if there is one, stands in the direction `engaged`."""
    made = Attention(replace(SETTINGS, mode=mode))
    if engaged is not None:
        made.engaged(True, engaged, 0)
    return made


@pytest.mark.parametrize("mode", ["Unengaged", "SemiEngaged"])
def test_it_looks_to_a_sound_and_comes_back_to_the_visitor(mode: str) -> None:
    """E8: Unengaged, SemiEngaged."""
    robot = attention(mode, engaged=-10.0)
    assert robot.sound(70.0, 0) == GazeDirection(70.0)
    assert robot.away and "70 degrees to the left" in robot.shown
    assert robot.sound(-70.0, SECOND) is None, "no other sound takes over"
    assert robot.due() == 2 * SECOND
    assert robot.advance(2 * SECOND - 1) is None
    assert robot.advance(2 * SECOND) == LookBack(-10.0)
    assert robot.due() is None


def test_fully_engaged_nothing_distracts_it_until_the_visitor_is_lost() -> None:
    """E8: FullyEngaged."""
    robot = attention("FullyEngaged", engaged=0.0)
    assert robot.sound(70.0, SECOND) is None
    assert robot.due() is None
    robot.engaged(False, None, 2 * SECOND)
    assert robot.sound(70.0, 10 * SECOND) == GazeDirection(70.0)


def test_fully_engaged_a_look_ends_when_somebody_engages() -> None:
    """E8: FullyEngaged."""
    robot = attention("FullyEngaged")
    robot.sound(70.0, 0)
    assert robot.engaged(True, 5.0, SECOND) == LookBack(5.0)


def test_where_the_visitor_is_lost_meanwhile_it_goes_back_to_what_it_did() -> None:
    """E8: SemiEngaged, after loss."""
    robot = attention("SemiEngaged", engaged=0.0)
    robot.sound(70.0, 0)
    assert robot.engaged(False, None, SECOND) is None
    assert robot.advance(3 * SECOND) == LookBack(None)


def test_the_visitors_own_voice_does_not_distract() -> None:
    robot = attention("SemiEngaged", engaged=175.0)
    assert robot.sound(-175.0, 0) is None
    robot.engaged(True, None, SECOND)
    assert robot.sound(14.0, SECOND) is None
    assert robot.sound(30.0, SECOND) == GazeDirection(30.0)


def test_what_goes_on_is_looked_at_once() -> None:
    robot = attention("SemiEngaged", engaged=0.0)
    assert robot.sound(60.0, 0) == GazeDirection(60.0)
    for tenths in range(1, 50):
        assert not isinstance(robot.sound(60.0, tenths * SECOND // 10), GazeDirection)
    assert robot.sound(60.0, 7 * SECOND) == GazeDirection(60.0)


def test_a_direction_may_be_missing_or_no_direction() -> None:
    robot = attention("SemiEngaged")
    assert [robot.sound(direction, 0) for direction in (None, math.nan, math.inf)] == [None] * 3
    assert robot.sound(360.0 + 90.0, 0) == GazeDirection(90.0)


def test_the_mode_may_change_while_it_looks() -> None:
    robot = attention("SemiEngaged", engaged=0.0)
    robot.sound(60.0, 0)
    assert robot.attend("Unengaged", SECOND) is None
    assert robot.attend("FullyEngaged", SECOND) == LookBack(0.0)
    with pytest.raises(ValueError, match="there is no mode 'Asleep'"):
        robot.attend("Asleep", SECOND)


@pytest.mark.parametrize(
    ("mode", "engaged", "camera", "end"),
    [
        ("Unengaged", -10.0, "head", Stay(70.0)),
        ("Unengaged", -10.0, "body", LookBack(-10.0)),
        ("SemiEngaged", -10.0, "head", LookBack(-10.0)),
        ("SemiEngaged", None, "head", Stay(70.0)),
        ("FullyEngaged", None, "head", Stay(70.0)),
        ("SemiEngaged", None, "body", LookBack(None)),
    ],
)
def test_it_stays_with_somebody_whom_the_camera_on_the_head_finds(
    mode: str, engaged: float | None, camera: str, end: Order
) -> None:
    """E8: Unengaged may engage another person; after a loss, anybody may be found."""
    robot = Attention(replace(SETTINGS, mode=mode, camera=camera))
    robot.engaged(engaged is not None, engaged, 0)
    robot.sound(70.0, 0)
    robot.presence(True, 1_500_000)
    assert robot.advance(2 * SECOND) == end
    assert not robot.away


def test_what_the_camera_saw_while_the_head_turned_does_not_count() -> None:
    robot = attention("Unengaged", engaged=-10.0)
    robot.sound(70.0, 0)
    for somebody, t in ((True, 0), (True, 999_999), (True, SECOND), (False, 1_500_000)):
        robot.presence(somebody, t)
    assert robot.advance(2 * SECOND) == LookBack(-10.0), "one of two is not most"


def test_who_was_found_is_the_visitor_to_whom_it_looks_back() -> None:
    """E8: Unengaged; nothing seen at the former look is left."""
    robot = attention("Unengaged", engaged=-10.0)
    robot.sound(70.0, 0)
    robot.presence(True, 1_500_000)
    assert robot.advance(2 * SECOND) == Stay(70.0)
    assert robot.sound(75.0, 3 * SECOND) is None, "that is where the visitor is"
    assert robot.sound(-60.0, 6 * SECOND) == GazeDirection(-60.0)
    assert robot.advance(8 * SECOND) == LookBack(70.0)


def test_directions_in_words() -> None:
    assert [direction_words(degrees) for degrees in (0.4, 60.2, -90.0)] == [
        "ahead",
        "60 degrees to the left",
        "90 degrees to the right",
    ]


# -- whatever happens ---------------------------------------------------------------------------

DIRECTIONS = st.none() | st.floats() | st.sampled_from([0.0, 20.0, 90.0, -90.0, 179.0, -179.0])
EVENTS = st.one_of(
    st.tuples(st.just("sound"), st.none(), DIRECTIONS),
    st.tuples(st.just("engaged"), st.booleans(), DIRECTIONS),
    st.tuples(st.just("presence"), st.none(), DIRECTIONS),
    st.tuples(st.just("advance"), st.none(), st.none()),
)
SCRIPTS = st.lists(st.tuples(EVENTS, st.integers(-500_000, 1_500_000)), max_size=60)


@given(st.sampled_from(MODES), SCRIPTS)
def test_the_promise_of_each_mode_holds_whatever_happens(
    mode: str, script: list[tuple[tuple[str, bool | None, float | None], int]]
) -> None:
    """E8: FullyEngaged never looks away; the others return in time, and to the visitor."""
    robot = attention(mode)
    engaged, t = False, 0
    for (event, what, direction), step in script:
        t = max(t, t + step)
        while (due := robot.due()) is not None and due <= t:
            over = robot.advance(due)
            assert isinstance(over, LookBack | Stay)
            assert not (isinstance(over, Stay) and engaged and mode != "Unengaged")
        engaged = engaged if what is None else what
        order = happens(robot, event, engaged, direction, t)
        assert not (engaged and mode == "FullyEngaged" and robot.away)
        if isinstance(order, GazeDirection):
            assert -180 <= order.direction <= 180
        if isinstance(order, LookBack):
            assert (order.direction is not None) == engaged
        due = robot.due()
        assert (due is not None) == robot.away
        assert due is None or t < due <= t + 2 * SECOND


def happens(
    robot: Attention, event: str, engaged: bool, direction: float | None, t: int
) -> Order | None:
    match event:
        case "sound":
            return robot.sound(direction, t)
        case "engaged":
            return robot.engaged(engaged, direction, t)
        case "presence":
            robot.presence(direction is not None, t)
            return None
    return robot.advance(t)
