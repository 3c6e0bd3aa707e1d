"""What a robot file may say about a voice."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers import command_lines
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.fields import Doc, Path, Range, Seconds, Section

#: What the commands may hold in braces.
SYNTHESISE_WORDS = ("text", "wav", "voice", "speed", "pitch")
PLAY_WORDS = ("wav", "volume", "device")
SPEAK_WORDS = ("text", "voice", "speed", "pitch", "volume", "device")

Command = str | tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SynthesisSettings(Section):
    """How text becomes sound."""

    voice: Annotated[str, Doc("espeak-ng voice; `espeak-ng --voices` lists them")] = "en"
    speed: Annotated[int, Range(60, 450, "words/min"), Doc("how fast it speaks")] = 160
    pitch: Annotated[int, Range(0, 99), Doc("how high it speaks")] = 50
    synthesise: Annotated[
        Command,
        Doc("program that turns {text} (or stdin) into a WAV file {wav} (or stdout);"
            " default: espeak-ng"),
    ] = ""  # fmt: skip
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
        return [*command_problems(("synthesise", self.synthesise_words))]

    def synthesise_words(self) -> tuple[str, ...]:
        """The command that makes a WAV file. Raises `DriverError` if it is none."""
        if not self.synthesise:
            voice = ("-v", "{voice}", "-s", "{speed}", "-p", "{pitch}")
            return ("espeak-ng", *voice, "-b", "1", "--stdin", "-w", "{wav}")
        return _checked(self.synthesise, SYNTHESISE_WORDS, "synthesise")

    def voice_values(self) -> dict[str, str]:
        """What stands for the placeholders, but for {text} and {wav}."""
        return {"voice": self.voice, "speed": str(self.speed), "pitch": str(self.pitch)}


@dataclass(frozen=True, slots=True)
class SpeechSettings(SynthesisSettings):
    """How text becomes sound, and how sound is played."""

    volume: Annotated[float, Range(0, 1), Doc("1 is as loud as the sound card is set")] = 1.0
    device: Annotated[str, Doc("ALSA device for aplay, such as plughw:1,0")] = ""
    play: Annotated[Command, Doc("program that plays the file {wav}; default: aplay")] = ""
    speak: Annotated[
        Command,
        Doc("program that speaks {text} (or stdin) by itself, instead of synthesise and play"),
    ] = ""
    margin: Annotated[
        float, Seconds(0.1, 2.0), Doc("a player may take this much longer than the sound")
    ] = 1.5

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = [
            *SynthesisSettings.problems(self),
            *command_problems(("play", self.play_words), ("speak", self.speak_words)),
        ]
        if self.speak and (self.synthesise or self.play):
            found.append(("speak", "speak replaces synthesise and play: leave these out"))
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

    def values(self, volume: float) -> dict[str, str]:
        """What stands for the placeholders, but for {text} and {wav}; {volume} in percent."""
        return {
            **self.voice_values(),
            "device": self.device,
            "volume": str(round(volume * 100)),
        }


def command_problems(*commands: tuple[str, Callable[[], object]]) -> Iterator[tuple[str, str]]:
    """What is wrong with commands, each given as its setting and what reads it."""
    for setting, look in commands:
        try:
            look()
        except DriverError as error:
            yield setting, f"{error.what}; {error.remedy}"


def _checked(command: str | Sequence[str], known: tuple[str, ...], setting: str) -> tuple[str, ...]:
    words = command_lines.split(command, setting)
    command_lines.placeholders(words, known, setting)
    return words
