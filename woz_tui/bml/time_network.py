"""Moments and how far they may be apart, as a system of difference constraints.

Constraints are added one by one; one that cannot hold with those before it is refused, with the
ones it conflicts with. Source of the method: incremental potentials for difference logic (Cotton
and Maler 2006).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterator
from dataclasses import dataclass

#: Times nearer than this are the same, in seconds.
EPSILON = 1e-6


@dataclass(frozen=True, slots=True)
class _Limit:
    """`later` is at most `seconds` behind `earlier`."""

    earlier: int
    later: int
    seconds: float
    label: str


class TimeNetwork:
    """Moments, the first of which is zero; all others are not before it."""

    def __init__(self) -> None:
        self._numbers: dict[Hashable, int] = {}
        self._from: list[list[_Limit]] = []
        #: A solution of all constraints so far, in seconds, not yet shifted to zero.
        self._times: list[float] = []
        self._number("zero")

    def add_moment(self, moment: Hashable) -> None:
        """A moment from zero on."""
        number = self._number(moment)
        self._try([_Limit(number, 0, 0.0, "")])

    def same(self, first: Hashable, second: Hashable, apart: float, label: str) -> list[str]:
        """`second` is exactly `apart` seconds behind `first`. What it conflicts with; empty: it
        holds from now on.
        """
        a, b = self._number(first), self._number(second)
        return self._try([_Limit(a, b, apart, label), _Limit(b, a, -apart, label)])

    def at_least(self, first: Hashable, second: Hashable, apart: float, label: str) -> list[str]:
        """`second` is at least `apart` seconds behind `first`. As `same`."""
        a, b = self._number(first), self._number(second)
        return self._try([_Limit(b, a, -apart, label)])

    def room(self, first: Hashable, second: Hashable) -> tuple[float, float]:
        """Least and most seconds that `second` can be behind `first`."""
        a, b = self._number(first), self._number(second)
        return -self._most(b, a), self._most(a, b)

    def earliest(self) -> dict[Hashable, float]:
        """The earliest time of each moment, in seconds from zero."""
        times = [0.0] * len(self._times)
        into: list[list[_Limit]] = [[] for _ in times]
        for limit in self._limits():
            into[limit.later].append(limit)
        waiting = deque(range(len(times)))
        queued = [True] * len(times)
        while waiting:
            later = waiting.popleft()
            queued[later] = False
            for limit in into[later]:
                least = times[later] - limit.seconds
                if limit.earlier and least > times[limit.earlier] + EPSILON / 10:
                    times[limit.earlier] = least
                    if not queued[limit.earlier]:
                        queued[limit.earlier] = True
                        waiting.append(limit.earlier)
        return {moment: times[number] for moment, number in self._numbers.items()}

    # -- inside --------------------------------------------------------------------------------

    def _number(self, moment: Hashable) -> int:
        number = self._numbers.get(moment)
        if number is None:
            number = self._numbers[moment] = len(self._times)
            self._times.append(0.0)
            self._from.append([])
        return number

    def _limits(self) -> Iterator[_Limit]:
        for limits in self._from:
            yield from limits

    def _try(self, limits: list[_Limit]) -> list[str]:
        before = self._times.copy()
        for place, limit in enumerate(limits):
            self._from[limit.earlier].append(limit)
            conflict = self._repair(limit)
            if conflict is not None:
                for each in limits[: place + 1]:
                    self._from[each.earlier].remove(each)
                self._times = before
                return conflict
        return []

    def _repair(self, added: _Limit) -> list[str] | None:
        """Move what is too late earlier; None if that went well, else the labels of the circle."""
        times = self._times
        because: dict[int, _Limit] = {}
        waiting: deque[_Limit] = deque([added])
        while waiting:
            limit = waiting.popleft()
            latest = times[limit.earlier] + limit.seconds
            if times[limit.later] <= latest + EPSILON:
                continue
            if limit.later == added.earlier:
                return self._circle(limit, added, because)
            times[limit.later] = latest
            because[limit.later] = limit
            waiting.extend(self._from[limit.later])
        return None

    @staticmethod
    def _circle(last: _Limit, added: _Limit, because: dict[int, _Limit]) -> list[str]:
        labels = [added.label]
        limit: _Limit | None = last
        for _ in range(len(because) + 1):
            if limit is None or limit is added:
                break
            labels.append(limit.label)
            limit = because.get(limit.earlier)
        return list(dict.fromkeys(label for label in labels if label))

    def _most(self, first: int, second: int) -> float:
        """Most seconds of `second` behind `first`: the shortest way through the limits."""
        ways = [float("inf")] * len(self._times)
        ways[first] = 0.0
        waiting, queued = deque([first]), {first}
        while waiting:
            at = waiting.popleft()
            queued.discard(at)
            for limit in self._from[at]:
                way = ways[at] + limit.seconds
                if way < ways[limit.later] - EPSILON / 10:
                    ways[limit.later] = way
                    if limit.later not in queued:
                        queued.add(limit.later)
                        waiting.append(limit.later)
        return ways[second]
