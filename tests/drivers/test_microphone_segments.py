"""Speech in segments: their times, their sound sample by sample, and what a disk may do."""

from __future__ import annotations

import errno
import os
import threading
import wave
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from woz_drivers.microphone import speech_segments
from woz_drivers.microphone.driver import Microphone
from woz_drivers.sound import pcm_audio

from tests.drivers.microphones import microphone_opener
from tests.drivers.published_messages import PATIENCE_S, PublishedMessages, until
from tests.fakes.piped_command import PipedCommand
from tests.fakes.sound import RATE, square
from woz_tui.protocol.messages import Notice, SensorChanged, SpeechEnded, SpeechStarted
from woz_tui.system.clock import ManualClock

Begin = Callable[..., Any]

#: Bytes of a block of 20 ms.
BLOCK = RATE // 50 * 2
EAR: dict[str, Any] = {"threshold": 0.1, "onset": 0.04, "hang_over": 0.1, "pre_roll": 0.06}


@pytest.fixture
def pipe(tmp_path: Path) -> PipedCommand:
    return PipedCommand(tmp_path / "pipe")


@pytest.fixture(autouse=True)
def slow_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files are waited for in real time, and a disk of a busy machine may be slow."""
    monkeypatch.setattr(speech_segments, "_FILE_S", PATIENCE_S)


@pytest.fixture
async def begin(tmp_path: Path) -> AsyncIterator[Begin]:
    async with microphone_opener(tmp_path) as some:

        async def started(
            pipe: PipedCommand, **settings: Any
        ) -> tuple[Microphone, PublishedMessages]:
            settings = {"command": pipe.command, **EAR, **settings}
            opened = await some.open(ManualClock(), "ears", **settings)
            await until(pipe.connected)
            return opened

        yield started


def ramp(blocks: int, level: float) -> bytes:
    """Blocks whose levels rise by a little from one to the next: each is unlike all others."""
    return b"".join(square(0.02, level + n * 0.0005) for n in range(blocks))


def utterance(before: int = 10, loud: int = 5, after: int = 10) -> bytes:
    return ramp(before, 0.01) + ramp(loud, 0.5) + ramp(after, 0.02)


def segment_samples(published: PublishedMessages, speech_ended: SpeechEnded) -> bytes:
    """The samples in a segment's file, read by somebody else's code."""
    with wave.open(str(published.context.folder / speech_ended.file)) as file:
        shape = (file.getnchannels(), file.getsampwidth(), file.getframerate())
        assert shape == (1, 2, RATE)
        frames: bytes = file.readframes(file.getnframes())
        return frames


async def test_a_segment_has_its_pre_roll_and_its_hang_over(
    begin: Begin, pipe: PipedCommand
) -> None:
    """10 quiet blocks, 5 loud, 10 quiet: from 3 before the onset to the 5th quiet one."""
    _, published = await begin(pipe)
    pipe.send(utterance())
    ended = await published.first(SpeechEnded)
    started = await published.first(SpeechStarted)
    assert (started.driver, started.segment, ended.segment) == ("it", 1, 1)
    assert ended.began == started.began
    assert ended.ended - ended.began == (3 + 5 + 5) * 20_000
    assert ended.loudest == pytest.approx(0.502, rel=1e-3)
    assert (ended.file, ended.detail) == ("", "")
    assert not (published.context.media).exists(), "nothing is kept unless it is asked for"


async def test_the_file_holds_the_segment_sample_by_sample(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe, segments=True)
    data = utterance()
    pipe.send(data)
    ended = await published.first(SpeechEnded)
    assert ended.file == "session.media/ears-0001.wav"
    path = published.context.folder / ended.file
    assert segment_samples(published, ended) == data[(10 - 3) * BLOCK : (10 + 5 + 5) * BLOCK]
    assert path.stat().st_mode & 0o777 == 0o600
    assert path.parent.stat().st_mode & 0o777 == 0o700
    assert [one.name for one in path.parent.iterdir()] == ["ears-0001.wav"]


async def test_a_second_segment_never_holds_sound_of_the_first(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe, segments=True, pre_roll=1.0, hang_over=0.04)
    data = ramp(4, 0.5) + ramp(3, 0.01) + ramp(4, 0.6) + ramp(3, 0.02)
    pipe.send(data)
    second = await published.first(SpeechEnded, after=1)
    first = published.all(SpeechEnded)[0]
    assert [segment_samples(published, first), segment_samples(published, second)] == [
        data[: 6 * BLOCK],
        data[6 * BLOCK : 13 * BLOCK],
    ]


async def test_of_several_channels_the_one_that_counts_is_kept(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe, segments=True, format="S24_3LE", channels=2, channel=2)
    levels = np.repeat(np.array([0.0, 0.5, 0.0], np.float32), [320 * 5, 320 * 5, 320 * 6])
    levels *= np.resize([1, -1], levels.size)
    pipe.send(pcm_audio.encode(np.stack([levels[::-1] * 2, levels], axis=1), "S24_3LE"))
    ended = await published.first(SpeechEnded)
    assert (
        np.frombuffer(segment_samples(published, ended), "<i2").tolist()
        == [0] * 320 * 3 + [16384, -16384] * 160 * 5 + [0] * 320 * 5
    )


async def test_what_lies_on_the_threshold_is_no_speech(begin: Begin, pipe: PipedCommand) -> None:
    exact = round(0.1 * 32768) / 32768
    _, published = await begin(pipe, threshold=exact)
    pipe.send(square(0.4, 0.1))
    await published.until(lambda: len(published.values("loudness")) == 4)
    assert published.all(SpeechStarted) == []
    pipe.send(square(0.1, 0.1001))
    await published.first(SpeechStarted)


async def test_not_a_number_and_zeros_are_quiet(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin(pipe, format="FLOAT_LE", silent_after=0.2)
    quiet = np.array([np.nan, 0.0] * (160 * 12), np.float32)
    loud = np.array([0.5, -0.5] * (160 * 5), np.float32)
    pipe.send(np.concatenate([quiet, loud, quiet]).astype("<f4").tobytes())
    ended = await published.first(SpeechEnded)
    assert ended.ended - ended.began == (3 + 5 + 5) * 20_000
    assert len(published.all(SpeechStarted)) == 1
    assert "muted" in (await published.state("loudness", "silent")).why


async def test_the_mark_on_the_screen_and_the_segments_agree(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe)
    pipe.send(utterance() + utterance())
    await published.first(SpeechEnded, after=1)
    seen = [
        message.state if isinstance(message, SensorChanged) else type(message)
        for message in published.messages
        if isinstance(message, SensorChanged | SpeechStarted | SpeechEnded)
    ]
    assert seen == ["ready", "quiet", *(["speaking", SpeechStarted, "quiet", SpeechEnded] * 2)]


async def test_whoever_never_pauses_is_cut_and_nothing_of_it_is_lost(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe, segments=True, longest=1.0)
    data = ramp(115, 0.3) + ramp(6, 0.01)
    pipe.send(data[: 60 * BLOCK])
    await published.first(SpeechEnded)
    pipe.send(data[60 * BLOCK :])
    last = await published.first(SpeechEnded, after=2)
    ends = published.all(SpeechEnded)
    assert [ended.detail[:4] for ended in ends] == ["cut:", "cut:", ""]
    assert [(ended.ended - ended.began) // 20_000 for ended in ends] == [50, 50, 20]
    assert b"".join(segment_samples(published, ended) for ended in ends) == data[: 120 * BLOCK]
    assert last.segment == 3
    told = [notice.text for notice in published.all(Notice)]
    assert len(told) == 1, "said once, not for each piece"
    assert "is that speech?" in told[0]
    assert published.states("loudness") == ["quiet", "speaking", "quiet"]


# -- trouble -----------------------------------------------------------------------------------


async def test_a_cable_pulled_in_mid_utterance_ends_the_segment(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe, segments=True)
    data = ramp(5, 0.01) + ramp(20, 0.5)
    pipe.send(data)
    await published.first(SpeechStarted)
    pipe.unplug()
    ended = await published.first(SpeechEnded)
    assert ended.detail == "the sound stopped: cat ended: exit status 0"
    assert segment_samples(published, ended) == data[2 * BLOCK :]
    await until(pipe.connected)
    clock = published.clock
    assert isinstance(clock, ManualClock)
    clock.advance(100)
    pipe.send(utterance())
    again = await published.first(SpeechEnded, after=1)
    assert again.began > 99_000_000, "the new stream has a time of its own"
    assert (again.segment, again.ended - again.began) == (2, 13 * 20_000)


async def test_a_device_that_falls_silent_in_mid_utterance_ends_it_too(
    begin: Begin, pipe: PipedCommand
) -> None:
    microphone, published = await begin(pipe)
    pipe.send(ramp(5, 0.01) + ramp(20, 0.5))
    await published.first(SpeechStarted)
    clock = published.clock
    assert isinstance(clock, ManualClock)
    clock.advance(1.5)
    ended = await published.first(SpeechEnded)
    assert "delivers no sound" in ended.detail
    pipe.send(utterance())
    again = await published.first(SpeechEnded, after=1)
    assert again.began >= 1_000_000, "after the gap, not continued from before it"
    await microphone.close()
    assert len(published.all(SpeechEnded)) == 2


async def test_the_end_of_the_session_ends_the_utterance(begin: Begin, pipe: PipedCommand) -> None:
    microphone, published = await begin(pipe)
    pipe.send(ramp(20, 0.5))
    await published.first(SpeechStarted)
    await microphone.close()
    (ended,) = published.all(SpeechEnded)
    assert ended.detail == "the sound stopped: the session ended"


async def test_a_folder_that_is_none_costs_the_file_and_nothing_else(
    begin: Begin, pipe: PipedCommand
) -> None:
    _, published = await begin(pipe, segments=True)
    published.context.media.write_text("in the way")
    pipe.send(utterance() + utterance())
    second = await published.first(SpeechEnded, after=1)
    assert second.file == ""
    assert second.detail.startswith("not kept: ")
    assert second.ended - second.began == 13 * 20_000
    assert [notice.level for notice in published.all(Notice)] == ["warning"]
    published.context.media.unlink()
    pipe.send(utterance())
    third = await published.first(SpeechEnded, after=2)
    assert third.file == "session.media/ears-0003.wav"
    published.context.media.rename(published.context.folder / "elsewhere")
    published.context.media.write_text("in the way again")
    pipe.send(utterance())
    await published.first(SpeechEnded, after=3)
    said = [notice.text for notice in published.all(Notice) if "not kept" in notice.text]
    assert len(said) == 2, "said again after it worked in between"


async def test_a_full_disk_is_said_once(begin: Begin, pipe: PipedCommand, tmp_path: Path) -> None:
    """Every byte for the part file goes to /dev/full."""
    _, published = await begin(pipe, segments=True)
    published.context.media.mkdir()
    for number in (1, 2):
        (published.context.media / f".ears-{number:04d}.wav.part").symlink_to("/dev/full")
    pipe.send(utterance() + utterance())
    second = await published.first(SpeechEnded, after=1)
    assert second.detail == "not kept: No space left on device"
    assert len(published.all(Notice)) == 1
    assert list(published.context.media.iterdir()) == []


async def test_a_file_that_is_there_already_is_left_alone(begin: Begin, pipe: PipedCommand) -> None:
    _, published = await begin(pipe, segments=True)
    published.context.media.mkdir()
    (published.context.media / "ears-0001.wav").write_bytes(b"older")
    pipe.send(utterance())
    ended = await published.first(SpeechEnded)
    assert "already" in ended.detail
    assert (published.context.media / "ears-0001.wav").read_bytes() == b"older"


async def test_a_disk_that_hangs_holds_up_nobody(
    begin: Begin, pipe: PipedCommand, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The part file is a pipe that nobody reads: opening it never returns."""
    monkeypatch.setattr(speech_segments, "_FILE_S", 2.0)  # enough for the second file
    _, published = await begin(pipe, segments=True)
    published.context.media.mkdir()
    stuck = published.context.media / ".ears-0001.wav.part"
    os.mkfifo(stuck)
    pipe.send(utterance() + utterance())
    second = await published.first(SpeechEnded, after=1)
    first = published.all(SpeechEnded)[0]
    assert "the disk is slow" in first.detail
    assert second.file == "session.media/ears-0002.wav"
    assert [message.segment for message in published.all(SpeechStarted)] == [1, 2]
    os.close(os.open(stuck, os.O_RDONLY | os.O_NONBLOCK))


class Disk:
    """fsync as a disk may do it: watched, held up, or failing."""

    def __init__(self) -> None:
        self.synced: dict[int, str] = {}
        self.goes_on = threading.Event()
        self.goes_on.set()
        self.error: OSError | None = None

    def fsync(self, fd: int) -> None:
        self.goes_on.wait(PATIENCE_S)
        if self.error is not None:
            raise self.error
        self.synced[os.fstat(fd).st_ino] = threading.current_thread().name


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    found = Disk()
    monkeypatch.setattr(os, "fsync", found.fsync)
    return found


async def test_a_file_and_its_name_outlive_a_power_cut(
    begin: Begin, pipe: PipedCommand, disk: Disk
) -> None:
    """Both are on the disk itself in the end; the session's own thread never waits for that."""
    _, published = await begin(pipe, segments=True)
    pipe.send(utterance())
    ended = await published.first(SpeechEnded)
    path = published.context.folder / ended.file
    wanted = {path.stat().st_ino, path.parent.stat().st_ino}
    await until(lambda: wanted <= disk.synced.keys())
    assert {disk.synced[inode] for inode in wanted} == {"speech file"}


async def test_nobody_waits_until_a_slow_card_has_it(
    begin: Begin, pipe: PipedCommand, disk: Disk
) -> None:
    _, published = await begin(pipe, segments=True)
    disk.goes_on.clear()
    pipe.send(utterance())
    ended = await published.first(SpeechEnded)
    assert (ended.file, ended.detail) == ("session.media/ears-0001.wav", "")
    # Threads of earlier tests may have files of their own to care for.
    assert (published.context.folder / ended.file).stat().st_ino not in disk.synced
    disk.goes_on.set()


async def test_a_disk_that_loses_what_it_was_given_is_told_once(
    begin: Begin, pipe: PipedCommand, disk: Disk
) -> None:
    _, published = await begin(pipe, segments=True)
    disk.error = OSError(errno.EIO, "Input/output error")
    pipe.send(utterance() + utterance())
    assert (await published.first(SpeechEnded, after=1)).file == "session.media/ears-0002.wav"
    notice = await published.first(Notice)
    assert notice.text == "it: a file of speech may be lost in a power cut: Input/output error"
    disk.error = None
    pipe.send(utterance())
    ended = await published.first(SpeechEnded, after=2)
    await until(lambda: (published.context.folder / ended.file).stat().st_ino in disk.synced)
    assert len(published.all(Notice)) == 1
