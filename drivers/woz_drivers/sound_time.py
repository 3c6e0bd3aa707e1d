"""When was a block of sound heard? Blocks have no time of their own, only an order."""

from __future__ import annotations

from woz_drivers.speaking import BLOCK_S

BLOCK_US = round(BLOCK_S * 1_000_000)

#: The promptest block of this many, and of as many before them, tells what the clock said when the
#: sound began: 5 s. A converter's clock drifts by a millisecond in that time at most.
_WINDOW = 250


class SoundTime:
    """Ties the blocks of a stream to a clock.

    A block can be late, because pipes and busy machines hold it back, but never early: of the
    blocks of the last seconds, that which took the least time to arrive is right for all of them.
    """

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """A new stream begins, or the old one after a gap."""
        self._count = 0
        self._before: int | None = None
        self._now: int | None = None

    def arrived(self, block: int, clock_us: int) -> None:
        """Block number `block` has come; `clock_us` is a reading of the clock."""
        zero = clock_us - (block + 1) * BLOCK_US
        if self._count == _WINDOW:
            self._before, self._now, self._count = self._now, None, 0
        self._count += 1
        self._now = zero if self._now is None else min(self._now, zero)

    def begins(self, block: int) -> int:
        """When a block's first sample was heard, on the clock; blocks to come included."""
        known = [zero for zero in (self._before, self._now) if zero is not None]
        if not known:
            raise ValueError("no block has arrived yet")
        return min(known) + block * BLOCK_US
