"""Moments and how far they may be apart, as a system of difference constraints.

Constraints are added one by one; one that cannot hold with those before it is refused, with the
ones it conflicts with. Source of the method: incremental potentials for difference logic (Cotton
and Maler 2006): each moment moves at most once for each constraint that is added.
"""

from __future__ import annotations

import heapq
from collections.abc import Hashable
from dataclasses import dataclass

#: Times nearer than this are the same, in seconds.
EPSILON = 1e-6
#: Where a moment is before anything is said of it, in seconds: so late that what is said later
#: moves it alone, as moments only ever move earlier.
_AT_FIRST = 1e7
#: Steps of moving one moment.
_MOVE = 10


class TimeNetworkError(Exception):
    """The constraints take more steps than are allowed."""


@dataclass(frozen=True, slots=True)
class _Limit:
    """`later` is at most `seconds` behind `earlier`."""

    earlier: int
    later: int
    seconds: float
    label: str


class TimeNetwork:
    """Moments, the first of which is zero; all others are not before it.

    Args:
        most_steps: How many steps all calls together may take; with more `TimeNetworkError` is
            raised. A constraint that is looked at is one, a moment that is moved ten.
    """

    def __init__(self, most_steps: int = 1_000_000) -> None:
        self._numbers: dict[Hashable, int] = {}
        #: Limits by their earlier and by their later moment.
        self._from: list[list[_Limit]] = []
        self._to: list[list[_Limit]] = []
        #: A solution of all constraints so far, in seconds, not yet shifted to zero.
        self._times: list[float] = []
        #: How many steps are left.
        self.steps = most_steps
        self._number("zero", 0.0)

    def add_moment(self, moment: Hashable) -> None:
        """A moment from zero on."""
        number = self._number(moment)
        self._try([_Limit(number, 0, 0.0, "")])

    def same(self, first: Hashable, second: Hashable, apart: float, label: str) -> list[str] | None:
        """`second` is exactly `apart` seconds behind `first`. What it conflicts with; None: it
        holds from now on.
        """
        a, b = self._number(first), self._number(second)
        return self._try([_Limit(a, b, apart, label), _Limit(b, a, -apart, label)])

    def at_least(
        self, first: Hashable, second: Hashable, apart: float, label: str
    ) -> list[str] | None:
        """`second` is at least `apart` seconds behind `first`. As `same`."""
        a, b = self._number(first), self._number(second)
        return self._try([_Limit(b, a, -apart, label)])

    def room(self, first: Hashable, second: Hashable) -> tuple[float, float]:
        """Least and most seconds that `second` can be behind `first`."""
        a, b = self._number(first), self._number(second)
        most = self._shortest(a, b, self._from).get(b, float("inf"))
        return -self._shortest(b, a, self._from).get(a, float("inf")), most

    def earliest(self) -> dict[Hashable, float]:
        """The earliest time of each moment, in seconds from zero."""
        ways = self._shortest(0, None, self._to)
        return {moment: -ways.get(number, 0.0) for moment, number in self._numbers.items()}

    # -- inside --------------------------------------------------------------------------------

    def _number(self, moment: Hashable, time: float = _AT_FIRST) -> int:
        number = self._numbers.get(moment)
        if number is None:
            number = self._numbers[moment] = len(self._times)
            self._times.append(time)
            self._from.append([])
            self._to.append([])
        return number

    def _step(self, number: int = 1) -> None:
        self.steps -= number
        if self.steps < 0:
            raise TimeNetworkError

    def _try(self, limits: list[_Limit]) -> list[str] | None:
        before: dict[int, float] = {}
        for place, limit in enumerate(limits):
            self._step()
            self._from[limit.earlier].append(limit)
            self._to[limit.later].append(limit)
            conflict = self._repair(limit, before)
            if conflict is not None:
                for each in limits[: place + 1]:
                    self._from[each.earlier].remove(each)
                    self._to[each.later].remove(each)
                for moment, time in before.items():
                    self._times[moment] = time
                return conflict
        return None

    def _repair(self, added: _Limit, before: dict[int, float]) -> list[str] | None:
        """Move what is too late earlier, what moves farthest first; None if that went well, else
        the labels of the circle. `before` gets the times of what moved.
        """
        times = self._times
        because: dict[int, _Limit] = {}
        too_late = times[added.earlier] + added.seconds - times[added.later]
        if added.later == added.earlier and too_late < -EPSILON:
            return [added.label] if added.label else []
        waiting = [(too_late, added.later, 0, added)]
        pushed = 0
        while waiting:
            move, moment, _, limit = heapq.heappop(waiting)
            if move >= -EPSILON or moment in because:
                continue
            self._step(_MOVE + len(self._from[moment]))
            because[moment] = limit
            before.setdefault(moment, times[moment])
            times[moment] += move
            for each in self._from[moment]:
                if each.later not in because:
                    pushed += 1
                    move = times[moment] + each.seconds - times[each.later]
                    if move < -EPSILON and each.later == added.earlier:
                        return self._circle(each, added, because)
                    if move < -EPSILON:
                        heapq.heappush(waiting, (move, each.later, pushed, each))
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

    def _shortest(
        self, source: int, target: int | None, limits: list[list[_Limit]]
    ) -> dict[int, float]:
        """The shortest ways from `source` through the limits, at least as far as to `target`.

        `limits` are those that lead away from a moment; by their later moment: the ways go to
        `source`. The solution makes all of them longer than nothing, as Dijkstra's method wants it.
        """
        times, forward = self._times, limits is self._from
        ways: dict[int, float] = {}
        waiting = [(0.0, source, 0.0)]
        while waiting:
            length, moment, way = heapq.heappop(waiting)
            if moment in ways:
                continue
            ways[moment] = way
            if moment == target:
                break
            self._step(_MOVE + len(limits[moment]))
            for each in limits[moment]:
                other = each.later if forward else each.earlier
                if other not in ways:
                    slack = max(times[each.earlier] + each.seconds - times[each.later], 0.0)
                    if other == target and not slack:  # no way there is shorter
                        ways[other] = way + each.seconds
                        return ways
                    heapq.heappush(waiting, (length + slack, other, way + each.seconds))
        return ways
