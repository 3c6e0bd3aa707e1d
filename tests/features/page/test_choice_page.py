"""A choice on the participant's page: buttons with words or pictures, in a form or by script."""

from __future__ import annotations

from pathlib import Path

from tests.features.choices.test_choices import offering
from tests.features.page.rig import pages
from tests.features.page.test_answer_page import send, shows
from tests.host.rig import served_session
from tests.session.rig import experiment
from woz_tui.features.choices.kinds import ChoiceMade, ChoiceOffered


async def test_a_choice_without_javascript(tmp_path: Path) -> None:
    made = offering(experiment(tmp_path))
    async with served_session(tmp_path, made=made) as host, pages(host) as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        browser, other = await rig.participant(), await rig.participant()
        await shows(browser, "Please wait.")
        await shows(other, "Please wait.")
        await wizard.ask("action", action="Offer")
        page, stale = await shows(browser, "Which colour?"), await shows(other, "Which colour?")
        [offered] = host.of(ChoiceOffered)
        picture = f"/answer/picture/{offered.seq}/1"
        assert f'<img src="{picture}" alt="">' in page
        async with browser.http.get(browser.here + picture) as response:
            assert (response.content_type, await response.read()) == (
                "image/png",
                b"\x89PNG of blue",
            )
        assert (await (await rig.stranger()).get(picture))[0] == 403
        assert (await browser.get(f"/answer/picture/{offered.seq}/0"))[0] == 404
        await send(browser, page, what="choose-0")
        await shows(browser, "Please wait.")
        await send(browser, page, what="choose-0")  # a double tap
        await send(other, stale, what="choose-1")  # another tablet, too late
        assert "Please wait." in (await other.get("/answer"))[1]
        assert [line.option for line in host.of(ChoiceMade)] == ["Red"]
        assert (await browser.get(picture))[0] == 404


async def test_a_choice_is_taken_back_on_the_page(tmp_path: Path) -> None:
    made = offering(experiment(tmp_path))
    async with served_session(tmp_path, made=made) as host, pages(host) as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        browser = await rig.participant()
        await wizard.ask("action", action="Offer")
        page = await shows(browser, "Which colour?")
        await wizard.ask("action", action="Take")
        await shows(browser, "Please wait.")
        await send(browser, page, what="choose-0")
        assert not host.of(ChoiceMade)
