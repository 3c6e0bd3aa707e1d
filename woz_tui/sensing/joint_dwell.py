"""How the thirty-six states of the joint filter change as time passes: mean dwell times as rates.

Rates are averages of behaviour and of sensors, per second. They are rounded numbers, chosen so
that the filter's decisions come where a person would take them, and tested with errors that have
other numbers. `docs/explanation/engagement-filters.md` has the reasons and what doubling them does.

Four things happen independently in a step: somebody moves nearer or away, turns to the robot or
away, comes or goes, and a reading becomes wrong or right again. Each is solved exactly for the
step's length; the steps are so short that the order in which they are taken matters little.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

WORLDS = 6
#: Readings: right; the detector wrong; the gaze wrong (or a glance), and still so; a stray
#: distance; all blind, or a phantom if nobody is there. A glance has two phases, because glances
#: differ less in length than a single one (an exponential distribution) would make them.
CONDITIONS = 6
#: Microseconds; a pause longer than this changes nothing more.
LONGEST = 3_600_000_000

# Behaviour, as mean times in seconds. A visitor of an exhibit stays for about a minute.
STAYS = 60.0
EMPTY = 60.0
STANDS_NEAR = 60.0
COMES_NEAR = 20.0
FURNITURE = 120.0  # something near that is nobody appears or disappears
ATTENDS = 120.0
LOOKS_UP = 40.0
#: Shares of those who come: already near, already looking; and of those who go: out of reach.
COME_NEAR = 0.5
COME_LOOKING = 0.5
GO_FAR = 0.99

# What fools the readings: mean time between two, and how long one lasts.
MISSED = (40.0, 0.3)
# Between two glances away of somebody who attends, and between two at the robot of somebody who
# does not. How long they last is a setting.
GLANCES = 7.0
PEEKS = 8.0
GHOST_LOOKS = (60.0, 0.3)
STRAY = (20.0, 0.25)
BLIND = (20.0, 0.25)
PHANTOM = (70.0, 0.25)  # nobody is there, and everything says that somebody attends


@dataclass(frozen=True, slots=True)
class DwellSteps:
    """Shares that change in a step of one length."""

    nearer: float
    away: float
    placed: float
    up: float
    turned: float
    come: float
    go: float
    wrong: tuple[tuple[float, ...], ...]  # by nobody, somebody, attending: missed, away, ...
    right: tuple[tuple[float, ...], ...]
    stay: tuple[tuple[float, float], ...]  # by the same: of a glance's phase, and to its second


class Dwell:
    """The rates of one filter, and the shares for the lengths of step that came last."""

    def __init__(self, glance: float) -> None:
        self._faults = (
            (MISSED, GHOST_LOOKS, STRAY, PHANTOM),
            (MISSED, (PEEKS, glance), STRAY, BLIND),
            (MISSED, (GLANCES, glance), STRAY, BLIND),
        )
        self._steps_by_ms: dict[int, DwellSteps] = {}

    def steps(self, elapsed: int) -> DwellSteps:
        """The shares for so many microseconds."""
        found = self._steps_by_ms.get(elapsed)
        if found is None:
            if len(self._steps_by_ms) >= 64:
                self._steps_by_ms.clear()
            found = self._steps_by_ms[elapsed] = self._solve(elapsed / 1e6)
        return found

    def _solve(self, seconds: float) -> DwellSteps:
        nearer, away = between(1.0 / COMES_NEAR, 1.0 / STANDS_NEAR, seconds)
        up, turned = between(1.0 / LOOKS_UP, 1.0 / ATTENDS, seconds)
        come, go = between(1.0 / EMPTY, 1.0 / STAYS, seconds)
        placed, _ = between(1.0 / FURNITURE, 1.0 / FURNITURE, seconds)
        pairs = [
            [between(1.0 / apart, 1.0 / lasts, seconds) for apart, lasts in faults]
            for faults in self._faults
        ]
        return DwellSteps(
            *(nearer, away, placed, up, turned, come, go),
            wrong=tuple(tuple(wrong for wrong, _ in row) for row in pairs),
            right=tuple(tuple(right for _, right in row) for row in pairs),
            stay=tuple(_phases(faults[1][1], seconds) for faults in self._faults),
        )


def after_steps(shares: Sequence[float], dwell: Dwell, elapsed: int) -> list[float]:
    """The probabilities after `elapsed` microseconds without a sample."""
    step = dwell.steps(min(elapsed, LONGEST))
    worlds = [shares[at : at + CONDITIONS] for at in range(0, len(shares), CONDITIONS)]
    # A stray distance turns out to be true for who has moved, a glance that stays is turning away.
    moved, turned = (0, 1, 2, 3, 0, 5), (0, 1, 0, 0, 4, 5)
    none_far, none_near = _exchanged(worlds[0], worlds[1], step.placed, step.placed, moved)
    idle_far, idle_near = _exchanged(worlds[2], worlds[3], step.nearer, step.away, moved)
    here_far, here_near = _exchanged(worlds[4], worlds[5], step.nearer, step.away, moved)
    idle_far, here_far = _exchanged(idle_far, here_far, step.up, step.turned, turned)
    idle_near, here_near = _exchanged(idle_near, here_near, step.up, step.turned, turned)
    worlds = _came([none_far, none_near, idle_far, idle_near, here_far, here_near], step)
    return [
        share for index, world in enumerate(worlds) for share in _erred(world, step, index // 2)
    ]


_World = Sequence[float]


def between(forward: float, back: float, seconds: float) -> tuple[float, float]:
    """The shares that go there and back between two states with these rates (per second)."""
    both = forward + back
    moved = -math.expm1(-both * seconds) / both
    return forward * moved, back * moved


def _phases(mean: float, seconds: float) -> tuple[float, float]:
    """Of the first of two phases with this mean in all: what stays there, what is in the second."""
    faded = 2.0 * seconds / mean
    stays = math.exp(-faded)
    return stays, faded * stays


def _exchanged(
    one: _World, other: _World, forward: float, back: float, become: Sequence[int]
) -> tuple[_World, _World]:
    """Two worlds of which these shares go there and back; on the way each condition of the readings
    becomes the one that `become` has in its place.
    """
    stay, rest = 1.0 - forward, 1.0 - back
    left, right = [share * stay for share in one], [share * rest for share in other]
    # Not strict: this runs at every sample.
    for condition, outgoing, incoming in zip(become, one, other):  # noqa: B905
        right[condition] += outgoing * forward
        left[condition] += incoming * back
    return left, right


def _came(worlds: list[_World], step: DwellSteps) -> list[_World]:
    """Between nobody and somebody. Whatever was wrong with the readings before is right now,
    except for a stray distance.
    """
    come, go = step.come, step.go
    far, near = worlds[0], worlds[1]
    come_far, come_near = sum(far) * come, sum(near) * come
    come_near += come_far * COME_NEAR
    come_far *= 1.0 - COME_NEAR
    went_far = (sum(worlds[2]) + sum(worlds[4])) * go
    went_near = (sum(worlds[3]) + sum(worlds[5])) * go
    went_far += went_near * GO_FAR
    went_near *= 1.0 - GO_FAR
    return [
        _scaled(far, 1.0 - come, went_far),
        _scaled(near, 1.0 - come, went_near),
        _scaled(worlds[2], 1.0 - go, come_far * (1.0 - COME_LOOKING)),
        _scaled(worlds[3], 1.0 - go, come_near * (1.0 - COME_LOOKING)),
        _scaled(worlds[4], 1.0 - go, come_far * COME_LOOKING),
        _scaled(worlds[5], 1.0 - go, come_near * COME_LOOKING),
    ]


def _scaled(world: _World, stay: float, more: float) -> _World:
    """What stays, and `more` whose readings are right."""
    scaled = [share * stay for share in world]
    scaled[0] += more
    return scaled


def _erred(world: _World, step: DwellSteps, who: int) -> _World:
    """Readings become wrong, and right again; a glance has its second phase after its first."""
    w0, w1, w2, w3, w4, w5 = world
    missed, away, stray, blind = step.wrong[who]
    found, _, true, sees = step.right[who]
    stay, second = step.stay[who]
    back = w2 * (1.0 - stay - second) + w3 * (1.0 - stay)
    return (
        w0 * (1.0 - (missed + away + stray + blind)) + w1 * found + back + w4 * true + w5 * sees,
        w1 * (1.0 - found) + w0 * missed,
        w2 * stay + w0 * away,
        w3 * stay + w2 * second,
        w4 * (1.0 - true) + w0 * stray,
        w5 * (1.0 - sees) + w0 * blind,
    )
