"""Two sessions side by side: what one has done that the other has not, and what came when.

A session and its re-run (be it a re-run of a re-run), or two re-runs of one session, are put beside
each other command by command, because the re-run's log says which command was which. Any other two
are aligned by the names of what was played, so that as much as possible stands in the same order in
both.
"""

from __future__ import annotations

import statistics
from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from woz_tui.analysis.played_actions import PlayedAct, PlayedSession

#: Sequences with more pairs of places than this are aligned piece by piece, which may miss
#: something but ends in a second or two.
EXACT = 4_000_000


def align(
    a: Sequence[str], b: Sequence[str], limit: int = EXACT
) -> tuple[list[tuple[int, int]], bool]:
    """The longest common subsequence, as pairs of places that rise in both.

    The second value says whether it surely is the longest one: sequences with more than `limit`
    pairs of places between the beginning and the end that they share are aligned piece by piece.
    """
    head = 0
    while head < min(len(a), len(b)) and a[head] == b[head]:
        head += 1
    tail = 0
    while tail < min(len(a), len(b)) - head and a[-1 - tail] == b[-1 - tail]:
        tail += 1
    middle_a, middle_b = a[head : len(a) - tail], b[head : len(b) - tail]
    pieces = max(1, -(-len(middle_a) * len(middle_b) // max(1, limit)))
    found = _in_pieces(middle_a, middle_b, pieces)
    return [
        *((place, place) for place in range(head)),
        *((i + head, j + head) for i, j in found),
        *((len(a) - tail + place, len(b) - tail + place) for place in range(tail)),
    ], pieces == 1


def _longest(a: Sequence[str], b: Sequence[str]) -> list[tuple[int, int]]:
    """Finds the longest common subsequence with a table of common lengths."""
    rows = [[0] * (len(b) + 1)]
    for name in reversed(a):
        below, row = rows[-1], [0] * (len(b) + 1)
        for j in range(len(b) - 1, -1, -1):
            row[j] = below[j + 1] + 1 if name == b[j] else max(below[j], row[j + 1])
        rows.append(row)
    rows.reverse()
    pairs, i, j = [], 0, 0
    while i < len(a) and j < len(b):
        if a[i] == b[j]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif rows[i + 1][j] >= rows[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs


def _in_pieces(a: Sequence[str], b: Sequence[str], pieces: int) -> list[tuple[int, int]]:
    """Cuts both into so many pieces, and aligns each with its counterpart."""
    found = []
    for piece in range(pieces):
        i, i_end = (len(a) * n // pieces for n in (piece, piece + 1))
        j, j_end = (len(b) * n // pieces for n in (piece, piece + 1))
        found += [(i + x, j + y) for x, y in _longest(a[i:i_end], b[j:j_end])]
    return found


def rising(numbers: Sequence[int]) -> list[int]:
    """Indices of a longest rising subsequence of `numbers`, all of which are different."""
    tops: list[int] = []
    ends: list[int] = []
    before: list[int] = []
    for place, number in enumerate(numbers):
        length = bisect_left(tops, number)
        before.append(ends[length - 1] if length else -1)
        tops[length : length + 1] = [number]
        ends[length : length + 1] = [place]
    found: list[int] = []
    place = ends[-1] if ends else -1
    while place >= 0:
        found.append(place)
        place = before[place]
    return found[::-1]


#: How two logs were put beside each other.
BY_COMMANDS, BY_NAMES = "commands", "names"


@dataclass(frozen=True, slots=True)
class ActPair:
    """The same act in both logs. `shift_us`: how much later it was in B than in A, both counted
    from the first act that they share; in a re-run, from when it was due.
    """

    a: PlayedAct
    b: PlayedAct
    shift_us: int = 0

    @property
    def differences(self) -> list[str]:
        """What else differs, in words."""
        found = []
        if self.a.args != self.b.args:
            found.append(f"asked {_words(self.a.args)}, then {_words(self.b.args)}")
        elif self.a.end == self.b.end and self.a.sent != self.b.sent:
            found.append(f"really sent {_words(self.a.sent)}, then {_words(self.b.sent)}")
        if self.a.end != self.b.end:
            found.append(f"{self.a.end or 'no end'}, then {self.b.end or 'no end'}")
        return found


@dataclass(frozen=True, slots=True)
class Shifts:
    """By how much B is later than A, in microseconds.

    `p95` and `largest` are of the amounts, whatever their sign. `drift` is the trend of the shifts,
    in microseconds a second: the slope of the straight line with the least squares.
    """

    median: int
    p95: int
    largest: int
    drift: float


@dataclass(frozen=True)
class Comparison:
    """What two logs, A and B, have in common and where they differ.

    Attributes:
        by: commands, if the logs say which is which; else names.
        pairs: What both have, in A's order.
        missing: What only A has.
        extra: What only B has.
        moved: Those of `pairs` that stand at another place in B's order.
        why_missing: Why a re-run has left something out, by A's ids.
        exact: Whether no alignment could have found more pairs.
    """

    a: PlayedSession
    b: PlayedSession
    by: str
    pairs: tuple[ActPair, ...]
    missing: tuple[PlayedAct, ...]
    extra: tuple[PlayedAct, ...]
    moved: tuple[ActPair, ...] = ()
    why_missing: dict[str, str] = field(default_factory=dict)
    exact: bool = True

    @property
    def different(self) -> tuple[ActPair, ...]:
        """Pairs that differ in what was asked, in what was sent or in how it ended."""
        return tuple(pair for pair in self.pairs if pair.differences)

    @property
    def same(self) -> bool:
        """Whether both have done the same in the same order, whenever that was."""
        return not (self.missing or self.extra or self.moved or self.different)

    @property
    def shifts(self) -> Shifts | None:
        """How much later B was than A; None if they share nothing."""
        return shifts_of(self.pairs)


def compare(a: PlayedSession, b: PlayedSession) -> Comparison:
    """Compare log B with log A."""
    if b.original and b.original == a.name:
        return _by_commands(_Side(a, again=False), _Side(b, again=True))
    if a.original and a.original == b.name:
        return _by_commands(_Side(a, again=True), _Side(b, again=False))
    if _of_one_session(a, b):
        return _by_commands(_Side(a, again=True), _Side(b, again=True))
    return _by_names(a, b)


@dataclass(frozen=True, slots=True)
class _Side:
    """One of two logs that have commands in common. `again`: it is the re-run here; a re-run that
    was run again in its turn is the original.
    """

    log: PlayedSession
    again: bool

    def acts(self) -> list[PlayedAct]:
        """What counts, in its order: in an original that of the beginnings, in a re-run that in
        which they were sent. In an original what had no effect is not expected to be repeated.
        """
        if self.again:
            return sorted(self.log.commands, key=lambda act: act.t)
        return [act for act in self.log.commands if act.began >= 0 and act.end != "refused"]

    def origin(self, act: PlayedAct) -> str:
        """The id of an act in the log that both come from; empty: it is not from there."""
        return act.original if self.again else act.id

    def late(self, act: PlayedAct) -> int:
        """How much later it was than it should have been; an original is never late."""
        return act.late if self.again else 0

    def skipped(self) -> dict[str, str]:
        """Why commands of the original were left out, by their ids there."""
        return self.log.skipped if self.again else {}


def _of_one_session(a: PlayedSession, b: PlayedSession) -> bool:
    """Whether both are re-runs of one log: two logs can have one name, redacted ones have none."""
    if a.original_sha256 and b.original_sha256:
        return a.original_sha256 == b.original_sha256
    return bool(a.original) and a.original == b.original and not (a.redacted or b.redacted)


def _by_commands(a: _Side, b: _Side) -> Comparison:
    acts_a, acts_b = a.acts(), b.acts()
    places = {b.origin(act): place for place, act in enumerate(acts_b)}
    places.pop("", None)
    indices = [
        (place, places[origin])
        for place, act in enumerate(acts_a)
        if (origin := a.origin(act)) in places
    ]
    pairs = [
        ActPair(acts_a[i], acts_b[j], b.late(acts_b[j]) - a.late(acts_a[i])) for i, j in indices
    ]
    missing = _rest(acts_a, {i for i, _ in indices})
    reasons = {**a.skipped(), **b.skipped()}
    return Comparison(
        a=a.log,
        b=b.log,
        by=BY_COMMANDS,
        pairs=tuple(pairs),
        missing=missing,
        extra=_rest(acts_b, {j for _, j in indices}),
        moved=_moved(pairs, indices),
        why_missing={
            act.id: reasons[origin] for act in missing if (origin := a.origin(act)) in reasons
        },
    )


def _by_names(a: PlayedSession, b: PlayedSession) -> Comparison:
    indices, exact = align([act.name for act in a.acts], [act.name for act in b.acts])
    pairs = []
    for i, j in indices:
        first_a, first_b = indices[0]
        since_a = a.acts[i].moment - a.acts[first_a].moment
        since_b = b.acts[j].moment - b.acts[first_b].moment
        pairs.append(ActPair(a.acts[i], b.acts[j], since_b - since_a))
    return Comparison(
        a=a,
        b=b,
        by=BY_NAMES,
        pairs=tuple(pairs),
        missing=_rest(a.acts, {i for i, _ in indices}),
        extra=_rest(b.acts, {j for _, j in indices}),
        exact=exact,
    )


def _rest(acts: Sequence[PlayedAct], taken: set[int]) -> tuple[PlayedAct, ...]:
    return tuple(act for place, act in enumerate(acts) if place not in taken)


def _moved(pairs: Sequence[ActPair], indices: Sequence[tuple[int, int]]) -> tuple[ActPair, ...]:
    kept = set(rising([j for _, j in indices]))
    return tuple(pair for place, pair in enumerate(pairs) if place not in kept)


def shifts_of(pairs: Iterable[ActPair]) -> Shifts | None:
    """The figures of the shifts; None without pairs. The percentile is the nearest rank."""
    points = [(pair.a.moment, pair.shift_us) for pair in pairs]
    if not points:
        return None
    amounts = sorted(abs(shift) for _, shift in points)
    return Shifts(
        median=round(statistics.median(shift for _, shift in points)),
        p95=amounts[max(0, -(-95 * len(amounts) // 100) - 1)],
        largest=amounts[-1],
        drift=_trend(points),
    )


def _trend(points: Sequence[tuple[int, int]]) -> float:
    if len({t for t, _ in points}) < 2:
        return 0.0
    times = [t / 1_000_000 for t, _ in points]
    return statistics.linear_regression(times, [float(shift) for _, shift in points]).slope


def _words(values: tuple[dict[str, Any], ...]) -> str:
    groups = (", ".join(f"{name} {value}" for name, value in each.items()) for each in values)
    return "; ".join(each or "nothing" for each in groups) or "nothing"


def facts(comparison: Comparison) -> dict[str, Any]:
    """The comparison as plain values; times in microseconds on the axis of each log."""
    shifts = comparison.shifts
    return {
        "a": comparison.a.name,
        "b": comparison.b.name,
        "by": comparison.by,
        "exact": comparison.exact,
        "same": comparison.same,
        "shifts": shifts
        and {
            "median_us": shifts.median,
            "p95_us": shifts.p95,
            "largest_us": shifts.largest,
            "drift_us_per_s": round(shifts.drift, 3),
        },
        "pairs": [_pair_facts(pair) for pair in comparison.pairs],
        "missing": [
            {**_act_facts(act), "why": comparison.why_missing.get(act.id, "")}
            for act in comparison.missing
        ],
        "extra": [_act_facts(act) for act in comparison.extra],
        "moved": [pair.a.id for pair in comparison.moved],
        "streams": {"a": comparison.a.streams, "b": comparison.b.streams},
        "redacted": {"a": comparison.a.redacted, "b": comparison.b.redacted},
    }


def _pair_facts(pair: ActPair) -> dict[str, Any]:
    return {
        "name": pair.a.name,
        "a": pair.a.id,
        "b": pair.b.id,
        "t_a": pair.a.moment,
        "t_b": pair.b.moment,
        "shift_us": pair.shift_us,
        "differences": pair.differences,
    }


def _act_facts(act: PlayedAct) -> dict[str, Any]:
    return {"name": act.name, "id": act.id, "t": act.moment, "end": act.end}
