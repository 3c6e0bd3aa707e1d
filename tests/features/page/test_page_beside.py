"""Pages that begin with the session, as its file says, and what the session is told of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HELLO, errors, panel, read_experiment
from tests.features.companions import is_kept_running, launched, next_of
from tests.features.page import rig as page_rig
from tests.features.page.test_page_command import opened_page
from tests.host.rig import served_session
from woz_tui.client import connect
from woz_tui.config.reload_changes import compare
from woz_tui.console.link.host_start import RobotProcess
from woz_tui.features.page import answer_page, watch_view
from woz_tui.features.page.control import open_pages
from woz_tui.features.page.doctor import CHECKS
from woz_tui.features.page.kinds import PageClosed, PageFailed, PageOpened
from woz_tui.features.page.section import PAGE, PageSettings, command_line
from woz_tui.protocol.requests import AskEnd, AskReload

ASKED = "questionnaires: [{name: ux, items: [{name: a, question: Q?}]}]\n"


def test_pages_of_a_file(tmp_path: Path) -> None:
    made = read_experiment(tmp_path, panel(HELLO) + "page: {for: [watch]}\n")
    settings = PAGE.of(made)
    assert settings == PageSettings(for_=("watch",))
    assert command_line(settings) == "page --at 127.0.0.1:8080 --for watch"
    assert [*PAGE.summary(made)] == [("page", "`woz page` at 127.0.0.1:8080, not encrypted: watch")]
    text = panel(HELLO) + ASKED + "page: {at: '0.0.0.0:80', plain: true, questionnaire: ux}\n"
    other = read_experiment(tmp_path, text)
    assert PAGE.of(other) is not None
    assert "page" in " ".join(compare(made, other).changes)
    assert not [*PAGE.summary(read_experiment(tmp_path, panel(HELLO)))]


@pytest.mark.parametrize(
    ("section", "told"),
    [
        ("{at: '0.0.0.0:8080'}", "lets other computers in, and nothing is encrypted"),
        ("{at: '8080'}", "'8080' is no address"),
        ("{certificate: experiment.yaml}", "certificate and key belong together"),
        ("{pictures: [eye]}", "there is no driver 'eye'"),
        ("{for: []}", "for"),
        ("{for: [play]}", "play"),
        ("{questionnaire: xu}", "there is no questionnaire 'xu'; questionnaires are: ux"),
    ],
)
def test_what_is_wrong_is_told(tmp_path: Path, section: str, told: str) -> None:
    found = errors(tmp_path, panel(HELLO) + ASKED + f"page: {section}\n")
    assert any(told in each for each in found), found


async def test_the_session_is_told_where_its_pages_are_and_that_they_have_gone(
    tmp_path: Path,
) -> None:
    async with served_session(tmp_path) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        async with opened_page(host) as said:
            opened = await wizard.kind("page.opened")
            assert (opened["roles"], said[0].split()[-1].startswith(opened["address"])) == (
                ["watch", "answer"],
                True,
            )
            assert f"{opened['address']}/ with the code {opened['class_code']}" in said[1]
            found = (await wizard.ask("preflight"))["data"]
            [finding] = [each for each in found if each["subject"] == "page"]
            assert opened["class_code"] in finding["text"]
            assert opened["class_code"] in " ".join(each.text for each in CHECKS.examine())
        gone = await wizard.kind("page.closed")
        assert gone["address"] == opened["address"]
        assert not [each for each in CHECKS.examine() if host.path.stem in each.subject]


async def test_only_a_program_tells_of_pages(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        watcher = await host.connect()
        await watcher.hello("watcher")
        told = {"kind": "page.opened", "address": "http://evil.example"}
        assert not (await watcher.ask("page.tell", told=told))["ok"]
        assert not host.of(PageOpened)


async def test_what_fails_is_told_and_the_pages_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    told: list[str] = []
    async with served_session(tmp_path) as host, page_rig.pages(host, told=said) as rig:
        rig.server.failures.tell_session = told.append
        watcher, participant = await rig.watcher(), await rig.participant()
        async with watcher.news("/watch/news") as reader:
            await reader.until(lambda view: view["title"] == "Made by hand")
            with monkeypatch.context() as broken:
                broken.setattr(watch_view, "EVENTS", None)
                broken.setattr(answer_page, "_AGAIN_S", "soon")
                await reader.until(lambda view: "stands still" in view["lost"])
                status, page = await participant.get("/answer")
                assert (status, "This went wrong" in page) == (500, True)
            await reader.until(lambda view: view["lost"] == "")
        assert (await participant.get("/answer"))[0] == 200
    assert [line.partition(" (")[0] for line in said] == [
        "woz page: the page for those who watch has failed",
        "woz page: the page answer has failed",
    ]
    assert [line.rpartition(" (")[2] for line in told] == ["TypeError)", "ValueError)"]


@pytest.fixture
def host(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RobotProcess:
    """The session of a file with pages."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return launched(tmp_path, "page: {at: '127.0.0.1:0'}")


@pytest.mark.real_clock
async def test_pages_run_with_the_session_and_end_with_it(host: RobotProcess) -> None:
    await is_kept_running(host, "page", PageOpened, PageClosed)
    assert open_pages() == [], "nothing is left of them"


@pytest.mark.real_clock
async def test_a_file_that_is_read_again_begins_pages_anew(
    host: RobotProcess, tmp_path: Path
) -> None:
    file = tmp_path / "study.yaml"
    async with connect(host.socket) as woz:
        messages = woz.messages(PageOpened, PageClosed, held=True)
        assert (await next_of(messages, PageOpened)).roles == ["watch", "answer"]
        file.write_text(file.read_text().replace("page: {", "page: {for: [answer], "))
        await woz.request(AskReload())
        await next_of(messages, PageClosed)
        again = await next_of(messages, PageOpened)
        assert (again.roles, again.class_code) == (["answer"], "")
        await woz.request(AskEnd())


@pytest.mark.real_clock
async def test_a_failure_reaches_the_log(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        program = await host.connect()
        await program.hello()
        told = {"kind": "page.failed", "why": "the page answer has failed (KeyError)"}
        assert (await program.ask("page.tell", told=told))["ok"]
        assert [line.why for line in host.of(PageFailed)] == [told["why"]]
        assert not (await program.ask("page.tell", told={**told, "why": "x" * 400}))["ok"]
