"""The robot's camera over the wire: looked through only while somebody looks."""

from __future__ import annotations

import asyncio
import threading
from pathlib import Path

import pytest
from PIL import Image
from woz_drivers.naoqi_robot.camera import SINGLE, VIEW, CameraPart

from tests.drivers.pepper.part_rig import PartRig, connected_part
from tests.drivers.published_messages import until
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import DeviceLostError, DriverError, Scope
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture


def _watch(
    rig: PartRig[CameraPart], width: int = 320, rate: float = 30.0, seconds: float = 60.0
) -> None:
    now = rig.published.clock.now_us()
    watched = CameraWatched(now + round(seconds * 1e6), width, rate)
    rig.published.context.feed(WATCHED).put(watched)


def _came(rig: PartRig[CameraPart]) -> int:
    return rig.published.context.feed(PICTURE).latest().serial


def _last(rig: PartRig[CameraPart]) -> Picture:
    found = rig.published.context.feed(PICTURE).latest().value
    assert isinstance(found, Picture)
    return found


async def _let_go(robot: StandIn) -> None:
    async def free() -> bool:
        return not await robot.get("camera.subscribers")

    await robot.until(free)


@pytest.mark.naoqi(
    "ALVideoDevice.subscribe", "ALVideoDevice.getImageRemote", "ALVideoDevice.unsubscribe"
)
async def test_pictures_come_while_somebody_watches_and_not_otherwise(
    tmp_path: Path, robot: StandIn
) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        assert await robot.trace("ALVideoDevice.subscribe") == []
        _watch(rig)
        await until(lambda: _came(rig) >= 3)
        picture = _last(rig)
        assert (picture.width, picture.height, len(picture.rgb)) == (320, 240, 3 * 320 * 240)
        assert 0 <= rig.published.clock.now_us() - picture.t_us < 20_000_000
        assert len(set(picture.rgb)) > 3
        [call] = await robot.trace("ALVideoDevice.subscribe")
        assert call.args == [VIEW, 1, 11, 30]
        _watch(rig, seconds=-1)
        await _let_go(robot)
        calls = [call for call in await robot.trace() if call.service == "ALVideoDevice"]
        assert calls[-1].method == "unsubscribe"
        assert rig.notices == []


async def test_a_wider_view_is_asked_for_anew(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        _watch(rig, width=100)
        await until(lambda: _came(rig) >= 1 and _last(rig).width == 160)
        _watch(rig, width=600)
        await until(lambda: _last(rig).width == 640)
        _watch(rig, width=4000)
        await until(lambda: _last(rig).width == 1280)
        assert len(await robot.get("camera.subscribers")) == 1
    assert await robot.get("camera.subscribers") == []


async def test_no_more_pictures_than_wanted_and_each_after_the_last(
    tmp_path: Path, robot: StandIn
) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        begun_us = rig.published.clock.now_us()
        _watch(rig, rate=5)
        await until(lambda: _came(rig) >= 4)
        asked = len(await robot.trace("ALVideoDevice.getImageRemote"))
        assert asked <= 1 + 5 * (rig.published.clock.now_us() - begun_us) / 1_000_000
        [call] = await robot.trace("ALVideoDevice.subscribe")
        assert call.args[3] == 5
        await robot.fault("slow:100")
        had = _came(rig)
        begun = len(await robot.trace("ALVideoDevice.getImageRemote"))
        _watch(rig, rate=30)
        await until(lambda: _came(rig) >= had + 2)
        assert (
            len(await robot.trace("ALVideoDevice.getImageRemote")) - begun <= _came(rig) - had + 1
        )


async def test_a_refusal_is_told_once_and_the_camera_tried_again(
    tmp_path: Path, robot: StandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.naoqi_robot.camera._TROUBLED_S", 0.1)
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        await robot.fault("refuse:ALVideoDevice.getImageRemote=the camera is broken")
        _watch(rig)
        await until(lambda: bool(rig.notices))
        assert "the camera is broken" in rig.notices[0]
        await robot.called("ALVideoDevice.getImageRemote", 3)
        await robot.clear()
        await until(lambda: _came(rig) >= 1)
        assert len(rig.notices) == 1


async def test_what_an_earlier_program_left_is_removed(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        for name in (VIEW, VIEW, SINGLE, "somebody"):
            await rig.connection.call("ALVideoDevice", "subscribe", name, 1, 11, 5)
    async with connected_part(CameraPart, tmp_path, robot):
        assert await robot.get("camera.subscribers") == ["somebody_0"]


async def test_after_a_loss_the_view_comes_back(tmp_path: Path, port: int) -> None:
    async with stand_in(port=port) as robot, connected_part(CameraPart, tmp_path, robot) as rig:
        _watch(rig)
        await until(lambda: _came(rig) >= 1)
        robot.kill()
        await until(lambda: not rig.connection.ready)
        had = _came(rig)
        async with stand_in(port=port):
            await rig.wait_connected(2)
            await until(lambda: _came(rig) > had + 1)
            assert rig.notices == []


@pytest.mark.naoqi("ALVideoDevice.subscribe", "ALVideoDevice.getImageRemote")
@pytest.mark.woz4u("camera_save_dir")
async def test_a_picture_is_kept_with_its_time(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        before = rig.published.context.t(rig.published.clock.now_us())
        told = await rig.do("picture")
        after = rig.published.context.t(rig.published.clock.now_us())
        media = rig.published.context.media
        path = media.parent / str(told["file"])
        assert str(told["file"]).startswith(f"{media.name}/picture-2")
        with Image.open(path) as image:
            image.load()
            assert image.size == (told["width"], told["height"]) == (640, 480)
            assert image.tobytes() == _last(rig).rgb
        t = told["t"]
        assert isinstance(t, int)
        assert before <= t <= after
        assert isinstance(told["robot_time"], float)
        await rig.do("picture")
        assert len(list(media.iterdir())) == 2
        await _let_go(robot)
        assert await rig.part.halt(Scope.ALL) is None
    await until(lambda: "robot file" not in [one.name for one in threading.enumerate()])


@pytest.mark.woz4u("camera_save_dir")
async def test_pictures_go_where_the_file_says(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(CameraPart, tmp_path, robot, pictures="shots") as rig:
        told = await rig.do("picture")
        assert str(told["file"]).startswith("shots/picture-")
        assert (tmp_path / str(told["file"])).exists()
    (tmp_path / "file").write_bytes(b"")
    async with connected_part(CameraPart, tmp_path, robot, pictures="file") as rig:
        with pytest.raises(DriverError, match="could not be kept"):
            await rig.do("picture")
        await _let_go(robot)


async def test_no_picture_is_an_error_with_the_robots_words(tmp_path: Path, robot: StandIn) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        await robot.fault("refuse:ALVideoDevice.subscribe=too many already")
        with pytest.raises(DriverError, match="too many already"):
            await rig.do("picture")
        await robot.clear()
        await robot.fault("refuse:ALVideoDevice.getImageRemote=dark")
        with pytest.raises(DriverError, match="dark"):
            await rig.do("picture")
        await _let_go(robot)
        await rig.connection.disconnect("the wizard")
        with pytest.raises(DeviceLostError):
            await rig.do("picture")


async def test_a_picture_that_is_cut_short_lets_the_camera_go(
    tmp_path: Path, robot: StandIn
) -> None:
    async with connected_part(CameraPart, tmp_path, robot) as rig:
        await robot.fault("slow:200")
        for tried in range(1, 20):  # on a busy machine the picture may be there first
            taking = asyncio.create_task(rig.do("picture"))
            await robot.called("ALVideoDevice.getImageRemote", tried)
            taking.cancel()
            await asyncio.wait([taking])
            if taking.cancelled():
                break
        assert taking.cancelled()
        await _let_go(robot)
