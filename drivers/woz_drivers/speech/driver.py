"""Speech and sound files: espeak-ng and aplay, recordings, or any programs that do the same."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections.abc import AsyncIterator, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.child_process import Child
from woz_drivers.sound import emotion_sound, live_talk
from woz_drivers.sound.live_talk import LiveTalk, program_loudspeaker
from woz_drivers.sound.wav import Wav
from woz_drivers.speech import doctor
from woz_drivers.speech.settings import VOICE_ARGUMENTS, SpeechSettings, voice_remarks
from woz_drivers.speech.synthesis import (
    LONGEST_SPEECH_S,
    PreparedUtterance,
    SpeechSynthesis,
    finish,
    read_wav,
    spoken_text,
)
from woz_drivers.speech.uttering import forecast, told, uttered
from woz_drivers.speech.voice_list import voices
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Forecast,
    Health,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
    StopReport,
    VoiceFound,
    Written,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.motion.body_feeds import VOICE, VoiceLevels
from woz_tui.motion.emotions import FEELINGS
from woz_tui.protocol import markup
from woz_tui.protocol.messages import Json
from woz_tui.system.tasks import end_tasks

#: How often missing programs are looked for, in seconds.
_LOOK_S = 2.0
#: How many utterances are ready, while they are made.
PREPARED = "prepared"
#: How the program that stays loaded is, and how long its last sound took, in seconds.
SYNTHESISER = "synthesiser"
#: Progress is published this often at most, in microseconds.
_PROGRESS_US = 500_000

_SAY = common_verb(
    "say",
    "speak a text",
    *VOICE_ARGUMENTS,
    Argument("volume", "number", "how loud, 0 to 1", range=Range(0, 1)),
    limit_s=LONGEST_SPEECH_S + 5,
    evidence="reported",  # its program has ended, and well
    markup=("pause",),
)
#: A program that speaks by itself gets the words alone.
_SAY_BY_ITSELF = replace(_SAY, markup=())
_SOUND = common_verb("sound", "play a WAV file", evidence="reported")
_UTTER = common_verb("utter", choices=FEELINGS, evidence="reported")
_VOLUME = common_verb("volume", "set how loud the next sounds are", lane="volume", evidence="")
#: A player that ends so long before its sound, and before the half of it, has not played it: it may
#: end a little early, where the sound card has a buffer. In seconds.
_EARLY_S = 0.5
#: How long one opening of a mouth is, in seconds: two pictures of a body.
_MOUTH_S = 0.04


class Speech(Driver):
    """One loudspeaker. Utterances and sound files may play at the same time."""

    Settings = SpeechSettings
    summary = "speech and sound files through a loudspeaker"
    facts = DriverFacts(
        needs="a synthesiser such as espeak-ng, and a loudspeaker",
        stop="its programs have ended",
        page="drivers/woz_drivers/speech/README.md",
    )
    settings: SpeechSettings

    def __init__(self, name: str, settings: SpeechSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._offered = {verb.name for verb in self.offer(settings).verbs}
        self._volume = settings.volume
        self._voice = SpeechSynthesis(settings, context.folder, self._resident_moved)
        #: Why the program that stays loaded makes no sound; None: it does, or there is none.
        self._resident_trouble: DriverError | None = None
        #: What could not be prepared, as `prepare_say` has it.
        self._unprepared: list[Mapping[str, Json]] = []
        self._levels = context.feed(VOICE)
        self._jobs: set[asyncio.Task[Any]] = set()
        self._audible: set[Child] = set()
        self._talk: LiveTalk | None = None
        if (talk := settings.talk) is not None:
            words = functools.partial(talk.play_words, settings.device)
            loudspeaker = program_loudspeaker(words, context)
            self._talk = LiveTalk(talk, context, loudspeaker, lambda: self._volume)
        self._missing: DriverError | None = None
        #: Why what is heard failed last; None: it did not.
        self._broken: DriverError | None = None
        #: Whether something is wrong, while what is heard can be ended all the same.
        self._faulted = False
        self._task: asyncio.Task[None] | None = None
        self._preparing: asyncio.Task[None] | None = None

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """Speech, sounds, volume; a program that speaks by itself plays no files. How many
        utterances are ready, how the program is that makes them, whether somebody talks.
        """
        made: SpeechSettings = settings
        volume = (_VOLUME,) if made.takes_volume or made.talk is not None else ()
        plays = (_SAY_BY_ITSELF, *volume) if made.speak else (_SAY, _SOUND, _UTTER, *volume)
        makes = (PREPARED, *((SYNTHESISER,) if made.resident_voice else ()))
        senses = () if made.speak else makes
        talk = live_talk.offered(made.talk)
        return replace(talk, verbs=(*plays, *talk.verbs), sensors=(*senses, *talk.sensors))

    @classmethod
    def remarks(cls, settings: Any, written: Written) -> Iterable[Finding]:
        """Voice settings that the command of this voice does not take."""
        return voice_remarks(settings, written)

    @classmethod
    async def voices(cls, probe: Probe) -> list[VoiceFound]:
        """Those of the synthesisers of this machine."""
        return await voices(probe.folder)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Are the programs, the voice, the sound card and the recordings there?"""
        return await doctor.examine(probe)

    async def open(self) -> None:
        """Look for the programs, until they are there."""
        self.context.health(Health.CONNECTING, "looking for the speech programs")
        self._task = asyncio.create_task(self._watch_programs())
        self._voice.start()
        if self._talk is not None:
            self._talk.start()

    async def prepare_say(self, utterances: list[Mapping[str, Json]]) -> None:
        """Synthesise what will be said, so that it is heard at once later. Troubles become one
        notice; what failed is tried again when it is said, or when the program that stays loaded
        is back.
        """
        if self.settings.speak:
            return
        preparing = self._start_preparing(utterances)
        try:
            await asyncio.wait([preparing])
        finally:
            preparing.cancel()

    def _start_preparing(self, utterances: list[Mapping[str, Json]]) -> asyncio.Task[None]:
        """Begin to prepare these, and end what was being prepared before."""
        if self._preparing is not None:
            self._preparing.cancel()
        self._preparing = asyncio.create_task(self._prepare(utterances))
        return self._preparing

    async def _prepare(self, utterances: list[Mapping[str, Json]]) -> None:
        self._unprepared = []
        published_us = 0
        for number, args in enumerate(utterances):
            try:
                text = spoken_text(str(args["text"]))
                made = await self._voice.utterance(text, self._voice.choice(args))
            except RejectedError:
                continue
            except DriverError as error:
                self._unprepared = utterances
                what = f"speech not prepared: {error.what}"
                self.context.notice("warning", what, error.remedy, tells=("request",))
                return
            now = self.context.clock.now_us()
            if made.source == "synthesised" and now - published_us >= _PROGRESS_US:
                published_us = now
                self._publish_progress(number + 1, len(utterances))
        self._publish_progress(len(utterances), len(utterances))

    def _publish_progress(self, ready: int, of: int) -> None:
        self.context.reading(PREPARED, None, text=f"{ready} of {of}")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Speak, play or set the volume; returns when the sound has ended."""
        if job.verb not in self._offered:
            raise RejectedError(f"{self.name} cannot {job.verb}")
        if job.verb == "volume":
            return self._set_volume(job.args.get("level"))
        if self._talk is not None and job.verb == "end_talk":
            return self._talk.end()
        if self._missing is not None:
            raise DeviceLostError(self._missing.what, self._missing.remedy)
        with self._counted():
            match job.verb:
                case "say" if self.settings.speak:
                    return await self._speak(job, spoken_text(str(job.args["text"])))
                case "say":
                    return await self._say(job, spoken_text(str(job.args["text"])))
                case "utter":
                    return await self._utter(job)
                case "sound":
                    return await self._play_file(job, str(job.args["file"]))
            assert self._talk is not None  # else `talk` is not offered
            return await self._talk.talk()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """An utterance or a file: made ready, and measured. Programs that speak by themselves do
        not say how long they take.
        """
        if verb == "sound":
            content = await asyncio.to_thread(read_wav, self.context.folder / str(args["file"]))
            return Forecast(content.seconds, ())
        if verb == "utter":
            return forecast(args)
        if verb != "say" or self.settings.speak:
            return Forecast() if verb == "say" else Forecast(0.0, ())
        choice = self._voice.choice(args)
        parts = self._voice.parts(spoken_text(str(args["text"])), choice)
        made = [await self._voice.part(parts, number, choice) for number in range(len(parts))]
        begins = [sum(each.sound.seconds for each in made[:number]) for number in range(len(made))]
        words = tuple(
            (begin + one.begin, "word", one.word)
            for begin, each in zip(begins, made, strict=True)
            for one in each.words
        )
        seconds = sum(each.sound.seconds for each in made)
        return Forecast(seconds, words if all(each.words for each in made) else None)

    async def stop(self, scope: Scope) -> StopReport | None:
        """Fall silent: every program that makes or plays sound for a job is killed. Nobody talks
        through the robot while no wizard watches.
        """
        if self._talk is not None:
            await self._talk.stop()
        if scope is Scope.DRIVE:
            return None
        await self._silence()
        return StopReport(("sound",)) if self._faulted else None

    async def close(self) -> None:
        """End everything."""
        watching, self._task = self._task, None
        await end_tasks(watching, self._preparing)
        await self._silence()
        if self._talk is not None:
            await self._talk.close()
        await self._voice.close()

    async def _silence(self) -> None:
        for running in list(self._audible):
            running.kill()
        jobs = set(self._jobs)
        for job in jobs:
            if not job.cancelling():  # the bus cancels as well; twice would disturb the clearing up
                job.cancel()
        if jobs:
            await asyncio.wait(jobs)

    @contextlib.contextmanager
    def _counted(self) -> Iterator[None]:
        """Let `_silence` find the running job."""
        task = asyncio.current_task()
        assert task is not None
        self._jobs.add(task)
        try:
            yield
        finally:
            self._jobs.discard(task)

    # -- programs ------------------------------------------------------------------------------

    async def _watch_programs(self) -> None:
        while not self._complete():  # noqa: ASYNC110 - nothing tells when a program is installed
            await asyncio.sleep(_LOOK_S)

    def _look_again(self) -> None:
        """Something has changed: what is missing now may be there again later."""
        if not self._complete() and self._task is not None and self._task.done():
            self._task = asyncio.create_task(self._watch_programs())

    def _complete(self) -> bool:
        """Whether every program is there; says so as the driver's health. Without the synthesiser
        recordings can still be played, without the player nothing can.
        """
        *makers, player = _programs(self.settings)
        self._missing, self._faulted = None, False
        try:
            command_lines.find(player, self.context.folder)
        except DriverError as error:
            self._missing = error
            self.context.health(Health.LOST, error.what, error.remedy)
            return False
        try:
            for maker in makers:
                command_lines.find(maker, self.context.folder)
        except DriverError as error:
            self._fault(error)
            return False
        trouble = self._resident_trouble or self._broken
        if trouble is not None:
            self._fault(trouble)
        else:
            made_by = (self._voice.program,) if makers else ()
            self.context.health(Health.CONNECTED, ", ".join((*made_by, player)))
        return True

    def _fault(self, error: DriverError) -> None:
        self._faulted = True
        self.context.health(Health.FAULTED, error.what, error.remedy)

    def _resident_moved(self, state: str, why: str, remedy: str) -> None:
        """The program that stays loaded is `loading`, `ready` or `lost`."""
        self.context.sensor(SYNTHESISER, "stale" if state == "lost" else state, why)
        if state == "loading":
            return
        self._resident_trouble = DriverError(why, remedy) if state == "lost" else None
        self._look_again()
        if state == "ready" and self._unprepared:
            self._start_preparing(self._unprepared)

    # -- sound ---------------------------------------------------------------------------------

    async def _say(self, job: Job, text: str) -> Mapping[str, Json]:
        """Speak; of what has to be made first, part by part, each while the one before it is
        heard.
        """
        choice, volume, clock = (
            self._voice.choice(job.args),
            self._volume_of(job),
            self.context.clock,
        )
        asked_us, heard_us = clock.now_us(), 0
        spoken: list[PreparedUtterance] = []
        words: list[Json] = []
        parts = self._voice.parts(text, choice)
        making = [asyncio.create_task(self._voice.part(parts, 0, choice))]
        try:
            for following in range(1, len(parts) + 1):
                utterance = await making.pop()
                if following < len(parts):
                    following_part = self._voice.part(parts, following, choice)
                    making.append(asyncio.create_task(following_part))
                now_us = clock.now_us()
                if not heard_us:
                    heard_us = now_us
                    if self.settings.resident_voice and utterance.source == "synthesised":
                        delay_s = round((heard_us - asked_us) / 1_000_000, 2)
                        self.context.reading(SYNTHESISER, delay_s, unit="s")
                begin = (now_us - heard_us) / 1_000_000
                words += [
                    [one.word, round(begin + one.begin, 3), round(begin + one.end, 3)]
                    for one in utterance.words
                ]
                spoken.append(utterance)
                letters_s = sum(one.sound.seconds for one in spoken) / sum(
                    map(len, parts[:following])
                )
                left_s = letters_s * sum(map(len, parts[following:]))
                with _telling(job, utterance), self._moving_mouth(utterance.sound):
                    await self._play(job, utterance.path, utterance.sound, volume, left_s)
        finally:
            await end_tasks(*making)
        new = [utterance for utterance in spoken if utterance.source == "synthesised"]
        return {
            **self._sent((new or spoken)[0], volume),
            "seconds": round(sum(one.sound.seconds for one in spoken), 3),
            **{"text": markup.sentence(text), "delay": round((heard_us - asked_us) / 1_000_000, 3)},
            **({"words": words} if words else {}),
        }

    async def _utter(self, job: Job) -> Mapping[str, Json]:
        """A sound that goes with a mood: notes, or syllables without a meaning."""
        sound = await uttered(job.args, self.context.folder, self.settings.register)
        with self._moving_mouth(sound):
            await self._play(job, None, sound, self._volume)
        return {**told(job.args, sound), "volume": self._volume}

    @contextlib.contextmanager
    def _moving_mouth(self, sound: Wav) -> Iterator[None]:
        """While it sounds, have a face that follows this voice open its mouth as loud as it is."""
        began_us = self.context.clock.now_us()

        async def tell() -> None:
            levels = await asyncio.to_thread(emotion_sound.voiced_level, sound, _MOUTH_S)
            self._levels.put(VoiceLevels(began_us, _MOUTH_S, levels))

        telling = asyncio.create_task(tell())  # beside the player, which is not to wait for it
        try:
            yield
        finally:
            telling.cancel()
            self._levels.put(VoiceLevels())

    def _volume_of(self, job: Job) -> float:
        wanted = job.args.get("volume")
        return self._volume if wanted is None else float(wanted)

    async def _play_file(self, job: Job, file: str) -> Mapping[str, Json]:
        path = self.context.folder / file
        content = await asyncio.to_thread(read_wav, path)
        await self._play(job, path, content, self._volume)
        sent = self._sent(PreparedUtterance(path, content, "file"), self._volume)
        return sent | {"file": file}

    def _sent(self, utterance: PreparedUtterance, volume: float) -> dict[str, Json]:
        return {
            "seconds": round(utterance.sound.seconds, 3),
            "source": utterance.source,
            "cached": utterance.source == "cache",
            "volume": volume,
        }

    async def _play(
        self, job: Job, path: Path | None, content: Wav, volume: float, left_s: float = 0.0
    ) -> None:
        """`left_s`: so long the job goes on behind it."""
        words = self.settings.play_words()
        values = self.settings.values(self._voice.choice(job.args), volume)
        own_volume = any("{volume}" in word for word in words)
        async with _at_volume(path, content, 1.0 if own_volume else volume) as played:
            job.expects(content.seconds + left_s)
            await self._run(
                command_lines.fill(words, {**values, "wav": str(played)}),
                content.seconds + self.settings.margin,
                sound_s=content.seconds,
            )

    async def _speak(self, job: Job, text: str) -> Mapping[str, Json]:
        words = self.settings.speak_words()
        choice, volume = self._voice.choice(job.args), self._volume_of(job)
        values = {**self.settings.values(choice, volume), "text": text}
        used = command_lines.placeholders(words, values, "speak")
        estimate = max(1, len(text.split())) * 60 / choice.speed
        job.expects(estimate)
        await self._run(
            command_lines.fill(words, values),
            LONGEST_SPEECH_S,
            None if "text" in used else text + "\n",
        )
        heard = {"volume": volume} if self.settings.takes_volume else {}
        return {"text": text, "source": words[0], **heard}

    async def _run(
        self, words: Sequence[str], seconds: float, text: str | None = None, *, sound_s: float = 0.0
    ) -> None:
        """Run a program that is heard; its failure is the driver's health until one succeeds.

        `sound_s`: so long the sound is that it plays, if that is known.
        """
        began_us = self.context.clock.now_us()
        running = await child_process.start(words, self.context.folder, text=text)
        self._audible.add(running)
        try:
            await finish(running, seconds)
            played_s = (self.context.clock.now_us() - began_us) / 1_000_000
            if sound_s - played_s > max(_EARLY_S, sound_s / 2):
                raise DriverError(
                    f"{running.program} ended after {played_s:.1f} s of {sound_s:.1f} s of sound",
                    "try its command in a terminal: it must go on for as long as the sound does",
                )
        except DriverError as error:
            self._broken = error
            self._fault(error)
            raise
        finally:
            self._audible.discard(running)
        if self._broken is not None:
            self._broken = None
            self._look_again()

    def _set_volume(self, level: Json) -> Mapping[str, Json]:
        if not isinstance(level, int | float):
            raise RejectedError("volume needs a level from 0 to 1")
        self._volume = min(max(float(level), 0.0), 1.0)
        return {"level": self._volume}


def _programs(settings: SpeechSettings) -> tuple[str, ...]:
    """The programs that are needed; the last one is heard."""
    if settings.speak:
        return (settings.speak_words()[0],)
    words = settings.resident_words() or settings.synthesise_words()
    return (words[0], settings.play_words()[0])


@contextlib.contextmanager
def _telling(job: Job, utterance: PreparedUtterance) -> Iterator[None]:
    """While it sounds, tell where its words begin."""
    loop = asyncio.get_running_loop()
    timers = [loop.call_later(one.begin, job.mark, "word", one.word) for one in utterance.words]
    try:
        yield
    finally:
        for timer in timers:
            timer.cancel()


@contextlib.asynccontextmanager
async def _at_volume(path: Path | None, content: Wav, volume: float) -> AsyncIterator[Path]:
    """`path` itself at full volume, else a file at this volume for as long as it is needed."""
    if path is not None and volume == 1.0:
        yield path
        return
    softer = await asyncio.to_thread(lambda: content.at(volume).to_bytes())
    with child_process.temporary_file("softer.wav", softer) as file:
        yield file
