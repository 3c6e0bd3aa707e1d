"""The camera's pictures for people: only while somebody watches, as they are, turned if told to."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.camera import Camera
from woz_drivers.camera.raw_pictures import Picture as Pixels
from woz_drivers.camera.raw_pictures import PictureLayout
from woz_drivers.camera.settings import CameraSettings

from tests.drivers.camera.pictures import PipedCamera, planes, with_block
from tests.drivers.published_messages import PublishedMessages, until
from woz_tui.motion.body_feeds import SEEN
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.system.clock import ManualClock

SMALL = {"width": 20, "height": 15, "format": "rgb24"}


class CameraRig:
    """A camera behind a pipe, and a clock that stands still."""

    def __init__(self, folder: Path, **more: object) -> None:
        self.clock = ManualClock()
        self.published = PublishedMessages(folder, self.clock)
        self.pipe = PipedCamera(folder / "pipe")
        camera_settings = CameraSettings(command=self.pipe.command, **{**SMALL, **more})  # type: ignore[arg-type]
        self.camera = Camera("it", camera_settings, self.published.context)
        self._count = 0

    def watch(self, seconds: float, width: int = 20, rate: float = 5.0) -> None:
        wish = CameraWatched(self.clock.now_us() + round(seconds * 1_000_000), width, rate)
        self.published.context.feed(WATCHED).put(wish)

    async def film(self, picture: Pixels | bytes) -> None:
        """One picture comes and has been looked at."""
        self.pipe.send(picture)
        self._count += 1
        await until(lambda: self.published.context.feed(SEEN).latest().serial >= self._count)

    @property
    def offered(self) -> int:
        return self.published.context.feed(PICTURE).latest().serial

    @property
    def last(self) -> Picture:
        value = self.published.context.feed(PICTURE).latest().value
        assert isinstance(value, Picture)
        return value

    @property
    def pixels(self) -> Pixels:
        last = self.last
        return np.frombuffer(last.rgb, np.uint8).reshape(last.height, last.width, 3)


@pytest.fixture
async def seats(tmp_path: Path) -> AsyncIterator[list[CameraRig]]:
    made: list[CameraRig] = []
    yield made
    for rig in made:
        await rig.camera.close()


async def open_rig(seats: list[CameraRig], folder: Path, **more: object) -> CameraRig:
    rig = CameraRig(folder, **more)
    seats.append(rig)
    await rig.camera.open()
    await until(rig.pipe.connected)
    return rig


async def test_pictures_come_while_somebody_watches_and_no_longer(
    seats: list[CameraRig], tmp_path: Path
) -> None:
    rig = await open_rig(seats, tmp_path)
    made = with_block(3, 4, 2)
    await rig.film(made)
    assert rig.offered == 0, "nobody watches"
    rig.watch(2.0)
    await rig.film(made)
    assert rig.offered == 1
    assert np.array_equal(rig.pixels, made)
    rig.clock.advance(2.0)
    await rig.film(made)
    assert rig.offered == 1, "the watch is over"


async def test_no_more_pictures_than_twice_the_wanted_rate(
    seats: list[CameraRig], tmp_path: Path
) -> None:
    rig = await open_rig(seats, tmp_path)
    rig.watch(60.0, rate=4.0)
    for _ in range(32):
        await rig.film(with_block(3, 4))
        rig.clock.advance(1 / 32)
    assert rig.offered == 8
    assert rig.last.t_us == 875_000


@pytest.mark.parametrize(
    ("mirror", "flip", "corner"),
    [
        (False, False, (4, 3)),
        (True, False, (4, 16)),
        (False, True, (10, 3)),
        (True, True, (10, 16)),
    ],
)
async def test_a_turned_camera_is_turned_back(
    seats: list[CameraRig], tmp_path: Path, mirror: bool, flip: bool, corner: tuple[int, int]
) -> None:
    rig = await open_rig(seats, tmp_path, mirror=mirror, flip=flip)
    rig.watch(2.0)
    await rig.film(with_block(3, 4))
    assert np.argwhere(rig.pixels[:, :, 1] == 200).tolist() == [list(corner)]


@pytest.mark.parametrize(
    ("width", "wanted", "gets"), [(640, 640, 640), (640, 200, 214), (640, 9000, 640)]
)
def test_pictures_of_planes_keep_their_size(width: int, wanted: int, gets: int) -> None:
    made = with_block(100, 60, 40, width, 480)
    shown = PictureLayout(width, 480, "yuv420", width).for_people(planes(made, width), wanted)
    assert shown.shape[1] == gets
    step = -(-width // gets)
    assert np.abs(shown.astype(int) - made[::step, ::step].astype(int)).max() <= 4


@given(st.integers(1, 40), st.integers(1, 40), st.integers(1, 60), st.integers(0, 3))
def test_planes_of_any_size(width: int, height: int, wanted: int, padding: int) -> None:
    layout = PictureLayout(width, height, "yuv420", width + padding)
    shown = layout.for_people((bytes(range(256)) * 20)[: layout.size], wanted)
    assert shown.shape[0] >= 1
    assert min(width, wanted) <= shown.shape[1] <= max(width, wanted)
