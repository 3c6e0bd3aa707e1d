"""From text to a WAV file: recordings first, then the cache, then the synthesiser, which may be a
program that stays loaded.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import os
import re
import tempfile
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.child_process import Child
from woz_drivers.programs.resident_program import ResidentProgram
from woz_drivers.sound import wav
from woz_drivers.sound.wav import NotWavError, Wav
from woz_drivers.speech.settings import SynthesisSettings, VoiceChoice
from woz_drivers.speech.text_parts import goes_on, spoken_parts
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol import markup
from woz_tui.system.files import open_regular
from woz_tui.system.tasks import wait_at_most


# -- cache -----------------------------------------------------------------------------------------
def users_folder() -> Path:
    """`woz-tui/speech` in the user's cache directory (XDG_CACHE_HOME, or ~/.cache)."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if base.startswith("/") else Path.home() / ".cache"
    return root / "woz-tui" / "speech"


class SpeechCache:
    """A folder of WAV files named by what made them. Programs may share one."""

    def __init__(self, folder: Path, megabytes: int) -> None:
        self._folder = folder
        self._limit = megabytes * 1_000_000

    def path(self, recipe: Sequence[str]) -> Path:
        """Where the sound made by `recipe` (command, voice, its settings, text) belongs."""
        digest = hashlib.sha256("\0".join(recipe).encode()).hexdigest()
        return self._folder / f"{digest[:40]}.wav"

    def get(self, path: Path) -> bytes | None:
        """A file's content, and it counts as used now; None if it is not there."""
        try:
            content = path.read_bytes()
        except OSError:
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return content

    def store(self, path: Path, content: bytes) -> None:
        """Store a file whole or not at all, then make room. Raises OSError."""
        self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        handle, name = tempfile.mkstemp(dir=self._folder, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            Path(name).replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                Path(name).unlink()
            raise
        self._make_room(keep=path)

    def _make_room(self, keep: Path) -> None:
        files = []
        for file in self._folder.glob("*.wav"):
            with contextlib.suppress(OSError):
                found = file.stat()
                files.append((found.st_mtime, found.st_size, file))
        total = sum(size for _, size, _ in files)
        for _, size, file in sorted(files):
            if total <= self._limit:
                return
            if file != keep:
                with contextlib.suppress(OSError):
                    file.unlink()
                    words_file(file).unlink(missing_ok=True)
                total -= size


# --------------------------------------------------------------------------------------------------

#: A synthesiser that takes longer than this hangs, in seconds; large neural voices need a few.
_SYNTHESIS_S = 25.0
#: No utterance may take longer than this, in seconds.
LONGEST_SPEECH_S = 120.0
#: A longer program output than this is no utterance, in bytes.
_MOST_OUTPUT = 200_000_000

#: The first part of a text is to be made within this, in seconds; speech has about so many seconds
#: a letter, and of that so much may pass until the next part is made.
_FIRST_PART_S, _SPOKEN_S, _AHEAD = 0.22, 0.05, 0.6
#: A part that ends within a sentence has so much silence at its end, in seconds.
_WITHIN_SENTENCE_S = 0.03
#: How long a program needs for a letter, in seconds, before it has made anything; how much the
#: newest sentence counts; each text costs as much as so many letters more.
_LETTER_S, _NEWEST, _FIXED = 0.008, 0.3, 10
#: A part may have so many letters however slow the program is; and parts of so many texts are
#: remembered.
_SHORTEST, _ALL, _REMEMBERED = 16, 1_000_000, 64
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")


class UtteranceWord(msgspec.Struct, frozen=True, array_like=True):
    """A word of an utterance; `begin` and `end` in seconds from its beginning."""

    word: str
    begin: float
    end: float

    def later(self, seconds: float) -> UtteranceWord:
        """The same word, so many seconds later."""
        return UtteranceWord(self.word, self.begin + seconds, self.end + seconds)


@dataclass(frozen=True, slots=True)
class PreparedUtterance:
    """Sound ready to play. `path`: a file of it, if there is one; `source`: recording, cache or
    synthesised; `words` where they are known.
    """

    path: Path | None
    sound: Wav
    source: str
    words: tuple[UtteranceWord, ...] = ()


class _MadeWord(msgspec.Struct, frozen=True):
    """A word as a program that stays loaded tells it."""

    word: str
    begin: float
    end: float


class _Made(msgspec.Struct, frozen=True):
    """Its answer. With a `rate` the file is raw sound: 16 bits, one channel."""

    rate: int = 0
    words: list[_MadeWord] = []


def words_file(path: Path) -> Path:
    """Where the words of a sound in the cache are."""
    return path.with_suffix(".json")


def spoken_text(text: str) -> str:
    """What is really said of `text`: on one line, without control characters (espeak-ng takes
    some for commands) and without the halves of broken characters. `RejectedError` if nothing is
    left.
    """
    clean = " ".join(_CONTROL.sub(" ", text).split())
    if not clean:
        raise RejectedError("there is nothing to say", "give say: a text")
    return clean


def read_wav(path: Path) -> Wav:
    """A WAV file. `RejectedError` says what is wrong with it and how to convert it."""
    try:
        with open_regular(path) as file:
            return wav.parse(file.read())
    except OSError as error:
        raise RejectedError(
            f"{path} cannot be read: {error.strerror}", "check the path and its permissions"
        ) from error
    except NotWavError as error:
        raise RejectedError(
            f"{path} cannot be played: {error}",
            f"convert it: ffmpeg -i '{path}' -c:a pcm_s16le '{path.with_suffix('.wav')}'",
        ) from error


async def finish(running: Child, seconds: float) -> None:
    """Wait until a child has ended well; it is gone afterwards, whatever happens. `DriverError`
    if it fails or takes longer than `seconds`.
    """
    ending = asyncio.ensure_future(running.wait())
    try:
        await wait_at_most([ending], seconds)
        if not ending.done():
            raise DriverError(
                f"{running.program} did not end within {seconds:.1f} s and was killed",
                "try its command in a terminal; check whether another program uses the sound"
                " device",
            )
        status = ending.result()
    finally:
        ending.cancel()
        await running.end()
    if status != 0:
        raise DriverError(
            f"{running.program} failed: {running.reason(status)}",
            "try its command in a terminal; `woz doctor`",
        )


class SpeechSynthesis:
    """Makes utterances of texts with one set of settings; `folder`: the experiment's.

    `on_state(state, why, remedy)`: how the program that stays loaded is, if there is one.
    """

    def __init__(
        self,
        settings: SynthesisSettings,
        folder: Path,
        on_state: Callable[[str, str, str], None] = lambda state, why, remedy: None,
    ) -> None:
        self._settings = settings
        self._folder = folder
        cache = Path(settings.cache) if settings.cache else users_folder()
        self._cache = SpeechCache(cache, settings.cache_megabytes)
        self._recordings = {
            " ".join(text.split()): folder / file for text, file in settings.recordings.items()
        }
        words = settings.resident_words()
        self._resident = ResidentProgram(words, folder, on_state) if words else None
        self._letter_s = _LETTER_S
        #: In which parts texts were made: those that are predicted are said in the same.
        self._parts: OrderedDict[Path, list[str]] = OrderedDict()

    @property
    def program(self) -> str:
        """The program that makes the sound, as sentences name it. Raises `DriverError`."""
        if self._resident is not None:
            return self._resident.program
        return self._settings.synthesise_words()[0]

    def choice(self, args: Mapping[str, Any]) -> VoiceChoice:
        """The voice of an utterance with these arguments of `say`."""
        return self._settings.choice().changed(args)

    def start(self) -> None:
        """Load the program that stays loaded, if there is one."""
        if self._resident is not None:
            self._resident.start()

    async def close(self) -> None:
        """End it."""
        if self._resident is not None:
            await self._resident.close()

    async def utterance(self, text: str, choice: VoiceChoice | None = None) -> PreparedUtterance:
        """The sound of `text`, which `spoken_text` gave. Cancelling it ends the synthesiser."""
        choice = choice or self._settings.choice()
        if len(pieces := _pieces(text)) > 1:
            return await self._with_pauses(pieces, choice)
        # Hundreds are prepared one after the other: a disk must not keep the loop from its work.
        found = await asyncio.to_thread(self._found, text, choice)
        if found is not None:
            return found
        path = self._path(text, choice)
        if self._resident is not None:
            made, spoken = await self._ask(self._resident, text, choice)
        else:
            made, spoken = await self._synthesise(text, choice), ()
        try:
            await asyncio.to_thread(self._store, path, made, spoken)
        except OSError as error:
            raise DriverError(
                f"no room for synthesised speech in {path.parent}: {error.strerror}",
                "free some space, or set cache: to another folder",
            ) from error
        return PreparedUtterance(path, made, "synthesised", spoken)

    async def _with_pauses(
        self, pieces: Sequence[tuple[str, float]], choice: VoiceChoice
    ) -> PreparedUtterance:
        """One sound of what is said between pauses, and of silence; of a recording where there is
        one of the whole. `RejectedError` where nothing is said.
        """
        whole = " ".join(text for text, _ in pieces if text)
        if self._recording(spoken_text(whole)) is not None:
            return await self.utterance(whole, choice)
        made: list[tuple[PreparedUtterance | None, float]] = []
        for text, pause in pieces:
            made.append((await self.utterance(text, choice) if text else None, pause))
        spoken = [utterance for utterance, _ in made if utterance is not None]
        shape = spoken[0].sound
        if any(each.sound.shape != shape.shape for each in spoken):  # a recording beside a voice
            return await self.utterance(whole, choice)
        sound, words = await asyncio.to_thread(_joined, made, shape)
        sources = [each.source for each in spoken]
        source = "synthesised" if "synthesised" in sources else sources[0]
        return PreparedUtterance(None, sound, source, words)

    def parts(self, text: str, choice: VoiceChoice) -> list[str]:
        """`text` in the parts in which it is made, if a program that stays loaded has to make it:
        the first as long as it can make soon, each other while the one before it is heard. A pause
        stands behind its part, or before the first one.
        """
        pieces = _pieces(text)
        whole = " ".join(said for said, _ in pieces if said)
        if self._resident is None or not whole or self._recording(whole) is not None:
            return [text]
        parts: list[str] = []
        before = ""
        for said, pause in pieces:
            if said:
                first = max(_SHORTEST, self._letters(_FIRST_PART_S))
                if parts:
                    first = self._following(len(parts[-1]))
                parts += self._parts_of_piece(said, choice, first)
            silence = f" \\pau={pause * 1000:.0f}\\" if pause else ""
            if parts:
                parts[-1] += silence
            else:
                before += silence
        parts[0] = f"{before} {parts[0]}".strip()
        return parts

    def _parts_of_piece(self, said: str, choice: VoiceChoice, first: int) -> list[str]:
        path = self._path(said, choice)
        if self._recording(said) is not None or path.exists():
            return [said]
        if path not in self._parts:
            self._parts[path] = spoken_parts(said, first, self._following)
            if len(self._parts) > _REMEMBERED:
                self._parts.popitem(last=False)
        return self._parts[path]

    def _letters(self, seconds: float) -> int:
        """How many letters can be made within this time."""
        return round(seconds / self._letter_s) - _FIXED

    def _following(self, letters: int) -> int:
        """How many can be made while so many are heard; all, if they are too few to be worth it."""
        found = self._letters(_AHEAD * _SPOKEN_S * letters)
        return found if found >= _SHORTEST else _ALL

    async def part(
        self, parts: Sequence[str], number: int, choice: VoiceChoice
    ) -> PreparedUtterance:
        """The sound of one of `parts`; where the sentence goes on, without a pause behind it."""
        made = await self.utterance(parts[number], choice)
        if number + 1 == len(parts) or not goes_on(parts[number]):
            return made
        return replace(made, path=None, sound=made.sound.without_end(_WITHIN_SENTENCE_S))

    def _path(self, text: str, choice: VoiceChoice) -> Path:
        words = self._settings.resident_words() or self._settings.synthesise_words()
        return self._cache.path((*words, *_recipe(choice), text))

    def _store(self, path: Path, made: Wav, words: tuple[UtteranceWord, ...]) -> None:
        self._cache.store(path, made.to_bytes())
        if words:
            words_file(path).write_bytes(msgspec.json.encode(words))

    async def _ask(
        self, program: ResidentProgram, text: str, choice: VoiceChoice
    ) -> tuple[Wav, tuple[UtteranceWord, ...]]:
        """Have the program that stays loaded make it. Cancelled, it goes on and is passed over."""
        with child_process.temporary_file("speech.wav") as path:
            request: dict[str, Any] = {
                **{"text": text, "wav": str(path), "voice": choice.voice},
                **{"language": choice.language, "speed": choice.speed, "pitch": choice.pitch},
            }
            answer = await program.ask(request, _Made, _SYNTHESIS_S)
            newest = program.answered_in / (len(text) + _FIXED)
            self._letter_s += _NEWEST * (newest - self._letter_s)
            content = path.read_bytes()
        if answer.rate:
            made = Wav("S16_LE", answer.rate, 1, content[: len(content) // 2 * 2])
        else:
            made = _parsed(content, program.program, "it has to write a WAV file to `wav`")
        if not made.data:
            raise DriverError(f"{program.program} made no sound", "try the text with `woz say`")
        return made, tuple(UtteranceWord(one.word, one.begin, one.end) for one in answer.words)

    def _found(self, text: str, choice: VoiceChoice) -> PreparedUtterance | None:
        """What was recorded or made before. Raises `DriverError`; for a thread."""
        recording = self._recording(text)
        if recording is not None:
            return PreparedUtterance(recording, read_wav(recording), "recording")
        path = self._path(text, choice)
        known = self._cache.get(path)
        if known is not None:
            with contextlib.suppress(NotWavError):  # a damaged file is made anew
                return PreparedUtterance(path, wav.parse(known), "cache", _cached_words(path))
        return None

    def _recording(self, text: str) -> Path | None:
        if text in self._recordings:
            return self._recordings[text]
        if not self._settings.recordings_folder:
            return None
        folder = self._folder / self._settings.recordings_folder
        for name in file_names(text):
            if (folder / name).is_file():
                return folder / name
        return None

    async def _synthesise(self, text: str, choice: VoiceChoice) -> Wav:
        words = self._settings.synthesise_words()
        with child_process.temporary_file("speech.wav") as path:
            values = {**choice.values(), "text": text, "wav": str(path)}
            used = command_lines.placeholders(words, values, "synthesise")
            output = bytearray()

            def collect(data: bytes) -> None:
                if len(output) < _MOST_OUTPUT:
                    output.extend(data)

            running = await child_process.start(
                command_lines.fill(words, values),
                self._folder,
                text=None if "text" in used else text + "\n",
                on_output=None if "wav" in used else collect,
            )
            await finish(running, _SYNTHESIS_S)
            content = path.read_bytes() if "wav" in used else bytes(output)
        remedy = "check the command's options: {wav} or stdout must become a WAV file"
        return _parsed(content, words[0], remedy)


def _pieces(text: str) -> list[tuple[str, float]]:
    """What is said between pauses. `RejectedError` where these take longer than speech may."""
    pieces = markup.pieces(text)
    pauses_s = sum(pause for _, pause in pieces)
    if pauses_s > LONGEST_SPEECH_S:
        raise RejectedError(
            f"its pauses alone take {pauses_s:.0f} s, and nothing may take longer than"
            f" {LONGEST_SPEECH_S:.0f} s",
            "shorten its pauses, or make several actions of it",
        )
    return pieces


def _joined(
    made: Sequence[tuple[PreparedUtterance | None, float]], shape: Wav
) -> tuple[Wav, tuple[UtteranceWord, ...]]:
    """The sound of several, each with its pause behind it, and their words; for a thread."""
    sounds, words, seconds = list[bytes](), list[UtteranceWord](), 0.0
    silent = replace(shape, data=b"")
    for utterance, pause in made:
        if utterance is not None:
            words += [one.later(seconds) for one in utterance.words]
            sounds.append(utterance.sound.data)
            seconds += utterance.sound.seconds
        silence = silent.with_silence(pause)
        sounds.append(silence.data)
        seconds += silence.seconds
    return replace(shape, data=b"".join(sounds)), tuple(words)


def _recipe(choice: VoiceChoice) -> tuple[str, ...]:
    """What of a voice makes its sound another one."""
    values = choice.values()
    language = values.pop("language")
    return (*values.values(), *((language,) if language else ()))


def _cached_words(path: Path) -> tuple[UtteranceWord, ...]:
    try:
        return msgspec.json.decode(words_file(path).read_bytes(), type=tuple[UtteranceWord, ...])
    except (OSError, msgspec.DecodeError):
        return ()


def _parsed(content: bytes, program: str, remedy: str) -> Wav:
    """What a program wrote. Raises `DriverError`."""
    try:
        return wav.parse(content)
    except NotWavError as error:
        raise DriverError(
            f"{program} ended without an error, but wrote no sound: {error}", remedy
        ) from error


def file_names(text: str) -> Iterator[str]:
    """Under which names a recording of `text` is looked for: as it is, and as plain words."""
    if "/" not in text and len(text.encode()) <= 250:
        yield f"{text}.wav"
    plain = "-".join(re.findall(r"\w+", text.lower()))
    if plain and len(plain.encode()) <= 250:
        yield f"{plain}.wav"
