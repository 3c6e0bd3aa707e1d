"""Who is not let in: other origins, other ports, guessed codes, foreign names, frames."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import aiohttp
import pytest

from tests.features.page.rig import PageRig, pages
from tests.host.rig import served_session
from woz_tui.features.page.same_page import is_own_host, is_own_stream
from woz_tui.features.page.visitors import (
    WRONG_A_MINUTE,
    WRONG_IN_ALL,
    PageRole,
    TooOftenError,
    Visitors,
)
from woz_tui.protocol import messages as m
from woz_tui.system.clock import ManualClock

pytestmark = pytest.mark.safety


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[PageRig]:
    async with served_session(tmp_path) as host, pages(host, names=("robot.lab",)) as opened:
        yield opened


async def test_without_a_code_nothing_is_told(rig: PageRig) -> None:
    stranger = await rig.stranger()
    for path in ("/watch", "/watch/news", "/answer", "/answer/news"):
        status, said = await stranger.get(path, **{"Sec-Fetch-Site": "same-origin"})
        assert status == 403
        assert "Made by hand" not in said
    status, _ = await stranger.post("/answer", what="done")
    assert status == 403


async def test_a_code_is_good_for_its_page_alone(rig: PageRig) -> None:
    watcher, participant = await rig.watcher(), await rig.participant()
    assert (await watcher.get("/watch"))[0] == (await participant.get("/answer"))[0] == 200
    assert (await watcher.get("/answer"))[0] == (await participant.get("/watch"))[0] == 403
    assert (await watcher.post("/answer", what="done"))[0] == 403


async def test_a_guessed_address_does_not_exist(rig: PageRig) -> None:
    stranger = await rig.stranger()
    for guess in ("0" * 24, "é", rig.server.visitors.class_code):
        assert (await stranger.get(f"/join/{guess}"))[0] == 404
    assert all(len(code) == 24 for code in rig.server.visitors.codes.values())


@pytest.mark.parametrize(
    "origin", [None, "null", "http://evil.example", "http://127.0.0.1:1", "https://127.0.0.1"]
)
async def test_a_form_from_elsewhere_is_refused_whoever_sends_it(
    rig: PageRig, origin: str | None
) -> None:
    """Also from another port of this computer, whose pages send the cookie along."""
    participant = await rig.participant()
    assert (await participant.post("/answer", origin, what="done"))[0] == 403
    code = rig.server.visitors.class_code
    assert (await participant.post("/code", origin, code=code))[0] == 403
    assert (await participant.post("/code", code=code))[0] == 200


@pytest.mark.parametrize("site", ["same-site", "cross-site", "none"])
async def test_a_stream_that_another_page_opens_is_refused(rig: PageRig, site: str) -> None:
    watcher = await rig.watcher()
    assert (await watcher.get("/watch/news", **{"Sec-Fetch-Site": site}))[0] == 403
    async with watcher.news("/watch/news") as reader:
        assert (await reader.until(lambda view: view["title"]))["title"] == "Made by hand"


def test_browsers_that_do_not_say_so_are_told_by_the_page_they_come_from() -> None:
    own = "http://127.0.0.1:8080"
    assert is_own_stream({"Referer": f"{own}/watch?big"}, own)
    for referer in ("", "http://127.0.0.1:8081/watch", "http://127.0.0.1:80800/", "null"):
        assert not is_own_stream({"Referer": referer}, own)


async def test_only_names_of_this_computer_are_answered(rig: PageRig) -> None:
    """Else somebody's own domain, pointed here, would be an origin of its own to the browser."""
    watcher = await rig.watcher()
    for host in ("evil.example", f"evil.example:{rig.port}", "127.0.0.2", "[", "127.0.0.1.evil"):
        assert (await watcher.get("/watch", Host=host))[0] == 421
    for host in ("robot.lab", f"ROBOT.lab:{rig.port}", "127.0.0.1:9999"):
        assert (await watcher.get("/", Host=host))[0] == 200


@pytest.mark.parametrize(
    ("host", "here", "own"),
    [
        ("192.168.4.1:8080", "192.168.4.1", True),
        ("192.168.4.1", "::ffff:192.168.4.1", True),
        ("[fd00::1]:8080", "fd00::1", True),
        ("192.168.4.2", "192.168.4.1", False),
        ("robot", "192.168.4.1", False),
        ("", "192.168.4.1", False),
    ],
)
def test_an_address_is_ours_where_the_request_came_in_by_it(
    host: str, here: str, own: bool
) -> None:
    assert is_own_host(host, here, ()) is own


async def test_every_answer_forbids_frames_scripts_and_copies(rig: PageRig) -> None:
    watcher = await rig.watcher()
    for path in ("/", "/watch", "/page.css", "/watch.js", "/nothing", "/answer", "/join/1"):
        async with watcher.http.get(rig.here + path) as response:
            headers = response.headers
            policy = headers["Content-Security-Policy"]
            assert policy.startswith("default-src 'self';")
            assert "frame-ancestors 'none'" in policy
            assert headers["X-Content-Type-Options"] == "nosniff"
            assert headers["Cache-Control"] == "no-store"
            assert headers["Referrer-Policy"] == "same-origin"  # no-referrer: `Origin: null`
            assert "<style" not in (text := await response.text())
            assert " style=" not in text
            assert " onload=" not in text


async def test_a_cookie_is_out_of_reach_of_scripts_and_other_sites(rig: PageRig) -> None:
    stranger = await rig.stranger()
    code = rig.server.visitors.codes[PageRole.WATCH]
    async with stranger.http.get(f"{rig.here}/join/{code}") as response:
        cookie = response.cookies[f"woz-page-{rig.port}"]
        assert (cookie["httponly"], cookie["samesite"], cookie["path"]) == (True, "Strict", "/")
        assert code not in cookie.value
        # No redirection: from a link elsewhere that would come without the cookie.
        assert (response.status, response.history) == (200, ())


async def test_nothing_plays_and_nothing_stops(rig: PageRig, tmp_path: Path) -> None:
    watcher = await rig.watcher()
    for path in ("/watch", "/stop", "/action", "/session", "/watch/news"):
        assert (await watcher.post(path, kind="stop", action="Hello"))[0] in (404, 405)
    async with aiohttp.ClientSession(cookie_jar=watcher.http.cookie_jar) as http:
        with pytest.raises(aiohttp.WSServerHandshakeError):
            await http.ws_connect(f"{rig.here}/session")


async def test_a_class_types_a_code_and_few_wrong_ones(rig: PageRig) -> None:
    pupil, guesser = await rig.stranger(), await rig.stranger()
    code = rig.server.visitors.class_code
    assert (await pupil.post("/code", code=f" {code[:3]} {code[3:]} "))[0] == 200
    assert (await pupil.get("/watch"))[0] == 200
    wrong = "".join(str((int(digit) + 1) % 10) for digit in code)
    for _ in range(WRONG_A_MINUTE):
        assert (await guesser.post("/code", code=wrong))[0] == 403
    assert (await guesser.post("/code", code=code))[0] == 429
    assert (await guesser.get("/watch"))[0] == 403


def test_after_twenty_wrong_codes_there_is_a_new_one() -> None:
    clock, told = ManualClock(), list[str]()
    visitors = Visitors(told.append, clock)
    before = visitors.class_code
    for number in range(WRONG_IN_ALL):
        assert visitors.by_class_code("no", f"192.168.4.{number}") is None
    assert told == [visitors.class_code]
    assert visitors.class_code != before
    assert visitors.by_class_code(before, "192.168.4.99") is None


def test_a_minute_later_an_address_may_try_again() -> None:
    clock = ManualClock()
    visitors = Visitors(lambda code: None, clock)
    for _ in range(WRONG_A_MINUTE):
        visitors.by_class_code("no", "192.168.4.7")
    with pytest.raises(TooOftenError):
        visitors.by_class_code(visitors.class_code, "192.168.4.7")
    assert visitors.by_class_code(visitors.class_code, "192.168.4.8") is not None
    clock.advance(61)
    assert visitors.by_class_code(visitors.class_code, "192.168.4.7") is not None


async def test_who_watches_does_not_read_the_code_of_who_answers(tmp_path: Path) -> None:
    """It goes to the robot's tablet in a command, which is an event."""
    async with served_session(tmp_path) as host, pages(host) as rig:
        watcher = await rig.watcher()
        code = rig.server.visitors.codes[PageRole.ANSWER]
        async with watcher.news("/watch/news") as reader:
            host.session.hub.publish(m.Marker(source="program", text=f"join/{code} it"))
            view = await reader.until(lambda view: "join/" in str(view["events"]))
            assert code not in str(view)
        _, page = await watcher.get("/watch")
        assert "join/… it" in page
        assert code not in page


async def test_a_class_that_guesses_does_not_reach_the_log(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host, pages(host) as rig:
        stranger = await rig.stranger()
        for _ in range(3):
            await stranger.post("/code", code="1")
            await stranger.get("/join/1")
        assert [line.name for line in host.lines if isinstance(line, m.ConsoleAttached)] == ["page"]
