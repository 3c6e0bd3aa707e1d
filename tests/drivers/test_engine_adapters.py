"""The adapters for faster-whisper and Piper with stand-ins; `make peers` has the real ones.

The stand-ins are called as the real ones are: a module that is imported, a program that is run.
"""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.microphone import whisper_transcriber
from woz_drivers.microphone.transcriber import Transcript
from woz_drivers.programs.resident_program import ResidentProgram
from woz_drivers.speech import piper_voice
from woz_drivers.speech.settings import SynthesisSettings, VoiceChoice
from woz_drivers.speech.synthesis import PreparedUtterance, SpeechSynthesis

from tests.drivers.resident_programs import ROOT
from tests.fakes.sound import RATE, journal_entries
from woz_tui.drivers.contract import DriverError

WHISPER = '''
"""Understands the name of a file, in two parts."""
from types import SimpleNamespace as S

class WhisperModel:
    def __init__(self, model, device, compute_type, cpu_threads):
        print("a library that prints")
        if model == "missing":
            raise ValueError("there is no such model")

    def transcribe(self, file, language, **options):
        if "broken" in file:
            raise RuntimeError("no sound in it")
        def part(text, start):
            word = S(word=" " + text, start=start, end=start + 0.5, probability=0.8)
            return S(text=" " + text, avg_logprob=-0.5, words=[word])
        return iter([part("hello", 0.0), part(str(language), 0.5)]), None
'''

PIPER = f"""#!{sys.executable} -S
import json, sys, time, wave
sys.path.insert(0, {str(ROOT)!r})
from tests.fakes.sound import square
options = dict(zip(sys.argv[1::2], sys.argv[2::2]))
journal = sys.argv[0] + ".journal"
def note(**what):
    with open(journal, "a") as file:
        file.write(json.dumps(what) + "\\n")
note(do="start", model=options["-m"], scale=options["--length-scale"])
for line in sys.stdin:
    note(do="line", text=line.strip())
    if "die" in line:
        sys.exit("Segmentation fault")
    path = options["--output-dir"] + "/" + str(time.monotonic_ns()) + ".wav"
    with wave.open(path, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate({RATE})
        out.writeframesraw(square(0.1 * float(options["--length-scale"]), 0.5))
    print("INFO:__main__:Wrote " + path, file=sys.stderr, flush=True)
"""


@pytest.fixture
def whisper_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "faster_whisper.py").write_text(WHISPER)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))


def whisper(folder: Path, *options: str) -> ResidentProgram:
    command = (sys.executable, "-m", whisper_transcriber.__name__, *options)
    return ResidentProgram(command, folder)


def test_any_python_runs_the_transcriber_also_one_without_woz_tui() -> None:
    words = [sys.executable, "-I", "-S", whisper_transcriber.__file__, "--model", "tiny.en"]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=100, check=False)
    assert "faster-whisper is not installed" in ended.stderr
    assert "install faster-whisper" in ended.stderr


@pytest.mark.usefixtures("whisper_module")
async def test_whisper(tmp_path: Path) -> None:
    program = whisper(tmp_path)
    parts: list[dict[str, Any]] = []

    async def ask(**request: str) -> Transcript:
        return await program.ask(request, Transcript, 30.0, parts.append)

    try:
        transcript = await ask(file="a.wav", language="en")
        assert (transcript.text, transcript.confidence) == ("hello en", 0.607)
        assert [(word.word, word.begin, word.end) for word in transcript.words] == [
            ("hello", 0.0, 0.5),
            ("en", 0.5, 1.0),
        ]
        assert [part["text"] for part in parts] == ["hello"]
        with pytest.raises(DriverError, match="no sound in it"):
            await ask(file="broken.wav")
        assert (await ask(file="a.wav")).text == "hello None"
    finally:
        await program.close()


@pytest.mark.usefixtures("whisper_module")
async def test_a_model_that_cannot_be_loaded(tmp_path: Path) -> None:
    program = whisper(tmp_path, "--model", "missing")
    try:
        with pytest.raises(DriverError, match="there is no such model"):
            await program.load(30.0)
    finally:
        await program.close()


async def test_whisper_that_is_not_installed_names_the_extra(tmp_path: Path) -> None:
    (tmp_path / "faster_whisper.py").write_text("raise ImportError('none')")
    command = ("env", f"PYTHONPATH={tmp_path}", sys.executable, "-m", whisper_transcriber.__name__)
    program = ResidentProgram(command, tmp_path)
    try:
        with pytest.raises(DriverError, match="pip install"):
            await program.load(30.0)
    finally:
        await program.close()


class Piper:
    """A voice by the adapter and a Piper that is a script."""

    def __init__(self, folder: Path, *options: str) -> None:
        program = folder / "piper"
        program.write_text(PIPER)
        program.chmod(0o700)
        self._journal = folder / "piper.journal"
        for name in ("en_US-joe-medium", "de_DE-eva-low", "en_GB-alba-medium"):
            (folder / f"{name}.onnx").touch()
            (folder / f"{name}.onnx.json").touch()
        words = ("{python}", "-m", piper_voice.__name__, "--piper", str(program), *options)
        settings = SynthesisSettings(resident_voice=words, cache=str(folder / "cache"))
        self.voice = SpeechSynthesis(settings, folder)

    async def say(self, text: str, **changes: str | int) -> PreparedUtterance:
        return await self.voice.utterance(text, VoiceChoice("", "", 160, 50).changed(changes))

    def started(self) -> list[tuple[str, str]]:
        """Model and scale of each Piper that was started."""
        return [
            (Path(str(line["model"])).stem, str(line["scale"]))
            for line in journal_entries(self._journal, "start")
        ]

    def lines(self) -> list[dict[str, object]]:
        return journal_entries(self._journal, "line")


@pytest.fixture
async def piper(tmp_path: Path) -> AsyncIterator[Piper]:
    made = Piper(tmp_path, "--model", "en_US-joe-medium")
    yield made
    await made.voice.close()


async def test_piper_stays_loaded_for_each_voice_and_speed(piper: Piper) -> None:
    assert (await piper.say("Hello")).sound.seconds == pytest.approx(0.1)
    assert (await piper.say("Hello", speed=80)).sound.seconds == pytest.approx(0.2)
    await piper.say("Hallo", language="de")
    await piper.say("Hi", language="en")
    await piper.say("Hello", voice="en_GB-alba-medium")
    await piper.say("Hello again")
    assert piper.started() == [
        ("en_US-joe-medium", "1.000"),
        ("en_US-joe-medium", "2.000"),
        ("de_DE-eva-low", "1.000"),
        ("en_GB-alba-medium", "1.000"),
    ], "one for each, and the usual one is not among the oldest"
    assert piper.lines()[0]["text"] == "Yes.", "it is loaded before it says that it is ready"


async def test_a_line_of_pipers_without_a_file_is_no_answer(tmp_path: Path) -> None:
    folder, script = tmp_path / "out", tmp_path / "piper.sh"
    folder.mkdir()
    script.write_text(
        f'while read text; do echo; echo "$text" > {folder}/$text.wav'
        f'; echo "Wrote {folder}/$text.wav"; done'
    )
    program = piper_voice.PiperProgram(("sh", str(script)), Path("model"), 160, folder)
    try:
        for text in ("one", "two"):
            assert (await asyncio.to_thread(program.speak, text)).read_text() == f"{text}\n"
    finally:
        program.end()


async def test_a_voice_that_is_not_there_names_those_that_are(piper: Piper) -> None:
    for changes in ({"voice": "nobody"}, {"language": "fr"}):
        with pytest.raises(DriverError, match="de_DE-eva-low"):
            await piper.say("Hello", **changes)
    assert (await piper.say("Hello")).sound.seconds > 0


async def test_a_piper_that_dies_costs_one_sentence(piper: Piper) -> None:
    with pytest.raises(DriverError, match="Segmentation fault"):
        await piper.say("die")
    assert (await piper.say("Hello")).sound.seconds > 0


async def test_no_model_at_all(tmp_path: Path) -> None:
    piper = Piper(tmp_path, "--model", "other")
    try:
        with pytest.raises(DriverError, match="there is no voice 'other'"):
            await piper.say("Hello")
    finally:
        await piper.voice.close()
