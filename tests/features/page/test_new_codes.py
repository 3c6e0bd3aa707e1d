"""Codes that leaked are replaced while the pages run, from another terminal of the same user."""

from __future__ import annotations

import asyncio
import re
import socket
from pathlib import Path

import pytest

from tests.features.page.rig import pages
from tests.features.page.test_answer_page import UX, on_stage, send, shows
from tests.features.page.test_page_command import opened_page
from tests.host.rig import served_session
from tests.session.study_rig import study_experiment
from woz_tui.cli import main
from woz_tui.features.page.visitors import PageRole
from woz_tui.features.questionnaires.kinds import QuestionnaireStarted
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked
from woz_tui.system import session_sockets


async def test_old_codes_and_cookies_die_and_other_roles_stay(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        old_codes, old_class = dict(rig.server.visitors.codes), rig.server.visitors.class_code
        watcher, participant = await rig.watcher(), await rig.participant()
        async with watcher.news("/watch/news") as reader, participant.news("/answer/news") as seat:
            await reader.more()
            await seat.more()
            await rig.server.renew([PageRole.WATCH])
            assert await asyncio.wait_for(reader.response.content.read(), 10) is not None
            assert (await watcher.get("/watch"))[0] == 403
            stranger = await rig.stranger()
            assert (await stranger.get(f"/join/{old_codes[PageRole.WATCH]}"))[0] == 404
            assert (await stranger.post("/code", code=old_class))[0] == 403
            assert (await stranger.post("/code", code=rig.server.visitors.class_code))[0] == 200
            assert (await participant.get("/answer"))[0] == 200
            await rig.server.renew([PageRole.ANSWER])
            assert (await participant.get("/answer"))[0] == 403
            assert (await stranger.get(f"/join/{old_codes[PageRole.ANSWER]}"))[0] == 404
            assert (await (await rig.participant()).get("/answer"))[0] == 200
        news = await rig.watcher()
        async with news.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")


async def test_another_terminal_asks_for_codes_and_new_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    async with served_session(tmp_path) as host:
        async with opened_page(host) as said:
            assert await asyncio.to_thread(main, ["page", "codes", host.path.stem]) == 0
            assert capsys.readouterr().out == "\n".join(said) + "\n"
            order = ["page", "new-code", host.path.stem, "--for", "answer"]
            assert await asyncio.to_thread(main, order) == 0
            told = capsys.readouterr().out.splitlines()
            assert told[:2] == said[:2]
            assert told[2] != said[2]
            assert re.fullmatch(
                r"The participant: +http://127\.0\.0\.1:\d+/join/[0-9a-f]{24}", told[2]
            )
        killed = session_sockets.folder() / f"{host.path.stem}.1.page"
        with socket.socket(socket.AF_UNIX) as left:
            left.bind(str(killed))
        assert await asyncio.to_thread(main, ["page", "codes", host.path.stem]) == 1
        assert not killed.exists()
        assert "no page is open here" in capsys.readouterr().err


async def test_only_who_is_meant_can_come_in(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host, roles=[PageRole.ANSWER]) as rig:
        stranger = await rig.stranger()
        code = rig.server.visitors.class_code
        assert (await stranger.post("/code", code=code))[0] == 403
        assert [*rig.server.visitors.codes] == [PageRole.ANSWER]


async def test_a_questionnaire_begins_by_itself_once_for_each_participant(tmp_path: Path) -> None:
    made = study_experiment(tmp_path, sections={QUESTIONNAIRES: Asked((UX,))})
    async with served_session(tmp_path, made=made) as host, pages(host, begins="ux") as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        first, second = await rig.participant(), await rig.participant()
        page = await shows(first, "There are no wrong answers.")
        await shows(second, "There are no wrong answers.")
        await send(first, page, what="begin")
        await wizard.ask("questionnaire", questionnaire="ux", what="left")
        await shows(first, "Please wait.")  # taken back: it does not come again by itself
        assert "Please wait." in (await first.get("/answer"))[1]
        await shows(second, "Please wait.")  # else it may still show what was taken back
        await wizard.ask("set", participant="P02")
        await shows(second, "There are no wrong answers.")
        begun = [line.source for line in host.of(QuestionnaireStarted)]
        assert begun == ["program", "program"]


async def test_who_comes_next_is_not_thanked_for_what_the_last_one_answered(
    tmp_path: Path,
) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        await stage.begin(browser)
        _, page = await browser.get("/answer?stop")
        await send(browser, page, what="declined")
        await shows(browser, "Thank you!")
        await stage.wizard.ask("set", participant="P02")
        await shows(browser, "Please wait.")
