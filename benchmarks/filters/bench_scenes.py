"""Scenes of the bench: what visitors do, and the rows of samples that sensors make of it.

Times are seconds from the beginning of a scene. For the first `CALM` seconds nothing errs, so
that every filter has a full queue and the right verdict; what a scene is about happens later.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.filters.sensor_errors import ErrorEpisodes, ErrorModel

CALM = 6.0
#: When something happens, at a random phase of the sampling; and how long it is watched.
HAPPENS = 8.0
WATCHED = 12.0
#: The window of a stable engagement, as the longest of the paper's table.
WINDOW = 30.0
#: Metres: where a visitor talks, where they step back to, what the sensor sees without them, and
#: how much it strays from reading to reading.
TALKS, BACK, WALL, NOISE = 0.9, 2.2, 3.0, 0.03
#: Metres per second backwards.
WALKS = 1.0
NAME = "V01"
#: Seconds that the eyes rest on their object before they leave it again.
LEAST = 1.0


@dataclass(frozen=True, slots=True)
class Truth:
    """How it really is. `metres` is what the rangefinder should read."""

    present: bool
    looks: bool
    metres: float

    def engaged(self, near: float) -> bool:
        """Whether somebody is engaged within `near` metres."""
        return self.present and self.looks and self.metres <= near


@dataclass(frozen=True, slots=True)
class GlancesAway:
    """Glances of somebody to elsewhere: mean time between two, which is `LEAST` at least, and their
    length, evenly spread between half and one and a half times the mean. All in seconds.
    """

    apart: float
    length: float


#: Glances away. How often people do so differs widely between people, talk and task.
SHORT = GlancesAway(8.0, 0.56)
LONG = GlancesAway(8.0, 1.5)
ENGAGED = Truth(True, True, TALKS)
NOBODY = Truth(False, False, WALL)
ELSEWHERE = Truth(True, False, TALKS)


@dataclass(frozen=True, slots=True)
class Scene:
    """A scene: how it is before and after the moment at which something happens, if anything.

    `walks`: the visitor steps back slowly instead of at once; the moment is that of crossing the
    social distance. `glances` are away from the robot for who attends, and at it for who does not.
    `ghosts`: with nobody there the errors are of another kind (see `_ghost`). `named`: faces are
    recognised, too.
    """

    name: str
    before: Truth
    after: Truth
    glances: GlancesAway | None = None
    walks: bool = False
    ghosts: bool = False
    named: bool = False

    @property
    def lasts(self) -> float:
        """Seconds."""
        return CALM + WINDOW if self.before == self.after else HAPPENS + WATCHED


STAYING = Scene("staying", ENGAGED, ENGAGED, named=True)
#: They have asked something, and leave.
ASKING = Scene("asking", ENGAGED, NOBODY, named=True)
SCENES = {
    scene.name: scene
    for scene in (
        *(STAYING, ASKING),
        Scene("short glances", ENGAGED, ENGAGED, SHORT),
        Scene("long glances", ENGAGED, ENGAGED, LONG),
        Scene("nobody", NOBODY, NOBODY, ghosts=True),
        Scene("bystander", ELSEWHERE, ELSEWHERE, GlancesAway(15.0, 0.56)),
        Scene("arriving", NOBODY, ENGAGED),
        Scene("looking up", ELSEWHERE, ENGAGED),
        Scene("leaving", ENGAGED, NOBODY),
        Scene("stepping back", ENGAGED, Truth(True, True, BACK)),
        Scene("walking back", ENGAGED, Truth(True, True, BACK), walks=True),
        Scene("turning away", ENGAGED, ELSEWHERE),
    )
}


@dataclass(frozen=True, slots=True)
class SampleRow:
    """What sensors say at a time in microseconds: pairs of a sign and its sample."""

    t: int
    samples: tuple[tuple[str, float | str], ...]


@dataclass(frozen=True, slots=True)
class SceneRun:
    """A scene as it was played once. `moment`: microseconds at which something happened."""

    scene: Scene
    rows: tuple[SampleRow, ...]
    moment: int


def played(
    scene: Scene,
    chance: random.Random,
    errors: ErrorModel,
    *,
    rate: float = 3.0,
    near: float = 1.3,
    together: bool = True,
) -> SceneRun:
    """A scene with errors at `rate` samples a second, all signs `together` or each by itself."""
    period = 1.0 / rate
    moment = HAPPENS + chance.uniform(0.0, period)
    truth = _course(scene, chance, moment, near)
    faults = ErrorEpisodes(errors, chance, scene.lasts, CALM)
    sensors = _Sensors(chance, faults, near, scene.ghosts)
    signs = 4 if scene.named else 3
    phases = [0.0 if together else chance.uniform(0.0, period) for _ in range(signs)]
    readings = sorted(
        (at + phase, index)
        for at in _ticks(period, scene.lasts - period)
        for index, phase in enumerate(phases)
    )
    rows: list[SampleRow] = []
    for at, index in readings:
        t = round(at * 1e6)
        sample = sensors.read(index, at, truth(at))
        if rows and rows[-1].t == t:
            rows[-1] = SampleRow(t, (*rows[-1].samples, sample))
        else:
            rows.append(SampleRow(t, (sample,)))
    return SceneRun(scene, tuple(rows), round(moment * 1e6))


def _ticks(period: float, until: float) -> list[float]:
    return [index * period for index in range(int(until / period + 1e-9) + 1)]


def _course(
    scene: Scene, chance: random.Random, moment: float, near: float
) -> Callable[[float], Truth]:
    """How it is at any time. A glance is no end of the engagement, but the eyes are elsewhere."""
    glances = _glances(scene, chance)

    def at(seconds: float) -> Truth:
        truth = scene.after if seconds >= moment else scene.before
        if scene.walks:
            metres = near + (seconds - moment) * WALKS
            truth = Truth(True, True, min(BACK, max(TALKS, metres)))
        if any(begin <= seconds < end for begin, end in glances):
            truth = Truth(truth.present, not truth.looks, truth.metres)
        return truth

    return at


def _glances(scene: Scene, chance: random.Random) -> list[tuple[float, float]]:
    if scene.glances is None:
        return []
    found = []
    at = CALM
    mean = scene.glances.apart - LEAST
    while (at := at + LEAST + chance.expovariate(1.0 / mean)) < scene.lasts:
        length = scene.glances.length * chance.uniform(0.5, 1.5)
        found.append((at, at + length))
        at += length
    return found


class _Sensors:
    """Readings of the truth, and of what errs."""

    def __init__(
        self, chance: random.Random, faults: ErrorEpisodes, near: float, ghosts: bool
    ) -> None:
        self._chance = chance
        self._faults = faults
        self._near = near
        #: Every other ghost has eyes.
        self._eyes = chance.random() < 0.5
        self._ghosts = ghosts

    def read(self, index: int, at: float, truth: Truth) -> tuple[str, float | str]:
        """The sample of one sign: presence, gaze, distance, identity."""
        if self._ghosts:
            truth = self._ghost(at, truth)
        missed = not self._ghosts and self._faults.during("people", at)
        present = truth.present != missed
        if index == 0:
            return "presence", float(present)
        if index == 3:
            lapsed = missed or not truth.present or self._faults.during("face", at)
            return "identity", "Unknown" if lapsed else NAME
        if index == 1:
            looks = truth.looks != self._faults.during("gaze", at)
            return "gaze", float(looks and not missed and truth.present)
        if self._faults.during("distance", at):
            return "distance", self._stray(truth)
        return "distance", max(0.05, truth.metres + self._chance.gauss(0.0, NOISE))

    def _ghost(self, at: float, truth: Truth) -> Truth:
        """With nobody there the detector's errors are things that it takes for a person: they are
        near, and half of them have eyes that look.
        """
        if not self._faults.during("people", at):
            return truth
        return Truth(True, self._eyes, TALKS)

    def _stray(self, truth: Truth) -> float:
        """A reading on the wrong side: an echo that is missed as often as one from elsewhere."""
        if truth.metres > self._near:
            return self._chance.uniform(0.3, self._near)
        return self._chance.choice((math.inf, self._chance.uniform(self._near, 5.0)))
