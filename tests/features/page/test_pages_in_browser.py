"""The pages in a real browser: what strangers try there, and what is seen."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import TypeVar

import pytest
from aiohttp import web
from selenium.webdriver.common.by import By

from tests.analysis.html.browser import Page, browser
from tests.features.choices.test_choices import offering
from tests.features.page.rig import PageRig, pages
from tests.host.rig import served_session
from tests.host.test_pictures import give
from tests.session.rig import experiment
from tests.session.study_rig import STUDY, study_experiment
from woz_tui.features.choices.kinds import ChoiceMade
from woz_tui.features.page.visitors import PageRole
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem

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


@contextmanager
def scripts_allowed(page: Page, allowed: bool) -> Iterator[None]:
    """Pages run their own scripts, or not."""
    switch = "Emulation.setScriptExecutionDisabled"
    page.driver.execute_cdp_cmd(switch, {"value": not allowed})
    try:
        yield
    finally:
        page.driver.execute_cdp_cmd(switch, {"value": False})


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


async def test_the_picture_of_a_named_camera_is_seen(tmp_path: Path, opened: Page) -> None:
    async with served_session(tmp_path) as host, pages(host, cameras=("robot",)) as rig:
        give(host)
        await join(opened, rig, PageRole.WATCH)
        size = "return document.querySelector('img').naturalWidth"
        await aside(opened.until, lambda: opened.run(size) > 0)
        assert await aside(opened.complaints) == []


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
            # The browser says why there is nothing in the frame.
            await aside(
                opened.until, lambda: any("frame-ancestors" in one for one in opened.complaints())
            )
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


async def test_who_guesses_codes_gets_nowhere_and_then_has_to_wait(
    tmp_path: Path, opened: Page
) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        await aside(opened.visit, f"{rig.here}/join/{'0' * 24}")
        assert "This address does not exist" in await aside(opened.text, "main")
        await aside(opened.visit, f"{rig.here}/answer")
        assert "The address with the code is needed." in await aside(opened.text, "main")
        for said in ("This is not the code.",) * 5 + ("wait a minute",):
            await aside(opened.visit, rig.here)
            field = await aside(opened.one, "input[name=code]")
            wrong = "000000" if rig.server.visitors.class_code != "000000" else "000001"
            await aside(field.send_keys, f"{wrong}\n")
            await aside(opened.until, lambda said=said: said in opened.text("#complaint"))


TLX = Questionnaire(
    "tlx",
    "The task",
    when="hand",
    items=tuple(
        QuestionnaireItem(name, f"{name}?", 0, 20, ("very low", "very high"))
        for name in ("Mental", "Physical", "Temporal", "Performance", "Effort", "Frustration")
    ),
)


@pytest.mark.parametrize("scripts", [True, False])
async def test_a_participant_answers_on_a_phone_and_loads_the_page_anew(
    tmp_path: Path, opened: Page, scripts: bool
) -> None:
    made = study_experiment(tmp_path, STUDY, {QUESTIONNAIRES: Asked((TLX,))})
    opened.size(360, 640)

    def asked(item: str) -> None:
        opened.until(lambda: opened.driver.find_elements(By.XPATH, f"//legend[.='{item}?']"))

    def answer(item: str, value: int) -> None:
        asked(item)
        opened.hands().click(opened.one(f"input[name=value][value='{value}']")).perform()
        # A double tap.
        opened.hands().double_click(opened.one("button[value=answer]")).perform()

    with scripts_allowed(opened, scripts):
        async with served_session(tmp_path, made=made) as host, pages(host) as rig:
            wizard = await host.connect()
            await wizard.hello("wizard")
            await join(opened, rig, PageRole.ANSWER)
            await aside(opened.until, lambda: opened.one(".said").text == "Please wait.")
            await wizard.ask("questionnaire", questionnaire="tlx", what="begin")
            begin = "button[value=begin]"
            await aside(opened.until, lambda: opened.all(begin))
            await aside(lambda: opened.one(begin).click())
            for number, item in enumerate(TLX.items):
                await aside(answer, item.name, number)
                if number == 2:
                    await aside(asked, TLX.items[3].name)
                    await aside(opened.driver.refresh)
            await aside(opened.until, lambda: opened.all("button[value=done]"))
            wide = "return document.documentElement.scrollWidth" if scripts else "return 360"
            assert await aside(opened.run, wide) <= 360
            await aside(lambda: opened.one("button[value=done]").click())
            await aside(opened.until, lambda: opened.one(".said").text == "Thank you!")
            answers = [line for line in host.lines if isinstance(line, QuestionnaireAnswered)]
    assert [(line.item, line.value) for line in answers] == [
        (item.name, float(number)) for number, item in enumerate(TLX.items)
    ]
    assert all(line.answered_us >= 0 for line in answers)


@pytest.mark.parametrize("scripts", [True, False])
async def test_a_participant_chooses_on_a_phone(
    tmp_path: Path, opened: Page, scripts: bool
) -> None:
    made = offering(experiment(tmp_path))
    opened.size(360, 640)
    with scripts_allowed(opened, scripts):
        async with served_session(tmp_path, made=made) as host, pages(host) as rig:
            wizard = await host.connect()
            await wizard.hello("wizard")
            await join(opened, rig, PageRole.ANSWER)
            await aside(opened.until, lambda: opened.one(".said").text == "Please wait.")
            await wizard.ask("action", action="Offer")
            buttons = ".choices button"
            await aside(opened.until, lambda: len(opened.all(buttons)) == 2)
            assert [each.text for each in await aside(opened.all, buttons)] == ["Red", "Blue"]
            await aside(lambda: opened.hands().double_click(opened.all(buttons)[1]).perform())
            await aside(opened.until, lambda: opened.one(".said").text == "Please wait.")
            [made_] = host.of(ChoiceMade)
            assert (made_.option, made_.after_us >= 0) == ("Blue", True)


async def test_what_was_typed_survives_loading_anew_and_a_lost_line(
    tmp_path: Path, opened: Page
) -> None:
    asked = Questionnaire(
        "free", "Free", when="hand", items=(QuestionnaireItem("why", "Why?", text=True),)
    )
    made = study_experiment(tmp_path, STUDY, {QUESTIONNAIRES: Asked((asked,))})
    async with served_session(tmp_path, made=made) as host, pages(host) as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        await join(opened, rig, PageRole.ANSWER)
        await wizard.ask("questionnaire", questionnaire="free", what="begin")
        await aside(opened.until, lambda: opened.all("button[value=begin]"))
        await aside(lambda: opened.one("button[value=begin]").click())
        await aside(opened.until, lambda: opened.all("textarea"))
        await aside(lambda: opened.one("textarea").send_keys("Because it"))
        await aside(opened.driver.refresh)
        typed = "return document.querySelector('textarea').value"
        await aside(opened.until, lambda: opened.run(typed) == "Because it")
        offline = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
        await aside(opened.driver.execute_cdp_cmd, "Network.enable", {})
        await aside(opened.driver.execute_cdp_cmd, "Network.emulateNetworkConditions", offline)
        await aside(lambda: opened.one("button[value=answer]").click())
        await aside(opened.until, lambda: "Not sent yet" in opened.text("#complaint"))
        online = {**offline, "offline": False, "downloadThroughput": -1, "uploadThroughput": -1}
        await aside(opened.driver.execute_cdp_cmd, "Network.emulateNetworkConditions", online)
        await aside(opened.until, lambda: opened.all("button[value=done]"))
        answers = [line.text for line in host.lines if isinstance(line, QuestionnaireAnswered)]
        assert answers == ["Because it"]


async def test_without_javascript_the_page_is_whole(tmp_path: Path, opened: Page) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        with scripts_allowed(opened, False):
            await join(opened, rig, PageRole.WATCH)
            assert (await aside(opened.one, "#title")).text == "Made by hand"


async def test_the_report_after_the_end_works_as_a_page_of_its_own(
    tmp_path: Path, opened: Page
) -> None:
    opened.size(1400, 900)
    async with served_session(tmp_path) as host, pages(host, debrief=True) as rig:
        await join(opened, rig, PageRole.WATCH)
        await aside(opened.until, lambda: opened.text("#title") == "Made by hand")
        host.session.hub.publish(m.SessionEnd(reason="ended"))
        await host.host.close()
        await aside(opened.until, lambda: opened.visible("#debrief a") == 1)
        await aside(lambda: opened.one("#debrief a").click())
        ready = "return document.documentElement.dataset.ready"
        await aside(opened.until, lambda: opened.run(ready) == "yes")
        assert await aside(opened.complaints) == []
