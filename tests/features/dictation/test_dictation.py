"""Dictation: a voice becomes text in the field of `say`, and never the visitor's."""

from __future__ import annotations

import asyncio
import fcntl
import io
import os
import re
import shutil
import struct
import subprocess
import sys
import termios
import wave
from argparse import Namespace
from array import array
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import msgspec
import pytest

from tests.console import scenes
from tests.console.dialogs import entry
from tests.console.piloting import ConsolePilot, piloted_console
from tests.features.phases.test_phases_on_screen import at
from tests.host.rig import Peer, ServedSession, served_session
from woz_tui.client import WozClient, WozRefusedError, connect
from woz_tui.console.screens.say import SayDialog
from woz_tui.features.dictation import in_session
from woz_tui.features.dictation.command import NoTranscriberError, transcriber_of
from woz_tui.features.dictation.dialog import DictationDialog
from woz_tui.features.dictation.dictating import CLOSED, OPEN, Dictating
from woz_tui.features.dictation.kinds import (
    AskDictated,
    AskDictation,
    Dictated,
    DictationListens,
    DictationSaid,
)
from woz_tui.features.dictation.speech_pieces import CHUNK, RATE, SpeechPieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskVerb, Reply

#: Writes how long the sound file is, in tenths of a second.
LENGTH = (
    "import sys, wave; w = wave.open(sys.argv[1]);"
    " print('spoke', round(10 * w.getnframes() / w.getframerate()), w.getnchannels())"
)


def tone(seconds: float, level: int = 8000) -> bytes:
    return array("h", [level, -level] * round(seconds * RATE / 2)).tobytes()


def unread(pipe: int) -> int:
    """Bytes that nobody has read yet."""
    (count,) = struct.unpack("i", fcntl.ioctl(pipe, termios.FIONREAD, bytes(4)))
    return int(count)


def options(transcribe: str = "", experiment: Path | None = None) -> Namespace:
    return Namespace(transcribe=transcribe, experiment=experiment)


def program(text: str = LENGTH) -> str:
    return f'"{sys.executable}" -c "{text}" {{file}}'


@asynccontextmanager
async def opened(folder: Path) -> AsyncIterator[tuple[ServedSession, Peer, WozClient]]:
    """A session with a wizard whose field is open, and `woz dictate`."""
    async with served_session(folder) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        assert (await wizard.ask("dictation", on=True))["ok"]
        async with connect(host.path, name="dictate", sees="wizard") as client:
            yield host, wizard, client


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine closes no field."""
    monkeypatch.setattr(in_session, "SILENT_S", 1000.0)


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
    async with opened(tmp_path) as (host, wizard, client):
        voice = io.BytesIO(tone(1.0) + tone(1.0, 10) + tone(0.5))
        transcriber = transcriber_of(options(program()), tmp_path)
        await Dictating(client, transcriber, tmp_path, told.append, 0.02).run(voice)
        await transcriber.close()
        assert [line.text for line in host.of(Dictated)] == ["spoke 18 1", "spoke 7 1"]
        assert told == [CLOSED, OPEN, "spoke 18 1", "spoke 7 1"]
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


@pytest.mark.real_clock
async def test_what_is_said_while_the_field_is_not_open_is_put_nowhere(tmp_path: Path) -> None:
    told: list[str] = []
    async with (
        served_session(tmp_path) as host,
        connect(host.path, name="dictate", sees="wizard") as client,
    ):
        with pytest.raises(WozRefusedError, match="not open"):
            await client.request(AskDictated(text="Nobody asked"))
        with pytest.raises(WozRefusedError, match="a wizard's console has the field"):
            await client.request(AskDictation(on=True))
        transcriber = transcriber_of(options(program("print('heard')")), tmp_path)
        reading, writing = os.pipe()
        with os.fdopen(reading, "rb", 0) as voice, os.fdopen(writing, "wb", 0) as mouth:
            work = Dictating(client, transcriber, tmp_path, told.append, 0.02)
            dictating = asyncio.create_task(work.run(voice))
            await host.until(lambda: told == [CLOSED])
            await asyncio.to_thread(mouth.write, tone(1.0) + tone(1.0, 10))
            await host.until(lambda: not unread(reading))
            wizard = await host.connect()
            await wizard.hello("wizard")
            assert (await wizard.ask("dictation", on=True))["ok"]
            await host.until(lambda: OPEN in told)
            await asyncio.to_thread(mouth.write, tone(0.5) + tone(1.0, 10))
            await host.until(lambda: len(host.of(Dictated)) == 1)
            assert (await wizard.ask("dictation", on=False))["ok"]
            await host.until(lambda: told[-1] == CLOSED)
            await asyncio.to_thread(mouth.write, tone(1.0) + tone(1.0, 10))
            mouth.close()
            await dictating
        await transcriber.close()
        assert [line.text for line in host.of(Dictated)] == ["heard"]
        listens = [(line.on, line.why) for line in host.of(DictationListens)]
        assert listens == [(True, ""), (False, "closed")]


@pytest.mark.real_clock
async def test_the_field_closes_with_its_console_by_the_stop_and_by_silence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with served_session(tmp_path) as host:
        first, second = await host.connect(), await host.connect()
        await first.hello("wizard")
        await second.hello("watcher")
        assert (await first.ask("dictation", on=True))["ok"]
        assert (await first.ask("dictation", on=True))["ok"], "it is still open"
        assert not (await second.ask("dictation", on=True))["ok"], "who watches says nothing"
        await first.ask("stop")
        still = await first.ask("dictation", on=True, again=True)
        assert not still["ok"], "what was under way opens nothing behind the stop"
        assert (await first.ask("dictation", on=True))["ok"]
        monkeypatch.setattr(in_session, "SILENT_S", 0.01)
        await first.ask("dictation", on=True)
        await host.until(lambda: len(host.of(DictationListens)) == 4)
        monkeypatch.setattr(in_session, "SILENT_S", 1000.0)
        assert (await first.ask("dictation", on=True))["ok"]
        first.leave()
        await host.until(lambda: len(host.of(DictationListens)) == 6)
        ends = [line.why for line in host.of(DictationListens) if not line.on]
        assert ends == ["stop", "silent", "left"]


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
    async with opened(tmp_path) as (host, wizard, client):
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
    async with opened(tmp_path) as (host, _, client):
        transcriber = transcriber_of(options(failing), tmp_path)
        await Dictating(client, transcriber, tmp_path, told.append, 0.02).run(io.BytesIO(tone(1.0)))
        assert told[:2] == [CLOSED, OPEN]
        assert len(told) == 3
        assert "no model" in told[2]
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


ATTACHED = m.ConsoleAttached(console="p1", role="program", name="dictate")


def listens(on: bool = True, console: str = "console1") -> DictationListens:
    return DictationListens(on=on, console=console)


async def test_its_key_opens_the_field_and_enter_says_what_came_into_it() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        await pilot.press("f10")
        assert isinstance(pilot.console.dialog, DictationDialog)
        assert pilot.feed.last(AskDictation) == AskDictation(ref=1, on=True)
        assert "| ssh ROBOT woz dictate" in " ".join(pilot.drawn().split())
        await at(pilot, ATTACHED, 4999)
        assert "begins to listen" in pilot.drawn()
        await at(pilot, listens(), 5000)
        assert "listens: what you say comes here" in pilot.drawn()
        await at(pilot, Dictated(dictation=1, text="It is a wale"), 5001)
        assert entry(pilot).value == "It is a wale"
        assert "look at it" not in pilot.drawn(), "she does"
        await pilot.press("backspace", "backspace", "backspace", "backspace")
        await pilot.type("whale.")
        await at(pilot, Dictated(dictation=2, text="And {big}."), 5002)
        assert entry(pilot).value == "It is a whale. And {{big}}."
        assert not pilot.feed.last(AskVerb), "she looks at it first"
        await pilot.pass_time(0.3)
        await pilot.press("enter")
        asked = pilot.feed.last(AskVerb)
        assert isinstance(asked, AskVerb)
        assert asked.args["text"] == "It is a whale. And {{big}}."
        closed = pilot.feed.last(AskDictation)
        assert isinstance(closed, AskDictation)
        assert not closed.on
        await at(pilot, listens(on=False), 5003)
        await pilot.press("f10")
        assert entry(pilot).value == ""


async def test_as_long_as_the_field_is_open_and_painted_it_says_so() -> None:
    async with piloted_console() as pilot:

        def said() -> list[bool]:
            return [each.on for each in pilot.feed.asked if isinstance(each, AskDictation)]

        await pilot.press("f10")
        assert said() == [True]
        await pilot.pass_time(0.1)
        assert said() == [True]
        await pilot.pass_time(0.5)
        assert said() == [True, True]
        pilot.feed.line_ok = False
        await pilot.pass_time(5)
        assert said() == [True, True], "nobody sees the field"
        pilot.feed.line_ok, pilot.feed.attached = True, False
        await pilot.pass_time(5)
        assert said() == [True, True], "nobody sits there"
        pilot.feed.attached = True
        await pilot.pass_time(0.1)
        await pilot.press("escape")
        assert pilot.console.dialog is None
        assert said() == [True, True, True, False]
        await pilot.pass_time(5)
        assert len(said()) == 4


async def test_a_field_that_was_silent_for_too_long_opens_anew() -> None:
    async with piloted_console() as pilot:
        await pilot.press("f10")
        pilot.feed.answers[AskDictation] = lambda request, ref: Reply(ref=ref, ok=False)
        await pilot.pass_time(0.6)
        del pilot.feed.answers[AskDictation]
        await pilot.pass_time(0.6)
        said = [each for each in pilot.feed.asked if isinstance(each, AskDictation)]
        assert [each.again for each in said[:2]] == [False, True]
        assert not said[2].again
        assert said[-1].on


async def test_a_stop_by_somebody_else_closes_the_field_for_good() -> None:
    async with piloted_console() as pilot:

        def said() -> list[bool]:
            return [each.on for each in pilot.feed.asked if isinstance(each, AskDictation)]

        await pilot.press("f10")
        await at(pilot, listens(), 5000)
        await pilot.type("A whale")
        await at(pilot, m.StopPressed(source="program"), 5001)
        await at(pilot, DictationListens(on=False, console="console1", why="stop"), 5002)
        await pilot.pass_time(5)
        assert pilot.console.dialog is None
        assert said() == [True, False]
        await at(pilot, listens(), 5003)  # which a session says before it answers
        await pilot.press("f10")
        await pilot.pass_time(0.6)
        assert entry(pilot).value == "A whale"
        assert said() == [True, False, True, True]


async def test_what_is_dictated_at_another_console_does_not_come_into_this_field() -> None:
    async with piloted_console() as pilot:
        await at(pilot, listens(console="c0"), 5000)
        await pilot.press("f10")
        await pilot.type("Hello")
        await at(pilot, Dictated(dictation=1, text="Of somebody else"), 5001)
        assert entry(pilot).value == "Hello"
        await at(pilot, listens(on=False, console="c0"), 5002)
        await at(pilot, listens(), 5003)
        assert entry(pilot).value == "Hello"
        await at(pilot, Dictated(dictation=2, text="there."), 5004)
        assert entry(pilot).value == "Hello there."


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_enter_does_not_say_a_text_that_came_just_before_it(size: tuple[int, int]) -> None:
    async with piloted_console(size=size) as pilot:
        await pilot.press("f10")
        await pilot.type("Hello.")
        await at(pilot, listens(), 5000)
        await at(pilot, Dictated(dictation=1, text="What was I to say?"), 5001)
        await pilot.press("enter")
        assert not pilot.feed.last(AskVerb)
        assert "a text had only just come; press enter again" in pilot.drawn()
        assert entry(pilot).value == "Hello. What was I to say?"
        await pilot.pass_time(0.3)
        await pilot.press("enter")
        asked = pilot.feed.last(AskVerb)
        assert isinstance(asked, AskVerb)
        assert asked.args["text"] == "Hello. What was I to say?"


def boxed(pilot: ConsolePilot) -> str:
    """What stands in the dialog."""
    return " ".join("".join(re.findall(r"│(.*)│", pilot.drawn())).split())


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_a_text_that_the_field_is_too_short_for_is_read_below(size: tuple[int, int]) -> None:
    long = "This whale was found on the beach by two fishermen, and sold to a museum at once."
    async with piloted_console(size=size) as pilot:
        await pilot.press("f10")
        await at(pilot, listens(), 5000)
        await at(pilot, Dictated(dictation=1, text="Hello."), 5001)
        assert boxed(pilot).count("Hello.") == 1
        await at(pilot, Dictated(dictation=2, text=f"{long} {long}"), 5002)
        assert f"Hello. {long} {long}" in boxed(pilot)
        await pilot.press("ctrl+q", "f10")
        await pilot.pass_time(0.1)
        assert f"Hello. {long} {long}" in boxed(pilot), "it is the draft now"


async def test_a_refusal_stands_in_the_field() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[AskDictation] = lambda request, ref: Reply(
            ref=ref, ok=False, reason="somebody dictates at another console already"
        )
        await pilot.press("f10")
        assert "somebody dictates at another console already" in pilot.drawn()


async def test_after_a_lost_line_nothing_stands_there_twice() -> None:
    texts = [
        Dictated(dictation=n, text=text) for n, text in ((1, "One."), (2, "Two."), (3, "Three."))
    ]
    said = DictationSaid(command="c1", dictations=[1])
    async with piloted_console() as pilot:
        for seq, message in enumerate((listens(), *texts[:2], said), 5000):
            await at(pilot, message, seq)
        await pilot.press("f10")
        assert entry(pilot).value == "Two."
        recent = [listens(), *texts[:2], said, texts[2]]
        placed = [msgspec.structs.replace(line, t=scenes.NOW) for line in recent]
        await pilot.tell(scenes.welcome(recent=placed))
        assert entry(pilot).value == "Two. Three."


async def test_a_console_that_is_attached_anew_gets_the_newest_text_alone() -> None:
    texts = [Dictated(dictation=n, text=f"Text {n}.") for n in range(1, 5)]
    recent = [listens(console="c0"), *texts[:3], listens(on=False, console="c0"), texts[3]]
    placed = [msgspec.structs.replace(line, t=scenes.NOW) for line in recent]
    async with piloted_console(scenes.welcome(recent=placed)) as pilot:
        await pilot.press("f10")
        assert entry(pilot).value == "Text 4."
        await pilot.press("ctrl+q", "f10")
        assert entry(pilot).value == "Text 4.", "it is the draft now"


async def test_the_usual_field_gets_nothing_that_is_dictated() -> None:
    async with piloted_console() as pilot:
        await at(pilot, Dictated(dictation=1, text="It is a whale"), 5000)
        assert "Dictated: It is a whale; press F10 to look at it" in pilot.drawn()
        await pilot.press("slash")
        assert type(pilot.console.dialog) is SayDialog
        assert entry(pilot).value == ""
