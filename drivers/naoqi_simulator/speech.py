"""ALTextToSpeech and ALAnimatedSpeech: one voice, one text after the other."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar

from naoqi_simulator.animations import AnimationLibrary
from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld

#: Seconds from the call until the sound begins.
ONSET_S = 0.15
#: Words of which is remembered when they were said: microphones hear them a moment later.
_REMEMBERED = 8
_LIMITS = {"pitchShift": (0.0, 4.0), "speed": (50.0, 400.0), "volume": (0.0, 100.0)}


class SpeechVoice:
    """The voice: the utterance under way, its manner, and all utterances so far."""

    def __init__(self, world: SimulatedWorld) -> None:
        self._world = world
        self._turn = asyncio.Lock()
        self._generation = 0
        self._number = 0
        self.parameters = {"pitchShift": 0.0, "speed": 100.0, "doubleVoice": 0.0}
        self.volume = 0.7
        self.said: list[dict[str, object]] = []

    async def say(self, pieces: list[Piece], text: str, animations: AnimationLibrary) -> None:
        """Say the pieces when all before are said; a stop ends this one and all that wait."""
        self._number += 1
        number, generation = self._number, self._generation
        self._status(number, "enqueued")
        async with self._turn:
            if generation != self._generation:
                return self._status(number, "stopped")
            self._event("TextStarted", 1)
            self._event("CurrentSentence", text)
            self._status(number, "started")
            complete = await self._pieces(pieces, animations)
            self._event("TextDone" if complete else "TextInterrupted", 1)
            self._status(number, "done" if complete else "stopped")
        return None

    def stop(self) -> None:
        """Silence, at once."""
        self._generation += 1
        self._world.going.end("speech")

    @property
    def speaking(self) -> bool:
        """Whether a text is being said."""
        return bool(self._world.going.of("speech"))

    async def _pieces(self, pieces: list[Piece], animations: AnimationLibrary) -> bool:
        generation, last = self._generation, self._world.going.last
        complete = await last("speech", ONSET_S, "onset")
        for piece in pieces:
            if not complete or generation != self._generation:
                return False
            if isinstance(piece, Animate):
                await animations.from_speech(piece.how, piece.path)
            elif isinstance(piece, Pause):
                complete = await last("speech", piece.seconds, "pause")
            else:
                complete = await self._words(piece)
        return complete and generation == self._generation

    async def _words(self, words: Words) -> bool:
        said = {"text": words.text, **asdict(words.manner), "whole": False}
        self.said.append(said)
        seconds = words.seconds(self.parameters["speed"])
        spoke, began = self._world.spoke, self._world.time.now()
        spoke[:] = [*spoke[-_REMEMBERED:], (began, None)]
        try:
            said["whole"] = await self._world.going.last("speech", seconds, words.text)
        finally:
            spoke[-1] = (began, self._world.time.now())
        return bool(said["whole"])

    def _event(self, name: str, value: Any) -> None:
        self._world.store.raise_event(f"ALTextToSpeech/{name}", value)

    def _status(self, number: int, status: str) -> None:
        self._event("Status", [number, status])


class TextToSpeech(Service):
    """The voice without gestures."""

    name = "ALTextToSpeech"
    signals: ClassVar = {"synchroTTS": "(s)", "languageTTS": "(s)"}

    def __init__(self, voice: SpeechVoice, animations: AnimationLibrary) -> None:
        super().__init__()
        self._voice, self._animations = voice, animations
        self._language = "English"

    @offers("say(s)v")
    async def say(self, text: str) -> None:
        """Say a text; returns when it is said or stopped."""
        await self._voice.say(plain(text), text, self._animations)

    @offers("say(ss)v")
    async def say_in(self, text: str, _language: str) -> None:
        """Say a text in a language; the length is the same here."""
        await self.say(text)

    @offers("stopAll()v")
    def stop_all(self) -> None:
        """End what is being said and drop what waits."""
        self._voice.stop()

    @offers("setVolume(f)v")
    def set_volume(self, volume: float) -> None:
        """0 to 1."""
        if not 0 <= volume <= 1:
            raise CallRefusedError("ALTextToSpeech::setVolume\n\tvolume must be within [0.0, 1.0]")
        self._voice.volume = volume

    @offers("getVolume()f")
    def get_volume(self) -> float:
        """0 to 1."""
        return self._voice.volume

    @offers("setParameter(sf)v")
    def set_parameter(self, name: str, value: float) -> None:
        """Speed in percent, pitchShift 0 or 1 to 4, and others that are only kept."""
        low, high = _LIMITS.get(name, (float("-inf"), float("inf")))
        if name not in {*self._voice.parameters, *_LIMITS}:
            raise CallRefusedError(f"ALTextToSpeech::setParameter\n\tunknown parameter {name}")
        if not low <= value <= high or (name == "pitchShift" and 0 < value < 1):
            raise CallRefusedError(
                f"ALTextToSpeech::setParameter\n\t{value:g} is out of range for {name}"
            )
        self._voice.parameters[name] = value

    @offers("getParameter(s)f")
    def get_parameter(self, name: str) -> float:
        """The value set last, or the default."""
        if name not in self._voice.parameters:
            raise CallRefusedError(f"ALTextToSpeech::getParameter\n\tunknown parameter {name}")
        return self._voice.parameters[name]

    @offers("resetSpeed()v")
    def reset_speed(self) -> None:
        """Back to 100."""
        self._voice.parameters["speed"] = 100.0

    @offers("getLanguage()s")
    def get_language(self) -> str:
        """English, unless another was set."""
        return self._language

    @offers("setLanguage(s)v")
    def set_language(self, language: str) -> None:
        """Kept; the length of speech is the same in every language here."""
        if language not in self.get_available_languages():
            raise CallRefusedError(f"ALTextToSpeech::setLanguage\n\t{language} is not installed")
        self._language = language

    @offers("getAvailableLanguages()[s]")
    def get_available_languages(self) -> list[str]:
        """What is installed on this robot."""
        return ["English", "French", "German", "Japanese"]


class AnimatedSpeech(Service):
    """The voice with animations in the text; no gestures of its own are added."""

    name = "ALAnimatedSpeech"

    def __init__(self, voice: SpeechVoice, animations: AnimationLibrary) -> None:
        super().__init__()
        self._voice, self._animations = voice, animations
        self._mode = "contextual"

    @offers("say(s)v")
    async def say(self, text: str) -> None:
        """Say a text with tags; returns when it is said or stopped."""
        await self._voice.say(animated(text), text, self._animations)

    @offers("say(sm)v")
    async def say_with(self, text: str, _configuration: Any) -> None:
        """As say(s); the configuration is not simulated."""
        await self.say(text)

    @offers("setBodyLanguageModeFromStr(s)v")
    def set_mode(self, mode: str) -> None:
        """Disabled, random or contextual: only kept."""
        if mode not in ("disabled", "random", "contextual"):
            raise CallRefusedError("ALAnimatedSpeech::setBodyLanguageModeFromStr\n\tunknown mode")
        self._mode = mode

    @offers("getBodyLanguageModeToStr()s")
    def get_mode(self) -> str:
        """The mode set last."""
        return self._mode

    @offers("_stopAll(b)v")
    def stop_all(self, _blocking: bool) -> None:
        """As ALTextToSpeech.stopAll."""
        self._voice.stop()


# -- what a text for ALAnimatedSpeech says and does ------------------------------------------------
# Not shared with what the driver knows of tags (`woz_drivers.naoqi_robot.tags`), on purpose: this
# is the far end of the wire, and takes what a Pepper takes, whatever the driver lets through.

#: Letters a second at speed 100, about three words.
LETTERS_PER_S = 15.0
# Blanks around a value are taken off afterwards: beside them, the search would take hours.
_TAG = re.compile(r"\\\s*([a-z]+)\s*(?:=([^\\]*))?\\", re.IGNORECASE)
_RUN = re.compile(r"\^([A-Za-z]+)\(((?:[^()]|\([^()]*\))*)\)")
_RANGES = {"vct": (50, 200), "rspd": (50, 400), "vol": (0, 100), "pau": (0, 65535)}


@dataclass(frozen=True, slots=True)
class SpeechManner:
    """How it is said, in percent: pitch, speed, volume."""

    vct: int = 100
    rspd: int = 100
    vol: int = 100


@dataclass(frozen=True, slots=True)
class Words:
    """Words said in one manner."""

    text: str
    manner: SpeechManner

    def seconds(self, speed: float) -> float:
        """How long they take at the voice's own speed in percent."""
        return len(self.text) / LETTERS_PER_S / (self.manner.rspd / 100) / (speed / 100)


@dataclass(frozen=True, slots=True)
class Pause:
    """Silence in seconds."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Animate:
    """What is done with an animation: run, start, stop, wait, and `runTag` and so on."""

    how: str
    path: str


Piece = Words | Pause | Animate


def plain(text: str) -> list[Piece]:
    """The pieces of a text for ALTextToSpeech, which knows no animations."""
    return list(_voiced(text, SpeechManner()))


def animated(text: str) -> list[Piece]:
    """The pieces of a text for ALAnimatedSpeech; a tag's effect lasts until the end or a reset."""
    pieces: list[Piece] = []
    manner, position = SpeechManner(), 0
    for match in [*_RUN.finditer(text), None]:
        end = match.start() if match else len(text)
        pieces += _voiced(text[position:end], manner)
        manner = _manner_after(text[position:end], manner)
        if match:
            pieces.append(Animate(match[1], match[2].strip()))
            position = match.end()
    return pieces


def _voiced(text: str, manner: SpeechManner) -> Iterator[Piece]:
    position = 0
    for match in [*_TAG.finditer(text), None]:
        words = text[position : match.start() if match else len(text)].strip()
        if words:
            yield Words(words, manner)
        if match:
            manner = _changed(manner, match)
            if match[1].lower() == "pau":
                yield Pause(_number(match) / 1000)
            position = match.end()


def _manner_after(text: str, manner: SpeechManner) -> SpeechManner:
    for match in _TAG.finditer(text):
        manner = _changed(manner, match)
    return manner


def _changed(manner: SpeechManner, match: re.Match[str]) -> SpeechManner:
    name = match[1].lower()
    if name == "rst":
        return SpeechManner()
    # Tags that are not simulated are not read out either.
    return replace(manner, **{name: _number(match)}) if name in asdict(manner) else manner


def _number(match: re.Match[str]) -> int:
    """The value within its range; 100 when there is none."""
    low, high = _RANGES[match[1].lower()]
    value = (match[2] or "").strip()
    return min(high, max(low, int(value))) if value.isdigit() else 100
