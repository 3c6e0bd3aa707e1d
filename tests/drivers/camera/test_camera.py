"""The camera driver behind real commands: a pipe as the camera, and what goes wrong."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.camera import Camera, doctor
from woz_drivers.camera.settings import CameraSettings

from tests.drivers.camera.pictures import PipedCamera, picture, planes, with_block
from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.child_processes import offspring
from woz_tui.drivers.contract import Finding, Probe, RejectedError, Scope
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.protocol.messages import DriverConnected, DriverLost
from woz_tui.system.clock import ManualClock, RealClock

Begin = Callable[..., Any]
SMALL = {"width": 20, "height": 15, "format": "rgb24"}


@pytest.fixture
def pipe(tmp_path: Path) -> PipedCamera:
    return PipedCamera(tmp_path / "pipe")


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def begin(tmp_path: Path, clock: ManualClock) -> AsyncIterator[Begin]:
    cameras: list[Camera] = []

    async def started(
        command: tuple[str, ...] | str, real: bool = False, **settings: Any
    ) -> tuple[Camera, PublishedMessages]:
        published = PublishedMessages(tmp_path, RealClock() if real else clock)
        camera_settings = CameraSettings(command=command, **{**SMALL, **settings})
        assert camera_settings.problems() == []
        camera = Camera("it", camera_settings, published.context)
        cameras.append(camera)
        await camera.open()
        return camera, published

    yield started
    for camera in cameras:
        await camera.close()


def sighting_of(published: PublishedMessages) -> Sighting:
    value = published.context.feed(SEEN).latest().value
    assert isinstance(value, Sighting)
    return value


async def frames(published: PublishedMessages, count: int) -> Sighting:
    """What was seen in the picture number `count`."""
    feed = published.context.feed(SEEN)
    await until(lambda: feed.latest().serial >= count)
    return sighting_of(published)


@pytest.mark.toolkit("O3")
async def test_where_it_is_goes_into_the_feed_and_the_log(begin: Begin, pipe: PipedCamera) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(with_block(18, 0, 2))
    first = await frames(published, 1)
    assert first.frame == 1
    assert first.x == pytest.approx(0.9)
    assert first.y == pytest.approx(-13 / 15)
    assert first.size == pytest.approx(4 / 300)
    assert published.values("seen.x") == [pytest.approx(0.9)]
    assert published.values("seen.y") == [pytest.approx(-13 / 15)]
    assert published.values("seen.size") == [pytest.approx(4 / 300)]
    assert published.all(DriverConnected)[0].detail == "cat, 20 x 15 rgb24"
    assert published.states("seen.x") == ["ok"]


@pytest.mark.toolkit("O3")
async def test_nothing_seen_is_said_too(
    begin: Begin, pipe: PipedCamera, clock: ManualClock
) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    clock.advance(3)
    pipe.send(picture())
    assert await frames(published, 1) == Sighting(3_000_000, 1, None, None, 0.0)
    assert published.values("seen.x") == [None]
    assert published.values("seen.size") == [0.0]


async def test_every_picture_counts_but_ten_readings_a_second_do(
    begin: Begin, pipe: PipedCamera, clock: ManualClock
) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    for number in range(1, 33):  # one second of pictures
        pipe.send(with_block(number % 20, 4))
        assert (await frames(published, number)).frame == number
        clock.advance(1 / 32)
    assert 8 <= len(published.values("seen.x")) <= 10


async def test_a_camera_that_hangs_before_a_mirror(begin: Begin, pipe: PipedCamera) -> None:
    _, published = await begin(pipe.command, mirror=True, flip=True)
    await until(pipe.connected)
    pipe.send(with_block(18, 0, 2))
    sighting = await frames(published, 1)
    assert sighting.x == pytest.approx(-0.9)
    assert sighting.y == pytest.approx(13 / 15)


async def test_pictures_of_planes_with_padded_rows(begin: Begin, pipe: PipedCamera) -> None:
    _, published = await begin(pipe.command, width=32, height=24, format="yuv420", stride=64)
    await until(pipe.connected)
    pipe.send(planes(with_block(12, 4, 6, 32, 24), 64))
    sighting = await frames(published, 1)
    assert sighting.x == pytest.approx(-1 / 16)
    assert sighting.y == pytest.approx(-5 / 12)
    assert sighting.size == pytest.approx(9 / 192)


async def test_a_dead_command_is_told_and_started_again(begin: Begin, pipe: PipedCamera) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(with_block(3, 3), b"half a picture")
    await frames(published, 1)
    pipe.unplug()
    lost = await published.first(DriverLost)
    assert lost.detail == "cat ended: exit status 0"
    assert published.states("seen.x") == ["ok", "stale"]
    await until(pipe.connected)
    pipe.send(with_block(18, 0, 2))  # the half picture is forgotten
    assert (await frames(published, 2)).x == pytest.approx(0.9)
    assert published.states("seen.x") == ["ok", "stale", "ok"]


async def test_a_missing_program_is_named_with_its_package(begin: Begin) -> None:
    _, published = await begin("ffmpeg-of-nobody -i x", real=True)
    lost = await published.first(DriverLost)
    assert "ffmpeg-of-nobody is not installed" in lost.detail


async def test_a_silent_command_is_stale_and_then_started_again(
    begin: Begin, pipe: PipedCamera, clock: ManualClock
) -> None:
    _, published = await begin(pipe.command)
    await until(pipe.connected)
    pipe.send(with_block(3, 3))
    await frames(published, 1)
    clock.advance(2)
    await published.state("seen.x", "stale")
    clock.advance(4)
    lost = await published.first(DriverLost)
    assert "delivered nothing" in lost.detail


async def test_a_film_runs_at_its_own_pace_and_again(begin: Begin, tmp_path: Path) -> None:
    film = tmp_path / "film.rgb"
    film.write_bytes(b"".join(with_block(x, 5).tobytes() for x in range(20)))
    _, published = await begin(("cat", str(film)), real=True, pace="real", rate=100)
    loop = asyncio.get_running_loop()
    began = loop.time()
    await frames(published, 21)
    assert loop.time() - began >= 0.2  # twenty pictures last at least as long as they should


async def test_a_film_is_shown_to_its_last_picture(begin: Begin, tmp_path: Path) -> None:
    """Its command has ended long before: what it wrote is still in the pipe, held back."""
    film = tmp_path / "film.rgb"
    film.write_bytes(with_block(0, 5).tobytes() * 149 + with_block(17, 5).tobytes())
    _, published = await begin(("cat", str(film)), real=True, pace="real", rate=120)
    feed = published.context.feed(SEEN)
    await until(lambda: isinstance(last := feed.latest().value, Sighting) and (last.x or 0.0) > 0.5)
    assert sighting_of(published).frame % 150 == 0  # on a busy machine it may have begun again


async def test_it_only_looks_and_leaves_nothing_behind(begin: Begin, pipe: PipedCamera) -> None:
    camera, _ = await begin(pipe.command)
    await until(pipe.connected)
    with pytest.raises(RejectedError, match="cannot gaze"):
        await camera.perform(BusJob("gaze"))
    await camera.stop(Scope.ALL)
    await camera.rest()
    await camera.close()
    assert offspring(saying=str(pipe.path)) == []
    assert Camera.offer(CameraSettings()).verbs == ()
    assert Camera.offer(CameraSettings()).sensors == ("seen.x", "seen.y", "seen.size")


# -- woz doctor ------------------------------------------------------------------------------------


async def examined(folder: Path, code: str, **settings: Any) -> Finding:
    command = (sys.executable, "-c", f"import sys, time; out = sys.stdout.buffer; {code}")
    camera_settings = CameraSettings(command=command, **{**SMALL, **settings})
    (finding,) = await Camera.examine(Probe("eye", camera_settings, folder))
    return finding


async def test_doctor_looks_into_the_first_picture(tmp_path: Path) -> None:
    (tmp_path / "film.rgb").write_bytes(with_block(4, 4, 3).tobytes() * 3)
    camera_settings = CameraSettings(command="cat film.rgb", **SMALL)  # type: ignore[arg-type]
    (finding,) = await Camera.examine(Probe("eye", camera_settings, tmp_path))
    assert finding.level == "ok"
    assert "20 x 15 rgb24, 900 bytes each" in finding.text
    assert "3.0% of the first picture" in finding.text


@pytest.mark.parametrize(
    ("code", "level", "words"),
    [
        ("out.write(bytes(400))", "error", "400 bytes, less than one picture"),
        ("out.write(bytes(1000))", "warning", "1000 bytes, which are no whole pictures"),
        ("sys.exit('no cameras available')", "error", "no cameras available"),
        ("out.write(bytes(9000)); out.flush(); time.sleep(60)", "ok", ""),
    ],
)
async def test_doctor_names_what_is_wrong(
    tmp_path: Path, code: str, level: str, words: str
) -> None:
    finding = await examined(tmp_path, code)
    if level != "ok":
        assert finding.level == level
        assert words in finding.text
        assert finding.remedy
    else:  # a burst, then nothing: far more pictures a second than announced
        assert finding.level == "warning"
        assert "pictures a second" in finding.text


@pytest.mark.parametrize(("busy_s", "busy"), [(0.0, False), (30.0, True)])
async def test_doctor_tells_a_busy_computer_from_pictures_of_another_size(
    tmp_path: Path, busy_s: float, busy: bool
) -> None:
    waited = iter((0.0, busy_s))
    few = "[(out.write(bytes(900)), out.flush(), time.sleep(0.4)) for _ in range(150)]"
    command = (sys.executable, "-c", f"import sys, time; out = sys.stdout.buffer; {few}")
    settings = CameraSettings(command=command, **SMALL)  # type: ignore[arg-type]
    (finding,) = await doctor.examine(Probe("eye", settings, tmp_path), lambda: (0.0, next(waited)))
    assert finding.level == "warning"
    assert "pictures a second" in finding.text
    assert ("too busy to take them" in finding.text) is busy
    assert ("size, format" in finding.remedy) is not busy


async def test_doctor_names_the_package_of_a_missing_program(tmp_path: Path) -> None:
    camera_settings = CameraSettings(width=64, height=48)
    assert camera_settings.words[0] == "rpicam-vid"
    (finding,) = await Camera.examine(Probe("eye", camera_settings, tmp_path))
    assert finding.level == "error"
    assert "rpicam-apps" in finding.remedy or "rpicam-vid" in finding.text


@pytest.mark.parametrize(
    ("wrong", "setting"),
    [
        ({"command": "cat x", "format": "rgb24", "stride": 100, "width": 40}, "stride"),
        ({"format": "rgb24"}, "format"),
        ({"command": 'cat "x'}, "command"),
    ],
)
def test_settings_that_do_not_fit(wrong: dict[str, Any], setting: str) -> None:
    assert [name for name, _ in CameraSettings(**wrong).problems()] == [setting]
