"""A transcriber that stays loaded: a good one, and one that dies, hangs, babbles or is late."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.microphone import doctor
from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.microphone.transcriber import TRANSCRIBER
from woz_drivers.programs import byte_stream
from woz_drivers.programs.child_process import RestartPauses

from tests.drivers.microphones import microphone_opener
from tests.drivers.published_messages import PublishedMessages, until
from tests.drivers.resident_programs import ROOT, command, processes
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import journal_entries, square
from woz_tui.drivers.contract import SPEECH, Probe
from woz_tui.protocol.messages import Notice, Reading, SpeechEnded, SpeechText
from woz_tui.system.clock import RealClock

Begin = Callable[..., Any]

BLOCK = 640
SPOKEN = square(0.1, 0.5) + square(0.1, 0.01)
SECOND = "hello 4524"  # what the fake makes of SPOKEN: 7 blocks and the header


@pytest.fixture(autouse=True)
def importable(monkeypatch: pytest.MonkeyPatch) -> None:
    """The script is found from wherever it is started."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


@pytest.fixture(autouse=True)
def silent_ear(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between two sentences no sound comes, however long a text takes: that ends no stream."""
    monkeypatch.setattr(byte_stream, "_STALE_S", 60.0)
    monkeypatch.setattr(byte_stream, "_STUCK_S", 60.0)


@pytest.fixture
def journal(tmp_path: Path) -> Path:
    return tmp_path / "journal"


@pytest.fixture
def pipe(tmp_path: Path) -> PipedCommand:
    return PipedCommand(tmp_path / "pipe")


@pytest.fixture
async def begin(tmp_path: Path, pipe: PipedCommand, journal: Path) -> AsyncIterator[Begin]:
    async with microphone_opener(tmp_path) as some:

        async def started(
            *behaviours: str, **settings: Any
        ) -> tuple[Microphone, PublishedMessages]:
            settings = {
                **{"command": pipe.command, "threshold": 0.1, "hang_over": 0.04, "onset": 0.02},
                **{"pre_roll": 0.0, "resident_transcriber": command(journal, *behaviours)},
                **settings,
            }
            opened = await some.open(RealClock(), **settings)
            await until(pipe.connected)
            return opened

        yield started


async def texts(published: PublishedMessages, pipe: PipedCommand, count: int) -> list[SpeechText]:
    """What becomes of so many sentences, one after the other."""
    found = []
    for number in range(count):
        pipe.send(SPOKEN)
        found.append(await published.first(SpeechText, after=number))
    return found


async def test_it_is_started_once_and_understands_sentence_after_sentence(
    begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    microphone, published = await begin("ok", language="en")
    await published.state(TRANSCRIBER, "ready")
    one, two = await texts(published, pipe, 2)
    assert (one.segment, one.text, one.detail) == (1, SECOND, "")
    assert (two.segment, two.text, two.confidence) == (2, SECOND, 0.75)
    assert (two.language, two.partials, two.first_us) == ("en", 0, None)
    ended = published.all(SpeechEnded)[1]
    (word,) = two.words
    assert (word.text, word.began - ended.began, word.ended - ended.began) == (
        "hello",
        100_000,
        300_000,
    )
    assert len(journal_entries(journal, "start")) == 1
    assert [line["language"] for line in journal_entries(journal, "request")] == ["en", "en"]
    delays = [reading for reading in published.all(Reading) if reading.sensor == TRANSCRIBER]
    assert [reading.unit for reading in delays] == ["s", "s"]
    assert delays[0].value == round(one.took_us / 1_000_000, 2)
    await microphone.close()
    assert published.all(Notice) == []


async def test_it_is_loaded_with_the_session_and_what_is_said_meanwhile_is_understood_later(
    begin: Begin, pipe: PipedCommand, tmp_path: Path
) -> None:
    _, published = await begin("slow", "ok")
    await published.state(TRANSCRIBER, "loading")
    pipe.send(SPOKEN)
    await published.first(SpeechEnded)
    (tmp_path / "loaded").touch()
    assert (await published.first(SpeechText)).text == SECOND


async def test_one_that_dies_is_told_of_with_a_remedy_and_started_again(
    begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin("die", "ok")
    lost, speech_text = await texts(published, pipe, 2)
    assert lost.text == ""
    assert "out of memory" in lost.detail
    assert speech_text.text == SECOND
    assert len(journal_entries(journal, "start")) == 2
    (notice,) = published.all(Notice)
    assert "out of memory" in notice.text
    assert str(journal) in notice.remedy, "it names the command"
    assert published.states(TRANSCRIBER) == ["loading", "ready", "stale", "loading", "ready"]


async def test_one_that_dies_between_two_sentences_is_back_for_the_next(
    begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin("ok")
    await texts(published, pipe, 1)
    await until(lambda: len(journal_entries(journal, "start")) == 1)
    heard_before = len(published.all(Notice))
    for one in processes(journal):
        one.kill()
    await published.state(TRANSCRIBER, "stale")
    assert len(published.all(Notice)) == heard_before + 1
    pipe.send(SPOKEN)
    assert (await published.first(SpeechText, after=1)).text == SECOND


@pytest.mark.parametrize("behaviour", ["hang", "babble"])
async def test_one_that_does_not_answer_is_ended_and_started_again(
    behaviour: str, begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin(behaviour, "ok", transcribe_limit=3.0)
    lost, speech_text = await texts(published, pipe, 2)
    assert "did not answer within 3 s" in lost.detail
    assert ("Segment 1 of 1" in lost.detail) == (behaviour == "babble")
    assert speech_text.text == SECOND
    assert len(processes(journal)) == 1


@pytest.mark.parametrize("behaviour", ["twice", "late", "nonsense", "parts"])
async def test_what_is_no_answer_is_passed_over(
    behaviour: str, begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin(behaviour)
    assert [text.text for text in await texts(published, pipe, 2)] == [SECOND, SECOND]
    assert len(journal_entries(journal, "start")) == 1
    assert published.all(Notice) == []


async def test_a_wrong_answer_and_an_error_cost_one_sentence(
    begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin("wrong", "error", "ok")
    wrong, error, speech_text = await texts(published, pipe, 3)
    assert "wrong answer" in wrong.detail
    assert "no such voice" in error.detail
    assert speech_text.text == SECOND
    assert len(journal_entries(journal, "start")) == 1


async def test_a_line_that_never_ends_is_given_up_and_a_long_one_is_cut(
    begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin("endless", "long")
    endless, long = await texts(published, pipe, 2)
    assert "more than 1 MiB" in endless.detail
    assert long.text.startswith("x x x")
    assert len(long.text) == 2000
    assert len(journal_entries(journal, "start")) == 2


async def test_one_that_does_not_come_up_holds_nothing_up(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin("unloadable")
    found = await texts(published, pipe, 2)
    assert all("no model" in text.detail for text in found)
    assert len(published.all(Notice)) == 1


async def test_what_is_said_so_far_is_shown_while_they_speak(
    begin: Begin, pipe: PipedCommand, journal: Path
) -> None:
    _, published = await begin("ok", partial_texts=0.2)
    await published.state(TRANSCRIBER, "ready")
    pipe.send(square(0.24, 0.5))

    def so_far() -> list[str]:
        return [reading.text for reading in published.all(Reading) if reading.sensor == SPEECH]

    await until(lambda: bool(so_far()))
    assert so_far() == [f"hello {44 + 10 * BLOCK}"]
    assert published.all(SpeechText) == []
    pipe.send(square(0.1, 0.01))
    final = await published.first(SpeechText)
    assert final.text == f"hello {44 + 14 * BLOCK}"
    assert so_far()[1:] == [final.text], "it takes the place of the text so far"
    assert (final.partials, final.revised) == (1, 0)
    assert final.first_us is not None
    assert [line["do"] for line in journal_entries(journal)] == ["start", "request", "request"]


async def test_parts_of_an_answer_are_shown_before_it(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin("parts")
    await texts(published, pipe, 1)
    so_far = [reading.text for reading in published.all(Reading) if reading.sensor == SPEECH]
    assert so_far == ["hel", SECOND]


async def test_a_program_may_tell_the_language_that_it_found(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin("language")
    (text,) = await texts(published, pipe, 1)
    assert (text.text, text.language) == (SECOND, "de")


async def test_doctor_loads_it(
    tmp_path: Path, journal: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sound.raw").write_bytes(square(1.5, 0.01))
    for behaviour, level in (("ok", "ok"), ("unloadable", "error"), ("slow", "warning")):
        patience = 0.2 if behaviour == "slow" else 40.0
        monkeypatch.setattr(doctor, "_LOAD_PATIENCE_S", patience)
        settings = MicrophoneSettings(
            command="cat sound.raw", resident_transcriber=command(journal, behaviour)
        )
        _, finding = await Microphone.examine(Probe("ear", settings, tmp_path))
        assert finding.level == level
        assert processes(journal) == []


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"resident_transcriber": "a", "transcribe": "b {file}"}, "transcribe"),
        ({"resident_transcriber": "a {file}"}, "resident_transcriber"),
        ({"language": "en"}, "language"),
        ({"transcribe": "b {file}", "partial_texts": 1.0}, "partial_texts"),
    ],
)
def test_settings_that_contradict_each_other(settings: dict[str, Any], name: str) -> None:
    assert [found for found, _ in MicrophoneSettings(**settings).problems()] == [name]


def test_pauses_grow_until_a_run_goes_well() -> None:
    pauses = RestartPauses()
    assert [pauses.after_run(0) for _ in range(7)] == [0.5, 1, 2, 4, 8, 10, 10]
    assert [pauses.after_run(60), pauses.after_run(1)] == [0.5, 1]
