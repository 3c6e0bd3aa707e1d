"""Pictures as files: where the file asks for them, while a key has them on, and on a full disk."""

from __future__ import annotations

import errno
import os
import threading
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from woz_drivers.camera import Camera
from woz_drivers.camera.frame_files import VERB
from woz_drivers.camera.settings import CameraSettings, FrameSettings

from tests.drivers.camera.pictures import PipedCamera, picture, with_block
from tests.drivers.published_messages import PATIENCE_S, BusJob, PublishedMessages, until
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_feeds import SEEN
from woz_tui.protocol.messages import Json, Notice
from woz_tui.system.clock import ManualClock


class SavingCamera:
    """A camera behind a pipe that saves its pictures."""

    def __init__(self, folder: Path, frames: FrameSettings | None, **more: Any) -> None:
        self.clock = ManualClock()
        self.published = PublishedMessages(folder, self.clock)
        self.pipe = PipedCamera(folder / "pipe")
        shape: dict[str, Any] = {"width": 20, "height": 15, "format": "rgb24", **more}
        settings = CameraSettings(command=self.pipe.command, frames=frames, **shape)
        self.camera = Camera("eye", settings, self.published.context)
        self._count = 0

    async def film(self, *pictures: Any) -> None:
        """Each comes and is looked at, a tenth of a second after the other."""
        for each in pictures:
            self.clock.advance(0.1)
            self.pipe.send(each)
            self._count += 1
            await until(lambda: self.published.context.feed(SEEN).latest().serial >= self._count)

    async def switch(self, on: bool) -> dict[str, Json]:
        return dict(await self.camera.perform(BusJob("save_frames", {"on": on})))

    @property
    def files(self) -> list[Path]:
        return sorted((self.published.context.media / "frames-eye").glob("*.png"))

    async def until_saved(self, count: int) -> None:
        await until(lambda: len(self.files) == count)


@pytest.fixture
async def shelves(tmp_path: Path) -> AsyncIterator[Any]:
    made: list[SavingCamera] = []

    async def opened(frames: FrameSettings | None = None, **more: Any) -> SavingCamera:
        shelf = SavingCamera(tmp_path, frames, **more)
        made.append(shelf)
        await shelf.camera.open()
        await until(shelf.pipe.connected)
        return shelf

    yield opened
    for shelf in made:
        await shelf.camera.close()


def pixels(path: Path) -> np.ndarray[Any, Any]:
    with Image.open(path) as opened:
        return np.asarray(opened.convert("RGB"))


async def test_nothing_is_saved_unless_the_file_asks(shelves: Any) -> None:
    shelf = await shelves()
    await shelf.film(picture(), picture())
    assert Camera.offer(shelf.camera.settings).verbs == ()
    with pytest.raises(RejectedError):
        await shelf.switch(on=True)
    assert not shelf.published.context.media.exists()


async def test_a_key_switches_it_on_and_off(shelves: Any) -> None:
    shelf = await shelves(FrameSettings())
    assert Camera.offer(shelf.camera.settings).verbs == (VERB,)
    await shelf.film(picture())
    begun = await shelf.switch(on=True)
    films = [with_block(1, 2), with_block(5, 6)]
    await shelf.film(*films)
    await shelf.until_saved(2)
    await shelf.published.until(lambda: 1.0 in shelf.published.values("frames"))
    ended = await shelf.switch(on=False)
    await shelf.film(picture())
    assert [path.name for path in shelf.files] == [
        "frame-20260301-100000-200.png",
        "frame-20260301-100000-300.png",
    ]
    for path, film in zip(shelf.files, films, strict=True):
        assert (pixels(path) == film).all()
        assert path.stat().st_mode & 0o777 == 0o600
    assert shelf.files[0].parent.stat().st_mode & 0o077 == 0
    folder = f"{shelf.published.context.media.name}/frames-eye"
    assert begun == {"folder": folder}
    assert (ended["folder"], ended["skipped"]) == (folder, 0)
    assert shelf.published.states("frames") == ["off", "on", "off"]


async def test_from_the_beginning_turned_and_some_of_them(shelves: Any) -> None:
    shelf = await shelves(FrameSettings(at_once=True, most=5.0), mirror=True, flip=True)
    films = [with_block(n, 0) for n in range(1, 6)]
    await shelf.film(*films)
    await shelf.until_saved(3)
    assert (pixels(shelf.files[1]) == films[2][::-1, ::-1]).all()


async def test_the_last_ones_are_written_when_the_session_ends(shelves: Any) -> None:
    shelf = await shelves(FrameSettings(at_once=True))
    await shelf.film(picture(), picture(), picture())
    await shelf.camera.close()
    assert len(shelf.files) == 3


async def test_what_waits_for_a_slow_disk_is_counted_with_its_own_series(
    shelves: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, quick = os.open, threading.Event()

    def opened(name: Any, flags: int, mode: int = 0o777, **more: Any) -> int:
        if str(name).endswith(".part"):
            assert quick.wait(PATIENCE_S)
        return real(name, flags, mode, **more)

    monkeypatch.setattr(os, "open", opened)
    shelf = await shelves(FrameSettings(at_once=True))
    await shelf.film(picture(), picture(), picture())
    assert (await shelf.switch(on=False))["frames"] == 3
    await shelf.switch(on=True)
    quick.set()
    await shelf.film(picture())
    await shelf.until_saved(4)
    assert (await shelf.switch(on=False))["frames"] == 1


async def test_a_full_disk_is_told_once_and_survived(
    shelves: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.open
    full = True

    def opened(name: Any, flags: int, mode: int = 0o777, **more: Any) -> int:
        if full and str(name).endswith(".part"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(name))
        return real(name, flags, mode, **more)

    monkeypatch.setattr(os, "open", opened)
    shelf = await shelves(FrameSettings(at_once=True))
    await shelf.film(picture())
    await shelf.published.state("frames", "stale")
    await shelf.film(picture(), picture())
    (told,) = shelf.published.all(Notice)
    assert (told.level, "No space left" in told.text) == ("error", True)
    assert told.remedy
    full = False
    shelf.clock.advance(6.0)
    await shelf.film(picture())
    await shelf.published.state("frames", "on")
    await shelf.until_saved(1)
    assert (await shelf.switch(on=False))["skipped"] == 3
    assert [one.level for one in shelf.published.all(Notice)] == ["error", "info"]


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        (FrameSettings(at_once=True, leave_free=10_000_000), "left to the log"),
        (FrameSettings(at_once=True, megabytes=1), "MB of pictures have been saved"),
    ],
)
async def test_the_disk_is_left_to_the_log(
    shelves: Any, monkeypatch: pytest.MonkeyPatch, frames: FrameSettings, words: str
) -> None:
    if frames.megabytes == 1:
        monkeypatch.setattr("woz_drivers.camera.frame_files._MEGABYTE", 1)
    shelf = await shelves(frames)
    await shelf.film(picture())
    if frames.megabytes == 1:
        await shelf.until_saved(1)
        await shelf.published.until(lambda: bool(shelf.published.values("frames")))
        await shelf.film(picture())
    moved = await shelf.published.state("frames", "stale")
    told = shelf.published.all(Notice)[-1]
    assert words in f"{told.text} {told.remedy} {moved.why}"
