"""Publishes what a visitor says, as far as the robot understands it: phrases of a list.

ALSpeechRecognition knows no other words than those it is given. It is polled like all senses: its
events do not work with NAOqi 2.5 ("Invalid signature"). What it has recognised stays in ALMemory,
so it is taken out there once it was read.
"""

from __future__ import annotations

import asyncio
import contextlib
from typing import Any

from woz_drivers.naoqi_robot.memory import flag, item, within
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.senses import NAME, MemoryQuery
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.sound.noticed_speech import NoticedSpeech
from woz_tui.drivers.contract import (
    SPEECH,
    SPEECH_TEXT,
    DeviceLostError,
    DriverContext,
    DriverError,
    Offer,
)

SERVICE = "ALSpeechRecognition"
DETECTED, RECOGNIZED = "SpeechDetected", "WordRecognized"
#: How often the robot is asked whether somebody speaks, in seconds.
POLL_S = 0.1
#: What was said is known so long after its end at the latest, in microseconds.
_TEXT_WITHIN_US = 2_000_000
_FAREWELL_S = 0.5
#: A phrase is looked at up to here, in characters.
_LONGEST = 200


class RecognitionPart(NaoqiPart):
    """Tells when somebody speaks, and what, where `recognition.phrases` names what to expect."""

    name = "recognition"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._query = MemoryQuery(robot)
        self._polling = self.background("reading the robot's speech recognition")
        self._speech = NoticedSpeech(context)
        #: Whether the text of the last segment is still to come.
        self._awaited = False
        #: Whether the robot still says that somebody speaks, though their words are known.
        self._lingers = False

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Segments of speech and their texts, where there is something to recognise."""
        return Offer(sensors=(SPEECH, SPEECH_TEXT) if settings.recognition.phrases else ())

    async def connected(self) -> None:
        """Have the robot listen for the phrases."""
        if not self._settings.recognition.phrases:
            return
        await self._polling.close()
        self._query.forget()
        try:
            await self._begin()
        except DeviceLostError:
            raise
        except DriverError as error:
            self._context.sensor(SPEECH, "stale", f"{SERVICE} does not run: {error.what}")
            remedy = "is the language installed? does another program on the robot listen?"
            raise DriverError(
                f"speech is not recognised: {error.what}", error.remedy or remedy
            ) from None
        self._ready()
        self._polling.start(self._poll())

    def lost(self) -> None:
        """Nobody knows whether they speak on."""
        self._polling.cancel()
        self._speech.end("the robot is not connected")
        self._awaited = self._lingers = False
        if self._settings.recognition.phrases:
            self._context.sensor(SPEECH, "stale", "the robot is not connected")

    async def close(self) -> None:
        """The robot need not listen for us any more."""
        await super().close()
        self._speech.end("the session ended")
        if self._settings.recognition.phrases and self._link.ready:
            with contextlib.suppress(DriverError):
                await self._link.call(SERVICE, "unsubscribe", NAME, within=_FAREWELL_S)

    async def _begin(self) -> None:
        """NAOqi takes other phrases only while nobody listens, or all pause."""
        call, settings = self._link.call, self._settings.recognition
        with contextlib.suppress(DriverError):  # an earlier session may have left it
            await call(SERVICE, "unsubscribe", NAME)
        await call(SERVICE, "pause", True)
        try:
            if settings.language:
                await call(SERVICE, "setLanguage", settings.language)
            await call(SERVICE, "setVocabulary", list(settings.phrases), settings.spotting)
        finally:
            await call(SERVICE, "pause", False)
        await call(SERVICE, "subscribe", NAME)
        await self._forget()

    async def _forget(self) -> None:
        """What was read shall not be read again."""
        await self._link.call("ALMemory", "insertData", RECOGNIZED, [])

    def _ready(self) -> None:
        self._context.sensor(SPEECH, "ready", "the robot tells itself when somebody speaks")

    async def _poll(self) -> None:
        while True:
            try:
                await self._poll_once()
            except DeviceLostError:
                pass  # the connection says when it is there again
            except DriverError as error:
                self._context.sensor(SPEECH, "stale", error.what)
            else:
                self._ready()
            await asyncio.sleep(POLL_S)

    async def _poll_once(self) -> None:
        """Ask once, and publish what is new. Raises `DriverError`: words that the robot's memory
        keeps would be read again.
        """
        values = await self._query.values((DETECTED, RECOGNIZED))
        speaks = flag(values[DETECTED]) is True
        if not speaks:
            self._lingers = False
        if speaks and not self._speech.going_on and not self._lingers:
            self._start()
        phrase, confidence = recognised(values[RECOGNIZED])
        if phrase:
            await self._forget()
        if phrase and confidence >= self._settings.recognition.confidence:
            self._lingers = speaks
            self._publish_text(phrase)
            return
        if not speaks:
            self._speech.end()
        if phrase:
            self._awaited = False  # a guess at words that are not in the list

    def _start(self) -> None:
        self._awaited = True
        self._speech.begin()

    def _publish_text(self, phrase: str) -> None:
        """The text of the segment under way, of the last one, or else of one of its own."""
        speech = self._speech
        late = self._awaited and speech.now_us - speech.ended_us < _TEXT_WITHIN_US
        if not (speech.going_on or late):
            self._start()
        speech.end()
        self._awaited = False
        speech.understood(phrase, took_us=speech.now_us - speech.ended_us)


def recognised(value: Any) -> tuple[str, float]:
    """The likeliest phrase of `WordRecognized` with its confidence; an empty one for none.

    `[phrase, confidence, ...]`, the likeliest first; `<...>` stands for other words around it.
    """
    phrase, confidence = item(value, 0), within(item(value, 1), 0.0, 1.0)
    if not isinstance(phrase, str) or len(phrase) > _LONGEST or confidence is None:
        return "", 0.0
    return phrase.replace("<...>", " ").strip(), confidence
