"""Speech and sounds on the robot's loudspeaker: synthesised or found here, sent once, played there.

The daemon has one player, and a new sound ends the one before: so both share a lane. It does not
say when a sound has ended; a sound lasts as long as its file.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import aiohttp

from woz_drivers.reachy_mini.body import ReachyBody
from woz_drivers.reachy_mini.daemon_link import QUICK_S, UPLOAD_S, DaemonLink, ReachyPart
from woz_drivers.reachy_mini.settings import LOUDSPEAKER, SETTINGS, ReachyMiniSettings
from woz_drivers.sound import live_talk
from woz_drivers.sound.live_talk import LiveTalk, program_loudspeaker
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.settings import VOICE_ARGUMENTS, VoiceChoice
from woz_drivers.speech.synthesis import SpeechSynthesis, read_wav, spoken_text
from woz_drivers.speech.uttering import forecast, told, uttered
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
)
from woz_tui.drivers.robot_parts import Pending, RefusalAllowed
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.motion.emotions import FEELINGS
from woz_tui.motion.safety import finite_number
from woz_tui.protocol import markup
from woz_tui.protocol.messages import Json

#: A robot without sound that is no simulation must not seem to speak.
_NO_SOUND = DriverError(
    "the robot's daemon runs without sound",
    "start it without --no-media, or look at its log",
)


_VOICE = "voice"


class ReachySounds(ReachyPart):
    """The loudspeaker; one sound at a time."""

    name = "sound"
    SETTINGS = (SETTINGS["volume"],)

    def __init__(
        self,
        link: DaemonLink,
        settings: ReachyMiniSettings,
        context: DriverContext,
        body: ReachyBody,
    ) -> None:
        super().__init__(link, settings, context)
        self._body = body
        self._voice = settings.voice
        self._synthesis = SpeechSynthesis(settings.voice, context.folder, self._voice_moved)
        #: Names of files that the robot has; it forgets them when it is switched off.
        self._sent: set[str] = set()
        self._tidying = BackgroundTasks("a sound that was cut short")
        self._audible = False
        #: Of the robot's loudspeaker, 0 to 1; None: it does not say.
        self._level: float | None = None
        self._talk: LiveTalk | None = None
        if (talk := settings.talk) is not None:
            words = functools.partial(talk.play_words, LOUDSPEAKER)
            self._talk = LiveTalk(talk, context, program_loudspeaker(words, context))

    @classmethod
    def offer(cls, settings: ReachyMiniSettings) -> Offer:
        """`say`, `sound`, `volume`; `talk` and `end_talk` where the file says so, with how old a
        voice is when it is sent.
        """
        talk = live_talk.offered(settings.talk)
        return replace(
            talk,
            verbs=(
                common_verb(
                    "say",
                    "speak a sentence with a voice made on this machine",
                    *VOICE_ARGUMENTS,
                    markup=("pause",),
                ),
                common_verb("sound", "play a WAV file on the robot", lane=_VOICE),
                common_verb("utter", choices=FEELINGS, lane=_VOICE),
                SETTINGS["volume"].changed_by(),
                *talk.verbs,
            ),
        )

    @property
    def heard(self) -> bool:
        """Whether something of ours is to be heard now, which is nobody's speech."""
        return self._audible or (self._talk is not None and self._talk.on)

    def start(self) -> None:
        """Load the program that makes the voice, if there is one that stays loaded."""
        self._synthesis.start()
        if self._talk is not None:
            self._talk.start()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """How long speech and sounds are; speech is made ready for that."""
        match verb:
            case "say":
                text = spoken_text(str(args["text"]))
                made = await self._synthesis.utterance(text, self._choice(args))
                return Forecast(made.sound.seconds)
            case "utter":
                return forecast(args)
            case "sound":
                file = self._context.folder / str(args["file"])
                return Forecast((await asyncio.to_thread(read_wav, file)).seconds)
        return Forecast()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Ends when it has been heard."""
        if self._talk is not None and job.verb in live_talk.NAMES:
            return await self._talk.perform(job)
        match job.verb:
            case "say":
                return await self._say(job)
            case "sound":
                return await self._sound(job)
            case "utter":
                return await self._utter(job)
            case "volume":
                self._level = await self._set_volume(job.args["level"])
                return {"level": self._level}
        return await super().perform(job)

    async def halt(self, scope: Scope) -> Pending:
        """Now, and when no move is left that begins a sound of its own, as waking up does. While
        nobody watches only who talks live falls silent.
        """
        if self._talk is not None:
            await self._talk.stop()
        if scope is Scope.DRIVE:
            return ()
        await self.stop()
        if self._body.ended is not None:
            await asyncio.shield(self._body.ended)
        await self.stop()
        return ()

    async def connected(self) -> None:
        """Ask how loud it is."""
        self._level = await self._volume()

    def fail(self, error: DeviceLostError) -> None:
        """The robot is gone: who talks is not heard any more."""
        if self._talk is not None:
            self._talk.fail(error)

    def shown(self) -> Mapping[str, Json]:
        """How loud it is."""
        return {"volume": self._level}

    def _voice_moved(self, state: str, why: str, remedy: str) -> None:
        if state == "lost":
            self._context.notice("warning", why, remedy)

    async def _say(self, job: Job) -> Mapping[str, Json]:
        """Speak; ends when the sound has ended."""
        text = spoken_text(str(job.args["text"]))
        utterance = await self._synthesis.utterance(text, self._choice(job.args))
        heard = await self._play(job, utterance.sound)
        return {"text": markup.sentence(text), "source": utterance.source} | heard

    async def _sound(self, job: Job) -> Mapping[str, Json]:
        """Play a file of this machine."""
        file = str(job.args["file"])
        wav = await asyncio.to_thread(read_wav, self._context.folder / Path(file))
        return {"file": file} | await self._play(job, wav)

    async def _utter(self, job: Job) -> Mapping[str, Json]:
        """A sound of a mood, made here."""
        sound = await uttered(job.args, self._context.folder)
        return told(job.args, sound) | await self._play(job, sound)

    def _choice(self, args: Mapping[str, Any]) -> VoiceChoice:
        return self._voice.choice().changed(args)

    async def prepare(self, utterances: list[Mapping[str, Json]]) -> None:
        """Synthesise what will be said, and send it to the robot."""
        try:
            for args in utterances:
                with contextlib.suppress(RejectedError):
                    text = spoken_text(str(args["text"]))
                    utterance = await self._synthesis.utterance(text, self._choice(args))
                    if self._link.ready and not self._link.status.silent:
                        await self._deliver(utterance.sound)
        except DeviceLostError:
            return
        except DriverError as error:
            text = f"speech not prepared: {error.what}"
            self._context.notice("warning", text, error.remedy, tells=("request",))

    async def _volume(self) -> float | None:
        """Of its loudspeaker, 0 to 1; None: it does not say. Raises `DeviceLostError`."""
        percent = None
        with RefusalAllowed():
            answer = await self._link.ask("GET", "volume/current")
            percent = finite_number(answer.get("volume")) if isinstance(answer, dict) else None
        return None if percent is None else percent / 100

    async def _set_volume(self, level: float) -> float:
        """Set the loudspeaker's volume, for all of its sounds; 0 to 1, as the robot has it then."""
        percent = round(level * 100)
        await self._link.send_volume(percent)
        found = await self._volume()
        if found is None:
            raise DriverError("the robot has no volume to set", "look at its sound")
        if abs(found - percent / 100) > 0.015:
            raise DriverError(
                f"the volume stays at {found:.0%}", "look at the sound system of the robot"
            )
        return found

    async def stop(self) -> None:
        """Fall silent, whoever began the sound; returns when the daemon has confirmed it."""
        await self._link.ask("POST", "media/stop_sound", within=QUICK_S)
        await self._tidying.settled()

    def forget(self) -> None:
        """The robot may have been switched off: it has no file of ours any more."""
        self._sent.clear()

    async def close(self) -> None:
        """End the program of the voice, and wait until a sound that was broken off has ended."""
        ending = [self._synthesis.close(), self._tidying.close()]
        if self._talk is not None:
            ending.append(self._talk.close())
        await asyncio.gather(*ending)

    async def _play(self, job: Job, wav: Wav) -> dict[str, Json]:
        status = self._link.status
        if status.silent and not status.simulated:
            raise _NO_SOUND
        await self._tidying.settled()
        name = "" if status.silent else await self._deliver(wav)
        job.expects(wav.seconds)
        self._audible = True
        beginning = asyncio.ensure_future(self._begin(name))
        try:
            await asyncio.shield(beginning)
            await self._link.pause(wav.seconds)
        except (asyncio.CancelledError, DriverError):
            self._tidying.start(self._silence(beginning))
            raise
        finally:
            self._audible = False
        return {"seconds": round(wav.seconds, 3), "heard": bool(name)}

    async def _deliver(self, wav: Wav) -> str:
        """Have the robot have this sound; the name that it has there."""
        content = await asyncio.to_thread(wav.to_bytes)
        name = f"woz-{hashlib.sha256(content).hexdigest()[:24]}.wav"
        if name not in self._sent:
            form = aiohttp.FormData()
            form.add_field("file", content, filename=name, content_type="audio/wav")
            await self._link.ask("POST", "media/sounds/upload", data=form, within=UPLOAD_S)
            self._sent.add(name)
        return name

    async def _begin(self, name: str) -> None:
        if name:
            await self._link.ask("POST", "media/play_sound", json={"file": name})

    async def _silence(self, beginning: asyncio.Future[None]) -> None:
        """End a sound that may have begun, not before the daemon has answered its beginning."""
        await asyncio.gather(beginning, return_exceptions=True)
        await self._link.ask("POST", "media/stop_sound", within=QUICK_S)
