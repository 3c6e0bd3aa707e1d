"""The programs of docs/how-to/speech-programs.md are run as they stand there."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from woz_drivers.microphone.transcriber import Transcript
from woz_drivers.programs.resident_program import ResidentProgram
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.settings import SynthesisSettings
from woz_drivers.speech.synthesis import SpeechSynthesis

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "speech-programs.md"


def program(folder: Path, heading: str) -> tuple[str, ...]:
    """The program below a heading, as a command."""
    _, _, below = PAGE.read_text().partition(f"### {heading}\n")
    found = re.search(r"```python\n(.*?)```", below, re.DOTALL)
    assert found is not None
    script = folder / "program.py"
    script.write_text(found[1])
    assert len(found[1].splitlines()) <= 12
    return (sys.executable, str(script))


async def test_the_transcriber(tmp_path: Path) -> None:
    sound = tmp_path / "sound.wav"
    sound.write_bytes(Wav("S16_LE", 16_000, 1, bytes(2 * 24_000)).to_bytes())
    transcriber = ResidentProgram(program(tmp_path, "Transcribers"), tmp_path)
    try:
        for _ in range(2):
            answer = await transcriber.ask({"file": str(sound)}, Transcript, 30.0)
            assert (answer.text, answer.words[0].end) == ("1.5 seconds of sound", 1.5)
    finally:
        await transcriber.close()


async def test_the_voice(tmp_path: Path) -> None:
    settings = SynthesisSettings(
        resident_voice=program(tmp_path, "Voices"), cache=str(tmp_path / "cache")
    )
    voice = SpeechSynthesis(settings, tmp_path)
    try:
        for text in ("Hello", "Hi"):
            prepared_utterance = await voice.utterance(text)
            assert (prepared_utterance.sound.rate, prepared_utterance.sound.seconds) == (
                16_000,
                0.05 * len(text),
            )
    finally:
        await voice.close()
