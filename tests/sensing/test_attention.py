"""E8: the three modes in which a robot attends to what is not the engaged visitor."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.engagement import MODES, AttentionSettings
from woz_tui.sensing.attention import (
    Attention,
    GazeDirection,
    KeepLooking,
    LookBack,
    Order,
    Stimulus,
    SwitchPartner,
    direction_words,
)

SECOND = 1_000_000
SETTINGS = AttentionSettings(seconds=2.0, within=15.0)


def attention(mode: str, *, engaged: float | None = None) -> Attention:
    """One whose visitor, if there is one, stands in the direction `engaged`."""
    made = Attention(replace(SETTINGS, mode=mode))
    if engaged is not None:
        made.engaged(True, engaged, 0)
    return made


def stays(order: Order) -> str:
    assert isinstance(order, KeepLooking)
    return order.why


# -- E8: unengaged ------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", Stimulus)
def test_unengaged_anything_distracts_it_from_the_visitor(kind: Stimulus) -> None:
    """E8: Unengaged."""
    robot = attention("Unengaged", engaged=10.0)
    order = robot.stimulus(kind, 70.0, SECOND)
    assert isinstance(order, GazeDirection) and order.direction == 70.0
    assert "70 degrees to the left" in order.why
    assert robot.away and "70 degrees" in robot.shown


def test_unengaged_it_may_turn_to_somebody_else_for_good() -> None:
    """E8: Unengaged."""
    robot = attention("Unengaged", engaged=0.0)
    robot.stimulus(Stimulus.SOUND, 70.0, 0)
    order = robot.somebody_there(True, SECOND)
    assert order == SwitchPartner(70.0, "somebody is 70 degrees to the left")
    assert robot.due() is None and not robot.away
    assert "where the visitor is" in stays(robot.stimulus(Stimulus.TOUCH, 65.0, 2 * SECOND))


@pytest.mark.parametrize("mode", ["Unengaged", "SemiEngaged"])
def test_where_nobody_is_found_it_goes_back_to_what_it_did(mode: str) -> None:
    """E8: a stimulus without anybody."""
    robot = attention(mode, engaged=10.0)
    robot.stimulus(Stimulus.SOUND, -70.0, 0)
    assert robot.somebody_there(False, SECOND) == LookBack(
        10.0, "nobody 70 degrees to the right; back to the visitor"
    )
    robot.stimulus(Stimulus.TOUCH, -70.0, 2 * SECOND)
    assert robot.due() == 4 * SECOND
    assert robot.advance(4 * SECOND - 1) is None
    assert robot.advance(4 * SECOND) == LookBack(
        10.0, "looked 70 degrees to the right long enough; back to the visitor"
    )


# -- E8: fully engaged --------------------------------------------------------------------------


@pytest.mark.parametrize("kind", Stimulus)
def test_fully_engaged_nothing_distracts_it_until_the_visitor_is_lost(kind: Stimulus) -> None:
    """E8: FullyEngaged."""
    robot = attention("FullyEngaged", engaged=0.0)
    assert "full attention" in stays(robot.stimulus(kind, 70.0, SECOND))
    assert robot.due() is None
    robot.engaged(False, None, 2 * SECOND)
    assert isinstance(robot.stimulus(kind, 70.0, 10 * SECOND), GazeDirection)


def test_fully_engaged_a_look_ends_when_somebody_engages() -> None:
    """E8: FullyEngaged."""
    robot = attention("FullyEngaged")
    robot.stimulus(Stimulus.SOUND, 70.0, 0)
    assert robot.engaged(True, 5.0, SECOND) == LookBack(
        5.0, "somebody is engaged; back to the visitor"
    )


# -- E8: semi-engaged ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", Stimulus)
def test_semi_engaged_it_looks_and_comes_back_to_the_visitor(kind: Stimulus) -> None:
    """E8: SemiEngaged."""
    robot = attention("SemiEngaged", engaged=-10.0)
    assert isinstance(robot.stimulus(kind, 70.0, 0), GazeDirection)
    assert robot.somebody_there(True, SECOND) is None
    order = robot.advance(2 * SECOND)
    assert isinstance(order, LookBack) and order.direction == -10.0


def test_semi_engaged_it_stays_with_somebody_after_the_visitor_is_lost() -> None:
    """E8: SemiEngaged, after loss."""
    robot = attention("SemiEngaged", engaged=0.0)
    robot.stimulus(Stimulus.SOUND, 70.0, 0)
    assert robot.engaged(False, None, SECOND) is None
    assert isinstance(robot.somebody_there(True, SECOND), SwitchPartner)
    robot.stimulus(Stimulus.TOUCH, -70.0, SECOND)
    assert robot.advance(3 * SECOND) == LookBack(
        None, "looked 70 degrees to the right long enough; back to what it did"
    )


def test_semi_engaged_many_stimuli_do_not_keep_it_away_for_longer() -> None:
    """E8: SemiEngaged always returns."""
    robot = attention("SemiEngaged", engaged=0.0)
    robot.stimulus(Stimulus.MOVEMENT, 30.0, 0)
    for number, kind in enumerate(reversed(list(Stimulus)[:-1]), 1):
        order = robot.stimulus(kind, 30.0 + 30 * number, number * SECOND // 3)
        assert isinstance(order, GazeDirection), kind
    assert robot.due() == 2 * SECOND
    assert isinstance(robot.advance(2 * SECOND), LookBack)


# -- priorities and what is a stimulus ----------------------------------------------------------


@pytest.mark.parametrize("first", Stimulus)
@pytest.mark.parametrize("second", Stimulus)
def test_only_what_counts_for_more_takes_over(first: Stimulus, second: Stimulus) -> None:
    """E8: People, Touch, TabletTouch, Sound, Movement."""
    robot = attention("SemiEngaged")
    robot.stimulus(first, 40.0, 0)
    order = robot.stimulus(second, -40.0, SECOND)
    more = list(Stimulus).index(second) < list(Stimulus).index(first)
    assert isinstance(order, GazeDirection) == more
    if not more:
        assert "has its attention" in stays(order)


def test_the_visitors_own_voice_does_not_distract() -> None:
    robot = attention("SemiEngaged", engaged=175.0)
    assert "where the visitor is" in stays(robot.stimulus(Stimulus.SOUND, -175.0, 0))
    robot.engaged(True, None, SECOND)
    assert "where the visitor is" in stays(robot.stimulus(Stimulus.SOUND, 14.0, SECOND))
    assert isinstance(robot.stimulus(Stimulus.TOUCH, 16.0, SECOND), GazeDirection)
    assert "looks there already" in stays(robot.stimulus(Stimulus.PEOPLE, 20.0, SECOND))


def test_what_goes_on_is_looked_at_once() -> None:
    robot = attention("SemiEngaged", engaged=0.0)
    assert isinstance(robot.stimulus(Stimulus.SOUND, 60.0, 0), GazeDirection)
    assert isinstance(robot.advance(2 * SECOND), LookBack)
    for tenths in range(1, 50):
        order = robot.stimulus(Stimulus.SOUND, 60.0, 19 * SECOND // 10 + tenths * SECOND // 10)
        assert isinstance(order, GazeDirection if tenths == 1 else KeepLooking), tenths
        if isinstance(order, GazeDirection):
            robot.somebody_there(False, 2 * SECOND)
    quiet = 7 * SECOND + 2 * SECOND
    assert isinstance(robot.stimulus(Stimulus.SOUND, 60.0, quiet), GazeDirection)


def test_a_direction_may_be_missing_or_no_direction() -> None:
    robot = attention("SemiEngaged")
    assert isinstance(robot.stimulus(Stimulus.TOUCH, None, 0), GazeDirection)
    robot = attention("SemiEngaged")
    for direction in (None, math.nan, math.inf):
        assert "nobody knows where" in stays(robot.stimulus(Stimulus.SOUND, direction, 0))
    order = robot.stimulus(Stimulus.SOUND, 360.0 + 90.0, 0)
    assert isinstance(order, GazeDirection) and order.direction == 90.0


def test_the_mode_may_change_while_it_looks() -> None:
    robot = attention("SemiEngaged", engaged=0.0)
    robot.stimulus(Stimulus.SOUND, 60.0, 0)
    assert robot.attend("Unengaged", SECOND) is None
    assert robot.attend("FullyEngaged", SECOND) == LookBack(
        0.0, "mode FullyEngaged; back to the visitor"
    )
    with pytest.raises(ValueError, match="there is no mode 'Asleep'"):
        robot.attend("Asleep", SECOND)


def test_directions_in_words() -> None:
    assert [direction_words(degrees) for degrees in (0.4, 60.2, -90.0)] == [
        "ahead",
        "60 degrees to the left",
        "90 degrees to the right",
    ]


# -- whatever happens ---------------------------------------------------------------------------

DIRECTIONS = st.none() | st.floats() | st.sampled_from([0.0, 20.0, 90.0, -90.0, 179.0, -179.0])
EVENTS = st.one_of(
    st.tuples(st.just("stimulus"), st.sampled_from(Stimulus), DIRECTIONS),
    st.tuples(st.just("engaged"), st.booleans(), DIRECTIONS),
    st.tuples(st.just("found"), st.booleans(), st.none()),
    st.tuples(st.just("advance"), st.none(), st.none()),
)
SCRIPTS = st.lists(st.tuples(EVENTS, st.integers(-500_000, 1_500_000)), max_size=60)


@given(st.sampled_from(MODES), SCRIPTS)
def test_the_promise_of_each_mode_holds_whatever_happens(
    mode: str, script: list[tuple[tuple[str, object, float | None], int]]
) -> None:
    """E8: FullyEngaged never looks away; SemiEngaged always returns in time, and to the visitor."""
    robot = attention(mode)
    engaged, t, away_since = False, 0, 0
    for (event, what, direction), step in script:
        t = max(t, t + step)
        while (due := robot.due()) is not None and due <= t:
            assert isinstance(robot.advance(due), LookBack)
        was_away = robot.away
        order = happens(robot, event, what, direction, t)
        engaged = bool(what) if event == "engaged" else engaged
        if robot.away and (not was_away or event == "engaged"):
            away_since = t
        assert not (engaged and mode == "FullyEngaged" and robot.away)
        if isinstance(order, GazeDirection | SwitchPartner):
            assert -180 <= order.direction <= 180
        if isinstance(order, SwitchPartner):
            assert not engaged or mode == "Unengaged"
        if isinstance(order, LookBack):
            assert (order.direction is not None) == engaged
        due = robot.due()
        assert (due is not None) == robot.away
        if due is not None and (not engaged or mode == "SemiEngaged"):
            assert t < due <= (away_since if engaged else t) + 2 * SECOND


def happens(
    robot: Attention, event: str, what: object, direction: float | None, t: int
) -> Order | None:
    match event, what:
        case "stimulus", Stimulus() as kind:
            return robot.stimulus(kind, direction, t)
        case "engaged", bool() as engaged:
            return robot.engaged(engaged, direction, t)
        case "found", bool() as somebody:
            return robot.somebody_there(somebody, t)
    return robot.advance(t)
