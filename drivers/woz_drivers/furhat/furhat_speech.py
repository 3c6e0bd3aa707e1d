"""What a Furhat says and plays, and its voice.

An utterance tells its words as they are said, so the wizard sees how much is left. Sounds of this
machine are sent through the connection itself: the robot needs no way back to this machine.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_drivers import pcm_audio, wav
from woz_drivers.background import BackgroundTasks
from woz_drivers.furhat.furhat_link import Exchange, FurhatLink
from woz_drivers.furhat.furhat_parts import FurhatPart
from woz_drivers.furhat.realtime_events import (
    SpeakBuffer,
    SpeakEnded,
    SpeakStarted,
    SpeakWord,
    SystemStatus,
    VoiceStatus,
)
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.simulated.argument_values import file, number, text
from woz_drivers.speech.synthesis import read_wav
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    RejectedError,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

#: One mouth: what is said and what is played wait for each other.
LANE = "voice"
#: Letters a second before anything is known of the voice; what `expects` may be wrong by.
_LETTERS_PER_S, _WRONG_BY_S = 14.0, 0.4
#: A voice in the cloud may take so long for its first word, in seconds.
_BEGINS_WITHIN_S = 15.0
#: No word, and no piece of a sound, takes longer, in seconds.
_GOES_ON_S = 60.0
#: Sound is sent in pieces of this length, and so far ahead of what is heard, in seconds.
_PIECE_S, _AHEAD_S = 0.2, 1.0
_LONGEST_S = 600.0
#: How loud it is, it tells within this; an older robot does not.
_TELLS_WITHIN_S = 1.0


class FurhatSpeech(FurhatPart):
    """Utterances, sounds, voice and volume."""

    name = "speech"

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._spoken: Exchange[SpeakEnded] | None = None
        #: What goes on sending a sound.
        self._sending = BackgroundTasks("a sound for the robot")
        self._voice_id = ""
        #: Asked for last, by the robot file or a command: set again after a loss.
        voice = settings.voice
        self._voice = _wish(voice.name, voice.language, voice.gender)
        self._volume = settings.voice.volume

    @classmethod
    def verbs(cls, settings: FurhatSettings) -> tuple[Verb, ...]:
        """`say`, `sound`, `voice`, `volume`."""
        return (
            common_verb("say", limit_s=_LONGEST_S),
            common_verb(
                "sound",
                "play a sound",
                Argument("volume", "number", "of a file, 0 to 1", False, 1.0, Range(0, 1)),
                Argument("lipsync", "flag", "move the lips to it", default=False),
                lane=LANE,
            ),
            Verb(
                "voice",
                "take another voice",
                (
                    Argument("name", "text", "its name or a part of it", default=""),
                    Argument("language", "text", "such as en-US", default=""),
                    Argument("gender", "text", "as the robot's list has it", default=""),
                ),
                lane="voice-settings",
                limit_s=10.0,
            ),
            common_verb("volume", "", lane="voice-settings", limit_s=5.0, brief=True),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Ends when the robot says that it has ended."""
        match job.verb:
            case "say":
                return await self._say(job)
            case "sound":
                return await self._sound(job)
            case "voice":
                wish = _wish(*(text(job.args, name) for name in ("name", "language", "gender")))
                if not wish:
                    raise RejectedError("no voice was named", "give name, language or gender")
                await self._take_voice(wish)
                self._voice = wish
                return {"voice": self._voice_id}
            case "volume":
                level = min(max(number(job.args, "level"), 0.0), 1.0)
                await self._link.send("request.system.config", volume=round(level * 100))
                self._volume = level
                return {"level": level}
        return await super().perform(job)

    def hold(self) -> None:
        """Send no more of a sound."""
        self._sending.cancel()

    async def halt(self) -> list[asyncio.Future[Any]]:
        """Fall silent, whoever speaks through it."""
        spoken = self._spoken
        await self._link.send("request.speak.stop")
        return [] if spoken is None or spoken.over.done() else [spoken.over]

    async def connected(self) -> None:
        """Set voice and volume; say nothing that was begun before."""
        await self._link.send("request.speak.stop")
        self._spoken = None
        if self._volume is not None:
            await self._link.send("request.system.config", volume=round(self._volume * 100))
        if self._voice:
            await self._take_voice(self._voice)
        else:
            status = await self._link.ask("request.voice.status", VoiceStatus, voice_list=False)
            self._voice_id = status.voice_id or ""
        if self._volume is None:
            await self._ask_volume()

    def shown(self) -> Mapping[str, Json]:
        """Voice and volume."""
        known: dict[str, Json] = {"voice": self._voice_id} if self._voice_id else {}
        return known if self._volume is None else {**known, "volume": self._volume}

    async def _ask_volume(self) -> None:
        """A robot that does not tell it has an unknown one."""
        try:
            status = await self._link.ask("request.system.status", SystemStatus, _TELLS_WITHIN_S)
        except DeviceLostError:
            raise
        except DriverError:
            return
        if status.volume is not None:
            self._volume = min(max(status.volume / 100, 0.0), 1.0)

    # -- speaking ------------------------------------------------------------------------------

    async def _say(self, job: Job) -> dict[str, Json]:
        spoken = text(job.args, "text")
        if not spoken.strip():
            raise RejectedError("there is nothing to say", "write a text")
        usual = len(spoken) / _LETTERS_PER_S
        job.expects(usual)
        exchange = await self._begin(
            "request.speak.text", text=spoken, abort=False, monitor_words=True
        )
        times = await self._until_over(job, exchange, usual, len(spoken.split()))
        return {"text": spoken, "words": times}

    async def _begin(self, kind: str, **fields: Any) -> Exchange[SpeakEnded]:
        if self._spoken is not None:
            self._link.forget(self._spoken)
        also = (SpeakStarted, SpeakWord, SpeakBuffer)
        self._spoken = await self._link.begin(kind, SpeakEnded, *also, **fields)
        return self._spoken

    async def _until_over(
        self, job: Job, exchange: Exchange[SpeakEnded], usual: float, words: int
    ) -> list[Json]:
        """Return when it has ended: the seconds from its beginning to each word."""
        loop = asyncio.get_running_loop()
        begun: float | None = None
        ends = loop.time() + usual
        times: list[Json] = []
        try:
            while True:
                within = _BEGINS_WITHIN_S if begun is None else _GOES_ON_S
                event = await exchange.next(within, _silent("go on with" if begun else "begin"))
                now = loop.time()
                match event:
                    case SpeakStarted():
                        begun = now
                        left = usual
                    case SpeakWord(index=index) if begun is not None and 0 <= index < words:
                        times.append(round(now - begun, 3))
                        left = (now - begun) * (words - index) / index if index else ends - now
                    case SpeakEnded():
                        _judge(event)
                        return times
                    case _:
                        continue
                if abs(now + left - ends) > _WRONG_BY_S:
                    ends = now + left
                    job.expects(max(0.0, left))
        except asyncio.CancelledError:
            await self._send_stop()
            raise
        except DeviceLostError:
            raise
        except DriverError:
            await self._send_stop()  # what did not begin in time must not begin later
            self._link.forget(exchange)
            raise

    async def _send_stop(self) -> None:
        """End it on the robot, if it is there; the next request comes behind this one."""
        self._sending.cancel()
        if self._link.ready:
            with contextlib.suppress(DeviceLostError):
                await self._link.send("request.speak.stop")

    # -- sounds --------------------------------------------------------------------------------

    async def _sound(self, job: Job) -> dict[str, Json]:
        wanted = file(job.args, "file", self._context.folder)
        lipsync = job.args.get("lipsync") is True
        if "://" in wanted:
            exchange = await self._begin(
                "request.speak.audio", url=wanted, text="AUDIO", lipsync=lipsync, abort=False
            )
            await self._until_over(job, exchange, 0.0, 0)
            return {"file": wanted}
        volume = min(max(number(job.args, "volume", 1.0), 0.0), 1.0)
        sound = await asyncio.to_thread(_read, wanted, volume)
        job.expects(sound.seconds)
        exchange = await self._begin(
            "request.speak.audio.start", sample_rate=sound.rate, lipsync=lipsync
        )
        # How it ends is told by the robot; a robot that is lost is told by the exchange.
        self._sending.start(self._send_sound(sound))
        try:
            await self._until_over(job, exchange, sound.seconds, 0)
        finally:
            self._sending.cancel()
        return {"file": str(job.args["file"]), "volume": volume}

    async def _send_sound(self, sound: wav.Wav) -> None:
        loop = asyncio.get_running_loop()
        begun = loop.time()
        piece = 2 * round(sound.rate * _PIECE_S)
        for start in range(0, len(sound.data), piece):
            data = base64.b64encode(sound.data[start : start + piece]).decode()
            await self._link.send("request.speak.audio.data", audio=data)
            ahead = start / (2 * sound.rate) - (loop.time() - begun)
            if ahead > _AHEAD_S:
                await asyncio.sleep(ahead - _AHEAD_S)
        await self._link.send("request.speak.audio.end")

    async def _take_voice(self, wish: Mapping[str, str]) -> None:
        asked: dict[str, Any] = {**wish, "input_language": False}
        status = await self._link.ask("request.voice.config", VoiceStatus, **asked)
        self._voice_id = status.voice_id or ""
        missing = [part for part in wish.values() if part.lower() not in self._voice_id.lower()]
        if "name" in wish and wish["name"] in missing:
            raise DriverError(
                f"the robot has not taken the voice {wish['name']!r}, it speaks with"
                f" {self._voice_id or 'another one'}",
                "look up its voices with `woz doctor`",
            )


def _wish(name: str, language: str, gender: str) -> dict[str, str]:
    wish = {"name": name, "language": language, "gender": gender}
    return {key: value.strip() for key, value in wish.items() if value.strip()}


def _silent(what: str) -> DriverError:
    return DriverError(
        f"the robot did not {what} an utterance", "check its voice; else restart the robot"
    )


def _judge(ended: SpeakEnded) -> None:
    """Raises `DriverError` if it was not said to its end."""
    if ended.failed:
        raise DriverError(
            "the robot could not speak or play it",
            "voices of the cloud need the internet, an address must be one that the robot reaches",
        )
    if ended.aborted:
        raise DriverError(
            "it was cut short at the robot", "does another program or person use it, too?"
        )


def _read(path: str, volume: float) -> wav.Wav:
    """A WAV file as 16-bit samples of one channel. Raises `RejectedError`; for a thread."""
    sound = read_wav(Path(path))
    samples = pcm_audio.decode(sound.data, sound.format, sound.channels)
    mono = pcm_audio.one_channel(samples, 0) * volume
    return wav.Wav("S16_LE", sound.rate, 1, pcm_audio.encode(mono, "S16_LE"))
