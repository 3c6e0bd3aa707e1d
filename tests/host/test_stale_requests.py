"""Keys pressed while the robot process stands still are not played when it wakes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.protocol import examples
from tools import ROOT
from woz_tui.gate.table import not_done
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock, boot_id

pytestmark = pytest.mark.safety

S = 1_000_000


class BootClock(RealClock):
    """The process is as awake as the test says."""

    def __init__(self) -> None:
        self.boot = 100 * S

    def boot_us(self) -> int:
        return self.boot


#: Everything that moves something, lets something move, or means another thing when it comes late.
TIMELY: list[tuple[str, dict[str, Any]]] = [
    ("action", {"action": "Hello", "source": "key"}),
    ("verb", {"verb": "play", "args": {"move": "nod"}}),
    ("script", {}),
    ("script", {"play": False, "to": 1}),
    ("release", {}),
    ("lock", {"panel": "Base", "locked": False}),
    ("profile", {}),
    ("phase", {"phase": "closing"}),
    ("mistake", {}),
    ("unrecorded", {}),
    ("end", {}),
]


async def refusal_of(place: ServedSession, peer: Peer, kind: str, fields: dict[str, Any]) -> str:
    """Ask for it; the reason. Nothing has reached the driver, and the log says why."""
    before = len(place.lines)
    reply = await peer.ask(kind, **fields)
    assert not reply["ok"], (kind, reply)
    assert {verb for verb, _ in place.driver().calls} <= {"stop"}
    logged = [
        line
        for line in place.lines[before:]
        if isinstance(line, m.ActionRefused | m.Refused | m.Notice)
    ]
    told = [line.text if isinstance(line, m.Notice) else line.reason for line in logged]
    assert len(told) == 1, (kind, told)
    assert "too late" in told[0]
    return str(reply["reason"])


@pytest.mark.parametrize(("kind", "fields"), TIMELY)
@pytest.mark.parametrize("stamped", [True, False])
async def test_what_waited_in_the_socket_too_long_is_refused_and_logged(
    tmp_path: Path, kind: str, fields: dict[str, Any], stamped: bool
) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        await peer.hello()
        place.session.lock("Base", True)
        place.session.stop("test")
        stamp = {"sent_us": clock.boot} if stamped else {}
        clock.boot += 5 * S
        assert "5.0 s ago" in await refusal_of(place, peer, kind, {**fields, **stamp})
        assert place.session.bus.latched
        assert place.session.locked["Base"]
        assert not place.session.ended


def test_the_page_of_the_protocol_names_all_of_it() -> None:
    page = (ROOT / "docs" / "reference" / "protocol.md").read_text(encoding="utf-8")
    named = page.partition("### Too old")[2].partition("The stop counts")[0]
    undone = {
        str(request.__struct_config__.tag) for request in examples.REQUESTS if not_done(request)
    }
    kinds = {kind for kind, _ in TIMELY}
    assert undone < kinds
    assert {*re.findall("`([a-z-]+)`", named)} - {"stale", "run"} == kinds


@pytest.mark.parametrize("stamped", [True, False])
async def test_the_stop_and_what_takes_away_or_records_count_however_old(
    tmp_path: Path, stamped: bool
) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        await peer.hello()
        stamp = {"sent_us": clock.boot} if stamped else {}
        clock.boot += 60 * S
        assert (await peer.ask("stop", **stamp))["ok"]
        assert place.session.bus.latched
        assert (await peer.ask("lock", panel="Base", locked=True, **stamp))["ok"]
        assert (await peer.ask("note", text="odd", **stamp))["ok"]
        assert (await peer.ask("marker", text="odd", **stamp))["ok"]


@pytest.mark.parametrize(
    ("source", "sent_s", "counts"),
    [
        ("a key 4 s ago", 0, True),
        ("nobody said when", None, False),
        ("after it came", 3600, False),
        ("an hour ago", -3600, False),
    ],
)
async def test_a_stop_is_confirmed_so_long_after_its_key(
    tmp_path: Path, source: str, sent_s: int | None, counts: bool
) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        await peer.hello()
        fields = {} if sent_s is None else {"sent_us": clock.boot + sent_s * S}
        clock.boot += 4 * S
        await peer.say(kind="stop", source=source, **fields)
        pressed = await peer.kind("stop.pressed")
        confirmed = await peer.kind("stop.confirmed")
        assert ("pressed" in pressed) == counts
        assert (confirmed["elapsed_us"] >= 4 * S) == counts


async def test_a_fresh_stamp_counts_right_after_the_process_woke(tmp_path: Path) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        welcome = await peer.hello()
        assert welcome["boot_id"] == boot_id()
        clock.boot += 5 * S
        fresh = {"sent_us": clock.boot - S // 10}
        assert not (await peer.ask("action", action="Hello"))["ok"]
        assert (await peer.ask("action", action="Hello", **fresh))["ok"]


async def test_age_at_the_sender_and_on_the_way_are_added(tmp_path: Path) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        await peer.hello()
        sent = {"action": "Hello", "sent_us": clock.boot, "age_us": S}
        clock.boot += S
        assert "2.0 s ago" in (await peer.ask("action", **sent))["reason"]
        young = {**sent, "age_us": -60 * S}  # nobody makes it younger than its way
        clock.boot += S
        assert "2.0 s ago" in (await peer.ask("action", **young))["reason"]


async def test_a_client_that_comes_while_the_process_stands_still_is_no_exception(
    tmp_path: Path,
) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        clock.boot += 5 * S
        await peer.hello()
        assert "5.0 s ago" in await refusal_of(place, peer, "action", {"action": "Hello"})


@pytest.mark.parametrize("stamp", [10**18, -5])
async def test_a_stamp_that_makes_no_sense_is_none(tmp_path: Path, stamp: int) -> None:
    clock = BootClock()
    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        await peer.hello()
        assert (await peer.ask("action", action="Hello", sent_us=stamp))["ok"]
        clock.boot += 5 * S
        reply = await peer.ask("action", action="Hello", sent_us=stamp)
        assert "5.0 s ago" in reply["reason"]


async def test_what_waits_here_behind_other_requests_grows_older(tmp_path: Path) -> None:
    clock = BootClock()

    def takes_long(message: m.Message) -> None:
        if isinstance(message, m.Marker):
            clock.boot += S

    async with served_session(tmp_path, clock=clock) as place:
        peer = await place.connect()
        await peer.hello()
        place.session.hub.listen(takes_long)
        clock.boot += 5 * S
        peer.writer.write(
            b'{"kind":"marker","ref":1,"text":"in front"}\n'
            b'{"kind":"action","ref":2,"action":"Hello","source":"key"}\n'
        )
        reply = await peer.until(lambda line: line.get("ref") == 2)
        assert "6.0 s ago" in reply["reason"]


@pytest.mark.parametrize(
    ("age_us", "said"),
    [(2_200_000, "may have been pressed 2.2 s ago"), (20_000, "more keys at once than anybody")],
)
async def test_what_a_console_calls_stale_is_told_by_its_age_and_blames_no_connection(
    tmp_path: Path, age_us: int, said: str
) -> None:
    async with served_session(tmp_path, clock=BootClock()) as place:
        peer = await place.connect()
        await peer.hello()
        fields = {"action": "Hello", "source": "key", "stale": True, "age_us": age_us}
        reason = await refusal_of(place, peer, "action", fields)
        assert said in reason
        assert "connection" not in reason
