"""What a robot file may say about a voice."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

from woz_drivers.programs import command_lines
from woz_drivers.programs.command_lines import Command
from woz_drivers.programs.resident_program import resident_words
from woz_drivers.sound.emotion_sound import REGISTER
from woz_drivers.sound.live_talk import TalkSettings
from woz_tui.drivers.contract import Argument, DriverError, Finding, Written
from woz_tui.drivers.fields import Doc, Path, Range, Seconds, Section

#: What the commands may hold in braces.
SYNTHESISE_WORDS = ("text", "wav", "voice", "language", "speed", "pitch")
PLAY_WORDS = ("wav", "volume", "device")
SPEAK_WORDS = ("text", "voice", "language", "speed", "pitch", "volume", "device")

SPEEDS = Range(60, 450, "words/min")
PITCHES = Range(0, 99)
#: The voice that nobody chose; a program that stays loaded takes its own then.
_USUAL_VOICE = "en"

#: How much of a live voice aplay holds, in microseconds.
_TALK_BUFFER_US = "100000"

#: What one utterance may change of the voice.
VOICE_ARGUMENTS = (
    Argument("voice", "text", "another voice"),
    Argument("language", "text", "such as de"),
    Argument("speed", "whole", "how fast", range=SPEEDS),
    Argument("pitch", "whole", "how high", range=PITCHES),
)


@dataclass(frozen=True, slots=True)
class VoiceChoice:
    """How one utterance is to sound. Without a voice the language decides, else the program."""

    voice: str
    language: str
    speed: int
    pitch: int

    def changed(self, args: Mapping[str, Any]) -> VoiceChoice:
        """The same with what an utterance has of `VOICE_ARGUMENTS`."""
        names = [argument.name for argument in VOICE_ARGUMENTS]
        wanted = {name: args[name] for name in names if args.get(name) is not None}
        if "language" in wanted:
            wanted.setdefault("voice", "")  # the usual one speaks another language
        return replace(self, **wanted)

    def values(self) -> dict[str, str]:
        """What stands for the placeholders of commands."""
        return {
            "voice": self.voice or self.language or _USUAL_VOICE,
            "language": self.language,
            "speed": str(self.speed),
            "pitch": str(self.pitch),
        }


@dataclass(frozen=True, slots=True)
class SynthesisSettings(Section):
    """How text becomes sound."""

    voice: Annotated[str, Doc("its voice, such as en-gb; `woz voices` lists them")] = _USUAL_VOICE
    language: Annotated[str, Doc("language where no voice is named, such as de")] = ""
    speed: Annotated[int, SPEEDS, Doc("how fast it speaks")] = 160
    pitch: Annotated[int, PITCHES, Doc("how high it speaks")] = 50
    synthesise: Annotated[
        Command,
        Doc("program that turns {text} (or stdin) into a WAV file {wav} (or stdout);"
            " default: espeak-ng"),
    ] = ""  # fmt: skip
    resident_voice: Annotated[
        Command, Doc("program that stays loaded and makes the sound, instead of `synthesise`")
    ] = ""
    recordings: Annotated[
        Mapping[str, Annotated[str, Path(must_exist=True)]],
        Doc("WAV files to be played instead of synthesising, by utterance"),
    ] = field(default_factory=dict)
    recordings_folder: Annotated[
        str, Path(must_exist=True), Doc("WAV files named like the utterance: `Hello there.wav`")
    ] = ""
    cache: Annotated[str, Path(), Doc("folder for what was synthesised")] = ""
    cache_megabytes: Annotated[int, Range(1, 100_000), Doc("largest size of that folder")] = 200

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong with the command: pairs of a setting's name and a sentence."""
        found = [
            *command_lines.setting_problems(
                ("synthesise", self.synthesise_words), ("resident_voice", self.resident_words)
            )
        ]
        if self.synthesise and self.resident_voice:
            found.append(("synthesise", "resident_voice replaces it: leave one out"))
        return found

    def synthesise_words(self) -> tuple[str, ...]:
        """The command that makes a WAV file. Raises `DriverError` if it is none."""
        if not self.synthesise:
            voice = ("-v", "{voice}", "-s", "{speed}", "-p", "{pitch}")
            return ("espeak-ng", *voice, "-b", "1", "--stdin", "-w", "{wav}")
        return _checked(self.synthesise, SYNTHESISE_WORDS, "synthesise")

    def resident_words(self) -> tuple[str, ...]:
        """The program that stays loaded, or () if there is none. Raises `DriverError`."""
        return resident_words(self.resident_voice, "resident_voice")

    def ignored(self) -> tuple[str, ...]:
        """Those of `VOICE_ARGUMENTS` that its command does not take; a program that stays loaded
        gets all.
        """
        return () if self.resident_voice else _not_taken(self.synthesise_words)

    def choice(self) -> VoiceChoice:
        """The voice of utterances that do not change it."""
        voice = "" if self.voice == _USUAL_VOICE else self.voice
        return VoiceChoice(voice, self.language, self.speed, self.pitch)


@dataclass(frozen=True, slots=True)
class PlayedTalkSettings(TalkSettings):
    """The same through a program that plays it."""

    play: Annotated[
        Command, Doc("program that plays raw S16_LE from stdin at {rate} Hz; default: aplay")
    ] = ""

    def problems(self, device: str = "") -> list[tuple[str, str]]:
        """What is wrong with the commands: pairs of the setting's path and a sentence."""
        plays = command_lines.setting_problems(("talk.play", lambda: self.play_words(device)))
        return [*TalkSettings.problems(self), *plays]

    def play_words(self, device: str) -> tuple[str, ...]:
        """The program that plays it. Raises `DriverError`."""
        values = {"rate": str(self.rate), "device": device}
        if self.play:
            words = _checked(self.play, ("rate", "device"), "talk.play")
            return command_lines.fill(words, values)
        card = ("-D", device) if device else ()
        shape = ("-t", "raw", "-f", "S16_LE", "-c", "1", "-r", values["rate"])
        return ("aplay", "-q", *card, *shape, "-B", _TALK_BUFFER_US)


@dataclass(frozen=True, slots=True)
class SpeechSettings(SynthesisSettings):
    """How text becomes sound, and how sound is played."""

    volume: Annotated[float, Range(0, 1), Doc("1 is as loud as the sound card is set")] = 1.0
    register: Annotated[
        float, Range(110, 1760, "Hz"), Doc("middle pitch of the sounds of `utter`")
    ] = REGISTER
    device: Annotated[str, Doc("ALSA device for aplay, such as plughw:1,0")] = ""
    play: Annotated[Command, Doc("program that plays the file {wav}; default: aplay")] = ""
    speak: Annotated[
        Command,
        Doc("program that speaks {text} (or stdin) by itself, instead of synthesise and play"),
    ] = ""
    margin: Annotated[
        float, Seconds(0.1, 2.0), Doc("a player may take this much longer than the sound")
    ] = 1.5
    talk: Annotated[
        PlayedTalkSettings | None,
        Doc("somebody can talk through it live: verbs `talk` and `end_talk`"),
    ] = None

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = [
            *SynthesisSettings.problems(self),
            *command_lines.setting_problems(("play", self.play_words), ("speak", self.speak_words)),
        ]
        if self.speak and (self.synthesise or self.resident_voice or self.play):
            found.append(("speak", "speak replaces the programs that make and play sound"))
        if self.speak and (self.recordings or self.recordings_folder):
            found.append(("speak", "speak plays no recordings: leave one of both out"))
        if self.talk is not None:
            found += self.talk.problems(self.device)
        return found

    def play_words(self) -> tuple[str, ...]:
        """The command that plays a WAV file. Raises `DriverError` if it is none."""
        if not self.play:
            return ("aplay", "-q", *(("-D", "{device}") if self.device else ()), "{wav}")
        words = _checked(self.play, PLAY_WORDS, "play")
        if not any("{wav}" in word for word in words):
            raise DriverError("play does not contain {wav}", "put {wav} at the place of the file")
        return words

    def speak_words(self) -> tuple[str, ...]:
        """The command that speaks by itself, or () if there is none. Raises `DriverError`."""
        return _checked(self.speak, SPEAK_WORDS, "speak") if self.speak else ()

    @property
    def takes_volume(self) -> bool:
        """Whether a volume is heard: a program that speaks by itself has to be told it."""
        return "volume" not in self.ignored()

    def ignored(self) -> tuple[str, ...]:
        """The same of the program that speaks by itself, and the volume if it does not take it."""
        if not self.speak:
            return SynthesisSettings.ignored(self)
        return _not_taken(self.speak_words, "volume")

    def values(self, choice: VoiceChoice, volume: float) -> dict[str, str]:
        """What stands for the placeholders, but for {text} and {wav}; {volume} in percent."""
        return {
            **choice.values(),
            "device": self.device,
            "volume": str(round(volume * 100)),
        }


def voice_remarks(settings: SynthesisSettings, written: Written) -> Iterable[Finding]:
    """What a written `say` wants of the voice and its command does not take."""
    for name in settings.ignored() if written.verb == "say" else ():
        if written.args.get(name) is not None:
            what = f"this voice has no {name}: its command lacks {{{name}}}"
            yield Finding("warning", name, what)


def _not_taken(command: Callable[[], tuple[str, ...]], *more: str) -> tuple[str, ...]:
    """Those of `VOICE_ARGUMENTS`, and of `more`, that this command has no placeholder for."""
    try:
        words = command()
    except DriverError:  # `problems` says so
        return ()
    taken = {name for name in SPEAK_WORDS if any(f"{{{name}}}" in word for word in words)}
    if "voice" in taken:
        taken.add("language")  # it stands for a voice that is not named
    names = (*(one.name for one in VOICE_ARGUMENTS), *more)
    return tuple(name for name in names if words and name not in taken)


def _checked(command: str | Sequence[str], known: tuple[str, ...], setting: str) -> tuple[str, ...]:
    words = command_lines.split(command, setting)
    command_lines.placeholders(words, known, setting)
    return words
