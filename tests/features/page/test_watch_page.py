"""The page for watchers: what it says, how often, and to how many."""

from __future__ import annotations

import asyncio
import re
from contextlib import AsyncExitStack
from pathlib import Path

import pytest

from tests.features.page.rig import pages
from tests.features.page.test_answer_page import Clock
from tests.host.rig import served_session
from tests.session.study_rig import study_experiment
from woz_tui.features.page import server as page_server
from woz_tui.protocol import messages as m


def texts(view: dict[str, object]) -> str:
    """The sentences of the events."""
    events = view.get("events")
    assert isinstance(events, list)
    return " / ".join(" ".join(text for text, _ in event["pieces"]) for event in events)


async def test_it_says_what_happens_in_the_words_of_the_console(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            view = await reader.until(lambda view: view["plays"] == "The wizard plays")
            assert (view["title"], view["stop"], view["lost"]) == ("Made by hand", "", "")
            await wizard.ask("action", action="Hello")
            await reader.until(lambda view: "Hello “Hello" in texts(view))
            changed = m.EngagementChanged(was="", now="Wait", outcome="", why="", verdicts={})
            host.session.hub.publish(changed)
            await reader.until(lambda view: view["engagement"] == "nobody there")
            for name, value in (("presence", 1.0), ("distance", 0.8), ("touch", 1.0)):
                host.session.hub.publish(m.Reading(sensor=name, driver="robot", value=value))
            view = await reader.until(lambda view: len(view["meters"]) > 1)
            assert view["meters"] == [
                {"name": "distance", "text": "0.80 m personal", "share": 0.17, "old": False},
                {"name": "person", "text": "yes", "share": None, "old": False},
            ]
            await wizard.ask("stop")
            view = await reader.until(lambda view: view["stop"])
            assert view["stop"].startswith("■ STOPPED by ")
        status, page = await watcher.get("/watch")
        assert status == 200
        for said in ("Made by hand", "The wizard plays", "STOPPED by", "nobody there", "0.80 m"):
            assert said in page


async def test_who_watches_reads_that_the_wizard_must_answer(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            changed = m.EngagementChanged(
                was="UserSpeaks", now="RobotThinks", outcome="", why="", verdicts={}, visitor="V2"
            )
            host.session.hub.publish(changed)
            waits = "visitor V2 waits for the wizard's answer"
            await reader.until(lambda view: view["engagement"] == waits)


async def test_trial_and_condition_are_those_that_a_wizard_sees(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=study_experiment(tmp_path)) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        async with pages(host) as rig:
            watcher = await rig.watcher()
            async with watcher.news("/watch/news") as reader:
                await wizard.ask("assign", participant="P01", order=["A", "B"])
                await wizard.ask("trial", what="begin")
                view = await reader.until(lambda view: view["trial"].startswith("trial 1 of 4"))
                assert "Trial 1 of 4 begins" in texts(view)
                assert "P01: A, B" in texts(view)
            _, page = await watcher.get("/watch")
            assert not re.search("warm|cold", page)


async def test_twenty_readers_are_one_connection_and_get_few_updates(tmp_path: Path) -> None:
    """Whatever comes from the session, each gets the newest some times a second."""
    async with served_session(tmp_path) as host, pages(host) as rig, AsyncExitStack() as stack:
        watchers = [await rig.watcher() for _ in range(20)]
        readers = [
            await stack.enter_async_context(watcher.news("/watch/news")) for watcher in watchers
        ]
        for number in range(500):
            host.session.hub.publish(
                m.Reading(sensor="distance", driver="robot", value=number / 100, unit="m")
            )
            if number % 50 == 0:
                await asyncio.sleep(0)
        host.session.hub.publish(m.Marker(source="program", text="the last"))
        await asyncio.gather(
            *(reader.until(lambda view: "the last" in texts(view)) for reader in readers)
        )
        assert [reader.view["meters"][0]["text"] for reader in readers] == ["4.99 m public"] * 20
        assert max(reader.updates for reader in readers) < 50
        attached = [line for line in host.lines if isinstance(line, m.ConsoleAttached)]
        assert [(line.role, line.name) for line in attached] == [("watcher", "page")]


async def test_what_somebody_writes_is_text_and_nothing_else(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        watcher = await rig.watcher()
        hostile = "<script>alert(1)</script><img src=x onerror=alert(2)>"
        async with watcher.news("/watch/news") as reader:
            host.session.hub.publish(m.Marker(source="program", text=hostile))
            await reader.until(lambda view: hostile in texts(view))
        _, page = await watcher.get("/watch")
        assert "&lt;script&gt;alert(1)" in page
        assert "<script>" not in page
        assert "<img" not in page


async def test_a_session_that_ends_is_said_to_be_over(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")
            wizard = await host.connect()
            await wizard.hello("wizard")
            await wizard.ask("end")
            host.session.hub.publish(m.SessionEnd(reason="ended"))
            view = await reader.until(lambda view: view["over"])
            assert (view["plays"], view["lost"]) == ("The session is over", "")


async def test_a_robot_process_that_is_gone_is_said_to_be_lost(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")
            await host.host.close()
            view = await reader.until(lambda view: view["lost"])
            assert view["lost"] == "The robot process is gone"


async def test_pages_end_when_the_robot_process_is_gone_for_good(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else they would hold their port when the next session begins."""
    monkeypatch.setattr(page_server, "FAREWELL_S", 0.0)
    clock, said = Clock(), list[str]()
    async with served_session(tmp_path) as host, pages(host, told=said, clock=clock) as rig:
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")
            await host.host.close()
            await reader.until(lambda view: view["lost"])
            over = asyncio.create_task(rig.server.until_over())
            while not over.done():
                clock.ahead_us += round(page_server.GONE_S * 1e6)
                await reader.more()
        assert said == ["The robot process is gone, so the pages end, too."]


async def test_large_for_a_projector_and_without_javascript(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        watcher = await rig.watcher()
        _, page = await watcher.get("/watch")
        assert '<body class="watch">' in page
        assert '<noscript><meta http-equiv="refresh" content="3"></noscript>' in page
        _, page = await watcher.get("/watch?big")
        assert '<body class="watch big">' in page


async def test_after_the_end_those_who_watched_read_the_report(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host, debrief=True) as rig:
        watcher, stranger = await rig.watcher(), await rig.stranger()
        async with watcher.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")
            assert (await watcher.get("/watch/debrief"))[0] == 404
            host.session.hub.publish(m.SessionEnd(reason="ended"))
            await host.host.close()
            view = await reader.until(lambda view: view["debrief"])
            assert view["plays"] == "The session is over"
        status, page = await watcher.get("/watch/debrief")
        assert status == 200
        assert "session report</title>" in page
        assert (await stranger.get("/watch/debrief"))[0] == 403


async def test_without_a_report_it_is_said_why(tmp_path: Path) -> None:
    told: list[str] = []
    async with served_session(tmp_path) as host, pages(host, told=told, debrief=True) as rig:
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")
            for file in (tmp_path / "recordings").iterdir():
                file.unlink()
            host.session.hub.publish(m.SessionEnd(reason="ended"))
            await host.host.close()
            await reader.until(lambda view: view["over"])
        assert "There is no report for those who watched: " in told[0]
