"""What a simulated visitor says: a few sentences, and answers to what a robot asks strangers."""

from __future__ import annotations

import re
from random import Random

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


def reply(name: str, said: str, chance: Random) -> str:
    """What the visitor `name` says to a robot that `said` something.

    A question for the name gets the name. A question that contains it gets a yes, and a question
    whether something is right that does not gets a no.
    """
    if "?" not in said:
        return chance.choice(REPLIES + REMARKS[1:])
    if re.search(rf"\b{re.escape(name)}\b", said, re.IGNORECASE):
        return "Yes."
    if _ASKS_NAME.search(said):
        return f"{name}."
    if _asks_whether(said):
        return "No."
    return chance.choice(ANSWERS)


def _asks_whether(said: str) -> bool:
    return _WHETHER.search(said[: said.rfind("?")]) is not None


def is_about_the_name(name: str, said: str) -> bool:
    """Whether the robot asks who they are: politeness answers that, however often."""
    known = re.search(rf"\b{re.escape(name)}\b", said, re.IGNORECASE)
    return "?" in said and bool(known or _ASKS_NAME.search(said) or _asks_whether(said))


def seconds(text: str) -> float:
    """How long it takes to say that."""
    return max(_SHORTEST, len(text) / _LETTERS)
