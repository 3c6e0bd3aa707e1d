"""What is made of what was seen of a loop that stood still."""

from __future__ import annotations

import pytest

from woz_tui.host.loop_watchdog import CodePlace, Sight, cause, place_in, whose


@pytest.mark.parametrize(
    ("gap", "waited", "continued", "idle", "why"),
    [
        (4.0, 0.0, False, False, "blocked"),
        (4.0, 3.0, False, False, "blocked"),  # a second of its own would have been too long, too
        (0.6, 0.5, False, False, "starved"),
        (0.6, 0.5, False, True, "starved"),
        (4.0, 0.0, True, False, "stopped"),
        (4.0, 0.0, False, True, "stopped"),  # nobody says so, but it had nothing to do
    ],
)
def test_why_a_loop_stood_still(
    gap: float, waited: float, continued: bool, idle: bool, why: str
) -> None:
    assert cause(gap, waited, continued, idle=idle) == why


def test_a_loop_that_waits_for_something_to_do_is_nobody_s_fault() -> None:
    idle = Sight([CodePlace("/usr/lib/python3/selectors.py", 468, "select")])
    assert whose(idle, None, {}) == whose(None, None, {}) == ("", "")
    assert place_in(idle) == place_in(None) == ""
