"""Dictation: a voice becomes text in the field of `say`, and never the visitor's."""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
import wave
from argparse import Namespace
from array import array
from pathlib import Path

import msgspec
import pytest

from tests.console import scenes
from tests.console.dialogs import entry
from tests.console.piloting import piloted_console
from tests.features.phases.test_phases_on_screen import at
from tests.host.rig import served_session
from woz_tui.client import WozRefusedError, connect
from woz_tui.console.screens.say import SayDialog
from woz_tui.features.dictation.command import NoTranscriberError, transcriber_of
from woz_tui.features.dictation.dictating import Dictating
from woz_tui.features.dictation.kinds import AskDictated, Dictated, DictationSaid
from woz_tui.features.dictation.speech_pieces import CHUNK, RATE, SpeechPieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskVerb

#: Writes how long the sound file is, in tenths of a second.
LENGTH = (
    "import sys, wave; w = wave.open(sys.argv[1]);"
    " print('spoke', round(10 * w.getnframes() / w.getframerate()), w.getnchannels())"
)


def tone(seconds: float, level: int = 8000) -> bytes:
    return array("h", [level, -level] * round(seconds * RATE / 2)).tobytes()


def options(transcribe: str = "", experiment: Path | None = None) -> Namespace:
    return Namespace(transcribe=transcribe, experiment=experiment)


def program(text: str = LENGTH) -> str:
    return f'"{sys.executable}" -c "{text}" {{file}}'


def test_a_voice_is_cut_at_pauses() -> None:
    pieces = SpeechPieces(0.02)
    voice = tone(0.5, 10) + tone(1.0) + tone(1.2, 10) + tone(0.5)
    found = [piece for i in range(0, len(voice), 777) for piece in pieces.add(voice[i : i + 777])]
    found += pieces.end()
    seconds = [round(len(piece) / 2 / RATE, 2) for piece in found]
    assert seconds == [0.3 + 1.0 + 0.8, 0.3 + 0.5]
    assert all(len(piece) % CHUNK == 0 for piece in found)
    assert [*SpeechPieces(0.02).add(tone(3, 10))] == []


@pytest.mark.real_clock
async def test_the_text_comes_to_the_session_and_the_log_knows_of_which_sentence(
    tmp_path: Path,
) -> None:
    told: list[str] = []
    async with (
        served_session(tmp_path) as host,
        connect(host.path, name="dictate", sees="wizard") as client,
    ):
        wizard = await host.connect()
        await wizard.hello("wizard")
        voice = io.BytesIO(tone(1.0) + tone(1.0, 10) + tone(0.5))
        transcriber = transcriber_of(options(program()), tmp_path)
        await Dictating(client, transcriber, tmp_path, told.append, 0.02).run(voice)
        await transcriber.close()
        assert [line.text for line in host.of(Dictated)] == ["spoke 18 1", "spoke 7 1"] == told
        assert [line.lasted_us for line in host.of(Dictated)] == [1_800_000, 700_000]
        assert host.of(m.SpeechText, m.SpeechStarted) == [], "it is no visitor's"
        assert host.driver().calls == [], "nothing is said by that"
        assert (await wizard.kind("dictated"))["text"] == "spoke 18 1"
        for text in ("Something else altogether!", "I spoke 18 1, spoke 7 1", "spoke 7 1"):
            ask = {"verb": "say", "args": {"text": text}, "source": "key"}
            assert (await wizard.ask("verb", **ask))["ok"]
        said = {line.command: line.args["text"] for line in host.of(m.Command)}
        (row,) = host.of(DictationSaid)
        assert said[row.command] == "I spoke 18 1, spoke 7 1"
        assert row.dictations == [1, 2]
        assert 0 < row.distance < 0.2
        assert not (tmp_path / "dictated.wav").exists(), "no sound is kept"


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("How are you today?", [4]),
        ("What a nice hat! How are you today?", [3, 4]),
        ("What a nice hat!", [3]),
        ("Something else altogether, which nobody dictated", []),
    ],
)
async def test_what_the_wizard_took_out_of_the_field_was_not_said(
    tmp_path: Path, typed: str, said: list[int]
) -> None:
    async with (
        served_session(tmp_path) as host,
        connect(host.path, name="dictate", sees="wizard") as client,
    ):
        wizard = await host.connect()
        await wizard.hello("wizard")
        for text in (
            "Good morning everybody",
            "Hm, no, not that",
            "What a nice hat",
            "How are you",
        ):
            await client.request(AskDictated(text=text))
        ask = {"verb": "say", "args": {"text": typed}, "source": "key"}
        assert (await wizard.ask("verb", **ask))["ok"]
        assert [row.dictations for row in host.of(DictationSaid)] == ([said] if said else [])


@pytest.mark.real_clock
async def test_a_recogniser_that_fails_is_told_and_the_next_piece_comes(tmp_path: Path) -> None:
    told: list[str] = []
    failing = program("import sys; sys.exit('no model')")
    async with (
        served_session(tmp_path) as host,
        connect(host.path, name="dictate", sees="wizard") as client,
    ):
        transcriber = transcriber_of(options(failing), tmp_path)
        await Dictating(client, transcriber, tmp_path, told.append, 0.02).run(io.BytesIO(tone(1.0)))
        assert len(told) == 1
        assert "no model" in told[0]
        with pytest.raises(WozRefusedError, match="nothing was dictated"):
            await client.request(AskDictated(text=" \x1b "))
        assert host.of(Dictated) == []


@pytest.mark.skipif(shutil.which("espeak-ng") is None, reason="espeak-ng is not installed")
def test_a_sentence_of_espeak_is_one_piece() -> None:
    spoken = subprocess.run(
        ["espeak-ng", "-v", "en", "--stdout", "Good morning, and welcome to the museum."],
        capture_output=True,
        check=True,
    ).stdout
    with wave.open(io.BytesIO(spoken)) as sound:
        rate = sound.getframerate()
        samples = array("h", sound.readframes(1 << 20))
    wanted = range(round(len(samples) * RATE / rate))
    voice = array("h", [samples[min(len(samples) - 1, i * rate // RATE)] for i in wanted])
    pieces = SpeechPieces(0.02)
    found = [*pieces.add(voice.tobytes() + tone(1.0, 0))]
    assert len(found) == 1
    assert len(found[0]) / 2 / RATE > 1.5


def test_what_understands_it_is_the_microphones_of_the_experiment(tmp_path: Path) -> None:
    file = tmp_path / "study.yaml"
    lines = (
        "title: T",
        "robot:",
        "  drivers:",
        "    voice: {type: speech}",
        "    ear: {type: microphone%s}",
        "panels: [{title: P, actions: [{key: h, label: Hi, say: Hello}]}]",
    )
    file.write_text("\n".join(lines) % f", transcribe: [{sys.executable}, x.py, '{{file}}']")
    assert transcriber_of(options(experiment=file), tmp_path) is not None
    file.write_text("\n".join(lines) % "")
    with pytest.raises(NoTranscriberError, match="no microphone with transcribe"):
        transcriber_of(options(experiment=file), tmp_path)
    with pytest.raises(NoTranscriberError, match=r"\{file\}"):
        transcriber_of(options("whisper"), tmp_path)
    with pytest.raises(NoTranscriberError, match="--experiment FILE"):
        transcriber_of(options(), tmp_path)


async def test_it_stands_in_the_field_of_say_and_enter_says_it() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        await at(pilot, Dictated(dictation=1, text="It is a wale"), 5000)
        assert "Dictated: It is a wale; press / to look at it" in pilot.drawn()
        await pilot.press("slash")
        assert isinstance(pilot.console.dialog, SayDialog)
        assert entry(pilot).value == "It is a wale"
        await pilot.press("backspace", "backspace", "backspace", "backspace")
        await pilot.type("whale.")
        await at(pilot, Dictated(dictation=2, text="And {big}."), 5001)
        assert entry(pilot).value == "It is a whale. And {{big}}."
        assert not pilot.feed.last(AskVerb), "she looks at it first"
        await pilot.press("enter")
        asked = pilot.feed.last(AskVerb)
        assert isinstance(asked, AskVerb)
        assert asked.args["text"] == "It is a whale. And {{big}}."
        await pilot.press("slash")
        assert entry(pilot).value == ""


async def test_after_a_lost_line_nothing_stands_there_twice() -> None:
    texts = [
        Dictated(dictation=n, text=text) for n, text in ((1, "One."), (2, "Two."), (3, "Three."))
    ]
    said = DictationSaid(command="c1", dictations=[1])
    async with piloted_console() as pilot:
        for seq, message in enumerate((*texts[:2], said), 5000):
            await at(pilot, message, seq)
        await pilot.press("slash")
        assert entry(pilot).value == "Two."
        recent = [*texts[:2], said, texts[2]]
        placed = [msgspec.structs.replace(line, t=scenes.NOW) for line in recent]
        await pilot.tell(scenes.welcome(recent=placed))
        assert entry(pilot).value == "Two. Three."


async def test_a_wizard_who_dictates_nothing_has_the_usual_field() -> None:
    async with piloted_console() as pilot:
        await pilot.press("slash")
        assert type(pilot.console.dialog) is SayDialog
