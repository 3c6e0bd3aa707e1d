"""Break-downs on demand: which hold at a moment, and for which part of the robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

#: What each kind does to commands, sensors or the driver as a whole.
MEANING = {
    "disconnect": "the hardware is disconnected: commands are lost, sensors stop",
    "slow": "all commands take four times as long",
    "fail": "the next command fails half-way",
    "hang": "the next command does not end when it is cancelled",
    "refuse": "commands are refused",
    "deaf": "the stop is obeyed but confirmed late",
    "overheat": "a motor reports an alarm; everything else goes on",
    "nan": "a sensor reads not-a-number",
    "stuck": "a sensor repeats its last value",
    "silent": "a sensor says nothing",
    "clear": "ends all faults",
}
KINDS = tuple(kind for kind in MEANING if kind != "clear")

#: These wait for one command, however long, and are then used up.
ONCE = ("fail", "hang")

#: How much longer everything takes while the robot is `slow`.
SLOWNESS = 4.0


@dataclass(frozen=True, slots=True)
class Fault:
    """One break-down from `begin` to `end`, in seconds of the driver's pace; `seconds` is how
    long a hanging command hangs.
    """

    kind: str
    part: str
    begin: float
    end: float
    seconds: float

    def hits(self, part: str, now: float) -> bool:
        """Whether it holds for `part` at `now`; a fault without a part hits all of them."""
        return self.part in ("", part) and self.begin <= now < self.end


class ActiveFaults:
    """The break-downs that hold or are still to come."""

    def __init__(self) -> None:
        self._faults: list[Fault] = []

    def add(self, kind: str, seconds: float, part: str, begin: float) -> Fault:
        """Let `kind` hold for `seconds` from `begin` on."""
        end = math.inf if kind in ONCE else begin + seconds
        fault = Fault(kind, part, begin, end, seconds)
        self._faults.append(fault)
        return fault

    def clear(self) -> None:
        """End them all, those to come included."""
        self._faults.clear()

    def holding(self, kind: str, part: str, now: float) -> Fault | None:
        """The fault of this kind that holds for `part` at `now` and lasts longest, or None. An
        empty `part` asks for a fault of the whole robot.
        """
        found = [fault for fault in self._faults if fault.kind == kind and fault.hits(part, now)]
        return max(found, key=lambda fault: fault.end, default=None)

    def any(self, kind: str, now: float) -> Fault | None:
        """A fault of this kind that holds for any part or the whole, or None."""
        return self.holding(kind, "", now) or self.partial(kind, now)

    def partial(self, kind: str, now: float) -> Fault | None:
        """A fault of this kind that names a part, or None."""
        for fault in self._faults:
            if fault.kind == kind and fault.part and fault.hits(fault.part, now):
                return fault
        return None

    def use_up(self, kind: str, part: str, now: float) -> Fault | None:
        """Like `holding`, for a fault that hits one command: it is gone afterwards."""
        fault = self.holding(kind, part, now)
        if fault is not None:
            self._faults.remove(fault)
        return fault

    def expire(self, now: float) -> None:
        """Forget those that are over."""
        self._faults = [fault for fault in self._faults if fault.end > now]
