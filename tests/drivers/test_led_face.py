"""The driver of a face of lights, over a pseudo-terminal with the compiled firmware behind it."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.led_face import LedFace, LedFaceSettings, doctor, driver
from woz_drivers.led_face.driver import PATTERNS, as_mounted, sleeping_face
from woz_drivers.led_face.wire import HERE, Packet

from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.led_face import Board, PluggedFace
from woz_tui.drivers.contract import DeviceLostError, Driver, Finding, Probe, RejectedError, Scope
from woz_tui.motion.body_feeds import FACE, FacePicture
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.face_drawing import FaceState, draw
from woz_tui.motion.light_frames import LightFrame
from woz_tui.protocol.messages import DriverConnected, DriverFaulted, DriverLost, Notice
from woz_tui.system.clock import ManualClock

pytestmark = pytest.mark.cpp

HAPPY = draw(FaceState(0.3, 0, "happy", 1.0), FaceShape())
SAD = draw(FaceState(-0.3, 0, "sad", 1.0), FaceShape())


@dataclass
class LedFaceRig:
    """A driver at work, the board it talks to, and everything it said."""

    driver: LedFace
    face: PluggedFace
    published: PublishedMessages
    clock: ManualClock

    def show(self, frame: LightFrame, brightness: float = 1.0) -> None:
        """The body draws a face."""
        self.published.context.feed(FACE, of="body").put(FacePicture(frame, brightness))

    async def until(self, holds: Callable[[], bool]) -> None:
        """Let time pass until it holds; the driver has a turn for each bit of it."""

        def later() -> bool:
            self.clock.advance(0.01)
            return holds()

        await until(later)

    async def shows(self, frame: LightFrame) -> None:
        """Return when the lights show this frame."""
        await self.until(lambda: self.face.board.frame == frame)


Begin = Callable[..., Awaitable[LedFaceRig]]


@pytest.fixture
async def begin(tmp_path: Path) -> AsyncIterator[Begin]:
    stands: list[LedFaceRig] = []

    async def started(board: Board | None = None, **settings: Any) -> LedFaceRig:
        clock = ManualClock()
        published = PublishedMessages(tmp_path, clock)
        face = PluggedFace(tmp_path / "face", board)
        led_face_settings = LedFaceSettings(port=str(face.port), **{"follows": "body", **settings})
        rig = LedFaceRig(
            LedFace("it", led_face_settings, published.context), face, published, clock
        )
        stands.append(rig)
        await rig.driver.open()
        return rig

    yield started
    for rig in stands:
        await rig.driver.close()
        rig.face.unplug()


@pytest.mark.toolkit("F1", "V1")
async def test_the_lights_show_the_bodys_face_bit_for_bit(begin: Begin) -> None:
    rig = await begin()
    connected = await rig.published.first(DriverConnected)
    assert connected.detail == f"{rig.face.port}: memory, 24 x 16"
    for frame, brightness in ((HAPPY, 1.0), (SAD, 0.5), (HAPPY, 0.25)):
        rig.show(frame, brightness)
        await rig.shows(frame)
        await rig.until(lambda: rig.face.board.brightness == round(255 * brightness))  # noqa: B023
    assert rig.face.board.frame == LightFrame.of_hex(24, HAPPY.hex)


async def test_the_settings_bound_the_brightness(begin: Begin) -> None:
    rig = await begin(brightness=0.5)
    rig.show(HAPPY, 0.5)
    await rig.shows(HAPPY)
    await rig.until(lambda: rig.face.board.brightness == 64)


async def test_an_unchanged_face_is_sent_about_once_a_second(begin: Begin) -> None:
    rig = await begin()
    rig.show(HAPPY)
    await rig.shows(HAPPY)
    before = rig.face.board.frames
    began = rig.clock.now_us()
    await rig.until(lambda: rig.face.board.frames >= before + 3)
    assert rig.clock.now_us() - began >= 2_000_000


@pytest.mark.toolkit("G1")
async def test_unplugged_and_put_back(begin: Begin) -> None:
    rig = await begin()
    rig.show(HAPPY)
    await rig.shows(HAPPY)
    rig.face.unplug()
    lost = await rig.published.first(DriverLost)
    assert "was lost" in lost.detail
    assert lost.remedy
    with pytest.raises(DeviceLostError):
        await rig.driver.perform(BusJob("pattern", {"picture": "all", "seconds": 5}))
    rig.show(SAD)
    rig.face.board = Board()
    rig.face.plug()
    await rig.published.first(DriverConnected, after=1)
    await rig.shows(SAD)


async def test_a_face_that_falls_silent_is_lost_and_found(begin: Begin) -> None:
    rig = await begin()
    await rig.published.first(DriverConnected)
    rig.face.mute = True
    await rig.until(lambda: bool(rig.published.all(DriverLost)))
    assert "does not answer any more" in rig.published.all(DriverLost)[0].detail
    rig.face.mute = False
    await rig.until(lambda: len(rig.published.all(DriverConnected)) == 2)


async def test_a_reset_face_is_lit_again(begin: Begin) -> None:
    rig = await begin()
    rig.show(HAPPY)
    await rig.shows(HAPPY)
    rig.face.reset()
    assert rig.face.board.frame is None
    await rig.shows(HAPPY)
    assert not rig.published.all(DriverLost)


async def test_a_face_of_another_size_is_named_with_a_remedy(begin: Begin) -> None:
    rig = await begin(Board(16, 24))
    fault = await rig.published.first(DriverFaulted)
    assert "wired as 16 x 24 lights, and the settings say 24 x 16" in fault.detail
    assert "rotate" in fault.remedy
    with pytest.raises(DeviceLostError, match="16 x 24"):
        await rig.driver.perform(BusJob("pattern", {"picture": "all", "seconds": 5}))


async def test_a_face_of_another_version_is_named_with_a_remedy(begin: Begin) -> None:
    rig = await begin()
    await rig.published.first(DriverConnected)
    rig.face.hello = Packet(HERE, 0, b"\x09\x18\x10later").encoded()
    rig.face.unplug()
    rig.face.plug()
    fault = await rig.published.first(DriverFaulted)
    assert "version 9" in fault.detail
    assert "firmware" in fault.remedy


async def test_a_bodys_face_of_another_size_is_said_once(begin: Begin) -> None:
    rig = await begin()
    await rig.published.first(DriverConnected)
    for row in (1, 2, 3):
        rig.show(LightFrame(32, (row,) * 8))
    notice = await rig.published.first(Notice)
    assert "'body' is 32 x 8 lights, and these are 24 x 16" in notice.text
    assert notice.remedy
    assert len(rig.published.all(Notice)) == 1


@pytest.mark.parametrize("picture", ["arrow", "chessboard", "all"])
async def test_a_pattern_is_shown_until_the_stop_and_then_the_face(
    begin: Begin, picture: str
) -> None:
    rig = await begin()
    rig.show(HAPPY)
    await rig.shows(HAPPY)
    job = BusJob("pattern", {"picture": picture, "seconds": 20.0})
    running = asyncio.create_task(rig.driver.perform(job))
    await rig.shows(PATTERNS[picture](24, 16))
    assert job.announced == [20.0]
    running.cancel()
    await rig.driver.stop(Scope.ALL)
    await asyncio.wait([running])
    assert running.cancelled()
    await rig.shows(HAPPY)  # a stop leaves the face as it is


async def test_a_pattern_ends_by_itself(begin: Begin) -> None:
    rig = await begin(follows="")
    await rig.published.first(DriverConnected)
    sent = await rig.driver.perform(BusJob("pattern", {"picture": "rows", "seconds": 0.1}))
    assert sent == {"picture": "rows", "seconds": 0.1}
    with pytest.raises(RejectedError):
        await rig.driver.perform(BusJob("say", {"text": "hello"}))


@pytest.mark.parametrize("afterwards", ["dark", "asleep", "last"])
async def test_what_stays_when_the_session_has_ended(
    begin: Begin, afterwards: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(driver, "_FAREWELL_S", 20.0)
    rig = await begin(afterwards=afterwards)
    rig.show(HAPPY)
    await rig.shows(HAPPY)

    async def time_passes() -> None:
        while True:
            rig.clock.advance(0.05)
            await asyncio.sleep(0.005)

    passing = asyncio.create_task(time_passes())
    await rig.driver.close()
    passing.cancel()
    asleep_face = sleeping_face(LedFaceSettings("x"))
    expected = {"dark": LightFrame(24, (0,) * 16), "asleep": asleep_face, "last": HAPPY}[afterwards]
    await rig.shows(expected)
    await rig.driver.close()  # a second time is no harm


@pytest.mark.parametrize("rotate", ["0", "90", "180", "270"])
@given(data=st.data(), mirror=st.booleans())
def test_a_mounted_picture_is_seen_upright(rotate: str, data: st.DataObject, mirror: bool) -> None:
    rows = data.draw(st.lists(st.integers(0, (1 << 12) - 1), min_size=9, max_size=9))
    frame = LightFrame(12, tuple(rows))
    settings = LedFaceSettings("x", width=12, height=9, rotate=rotate, mirror=mirror)
    light_frame = as_mounted(frame, settings)
    assert (light_frame.width, light_frame.height) == settings.wired
    for _ in range(int(rotate) // 90):  # turn the matrix as it was mounted: clockwise
        light_frame = LightFrame(
            light_frame.height,
            tuple(
                sum(
                    light_frame.lit(column, row) << row  # the lowest row comes to the left
                    for row in range(light_frame.height)
                )
                for column in range(light_frame.width)
            ),
        )
    for y in range(9):
        for x in range(12):
            assert light_frame.lit(11 - x if mirror else x, y) == frame.lit(x, y)


def test_patterns_tell_every_way_of_mounting_apart() -> None:
    arrow = PATTERNS["arrow"](24, 16)
    ways = {
        as_mounted(arrow, LedFaceSettings("x", rotate=rotate, mirror=mirror))
        for rotate in ("0", "90", "180", "270")
        for mirror in (False, True)
    }
    assert len(ways) == 8
    assert {name: picture(24, 16).height for name, picture in PATTERNS.items()} == dict.fromkeys(
        PATTERNS, 16
    )


# -- woz doctor -----------------------------------------------------------------------------------


async def examined(face: PluggedFace, **settings: Any) -> Finding:
    (finding,) = await LedFace.examine(
        Probe("face", LedFaceSettings(port=str(face.port), **settings))
    )
    return finding


async def test_the_doctor_measures_and_leaves_the_picture_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_ANSWER_S", 20.0)
    monkeypatch.setattr(doctor, "_PATIENCE_S", 20.0)
    face = PluggedFace(tmp_path / "face")
    finding = await examined(face)
    assert finding.level == "ok", finding
    assert "memory, 24 x 16, protocol 1, answers in" in finding.text
    assert face.board.frames == 0
    assert (await examined(face, rotate="90")).level == "error"
    face.unplug()
    gone = await examined(face)
    assert (gone.level, bool(gone.remedy)) == ("error", True)


async def test_the_doctor_tells_a_busy_computer_from_a_slow_face(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_ANSWER_S", 20.0)
    monkeypatch.setattr(doctor, "_PATIENCE_S", 20.0)
    looks = itertools.count()

    def now() -> tuple[float, float]:
        """From one look to the next pass 90 ms, of which it has waited 80 for a processor."""
        look = next(looks)
        return 0.09 * look, 0.08 * look

    face = PluggedFace(tmp_path / "face")
    finding = await doctor.examine("face", LedFaceSettings(port=str(face.port)), now)
    assert (finding.level, "baud" in finding.remedy) == ("warning", False)
    assert "for 80 ms of them this computer was too busy" in finding.text
    face.noise = b"\x07noise\x00"
    finding = await doctor.examine("face", LedFaceSettings(port=str(face.port)), now)
    assert "for 80 ms of them this computer was too busy" in finding.text
    assert "packets damaged" in finding.text
    assert finding.remedy == "check cable, ground and baud"
    face.unplug()


async def test_the_doctor_names_a_face_that_says_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_ANSWER_S", 0.02)
    monkeypatch.setattr(doctor, "_PATIENCE_S", 0.06)
    face = PluggedFace(tmp_path / "face")
    face.mute = True
    finding = await examined(face)
    assert finding.level == "error"
    assert "no face answers" in finding.text
    assert "firmware" in finding.remedy
    face.unplug()


def test_its_type_is_a_driver(tmp_path: Path) -> None:
    face: type[Driver] = LedFace
    assert [verb.name for verb in face.offer(LedFaceSettings("x")).verbs] == ["pattern"]
    assert face.offer(None).sensors == ()
