"""How many bytes pictures may cost, so that nothing else on the line has to wait for them.

A picture counts as shown when the terminal has answered a question that was written behind it:
what the kernel has taken may still be in the buffers of an SSH connection, megabytes of it. From
the time this took the speed of the line is known, and so how large the next picture may be, and
when it may come.
"""

from __future__ import annotations

#: Bytes a second that pictures may cost, and pictures a second: the defaults.
BUDGET, RATE = 200_000, 5.0
#: For how long one picture may fill the line, in seconds: so long a stop's answer may wait for it.
FILLS_S = 0.25
#: Of the time pictures may have this share; the rest of it is everybody else's.
SHARE = 0.5
#: The line's speed before it is known, in bytes a second, and what is at least reckoned with.
AT_FIRST, SLOWEST = 12_000, 4_000
#: Smaller pictures tell nothing about the line, in bytes; faster ones only that it is not slow.
TELLING, INSTANT_S = 2_000, 0.030
#: No picture costs more, in bytes.
MOST = 200_000


class PictureBudget:
    """Allowances for one picture after the other. All times in microseconds of one clock."""

    def __init__(self, budget: float = BUDGET, rate: float = RATE) -> None:
        self._budget, self.rate = budget, rate
        self._speed = float(AT_FIRST)
        self._next_us = 0

    @property
    def speed(self) -> float:
        """How fast the line is, as far as it was needed: bytes a second."""
        return self._speed

    @property
    def allowance(self) -> int:
        """Bytes that the next picture may cost."""
        return round(min(MOST, self._speed * FILLS_S))

    def due(self, now_us: int) -> bool:
        """Whether the next picture may be asked for."""
        return now_us >= self._next_us

    def asked(self, now_us: int) -> None:
        """A picture is being asked for: the next one may not be before the rate allows it."""
        self.wait(now_us, 1 / self.rate)

    def shown(self, began_us: int, cost: int, took_us: int, drawing_us: int = 0) -> None:
        """A picture of `cost` bytes, drawn from `began_us` on, filled the line for `took_us`; to
        draw it took `drawing_us` of the processor.
        """
        took_s = max(0.0, took_us / 1_000_000)
        if cost >= TELLING:
            self._learn(cost, took_s)
        pause_s = max(cost / self._budget, took_s / SHARE, drawing_us / 1_000_000 / SHARE)
        self.wait(began_us, pause_s)

    def wait(self, now_us: int, seconds: float) -> None:
        """Ask for nothing for a while."""
        self._next_us = max(self._next_us, now_us + round(seconds * 1_000_000))

    def _learn(self, cost: int, took_s: float) -> None:
        measured = cost / max(took_s, INSTANT_S)
        if took_s <= INSTANT_S:
            self._speed = max(self._speed, measured)
        elif measured < self._speed:
            self._speed = max(float(SLOWEST), measured)  # at once: too slow hurts
        else:
            self._speed = (self._speed + measured) / 2
