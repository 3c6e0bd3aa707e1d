"""The pages in a real browser: what strangers try there, and what is seen."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TypeVar

import pytest
from aiohttp import web

from tests.analysis.html.browser import Page, browser
from tests.features.page.rig import PageRig, pages
from tests.host.rig import served_session
from woz_tui.features.page.visitors import PageRole
from woz_tui.protocol import messages as m

pytestmark = [pytest.mark.browser, pytest.mark.real_clock]

T = TypeVar("T")


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser(tmp_path_factory.mktemp("profile"), "127.0.0.1", "localhost") as page:
        yield page


async def aside(work: Callable[..., T], *given: object) -> T:
    """Something that waits for the browser, while the pages are served here."""
    return await asyncio.to_thread(functools.partial(work, *given))


async def join(page: Page, rig: PageRig, role: PageRole) -> None:
    """Open the address that lets in, and wait for the page behind it."""
    await aside(page.visit, f"{rig.here}/join/{rig.server.visitors.codes[role]}")
    await aside(page.until, lambda: page.driver.current_url == f"{rig.here}/{role.value}")


@asynccontextmanager
async def other_pages(text: str) -> AsyncIterator[str]:
    """Pages of somebody else on this computer; every one is the same."""

    async def give(request: web.Request) -> web.Response:
        return web.Response(text=text, content_type="text/html")

    application = web.Application()
    application.router.add_route("*", "/{path:.*}", give)
    runner = web.AppRunner(application)
    await runner.setup()
    await web.TCPSite(runner, "127.0.0.1", 0).start()
    try:
        yield f"http://127.0.0.1:{runner.addresses[0][1]}"
    finally:
        await runner.cleanup()


async def test_the_watch_page_follows_the_session(tmp_path: Path, opened: Page) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        await join(opened, rig, PageRole.WATCH)
        wizard = await host.connect()
        await wizard.hello("wizard")
        await aside(opened.until, lambda: opened.text("#plays") == "The wizard plays")
        hostile = "<script>document.title='mine'</script><img src=x onerror=alert(1)>"
        host.session.hub.publish(m.Marker(source="program", text=hostile))
        await aside(opened.until, lambda: hostile in opened.text("#events"))
        assert await aside(opened.visible, "#stop") == 0
        await wizard.ask("stop")
        await aside(opened.until, lambda: opened.visible("#stop") == 1)
        assert "STOPPED" in await aside(opened.text, "#stop")
        assert opened.driver.title == "Made by hand"
        assert await aside(opened.complaints) == []
        elsewhere = [each for each in opened.requests() if not each.startswith(rig.here)]
        assert elsewhere == []


async def test_what_pages_of_others_try(tmp_path: Path, opened: Page) -> None:
    """Another port of this computer is the same site: its pages send the cookie along."""
    async with served_session(tmp_path) as host, pages(host) as rig:
        await join(opened, rig, PageRole.WATCH)
        async with other_pages("<title>other</title><p>something else</p>") as other:
            await aside(opened.visit, other)
            tried = await aside(
                opened.run,
                """
                const here = arguments[0];
                const stream = new Promise((done) => {
                  const source = new EventSource(here + "/watch/news", {withCredentials: true});
                  source.onmessage = () => done("news");
                  source.onerror = () => done("nothing");
                });
                const form = fetch(here + "/code", {method: "POST", credentials: "include",
                  mode: "no-cors", body: new URLSearchParams({code: "1"})}).catch(() => "nothing");
                const read = fetch(here + "/watch", {credentials: "include"})
                  .then((answer) => answer.text()).catch(() => "nothing");
                const frame = new Promise((done) => {
                  const element = document.createElement("iframe");
                  element.onload = () => {
                    let text = "nothing";
                    try { text = element.contentDocument.body.textContent; } catch {}
                    done(text);
                  };
                  element.src = here + "/watch";
                  document.body.append(element);
                });
                return Promise.all([stream, form, read, frame]);
                """,
                rig.here,
            )
            assert tried == ["nothing"] * 4
            refused = [
                entry for entry in await aside(opened.complaints) if "frame-ancestors" in entry
            ]
            assert refused  # the browser says why there is nothing in the frame
        # The form was refused before its code was looked at: none was wrong.
        assert rig.server.visitors.wrong_in_all == 0


async def test_by_another_name_of_this_computer_one_is_a_stranger(
    tmp_path: Path, opened: Page
) -> None:
    async with served_session(tmp_path) as host, pages(host, names=("localhost",)) as rig:
        await join(opened, rig, PageRole.WATCH)
        await aside(opened.visit, f"http://localhost:{rig.port}/watch")
        assert "A code is needed" in await aside(opened.text, "main")


async def test_a_pupil_types_the_code_of_the_class(tmp_path: Path, opened: Page) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        await aside(opened.visit, rig.here)
        field = await aside(opened.one, "input[name=code]")
        await aside(field.send_keys, f"{rig.server.visitors.class_code}\n")
        await aside(opened.until, lambda: opened.driver.current_url == f"{rig.here}/watch")
        await aside(opened.until, lambda: opened.text("#title") == "Made by hand")


async def test_without_javascript_the_page_is_whole(tmp_path: Path, opened: Page) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        try:
            await aside(
                opened.driver.execute_cdp_cmd,
                "Emulation.setScriptExecutionDisabled",
                {"value": True},
            )
            await join(opened, rig, PageRole.WATCH)
            assert (await aside(opened.one, "#title")).text == "Made by hand"
        finally:
            await aside(
                opened.driver.execute_cdp_cmd,
                "Emulation.setScriptExecutionDisabled",
                {"value": False},
            )
