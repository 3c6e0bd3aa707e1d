"""Sound files on the robot over the wire."""

from __future__ import annotations

from http import HTTPStatus
from pathlib import Path

import aiohttp
import numpy as np
import pytest
from woz_drivers.naoqi_robot.eyes import CLOSE
from woz_drivers.sound.emotion_sound import emotion_sound
from woz_drivers.sound.wav import Wav

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from woz_tui.drivers.contract import DriverError, RejectedError

BEEP, APPLAUSE, MUSIC = (
    f"/home/nao/sounds/{name}" for name in ("beep.wav", "applause.wav", "music.mp3")
)


pytestmark = pytest.mark.asyncio(loop_scope="module")
#: What is in here is so of both.
KINDS = ("pepper", "nao")


async def sounds(rig: RobotRig) -> bool:
    return any("sound" in kind for kind, *_ in await rig.robot.get("going"))


@pytest.mark.naoqi("ALAudioPlayer.loadFile", "ALAudioPlayer.play", "ALAudioPlayer.setVolume")
@pytest.mark.woz4u("audio_files")
async def test_a_sound_is_loaded_once_and_ends_when_it_has_ended(robot_rig: RobotRig) -> None:
    for volume in (0.25, 0.5):
        sent = await robot_rig.do("sound", file=APPLAUSE, volume=volume)
        assert sent == {"file": APPLAUSE, "volume": volume}
        assert not await sounds(robot_rig)
    assert await robot_rig.calls("ALAudioPlayer.loadFile") == [(APPLAUSE,)]
    number = next(
        one["id"] for one in await robot_rig.robot.get("sounds.loaded") if one["path"] == APPLAUSE
    )
    assert await robot_rig.calls("ALAudioPlayer.setVolume") == [(number, 0.25), (number, 0.5)]
    assert await robot_rig.calls("ALAudioPlayer.play") == [(number,), (number,)]
    assert robot_rig.jobs[-1].announced == [3.0]


@pytest.mark.naoqi("ALAudioPlayer.stopAll")
async def test_a_cancelled_sound_ends_on_the_robot_and_the_next_one_plays(
    robot_rig: RobotRig,
) -> None:
    job = robot_rig.begin("sound", file=MUSIC)
    await robot_rig.robot.until(lambda: sounds(robot_rig))
    await robot_rig.shows(sound=MUSIC)
    await robot_rig.cancel(job)
    await robot_rig.do("sound", file=BEEP)
    assert not await sounds(robot_rig)
    await robot_rig.shows(sound="")


async def test_a_file_that_is_not_on_the_robot_is_told(robot_rig: RobotRig) -> None:
    with pytest.raises(DriverError, match=r"could not load /nowhere\.wav") as raised:
        await robot_rig.do("sound", file="/nowhere.wav")
    assert "copy it there" in raised.value.remedy
    with pytest.raises(RejectedError):
        await robot_rig.do("sound", file=" ")


def write_sound(path: Path, seconds: float) -> Path:
    """A quiet WAV file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    samples = np.zeros(round(8000 * seconds), "<i2")
    path.write_bytes(Wav("S16_LE", 8000, 1, samples.tobytes()).to_bytes())
    return path


@pytest.mark.naoqi("ALAudioPlayer.playWebStream")
async def test_a_sound_beside_the_experiment_is_fetched_by_the_robot(robot_rig: RobotRig) -> None:
    here = write_sound(robot_rig.folder / "media" / "gong.wav", 1.5)
    sent = await robot_rig.do("sound", file="media/gong.wav", volume=0.5)
    assert sent == {"file": "media/gong.wav", "volume": 0.5}
    ((url, volume, pan),) = await robot_rig.calls("ALAudioPlayer.playWebStream")
    assert (volume, pan) == (0.5, 0.0)
    (played,) = await robot_rig.robot.get("sounds.streamed")
    assert played == {"url": url, "type": "audio/wav", "size": here.stat().st_size}
    assert robot_rig.jobs[-1].announced == [1.5]
    assert await robot_rig.calls("ALAudioPlayer.loadFile") == []


async def test_a_sound_of_a_mood_is_made_here_and_fetched_by_the_robot(robot_rig: RobotRig) -> None:
    """Twice the same by the same seed, as a re-run has it; eyes as bright as it is loud."""
    meant = emotion_sound(0.87, 0.5, 0.8, 7)
    args = {"emotion": "happy", "valence": 0.87, "arousal": 0.5, "seed": 7, "seconds": 0.8}
    for _ in range(2):
        sent = await robot_rig.do("utter", **args)
        assert sent == args
    urls = [url for url, *_ in await robot_rig.calls("ALAudioPlayer.playWebStream")]
    played = (await robot_rig.robot.get("sounds.streamed"))[-2:]
    assert [one["url"] for one in played] == urls
    assert len({*urls}) == 2
    assert {(one["type"], one["size"]) for one in played} == {("audio/wav", len(meant.to_bytes()))}
    assert robot_rig.jobs[-1].announced == [0.8]
    async with aiohttp.ClientSession() as session, session.get(urls[-1]) as answer:
        assert answer.status == HTTPStatus.NOT_FOUND  # it is heard, and served no more
    fades = await robot_rig.calls("ALLeds.fadeRGB")
    assert len({fade[1:4] for fade in fades}) > 2
    for fade in fades[-2:]:  # as before, which may be read while the eyes come back to it
        assert fade[1:4] == pytest.approx((1.0, 1.0, 1.0), abs=CLOSE)


async def test_a_sound_of_a_mood_ends_with_the_stop(robot_rig: RobotRig) -> None:
    job = robot_rig.begin("utter", emotion="sad", seconds=10, seed=1)
    await robot_rig.robot.until(lambda: sounds(robot_rig))
    report = await robot_rig.stop()
    assert {"sounds", "eyes"} <= set(report.confirmed)
    assert job.done()
    assert not await sounds(robot_rig)
    await robot_rig.driver.resume()


async def test_a_sound_of_another_folder_is_fetched_and_ends_when_it_is_cut_short(
    robot_rig: RobotRig, tmp_path_factory: pytest.TempPathFactory
) -> None:
    here = write_sound(tmp_path_factory.mktemp("elsewhere") / "long.wav", 300.0)
    job = robot_rig.begin("sound", file=f"../{here.parent.name}/long.wav")
    await robot_rig.robot.until(lambda: sounds(robot_rig))
    await robot_rig.cancel(job)
    await robot_rig.do("sound", file=BEEP)
    assert not await sounds(robot_rig)


async def test_an_address_is_played_as_it_is(robot_rig: RobotRig) -> None:
    with pytest.raises(DriverError, match="could not play"):
        await robot_rig.do("sound", file="http://127.0.0.1:9/none.mp3")
    ((url, *_),) = await robot_rig.calls("ALAudioPlayer.playWebStream")
    assert url == "http://127.0.0.1:9/none.mp3"


async def test_the_robot_does_not_know_the_files_of_this_machine(robot_rig: RobotRig) -> None:
    here = write_sound(robot_rig.folder / "mine.wav", 0.1)
    with pytest.raises(DriverError, match="could not load"):
        await robot_rig.do("sound", file=str(here))


@pytest.mark.naoqi("ALAudioPlayer.getLoadedFilesIds")
async def test_a_loaded_sound_is_not_loaded_again_after_its_ids_were_read(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.do("sound", file=BEEP)
    await robot_rig.robot.clear()
    await robot_rig.robot.called("ALAudioPlayer.getLoadedFilesIds", 2)
    await robot_rig.do("sound", file=BEEP)
    assert await robot_rig.calls("ALAudioPlayer.loadFile") == []


@pytest.mark.naoqi("ALAudioPlayer.getLoadedFilesIds", "ALAudioPlayer.unloadAllFiles")
async def test_what_the_robot_has_unloaded_is_loaded_anew_and_close_unloads(
    tmp_path: Path,
) -> None:
    async with connected_robot(tmp_path) as rig:
        await rig.do("sound", file=BEEP)
        await rig.do("naoqi", call="ALAudioPlayer.unloadAllFiles")
        await rig.robot.clear()
        await rig.robot.called("ALAudioPlayer.getLoadedFilesIds", 2)
        await rig.do("sound", file=BEEP)
        assert len(await rig.calls("ALAudioPlayer.loadFile")) == 1
        await rig.driver.close()
        assert await rig.robot.get("sounds.loaded") == []
