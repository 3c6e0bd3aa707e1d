"""Samples that are missing, old or stamped oddly: what the model makes of time."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.visitor_samples import GONE, PERIOD, WITH, Visit
from woz_tui.config.engagement import SignSettings
from woz_tui.config.engagement_words import FILTERS, START_UPS
from woz_tui.sensing.model_time import LONGEST_PAUSE, SECOND, ModelClock, microseconds
from woz_tui.sensing.state_machine import State

signs = pytest.mark.parametrize("sign", ["presence", "gaze", "distance"])


def engaged_visit(**settings: Any) -> Visit:
    """Somebody with a name, after four seconds."""
    visit = Visit(quick=False, **settings)
    visit.see(12, **WITH, identity="Anna")
    assert visit.model.engaged
    return visit


def without(sign: str) -> dict[str, Any]:
    return {name: value for name, value in WITH.items() if name != sign}


# -- no evidence --------------------------------------------------------------------------------


@signs
@pytest.mark.parametrize("nothing", [None, math.nan, "NaN", "rubbish", [], -1])
def test_what_says_nothing_takes_no_place(sign: str, nothing: object) -> None:
    visit = Visit(quick=False)
    visit.see(4, **WITH)
    before = visit.model.shown().signs[sign]
    for _ in range(50):
        visit.model.sample(sign, nothing)
    assert visit.model.shown().signs[sign] == before


@signs
def test_a_nan_never_counts_as_a_one(sign: str) -> None:
    visit = Visit(quick=False, threshold=0.125)
    assert visit.see(20, **{sign: math.nan}) == []
    assert visit.model.verdicts[sign] == 0


# -- stale --------------------------------------------------------------------------------------


@signs
def test_after_more_than_a_second_of_silence_a_sign_is_stale_and_its_queue_empty(sign: str) -> None:
    visit = engaged_visit()
    last = visit.t
    visit.model.advance(last + SECOND)
    assert visit.model.signs.stale == []
    visit.model.advance(last + SECOND + 1)
    sign_shown = visit.model.shown().signs[sign]
    assert (sign_shown.verdict, sign_shown.stale, sign_shown.count) == (0, True, 0)
    assert not visit.model.engaged
    change = visit.model.step()
    assert change is not None
    assert change.outcome == "error"
    assert "presence stale" in change.why
    visit.see(**WITH)
    assert visit.model.shown().signs[sign].count == 1
    assert visit.model.verdicts[sign] == 0


def test_an_identity_that_is_stale_is_unknown() -> None:
    visit = engaged_visit()
    assert visit.model.verdicts["identity"] == "Anna"
    visit.see(4, **WITH)
    assert visit.model.verdicts["identity"] == "Unknown"
    assert visit.model.signs.stale == ["identity"]
    assert visit.model.engaged


@signs
def test_nulls_do_not_keep_a_sign_alive(sign: str) -> None:
    visit = engaged_visit()
    changes = visit.see(4, **without(sign), **{sign: None})
    assert [change.outcome for change in changes] == ["error"]


def test_each_sign_grows_stale_by_itself() -> None:
    visit = engaged_visit(gaze=SignSettings(stale=0.5))
    visit.see(2, **without("gaze"))
    assert visit.model.signs.stale == ["gaze"]


def test_a_sign_that_never_came_is_not_called_stale() -> None:
    visit = Visit()
    visit.see(9, presence=1)
    assert visit.model.signs.stale == []
    assert "no gaze sensor" in visit.model.reason


def test_after_a_silence_a_held_verdict_starts_anew() -> None:
    """`hold`: 0 while stale, none until the queue is full again."""
    visit = engaged_visit(start_up="hold", samples=3)
    visit.model.advance(visit.t + 2 * SECOND)
    visit.t += 2 * SECOND
    assert visit.model.verdicts["presence"] == 0
    found = []
    for _ in range(3):
        visit.see(**WITH)
        found.append(visit.model.verdicts["presence"])
    assert found == [None, None, 1]


@given(
    st.fixed_dictionaries(
        {
            "filter": st.sampled_from(FILTERS),
            "start_up": st.sampled_from(START_UPS),
            "samples": st.integers(1, 12),
            "threshold": st.integers(0, 10).map(lambda tenth: tenth / 10),
            "stale": st.sampled_from([0.5, 1.0, 2.0, 60.0]),
        }
    ),
    st.sampled_from(["presence", "gaze", "distance"]),
)
def test_nobody_is_engaged_by_data_older_than_two_seconds(
    settings: dict[str, Any], sign: str
) -> None:
    """Binding under every policy, also where a setting lets a queue live for longer."""
    visit = Visit(quick=False, **settings)
    visit.see(15, **WITH, identity="Anna")
    heard = visit.t
    while visit.t <= heard + 5 * SECOND:
        visit.see(**without(sign), identity="Anna")
        assert not visit.model.engaged or visit.t - heard <= 2 * SECOND
        assert visit.model.verdicts[sign] in (0, 1, None)


def test_a_deadline_is_due_by_itself() -> None:
    visit = engaged_visit()
    due = visit.model.due()
    assert due == visit.t + SECOND + 1
    visit.model.advance(due)
    assert visit.model.due() == due
    assert visit.model.step() is not None


# -- clocks -------------------------------------------------------------------------------------


def test_a_wall_clock_that_is_set_back_loses_nobody() -> None:
    visit = engaged_visit()
    visit.t -= 3600 * SECOND
    assert visit.see(60, **WITH, identity="Anna") == []
    assert visit.model.state is State.KNOWN


def test_a_clock_that_only_goes_back_still_passes() -> None:
    """Each step back is one period: a sign that has gone silent is noticed all the same."""
    visit = engaged_visit()
    for _ in range(4):
        visit.t -= SECOND + PERIOD
        visit.see(**without("gaze"), identity="Anna")
    assert visit.model.signs.stale == ["gaze"]


def test_a_step_forward_is_a_pause() -> None:
    visit = engaged_visit()
    visit.t += 10 * SECOND
    changes = visit.see(**WITH, identity="Anna")
    assert [change.outcome for change in changes] == ["error"]


@given(st.lists(st.integers(-(10**18), 10**18), max_size=50))
def test_the_models_time_never_goes_back_and_never_leaps(stamps: list[int]) -> None:
    time = ModelClock(0, PERIOD)
    for stamp in stamps:
        before = time.now
        time.to(stamp)
        assert 0 <= time.now - before <= LONGEST_PAUSE
        assert time.stamp(time.now) == stamp


@given(st.lists(st.integers(0, 10**12), max_size=50).map(sorted))
def test_stamps_in_order_are_the_models_time(stamps: list[int]) -> None:
    time = ModelClock(0, PERIOD)
    for stamp in stamps:
        small = time.now + min(stamp - time.now, LONGEST_PAUSE)
        time.to(small)
        assert time.now == small


@given(st.floats(0, 1e5))
def test_a_limit_is_reached_at_its_microsecond(seconds: float) -> None:
    whole = microseconds(seconds)
    assert whole / SECOND >= seconds > (whole - 1) / SECOND - 1e-9


def reason_of_leaving(visit: Visit, after: dict[str, Any]) -> str:
    """Why somebody is not there any more, who stood far away before."""
    visit.see(presence=1, gaze=1, distance=3.0)
    assert visit.model.state is State.DETECTED
    (change,) = visit.see(6, **after)
    assert change.outcome == "human_absence"
    return change.why


def test_why_nobody_is_there_is_said_once() -> None:
    assert reason_of_leaving(Visit(), GONE) == "nobody is there"
    assert reason_of_leaving(Visit(), {"presence": 0}) == "nobody is there"


def test_a_silent_sensor_is_no_visitor_who_looks_away() -> None:
    assert reason_of_leaving(Visit(), {"gaze": 0}) == "nobody is there: presence stale"
    two = Visit(signs=("gaze", "distance"))
    assert reason_of_leaving(two, GONE) == "nobody is there: looks away, not near 3.0 m"
    two = Visit(signs=("gaze", "distance"))
    assert (
        reason_of_leaving(two, {"distance": 3.0}) == "nobody is there: gaze stale, not near 3.0 m"
    )


def test_a_sensor_that_never_spoke_says_nothing_about_the_visitor() -> None:
    visit = Visit(signs=("presence", "gaze"))
    (change,) = visit.see(presence=1)
    assert change.why == "present, gaze not known yet, no name"
    visit.wait(3, presence=1)
    assert visit.model.reason == "present, no gaze sensor, no name"
    visit.see(presence=1, gaze=0)
    assert visit.model.reason == "present, looks away, no name"
    visit.wait(3, presence=1)
    assert visit.model.reason == "present, gaze stale, no name"
    visit.model.override("gaze", False)
    assert visit.model.reason == "present, looks away (wizard), no name"


def test_the_wizard_may_say_that_nobody_is_there() -> None:
    visit = Visit()
    visit.see(presence=1)
    visit.model.override("presence", False)
    change = visit.model.step()
    assert change is not None and change.why == "nobody is there (wizard)"
