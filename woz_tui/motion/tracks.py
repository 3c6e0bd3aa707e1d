"""One value over time: from key to key by an easing, or through dense samples."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

from woz_tui.motion.easing import EASINGS


class Track(Protocol):
    """A value over the places (seconds or beats) of a move."""

    @property
    def begins(self) -> float:
        """Where it begins to want something."""
        ...

    @property
    def ends(self) -> float:
        """Where its last value is reached."""
        ...

    def at(self, place: float) -> float:
        """The value; beyond an end as there."""
        ...


@dataclass(frozen=True, slots=True)
class Keyed:
    """From key to key; `easings[i]` leads to key `i`, so the first one leads nowhere.

    `places` rise; a key at the place of the one before takes its place at once.
    """

    places: tuple[float, ...]
    values: tuple[float, ...]
    easings: tuple[str, ...]

    @property
    def begins(self) -> float:
        """Place of the first key."""
        return self.places[0]

    @property
    def ends(self) -> float:
        """Place of the last key."""
        return self.places[-1]

    def at(self, place: float) -> float:
        """The value; beyond an end as there."""
        after = bisect_right(self.places, place)
        if after == 0:
            return self.values[0]
        if after == len(self.places):
            return self.values[-1]
        start, value = self.places[after - 1], self.values[after - 1]
        share = (place - start) / (self.places[after] - start)
        return value + (self.values[after] - value) * EASINGS[self.easings[after]](share)


@dataclass(frozen=True, slots=True)
class Sampled:
    """Straight from sample to sample, `rate` of them each second or beat; the first is at 0."""

    rate: float
    values: tuple[float, ...]
    begins: float = 0.0

    @property
    def ends(self) -> float:
        """Place of the last sample."""
        return (len(self.values) - 1) / self.rate

    def at(self, place: float) -> float:
        """The value; beyond an end as there."""
        position = place * self.rate
        index = int(max(0.0, position))
        if index >= len(self.values) - 1:
            return self.values[-1]
        value = self.values[index]
        return value + (self.values[index + 1] - value) * max(0.0, position - index)


@dataclass(slots=True)
class Drawing:
    """Keys of a track while they are being collected, in the order of their places."""

    places: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    easings: list[str] = field(default_factory=list)

    def key(self, place: float, value: float, easing: str) -> None:
        """The next key; at the place of the last one it replaces that one."""
        if self.places and place <= self.places[-1]:
            self.values[-1] = value
            return
        self.places.append(place)
        self.values.append(value)
        self.easings.append(easing)

    def leg(self, start: float, end: float, value: float, easing: str, first: float) -> None:
        """To `value` between `start` and `end`; until `start` it stays where it is, at `first`
        if it was nowhere.
        """
        here = self.values[-1] if self.values else first
        if not self.places or start > self.places[-1]:
            self.key(start, here, "linear")
        self.key(end, value, easing)

    def keyed(self) -> Keyed:
        """The finished track."""
        return Keyed(tuple(self.places), tuple(self.values), tuple(self.easings))


@dataclass(frozen=True, slots=True)
class Steps:
    """A word that changes from one moment to the next; nothing before the first."""

    places: tuple[float, ...]
    words: tuple[str, ...]

    @classmethod
    def of(cls, steps: Iterable[tuple[float, str]]) -> Steps:
        """From places and words, in order."""
        pairs = tuple(steps)
        return cls(tuple(place for place, _ in pairs), tuple(word for _, word in pairs))

    def at(self, place: float) -> str | None:
        """The word that counts at `place`."""
        before = bisect_right(self.places, place)
        return self.words[before - 1] if before else None
