"""Two sessions side by side: what one has done that the other has not, and what came when.

A session and its re-run (or two re-runs of one session) are put beside each other command by
command, because the re-run's log says which command was which. Any other two are aligned by the
names of what was played, so that as much as possible stands in the same order in both.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from difflib import SequenceMatcher
from itertools import pairwise
from typing import Any

from woz_tui.core import messages as m
from woz_tui.experiment.verbs import ENGAGEMENT

#: Alignments of more than so many pairs of acts are made with a quicker method that may miss some.
EXACT = 4_000_000
#: Commands like these are counted, but are no acts of their own: only the last of them counts.
_STREAMS = frozenset({"control", "joints"})


@dataclass(frozen=True, slots=True)
class Act:
    """Something that was done: an action by its name, or a command that belongs to none.

    Attributes:
        id: Its run or command in its own log.
        name: The action, or `driver.verb`.
        t: When it was asked for, in microseconds on the axis of its own log.
        began: When its first command began; -1: none has.
        end: How it ended, without what is before the dot: done, failed, stopped ... or cut for
            what was stopped or made way; empty: the log does not say.
        args: The arguments of its commands, by `driver.verb`, in order.
        sent: What was really sent, as far as it was done.
        original: The command of the original, in a re-run.
    """

    id: str
    name: str
    t: int
    began: int = -1
    end: str = ""
    args: tuple[tuple[str, dict[str, m.Json]], ...] = ()
    sent: tuple[dict[str, m.Json], ...] = ()
    original: str = ""

    @property
    def moment(self) -> int:
        """When it began; if it never did, when it was asked for."""
        return self.began if self.began >= 0 else self.t


@dataclass
class Course:
    """What of a log can be compared.

    Attributes:
        name: What its files are called.
        start: Its first line.
        acts: What was done, in order of `t`.
        commands: Each command by itself, in the order in which they began.
        original: Of which log it is a re-run; empty: of none.
        skipped: Why commands of the original were left out, by their ids.
        streams: How many setpoints of streams there were.
    """

    name: str
    start: m.SessionStart | None = None
    acts: list[Act] = field(default_factory=list)
    commands: list[Act] = field(default_factory=list)
    original: str = ""
    skipped: dict[str, str] = field(default_factory=dict)
    streams: int = 0


@dataclass(frozen=True, slots=True)
class Pair:
    """The same act in both logs. `shift_us`: how much later it was in B, counted from the first act
    that both have.
    """

    a: Act
    b: Act
    shift_us: int = 0

    @property
    def differences(self) -> list[str]:
        """In what else they differ, in words."""
        found = []
        if self.a.args != self.b.args:
            found.append(f"asked {_asked(self.a)}, then {_asked(self.b)}")
        if self.a.end != self.b.end:
            found.append(f"{self.a.end or 'no end'}, then {self.b.end or 'no end'}")
        return found


@dataclass(frozen=True, slots=True)
class Shifts:
    """By how much B is later than A, in microseconds; `drift` is the trend, in microseconds a second.

    `p95` and `largest` are of the amounts, whatever their direction.
    """

    median: int
    p95: int
    largest: int
    drift: float


@dataclass(frozen=True)
class Comparison:
    """A and B beside each other.

    Attributes:
        by: rerun, if each command is known to be another one of the other log; else names.
        pairs: What both have, in A's order.
        missing: What only A has.
        extra: What only B has.
        moved: What both have, but B at another place in the order; a part of `pairs`.
        why_missing: Why the re-run has left something out, by A's ids.
        exact: Whether no alignment could have found more pairs.
    """

    a: Course
    b: Course
    by: str
    pairs: tuple[Pair, ...]
    missing: tuple[Act, ...]
    extra: tuple[Act, ...]
    moved: tuple[Pair, ...] = ()
    why_missing: dict[str, str] = field(default_factory=dict)
    exact: bool = True

    @property
    def different(self) -> tuple[Pair, ...]:
        """Pairs that differ in arguments or end."""
        return tuple(pair for pair in self.pairs if pair.differences)

    @property
    def same(self) -> bool:
        """Whether both have done the same in the same order, whenever it was."""
        return not (self.missing or self.extra or self.moved or self.different)

    @property
    def shifts(self) -> Shifts | None:
        """How the times lie to each other; None if there is nothing to compare."""
        return shifts_of(self.pairs)


def compare(a: Course, b: Course) -> Comparison:
    """Put B beside A."""
    keys = _keys(a, b)
    if keys is not None:
        return _by_origin(a, b, *keys)
    indices, exact = align([act.name for act in a.acts], [act.name for act in b.acts])
    return _compared(a, b, a.acts, b.acts, indices, "names", exact=exact)


# -- a re-run -------------------------------------------------------------------------------------


def _keys(a: Course, b: Course) -> tuple[dict[str, str], dict[str, str]] | None:
    """What the commands of A and of B are called in the log that both come from; None: in none."""
    origin = a.original or b.original
    if not origin or a.original not in ("", origin) or b.original not in ("", origin):
        return None
    if {a.name, b.name} != {origin, a.name if a.original else b.name} and not (
        a.original and b.original
    ):
        return None
    return _origins(a), _origins(b)


def _origins(course: Course) -> dict[str, str]:
    if not course.original:
        return {act.id: act.id for act in course.commands}
    return {act.id: act.original for act in course.commands if act.original}


def _by_origin(a: Course, b: Course, in_a: dict[str, str], in_b: dict[str, str]) -> Comparison:
    there = {origin: place for place, act in enumerate(b.commands) if (origin := in_b.get(act.id))}
    indices = [
        (place, there[in_a[act.id]])
        for place, act in enumerate(a.commands)
        if in_a.get(act.id) in there
    ]
    compared = _compared(a, b, a.commands, b.commands, indices, "rerun")
    why = {
        act.id: reason
        for act in compared.missing
        if (reason := {**a.skipped, **b.skipped}.get(in_a.get(act.id, "")))
    }
    return replace(compared, why_missing=why)


# -- any two --------------------------------------------------------------------------------------


def align(a: Sequence[str], b: Sequence[str]) -> tuple[list[tuple[int, int]], bool]:
    """The longest common subsequence of two sequences of names, as pairs of places that rise in
    both; and whether it surely is the longest one.
    """
    head = 0
    while head < min(len(a), len(b)) and a[head] == b[head]:
        head += 1
    tail = 0
    while tail < min(len(a), len(b)) - head and a[-1 - tail] == b[-1 - tail]:
        tail += 1
    middle_a, middle_b = a[head : len(a) - tail], b[head : len(b) - tail]
    exact = len(middle_a) * len(middle_b) <= EXACT
    found = (_longest if exact else _quickly)(middle_a, middle_b)
    return [
        *((place, place) for place in range(head)),
        *((i + head, j + head) for i, j in found),
        *((len(a) - tail + place, len(b) - tail + place) for place in range(tail)),
    ], exact


def _longest(a: Sequence[str], b: Sequence[str]) -> list[tuple[int, int]]:
    """By a table of the lengths of what is common from each pair of places on."""
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


def _quickly(a: Sequence[str], b: Sequence[str]) -> list[tuple[int, int]]:
    blocks = SequenceMatcher(None, a, b, autojunk=False).get_matching_blocks()
    return [(block.a + n, block.b + n) for block in blocks for n in range(block.size)]


def _compared(
    a: Course,
    b: Course,
    acts_a: Sequence[Act],
    acts_b: Sequence[Act],
    indices: Sequence[tuple[int, int]],
    by: str,
    *,
    exact: bool = True,
) -> Comparison:
    matched_a, matched_b = {i for i, _ in indices}, {j for _, j in indices}
    zero = min(indices, default=(0, 0))
    pairs = []
    for i, j in indices:
        since_a = acts_a[i].moment - acts_a[zero[0]].moment
        since_b = acts_b[j].moment - acts_b[zero[1]].moment
        pairs.append(Pair(acts_a[i], acts_b[j], since_b - since_a))
    kept = set(_rising([j for _, j in indices]))
    moved = [pair for place, pair in enumerate(pairs) if place not in kept]
    return Comparison(
        a=a,
        b=b,
        by=by,
        pairs=tuple(pairs),
        missing=tuple(act for i, act in enumerate(acts_a) if i not in matched_a),
        extra=tuple(act for j, act in enumerate(acts_b) if j not in matched_b),
        moved=tuple(moved),
        exact=exact,
    )


def _rising(numbers: Sequence[int]) -> list[int]:
    """Places of a longest rising part of `numbers`, which are all different."""
    ends: list[int] = []
    before: list[int] = []
    for place, number in enumerate(numbers):
        low, high = 0, len(ends)
        while low < high:
            middle = (low + high) // 2
            if numbers[ends[middle]] < number:
                low = middle + 1
            else:
                high = middle
        before.append(ends[low - 1] if low else -1)
        ends[low : low + 1] = [place]
    found, place = [], ends[-1] if ends else -1
    while place >= 0:
        found.append(place)
        place = before[place]
    return found[::-1]


# -- figures --------------------------------------------------------------------------------------


def shifts_of(pairs: Iterable[Pair]) -> Shifts | None:
    """Median, 95th percentile and largest of the shifts, and their trend over time."""
    points = sorted((pair.a.moment, pair.shift_us) for pair in pairs)
    if not points:
        return None
    shifts = [shift for _, shift in points]
    amounts = sorted(abs(shift) for shift in shifts)
    return Shifts(
        median=round(statistics.median(shifts)),
        p95=amounts[min(len(amounts) - 1, round(0.95 * (len(amounts) - 1)))],
        largest=amounts[-1],
        drift=_trend(points),
    )


def _trend(points: Sequence[tuple[int, int]]) -> float:
    """Microseconds a second, as the slope of a straight line with the least squares."""
    if all(one[0] == other[0] for one, other in pairwise(points)):
        return 0.0
    slope, _ = statistics.linear_regression(
        [t / 1_000_000 for t, _ in points], [float(shift) for _, shift in points]
    )
    return slope


def _asked(act: Act) -> str:
    return "; ".join(f"{verb} {args}" for verb, args in act.args) or "nothing"


# -- out of messages ------------------------------------------------------------------------------


def course_of(name: str, messages: Iterable[m.AnyMessage]) -> Course:
    """What of a session can be compared, out of its messages (samples may be left out).

    Setpoints of a stream of the wizard's hands are only counted. What the engagement model was told
    is left out, and what it did by itself is in: the robot has done it.
    """
    reader = _Reader(Course(name))
    for message in messages:
        reader.take(message)
    return reader.finished()


@dataclass
class _Reader:
    course: Course
    runs: dict[str, Act] = field(default_factory=dict)
    single: dict[str, Act] = field(default_factory=dict)
    commands: dict[str, m.Command] = field(default_factory=dict)
    began: dict[str, int] = field(default_factory=dict)
    ends: dict[str, m.End] = field(default_factory=dict)
    originals: dict[str, str] = field(default_factory=dict)

    def take(self, message: m.AnyMessage) -> None:
        match message:
            case m.SessionStart() if self.course.start is None:
                self.course.start = message
            case m.ActionRequested():
                self.runs[message.run] = Act(message.run, message.action, message.t)
            case m.ActionEnd():
                self._end_of_run(message)
            case m.Command():
                self.commands[message.command] = message
            case m.Dispatched():
                self.began[message.command] = message.t
            case m.End():
                self.ends[message.command] = message
            case m.RerunStarted():
                self.course.original = message.original
            case m.RerunSent():
                self.originals[message.command] = message.original_command
            case m.RerunSkipped():
                self.course.skipped[message.original_command] = message.reason

    def _end_of_run(self, end: m.ActionEnd) -> None:
        if end.run in self.runs:
            how = str(end.__struct_config__.tag).removeprefix("action.")
            self.runs[end.run] = replace(self.runs[end.run], end=_cut(how))

    def finished(self) -> Course:
        of_runs: dict[str, list[Act]] = {}
        for command in self.commands.values():
            if command.driver == ENGAGEMENT:
                continue
            act = self._act(command)
            self.course.commands.append(act)
            if command.run:
                of_runs.setdefault(command.run, []).append(act)
            elif command.passing or command.verb in _STREAMS:
                self.course.streams += 1
            else:
                self.course.acts.append(act)
        for name, run in self.runs.items():
            self.course.acts.append(_whole(run, of_runs.get(name, [])))
        self.course.acts.sort(key=lambda act: act.t)
        self.course.commands.sort(key=lambda act: act.moment)
        return self.course

    def _act(self, command: m.Command) -> Act:
        end = self.ends.get(command.command)
        how = str(end.__struct_config__.tag).removeprefix("command.") if end is not None else ""
        return Act(
            id=command.command,
            name=f"{command.driver}.{command.verb}",
            t=command.t,
            began=self.began.get(command.command, -1),
            end=_cut(how),
            args=((f"{command.driver}.{command.verb}", command.args),),
            sent=(end.sent,) if isinstance(end, m.Done) else (),
            original=self.originals.get(command.command, ""),
        )


def _whole(run: Act, commands: Sequence[Act]) -> Act:
    began = [act.began for act in commands if act.began >= 0]
    return replace(
        run,
        began=min(began, default=-1),
        args=tuple(args for act in commands for args in act.args),
        sent=tuple(sent for act in commands for sent in act.sent),
    )


def _cut(how: str) -> str:
    """A re-run cuts short by itself what another command or the stop has cut short then."""
    return "cut" if how in ("stopped", "superseded") else how


def facts(comparison: Comparison) -> dict[str, Any]:
    """The comparison as plain values, for `--json`."""
    shifts = comparison.shifts
    return {
        "a": comparison.a.name,
        "b": comparison.b.name,
        "by": comparison.by,
        "exact": comparison.exact,
        "same": comparison.same,
        "pairs": [
            {
                "name": pair.a.name,
                "a": pair.a.id,
                "b": pair.b.id,
                "t_a": pair.a.moment,
                "t_b": pair.b.moment,
                "shift_us": pair.shift_us,
                "differences": pair.differences,
            }
            for pair in comparison.pairs
        ],
        "missing": [
            {**_fact(act), "why": comparison.why_missing.get(act.id, "")}
            for act in comparison.missing
        ],
        "extra": [_fact(act) for act in comparison.extra],
        "moved": [pair.a.id for pair in comparison.moved],
        "shifts": None
        if shifts is None
        else {
            "median_us": shifts.median,
            "p95_us": shifts.p95,
            "largest_us": shifts.largest,
            "drift_us_per_s": round(shifts.drift, 3),
        },
        "streams": [comparison.a.streams, comparison.b.streams],
    }


def _fact(act: Act) -> dict[str, Any]:
    return {"name": act.name, "id": act.id, "t": act.moment, "end": act.end}
