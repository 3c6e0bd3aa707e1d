"""The filter of one sign, which may be changed for another one while samples come."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from woz_tui.sensing.filters import Filter
from woz_tui.sensing.joint import Sign as JointSign


class Queue(Filter, Protocol):
    """A filter that remembers its last samples: metres, flags or names."""

    start_up: str

    @property
    def threshold(self) -> float:
        """The share that decides."""
        ...

    @property
    def values(self) -> list[Any]:
        """What it holds, oldest first."""
        ...

    def take(self, value: Any, t: int) -> None:
        """One more valid sample."""
        ...

    def configure(self, samples: int, threshold: float) -> None:
        """Other numbers from now on; the newest values that fit stay."""
        ...

    def resume(self, values: list[Any]) -> None:
        """Hold what another one held, oldest first."""
        ...


Q = TypeVar("Q", bound=Queue)
#: Kind of the filter, its places, its threshold.
Numbers = tuple[str, int, float]


class Steady(Generic[Q]):
    """A queue, and the sign's view of the joint filter; one of them decides.

    The queue is filled in any case, so that it is there when it is asked again. `made` makes a
    queue of a kind (whichever is usual, if it has no such kind).
    """

    def __init__(
        self, made: Callable[[str, int, float], Q], joint: JointSign, numbers: Numbers
    ) -> None:
        kind, count, threshold = numbers
        self._made = made
        self._joint = joint
        self._joint.configure(count, threshold)
        self._jointly = kind == "joint"
        self.queue = made(kind, count, threshold)

    @property
    def filter(self) -> Q | JointSign:
        """Whichever decides."""
        return self._joint if self._jointly else self.queue

    def take(self, value: float | str, t: int) -> None:
        """One more valid sample, at `t` microseconds."""
        self.queue.take(value, t)
        if self._jointly:
            self._joint.take(value, t)
        else:
            self._joint.overhear(value, t)

    def start_as(self, start_up: str) -> None:
        """Another policy for what is not full, or has not begun."""
        self.queue.start_up = self._joint.start_up = start_up

    def forget(self) -> None:
        """As before the first sample."""
        self.queue.forget()
        self._joint.forget()

    def configure(self, kind: str | None, count: int | None, threshold: float | None) -> None:
        """Another filter, or other numbers for it; it keeps what it holds as far as it fits. None
        leaves a number as it is.
        """
        before = self.queue
        count = before.places if count is None else count
        threshold = before.threshold if threshold is None else threshold
        before.configure(count, threshold)
        self._joint.configure(count, threshold)
        if kind is None:
            return
        if kind not in ("joint", before.kind):
            self.queue = self._made(kind, count, threshold)
            self.queue.resume(before.values)
        if kind == "joint" and not self._jointly:
            self._joint.catch_up()
        if kind != "joint" and self._jointly:
            self._joint.leave()
        self._jointly = kind == "joint"
