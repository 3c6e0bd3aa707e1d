"""`woz listen` and `woz talk`: sound through pipes, beside a robot process that may stand still."""

from __future__ import annotations

import asyncio
import contextlib
import io
import os
import sys
import wave
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import ServedSession, served_session
from tests.host.test_live_sound import RATE, WORD, loudspeaker, microphone, now
from tests.session.rig import WAIT_S
from woz_tui.drivers.sound_feeds import LISTENED, SoundListened, SoundReader, SoundWindow
from woz_tui.host import sound_service
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import Welcome

WOZ = (sys.executable, "-m", "woz_tui")


class LiveSoundRig:
    """A served session, and commands beside it."""

    def __init__(self, host: ServedSession) -> None:
        self.host = host
        self.begun: list[Process] = []

    async def woz(self, *words: str, **more: Any) -> Process:
        begun = await asyncio.create_subprocess_exec(
            *WOZ, *words, str(self.host.path), **{"stderr": PIPE, "stdout": DEVNULL, **more}
        )
        self.begun.append(begun)
        return begun

    async def wanted(self) -> None:
        """Somebody listens."""
        feed = self.host.session.feeds.feed("robot", LISTENED)
        await until(lambda: isinstance(feed.latest().value, SoundListened))


async def until(holds: Any) -> None:
    async with asyncio.timeout(WAIT_S):
        while not holds():  # noqa: ASYNC110 - another process does it
            await asyncio.sleep(0.01)


async def line_with(running: Process, words: str) -> str:
    """The first line on standard error that has these words."""
    assert running.stderr is not None
    told = []
    async with asyncio.timeout(WAIT_S):
        while line := (await running.stderr.readline()).decode():
            told.append(line)
            if words in line:
                return line
    raise AssertionError(f"it ended without {words!r}: {told}")


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A voice that a busy machine holds back is not late."""
    monkeypatch.setattr(sound_service, "LATE_S", 10.0)


@pytest.fixture
async def sound_rig(tmp_path: Path) -> AsyncIterator[LiveSoundRig]:
    async with served_session(tmp_path) as host:
        rig = LiveSoundRig(host)
        yield rig
        for running in rig.begun:
            with contextlib.suppress(ProcessLookupError):
                running.kill()
            await running.wait()


# -- listening ---------------------------------------------------------------------------------


async def received_sound(
    rig: LiveSoundRig, window: SoundWindow, running: Process, size: int
) -> bytes:
    """What is written first; words are said until then, because what comes late is dropped."""
    assert running.stdout is not None
    hearing = asyncio.ensure_future(running.stdout.readexactly(size))
    while not hearing.done():
        window.add(WORD, now(rig.host))
        await asyncio.sleep(0.01)
    return await hearing


async def test_the_microphone_on_standard_output_as_wav(sound_rig: LiveSoundRig) -> None:
    window = microphone(sound_rig.host)
    running = await sound_rig.woz("listen", stdout=PIPE)
    await sound_rig.wanted()
    written = await received_sound(sound_rig, window, running, 44 + 640)
    head, word = written[:44], written[44:]
    assert word == WORD
    with wave.open(io.BytesIO(head)) as file:
        assert (file.getframerate(), file.getnchannels(), file.getsampwidth()) == (RATE, 1, 2)
    assert f"{RATE} Hz" in await line_with(running, "delay")


async def test_bare_samples(sound_rig: LiveSoundRig) -> None:
    window = microphone(sound_rig.host)
    running = await sound_rig.woz("listen", "--format", "raw", stdout=PIPE)
    await sound_rig.wanted()
    assert await received_sound(sound_rig, window, running, 640) == WORD


async def test_who_takes_nothing_loses_sound_and_hears_the_newest_later(
    sound_rig: LiveSoundRig,
) -> None:
    window = microphone(sound_rig.host)
    reading, writing = os.pipe()
    running = await sound_rig.woz("listen", "--format", "raw", stdout=writing)
    os.close(writing)
    await sound_rig.wanted()
    told = asyncio.ensure_future(line_with(running, "nobody takes"))
    spoken = 0
    while not told.done():
        window.add((spoken % 30_000).to_bytes(2, "little") * 320, now(sound_rig.host))
        spoken += 1
        await asyncio.sleep(0.005)
    await told
    waiting = os.read(reading, 1 << 20)
    assert len(waiting) <= 8192, "the pipe holds a fraction of a second"
    last = (spoken - 1).to_bytes(2, "little")
    rest = bytearray()
    while last not in (bytes(rest[-2:]),):
        taken = asyncio.ensure_future(asyncio.to_thread(os.read, reading, 1 << 16))
        while not taken.done():  # again and again: what a busy machine holds back is dropped
            window.add(last * 320, now(sound_rig.host))
            await asyncio.sleep(0.01)
        rest += await taken
    assert len(rest) < 40_000, "what was said meanwhile is not made up for"
    os.close(reading)
    assert await asyncio.wait_for(running.wait(), WAIT_S) == 0


async def test_a_closed_pipe_ends_it_though_nobody_speaks(sound_rig: LiveSoundRig) -> None:
    microphone(sound_rig.host)
    reading, writing = os.pipe()
    running = await sound_rig.woz("listen", stdout=writing)
    os.close(writing)
    await sound_rig.wanted()
    os.close(reading)
    assert await asyncio.wait_for(running.wait(), WAIT_S) == 0
    await sound_rig.host.published(lambda line: isinstance(line, m.ListenerLeft))


async def test_a_microphone_that_is_pulled_out_is_told_and_is_heard_again(
    sound_rig: LiveSoundRig,
) -> None:
    window = microphone(sound_rig.host)
    running = await sound_rig.woz("listen", "--format", "raw", stdout=PIPE)
    await sound_rig.wanted()
    assert "robot" in await line_with(running, "no sound")
    assert await received_sound(sound_rig, window, running, 640) == WORD
    await line_with(running, "delay")


async def test_the_end_of_the_session_ends_it(sound_rig: LiveSoundRig) -> None:
    microphone(sound_rig.host)
    running = await sound_rig.woz("listen", stdout=PIPE)
    await sound_rig.wanted()
    await sound_rig.host.session.close("test", rest=False)
    await sound_rig.host.host.close()
    _, said = await asyncio.wait_for(running.communicate(), WAIT_S)
    assert running.returncode == 0
    assert b"the session has ended" in said


async def test_a_session_without_a_microphone_is_told(sound_rig: LiveSoundRig) -> None:
    running = await sound_rig.woz("listen", stdout=PIPE)
    _, said = await asyncio.wait_for(running.communicate(), WAIT_S)
    assert running.returncode == 1
    assert b"no driver of this session has a microphone" in said


async def test_a_robot_process_that_stands_still_is_told(tmp_path: Path) -> None:
    """It greets, and answers nothing more."""
    path = tmp_path / "s"
    nothing: dict[str, Any] = {
        **dict.fromkeys(("title", "log", "keyboard"), ""),
        **{key: [] for key in ("panels", "script", "variables", "conditions", "drivers")},
    }
    welcome = Welcome(protocol=1, console="con1", role="watcher", seq=0, t=0, verbs={}, **nothing)

    async def greet(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readline()
        writer.write(codec.encode(welcome))
        await reader.read()

    async with await asyncio.start_unix_server(greet, path):
        running = await asyncio.create_subprocess_exec(
            *WOZ, "listen", str(path), stdout=PIPE, stderr=PIPE
        )
        try:
            await line_with(running, "has not answered")
        finally:
            running.kill()
            await running.wait()


# -- talking -----------------------------------------------------------------------------------


async def say(running: Process, word: bytes, reader: SoundReader) -> None:
    """Say it again and again until the robot has it whole: of a voice that a busy machine holds
    back, what was said long before is dropped.
    """
    assert running.stdin is not None
    running.stdin.transport.set_write_buffer_limits(0)  # what has been drained is in the pipe
    pcm = bytearray()
    async with asyncio.timeout(WAIT_S):
        while word not in pcm:
            running.stdin.write(word)
            await running.stdin.drain()
            await asyncio.sleep(0.05)
            while (taken := reader.take()) is not None:
                pcm += taken[0].pcm


async def got(reader: SoundReader, count: int) -> bytes:
    """The first so many bytes of a voice."""
    pcm = bytearray()

    def enough() -> bool:
        if (taken := reader.take()) is not None:
            pcm.extend(taken[0].pcm)
        return len(pcm) >= count

    await until(enough)
    return bytes(pcm)


def wav(pcm: bytes, rate: int = RATE, channels: int = 1) -> bytes:
    content = io.BytesIO()
    with wave.open(content, "wb") as file:
        file.setnchannels(channels)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(pcm)
    return content.getvalue()


@pytest.fixture
def late(monkeypatch: pytest.MonkeyPatch) -> None:
    """A voice that comes late is taken all the same, and whole from its beginning: a busy machine
    may be slow.
    """
    monkeypatch.setattr("woz_tui.host.sound_service.LATE_S", 60.0)
    for limit in ("HELD_S", "FRESH_S"):
        monkeypatch.setattr(f"woz_tui.drivers.sound_feeds.{limit}", 60.0)


@pytest.mark.usefixtures("late")
@pytest.mark.parametrize("header", [True, False])
async def test_a_voice_from_standard_input(sound_rig: LiveSoundRig, header: bool) -> None:
    reader = loudspeaker(sound_rig.host, on=True)
    running = await sound_rig.woz("talk", stdin=PIPE)
    assert running.stdin is not None
    if header:
        running.stdin.write(wav(WORD))
        assert await got(reader, 640) == WORD
    else:
        await say(running, WORD, reader)
    assert "on" in await line_with(running, "the robot says it")
    await say(running, b"\3\4" * 320, reader)
    running.stdin.close()
    assert await asyncio.wait_for(running.wait(), WAIT_S) == 0


async def test_that_it_is_switched_off_is_told(sound_rig: LiveSoundRig) -> None:
    reader = loudspeaker(sound_rig.host)
    running = await sound_rig.woz("talk", stdin=PIPE)
    await say(running, WORD, reader)
    assert "talk" in await line_with(running, "off")


@pytest.mark.usefixtures("late")
@pytest.mark.parametrize("piped", [False, True])
async def test_a_recording_comes_whole_and_in_time(
    sound_rig: LiveSoundRig, tmp_path: Path, piped: bool
) -> None:
    """Longer than a piece may be, and than what waits of somebody who speaks."""
    reader = loudspeaker(sound_rig.host, on=True)
    file = tmp_path / "voice.wav"
    pcm = b"".join(bytes([n, n]) * 320 for n in range(60))
    file.write_bytes(wav(pcm))
    with file.open("rb") as voice:
        running = await sound_rig.woz("talk", stdin=PIPE if piped else voice)
        if running.stdin is not None:  # as through ssh, which sends all of it at once
            running.stdin.write(file.read_bytes())
            running.stdin.close()
        assert await got(reader, len(pcm)) == pcm
        assert await asyncio.wait_for(running.wait(), WAIT_S) == 0


@pytest.mark.parametrize(("rate", "channels"), [(44_100, 1), (RATE, 2)])
async def test_another_kind_of_sound_is_refused(
    sound_rig: LiveSoundRig, rate: int, channels: int
) -> None:
    reader = loudspeaker(sound_rig.host, on=True)
    running = await sound_rig.woz("talk", stdin=PIPE)
    _, said = await asyncio.wait_for(running.communicate(wav(WORD, rate, channels)), WAIT_S)
    assert running.returncode == 1
    assert f"arecord -f S16_LE -c 1 -r {RATE}".encode() in said
    assert reader.take() is None


async def test_a_robot_process_that_stands_still_costs_sound_and_nothing_is_late(
    sound_rig: LiveSoundRig,
) -> None:
    reader = loudspeaker(sound_rig.host, on=True)
    running = await sound_rig.woz("talk", stdin=PIPE)
    assert running.stdin is not None
    await say(running, WORD, reader)
    transport = running.stdin.transport
    # This very process is the robot process: it does nothing while it writes and waits.
    pipe = transport.get_extra_info("pipe").fileno()
    os.set_blocking(pipe, True)
    for count in range(200):
        os.write(pipe, count.to_bytes(2, "little") * 320)
    os.set_blocking(pipe, False)
    pcm = bytearray()

    def newest() -> bool:
        if (taken := reader.take()) is not None:
            pcm.extend(taken[0].pcm)
        return pcm[-2:] == (199).to_bytes(2, "little")

    await until(newest)
    assert len(pcm) < 100 * 640, "four seconds were said; the newest of them came"
    assert await line_with(running, "dropped here")


async def test_nothing_on_standard_input_is_told(sound_rig: LiveSoundRig) -> None:
    loudspeaker(sound_rig.host)
    running = await sound_rig.woz("talk", stdin=DEVNULL)
    _, said = await asyncio.wait_for(running.communicate(), WAIT_S)
    assert running.returncode == 1
    assert b"standard input" in said
