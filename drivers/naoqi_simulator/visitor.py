"""Simulated visitors before the robot, one after the other, drawn from a seed.

A visitor comes nearer, stays for a while, looks, talks, turns away in between, and leaves. Where
somebody is at a time depends on the seed and that time alone.
"""

from __future__ import annotations

import math
import random
import re
from dataclasses import dataclass

#: Whom the robot has been taught; the others have faces without a name.
NAMES = ("Ada", "Grace", "Alan")
#: Seconds of walking up to the robot, and away.
WALK_S = 3.0
FAR_M = 2.6
#: Pepper's upper camera: half of its field of view in radians, across and upright.
HALF_ACROSS, HALF_UPRIGHT = math.radians(57.2 / 2), math.radians(44.3 / 2)
#: What they say to the robot, and answer to questions that are not about their names.
REMARKS = ("Oh, really?", "What is that over there?", "How old is it?", "That is a lot!")
ANSWERS = ("Yes, please.", "I think so.", "I do not know.", "Tell me!")
_NAME = re.compile(r"\b(your name|call you|who are you)\b", re.IGNORECASE)
_WHETHER = re.compile(r"\b(right|correct)\b", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class SimulatedPerson:
    """Somebody as the robot perceives them: metres, radians (left positive)."""

    number: int
    distance: float
    angle: float
    looking: bool
    talking: bool
    name: str = ""


def reply(name: str, sentence: str, draw: random.Random) -> str:
    """What the visitor `name` answers to a sentence of the robot."""
    if "?" not in sentence:
        return draw.choice(REMARKS)
    if re.search(rf"\b{re.escape(name)}\b", sentence, re.IGNORECASE):
        return "Yes."
    if _NAME.search(sentence):
        return f"{name}."
    return "No." if _WHETHER.search(sentence) else draw.choice(ANSWERS)


def speaking_s(text: str) -> float:
    """How long they take to say that, in seconds."""
    return max(0.8, len(text) / 12)


@dataclass(frozen=True, slots=True)
class _Doing:
    until: float
    looking: bool
    talking: bool


@dataclass(frozen=True, slots=True)
class _CurrentVisit:
    number: int
    comes: float
    stays: float
    leaves: float
    ends: float
    distance: float
    angle: float
    name: str
    doings: tuple[_Doing, ...]


class SimulatedVisitors:
    """All visits, as far as they were asked for."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._visits: list[_CurrentVisit] = []

    def at(self, seconds: float) -> SimulatedPerson | None:
        """Who is there after so many seconds of the robot."""
        while not self._visits or self._visits[-1].ends <= seconds:
            self._visits.append(self._next())
        visit = next(one for one in self._visits if seconds < one.ends)
        return None if seconds < visit.comes else _person_at(visit, seconds)

    def _next(self) -> _CurrentVisit:
        draw = self._random
        number = len(self._visits) + 1
        comes = (self._visits[-1].ends if self._visits else 0.0) + draw.uniform(4.0, 10.0)
        stays = comes + WALK_S
        doings = self._doings(stays, draw.randint(3, 6))
        leaves = doings[-1].until
        name = draw.choice(NAMES) if draw.random() < 0.5 else ""
        return _CurrentVisit(
            *(number, comes, stays, leaves, leaves + WALK_S),
            *(draw.uniform(0.8, 1.4), draw.uniform(-0.4, 0.4), name, doings),
        )

    def _doings(self, begin: float, number: int) -> tuple[_Doing, ...]:
        """Look, then talk, then perhaps turn away, and so on; the first is always a look."""
        doings: list[_Doing] = []
        for index in range(number):
            looking = index % 3 != 2
            talking = looking and index % 3 == 1
            begin += self._random.uniform(2.0, 6.0)
            doings.append(_Doing(begin, looking, talking))
        return tuple(doings)


def _person_at(visit: _CurrentVisit, now: float) -> SimulatedPerson:
    sway = 0.05 * math.sin(now * 0.8)
    if now < visit.stays:
        share = (now - visit.comes) / WALK_S
        distance = FAR_M + share * (visit.distance - FAR_M)
        return SimulatedPerson(visit.number, distance, visit.angle + sway, True, False, visit.name)
    if now >= visit.leaves:
        share = (now - visit.leaves) / WALK_S
        distance = visit.distance + share * (FAR_M - visit.distance)
        return SimulatedPerson(
            visit.number, distance, visit.angle + 0.6 * share, False, False, visit.name
        )
    doing = next(one for one in visit.doings if now < one.until)
    return SimulatedPerson(
        *(visit.number, visit.distance, visit.angle + sway),
        *(doing.looking, doing.talking, visit.name),
    )
