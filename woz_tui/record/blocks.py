"""Samples of a session by time, left on the disk in blocks of some thousand lines.

In memory is, of each block, where it lies, which times it spans and the last reading of each
sensor; so the state of any moment is in one block and in what was before it.
"""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

import msgspec

from woz_tui.core.messages import EngagementShown, Reading
from woz_tui.record.damage import Damage
from woz_tui.record.lines import Chunk
from woz_tui.record.stream import Item, items_in

#: Blocks that are kept decoded, for those who go through a session step by step.
_KEPT = 6


class Slim(
    msgspec.Struct, frozen=True, gc=False, omit_defaults=True, tag_field="kind", tag="sample"
):
    """A `Reading` that costs half as much to decode: the same fields, no list in it."""

    seq: int
    t: int
    sensor: str
    value: float | None
    ts: str = ""
    text: str = ""
    driver: str = ""
    unit: str = ""
    raw: float | None = None
    bad: list[str] | msgspec.UnsetType = msgspec.UNSET

    def reading(self) -> Reading:
        """The same as a `Reading`."""
        fields = {name: getattr(self, name) for name in self.__struct_fields__}
        return Reading(**fields | {"bad": self.bad or []})


@dataclass(frozen=True)
class State:
    """What the samples said last, up to a moment.

    Attributes:
        readings: The last reading of each sensor that has spoken, by its name.
        shown: How the engagement model stood.
    """

    readings: dict[str, Reading] = field(default_factory=dict)
    shown: EngagementShown | None = None


@dataclass
class Lasts:
    """The last reading of each sensor, and the last picture of the engagement model, by `seq`."""

    sensors: dict[str, Slim | Reading] = field(default_factory=dict)
    shown: EngagementShown | None = None

    def copy(self) -> Lasts:
        """The same, to be changed."""
        return Lasts(dict(self.sensors), self.shown)

    def follow(self, later: Lasts) -> None:
        """All of `later` came after this."""
        self.sensors |= later.sensors
        self.shown = later.shown or self.shown

    def take(self, item: Item | Slim) -> None:
        """`item` may have come before or after."""
        if isinstance(item, Slim | Reading):
            known = self.sensors.get(item.sensor)
            if known is None or known.seq < item.seq:
                self.sensors[item.sensor] = item
        elif isinstance(item, EngagementShown) and (
            self.shown is None or self.shown.seq < item.seq
        ):
            self.shown = item

    def state(self) -> State:
        """As messages."""
        readings = {
            name: last.reading() if isinstance(last, Slim) else last
            for name, last in self.sensors.items()
        }
        return State(readings, self.shown)


@dataclass(frozen=True, slots=True)
class Block:
    """Samples that stand together: where, and the smallest and greatest `t` among them."""

    source: BinaryIO
    path: Path
    offset: int
    size: int
    low: int
    high: int
    lasts: Lasts


class Samples:
    """All blocks of a session, in order of `seq`.

    Time rises from block to block, unless something has damaged it: blocks that do not fit in are
    *stray* and looked at whenever their times are asked for.
    """

    def __init__(self, blocks: Sequence[Block]) -> None:
        fits = steady([(block.low, block.high) for block in blocks])
        self._blocks = [block for block, fit in zip(blocks, fits, strict=True) if fit]
        self._strays = [block for block, fit in zip(blocks, fits, strict=True) if not fit]
        self._lows = [block.low for block in self._blocks]
        self._highs = [block.high for block in self._blocks]
        self._order = {id(block): place for place, block in enumerate(blocks)}
        self._before = [Lasts()]
        for block in self._blocks:
            self._before.append(self._before[-1].copy())
            self._before[-1].follow(block.lasts)
        self._kept: dict[int, list[Item]] = {}

    @property
    def last_us(self) -> int:
        """The last moment of which there are samples; -1 if there are none."""
        return self._highs[-1] if self._highs else -1

    def at(self, t_us: int) -> State:
        """What was said last, up to and with `t_us`."""
        whole = bisect_right(self._highs, t_us)
        found = self._before[whole].copy()
        begun = bisect_right(self._lows, t_us)
        for block in [*self._blocks[whole:begun], *self._strays]:
            if block.low <= t_us:
                for item in self._items(block):
                    if item.t <= t_us:
                        found.take(item)
        return found.state()

    def between(self, after_us: int, until_us: int) -> Iterator[list[Item]]:
        """Samples with `after_us` < t <= `until_us`, in order of `seq`, block by block."""
        first = bisect_right(self._highs, after_us)
        end = bisect_right(self._lows, until_us)
        blocks = self._blocks[first:end]
        strays = [each for each in self._strays if each.low <= until_us and each.high > after_us]
        if strays:
            blocks = sorted([*blocks, *strays], key=lambda block: self._order[id(block)])
        for block in blocks:
            found = [item for item in self._items(block) if after_us < item.t <= until_us]
            if found:
                yield found

    def _items(self, block: Block) -> list[Item]:
        kept = self._kept.pop(id(block), None)
        if kept is None:
            while len(self._kept) >= _KEPT:
                del self._kept[next(iter(self._kept))]
            kept = items_in(Chunk(block.path, block.offset, _read(block)), Damage())
        self._kept[id(block)] = kept
        return kept


def _read(block: Block) -> bytes:
    """The block's bytes; none if the file has been cut short or is gone."""
    try:
        return os.pread(block.source.fileno(), block.size, block.offset)
    except OSError:
        return b""


def steady(spans: Sequence[tuple[int, int]]) -> list[bool]:
    """Which of these belong to the longest series that never goes back: each begins no sooner than
    the one before has ended. A single wild value so costs its own place only.
    """
    if all(one[1] <= other[0] for one, other in pairwise(spans)):
        return [True] * len(spans)
    ends: list[int] = []  # the earliest end of a series of each length
    tips: list[int] = []  # where that series ends
    before: list[int] = []
    for place, (low, high) in enumerate(spans):
        length = bisect_right(ends, low)
        before.append(tips[length - 1] if length else -1)
        if length == len(ends):
            ends.append(high)
            tips.append(place)
        elif high < ends[length]:
            ends[length], tips[length] = high, place
    chosen = [False] * len(spans)
    place = tips[-1]
    while place >= 0:
        chosen[place] = True
        place = before[place]
    return chosen
