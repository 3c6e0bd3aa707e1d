"""What a Furhat says and plays, and its voice.

An utterance tells its words as they are said, so the wizard sees how much is left. Sounds of this
machine are sent through the connection itself: the robot needs no way back to this machine.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
from collections.abc import AsyncIterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from woz_drivers.furhat.link import Exchange, FurhatLink, FurhatPart
from woz_drivers.furhat.realtime_events import (
    SpeakBuffer,
    SpeakEnded,
    SpeakStarted,
    SpeakWord,
    SystemStatus,
    VoiceStatus,
)
from woz_drivers.furhat.settings import SETTINGS, FurhatSettings, FurhatTalkSettings
from woz_drivers.sound import live_talk, pcm_audio, wav
from woz_drivers.sound.live_talk import LiveTalk, SentVoice, VoiceTally
from woz_drivers.speech.synthesis import read_wav
from woz_drivers.speech.uttering import forecast, told, uttered
from woz_tui.drivers.argument_values import file, number, text
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending, RefusalAllowed
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.drivers.sound_feeds import WIDTH
from woz_tui.motion.emotions import FEELINGS
from woz_tui.protocol import markup
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
_LONGEST_S, _LONGEST_TALK_S = 600.0, 4000.0
#: So much of a live voice the robot may have in store before more is dropped, and so long it may
#: take for the rest of it at the end, in seconds.
_BEHIND_S, _LAST_WORDS_S = 0.6, 1.0
#: How loud it is, it tells within this; an older robot does not.
_TELLS_WITHIN_S = 1.0


def _usual_s(written: str) -> float:
    """How long a text usually takes, with its pauses."""
    pieces = markup.pieces(written)
    return sum(len(piece) / _LETTERS_PER_S + pause for piece, pause in pieces)


class FurhatSpeech(FurhatPart):
    """Utterances, sounds, voice and volume."""

    name = "speech"
    SETTINGS = (SETTINGS["voice"], SETTINGS["volume"])

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._spoken: Exchange[SpeakEnded] | None = None
        #: What goes on sending a sound.
        self._sending = BackgroundTasks("a sound for the robot")
        self._voice_id = ""
        #: Asked for last, by the robot file or a command: set again after a loss.
        voice = settings.voice
        self._voice = _wish(voice.name, voice.language, voice.gender)
        #: The volume that was asked for last, and the one that the robot has; None: unknown.
        self._volume = self._robot_volume = settings.voice.volume
        self._talk: LiveTalk | None = None
        if (talk := settings.talk) is not None:
            self._talk = LiveTalk(talk, context, lambda tally: self._open(tally, talk))
        #: Whose voice is sent now.
        self._live: _LiveUtterance | None = None
        #: Such a voice, the latest, as the robot was asked to play it.
        self._live_exchange: Exchange[SpeakEnded] | None = None

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """`say`, `sound`, `voice`, `volume`; `talk` and `end_talk` where the file says so, with how
        old a voice is when it is sent.
        """
        talk = live_talk.offered(settings.talk)
        return replace(
            talk,
            verbs=(
                *talk.verbs,
                common_verb("say", limit_s=_LONGEST_S, markup=("pause",)),
                common_verb(
                    "sound",
                    "play a sound",
                    Argument("volume", "number", "of a file, 0 to 1", False, 1.0, Range(0, 1)),
                    Argument("lipsync", "flag", "move the lips to it", default=False),
                    lane=LANE,
                ),
                common_verb("utter", choices=FEELINGS, lane=LANE),
                Verb(
                    "voice",
                    "take another voice",
                    (
                        SETTINGS["voice"].taken(default=""),
                        Argument("language", "text", "such as en-US", default=""),
                        Argument("gender", "text", "as the robot's list has it", default=""),
                    ),
                    lane="voice-settings",
                    limit_s=10.0,
                ),
                SETTINGS["volume"].changed_by(lane="voice-settings", limit_s=5.0, brief=True),
            ),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Ends when the robot says that it has ended."""
        if job.verb in ("say", "sound", "utter") and self._live is not None:
            raise RejectedError("somebody talks through it live", "`end_talk` first")
        if self._talk is not None and job.verb in live_talk.NAMES:
            return await self._talk.perform(job)
        match job.verb:
            case "say":
                return await self._say(job)
            case "sound":
                return await self._sound(job)
            case "utter":
                return await self._utter(job)
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
                self._volume = self._robot_volume = level
                return {"level": level}
        return await super().perform(job)

    def hold(self, scope: Scope) -> None:
        """Send no more of a sound, or of a voice."""
        if scope is Scope.ALL:
            self._sending.cancel()
        if self._live is not None:
            self._live.voice.silence()

    async def halt(self, scope: Scope) -> Pending:
        """Fall silent, whoever speaks through it; while nobody watches only who talks live, or was
        just cut short: nothing else is heard meanwhile.
        """
        spoken = self._spoken
        going = spoken is not None and not spoken.over.done()
        live = self._live is not None or (going and spoken is self._live_exchange)
        if scope is Scope.DRIVE and not live:
            return None
        await self._link.send("request.speak.stop")
        if self._talk is not None:
            await self._talk.stop()
        return [spoken.over] if spoken is not None and going else []

    async def connected(self) -> None:
        """Set voice and volume; say nothing that was begun before."""
        await self._link.send("request.speak.stop")
        self._spoken = None
        if self._talk is not None:
            self._talk.start()
        if self._volume is not None:
            await self._link.send("request.system.config", volume=round(self._volume * 100))
        if self._voice:
            await self._take_voice(self._voice)
        else:
            status = await self._link.ask("request.voice.status", VoiceStatus, voice_list=False)
            self._voice_id = status.voice_id or ""
        self._robot_volume = self._volume
        if self._volume is None:
            await self._ask_volume()

    def lost(self) -> None:
        """Who talks is not heard any more, and has to press the key again."""
        if self._talk is not None:
            self._talk.fail(DeviceLostError("the robot is disconnected"))

    async def close(self) -> None:
        """End the program that changes a voice."""
        if self._talk is not None:
            await self._talk.close()

    def shown(self) -> Mapping[str, Json]:
        """Voice and volume."""
        known: dict[str, Json] = {"voice": self._voice_id} if self._voice_id else {}
        return known if self._robot_volume is None else {**known, "volume": self._robot_volume}

    async def _ask_volume(self) -> None:
        """A robot that does not tell it has an unknown one."""
        with RefusalAllowed():
            status = await self._link.ask("request.system.status", SystemStatus, _TELLS_WITHIN_S)
            if status.volume is not None:
                self._robot_volume = min(max(status.volume / 100, 0.0), 1.0)

    # -- a live voice --------------------------------------------------------------------------

    @contextlib.asynccontextmanager
    async def _open(
        self, tally: VoiceTally, settings: FurhatTalkSettings
    ) -> AsyncIterator[_LiveUtterance]:
        if self._spoken is not None and not self._spoken.over.done():
            raise RejectedError("it is speaking", "press the key again when it has ended")
        live = self._live = _LiveUtterance(self, tally, settings.lipsync)
        try:
            yield live
        except BaseException:
            await self._send_stop()
            raise
        finally:
            self._live = None
            await live.close()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """Speech about so long: the robot tells of each word only when it comes."""
        if verb == "say":
            return Forecast(_usual_s(text(args, "text")))
        if verb == "utter":
            return forecast(args)
        wanted = file(args, "file", self._context.folder) if verb == "sound" else "://"
        if "://" in wanted:
            return Forecast()
        return Forecast((await asyncio.to_thread(_read, wanted, 1.0)).seconds, ())

    # -- speaking ------------------------------------------------------------------------------

    async def _say(self, job: Job) -> dict[str, Json]:
        """One utterance after the other, with the pauses between them."""
        written = text(job.args, "text")
        spoken = markup.sentence(written)
        if not spoken.strip():
            raise RejectedError("there is nothing to say", "write a text")
        job.expects(_usual_s(written))
        loop = asyncio.get_running_loop()
        times: list[float] = []
        begun = loop.time()
        for piece, pause in markup.pieces(written):
            if piece:
                since = loop.time() - begun
                exchange = await self._begin(
                    "request.speak.text", text=piece, abort=False, monitor_words=True
                )
                own = await self._until_over(job, exchange, _usual_s(piece), len(piece.split()))
                times += [round(since + at, 3) for at in own]
            if pause:
                await asyncio.sleep(pause)
        return {"text": spoken, "words": [*times]}

    async def _begin(self, kind: str, **fields: Any) -> Exchange[SpeakEnded]:
        if self._spoken is not None:
            self._link.forget(self._spoken)
        also = (SpeakStarted, SpeakWord, SpeakBuffer)
        self._spoken = await self._link.begin(kind, SpeakEnded, *also, **fields)
        return self._spoken

    async def _until_over(
        self, job: Job, exchange: Exchange[SpeakEnded], usual: float, words: int
    ) -> list[float]:
        """Return when it has ended: the seconds from its beginning to each word."""
        loop = asyncio.get_running_loop()
        begun: float | None = None
        ends = loop.time() + usual
        times: list[float] = []
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
        await self._play(job, await asyncio.to_thread(_read, wanted, volume), lipsync)
        return {"file": str(job.args["file"]), "volume": volume}

    async def _utter(self, job: Job) -> dict[str, Json]:
        """A sound of a mood, made here; the lips move to it."""
        sound = await uttered(job.args, self._context.folder)
        await self._play(job, sound, True)
        return told(job.args, sound)

    async def _play(self, job: Job, sound: wav.Wav, lipsync: bool) -> None:
        """A sound of 16-bit samples of one channel."""
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

    async def begin_live(self, rate: int, lipsync: bool) -> Exchange[SpeakEnded]:
        """Begin a sound of which nobody knows how long it lasts. Raises `DeviceLostError`."""
        self._live_exchange = exchange = await self._begin(
            "request.speak.audio.start", sample_rate=rate, lipsync=lipsync
        )
        return exchange

    async def send_live(self, pcm: bytes) -> None:
        """A piece of it. Raises `DeviceLostError`."""
        await self._link.send("request.speak.audio.data", audio=base64.b64encode(pcm).decode())

    async def end_live(self) -> None:
        """It ends when it was heard. Raises `DeviceLostError`."""
        await self._link.send("request.speak.audio.end")

    async def _send_sound(self, sound: wav.Wav) -> None:
        loop = asyncio.get_running_loop()
        begun = loop.time()
        piece = 2 * round(sound.rate * _PIECE_S)
        for start in range(0, len(sound.data), piece):
            await self.send_live(sound.data[start : start + piece])
            ahead = start / (2 * sound.rate) - (loop.time() - begun)
            if ahead > _AHEAD_S:
                await asyncio.sleep(ahead - _AHEAD_S)
        await self.end_live()

    async def _take_voice(self, wish: Mapping[str, str]) -> None:
        """Raises `DriverError` if the robot speaks with a voice that is not as wished."""
        asked: dict[str, Any] = {**wish, "input_language": False}
        await self._link.ask("request.voice.config", VoiceStatus, **asked)
        status = await self._link.ask("request.voice.status", VoiceStatus)
        self._voice_id = status.voice_id or ""
        if not _is_as_wished(status, wish):
            wished = ", ".join(f"{part} {value!r}" for part, value in wish.items())
            raise DriverError(
                f"the robot has not taken a voice of {wished}, it speaks with"
                f" {self._voice_id or 'another one'}",
                "look up its voices with `woz doctor`",
            )


class _LiveUtterance:
    """A voice on its way to the robot, as one long utterance."""

    def __init__(self, speech: FurhatSpeech, tally: VoiceTally, lipsync: bool) -> None:
        self._speech = speech
        self._rate = tally.rate
        self._lipsync = lipsync
        self._exchange: Exchange[SpeakEnded] | None = None
        self._watching: asyncio.Task[None] | None = None
        #: Bytes sent of this utterance, and those that the robot has played by its own account.
        self._sent = 0
        self._played: int | None = None
        self.voice = SentVoice(tally, self._send)

    def give(self, pcm: bytes) -> None:
        """Have samples heard."""
        self.voice.give(pcm)

    async def check(self) -> None:
        """The robot has to be there, and nobody must have cut it short."""
        await self.voice.check()

    async def finish(self) -> None:
        """Return when the robot has said the rest."""
        await self.voice.finish()
        if self._exchange is not None:
            with contextlib.suppress(DriverError):
                await self._speech.end_live()
                await asyncio.wait([self._exchange.over], timeout=_LAST_WORDS_S)

    def silence(self) -> None:
        """Send nothing more."""
        self.voice.silence()

    async def close(self) -> None:
        """Nothing more is sent, nor heard of it."""
        await self.voice.close()
        if self._watching is not None:
            self._watching.cancel()
            await asyncio.wait([self._watching])

    async def _send(self, pcm: bytes) -> bool:
        if self._exchange is None or self._exchange.over.done():
            self._exchange = await self._speech.begin_live(self._rate, self._lipsync)
            self._sent, self._played = 0, None
            self._watching = asyncio.create_task(self._watch(self._exchange))
        behind = 0 if self._played is None else self._sent - self._played
        if behind > _BEHIND_S * self._rate * WIDTH:
            return False
        await self._speech.send_live(pcm)
        self._sent += len(pcm)
        return True

    async def _watch(self, exchange: Exchange[SpeakEnded]) -> None:
        """How far the robot is, and whether it was cut short: one that has ended by itself, because
        nothing came, is begun anew.
        """
        try:
            while True:
                match await exchange.next(_LONGEST_TALK_S, _silent("go on with")):
                    case SpeakBuffer(played=int(played)):
                        self._played = played
                    case SpeakEnded() as ended:
                        _judge(ended)
                        return
        except DriverError as error:
            self.voice.fail(error)


def _wish(name: str, language: str, gender: str) -> dict[str, str]:
    wish = {"name": name, "language": language, "gender": gender}
    return {key: value.strip() for key, value in wish.items() if value.strip()}


def _is_as_wished(status: VoiceStatus, wish: Mapping[str, str]) -> bool:
    """By the voice's id and, where the robot lists more than ids, by its language and gender."""
    used = status.voice_id or ""
    listed = [each for each in status.voice_list or [] if isinstance(each, dict)]
    facts = next((each for each in listed if each.get("voice_id") == used), {})
    name, language, gender = (wish.get(part, "").lower() for part in ("name", "language", "gender"))
    return (
        name in used.lower()
        and language in str(facts.get("language") or language).lower().replace("_", "-")
        and str(facts.get("gender") or gender).lower().startswith(gender)
    )


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
