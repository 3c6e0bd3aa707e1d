"""The tablet over the wire: it fetches what it is to show, as the real one does."""

from __future__ import annotations

import asyncio
import socket
import threading
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.pepper.settings import TabletSettings
from woz_drivers.pepper.tablet import TabletPart
from woz_drivers.pepper.tablet_page import PageKind, kind

from tests.drivers.pepper.part_rig import PartRig, connected_part
from tests.drivers.published_messages import until
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope

PICTURE, OTHER, FILM = b"picture" * 100, b"another" * 50, b"film" * 1000


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "shown").mkdir()
    (tmp_path / "shown" / "map.png").write_bytes(PICTURE)
    (tmp_path / "shown" / "film.mp4").write_bytes(FILM)
    (tmp_path / "logo.JPG").write_bytes(OTHER)
    (tmp_path / "page.html").write_text("<p>page</p>")
    return tmp_path


@pytest.fixture
async def rig(folder: Path, robot: StandIn) -> AsyncIterator[PartRig[TabletPart]]:
    async with connected_part(
        TabletPart, folder, robot, tablet=TabletSettings("shown", "../logo.JPG")
    ) as part_rig:
        await _shows(robot, "webview", len(OTHER))
        yield part_rig


async def _shows(robot: StandIn, what: str, fetched: int = 0) -> dict[str, Any]:
    """Wait until the tablet shows this kind of thing and has fetched that many bytes for it."""

    async def there() -> Any:
        state = await robot.get("tablet")
        loads = await robot.get("tablet.fetched")
        # A film that is shown no more may be fetched to its end even so, and be the last.
        begun = [index for index, load in enumerate(loads) if load["url"] == state["url"]]
        sizes = {load["size"] for load in loads[begun[-1] :]} if begun else set()
        return state if state["shows"] == what and (not fetched or fetched in sizes) else None

    found: dict[str, Any] = await robot.until(there)
    return found


def _servers() -> int:
    """Servers of pictures that run in this process."""
    return [one.name for one in threading.enumerate()].count("robot files")


@pytest.mark.naoqi("ALTabletService.showWebview", "ALTabletService.enableWifi")
@pytest.mark.woz4u("tablet_root_location", "tablet_items", "is_default_img")
async def test_the_default_is_shown_on_connect_and_pictures_when_asked(
    folder: Path, robot: StandIn
) -> None:
    tablet = TabletSettings("shown", "logo.JPG")
    async with connected_part(TabletPart, folder, robot, tablet=tablet) as part_rig:
        await _shows(robot, "webview", len(OTHER))
        assert await part_rig.part.read() == {"tablet": "logo.JPG"}
        assert await part_rig.do("screen", file="map.png") == {"shown": "map.png"}
        state = await _shows(robot, "webview", len(PICTURE))
        assert (state["status"], state["error"]) == (200, "")
        page, picture = (await robot.get("tablet.fetched"))[-2:]
        assert page["type"] == "text/html"
        assert picture["type"] == "image/png"
        assert page["parts"] == [picture["url"]]
        assert await part_rig.do("screen", file="off") == {"shown": "logo.JPG"}
        await _shows(robot, "webview", len(OTHER))
        assert len(await robot.trace("ALTabletService.enableWifi")) == 1
        assert part_rig.notices == []
    await until(lambda: _servers() == 0)


@pytest.mark.naoqi("ALTabletService.playVideo", "ALTabletService.videoFinished")
async def test_a_video_plays_to_its_end_and_the_default_comes_back(
    rig: PartRig[TabletPart], robot: StandIn, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The tablet is never asked, so that its signal alone can tell.
    monkeypatch.setattr("woz_drivers.pepper.tablet._POLL_S", 1000.0)
    await robot.set("tablet.video_seconds", 40)  # long enough to be seen
    assert await rig.do("screen", file="film.mp4") == {"shown": "film.mp4"}
    await _shows(robot, "video")
    assert await rig.part.read() == {"tablet": "film.mp4"}
    await _shows(robot, "webview", len(OTHER))
    await until(lambda: rig.part._shows == "../logo.JPG")
    sizes = [one["size"] for one in await robot.get("tablet.fetched")]
    assert len(FILM) in sizes
    assert rig.notices == []


async def test_the_end_of_a_video_is_found_out_where_no_signal_tells_it(
    rig: PartRig[TabletPart], robot: StandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.pepper.tablet._POLL_S", 0.05)
    await robot.set("tablet.video_seconds", 40)  # long enough to be seen
    for end in rig.part._signals:
        await end()
    rig.part._signals = []
    await rig.do("screen", file="film.mp4")
    await _shows(robot, "video")
    await _shows(robot, "webview", len(OTHER))
    assert len(await robot.trace("ALTabletService.getVideoPosition")) >= 2


async def test_a_video_that_never_begins_is_told(
    rig: PartRig[TabletPart], robot: StandIn, monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    monkeypatch.setattr("woz_drivers.pepper.tablet._POLL_S", 0.05)
    monkeypatch.setattr("woz_drivers.pepper.tablet._BEGINS_WITHIN_S", 0.2)
    address = "http://127.0.0.1:9/film.mp4"
    await rig.do("screen", file=address)
    await until(lambda: any("has not begun to play" in one for one in rig.notices))
    assert any("could not load" in one for one in rig.notices)
    await _shows(robot, "webview", len(OTHER))


async def test_a_picture_after_a_video_ends_it(rig: PartRig[TabletPart], robot: StandIn) -> None:
    await robot.set("tablet.video_seconds", 3600)
    await rig.do("screen", file="film.mp4")
    await _shows(robot, "video")
    await rig.do("screen", file="map.png")
    await _shows(robot, "webview", len(PICTURE))
    assert len(await robot.trace("ALTabletService.stopVideo")) == 1
    assert await rig.part.halt(Scope.ALL) is None


async def test_a_second_video_plays_where_the_tablet_has_no_stopVideo(  # noqa: N802 - its name
    rig: PartRig[TabletPart], robot: StandIn, folder: Path
) -> None:
    (folder / "shown" / "second.mp4").write_bytes(FILM)
    await robot.set("tablet.video_seconds", 3600)
    await robot.fault("refuse:ALTabletService.stopVideo=Can't find method: stopVideo")
    await rig.do("screen", file="film.mp4")
    first = await _shows(robot, "video")
    assert await rig.do("screen", file="second.mp4") == {"shown": "second.mp4"}
    second = await _shows(robot, "video")
    assert first["url"] != second["url"]
    await rig.do("screen", file="map.png")
    await _shows(robot, "webview", len(PICTURE))


@pytest.mark.naoqi("ALTabletService.hideWebview")
@pytest.mark.woz4u("is_default_img")
async def test_without_a_default_the_tablet_is_cleared_on_connect(
    folder: Path, robot: StandIn
) -> None:
    async with connected_part(TabletPart, folder, robot) as part_rig:
        assert len(await robot.trace("ALTabletService.hideWebview")) == 1
        await _shows(robot, "default")
        assert part_rig.notices == []
    await robot.clear()
    await robot.fault("refuse:ALTabletService.hideWebview=no tablet")
    async with connected_part(TabletPart, folder, robot) as part_rig:
        assert (part_rig.notices, part_rig.troubles) == ([], []), (
            "what cannot be cleared shows nothing of ours"
        )


async def test_the_stop_ends_a_video_and_says_tablet(
    rig: PartRig[TabletPart], robot: StandIn
) -> None:
    assert await rig.part.halt(Scope.ALL) is None
    await robot.set("tablet.video_seconds", 3600)
    await rig.do("screen", file="film.mp4")
    await _shows(robot, "video")
    assert await rig.part.halt(Scope.ALL) == ()
    assert len(await robot.trace("ALTabletService.stopVideo")) == 1
    await _shows(robot, "webview", len(OTHER))


async def test_a_stop_that_the_tablet_refuses_is_an_error(
    rig: PartRig[TabletPart], robot: StandIn
) -> None:
    await robot.set("tablet.video_seconds", 3600)
    await rig.do("screen", file="film.mp4")
    await robot.fault("refuse:ALTabletService.stopVideo=no tablet")
    with pytest.raises(DriverError, match="no tablet"):
        await rig.part.halt(Scope.ALL)
    await robot.clear()
    assert await rig.part.halt(Scope.ALL) == ()
    await _shows(robot, "webview", len(OTHER))


async def test_a_video_that_is_cut_short_before_it_plays_can_be_stopped(
    rig: PartRig[TabletPart], robot: StandIn
) -> None:
    await robot.set("tablet.video_seconds", 3600)
    await robot.fault("slow:200")
    showing = asyncio.create_task(rig.do("screen", file="film.mp4"))
    await robot.called("ALTabletService.playVideo")
    stopping = asyncio.create_task(rig.part.halt(Scope.ALL))
    await asyncio.sleep(0)
    showing.cancel()
    assert await stopping == ()
    await _shows(robot, "webview", len(OTHER))
    names = [call.method for call in await robot.trace() if "Video" in call.method]
    assert names == ["playVideo", "stopVideo"]


async def test_a_video_that_the_tablet_refuses_is_not_playing(
    rig: PartRig[TabletPart], robot: StandIn
) -> None:
    await robot.fault("refuse:ALTabletService.playVideo=no such codec")
    with pytest.raises(DriverError, match="no such codec"):
        await rig.do("screen", file="film.mp4")
    assert await rig.part.halt(Scope.ALL) is None


@pytest.mark.naoqi("ALTabletService.hideWebview", "ALTabletService.enableWifi")
async def test_its_network_hiding_and_the_default(rig: PartRig[TabletPart], robot: StandIn) -> None:
    await rig.do("tablet", what="wifi")
    assert len(await robot.trace("ALTabletService.enableWifi")) == 2
    assert await rig.do("tablet", what="hide") == {"shown": ""}
    await _shows(robot, "default")
    assert await rig.part.read() == {"tablet": "its own"}
    await rig.do("tablet", what="default")
    await _shows(robot, "webview", len(OTHER))
    await robot.set("tablet.video_seconds", 3600)
    await rig.do("screen", file="film.mp4")
    assert await rig.do("tablet", what="stop") == {"shown": "../logo.JPG"}
    assert len(await robot.trace("ALTabletService.stopVideo")) == 1
    with pytest.raises(RejectedError):
        await rig.do("tablet", what="explode")


async def test_without_a_default_nothing_is_shown_until_asked(folder: Path, robot: StandIn) -> None:
    async with connected_part(TabletPart, folder, robot) as part_rig:
        assert await robot.trace("ALTabletService.showWebview") == []
        await robot.fault("refuse:ALTabletService.enableWifi=no wifi here")
        await part_rig.do("screen", file="page.html")
        await _shows(robot, "webview", len("<p>page</p>"))
        await robot.clear()
        await part_rig.do("screen", file="off")
        await _shows(robot, "default")


async def test_a_page_and_a_picture_of_somewhere_else(
    rig: PartRig[TabletPart], robot: StandIn, folder: Path
) -> None:
    elsewhere = await rig.connection.files.address(folder / "shown" / "map.png")
    await rig.do("screen", file=f"{elsewhere}?a=1&b='2'")
    await _shows(robot, "webview", len(PICTURE))
    page, _ = (await robot.get("tablet.fetched"))[-2:]
    assert page["parts"] == [f"{elsewhere}?a=1&amp;b=&#x27;2&#x27;"]
    site = "http://127.0.0.1:9/site"
    await rig.do("screen", file=site)
    assert (await _shows(robot, "webview"))["url"] == site
    await until(lambda: bool(rig.notices))
    assert "could not load" in rig.notices[0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("missing.png", r"there is no file .*shown/missing\.png or .*/missing\.png"),
        ("shown", "cannot show 'shown'"),
        ("notes.txt", "cannot show"),
        ("ftp://host/a.png", "cannot fetch"),
        ("http://", "cannot fetch"),
        ("http://[::1/a.png", "is no address"),
        ("\0.png", "is no file|there is no file"),
    ],
)
async def test_what_cannot_be_shown_is_said_and_changes_nothing(
    rig: PartRig[TabletPart], robot: StandIn, text: str, words: str
) -> None:
    with pytest.raises(DriverError, match=words) as raised:
        await rig.do("screen", file=text)
    assert raised.value.remedy
    assert await rig.part.read() == {"tablet": "../logo.JPG"}
    assert (await robot.get("tablet"))["shows"] == "webview"


async def test_a_default_that_is_missing_is_a_notice(folder: Path, robot: StandIn) -> None:
    async with connected_part(
        TabletPart, folder, robot, tablet=TabletSettings(default="lost.png")
    ) as part_rig:
        assert ["there is no file" in one for one in part_rig.notices] == [True]
        await part_rig.do("screen", file="logo.JPG")
        await _shows(robot, "webview", len(OTHER))


async def test_a_port_that_is_taken_is_told(folder: Path, robot: StandIn) -> None:
    server = await asyncio.start_server(lambda _r, _w: None, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    try:
        async with connected_part(
            TabletPart, folder, robot, tablet=TabletSettings(port=port)
        ) as part_rig:
            with pytest.raises(DriverError, match=f"port {port}: Address already in use"):
                await part_rig.do("screen", file="logo.JPG")
    finally:
        server.close()


async def test_after_a_loss_the_default_is_shown_again(folder: Path, port: int) -> None:
    tablet = TabletSettings(default="logo.JPG")
    async with (
        stand_in(port=port) as robot,
        connected_part(TabletPart, folder, robot, tablet=tablet) as part_rig,
    ):
        await part_rig.do("screen", file="shown/map.png")
        robot.kill()
        await until(lambda: not part_rig.connection.ready)
        with pytest.raises(DeviceLostError):
            await part_rig.do("screen", file="logo.JPG")
        async with stand_in(port=port) as back:
            await part_rig.wait_connected(2)
            await _shows(back, "webview", len(OTHER))
            assert await part_rig.part.read() == {"tablet": "logo.JPG"}


def _has_ipv6() -> bool:
    try:
        with socket.socket(socket.AF_INET6) as one:
            one.bind(("::1", 0))
    except OSError:
        return False
    return True


@pytest.mark.skipif(not _has_ipv6(), reason="this machine has no IPv6")
async def test_a_robot_that_is_reached_in_another_way_gets_its_pictures_there(
    folder: Path,
) -> None:
    tablet = TabletSettings(default="logo.JPG")
    async with (
        stand_in("own") as here,
        stand_in("own", options=("--host", "::1")) as there,
        connected_part(TabletPart, folder, here, tablet=tablet) as part_rig,
    ):
        first = await _shows(here, "webview", len(OTHER))
        assert first["url"].startswith("http://127.0.0.1:")
        part_rig.part.lost()
        await part_rig.connection.connect(f"tcp://[::1]:{there.port}")
        await part_rig.wait_connected(2)
        second = await _shows(there, "webview", len(OTHER))
        assert second["url"].startswith("http://[::1]:")
        await until(lambda: _servers() == 1)


async def test_a_video_ends_with_the_session(folder: Path, robot: StandIn) -> None:
    await robot.set("tablet.video_seconds", 3600)
    async with connected_part(TabletPart, folder, robot) as part_rig:
        await part_rig.do("screen", file="shown/film.mp4")
        await _shows(robot, "video")
    assert len(await robot.trace("ALTabletService.stopVideo")) == 1
    assert [one for one in asyncio.all_tasks() if "pepper" in one.get_name()] == []


@pytest.mark.woz4u("tablet_items")
@pytest.mark.parametrize("place", ["", "http://a.example/films/", "https://a.example/"])
@pytest.mark.parametrize(
    ("what", "suffixes"),
    [
        # By which WoZ4U's program tells them apart (its utils.py).
        (PageKind.VIDEO, "mp4 m4v mkv webm mov avi wmv mpg flv"),
        (PageKind.PICTURE, "jpeg jpg gif bmp png ppm pgm webp svg"),
    ],
)
async def test_what_woz4u_takes_for_a_picture_or_a_video_is_one(
    what: PageKind, suffixes: str, place: str
) -> None:
    assert {kind(f"{place}item.{suffix}") for suffix in suffixes.split()} == {what}
