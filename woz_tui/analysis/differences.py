"""How long settings of robots were other than asked for, and in which trial."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field

from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.known import TELLING, Known, Stretch, worded
from woz_tui.analysis.rows import Difference
from woz_tui.analysis.tally import Tally
from woz_tui.core import messages as m

#: Values of one setting that are told in a row of a table; beyond, there were more.
_VALUES = 3
#: What can change whose time it is.
_MOVING: tuple[type[m.Message], ...] = (
    *(m.SessionStart, m.SessionChanged, m.ConditionsAssigned),
    *(m.TrialStarted, m.TrialEnded, m.BreakStarted, m.BreakEnded),
)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where in the session a difference counts. `tally` is that of the others together."""

    participant: str
    condition: str
    trial: int
    run: int
    tally: Tally = field(compare=False)


class Differences:
    """Follows what robots say of their settings. Its handlers come after those of the course."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self._known = Known(self._place, lambda each: bool(each.differs))
        self._settled = 0
        course.leaving.append(self._settle)

    def handlers(self) -> Handlers:
        """What it listens to."""
        moving: Handlers = dict.fromkeys(_MOVING, self._moved)
        telling: Handlers = dict.fromkeys(TELLING, self._heard)
        return {**moving, **telling}

    def finish(self) -> None:
        """The log is over; what differed then differed to its last moment."""
        self._settle()
        self._known.finish(self._course.t)

    def rows(
        self, counts: Callable[[Tally], bool], people: Collection[str]
    ) -> tuple[Difference, ...]:
        """All of them by time; `counts` says whether a tally is to be analysed."""
        stretches = sorted(self._known.over, key=lambda each: (each.begin, each.driver, each.name))
        return tuple(
            _row(each, counted=counts(each.place.tally) and each.place.participant in people)
            for each in stretches
        )

    @property
    def _place(self) -> _Place:
        course = self._course
        tally = course.tally
        return _Place(course.participant, course.condition, course.trial, tally.run, tally)

    def _heard(self, message: m.Message) -> None:
        self._settle()
        self._known.take(message, self._course.t, message.seq)

    def _moved(self, message: m.Message) -> None:
        self._known.move(self._place, self._course.t)

    def _settle(self) -> None:
        """Count the time up to now where it belongs."""
        course = self._course
        us, self._settled = course.t - self._settled, course.t
        if self._known.known:
            course.tally.settings_us += us
            if self._known.differing:
                course.tally.differing_us += us


def _row(each: Stretch[_Place], *, counted: bool) -> Difference:
    assert each.state is not None
    return Difference(
        driver=each.driver,
        setting=each.name,
        value=worded(each.state.value),
        wanted=worded(each.state.wanted),
        begin=each.begin,
        end=each.end,
        changed=each.changed,
        cut=each.cut,
        participant=each.place.participant,
        condition=each.place.condition,
        trial=each.place.trial,
        counted=counted,
    )


@dataclass(frozen=True, slots=True)
class Differed:
    """All differences of one setting in one trial of one condition; `first` is when they began.

    `values` is what the robot had, `wanted` what was asked for, each once and at most three.
    """

    name: str
    participant: str
    condition: str
    trial: int
    counted: bool
    first: int
    us: int
    values: str
    wanted: str


def by_trial(rows: Iterable[Difference]) -> list[Differed]:
    """In the order in which they began; a setting is named with its driver if there are several."""
    found: dict[tuple[object, ...], list[Difference]] = {}
    for row in rows:
        key = (row.driver, row.setting, row.participant, row.condition, row.trial, row.counted)
        found.setdefault(key, []).append(row)
    several = len({same[0].driver for same in found.values()}) > 1
    return [_differed(same, several=several) for same in found.values()]


def _differed(same: list[Difference], *, several: bool) -> Differed:
    first = same[0]
    return Differed(
        name=f"{first.driver} {first.setting}" if several else first.setting,
        participant=first.participant,
        condition=first.condition,
        trial=first.trial,
        counted=first.counted,
        first=first.begin,
        us=sum(row.end - row.begin for row in same),
        values=_listed(row.value for row in same),
        wanted=_listed(row.wanted for row in same),
    )


def _listed(values: Iterable[str]) -> str:
    told = list(dict.fromkeys(values))
    return ", ".join(told[:_VALUES] + ["..."] * (len(told) > _VALUES))
