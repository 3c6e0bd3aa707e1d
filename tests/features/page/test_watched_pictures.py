"""Cameras' pictures on the watch page: only those that were named, for those alone who watch."""

from __future__ import annotations

import asyncio
from pathlib import Path

from tests.config.reading import HELLO, SEEING, panel, read_experiment
from tests.features.page.rig import pages
from tests.host.rig import served_session
from tests.host.test_pictures import BLUE, RED, give
from woz_tui.features.page.pictures import EVERY_S
from woz_tui.features.page.section import PAGE, command_line
from woz_tui.system.clock import RealClock

PNG = b"\x89PNG"
PICTURE = "/watch/picture/0"


class Clock(RealClock):
    """The server's clock."""

    ahead_us = 0

    def now_us(self) -> int:
        return super().now_us() + self.ahead_us


async def test_there_are_none_unless_a_camera_is_named(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        give(host)
        watcher = await rig.watcher()
        assert "<img" not in (await watcher.get("/watch"))[1]
        assert (await watcher.get(PICTURE))[0] == 404


async def test_who_watches_sees_the_named_camera_and_many_are_one(tmp_path: Path) -> None:
    clock = Clock()
    async with (
        served_session(tmp_path) as host,
        pages(host, cameras=("robot",), clock=clock) as rig,
    ):
        watchers = [await rig.watcher() for _ in range(5)]
        page = (await watchers[0].get("/watch"))[1]
        assert f'<img src="{PICTURE}" alt="Picture of robot">' in page
        assert (await watchers[0].get(PICTURE))[0] == 404  # it has taken none
        for stranger in (await rig.stranger(), await rig.participant()):
            assert (await stranger.get(PICTURE))[0] == 403

        async def seen(place: int) -> bytes:
            async with watchers[place].http.get(rig.here + PICTURE) as response:
                assert (response.status, response.content_type) == (200, "image/png")
                return await response.read()

        give(host, RED)
        first = await seen(0)
        assert first.startswith(PNG)
        give(host, BLUE)
        assert {*await asyncio.gather(*map(seen, range(5)))} == {first}
        clock.ahead_us += round(EVERY_S * 1e6)
        assert await seen(1) != first


def test_the_file_names_cameras_and_is_warned(tmp_path: Path) -> None:
    made = read_experiment(
        tmp_path, panel(HELLO, head=SEEING % "presence") + "page: {pictures: [eye]}\n"
    )
    settings = PAGE.of(made)
    assert settings is not None
    assert command_line(settings).endswith("--pictures eye")
    assert [each.message for each in made.warnings if "camera" in each.message] == [
        "whoever watches the page sees who is before the camera"
    ]
