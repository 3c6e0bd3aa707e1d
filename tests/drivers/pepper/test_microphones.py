"""The robot's microphones over the wire: recordings there, its sound as a file here."""

from __future__ import annotations

import asyncio
import os
import threading
import wave
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot.microphones import (
    SERVICE,
    MicrophonesPart,
    SoundBlock,
    block,
)
from woz_drivers.sound.sound_file import SoundFile

from tests.drivers.pepper.part_rig import PartRig, connected_part
from tests.drivers.published_messages import PATIENCE_S, until
from tests.fakes.libqi import SERVERS
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import DriverError, RejectedError, Scope
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, LiveSound, SoundListened


@pytest.fixture
async def robot() -> AsyncIterator[StandIn]:
    """Its time passes as ours does: a recording is made of as much sound as it lasted."""
    async with stand_in(pace=1.0) as started:
        yield started


@pytest.fixture(autouse=True)
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine sound comes late, and ends late."""
    monkeypatch.setattr("woz_drivers.naoqi_robot.microphones._COMES_WITHIN_S", PATIENCE_S)
    monkeypatch.setattr("woz_drivers.naoqi_robot.microphones._FAREWELL_S", PATIENCE_S)


@pytest.mark.naoqi(
    "ALAudioRecorder.startMicrophonesRecording", "ALAudioRecorder.stopMicrophonesRecording"
)
@pytest.mark.woz4u("audio_save_dir")
async def test_a_recording_on_the_robot(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(
        MicrophonesPart, tmp_path, robot, recordings="/home/nao/sounds of today"
    ) as rig:
        told = await rig.do("record_sound", on=True)
        path = str(told["file"])
        assert path.startswith("/home/nao/sounds of today/woz-2")
        assert path.endswith(".wav")
        [call] = await robot.called("ALAudioRecorder.startMicrophonesRecording")
        assert call.args == [path, "wav", 16000, [1, 1, 1, 1]]
        assert await rig.part.read() == {"microphones": f"recording {path}"}
        assert await rig.part.halt(Scope.ALL) is None
        with pytest.raises(RejectedError, match="recording already"):
            await rig.do("record_sound", on=True)
        ended = await rig.do("record_sound", on=False)
        assert (ended["file"], ended["t"]) == (path, told["t"])
        assert isinstance(ended["seconds"], float)
        assert await robot.get("recording") == ""
        assert await rig.part.read() == {"microphones": "off"}
        with pytest.raises(RejectedError):
            await rig.do("sing", on=True)


async def test_off_ends_what_an_earlier_program_began(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(MicrophonesPart, tmp_path, robot) as rig:
        words = ("/home/nao/old.wav", "wav", 16000, [1, 1, 1, 1])
        await rig.connection.call("ALAudioRecorder", "startMicrophonesRecording", *words)
        with pytest.raises(DriverError, match="no recording was begun") as raised:
            await rig.do("record_sound", on=True)
        assert "record_sound off" in raised.value.remedy
        assert await rig.do("record_sound", on=False) == {"file": ""}
        assert str((await rig.do("record_sound", on=True))["file"]).endswith(".wav")


async def test_the_end_of_the_session_ends_the_recording(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(MicrophonesPart, tmp_path, robot) as rig:
        await rig.do("record_sound", on=True)
    assert await robot.get("recording") == ""
    assert rig.notices == []


async def test_a_robot_that_goes_may_record_on(tmp_path: Path) -> None:
    async with stand_in() as robot, connected_part(MicrophonesPart, tmp_path, robot) as rig:
        path = (await rig.do("record_sound", on=True))["file"]
        robot.kill()
        await until(lambda: bool(rig.notices))
        assert rig.notices == [f"it: the robot may still be recording to {path}"]
        assert await rig.part.read() == {"microphones": "off"}


async def test_a_robot_that_refuses_the_end_may_record_on(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(MicrophonesPart, tmp_path, robot) as rig:
        path = (await rig.do("record_sound", on=True))["file"]
        await robot.fault("refuse:ALAudioRecorder.stopMicrophonesRecording=busy")
        with pytest.raises(DriverError, match="busy"):
            await rig.do("record_sound", on=False)
        assert await rig.part.read() == {"microphones": f"recording {path}"}
    assert rig.notices == [f"it: the robot may still be recording to {path}"]


def _sound(rig: PartRig[MicrophonesPart], file: Any) -> tuple[int, int, int, bytes]:
    path = rig.published.context.media.parent / str(file)
    with wave.open(str(path)) as sound:
        frames = sound.readframes(sound.getnframes())
        return sound.getnchannels(), sound.getsampwidth(), sound.getframerate(), frames


@pytest.mark.naoqi(
    "ALAudioDevice.setClientPreferences", "ALAudioDevice.subscribe", "ALAudioDevice.unsubscribe"
)
@pytest.mark.parametrize("server", SERVERS)
async def test_the_robots_sound_is_a_file_here(tmp_path: Path, server: str) -> None:
    async with (
        stand_in(server, pace=2.0) as robot,
        connected_part(MicrophonesPart, tmp_path, robot) as rig,
    ):
        before = rig.published.context.t(rig.published.clock.now_us())
        told = await rig.do("listen", on=True)
        [call] = await robot.trace("ALAudioDevice.setClientPreferences")
        name = str(call.args[0])
        assert name.startswith(SERVICE)
        assert call.args[1:] == [48000, 3, 0]
        assert await robot.get("sound.subscribers") == [name]
        assert await rig.part.read() == {"microphones": f"listening to {told['file']}"}
        t, robot_time = told["t"], told["robot_time"]
        assert isinstance(t, int)
        assert isinstance(robot_time, float)
        assert before - 100_000 <= t <= rig.published.context.t(rig.published.clock.now_us())
        with pytest.raises(RejectedError, match="listening already"):
            await rig.do("listen", on=True)
        ended = await rig.do("listen", on=False)
        assert await robot.get("sound.subscribers") == []
        channels, width, rate, frames = _sound(rig, ended["file"])
        assert (channels, width, rate) == (1, 2, 48000)
        assert len(frames) >= 2 * 4096
        assert len(set(frames)) > 10
        assert ended["seconds"] == round(len(frames) / 2 / 48000, 3)
        assert (ended["missing"], ended["t"]) == (0, told["t"])
        again = await rig.do("listen", on=True)
        assert again["file"] != ended["file"]
        assert rig.notices == []
    assert len(_sound(rig, again["file"])[3]) >= 2 * 4096
    await until(lambda: "robot sound" not in [one.name for one in threading.enumerate()])


async def test_without_sound_it_says_so_and_lets_go(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(MicrophonesPart, tmp_path, robot) as rig:
        await robot.fault("refuse:ALAudioDevice.subscribe=no microphone")
        with pytest.raises(DriverError, match="no microphone"):
            await rig.do("listen", on=True)
        assert await rig.part.read() == {"microphones": "off"}
        await robot.clear()
        assert await rig.do("listen", on=False) == {"file": ""}
        await rig.do("listen", on=True)
        assert len(await robot.get("sound.subscribers")) == 1
    assert await robot.get("sound.subscribers") == []


async def test_a_robot_that_goes_ends_the_file_and_it_is_whole(tmp_path: Path) -> None:
    async with stand_in() as robot, connected_part(MicrophonesPart, tmp_path, robot) as rig:
        told = await rig.do("listen", on=True)
        robot.kill()
        await until(lambda: bool(rig.notices))
        assert "ends here: the robot is disconnected" in rig.notices[0]
        assert await rig.do("listen", on=False) == {"file": ""}
    assert len(_sound(rig, told["file"])[3]) >= 2 * 4096


@pytest.mark.naoqi(
    "ALAudioDevice.setClientPreferences", "ALAudioDevice.subscribe", "ALAudioDevice.unsubscribe"
)
@pytest.mark.parametrize("server", SERVERS)
async def test_live_sound_while_somebody_listens(tmp_path: Path, server: str) -> None:
    async with (
        stand_in(server, pace=2.0) as robot,
        connected_part(MicrophonesPart, tmp_path, robot) as rig,
    ):
        await rig.wait_connected()
        feed, wish = rig.published.context.feed(SOUND), rig.published.context.feed(LISTENED)
        wish.put(SoundListened(rig.published.clock.now_us() + 600_000_000))
        await until(lambda: isinstance(feed.latest().value, LiveSound))
        [call] = await robot.trace("ALAudioDevice.setClientPreferences")
        assert call.args[1:] == [16000, 3, 0]
        sound = feed.latest().value
        assert isinstance(sound, LiveSound)
        assert sound.rate == 16000
        assert len(sound.blocks[-1].pcm) == 2 * 1365
        told = await rig.do("listen", on=True)
        assert len(await robot.get("sound.subscribers")) == 2, "a file beside it"
        wish.put(SoundListened(0))
        while len(await robot.get("sound.subscribers")) > 1:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
        before = feed.latest().serial
        assert (await rig.do("listen", on=False))["file"] == told["file"]
        assert feed.latest().serial == before
        wish.put(SoundListened(rig.published.clock.now_us() + 600_000_000))
        await until(lambda: feed.latest().serial > before)
        assert rig.notices == []
    assert not list(rig.published.context.media.glob("live*")), "no file"


async def test_a_robot_that_refuses_live_sound_is_told_once(
    tmp_path: Path, robot: StandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.naoqi_robot.microphones._AGAIN_S", 0.01)
    async with connected_part(MicrophonesPart, tmp_path, robot) as rig:
        await rig.wait_connected()
        await robot.fault("refuse:ALAudioDevice.subscribe=no microphone")
        wish = rig.published.context.feed(LISTENED)
        wish.put(SoundListened(rig.published.clock.now_us() + 600_000_000))
        await until(lambda: bool(rig.notices))
        await robot.clear()
        await until(lambda: rig.published.context.feed(SOUND).latest().serial > 0)
        assert len(rig.notices) == 1
        assert "no live sound: " in rig.notices[0]
    assert await robot.get("sound.subscribers") == []


@pytest.mark.parametrize(
    ("place", "trouble"), [("/dev/full", "No space left on device"), ("", "File exists")]
)
async def test_a_disk_that_takes_nothing_is_told_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str, trouble: str
) -> None:
    path = tmp_path / "sound.wav"
    path.write_bytes(b"somebody's")
    real = os.open
    if place:  # a real full disk, found under another name

        def full(name: Path, flags: int, mode: int = 0o777) -> int:
            return real(place if name == path else name, flags & ~os.O_EXCL, mode)

        monkeypatch.setattr(os, "open", full)
    failures: list[str] = []
    sound = SoundFile(path, 48000, 1, failures.append)
    sound.begin()
    sound.write_block(b"\0\0" * 100)
    sound_file = await sound.finish()
    assert sound_file.trouble == trouble
    sound.write_block(b"\0\0")
    assert failures == [trouble]
    assert path.read_bytes() == b"somebody's"


async def test_a_file_is_valid_after_every_buffer(tmp_path: Path) -> None:
    path = tmp_path / "new" / "sound.wav"
    sound = SoundFile(path, 16000, 2, pytest.fail)
    sound.begin()
    for count in range(1, 4):
        sound.write_block(b"\1\0\2\0" * 50)

        def there(frames: int = 50 * count) -> bool:
            try:
                with wave.open(str(path)) as opened:
                    return int(opened.getnframes()) == frames
            except (OSError, EOFError, wave.Error):
                return False

        await until(there)
    assert (await sound.finish()).frames == 150
    assert path.stat().st_mode & 0o077 == 0


@given(
    *(st.one_of(st.integers(), st.floats(), st.none(), st.text(max_size=3)) for _ in range(2)),
    st.one_of(st.none(), st.lists(st.integers() | st.none(), max_size=3)),
    st.one_of(st.binary(max_size=32), st.text(max_size=16), st.none(), st.integers()),
)
def test_no_buffer_raises(channels: Any, samples: Any, stamp: Any, buffer: Any) -> None:
    found = block(channels, samples, stamp, buffer)
    if isinstance(found, SoundBlock):
        assert len(found.data) == 2 * found.channels * found.samples
    else:
        assert found


def test_a_buffer_of_four_microphones() -> None:
    assert block(4, 2, [10, 500_000], b"\0" * 16) == SoundBlock(4, 2, b"\0" * 16, 10.5)
    assert block(1, 2, None, bytearray(4)) == SoundBlock(1, 2, b"\0" * 4, None)
    assert block(4, 2, [10, 0], b"\0" * 15) == "15 bytes for 4 channels of 2 samples are no sound"


async def test_nothing_is_left_after_closing(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(MicrophonesPart, tmp_path, robot) as rig:
        listening = asyncio.create_task(rig.do("listen", on=True))
        await robot.called("ALAudioDevice.subscribe")
        listening.cancel()
        await asyncio.wait([listening])
    left = [one for one in asyncio.all_tasks() if "pepper" in one.get_name()]
    assert left == []
    assert await robot.get("sound.subscribers") == []


@pytest.mark.parametrize("moved", [False, True])
async def test_a_file_that_is_not_there_any_more_is_told(tmp_path: Path, moved: bool) -> None:
    failures: list[str] = []
    path = tmp_path / "sound.wav"
    sound = SoundFile(path, 16000, 1, failures.append)
    sound.begin()
    sound.write_block(b"\1\0" * 50)
    await until(path.exists)
    path.rename(tmp_path / "other.wav") if moved else path.unlink()
    sound.write_block(b"\1\0" * 50)
    assert (await sound.finish()).trouble == "the file was removed or moved"
    assert failures == ["the file was removed or moved"]


def test_a_buffer_is_not_longer_than_a_second() -> None:
    assert isinstance(block(4, 48_000, None, bytes(384_000)), SoundBlock)
    assert isinstance(block(4, 48_001, None, bytes(384_008)), str)
    assert isinstance(block(5, 100, None, bytes(1000)), str)
