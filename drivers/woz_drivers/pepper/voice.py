"""The voice: speaking with gestures or without, reading a text out, and how it sounds.

`say` ends when the robot has finished speaking: the call itself returns then. The event
`ALTextToSpeech/TextDone` would tell the same later and not reliably: subscribing to it fails with
NAOqi 2.5.8 to 2.5.10, and asking for it over and over costs calls that a stop had to wait behind.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from woz_drivers.pepper import memory, speech_text
from woz_drivers.pepper.parts import Part, Robot
from woz_drivers.pepper.parts_calls import LONG_S, Call, Endings, answers, apply
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tags import problems
from woz_drivers.simulated.values import number, text
from woz_tui.core.driver import Argument, DriverError, Job, Outlet, Rejected, Scope, Verb
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json

TTS = "ALTextToSpeech"
LANE, SETTINGS_LANE = "voice", "voice-settings"
VOLUME, SPEED, PITCH = Range(0, 1), Range(50, 400, "%"), Range(0, 4)
#: NAOqi's names of its parameters.
_PARAMETERS = {"speech_speed": "speed", "speech_pitch": "pitchShift"}
_NAMES = ("volume", *_PARAMETERS)


class Voice(Part):
    """Text to speech; one utterance at a time."""

    name = "speech"

    def __init__(self, robot: Robot, settings: PepperSettings, outlet: Outlet) -> None:
        super().__init__(robot, settings, outlet)
        voice = settings.voice
        #: Asked for last, by the robot file or by a command: set again after a loss.
        self._asked: dict[str, float] = {}
        for name, value in zip(_NAMES, (voice.volume, voice.speed, voice.pitch), strict=True):
            if value is not None:
                self._asked[name] = float(value)
        self._endings = Endings()
        #: In per cent, as last read; only the expected duration depends on it.
        self._speed = settings.voice.speed or 100.0

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """`say` and `read`, and the three settings of the voice."""
        plain = Argument("plain", "flag", "without gestures", default=False)
        return (
            Verb(
                "say",
                "speak a sentence; tags for voice and gestures count",
                (Argument("text", "text", "what to say", required=True), plain),
                lane=LANE,
                limit_s=300.0,
            ),
            Verb(
                "read",
                "read a text file out, paragraph by paragraph",
                (
                    Argument("file", "file", "a text file, relative to the experiment", True),
                    plain,
                ),
                lane=LANE,
                limit_s=3600.0,
            ),
            _setting("volume", "level", "how loud it speaks, 0 to 1", VOLUME),
            _setting("speech_speed", "percent", "how fast it speaks, 100 is normal", SPEED),
            _setting("speech_pitch", "pitch", "0: its own voice; 1 to 4 times that", PITCH),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Speak, or change how it speaks."""
        match job.verb:
            case "say":
                return await self._say(job)
            case "read":
                return await self._read(job)
            case "volume":
                return await self._set(job, "level", VOLUME)
            case "speech_speed":
                return await self._set(job, "percent", SPEED)
            case "speech_pitch":
                pitch = _inside(job, "pitch", PITCH)
                if 0 < pitch < 1:
                    raise Rejected(f"there is no pitch {pitch:g}", "0 is its own, 1 to 4 shift it")
                return await self._set(job, "pitch", PITCH)
        raise Rejected(f"the voice cannot {job.verb!r}")

    async def stop(self, scope: Scope) -> tuple[str, ...]:
        """Fall silent."""
        if scope is not Scope.ALL:
            return ()
        await self._robot.call(TTS, "stopAll")
        return (self.name,)

    async def connected(self) -> None:
        """Apply what the robot file says of the voice, or the wizard since."""
        await apply(
            self._outlet,
            {name.replace("_", " "): self._call(name, to) for name, to in self._asked.items()},
        )

    async def read(self) -> Mapping[str, Json]:
        """Volume (0 to 1), speed (per cent) and pitch as the robot has them."""
        ask, before = self._robot.ask, self._speed
        values = await answers(
            {
                "volume": ask(TTS, "getVolume"),
                "speech_speed": ask(TTS, "getParameter", "speed"),
                "speech_pitch": ask(TTS, "getParameter", "pitchShift"),
            }
        )
        told = {name: memory.number(value) for name, value in values.items()}
        read = {name: round(value, 3) for name, value in told.items() if value is not None}
        if self._speed == before and SPEED.contains(read.get("speech_speed", 0.0)):
            self._speed = read["speech_speed"]  # else it was set while the robot was asked
        return dict(read)

    async def close(self) -> None:
        """End what is on its way."""
        await self._endings.close()

    # -- speaking --------------------------------------------------------------------------------

    async def _say(self, job: Job) -> dict[str, Json]:
        said = text(job.args, "text")
        if not said.strip():
            raise Rejected("there is nothing to say", "write a text")
        self._warn(said)
        await self._endings.settled()
        job.expects(speech_text.seconds(said, self._speed))
        await self._utter(said, job.args.get("plain") is True)
        return {"text": said}

    async def _read(self, job: Job) -> dict[str, Json]:
        path = self._outlet.folder / text(job.args, "file")
        whole = await asyncio.to_thread(speech_text.read_text, path)
        parts = speech_text.paragraphs(whole)
        if not parts:
            raise Rejected(f"{path} has no text in it", "write something into it")
        self._warn(whole)
        await self._endings.settled()
        for position, part in enumerate(parts):
            job.expects(sum(speech_text.seconds(left, self._speed) for left in parts[position:]))
            try:
                await self._utter(part, job.args.get("plain") is True)
            except DriverError as error:
                where = f"paragraph {position + 1} of {len(parts)}"
                raise type(error)(f"{where}: {error.what}", error.remedy) from error
        return {"file": str(job.args["file"]), "paragraphs": len(parts)}

    async def _utter(self, said: str, plain: bool) -> None:
        service = TTS if plain else "ALAnimatedSpeech"
        try:
            await self._robot.call(service, "say", said, within=LONG_S)
        except asyncio.CancelledError:
            self._endings.send(self._robot.call(TTS, "stopAll"))
            raise

    def _warn(self, said: str) -> None:
        """Tags that the robot will not understand; what is said stays as it was written."""
        for problem in problems(said):
            remedy = "correct the tag in the text"
            self._outlet.notice("warning", problem, remedy, tells=("request",))

    async def _set(self, job: Job, argument: str, allowed: Range) -> dict[str, Json]:
        value = _inside(job, argument, allowed)
        await self._call(job.verb, value)
        self._asked[job.verb] = value
        if job.verb == "speech_speed":
            self._speed = value
        return {argument: value}

    def _call(self, name: str, value: float) -> Call:
        if name == "volume":
            return self._robot.call(TTS, "setVolume", value)
        return self._robot.call(TTS, "setParameter", _PARAMETERS[name], value)


def _setting(verb: str, argument: str, summary: str, allowed: Range) -> Verb:
    takes = (Argument(argument, "number", summary, required=True, range=allowed),)
    return Verb(verb, f"set {summary}", takes, lane=SETTINGS_LANE, limit_s=5.0, brief=True)


def _inside(job: Job, argument: str, allowed: Range) -> float:
    value = number(job.args, argument)
    if not allowed.contains(value):
        raise Rejected(f"{job.verb} takes {allowed}, not {value:g}")
    return value
