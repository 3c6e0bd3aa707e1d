"""A voice is dictated: a real Whisper understands what espeak-ng says, in the field of `say`."""

from __future__ import annotations

import io
import json
import subprocess
import wave
from array import array
from pathlib import Path

import pytest
from woz_drivers.microphone import whisper_transcriber

from tests.features.dictation.test_dictation import opened
from tests.peers.places import place
from woz_tui.drivers.plugins import installed
from woz_tui.features.dictation import in_session
from woz_tui.features.dictation.dictating import Dictating
from woz_tui.features.dictation.kinds import Dictated
from woz_tui.features.dictation.speech_pieces import RATE
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.peers


def spoken(text: str) -> bytes:
    """A sentence as `arecord` would write it, and a pause behind it."""
    made = subprocess.run(
        ["espeak-ng", "-v", "en-us", "-s", "140", "--stdout", text], capture_output=True, check=True
    )
    with wave.open(io.BytesIO(made.stdout)) as sound:
        rate = sound.getframerate()
        samples = array("h", sound.readframes(1 << 24))
    count = len(samples) * RATE // rate
    voice = array("h", [samples[min(len(samples) - 1, i * rate // RATE)] for i in range(count)])
    return voice.tobytes() + bytes(2 * RATE)


async def test_two_sentences_become_two_texts_and_nobodys_speech(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = place("whisper")
    words = (there / "bin" / "python", whisper_transcriber.__file__, "--model", there / "model")
    microphone = installed()["microphone"]
    settings = microphone.Settings(
        resident_transcriber=tuple(map(str, words)), language="en", transcribe_limit=60.0
    )
    transcriber = microphone.transcriber(settings, tmp_path)
    assert transcriber is not None
    told: list[str] = []
    voice = spoken("Good morning, and welcome to the museum.")
    voice += spoken("What would you like to see today?")
    monkeypatch.setattr(in_session, "SILENT_S", 1000.0)
    async with opened(tmp_path) as (host, _, client):
        try:
            await Dictating(client, transcriber, tmp_path, told.append, 0.02).run(io.BytesIO(voice))
        finally:
            await transcriber.close()
        texts = [line.text.lower() for line in host.of(Dictated)]
        assert host.of(m.SpeechText) == []
    assert len(texts) == 2, json.dumps(told)
    assert "welcome to the" in texts[0]
    assert "like to see" in texts[1]
