"""Scenes played to filters: what a filter said, and when it said something else.

*Engaged* is the condition E: presence, gaze and distance all say yes. The machine of states makes
the same change with the same sample, since E is what its edges wait for. A scene of which nothing
happens is *right* if every verdict stays as the truth is for the whole window, from the last calm
second on. Something that happens is *noticed* with the first sample thereafter by which E is as it
should be; the delay runs from the moment itself, which falls anywhere between two samples. A run
in which E was that way already, by an error, is no measurement and is left out.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from woz_tui.config.engagement import SIGNS
from woz_tui.sensing.bench.bench_scenes import CALM, Scene, SceneRun, played
from woz_tui.sensing.bench.filter_candidates import Candidate
from woz_tui.sensing.bench.sensor_errors import WINDOWS, ErrorModel

#: Rows of the paper's table and the signs they speak of.
ROWS = {"people": "presence", "face": "identity", "gaze": "gaze", "distance": "distance"}


@dataclass(frozen=True, slots=True)
class BenchConditions:
    """Under what circumstances scenes are played. `near` in metres, `rate` in samples a second."""

    errors: ErrorModel
    near: float = 1.3
    rate: float = 3.0
    together: bool = True


def takes(scene: Scene, world: BenchConditions, runs: int, seed: int) -> list[SceneRun]:
    """A scene played so often; the same for all filters, and for the same seed always."""
    return [
        played(
            scene,
            random.Random(f"{seed}/{scene.name}/{run}"),
            world.errors,
            rate=world.rate,
            near=world.near,
            together=world.together,
        )
        for run in range(runs)
    ]


@dataclass(frozen=True, slots=True)
class Steady:
    """Runs in which nothing happens: how many stayed right, and how often E turned wrong in how
    many seconds. Of visitors who stay, only the first wrong turn of a run is counted.
    """

    runs: int
    right: int
    turns: int
    seconds: float

    @property
    def share(self) -> float:
        """Of runs that stayed right, in per cent."""
        return 100.0 * self.right / self.runs

    @property
    def per_hour(self) -> float:
        """How often E turned to what it should not be, in an hour."""
        return 3600.0 * self.turns / self.seconds


def steady(candidate: Candidate, films: Sequence[SceneRun], engaged: bool) -> Steady:
    """How steadily a filter says `engaged` when nothing happens."""
    turns = [_turns(candidate, film, engaged) for film in films]
    seconds = sum((film.rows[-1].t / 1e6 - CALM) for film in films)
    return Steady(len(films), turns.count(0), sum(turns), seconds)


def _turns(candidate: Candidate, film: SceneRun, engaged: bool) -> int:
    bank = candidate.made()
    turns = 0
    right = True
    for row in film.rows:
        bank.take(row)
        if row.t >= CALM * 1e6:
            was, right = right, bank.engaged == engaged
            turns += was and not right
            if turns and engaged:
                break
    return turns


@dataclass(frozen=True, slots=True)
class Delays:
    """Seconds until something was noticed, sorted; infinite if it never was."""

    seconds: tuple[float, ...]

    def at(self, share: float) -> float:
        """The delay that so large a share of the runs does not exceed."""
        if not self.seconds:
            return math.inf
        return self.seconds[min(len(self.seconds), math.ceil(share * len(self.seconds))) - 1]

    @property
    def median(self) -> float:
        """Half of the runs are noticed so soon."""
        return self.at(0.5)

    @property
    def most(self) -> float:
        """Nineteen of twenty are."""
        return self.at(0.95)

    @property
    def worst(self) -> float:
        """All are."""
        return self.at(1.0)


def delays(candidate: Candidate, films: Iterable[SceneRun], engaged: bool) -> Delays:
    """How long a filter takes to say `engaged` once something has happened."""
    found = (_delay(candidate, film, engaged) for film in films)
    return Delays(tuple(sorted(delay for delay in found if delay is not None)))


def _delay(candidate: Candidate, film: SceneRun, engaged: bool) -> float | None:
    bank = candidate.made()
    before: bool | None = None
    for row in film.rows:
        bank.take(row)
        if row.t < film.moment:
            before = bank.engaged
        elif before == engaged:
            return None
        elif bank.engaged == engaged:
            return (row.t - film.moment) / 1e6
    return math.inf


def windows(candidate: Candidate, films: Sequence[SceneRun]) -> dict[str, tuple[float, ...]]:
    """The paper's table for a filter: by row, the per cent that stay right for each window."""
    lasted = [_lasted(candidate, film) for film in films]
    return {
        row: tuple(
            100.0 * sum(each[sign] >= seconds for each in lasted) / len(films)
            for seconds in WINDOWS
        )
        for row, sign in ROWS.items()
    }


def _lasted(candidate: Candidate, film: SceneRun) -> dict[str, float]:
    """For how many seconds each sign said yes, without a break, once errors may come."""
    bank = candidate.made()
    lasted = dict.fromkeys(SIGNS, math.inf)
    for row in film.rows:
        bank.take(row)
        since = row.t / 1e6 - CALM
        if since >= 0.0:
            for sign in SIGNS:
                if math.isinf(lasted[sign]) and not bank.says(sign):
                    lasted[sign] = since
    return lasted
