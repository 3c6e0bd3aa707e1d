"""Says something so often at most that comes more often."""

from __future__ import annotations


class RateLimit:
    """Whether something may be said again. Times are seconds of any clock.

    Args:
        every: From one time to the next, on average.
        slack: It may be said so much too early.
    """

    def __init__(self, every: float, slack: float = 0.0) -> None:
        self._every = every
        self._slack = slack
        self._next = float("-inf")

    def __call__(self, now: float) -> bool:
        """Whether it is time; then the next time is `every` seconds later."""
        if now + self._slack < self._next:
            return False
        after = self._next + self._every
        self._next = after if after > now else now + self._every
        return True
