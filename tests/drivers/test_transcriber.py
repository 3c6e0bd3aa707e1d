"""Speech to text by any program: a good one, and slow, broken, chatty and hanging ones."""

from __future__ import annotations

import tempfile
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import psutil
import pytest
from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.microphone.transcriber import LONGEST, WAITING, one_line

from tests.drivers.microphones import microphone_opener
from tests.drivers.published_messages import PublishedMessages, until
from tests.fakes.child_processes import offspring
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import square
from woz_tui.drivers.contract import Finding, Probe
from woz_tui.protocol.messages import Notice, SpeechEnded, SpeechText
from woz_tui.system.clock import RealClock

Begin = Callable[..., Any]

SPOKEN = square(0.1, 0.5) + square(0.1, 0.01)


@pytest.fixture
def pipe(tmp_path: Path) -> PipedCommand:
    return PipedCommand(tmp_path / "pipe")


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where files go that are only lent."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture
async def begin(tmp_path: Path, pipe: PipedCommand) -> AsyncIterator[Begin]:
    async with microphone_opener(tmp_path) as some:

        async def started(script: str, **settings: Any) -> tuple[Microphone, PublishedMessages]:
            """A microphone whose transcriber is a shell script; `$1` is the file."""
            program = tmp_path / "transcriber"
            program.write_text(f"#!/bin/sh\n{script}\n")
            program.chmod(0o700)
            settings = {
                **{"command": pipe.command, "transcribe": "./transcriber {file}"},
                **{"threshold": 0.1, "hang_over": 0.04, "onset": 0.02, "pre_roll": 0.0},
                **settings,
            }
            opened = await some.open(RealClock(), **settings)
            await until(pipe.connected)
            return opened

        yield started


def names(folder: Path) -> list[str]:
    return [one.name for one in folder.iterdir()]


async def test_what_the_program_says_becomes_a_line_after_the_end_of_the_segment(
    begin: Begin, pipe: PipedCommand, scratch: Path
) -> None:
    microphone, published = await begin("echo '  Where are'; echo 'the whales?  '; wc -c < \"$1\"")
    pipe.send(SPOKEN)
    text = await published.first(SpeechText)
    ended = published.messages.index(published.all(SpeechEnded)[0])
    assert ended < published.messages.index(text)
    bytes_of_sound = (5 + 2) * 640
    assert (text.segment, text.text) == (1, f"Where are the whales? {bytes_of_sound + 44}")
    assert (text.driver, text.detail) == ("it", "")
    assert text.took_us > 0
    assert published.all(SpeechEnded)[0].file == "", "it was only lent"
    await until(lambda: not any(scratch.rglob("*.wav")))
    await microphone.close()
    assert names(scratch) == []
    assert not published.context.media.exists()


async def test_a_kept_file_stays_where_it_is(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin('basename "$1"', segments=True)
    pipe.send(SPOKEN)
    text = await published.first(SpeechText)
    assert text.text == "it-0001.wav"
    assert (published.context.folder / published.all(SpeechEnded)[0].file).exists()


async def test_nothing_understood_is_an_empty_text_and_no_trouble(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin("true")
    pipe.send(SPOKEN)
    text = await published.first(SpeechText)
    assert (text.text, text.detail) == ("", "")
    assert published.all(Notice) == []


async def test_a_program_that_crashes_is_told_of_once(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin("echo half a; echo 'no model' >&2; exit 3")
    for after in range(2):
        pipe.send(SPOKEN)
        text = await published.first(SpeechText, after=after)
        assert (text.text, text.detail) == ("", "./transcriber ended: no model")
    (notice,) = published.all(Notice)
    assert (notice.level, notice.text) == (
        "warning",
        "it: speech is not recognised: ./transcriber ended: no model",
    )


async def test_a_program_that_hangs_is_ended_with_its_children(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin("sleep 1000 & sleep 1000", transcribe_limit=1.0)
    pipe.send(SPOKEN)
    text = await published.first(SpeechText)
    assert text.detail == "./transcriber took longer than 1 s"
    await until(lambda: offspring(named="sleep") == [])


async def test_a_missing_program_says_so(begin: Begin, pipe: PipedCommand, tmp_path: Path) -> None:
    _, published = await begin("true")
    (tmp_path / "transcriber").unlink()
    pipe.send(SPOKEN)
    assert "does not exist" in (await published.first(SpeechText)).detail
    assert published.all(Notice)[0].remedy


async def test_a_slow_program_gets_one_at_a_time_and_what_waits_too_long_is_left_out(
    begin: Begin, pipe: PipedCommand, tmp_path: Path, scratch: Path
) -> None:
    gate = tmp_path / "gate"
    _, published = await begin(
        "mkdir busy || echo two at once; while [ ! -e gate ]; do sleep 0.02; done; rmdir busy"
    )
    for spoken in range(WAITING + 3):
        pipe.send(SPOKEN)
        await published.first(SpeechEnded, after=spoken)
        if not spoken:
            await until((tmp_path / "busy").exists)
    gate.touch()
    await published.first(SpeechText, after=WAITING + 2)
    texts = {text.segment: text for text in published.all(SpeechText)}
    left_out = "not recognised: ./transcriber is too slow"
    assert sorted(texts) == list(range(1, WAITING + 4)), "each segment has one answer"
    assert [n for n, text in sorted(texts.items()) if text.detail == left_out] == [2, 3]
    assert {text.text for text in texts.values()} == {""}, "never two at once"
    await until(lambda: not any(scratch.rglob("*.wav")))


async def test_it_leaves_the_processor_to_the_robot(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin("nice")
    pipe.send(SPOKEN)
    assert (await published.first(SpeechText)).text == "19"


async def test_closing_ends_it_and_leaves_no_file(
    begin: Begin, pipe: PipedCommand, scratch: Path
) -> None:
    microphone, published = await begin("sleep 1000")
    pipe.send(SPOKEN + SPOKEN)
    await published.first(SpeechEnded, after=1)
    await until(lambda: len(offspring(named="sleep")) == 1)
    children = [psutil.Process(one.pid) for one in offspring(named="sleep")]
    await microphone.close()
    _, left = psutil.wait_procs(children, timeout=10)
    assert left == []
    assert names(scratch) == []
    assert [text.segment for text in published.all(SpeechText)] == [1, 2]
    assert all("the session ended" in text.detail for text in published.all(SpeechText))


async def test_a_sound_that_cannot_be_written_has_no_text(
    begin: Begin, pipe: PipedCommand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", "/nowhere")
    _, published = await begin("echo hello")
    pipe.send(SPOKEN)
    text = await published.first(SpeechText)
    assert text.text == ""
    assert text.detail.startswith("its sound was not written: No such file")


async def test_lent_sound_is_private(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin('stat -c %a "$1" "$(dirname "$1")"')
    pipe.send(SPOKEN)
    assert (await published.first(SpeechText)).text == "600 700"


def test_output_becomes_one_line() -> None:
    assert one_line("\x1b[31m a\x00b \r\n\n c\t") == "[31m a b c"
    assert one_line("Grüße") == "Grüße"
    assert len(one_line("x" * 10_000)) == LONGEST


@pytest.mark.parametrize("wrong", ["whisper", "whisper {wav}", "whisper '{file}"])
def test_a_command_that_cannot_work_is_found_when_the_file_is_read(wrong: str) -> None:
    found = MicrophoneSettings(transcribe=wrong).problems()
    assert [name for name, _ in found] == ["transcribe"]


def test_segments_must_be_longer_than_their_beginning() -> None:
    found = MicrophoneSettings(pre_roll=2.0, longest=2.0).problems()
    assert [name for name, _ in found] == ["longest"]


async def test_doctor_misses_the_program(tmp_path: Path) -> None:
    (tmp_path / "sound.raw").write_bytes(square(1.5, 0.01))
    settings = MicrophoneSettings(command="cat sound.raw", transcribe="./whisper {file}")
    finding, missing = await Microphone.examine(Probe("ear", settings, tmp_path))
    assert finding.level == "ok"
    assert (missing.level, missing.subject) == ("error", "ear")
    assert "does not exist" in missing.text
    program = tmp_path / "whisper"
    program.touch()
    program.chmod(0o700)
    found: list[Finding] = await Microphone.examine(Probe("ear", settings, tmp_path))
    assert [finding.level for finding in found] == ["ok", "ok"]
