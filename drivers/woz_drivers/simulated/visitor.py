"""A simulated person in front of the robot, and what the robot's sensors make of them.

A pure model, moved by asking for the time: `step(t)` returns every sample up to `t` seconds. It
has no clock and no task, and all chance comes from its seed, so that the same seed gives the same
samples whatever the steps. What a person decides depends on the seed, the visit and what it is they
decide, never on what was drawn before; and they react in whole ticks to a robot that speaks. So a
real clock, which is never quite on time, changes nothing about the course of their visits.
"""

from __future__ import annotations

import enum
import math
import re
from collections import Counter
from random import Random

from woz_drivers.simulated.microphone import SpeechInProgress, SpeechSegmenter
from woz_drivers.simulated.senses import (
    DOOR,
    THRESHOLD,
    TICK,
    Sample,
    SimulatedSensors,
    VisitorView,
)
from woz_tui.drivers.face_store import key_of

# -- words ----------------------------------------------------------------------------------------
# What a simulated visitor says: a few sentences, and answers to what a robot asks strangers.

REMARKS = (
    "Hello!",
    "What is that over there?",
    "How big is it?",
    "Where did it live?",
    "When do you close?",
    "May I take a photograph?",
    "How old is it?",
    "Is there more to see?",
)
ANSWERS = ("Yes, please.", "I think so.", "I do not know.", "About a hundred years?", "Tell me!")
REPLIES = ("Oh, really?", "I did not know that.", "That is a lot!", "And what does it eat?")
GOODBYE = "Thank you, goodbye!"

#: Letters a second, and the shortest utterance in seconds.
_LETTERS, _SHORTEST = 12.0, 0.8

_ASKS_NAME = re.compile(r"\byour name\b|\bcall you\b|\bwho are you\b", re.IGNORECASE)
_WHETHER = re.compile(r"\b(right|correct)\b", re.IGNORECASE)


def reply(name: str, robot_text: str, chance: Random) -> str:
    """The answer of the visitor `name` to `robot_text`, which the robot said.

    A question for the name gets the name. A question that contains it gets a yes, and a question
    whether something is right that does not gets a no.
    """
    if "?" not in robot_text:
        return chance.choice(REPLIES + REMARKS[1:])
    if re.search(rf"\b{re.escape(name)}\b", robot_text, re.IGNORECASE):
        return "Yes."
    if _ASKS_NAME.search(robot_text):
        return f"{name}."
    if _asks_whether(robot_text):
        return "No."
    return chance.choice(ANSWERS)


def _asks_whether(robot_text: str) -> bool:
    return _WHETHER.search(robot_text[: robot_text.rfind("?")]) is not None


def is_about_the_name(name: str, robot_text: str) -> bool:
    """Whether the robot asks who they are: politeness answers that, however often."""
    named = re.search(rf"\b{re.escape(name)}\b", robot_text, re.IGNORECASE)
    return "?" in robot_text and bool(
        named or _ASKS_NAME.search(robot_text) or _asks_whether(robot_text)
    )


def seconds(text: str) -> float:
    """How long it takes to say that."""
    return max(_SHORTEST, len(text) / _LETTERS)


# --------------------------------------------------------------------------------------------------

#: Visitors whom the robot knows by their faces, and those whom it does not.
PEOPLE, STRANGERS = ("V1", "V2"), ("Kim", "Robin")

#: From here a face can be recognised and learnt, in metres.
FACE_RANGE = 2.2

#: Seconds of looking until a face is recognised.
_RECOGNISED_AFTER = 0.6

#: Nobody walks away before they have waited so long for an answer, in seconds.
_WAITS_FOR_ANSWER = 6.0

#: A robot that begins to speak up to so much before a tick began at it, in seconds.
_PUNCTUALITY = 0.02

#: People notice that a robot has ended at whole multiples of this, in ticks.
_NOTICED = 5

_NEVER = 2**62


class VisitPhase(enum.Enum):
    """What the person is doing as a whole."""

    AWAY = "away"
    COMING = "coming"
    STAYING = "staying"
    DOUBTING = "stepped back"
    GOING = "going"


class SimulatedVisitor:
    """Comes, looks, talks, answers, looks away, steps back, leaves, and comes again."""

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._senses = SimulatedSensors(seed)
        #: The microphone that hears them.
        self.hearing = SpeechSegmenter(THRESHOLD, TICK)
        self._speech: list[SpeechInProgress] = []
        self._faces = {person: person for person in PEOPLE}
        self._tick = 0
        self._visit = 0
        self._drawn: Counter[str] = Counter()
        self.phase = VisitPhase.AWAY
        self.person = ""
        self.distance = DOOR
        self._goal = DOOR
        #: Where they stand, in degrees to the left.
        self.side = 0.0
        self._phase_ends = self._ticks("away", 2.0, 4.0)
        self.looking = False
        self._looking_ends = 0
        self._talk_begins, self._talk_ends = _NEVER, 0
        self._talk_again = _NEVER
        self._words = ""
        self._patience = 0
        self._near_since = _NEVER

    @property
    def present(self) -> bool:
        """Whether somebody is there."""
        return self.phase is not VisitPhase.AWAY

    @property
    def talking(self) -> bool:
        """Whether the person is saying something now."""
        return self._talk_begins <= self._tick < self._talk_ends

    def step(self, t: float) -> list[Sample]:
        """All samples after the last step up to `t` seconds, oldest first."""
        samples: list[Sample] = []
        while (self._tick + 1) * TICK <= t + 1e-9:
            self._tick += 1
            self._live()
            samples += self._sensed()
        return samples

    def speech(self) -> list[SpeechInProgress]:
        """What the microphone made of their voice since this was asked last."""
        speech, self._speech = self._speech, []
        return speech

    def hear(self, begins: float, seconds: float, text: str = "") -> None:
        """The robot says `text` from `begins` on, for `seconds`: a person who is near looks up and
        answers 1-2 s later. After some answers they thank, and go, whatever is said to that.
        """
        taking_leave = self._patience < 0 and self._tick >= self._talk_begins
        if taking_leave or not self._listens:
            return
        spoken = math.floor((begins + _PUNCTUALITY) / TICK) + math.ceil(seconds / TICK - 1e-6)
        ends = -(-spoken // _NOTICED) * _NOTICED
        dice = self._dice("answer")
        self.looking = True
        self._looking_ends = ends + _ticks_in(dice.uniform(3.0, 6.0))
        if not is_about_the_name(self.person, text):
            self._patience -= 1
        goodbye = self._patience < 0
        robot_text = GOODBYE if goodbye else reply(self.person, text, dice)
        self._talk(ends + _ticks_in(dice.uniform(1.0, 2.0)), robot_text)
        if goodbye:
            self._phase_ends = self._talk_ends + _ticks_in(1.0)

    def learn_face(self, name: str) -> bool:
        """Recognise the present person as `name` from now on; False if nobody shows a face."""
        if not self.present or self.distance >= FACE_RANGE or self.phase is VisitPhase.GOING:
            return False
        self._faces[self.person] = name
        return True

    def forget_face(self, name: str) -> bool:
        """Recognise nobody as `name` any more; False if nobody was."""
        kept = {one: face for one, face in self._faces.items() if key_of(face) != key_of(name)}
        forgotten = len(kept) < len(self._faces)
        self._faces = kept
        return forgotten

    def recognised_as(self, name: str) -> bool:
        """Whether somebody else's face has this name already."""
        return any(name == face for one, face in self._faces.items() if one != self.person)

    # -- the person ---------------------------------------------------------------------------

    @property
    def _listens(self) -> bool:
        near = self.phase is VisitPhase.COMING and self.distance < FACE_RANGE
        return near or self.phase in (VisitPhase.STAYING, VisitPhase.DOUBTING)

    def _dice(self, decision: str) -> Random:
        """Chance for the next decision of a kind in this visit."""
        self._drawn[decision] += 1
        return Random(f"{self._seed} {self._visit} {decision} {self._drawn[decision]}")

    def _ticks(self, decision: str, low: float, high: float) -> int:
        """A duration between `low` and `high` seconds."""
        return _ticks_in(self._dice(decision).uniform(low, high))

    def _live(self) -> None:
        if self._tick >= self._phase_ends:
            self._next_phase()
        self._walk()
        if self.phase in (VisitPhase.STAYING, VisitPhase.DOUBTING):
            self._attend()
        if self._tick == self._talk_begins:
            self.hearing.words(self._words)
        if not (self.present and self.looking and self.distance < FACE_RANGE):
            self._near_since = _NEVER
        elif self._near_since == _NEVER:
            self._near_since = self._tick

    def _next_phase(self) -> None:
        if self.phase is VisitPhase.AWAY:
            self._arrive()
        elif self.phase is VisitPhase.COMING:
            self._enter(VisitPhase.STAYING, self._goal, self._ticks("stay", 15.0, 35.0))
            if self._talk_again == _NEVER:
                self._talk_again = self._tick + self._ticks("talk again", 2.0, 7.0)
        elif self.phase is VisitPhase.STAYING and self._stays("step back", 0.45):
            back = self._dice("back").uniform(1.6, 2.3)
            self._enter(VisitPhase.DOUBTING, back, self._ticks("doubt", 4.0, 8.0))
        elif self.phase is VisitPhase.DOUBTING and self._stays("come back", 0.5):
            near = self._dice("near").uniform(0.8, 1.2)
            self._enter(VisitPhase.STAYING, near, self._ticks("stay", 10.0, 25.0))
        elif self.phase is VisitPhase.GOING:
            self._enter(VisitPhase.AWAY, DOOR, self._ticks("away", 6.0, 15.0))
        else:
            self._enter(VisitPhase.GOING, DOOR + 0.2, _ticks_in(10.0))
            self.looking = False
            self._talk_begins = _NEVER

    def _stays(self, decision: str, share: float) -> bool:
        """Whether they do that rather than go; nobody who has said goodbye does."""
        return self._patience >= 0 and self._dice(decision).random() < share

    def _arrive(self) -> None:
        self._visit += 1
        self._drawn.clear()
        self._enter(VisitPhase.COMING, self._dice("near").uniform(0.85, 1.15), _ticks_in(12.0))
        self.distance = DOOR
        self.side = self._dice("side").uniform(-25.0, 25.0)
        self.person = self._dice("person").choice(PEOPLE + STRANGERS)
        self._patience = self._dice("patience").randint(1, 3)
        self.looking = False
        self._looking_ends = self._tick + self._ticks("first look", 0.5, 2.5)
        self._talk_begins, self._talk_ends, self._talk_again = _NEVER, 0, _NEVER

    def _enter(self, phase: VisitPhase, goal: float, ticks: int) -> None:
        self.phase = phase
        self._goal = goal
        self._phase_ends = self._tick + ticks

    def _walk(self) -> None:
        if self.phase is VisitPhase.AWAY:
            return
        pace = 0.65 if self.phase in (VisitPhase.COMING, VisitPhase.GOING) else 0.35
        self.distance += min(max(self._goal - self.distance, -pace * TICK), pace * TICK)
        arrived = abs(self._goal - self.distance) < 1e-6
        if arrived and self.phase in (VisitPhase.COMING, VisitPhase.GOING):
            self._phase_ends = min(self._phase_ends, self._tick)
        if self.phase is VisitPhase.COMING and self._tick >= self._looking_ends:
            self.looking = True

    def _attend(self) -> None:
        if self._tick >= self._looking_ends and not self.talking:
            self.looking = not self.looking
            stay = (4.0, 9.0) if self.looking else (0.8, 2.5)
            self._looking_ends = self._tick + self._ticks("look", *stay)
        if self._tick >= self._talk_again and self.looking:
            self._talk(self._tick, self._dice("remark").choice(REMARKS))

    def _talk(self, begins: int, text: str) -> None:
        """Say `text` from `begins` on, and nothing more by themselves for a while after it."""
        self._words = text
        self._talk_begins, self._talk_ends = begins, begins + _ticks_in(seconds(text))
        self._talk_again = self._talk_ends + self._ticks("talk again", 8.0, 16.0)
        self._phase_ends = max(self._phase_ends, self._talk_ends + _ticks_in(_WAITS_FOR_ANSWER))

    # -- the sensors --------------------------------------------------------------------------

    def _sensed(self) -> list[Sample]:
        face = self._faces.get(self.person, "")
        recognised = self._tick - self._near_since > _RECOGNISED_AFTER / TICK
        samples = self._senses.sensed(
            self._tick,
            VisitorView(
                distance=self.distance if self.present else None,
                looking=self.looking,
                talking=self.talking,
                side=self.side,
                face=face if recognised else "",
            ),
        )
        loudness = next(sample.value for sample in samples if sample.sensor == "loudness")
        self._speech += self.hearing.add(loudness or 0.0)
        return samples


def _ticks_in(seconds: float) -> int:
    return max(1, round(seconds / TICK))
