"""Threads write the files of speech: what happens there is told, and nothing is kept busy."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from woz_drivers.microphone.segment_files import SegmentFiles
from woz_drivers.microphone.transcriber import (
    ProgramForEachSegment,
    SpeechToTranscribe,
    Transcriber,
)

from tests.drivers.published_messages import until
from woz_tui.protocol.messages import SpeechText
from woz_tui.testing import RecordingContext


@pytest.fixture
def files() -> SegmentFiles:
    return SegmentFiles(16_000, lambda error: None)


async def test_a_failure_that_is_no_disk_s_is_told_and_frees_the_writer(
    files: SegmentFiles, tmp_path: Path
) -> None:
    for _ in range(20):
        with pytest.raises(ValueError, match="null"):
            await files.keep(tmp_path / "a\0b.wav", b"\0\0")
    assert (await files.keep(tmp_path / "a.wav", b"\0\0")).read_bytes().startswith(b"RIFF")


async def test_a_system_without_another_thread_is_told_and_frees_the_writer(
    files: SegmentFiles, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none_left(thread: object) -> None:
        raise RuntimeError("can't start new thread")

    with monkeypatch.context() as patch:
        patch.setattr("threading.Thread.start", none_left)
        for _ in range(20):
            with pytest.raises(OSError, match="new thread"):
                await files.keep(tmp_path / "a.wav", b"\0\0")
    assert (await files.keep(tmp_path / "a.wav", b"\0\0")).exists()


async def test_a_segment_that_cannot_be_read_costs_only_its_own_text(tmp_path: Path) -> None:
    context = RecordingContext(tmp_path)
    transcriber = Transcriber(
        "ear", ProgramForEachSegment(("echo", "hello"), 30.0, tmp_path), context
    )
    transcriber.start()
    loop = asyncio.get_running_loop()
    for number, trouble in ((1, ValueError("no such sound")), (2, None)):
        file: asyncio.Future[Path] = loop.create_future()
        if trouble is None:
            file.set_result(tmp_path / "a.wav")
        else:
            file.set_exception(trouble)
        transcriber.add(SpeechToTranscribe(number, file, 0, 0))
    await until(lambda: len(context.told) == 2)
    await transcriber.close()
    texts = [told for told in context.told if isinstance(told, SpeechText)]
    assert [(speech_text.text, speech_text.detail) for speech_text in texts] == [
        ("", "ValueError: no such sound"),
        ("hello", ""),
    ]


async def test_lent_sound_is_given_back_however_much_of_it_comes_at_once(
    files: SegmentFiles,
) -> None:
    lent = [await files.lend(f"{number}.wav", b"\0\0") for number in range(20)]
    assert all(path.exists() for path in lent)
    await asyncio.gather(*map(files.give_back, lent))
    assert not any(path.exists() for path in lent)
    files.close()
