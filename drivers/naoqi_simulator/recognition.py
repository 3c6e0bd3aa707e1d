"""ALSpeechRecognition, and visitors who answer what the robot says."""

from __future__ import annotations

import asyncio
import re
from typing import Any

from naoqi_simulator.senses import ExtractorService
from naoqi_simulator.service_table import CallRefusedError, offers
from naoqi_simulator.visitor import SimulatedPerson, reply, speaking_s
from naoqi_simulator.world import SimulatedWorld

DETECTED, RECOGNIZED = "SpeechDetected", "WordRecognized"
#: Confidence of a phrase that was said, and of the nearest one when none was.
SURE, GUESSED = 0.62, 0.12
#: What the robot calls those whose faces it does not know; they know their names.
STRANGERS = ("Robin", "Kim", "Sam")
#: Who stands nearer answers, and looks at the robot then.
NEAR_M = 2.0
#: So long after the robot's sentence its visitor answers, in seconds.
ANSWERS_AFTER_S = 1.2


class SpeechRecognition(ExtractorService):
    """Recognises phrases of a list that it was given, and nothing else."""

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__("ALSpeechRecognition")
        self._world = world
        self._language = "English"
        self._paused = False
        self._spotting = False
        self._answering: asyncio.Task[None] | None = None
        self._sentence = ""
        self.vocabulary: list[str] = []
        store = world.store
        store.put(DETECTED, False)
        store.put(RECOGNIZED, ["", -3.0])
        store.listen("ALTextToSpeech/CurrentSentence", self._remember)
        store.listen("ALTextToSpeech/TextDone", self._answer)

    @offers("setVocabulary([s]b)v")
    def set_vocabulary(self, phrases: list[str], spotting: bool) -> None:
        """Phrases to recognise from now on; `spotting`: within longer sentences, too."""
        if self.on and not self._paused:
            raise CallRefusedError(
                "ALSpeechRecognition::setVocabulary\n\tA grammar named modifiable_grammar already"
                " exists."
            )
        self.vocabulary, self._spotting = list(phrases), spotting

    @offers("pause(b)v")
    def pause(self, paused: bool) -> None:
        """Do not listen, or do again."""
        self._paused = paused

    @offers("setLanguage(s)v")
    def set_language(self, language: str) -> None:
        """One of those that are installed."""
        if language not in self.get_available_languages():
            raise CallRefusedError(
                f"ALSpeechRecognition::setLanguage\n\t{language} is not installed"
            )
        self._language = language

    @offers("getLanguage()s")
    def get_language(self) -> str:
        """English, unless another was set."""
        return self._language

    @offers("getAvailableLanguages()[s]")
    def get_available_languages(self) -> list[str]:
        """What is installed on this robot."""
        return ["English", "French", "German", "Japanese"]

    def say(self, text: str) -> None:
        """Let the visitor say this now."""
        self._begin(text, 0.0)

    def _remember(self, sentence: Any) -> None:
        self._sentence = str(sentence)

    def _answer(self, _: Any) -> None:
        """The robot has spoken: somebody who stands near answers, if it listens."""
        person = self._world.person()
        if self.on and person is not None and person.distance < NEAR_M:
            answer = reply(_called(person), self._sentence, self._world.random)
            self._begin(answer, ANSWERS_AFTER_S)

    def _begin(self, text: str, after: float) -> None:
        if self._answering is not None:
            self._answering.cancel()
        self._answering = asyncio.ensure_future(self._speak(text, after))

    async def _speak(self, text: str, after: float) -> None:
        world = self._world
        await world.time.sleep(after)
        world.talks = True
        self._publish(DETECTED, True)
        try:
            await world.time.sleep(speaking_s(text))
        finally:
            world.talks = False
            self._publish(DETECTED, False)
        if self.vocabulary:
            self._publish(RECOGNIZED, self._recognised(text))

    def _publish(self, key: str, value: Any) -> None:
        if self.on and not self._paused:
            self._world.store.raise_event(key, value)

    def _recognised(self, text: str) -> list[Any]:
        """The phrase with its confidence; of a word within a sentence as NAOqi marks it."""
        plain = _plain(text)
        for phrase in self.vocabulary:
            if _plain(phrase) == plain:
                return [phrase, SURE]
            if self._spotting and re.search(rf"\b{re.escape(_plain(phrase))}\b", plain):
                return [f"<...> {phrase} <...>", SURE]
        return [self.vocabulary[0], GUESSED]


def _called(person: SimulatedPerson) -> str:
    return person.name or STRANGERS[person.number % len(STRANGERS)]


def _plain(text: str) -> str:
    return " ".join(re.findall(r"\w+", text.casefold()))
