"""Orders the lines or messages of a session's files by number, each number once.

Works on lists of lines or messages at a time, because in a log of a million lines what is done
once for each line is what takes the time.
"""

from __future__ import annotations

from bisect import bisect_right, insort_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, islice, pairwise
from operator import attrgetter, ge, gt
from typing import Any, Generic, Protocol, TypeVar

from woz_tui.log.damage import Damage

#: Lines that stand out of order within a file are put right over this distance.
WINDOW = 256


class Sequenced(Protocol):
    """Something with a number and a time in a session."""

    @property
    def seq(self) -> int:
        """Number in the session."""
        ...

    @property
    def t(self) -> int:
        """Microseconds since the session began."""
        ...


N = TypeVar("N", bound=Sequenced)

seq_of: Callable[[Any], int] = attrgetter("seq")
t_of: Callable[[Any], int] = attrgetter("t")


def is_rising(numbers: Sequence[int]) -> bool:
    """Whether each number is greater than the one before it."""
    return not any(map(ge, numbers, islice(numbers, 1, None)))


def count_falls(numbers: Sequence[int]) -> int:
    """How often a number is smaller than the one before it."""
    return sum(map(gt, numbers, islice(numbers, 1, None)))


def in_order(batches: Iterable[list[N]], damage: Damage) -> Iterator[list[N]]:
    """Put right what stands a little out of order in one file; leave out what cannot be.

    The lists that come out are in order, in themselves and one after the other; a number may occur
    more than once.
    """
    window: list[N] = []
    given = -1
    for batch in batches:
        numbers = list(map(seq_of, batch))
        floor = window[-1].seq if window else given
        if numbers and numbers[0] >= floor and not count_falls(numbers):
            window += batch
        else:
            ready: list[N] = []
            for item in batch:
                if item.seq < given:
                    damage.misplaced += 1
                    continue
                insort_right(window, item, key=seq_of)
                if len(window) > WINDOW:
                    given = window[0].seq
                    ready.append(window.pop(0))
            if ready:
                yield ready
        if len(window) > WINDOW:
            ready, window = window[:-WINDOW], window[-WINDOW:]
            given = ready[-1].seq
            yield ready
    if window:
        yield window


class _Stream(Generic[N]):
    """One stream of lists, and how much of its present list has been given."""

    def __init__(self, batches: Iterator[list[N]]) -> None:
        self._batches = batches
        self._batch: list[N] = []
        self._given = 0
        self._fill()

    def _fill(self) -> None:
        if self._given == len(self._batch):
            self._batch, self._given = next(filter(None, self._batches), []), 0

    @property
    def waiting(self) -> bool:
        """Whether there is anything left."""
        return bool(self._batch)

    @property
    def last(self) -> int:
        """Highest number of the present list."""
        return self._batch[-1].seq

    def up_to(self, limit: int) -> list[N]:
        """Take what has a number up to `limit` out of the present list."""
        end = bisect_right(self._batch, limit, self._given, key=seq_of)
        part = self._batch[self._given : end]
        self._given = end
        self._fill()
        return part


def merged(streams: Iterable[Iterator[list[N]]]) -> Iterator[list[N]]:
    """Several streams, each in order, as one; of equals that of the first stream comes first."""
    heads = [head for stream in streams if (head := _Stream(stream)).waiting]
    while heads:
        limit = min(head.last for head in heads)
        parts = [part for head in heads if (part := head.up_to(limit))]
        yield parts[0] if len(parts) == 1 else sorted(chain.from_iterable(parts), key=seq_of)
        heads = [head for head in heads if head.waiting]


class SequenceChecker(Generic[N]):
    """Drops repeated numbers, and counts gaps and times that go back.

    `same` says whether two of the same number say the same; `gaps`: whether numbers that nothing
    has are to be counted.
    """

    def __init__(self, damage: Damage, same: Callable[[N, N], bool], *, gaps: bool) -> None:
        self._damage = damage
        self._same = same
        self._gaps = gaps
        self._last: N | None = None

    def new_lines(self, batch: list[N]) -> list[N]:
        numbers = list(map(seq_of, batch))
        before = self._last.seq if self._last is not None else -1
        if not numbers or numbers[0] <= before or not is_rising(numbers):
            batch = self._without_repeats(batch)
            numbers = list(map(seq_of, batch))
        if not batch:
            return batch
        if self._gaps and numbers[-1] - before != len(numbers):
            for one, following in pairwise([before, *numbers]):
                if following > one + 1:
                    self._damage.gap(one + 1, following - 1)
        times = list(map(t_of, batch))
        if self._last is not None:
            times.insert(0, self._last.t)
        self._damage.backwards += count_falls(times)
        self._last = batch[-1]
        return batch

    def pass_over(self, item: N) -> None:
        """Everything up to `item` was new and in order."""
        self._last = item

    def _without_repeats(self, batch: list[N]) -> list[N]:
        new = []
        last = self._last
        for item in batch:
            if last is None or item.seq != last.seq:
                new.append(item)
                last = item
            elif self._same(item, last):
                self._damage.repeated += 1
            else:
                self._damage.conflicting += 1
        return new

    def end(self) -> None:
        self._damage.lineless = self._last is None
