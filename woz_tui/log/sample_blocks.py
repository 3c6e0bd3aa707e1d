"""Samples of a session by time, left on the disk in blocks of some hundred lines.

In memory is, of each block, where it lies, which times it spans and the last reading of each
sensor; so the state of any moment is in one block and in what was before it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import msgspec

from woz_tui.log.damage import Damage
from woz_tui.log.line_reader import LineChunk
from woz_tui.log.log_reader import LogItem, items_in
from woz_tui.protocol import codec
from woz_tui.protocol.messages import EngagementShown, Reading

#: Blocks that are kept decoded, for those who go through a session step by step.
_KEPT = 16
_NOWHERE = Path()
#: No sensor is called like this.
_SHOWN = "\0"

#: Checked where the line is decoded.
Natural = Annotated[int, msgspec.Meta(ge=0)]


class QuickReading(
    msgspec.Struct, frozen=True, gc=False, omit_defaults=True, tag_field="kind", tag="sample"
):
    """A `Reading` with the same fields but no list, which costs two thirds as much to decode."""

    seq: Natural
    t: Natural
    sensor: str
    value: float | None
    ts: str = ""
    text: str = ""
    driver: str = ""
    unit: str = ""
    raw: float | None = None
    bad: list[str] | msgspec.UnsetType = msgspec.UNSET

    def message(self) -> Reading:
        """The same as a `Reading`."""
        return Reading(**msgspec.structs.asdict(self) | {"bad": self.bad or []})


class QuickEngagement(
    EngagementShown,
    frozen=True,
    kw_only=True,
    omit_defaults=True,
    gc=False,
    tag_field="kind",
    tag="engagement.shown",
):
    """An `EngagementShown` among them, so that all can be asked for their sensor."""

    seq: Natural
    t: Natural
    sensor: str = _SHOWN

    def message(self) -> EngagementShown:
        """The same as an `EngagementShown`."""
        fields = msgspec.structs.asdict(self)
        del fields["sensor"]
        return EngagementShown(**fields)


#: A sample as it is looked at here, or the line of one that this version does not know.
SampleEntry = LogItem | QuickReading | QuickEngagement

_decoder: msgspec.json.Decoder[QuickReading | QuickEngagement] = msgspec.json.Decoder(
    QuickReading | QuickEngagement
)


def entries_in(chunk: LineChunk) -> list[QuickReading | QuickEngagement]:
    """The samples of a chunk that holds nothing else, all at once; none if it does."""
    if chunk.data is None or not chunk.whole:
        return []
    try:
        return codec.decode_lines(_decoder, chunk.data)
    except codec.WireError:
        return []


@dataclass(frozen=True)
class SampleState:
    """What the samples said last, up to a moment.

    Attributes:
        readings: The last reading of each sensor that has spoken, by its name.
        shown: How the engagement model stood.
    """

    readings: dict[str, Reading] = field(default_factory=dict)
    shown: EngagementShown | None = None


Sample = QuickReading | QuickEngagement | Reading | EngagementShown


#: What was last of each sensor, by its name; that of the engagement model is under `_SHOWN`.
LastSamples = dict[str, Sample]


def last_samples(entries: Sequence[SampleEntry]) -> LastSamples:
    """What was last among `entries`, in order of `seq`."""
    try:
        return {entry.sensor: entry for entry in entries}  # type: ignore[union-attr, misc]
    except AttributeError:  # not all of them are of the quick kind
        found: LastSamples = {entry.sensor: entry for entry in entries if type(entry) is Reading}
        if shown := [entry for entry in entries if type(entry) is EngagementShown]:
            found[_SHOWN] = shown[-1]
        return found


@dataclass(frozen=True, slots=True)
class SampleBlock:
    """Samples that stand together: how to read them, and their smallest and greatest `t`.

    `lasts`: the last sample of each sensor, or its place in what `read` gives: offset and size.
    """

    read: Callable[[], bytes]
    low: int
    high: int
    lasts: Mapping[str, Sample | tuple[int, int]]

    def last(self, name: str) -> Sample | None:
        """The last sample of a sensor; None if there is none, or it can be read no longer."""
        found = self.lasts.get(name)
        if not isinstance(found, tuple):
            return found
        offset, size = found
        line = self.read()[offset : offset + size]
        return _decoder.decode(line) if line else None


class SampleBlocks:
    """All blocks of a session, in order of `seq`.

    Time rises from block to block, unless something has damaged it: blocks that do not fit in are
    *stray* and looked at whenever their times are asked for.
    """

    def __init__(self, blocks: Sequence[SampleBlock]) -> None:
        fits = in_steady_series([(block.low, block.high) for block in blocks])
        self._blocks = [block for block, fit in zip(blocks, fits, strict=True) if fit]
        self._strays = [block for block, fit in zip(blocks, fits, strict=True) if not fit]
        self._lows = [block.low for block in self._blocks]
        self._highs = [block.high for block in self._blocks]
        self._order = {id(block): place for place, block in enumerate(blocks)}
        self._names = set[str]().union(*(block.lasts for block in self._blocks))
        self._kept: dict[int, list[LogItem]] = {}

    @property
    def last_us(self) -> int:
        """The last moment of which there are samples; -1 if there are none."""
        return self._highs[-1] if self._highs else -1

    def at(self, t_us: int) -> SampleState:
        """What was said last, up to and with `t_us`."""
        whole = bisect_right(self._highs, t_us)
        found = self._last_before(whole)
        begun = bisect_right(self._lows, t_us)
        for block in [*self._blocks[whole:begun], *self._strays]:
            if block.low <= t_us:
                chunk = _chunk(block)
                entries: Sequence[SampleEntry] = entries_in(chunk) or items_in(chunk, Damage())
                _keep_later(found, last_samples([each for each in entries if each.t <= t_us]))
        said = [
            last.message() if isinstance(last, QuickReading | QuickEngagement) else last
            for last in found.values()
        ]
        readings = {each.sensor: each for each in said if isinstance(each, Reading)}
        shown = next((each for each in said if isinstance(each, EngagementShown)), None)
        return SampleState(readings, shown)

    def _last_before(self, count: int) -> LastSamples:
        """The last sample of each sensor in the first `count` blocks."""
        found: LastSamples = {}
        missing = set(self._names)
        for place in range(count - 1, -1, -1):
            block = self._blocks[place]
            for name in missing & block.lasts.keys():
                sample = block.last(name)
                if sample is not None:
                    found[name] = sample
            missing -= block.lasts.keys()
            if not missing:
                break
        return found

    def between(self, after_us: int, until_us: int) -> Iterator[list[LogItem]]:
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

    def _items(self, block: SampleBlock) -> list[LogItem]:
        kept = self._kept.pop(id(block), None)
        if kept is None:
            while len(self._kept) >= _KEPT:
                del self._kept[next(iter(self._kept))]
            kept = items_in(_chunk(block), Damage())
        self._kept[id(block)] = kept
        return kept


def _keep_later(found: LastSamples, others: LastSamples) -> None:
    """Some of `others` came before what was found and some after it."""
    for name, last in others.items():
        known = found.get(name)
        if known is None or known.seq < last.seq:
            found[name] = last


def _chunk(block: SampleBlock) -> LineChunk:
    return LineChunk(_NOWHERE, 0, block.read())


def in_steady_series(spans: Sequence[tuple[int, int]]) -> list[bool]:
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
