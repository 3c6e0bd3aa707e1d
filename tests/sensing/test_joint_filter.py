"""The joint filter: what it says about visitors, whatever comes in and whenever."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.sensing.joint_dwell import CONDITIONS, WORLDS, Dwell, after_steps
from woz_tui.sensing.joint_filter import JointFilter

SIGNS = ("presence", "gaze", "distance", "identity")
PERIOD = 333_333
NEAR = 1.3
#: Rows of presence, gaze, distance, name; None says nothing.
Row = tuple[float | None, float | None, float | None, str | None]
ENGAGED: Row = (1.0, 1.0, 0.9, "Ada")
NOBODY: Row = (0.0, 0.0, 3.0, "Unknown")
TURNED: Row = (1.0, 0.0, 0.9, "Unknown")
BACK: Row = (1.0, 1.0, 2.2, "Ada")


class Robot:
    """Rows at 3 Hz, or another rate, into a joint filter."""

    def __init__(self, period: int = PERIOD, **settings: float | str) -> None:
        self.joint = JointFilter(NEAR, **settings)  # type: ignore[arg-type]
        self.t = 0
        self.period = period

    def see(self, row: Row, times: int = 1) -> Robot:
        for _ in range(times):
            self.t += self.period
            for sign, value in zip(SIGNS, row, strict=True):
                if value is not None:
                    self.joint.add(sign, value, self.t)
        return self

    @property
    def engaged(self) -> bool:
        return all(self.joint.view(sign).verdict == 1 for sign in SIGNS[:3])

    def samples_until(self, engaged: bool, row: Row) -> int:
        """How many rows it takes until the condition is as it should be; 51: more than 50."""
        return next((count for count in range(1, 51) if self.see(row).engaged == engaged), 51)

    def samples_until_signs(self, signs: Sequence[str], verdict: int, row: Row) -> int:
        """The same for some signs only, which are all to say `verdict`."""
        for count in range(1, 51):
            self.see(row)
            if all(self.joint.view(sign).verdict == verdict for sign in signs):
                return count
        return 51


def only(signs: Sequence[str], row: Row) -> Row:
    """The row of a lab that has sensors for these signs."""
    presence, gaze, metres, _ = row
    return (
        presence if "presence" in signs else None,
        gaze if "gaze" in signs else None,
        metres if "distance" in signs else None,
        None,
    )


@pytest.mark.parametrize(
    ("before", "after", "engaged", "samples"),
    [
        (NOBODY, ENGAGED, True, 2),
        (ENGAGED, NOBODY, False, 2),
        (ENGAGED, (0.0, 0.0, math.inf, "Unknown"), False, 2),
        (ENGAGED, (0.0, 0.0, None, None), False, 2),
        (ENGAGED, BACK, False, 2),
        (ENGAGED, (1.0, 1.0, math.inf, None), False, 3),  # out of reach, or an echo was lost
        (ENGAGED, TURNED, False, 5),
        (TURNED, ENGAGED, True, 4),
        (ENGAGED, (0.0, 0.0, 0.9, "Unknown"), False, 5),  # something near stays there
    ],
)
def test_so_many_samples_tell_what_has_happened(
    before: Row, after: Row, engaged: bool, samples: int
) -> None:
    """At 3 Hz two samples are noticed within 0.67 s, five within 1.67 s."""
    assert Robot().see(before, 30).samples_until(engaged, after) == samples


def test_the_first_two_samples_of_all_engage() -> None:
    assert Robot().samples_until(True, ENGAGED) == 2


@pytest.mark.parametrize(
    "errors",
    [
        [(0.0, 1.0, 0.9, "Ada")] * 6,  # the detector misses who looks at the robot from near
        [(0.0, 0.0, 3.0, "Unknown")],  # everything fails at once
        [(0.0, 0.0, 0.9, "Unknown")] * 3,  # the camera fails
        [(1.0, 1.0, math.inf, "Ada")] * 2,  # no echo
        [(1.0, 1.0, math.inf, "Ada"), (1.0, 1.0, 2.5, "Ada")],
        [(1.0, 1.0, 2.5, "Ada")],
        [TURNED] * 4,
        [TURNED, TURNED, ENGAGED, ENGAGED, ENGAGED] * 5,  # glances, again and again
    ],
)
def test_errors_and_glances_do_not_end_an_engagement(errors: list[Row]) -> None:
    robot = Robot().see(ENGAGED, 30)
    for row in errors:
        assert robot.see(row).engaged
    assert robot.see(ENGAGED).engaged


@pytest.mark.parametrize(
    "ghost",
    [
        [ENGAGED],
        [(1.0, 1.0, 3.0, "Unknown")] * 5,
        [(0.0, 1.0, 0.9, None)] * 2,
        [(1.0, 0.0, 0.9, None)] * 20,
        [TURNED, TURNED, TURNED, ENGAGED, ENGAGED, TURNED] * 4,  # a bystander who glances
    ],
)
def test_ghosts_and_bystanders_are_no_engagement(ghost: list[Row]) -> None:
    robot = Robot().see(NOBODY, 30)
    for row in ghost:
        assert not robot.see(row).engaged


@pytest.mark.parametrize(
    ("signs", "on", "off"),
    [
        (("presence",), 2, 2),
        (("distance",), 2, 2),
        (("gaze",), 3, 4),
        (("presence", "distance"), 2, 2),
        (("presence", "gaze"), 2, 2),
    ],
)
def test_a_lab_may_have_fewer_sensors(signs: tuple[str, ...], on: int, off: int) -> None:
    """One sample of whatever there is never changes a verdict, and few do."""
    robot = Robot().see(only(signs, NOBODY), 30)
    assert robot.samples_until_signs(signs, 1, only(signs, ENGAGED)) == on
    robot.see(only(signs, ENGAGED), 30)
    assert robot.samples_until_signs(signs, 0, only(signs, NOBODY)) == off


@pytest.mark.parametrize("rate", [2, 3, 5, 10, 30])
def test_time_counts_and_not_the_number_of_samples(rate: int) -> None:
    period = 1_000_000 // rate
    robot = Robot(period).see(ENGAGED, 10 * rate)
    seconds = robot.samples_until(False, TURNED) / rate
    assert 1.0 < seconds < 2.1
    robot = Robot(period).see(ENGAGED, 10 * rate)
    assert robot.samples_until(False, NOBODY) / rate <= max(0.67, 2 / rate)
    robot = Robot(period).see(ENGAGED, 10 * rate)
    assert robot.samples_until(False, (1.0, 1.0, math.inf, None)) / rate <= 1.5


def test_long_glances_are_a_setting() -> None:
    usual, patient = (Robot(glance=glance).see(ENGAGED, 60) for glance in (0.56, 1.5))
    assert patient.samples_until(False, TURNED) >= 2 * usual.samples_until(False, TURNED)
    patient.see(ENGAGED, 60).joint.glances_last(0.56)
    assert patient.samples_until(False, TURNED) == 5


def test_the_limit_itself_says_nothing() -> None:
    """Readings that sway about the social distance do not make the verdict flicker."""
    robot = Robot().see(ENGAGED, 30)
    for metres in [1.28, 1.32] * 20:
        assert robot.see((1.0, 1.0, metres, "Ada")).engaged
    robot = Robot().see(BACK, 30)
    verdicts = [robot.see((1.0, 1.0, metres, "Ada")).engaged for metres in [1.32, 1.28] * 20]
    assert sum(one != other for one, other in itertools.pairwise(verdicts)) <= 1


def test_another_social_distance_counts_from_then_on() -> None:
    robot = Robot().see(ENGAGED, 30)
    robot.joint.near_within(0.5)
    assert robot.samples_until(False, ENGAGED) == 2
    assert robot.joint.view("presence").verdict == 1


def test_a_sign_that_says_nothing_is_no_evidence() -> None:
    robot = Robot().see(ENGAGED, 9)
    before = [robot.joint.probability(sign) for sign in SIGNS]
    for value in (math.nan, "1"):
        robot.joint.add("gaze", value, robot.t)
    assert [robot.joint.probability(sign) for sign in SIGNS] == before


@pytest.mark.parametrize("sign", SIGNS)
def test_a_sign_that_was_forgotten_is_silent_and_the_others_are_not(sign: str) -> None:
    robot = Robot().see(ENGAGED, 9)
    robot.joint.forget(sign)
    view = robot.joint.view(sign)
    assert (view.verdict, view.count, view.name) == (0, 0, "Unknown")
    others = [robot.joint.view(other).verdict for other in SIGNS if other != sign]
    assert others == [1, 1, 1]


def test_without_any_sign_it_begins_again() -> None:
    robot = Robot().see(ENGAGED, 9)
    for sign in SIGNS:
        robot.joint.forget(sign)
    assert robot.samples_until(True, ENGAGED) == 2


def test_hold_has_no_verdict_before_the_first_sample() -> None:
    assert [JointFilter(NEAR, start_up="hold").view(sign).verdict for sign in SIGNS] == [None] * 4
    assert [JointFilter(NEAR).view(sign).verdict for sign in SIGNS] == [0] * 4
    robot = Robot(start_up="hold").see(NOBODY)
    assert robot.joint.view("gaze").verdict == 0


def test_views_count_per_cent() -> None:
    robot = Robot().see(ENGAGED, 9)
    view = robot.joint.view("gaze")
    assert (view.kind, view.places, view.needed) == ("joint", 100, 50)
    assert 90 <= view.count <= 100
    view.configure(8, 0.7)
    assert view.needed == 70
    view.configure(8, 1.0)
    assert view.verdict == 0
    view.forget()
    view.configure(8, 0.0)
    assert view.verdict == 0
    assert robot.see((None, 0.0, None, None)).joint.view("gaze").verdict == 1


def test_a_pause_makes_it_unsure_and_never_wrong() -> None:
    robot = Robot().see(ENGAGED, 30)
    for t in (robot.t + 10**9, robot.t + 10**15, robot.t - 10**12, -(10**18)):
        robot.joint.add("presence", 1.0, t)
        assert all(0.0 <= robot.joint.probability(sign) <= 1.0 for sign in SIGNS)
    robot.joint.add("presence", 1.0, robot.t + 2 * 10**15)
    assert robot.joint.probability("gaze") < 0.9


VALUES = {
    "presence": st.sampled_from([0.0, 1.0]),
    "gaze": st.sampled_from([0.0, 1.0]),
    "distance": st.floats(min_value=1e-300) | st.just(math.inf) | st.just(math.nan),
    "identity": st.sampled_from(["Unknown", *"ABCDEFGHIJKL"]),
}
SAMPLES = st.sampled_from(SIGNS).flatmap(lambda sign: st.tuples(st.just(sign), VALUES[sign]))
STEPS = st.integers(-(10**6), 10**6) | st.integers(-(10**18), 10**18)


@given(st.lists(st.tuples(SAMPLES, STEPS, st.integers(0, 20)), max_size=60))
def test_whatever_comes_probabilities_stay_probabilities(
    story: list[tuple[tuple[str, float | str], int, int]],
) -> None:
    """E9: no exception and no NaN."""
    joint = JointFilter(NEAR)
    t = 0
    for (sign, value), step, luck in story:
        t += step
        joint.add(sign, value, t)
        if not luck:
            joint.forget(sign)
        for each in SIGNS:
            view = joint.view(each)
            assert 0.0 <= joint.probability(each) <= 1.0
            assert view.verdict in (0, 1)
            assert 0 <= view.count <= 100


@given(st.lists(st.integers(0, 10**10), max_size=12), st.floats(0.1, 10.0))
def test_time_loses_no_probability(pauses: Sequence[int], glance: float) -> None:
    shares = [1.0 / (WORLDS * CONDITIONS)] * (WORLDS * CONDITIONS)
    dwell = Dwell(glance)
    for pause in pauses:
        shares = after_steps(shares, dwell, pause)
        assert math.isclose(sum(shares), 1.0, abs_tol=1e-9)
        assert min(shares) >= 0.0


def test_the_same_samples_give_the_same_probabilities() -> None:
    story = [NOBODY, ENGAGED, TURNED, BACK, ENGAGED, NOBODY] * 5
    robots = [Robot(), Robot()]
    for row in story:
        assert len({str(robot.see(row).joint.probability("gaze")) for robot in robots}) == 1


def test_a_sample_costs_little() -> None:
    """Far more than it takes, so that a busy machine passes; a plain queue takes one tenth."""
    robot = Robot()
    began = time.process_time()
    robot.see(ENGAGED, 1000)
    assert (time.process_time() - began) / 4000 < 500e-6
