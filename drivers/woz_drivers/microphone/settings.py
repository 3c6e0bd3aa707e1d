"""What a robot file may say about a microphone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from woz_drivers.microphone import voice_detection
from woz_drivers.microphone.speech_detection import BLOCK_S, SpeechCriteria
from woz_drivers.programs import command_lines
from woz_drivers.programs.resident_program import resident_words
from woz_drivers.sound import pcm_audio
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section, Sibling
from woz_tui.drivers.sound_feeds import LISTEN
from woz_tui.system.extras import install_command


@dataclass(frozen=True, slots=True)
class MicrophoneSettings(Section):
    """Where the sound comes from, its shape, and what counts as speech in it."""

    command: Annotated[
        str | tuple[str, ...],
        Doc("program that writes raw sound to stdout; default: arecord with the settings below"),
    ] = ""
    from_: Annotated[
        str,
        Sibling(uses=LISTEN),
        Doc(
            "driver of the same robot whose live sound it is, such as a Pepper's, instead of a"
            " program"
        ),
    ] = ""
    device: Annotated[str, Doc("ALSA device for arecord, such as plughw:1,0")] = ""
    rate: Annotated[int, Range(4_000, 192_000, "Hz"), Doc("frames a second")] = 16_000
    format: Annotated[str, OneOf(tuple(pcm_audio.FORMATS)), Doc("sample format")] = "S16_LE"
    channels: Annotated[int, Range(1, 32), Doc("channels the command writes")] = 1
    channel: Annotated[int, Range(0, 32), Doc("which one counts, from 1; 0: their mean")] = 0
    publish: Annotated[float, Range(0.5, 50, "Hz"), Doc("loudness values a second")] = 10.0
    measure: Annotated[
        str, OneOf(("max", "rms")), Doc("loudest 20 ms since the last value, or all of them")
    ] = "max"
    threshold: Annotated[float, Range(0, 1), Doc("louder than this RMS is speech")] = 0.02
    speech: Annotated[
        str,
        OneOf(("loud", "voice", "voice-or-loud")),
        Doc(
            "what counts as speech: loud sound, or loud sound with a voice in it (an extra), or"
            " that where the extra is there"
        ),
    ] = "loud"
    onset: Annotated[
        float, Seconds(0, 2), Doc("time above the threshold that counts as speech")
    ] = 0.06
    hang_over: Annotated[float, Seconds(0, 10), Doc("silence of this length ends speech")] = 1.0
    pre_roll: Annotated[
        float, Seconds(0, 10), Doc("time before the threshold is passed that is kept in a segment")
    ] = 0.5
    longest: Annotated[
        float, Seconds(1, 600), Doc("speech without a pause is cut into segments of this length")
    ] = 60.0
    while_speaking: Annotated[
        str,
        OneOf(("mark", "drop", "keep")),
        Doc(
            "speech that begins while a robot of the session speaks: marked as the robot's own,"
            " left out, or a visitor's as any other"
        ),
    ] = "mark"
    segments: Annotated[
        bool, Doc("keep what is said as WAV files beside the log; mind your ethics approval")
    ] = False
    transcribe: Annotated[
        str | tuple[str, ...],
        Doc("program that turns the WAV file {file} into text on stdout; empty: none"),
    ] = ""
    resident_transcriber: Annotated[
        str | tuple[str, ...],
        Doc("program that stays loaded and turns speech into text, instead of `transcribe`"),
    ] = ""
    language: Annotated[
        str, Doc("what is spoken, for that program, such as en; empty: as it likes")
    ] = ""
    partial_texts: Annotated[
        float,
        Seconds(0, 10),
        Doc("ask that program this often what is understood so far; 0: never"),
    ] = 0.0
    transcribe_limit: Annotated[
        float, Seconds(1, 600), Doc("time limit of either program for a segment")
    ] = 30.0
    silent_after: Annotated[
        float,
        Seconds(0.1, 600),
        Doc("time with only zeros after which it counts as muted or unplugged"),
    ] = 3.0
    sensitivity: Annotated[
        float, Range(0.5, 20), Doc("listen_room: mean + this many standard deviations")
    ] = 4.0

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = []
        if self.channel > self.channels:
            found.append(
                ("channel", f"there is no channel {self.channel}: channels is {self.channels}")
            )
        if self.from_:
            found += [
                (name, f"the sound is {self.from_}'s, as it sends it: leave {name} out")
                for name in _OF_PROGRAMS
                if getattr(self, name) != getattr(_BARE, name)
            ]
        elif self.command and self.device:
            found.append(("device", "it is for arecord; put the device into your command instead"))
        if self.speech == "voice" and not voice_detection.installed():
            found.append(
                ("speech", f"`voice` needs a package: {install_command('voice-detection')}")
            )
        if self.detects_voices and self.rate % voice_detection.MODEL_RATE:
            found.append(("rate", "must be 16000, 32000 or 48000 where `speech` is `voice`"))
        if self.pre_roll + self.onset + 2 * BLOCK_S > self.longest:
            found.append(("longest", "must be longer than pre_roll and onset together"))
        return (
            found + command_lines.problems(self.command, "command") + self._transcriber_problems()
        )

    def _transcriber_problems(self) -> list[tuple[str, str]]:
        try:
            resident = self.resident_words
        except DriverError as error:
            return [("resident_transcriber", f"{error.what}; {error.remedy}")]
        found = command_lines.problems(self.transcribe, "transcribe")
        if resident and self.transcribe:
            found.append(("transcribe", "resident_transcriber replaces it: leave one out"))
        if not resident and (self.language or self.partial_texts):
            name = "language" if self.language else "partial_texts"
            found.append((name, "it is for resident_transcriber, which is not there"))
        if found or not self.transcribe:
            return found
        try:
            if "file" in command_lines.placeholders(self.transcriber, ("file",), "transcribe"):
                return []
        except DriverError as error:
            return [("transcribe", f"{error.what}; {error.remedy}")]
        return [("transcribe", "must contain {file}, the place of the sound file")]

    @property
    def detects_voices(self) -> bool:
        """Whether loud sound counts only with a voice in it."""
        wanted = self.speech != "loud"
        return wanted and (self.speech == "voice" or voice_detection.installed())

    @property
    def transcriber(self) -> tuple[str, ...]:
        """The command that turns speech into text; empty if there is none."""
        return command_lines.split(self.transcribe, "transcribe") if self.transcribe else ()

    @property
    def resident_words(self) -> tuple[str, ...]:
        """The program that stays loaded and does so; empty if there is none."""
        return resident_words(self.resident_transcriber, "resident_transcriber")

    @property
    def source(self) -> str:
        """Where the sound comes from, in sentences."""
        return self.from_ or self.words[0]

    @property
    def words(self) -> tuple[str, ...]:
        """The command. Raises `DriverError` if it is none."""
        if self.command:
            return command_lines.split(self.command, "command")
        device = ("-D", self.device) if self.device else ()
        shape = ("-t", "raw", "-f", self.format, "-r", str(self.rate), "-c", str(self.channels))
        return ("arecord", "-q", *device, *shape)

    @property
    def block_bytes(self) -> int:
        """Bytes of a 20 ms block of all channels."""
        return round(self.rate * BLOCK_S) * pcm_audio.FORMATS[self.format].width * self.channels

    @property
    def ear(self) -> SpeechCriteria:
        """The part that decides about speech."""
        return SpeechCriteria(
            self.threshold,
            self.onset,
            self.hang_over,
            self.silent_after,
            self.pre_roll,
            self.longest,
            self.rate if self.detects_voices else 0,
        )

    def samples(self, block: bytes) -> pcm_audio.Samples:
        """A block of bytes as the chosen channel's samples."""
        return pcm_audio.one_channel(
            pcm_audio.decode(block, self.format, self.channels), self.channel
        )


#: What is about a program's sound alone, and how it is where nothing is written.
_OF_PROGRAMS = ("command", "device", "rate", "format", "channels")
_BARE = MicrophoneSettings()
