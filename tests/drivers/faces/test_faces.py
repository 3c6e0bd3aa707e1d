"""The driver behind real programs: a pipe as the camera, a stand-in that finds faces, and what goes
wrong.
"""

from __future__ import annotations

import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from woz_drivers.faces import Faces
from woz_drivers.faces.face_lines import decoded_line
from woz_drivers.faces.feed_camera import fitted
from woz_drivers.faces.settings import FacesSettings

from tests.drivers.faces.faces_rig import HEIGHT, PROGRAM, SIZE, SMALL, WIDTH, FacesRig, picture
from tests.drivers.published_messages import PublishedMessages, until
from tests.fakes.child_processes import offspring
from tests.fakes.face_program import CRASH, FREEZE, NONSENSE, face
from woz_tui.drivers.contract import DeviceLostError, DriverError, Probe, RejectedError
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, Picture
from woz_tui.protocol.messages import (
    AddressedChanged,
    DriverConnected,
    DriverFaulted,
    DriverLost,
    Notice,
    Reading,
)
from woz_tui.system.clock import ManualClock
from woz_tui.testing import Device, DriverTests, PlainJob

NEAR, FAR = face(10, 20, 20), face(40, 20, 10)
Opens = Callable[..., Any]


@pytest.fixture
async def opened(tmp_path: Path) -> AsyncIterator[Opens]:
    desks: list[FacesRig] = []

    async def make(**settings: Any) -> FacesRig:
        rig = FacesRig(tmp_path, **settings)
        desks.append(rig)
        await rig.driver.open()
        await until(rig.pipe.connected)
        return rig

    yield make
    for rig in desks:
        await rig.driver.close()


async def test_one_person_who_looks(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    assert [rig.last(one) for one in ("presence", "people", "addressed", "gaze")] == [1, 1, 1, 1]
    assert rig.last("distance") == pytest.approx(0.39, abs=0.01)
    assert rig.last("direction") == pytest.approx(12.2, abs=0.1)
    assert rig.published.all(DriverConnected)[0].detail == "cat, 64 x 48 rgb24"
    assert rig.published.states("presence") == ["ok"]


async def test_nobody_is_told_too(opened: Opens) -> None:
    rig = await opened()
    await rig.show(times=2)
    assert [rig.last(one) for one in ("presence", "people", "gaze")] == [0, 0, 0]
    assert [rig.last(one) for one in ("addressed", "distance", "direction")] == [None] * 3


async def test_several_people_have_numbers_and_the_nearest_who_looks_counts(opened: Opens) -> None:
    rig = await opened()
    away = face(10, 20, 20, yaw=60)
    await rig.show(away, FAR, times=3)
    assert (rig.last("presence"), rig.last("people")) == (1, 2)
    assert rig.of_faces("gaze") == {"1": 0, "2": 1}
    assert rig.of_faces("distance") == {
        "1": pytest.approx(0.388, abs=0.01),
        "2": pytest.approx(0.776, abs=0.01),
    }
    assert rig.last("addressed") == 2
    assert rig.last("distance") == pytest.approx(0.776, abs=0.01)


async def test_the_wizard_steps_through_people_and_gives_the_choice_back(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, FAR, times=2)
    assert rig.last("addressed") == 1
    assert await (await rig.perform("address", who="next")) == {"addressed": 2}
    await rig.show(NEAR, FAR)
    told = [one for one in rig.published.all(Reading) if one.sensor == "addressed"][-1]
    assert (told.value, told.text) == (2, "by hand")
    assert await (await rig.perform("address", who="rule")) == {"addressed": "rule"}
    await rig.show(NEAR, FAR, times=12)
    assert rig.last("addressed") == 1


async def test_each_change_of_who_is_addressed_is_an_event(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, FAR, times=5)
    await (await rig.perform("address", who="next"))
    await rig.show(NEAR, FAR, times=2)
    rig.pipe.unplug()
    await rig.published.first(DriverLost)
    assert [(one.face, one.chosen) for one in rig.published.all(AddressedChanged)] == [
        *((1, "rule"), (2, "hand"), (None, "rule"))
    ]


@pytest.mark.parametrize("who", ["7", "somebody", "-1"])
async def test_who_is_not_there_cannot_be_addressed(opened: Opens, who: str) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    with pytest.raises(RejectedError, match=who):
        await (await rig.perform("address", who=who))


async def test_ten_readings_a_second_and_every_picture_for_a_head_that_follows(
    opened: Opens,
) -> None:
    rig = await opened(publish=5)
    await rig.show(NEAR, times=11)
    assert len(rig.published.values("presence")) == 6
    seen = rig.published.context.feed(SEEN).latest().value
    assert isinstance(seen, Sighting)
    assert seen.x == pytest.approx(20 / 32 - 1)
    assert seen.frame == 11


async def test_the_camera_of_another_driver(tmp_path: Path) -> None:
    clock = ManualClock()
    published = PublishedMessages(tmp_path, clock)
    faces_settings = FacesSettings(camera="pepper", width=WIDTH, height=HEIGHT, program=PROGRAM)
    assert faces_settings.problems() == []
    driver = Faces("it", faces_settings, published.context)
    theirs = published.context.feed(PICTURE, of="pepper")
    await driver.open()
    try:
        await until(lambda: published.context.feed(WATCHED, of="pepper").latest().serial > 0)
        wish = published.context.feed(WATCHED, of="pepper").latest().value
        assert (wish.width, wish.rate) == (WIDTH, faces_settings.rate)
        for n in range(2):
            theirs.put(Picture(clock.now_us(), WIDTH, HEIGHT, picture(NEAR)))
            await until(lambda n=n: published.context.feed(SEEN).latest().serial > n)  # type: ignore[misc]
            clock.advance(0.1)
        assert published.values("people")[-1] == 1
        # One whose bytes are no picture is told, and the next one is looked at as ever.
        for n, (width, height) in enumerate(((WIDTH, HEIGHT), (2, 2), (0, 0)), start=2):
            theirs.put(Picture(clock.now_us(), width, height, b"a few bytes"))
            await until(lambda n=n: published.states("people").count("stale") == n - 1)  # type: ignore[misc]
            theirs.put(Picture(clock.now_us(), WIDTH, HEIGHT, picture(NEAR)))
            await until(lambda n=n: published.context.feed(SEEN).latest().serial > n)  # type: ignore[misc]
            clock.advance(0.1)
        assert published.values("people")[-1] == 1
        clock.advance(6)
        lost = await published.first(DriverLost)
        assert "pepper" in lost.detail
    finally:
        await driver.close()


def test_pictures_of_another_shape_are_fitted_whole() -> None:
    wide = np.zeros((10, 40, 3), np.uint8)
    wide[:, 20:] = 200
    found = fitted(Picture(0, 40, 10, wide.tobytes()), 64, 48)
    pixels = np.frombuffer(found, np.uint8).reshape(48, 64, 3)
    assert pixels[24, [0, 31, 32, 63], 0].tolist() == [0, 0, 200, 200]
    assert pixels[[15, 16, 31, 32], 63, 0].tolist() == [0, 200, 200, 0]


# -- calibration -----------------------------------------------------------------------------------


async def test_two_seconds_of_looking_at_the_robot_calibrate_the_gaze(opened: Opens) -> None:
    rig = await opened()
    beside = face(10, 20, 20, yaw=30, pitch=-20)
    await rig.show(beside, times=2)
    assert rig.last("gaze") == 0
    task = await rig.perform("calibrate_gaze", seconds=2.0)
    await rig.show(beside, times=21)
    found = await task
    assert (found["neutral_yaw"], found["neutral_pitch"]) == (30, -20)
    await rig.show(beside)
    assert rig.last("gaze") == 1
    [notice] = rig.published.all(Notice)
    assert "neutral_yaw: 30" in notice.text
    await rig.show(NEAR)
    assert rig.last("gaze") == 0


async def test_a_distance_that_was_measured_calibrates_distances(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    task = await rig.perform("calibrate_distance", metres=1.5, seconds=1.0)
    await rig.show(NEAR, times=12)
    found = await task
    await rig.show(NEAR)
    assert rig.last("distance") == pytest.approx(1.5, abs=0.01)
    factor = found["distance_factor"]
    assert FacesSettings(distance_factor=factor).distance_factor == pytest.approx(1.5 / 0.388, 0.01)


async def test_calibrating_before_nobody_says_what_to_do(opened: Opens) -> None:
    rig = await opened()
    await rig.show(times=2)
    task = await rig.perform("calibrate_gaze", seconds=0.5)
    await rig.show(times=7)
    with pytest.raises(DriverError) as caught:
        await task
    assert caught.value.remedy


# -- what goes wrong -------------------------------------------------------------------------------


async def test_a_finder_that_crashes_is_told_and_started_again(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    rig.pipe.send(picture(order=CRASH))
    faulted = await rig.published.first(DriverFaulted)
    assert "fallen over" in faulted.detail
    assert rig.published.states("people")[-1] == "stale"
    with pytest.raises(DeviceLostError):
        await (await rig.perform("calibrate_gaze", seconds=1.0))
    before = rig.answers
    while rig.answers == before:  # the new one is handed pictures as soon as it runs
        rig.watch()
        await rig.film(NEAR)
        rig.clock.advance(0.1)
    await rig.show(NEAR, times=2)
    assert rig.published.states("people")[-1] == "ok"
    assert (rig.last("addressed") or 0) > 1, "numbers are not given twice"


async def test_a_finder_that_freezes_is_given_up(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    rig.pipe.send(picture(order=FREEZE))
    [finder] = offspring(saying="face_program")
    await until(lambda: finder.status() == "stopped")
    rig.watch()
    for _ in range(12):  # the camera goes on for six seconds
        await rig.film(NEAR)
        rig.clock.advance(0.5)
    faulted = await rig.published.first(DriverFaulted)
    assert "no answer" in faulted.detail
    assert rig.published.states("people") == ["ok", "stale"]


async def test_answers_that_are_none_are_told_until_there_is_one(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    rig.pipe.send(picture(order=NONSENSE))
    faulted = await rig.published.first(DriverFaulted)
    assert "read" in faulted.detail
    await rig.show(NEAR, times=2)
    assert len(rig.published.all(DriverConnected)) == 2


async def test_a_camera_without_pictures_is_no_fault_of_the_finder(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    rig.clock.advance(60)
    await rig.published.state("people", "stale")
    assert not rig.published.all(DriverFaulted)


async def test_a_camera_that_is_pulled_out_and_comes_back(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    rig.pipe.unplug()
    lost = await rig.published.first(DriverLost)
    assert lost.remedy
    await until(rig.pipe.connected)
    await rig.show(NEAR, times=2)
    assert rig.published.states("gaze") == ["ok", "stale", "ok"]


async def test_while_the_finder_is_busy_only_the_newest_picture_waits(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, times=2)
    [finder] = offspring(saying="face_program")
    finder.suspend()
    rig.watch()
    for n in range(5):
        await rig.film(face(10 + n, 20, 20))
        rig.clock.advance(0.1)
    finder.resume()
    await until(lambda: rig.answers == 4)
    assert rig.published.context.feed(SEEN).latest().value.x == pytest.approx(24 / 32 - 1)


async def test_without_networks_a_sentence_says_how_to_get_them(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    source = ("cat", "/dev/zero")
    faces_settings = FacesSettings(
        command=source, width=WIDTH, height=HEIGHT, models=str(tmp_path / "none")
    )
    driver = Faces("it", faces_settings, published.context)
    await driver.open()
    try:
        faulted = await published.first(DriverFaulted)
    finally:
        await driver.close()
    assert "python -m woz_drivers.faces" in faulted.detail or "woz-tui[faces]" in faulted.detail


# -- pictures to watch -----------------------------------------------------------------------------


async def test_who_watches_sees_a_frame_around_each_face(opened: Opens) -> None:
    rig = await opened()
    await rig.show(NEAR, FAR, times=2)
    rig.watch()
    shown = await rig.film(NEAR, FAR)
    pixels = np.frombuffer(shown.rgb, np.uint8).reshape(HEIGHT, WIDTH, 3)
    framed = {tuple(pixels[20, column]) for column in (12, 28)}
    assert len(framed) == 1, "one colour on both sides of the addressed face"
    assert framed.isdisjoint({(0, 0, 0), tuple(pixels[20, 42])})
    assert tuple(pixels[30, 20]) == (0, 0, 0), "nothing is drawn over the face"


# -- woz doctor ------------------------------------------------------------------------------------


async def test_the_doctor_says_who_is_in_the_first_picture(tmp_path: Path) -> None:
    (tmp_path / "film").write_bytes(picture(NEAR, FAR) * 30)
    faces_settings = FacesSettings(command=f"cat {tmp_path / 'film'}", **SMALL)
    [finding] = await Faces.examine(Probe("it", faces_settings, tmp_path))
    assert finding.level == "ok"
    assert "2 faces" in finding.text
    assert "0.4 m" in finding.text


async def test_the_doctor_says_what_the_finder_lacks(tmp_path: Path) -> None:
    (tmp_path / "film").write_bytes(picture(order=CRASH) * 30)
    faces_settings = FacesSettings(command=f"cat {tmp_path / 'film'}", **SMALL)
    [finding] = await Faces.examine(Probe("it", faces_settings, tmp_path))
    assert (finding.level, "fallen over" in finding.text) == ("error", True)


class TestTheContract(DriverTests):
    """With a camera that is pulled out while the gaze is calibrated, and without."""

    driver = Faces
    settings = FacesSettings(command=("no-such-program",), program=("no-such-program",))

    @asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with TemporaryDirectory() as folder:
            cable = Path(folder) / "cable"
            cable.touch()
            source = (sys.executable, "-S", "-c", _ENDLESS, str(cable))
            command = PlainJob("calibrate_gaze", {"seconds": 20.0})
            yield Device(FacesSettings(command=source, **SMALL), cable.unlink, cable.touch, command)


_ENDLESS = f"""
import os, sys, time
picture = {NEAR!r}.ljust({SIZE}, bytes(1))
while os.path.exists(sys.argv[1]):
    sys.stdout.buffer.write(picture)
    sys.stdout.flush()
    time.sleep(0.05)
"""


@pytest.mark.parametrize("number", ["NaN", "null"])
def test_an_angle_that_is_no_number_leaves_the_face_and_the_others(number: str) -> None:
    box = '"left": 1, "top": 1, "right": 9, "bottom": 9, "width": 8'
    angles = f'"yaw": {number}, "pitch": 4, "roll": {number}, "eyes_yaw": {number}'
    found = decoded_line(f'{{"faces": [{{{box}, {angles}}}, {{{box}, "yaw": 2}}]}}'.encode())
    assert [(face.yaw, face.roll, face.eyes_yaw) for face in found.faces] == [
        (None, None, None),
        (2.0, None, None),
    ]


def test_a_line_that_is_nested_without_end_is_no_answer() -> None:
    with pytest.raises(ValueError, match="nested"):
        decoded_line(b'{"more":' * 10_000 + b"1" + b"}" * 10_000)
