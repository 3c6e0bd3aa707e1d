"""Pauses before something is tried again: doubled up to the longest, until it goes well."""

from __future__ import annotations


class RetryPauses:
    """How long to wait before the next attempt, in seconds from `first_s` to `longest_s`."""

    def __init__(self, first_s: float = 0.1, longest_s: float = 1.0) -> None:
        self._first_s = self._next_s = first_s
        self._longest_s = longest_s

    def after(self, went_well: bool) -> float:
        """Seconds to wait after an attempt."""
        pause = self._first_s if went_well else self._next_s
        self._next_s = min(2 * pause, self._longest_s)
        return pause
