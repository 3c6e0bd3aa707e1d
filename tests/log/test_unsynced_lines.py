from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.log.log_segment import UnsyncedLines
from woz_tui.log.recorder import ALARM_US, CALM_US, LEVELS, LogHealth, level_of, worse

pytestmark = pytest.mark.safety

STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("push"), st.integers(1, 40)),
        st.tuples(st.just("confirm"), st.integers(0, 60)),
        st.tuples(st.sampled_from(["lose", "find"]), st.just(0)),
    ),
    max_size=60,
)


@given(STEPS, st.integers(40, 200))
def test_every_line_is_held_confirmed_or_counted(steps: list[tuple[str, int]], limit: int) -> None:
    backlog = UnsyncedLines(limit)
    confirmed = 0
    for what, size in steps:
        if what == "push":
            backlog.push(b"x" * size, 0)
        elif what == "confirm":
            confirmed = max(confirmed, min(size, backlog.last))
            backlog.confirm(min(size, backlog.last), 0)
        elif what == "lose":
            backlog.file_failed()
        else:
            backlog.file_opened()
    backlog.file_failed()
    held = len(backlog.lines())
    assert sum(map(len, backlog.lines())) <= limit
    assert held + confirmed + backlog.lost >= backlog.last
    assert held <= backlog.last - confirmed


def test_a_line_pushed_out_while_a_file_has_it_is_not_lost() -> None:
    backlog = UnsyncedLines(10)
    for _ in range(3):
        backlog.push(b"123456", 0)
    backlog.confirm(3, 0)
    backlog.file_failed()
    assert backlog.lost == 0


def test_a_line_pushed_out_while_no_file_has_it_is_lost() -> None:
    backlog = UnsyncedLines(10)
    backlog.file_failed()
    for _ in range(3):
        backlog.push(b"123456", 0)
    assert (backlog.lost, backlog.lines()) == (2, [b"123456"])


def test_the_longest_wait_is_told_once() -> None:
    backlog = UnsyncedLines(100)
    backlog.push(b"a", 0)
    backlog.confirm(1, 300)
    assert backlog.take_worst_us(400) == 300
    assert backlog.take_worst_us(500) == 0


@given(
    st.lists(
        st.tuples(st.integers(0, 2_000_000), st.integers(0, 3_000_000), st.sampled_from(LEVELS)),
        min_size=1,
        max_size=40,
    )
)
def test_the_level_is_never_better_than_the_present_calls_for(
    course: list[tuple[int, int, str]],
) -> None:
    gauge, now = LogHealth(), 0
    for passed, lag, floor in course:
        now += passed
        before = gauge.level
        gauge.measure(now, lag, floor)
        wanted = worse(level_of(lag), floor)
        assert worse(gauge.level, wanted) == gauge.level
        if worse(wanted, before) == wanted and wanted != before:
            assert gauge.due(now, news=False)
        if gauge.due(now, news=True):
            gauge.reported(now)


def test_a_level_falls_only_after_a_second_of_calm() -> None:
    gauge = LogHealth()
    gauge.measure(0, ALARM_US, "ok")
    gauge.measure(CALM_US - 1, 0, "ok")
    assert gauge.level == "alarm"
    gauge.measure(CALM_US, 0, "ok")
    assert gauge.level == "ok"


def test_reports_without_a_change_come_at_most_once_a_second() -> None:
    gauge = LogHealth()
    reports = 0
    for tenth in range(101):
        gauge.measure(tenth * 100_000, ALARM_US, "ok")
        if gauge.due(tenth * 100_000, news=True):
            gauge.reported(tenth * 100_000)
            reports += 1
    assert reports == 11


def test_a_line_that_a_new_file_has_by_then_is_not_lost() -> None:
    backlog = UnsyncedLines(limit=6)
    backlog.file_failed()
    backlog.push(b"123", 0)
    backlog.push(b"456", 0)
    backlog.file_took(backlog.last)
    backlog.push(b"789", 0)  # the first goes, which the new file has
    assert (backlog.lost, backlog.lines(after=2)) == (0, [b"789"])
    backlog.file_failed()  # that file was no good
    assert (backlog.lost, backlog.lines()) == (1, [b"456", b"789"])
    backlog.push(b"abc", 0)
    assert backlog.lost == 2
