"""A browser as a screen: what it is told, and what counts as shown."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from pathlib import Path

import aiohttp
import pytest
from woz_drivers.browser_screen import BrowserScreen, BrowserScreenSettings

from tests.analysis.html.browser import browser
from tests.fakes.ports import free_port
from tests.fakes.screen_browser import ScreenBrowser
from woz_tui.drivers.contract import DeviceLostError, DriverError, Health, Probe, RejectedError
from woz_tui.testing import Device, DriverTests, PlainJob, RecordingContext, until

PICTURE = b"\x89PNG of a test"


def settings_here(patience: float = 20.0) -> BrowserScreenSettings:
    """Where nobody else listens."""
    return BrowserScreenSettings(f"127.0.0.1:{free_port()}", code="letmein8", patience=patience)


class TestTheContract(DriverTests):
    driver = BrowserScreen
    settings = BrowserScreenSettings("127.0.0.1:0")

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        settings = settings_here()
        browser = ScreenBrowser(f"http://{settings.listen}/letmein8/")
        browser.open()
        yield Device(settings, unplug=browser.close, plug=browser.open)
        await browser.close()


class Stage:
    """The driver, and browsers that open its page."""

    def __init__(self, folder: Path, settings: BrowserScreenSettings) -> None:
        self.context = RecordingContext(folder=folder)
        self.screen = BrowserScreen("screen", settings, self.context)
        self.address = f"http://{settings.listen}/letmein8/"
        self.browsers: list[ScreenBrowser] = []

    async def browser(self, *, error: str = "", silent: bool = False) -> ScreenBrowser:
        """One that has opened it, and has shown that there is nothing yet."""
        browser = ScreenBrowser(self.address, error=error, silent=silent)
        browser.open()
        self.browsers.append(browser)
        await until(lambda: bool(browser.told or browser.refused))
        return browser


@contextlib.asynccontextmanager
async def on_stage(tmp_path: Path, patience: float = 20.0) -> AsyncIterator[Stage]:
    (tmp_path / "map.png").write_bytes(PICTURE)
    stage = Stage(tmp_path, settings_here(patience))
    await stage.screen.open()
    try:
        yield stage
    finally:
        await asyncio.gather(*(browser.close() for browser in stage.browsers))
        await stage.screen.close()


async def test_a_command_is_done_when_the_browser_has_painted(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.browser()
        sent = await stage.screen.perform(PlainJob("screen", {"file": "map.png"}))
        assert sent == {"file": "map.png", "painted_ms": 32.0}
        assert browser.pictures == [PICTURE]
        await stage.screen.perform(PlainJob("words", {"text": "<b>Ready?</b>"}))
        await stage.screen.perform(PlainJob("words", {"text": ""}))
        assert [(told["kind"], told.get("text", "")) for told in browser.told] == [
            ("words", ""),
            ("picture", ""),
            ("words", "<b>Ready?</b>"),
            ("words", ""),
        ]


async def test_what_nobody_has_painted_is_not_done(tmp_path: Path) -> None:
    async with on_stage(tmp_path, patience=0.2) as stage:
        with pytest.raises(DeviceLostError, match="no browser shows it"):
            await stage.screen.perform(PlainJob("words", {"text": "now"}))
        browser = await stage.browser(silent=True)
        with pytest.raises(DriverError, match=r"has not painted it within 0\.2 s"):
            await stage.screen.perform(PlainJob("words", {"text": "now"}))
        browser.silent, browser.error = False, "the browser cannot read this picture"
        with pytest.raises(DriverError, match="cannot read this picture"):
            await stage.screen.perform(PlainJob("screen", {"file": "map.png"}))


@pytest.mark.parametrize("file", ["../secret.txt", "none.png", "http://evil.example/a.png"])
async def test_only_pictures_of_this_computer_are_shown(tmp_path: Path, file: str) -> None:
    folder = tmp_path / "study"
    folder.mkdir()
    (tmp_path / "secret.txt").write_text("secret")
    async with on_stage(folder) as stage:
        browser = await stage.browser()
        with pytest.raises(RejectedError):
            await stage.screen.perform(PlainJob("screen", {"file": file}))
        assert browser.pictures == []


async def test_a_second_browser_is_turned_away_and_a_later_one_shows_what_holds(
    tmp_path: Path,
) -> None:
    async with on_stage(tmp_path) as stage:
        first = await stage.browser()
        second = await stage.browser()
        assert second.refused
        await stage.screen.perform(PlainJob("words", {"text": "still here"}))
        await first.close()
        await until(lambda: bool(second.told))
        assert second.told[-1]["text"] == "still here"


async def test_strangers_get_nothing(tmp_path: Path) -> None:
    async with on_stage(tmp_path, patience=1.0) as stage, aiohttp.ClientSession() as http:
        browser = await stage.browser(silent=True)
        for path in ("", "news", "picture/1", "painted", "12345678/", "12345678/news"):
            root = stage.address.replace("letmein8/", path)
            async with http.get(root) as answer:
                assert answer.status == 404
        shown = asyncio.ensure_future(stage.screen.perform(PlainJob("words", {"text": "now"})))
        await until(lambda: len(browser.told) > 1)
        said = json.dumps({"number": browser.told[-1]["number"], "after": 1, "error": ""})
        for origin in ("http://127.0.0.1:1", "null", ""):
            headers = {"Origin": origin} if origin else {}
            where = f"{stage.address}painted"
            async with http.post(where, data=said, headers=headers) as answer:
                assert answer.status == 403
        with pytest.raises(DriverError, match="has not painted it"):
            await shown


def test_other_computers_have_to_be_allowed() -> None:
    assert BrowserScreenSettings("127.0.0.1:8071").problems() == []
    assert BrowserScreenSettings("[::1]:8071").problems() == []
    assert BrowserScreenSettings("0.0.0.0:8071", plain=True).problems() == []
    ((setting, why),) = BrowserScreenSettings("0.0.0.0:8071").problems()
    assert setting == "listen"
    assert "nothing is encrypted" in why


async def test_a_port_that_is_taken_is_said(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        other = RecordingContext()
        late = BrowserScreen("late", stage.screen.settings, other)
        await late.open()
        await until(lambda: any(health is Health.LOST for health, _, _ in other.healths))
        await late.close()


async def test_the_doctor_says_whether_a_browser_could_be_let_in(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        await until(lambda: len(stage.context.healths) > 1)
        (taken,) = await BrowserScreen.examine(Probe("screen", stage.screen.settings))
        assert (taken.level, taken.remedy) == ("error", "give it another address (`listen`)")
    (free,) = await BrowserScreen.examine(Probe("screen", settings_here()))
    assert free.level == "ok"
    everywhere = BrowserScreenSettings(f"0.0.0.0:{free_port()}", plain=True)
    (public,) = await BrowserScreen.examine(Probe("screen", everywhere))
    assert public.level == "warning"
    assert "without encryption" in public.text


@pytest.mark.browser
@pytest.mark.real_clock
async def test_a_real_browser_paints_pictures_and_words(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    (tmp_path / "map.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30"><circle r="9"/></svg>'
    )
    (tmp_path / "broken.png").write_bytes(b"no picture")
    async with on_stage(tmp_path) as stage:
        with browser(tmp_path_factory.mktemp("profile"), "127.0.0.1") as page:
            await asyncio.to_thread(page.visit, stage.address)
            await until(lambda: stage.context.healths[-1][0] is Health.CONNECTED)
            sent = await stage.screen.perform(PlainJob("screen", {"file": "map.svg"}))
            assert 0 < float(str(sent["painted_ms"])) < 20_000
            width = "return document.querySelector('img').naturalWidth"
            assert await asyncio.to_thread(page.run, width) == 40
            await stage.screen.perform(PlainJob("words", {"text": "<b>Ready?</b>"}))
            assert await asyncio.to_thread(page.text, "#shown") == "<b>Ready?</b>"
            with pytest.raises(DriverError, match="cannot read this picture"):
                await stage.screen.perform(PlainJob("screen", {"file": "broken.png"}))
            await stage.screen.perform(PlainJob("words", {"text": ""}))
            assert await asyncio.to_thread(page.text, "#shown") == ""
            complaints = await asyncio.to_thread(page.complaints)
            assert all("picture/" in each for each in complaints)
