"""How much two coders agree: percent agreement and Cohen's kappa over bins of time, within trials.

J. Cohen, A coefficient of agreement for nominal scales, Educational and Psychological Measurement
20 (1), 1960.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.log.coding_file import Code, tiers_of
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import ContextSpan

#: The length of a bin unless somebody says otherwise, in microseconds.
BIN_US = 1_000_000
#: A piece of time (microseconds): codes end where it ends.
Stretch = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Agreement:
    """The agreement in one tier. `table`: how many bins the one coder gave the first code and the
    other the second; an empty code is none.
    """

    tier: str
    table: Mapping[tuple[str, str], int]

    @property
    def codes(self) -> list[str]:
        """All codes of both coders; the empty one, for no code, comes last."""
        return sorted({code for pair in self.table for code in pair}, key=lambda it: (not it, it))

    @property
    def bins(self) -> int:
        return sum(self.table.values())

    @property
    def agreed(self) -> float | None:
        """The share of bins with the same code; None without bins."""
        same = sum(count for (one, other), count in self.table.items() if one == other)
        return same / self.bins if self.bins else None

    @property
    def kappa(self) -> float | None:
        """Agreement beyond chance; None where chance alone makes all bins agree."""
        if self.agreed is None:
            return None
        ones, others = self._margin(0), self._margin(1)
        by_chance = sum(ones[code] * others[code] for code in ones) / self.bins**2
        return (self.agreed - by_chance) / (1 - by_chance) if by_chance < 1 else None

    def _margin(self, which: int) -> Counter[str]:
        found: Counter[str] = Counter()
        for pair, count in self.table.items():
            found[pair[which]] += count
        return found


def coded_spans(timeline: Timeline, *, every: bool = False) -> list[Stretch]:
    """The trials that count, breaks left out; in a session without trials all of it. `every`: also
    trials that do not.
    """
    return [(piece.begin, piece.end) for piece in _coded(timeline, every=every)]


def coded_trials(timeline: Timeline, *, every: bool = False) -> int:
    """How many trials `coded_spans` are of: one with a break has several spans."""
    contexts = [piece.context for piece in _coded(timeline, every=every)]
    return len({(each.participant, each.trial, each.run) for each in contexts})


def _coded(timeline: Timeline, *, every: bool) -> list[ContextSpan]:
    return [
        piece
        for piece in timeline.pieces
        if piece.end > piece.begin
        and timeline.inside(piece.context)
        and (every or timeline.counts(piece.context))
    ]


def code_ends(codes: Sequence[Code], timeline: Timeline) -> list[int | None]:
    """Returns when each of one coder's codes, given by time, ends; None for a moment."""
    borders = [piece.end for piece in timeline.pieces]
    found: list[int | None] = []
    for at, code in enumerate(codes):
        if code.note or not code.lasts:
            found.append(None)
            continue
        later = (each.t for each in codes[at + 1 :] if each.tier == code.tier and not each.note)
        border = next((end for end in borders if end > code.t), code.t)
        found.append(min(next(later, border), border))
    return found


def agreements(
    one: Sequence[Code], other: Sequence[Code], within: Iterable[Stretch], bin_us: int = BIN_US
) -> list[Agreement]:
    """The agreement in each tier that either of two coders has used."""
    within = list(within)
    found = []
    for tier in tiers_of([*one, *other]):
        pairs = zip(
            binned(one, tier, within, bin_us), binned(other, tier, within, bin_us), strict=True
        )
        found.append(Agreement(tier, Counter(pairs)))
    return found


def binned(codes: Iterable[Code], tier: str, within: Iterable[Stretch], bin_us: int) -> list[str]:
    """A code for each bin, the first of which begins with its stretch: that of a moment in the bin,
    the last one of several; or else the code that holds for most of the bin.
    """
    mine = sorted(
        (code for code in codes if not code.note and code.tier == tier),
        key=lambda code: (code.t, code.number),
    )
    found = []
    for begin, end in within:
        here = [code for code in mine if begin <= code.t < end]
        for at in range(begin, end, bin_us):
            found.append(_code_of(here, at, min(at + bin_us, end)))
    return found


def _code_of(codes: Sequence[Code], begin: int, end: int) -> str:
    """The code of a bin, of the codes of its stretch by time."""
    moments = [code.code for code in codes if not code.lasts and begin <= code.t < end]
    if moments:
        return moments[-1]
    held: Counter[str] = Counter()
    last, since = "", begin
    for code in codes:
        if code.lasts and code.t < end:
            held[last] += max(0, code.t - since)
            last, since = code.code, max(begin, code.t)
    held[last] += end - since
    return max(held, key=held.__getitem__)
