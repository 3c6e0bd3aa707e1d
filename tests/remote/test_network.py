"""A session that is joined from another machine."""

from __future__ import annotations

import asyncio
import json
import os
import random
import ssl
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import aiohttp
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.host.rig import Peer
from tests.remote.network import BootClock, Machines, S, connected_peer, machines
from tests.session.rig import WAIT_S
from woz_tui.cli.remote_start import remote_session
from woz_tui.config.experiment import AccessRole
from woz_tui.console.link.message_feed import Loss, LostPart
from woz_tui.host.remote_access import RemoteAccess
from woz_tui.network.certificates import SERVER_NAME, AccessError, AccessFile, Authority
from woz_tui.network.clock_offset import ClockOffset
from woz_tui.network.listen_address import ListenAddress
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskStop, Beat, Hello, Reply
from woz_tui.remote.access_server import BURST, LOCAL, MAY_BE, AccessServer, RequestFilter
from woz_tui.remote.remote_session import RemoteSession, RemoteSessionError
from woz_tui.system.clock import ManualClock, Standstill
from woz_tui.testing import until

# -- who joins ---------------------------------------------------------------------------------


async def test_a_wizard_on_another_machine_plays_and_the_log_has_the_name(tmp_path: Path) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("anna", "wizard")) as remote:
        peer = await connected_peer(remote)
        welcome = await peer.hello("wizard")
        assert welcome["role"] == "wizard"
        assert welcome["robot_at"] == two.address
        assert (await peer.ask("action", action="Hello", source="key"))["ok"]
        await peer.kind("action.done")
        assert "say" in {verb for verb, _ in two.robot.driver().calls}
        [joined] = [line for line in two.robot.lines if isinstance(line, m.ConsoleAttached)]
        assert (joined.role, joined.via) == ("wizard", "anna")


@pytest.mark.parametrize(
    ("role", "hello", "ok"),
    [
        ("wizard", "wizard", True),
        ("wizard", "watcher", True),
        ("wizard", "program", False),
        ("program", "program", True),
        ("program", "wizard", False),
        ("watcher", "watcher", True),
        ("watcher", "wizard", False),
        ("watcher", "program", False),
        ("participant", "participant", True),
        ("participant", "watcher", False),
    ],
)
async def test_nobody_is_more_than_the_experiment_says(
    tmp_path: Path, role: AccessRole, hello: str, ok: bool
) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("anna", role)) as remote:
        peer = await connected_peer(remote)
        await peer.say(kind="hello", ref=1, role=hello)
        answer = await peer.until(lambda line: line["kind"] in ("welcome", "reply"))
        assert (answer["kind"] == "welcome") is ok
        if not ok:
            assert "anna may be" in answer["reason"]
            assert "woz attach" in answer["hint"]


async def test_a_watcher_can_stop_and_nothing_else(tmp_path: Path) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("bob", "watcher")) as remote:
        peer = await connected_peer(remote)
        await peer.hello("watcher")
        for kind, fields in (
            ("action", {"action": "Hello"}),
            ("verb", {"verb": "say", "args": {"text": "boo"}}),
            ("take-over", {}),
            ("release", {}),
            ("end", {}),
        ):
            assert not (await peer.ask(kind, **fields))["ok"], kind
        assert not two.robot.driver().calls
        assert (await peer.ask("stop"))["ok"]
        assert two.robot.session.bus.latched


async def test_a_stop_needs_no_hello(tmp_path: Path) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("anna", "wizard")) as remote:
        assert (await (await connected_peer(remote)).ask("stop"))["ok"]
        assert two.robot.session.bus.latched


def _no_certificate(two: Machines) -> AccessFile:
    """Somebody who knows the authority, but was given nothing."""
    access = two.access("stranger", "wizard")
    other = Authority(two.folder / "other")
    other.new("stranger", 30, "", two.folder / "other.access")
    return replace(access, path=two.folder / "other.access")


def _revoked(two: Machines) -> AccessFile:
    access = two.access("eve", "wizard")
    assert two.authority.revoke("eve") == 1
    return access


def _not_listed(two: Machines) -> AccessFile:
    """The list was removed, as a damaged one has to be, and others have been let in since."""
    access = two.access("kim", "wizard")
    (two.authority.place / "names.json").unlink()
    two.access("anna", "wizard")
    return access


STRANGERS: Mapping[str, tuple[Callable[[Machines], AccessFile], str]] = {
    "no role": (lambda two: two.access("carl", None), "carl has no role"),
    "revoked": (_revoked, "the certificate of eve was revoked"),
    "not listed": (_not_listed, "the robot does not know this certificate of kim"),
    "expired": (lambda two: two.access("old", "wizard", days=-1), ""),
    "of another authority": (_no_certificate, ""),
}


@pytest.mark.parametrize("who", STRANGERS)
async def test_a_stranger_gets_nowhere(tmp_path: Path, who: str) -> None:
    make, why = STRANGERS[who]
    async with machines(tmp_path) as two:
        reason = await two.refusal(make(two))
        assert reason
        assert why in reason
        assert not any(isinstance(line, m.ConsoleAttached) for line in two.robot.lines)


async def test_without_a_certificate_nothing_is_answered_but_why(tmp_path: Path) -> None:
    async with machines(tmp_path) as two:
        context = ssl.create_default_context(cadata=two.access("anna", "wizard").authority)
        async with aiohttp.ClientSession() as client:
            for path in ("/session", "/clock", "/", "/../names.json"):
                async with client.get(
                    f"https://{two.address}{path}", ssl=context, server_hostname=SERVER_NAME
                ) as answer:
                    assert answer.status in (403, 404)
                    assert "BEGIN" not in await answer.text()


async def test_another_computer_is_not_taken_for_the_robot(tmp_path: Path) -> None:
    async with machines(tmp_path) as two:
        access = two.access("anna", "wizard")
        impostor = Authority(tmp_path / "impostor")
        impostor.new("x", 30, "", tmp_path / "x.access")
        other = AccessServer(two.robot.path, impostor, two.clock)
        port = (await other.listen(ListenAddress("127.0.0.1", 0))).rpartition(":")[2]
        two.cable.port = int(port)
        try:
            assert "not the robot" in await two.refusal(access)
        finally:
            await other.close()


async def test_who_is_revoked_is_cut_off(tmp_path: Path) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("anna", "wizard")) as remote:
        peer = await connected_peer(remote)
        await peer.hello("wizard")
        two.authority.revoke("anna")
        with pytest.raises((EOFError, ConnectionError)):
            await peer.until(lambda line: False)
        await two.robot.published(lambda line: isinstance(line, m.ConsoleLost))


async def test_a_new_file_of_the_same_name_keeps_nobody_in_with_the_old_one(
    tmp_path: Path,
) -> None:
    async with machines(tmp_path) as two:
        remote = RemoteSession(two.access("anna", "wizard"), two.address, two.clock)
        running = asyncio.create_task(remote.run())
        await remote.usable()
        two.authority.revoke("anna")
        two.access("anna", "wizard")
        with pytest.raises(RemoteSessionError, match="revoked"):
            await asyncio.wait_for(running, WAIT_S)


async def test_another_role_in_the_file_ends_what_was_open(tmp_path: Path) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("anna", "wizard")) as remote:
        peer = await connected_peer(remote)
        await peer.hello("wizard")
        two.server.adopt({"anna": "watcher"})
        with pytest.raises((EOFError, ConnectionError)):
            await peer.until(lambda line: False)


# -- the network -------------------------------------------------------------------------------


@pytest.fixture
def _running(monkeypatch: pytest.MonkeyPatch) -> None:
    """The robot process runs, though its clock jumps."""
    monkeypatch.setattr(Standstill, "LEAST_S", 1e9)


async def is_too_late(two: Machines, peer: Peer, *clocks: BootClock) -> None:
    """A press that the network holds back for 5 s is refused, and not played."""
    two.cable.flowing.clear()
    press = {"kind": "action", "ref": 1, "action": "Hello", "source": "key"}
    await peer.say(**press)
    await until(lambda: two.cable.held_there > len(json.dumps(press)))  # a question of time is less
    for clock in clocks:
        clock.boot += 5 * S
    two.cable.flowing.set()
    answer = await peer.until(lambda line: line["kind"] == "reply" and line["ref"] == 1)
    assert not answer["ok"]
    assert "too late" in answer["reason"]
    assert not two.robot.driver().calls


@pytest.mark.usefixtures("_running")
async def test_what_a_frozen_network_held_back_is_not_played(tmp_path: Path) -> None:
    clock = BootClock()
    async with (
        machines(tmp_path, clock) as two,
        two.joined(two.access("anna", "wizard")) as remote,
    ):
        peer = await connected_peer(remote)
        await peer.hello("wizard")
        await is_too_late(two, peer, clock)
        assert (await peer.ask("action", action="Hello", source="key"))["ok"]


@pytest.mark.usefixtures("_running")
async def test_that_holds_when_the_robots_computer_was_started_anew(tmp_path: Path) -> None:
    """Its clock begins at zero then."""
    here = BootClock()
    async with machines(tmp_path) as two:
        assert isinstance(two.clock, BootClock)
        async with two.joined(two.access("anna", "wizard"), here) as remote:
            path = await remote.usable()
            await two.cable.cut()
            await until(lambda: not path.exists(), WAIT_S)
            two.clock.boot -= 50 * S
            await two.cable.lay()
            peer = await connected_peer(remote)
            await peer.hello("wizard")
            await is_too_late(two, peer, here, two.clock)


async def test_a_path_that_the_environment_names_and_a_session_has_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with machines(tmp_path) as two:
        monkeypatch.setenv("WOZ_SOCKET", str(two.robot.path))
        assert "WOZ_SOCKET" in await two.refusal(two.access("anna", "wizard"))


async def test_a_cut_network_is_told_on_both_sides_and_comes_back(tmp_path: Path) -> None:
    async with machines(tmp_path) as two, two.joined(two.access("anna", "wizard")) as remote:
        peer = await connected_peer(remote)
        await peer.hello("wizard")
        path = await remote.usable()
        await two.cable.cut()
        with pytest.raises((EOFError, ConnectionError)):
            await peer.until(lambda line: False)
        await two.robot.published(lambda line: isinstance(line, m.ConsoleLost))
        await until(lambda: not path.exists(), WAIT_S)
        await two.cable.lay()
        assert (await (await connected_peer(remote)).hello("wizard"))["role"] == "wizard"


async def test_a_lost_line_and_an_ended_robot_process_are_told_apart(tmp_path: Path) -> None:
    async with machines(tmp_path) as two:
        access = two.access("anna", "wizard")
        opening = remote_session(access.path, two.address)
        line = await asyncio.to_thread(opening.__enter__)
        assert line is not None

        def lost() -> LostPart:
            return line.explained(Loss("it closed the connection")).part

        try:
            two.cable.flowing.clear()
            await until(lambda: line.reason != "" and lost() is LostPart.LINE, WAIT_S)
            two.cable.flowing.set()
            await until(lambda: line.reason == "", WAIT_S)
            await two.cable.cut()  # nobody listens there any more
            await until(lambda: lost() is LostPart.PROCESS, WAIT_S)
        finally:
            await asyncio.to_thread(opening.__exit__, None, None, None)


@given(
    offset=st.integers(-(10**15), 10**15),
    there=st.integers(0, 10**7),
    back=st.integers(0, 10**7),
    at=st.integers(10**15 + 10**8, 10**16),
)
def test_no_press_is_taken_for_younger_than_it_is(
    offset: int, there: int, back: int, at: int
) -> None:
    measured = ClockOffset.measured(at, at + there + offset, at + there + back)
    pressed = at + 123_456
    assert pressed + offset - (there + back) - 2 <= measured.there(pressed) <= pressed + offset


# -- what is sent ------------------------------------------------------------------------------


@given(line=st.one_of(st.binary(max_size=400), st.builds(lambda text: text.encode(), st.text())))
def test_whatever_is_sent_gets_an_answer_or_is_a_request(line: bytes) -> None:
    passed, answer = RequestFilter("anna", "watcher", ManualClock()).passed(line)
    if answer is None:
        codec.decode_request(passed)
    else:
        assert not answer.ok
        assert answer.reason
        assert not passed


@pytest.mark.hypothesis
@given(seed=st.integers(0, 10**9), role=st.sampled_from(sorted(MAY_BE)))
def test_requests_that_were_damaged_make_nobody_more_than_they_are(seed: int, role: str) -> None:
    chance = random.Random(seed)
    requests = RequestFilter("anna", role, ManualClock())
    for _ in range(30):
        line = bytearray(
            codec.encode(Hello(role=chance.choice(["wizard", "program", "watcher"]), via="boss"))
        )
        for _ in range(chance.randrange(3)):
            line[chance.randrange(len(line))] = chance.randrange(256)
        passed, _ = requests.passed(bytes(line).replace(b"\n", b""))
        if passed:
            request = codec.decode_request(passed)
            if isinstance(request, Hello):
                assert request.role in MAY_BE[role]
                assert request.via == "anna"


def test_who_comes_from_afar_says_hello_before_hearing_which_session_it_is() -> None:
    passed, answer = RequestFilter("anna", "program", ManualClock()).passed(b'{"kind":"about"}')
    assert not passed
    assert answer is not None
    assert "without a hello" in answer.reason


def test_a_flood_is_refused_and_a_stop_in_it_is_not() -> None:
    clock = ManualClock()
    requests = RequestFilter("anna", "wizard", clock)
    line = codec.encode(Hello(role="wizard", ref=7))

    def refused(count: int) -> int:
        return sum(not requests.passed(line)[0] for _ in range(count))

    assert refused(round(BURST)) == 0
    assert refused(50) == 50
    answer = requests.passed(line)[1]
    assert isinstance(answer, Reply)
    assert answer.ref == 7
    for urgent in (AskStop(), Beat()):
        assert requests.passed(codec.encode(urgent))[0]
    clock.advance(1)
    assert refused(50) == 0


# -- addresses and files -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "host", "port", "plain"),
    [
        ("0.0.0.0:8765", "0.0.0.0", 8765, False),
        (":8765", "", 8765, False),
        ("[::1]:1", "::1", 1, False),
        ("ws://127.0.0.1:80", "127.0.0.1", 80, True),
        ("ws://localhost:80", "localhost", 80, True),
    ],
)
def test_addresses(text: str, host: str, port: int, plain: bool) -> None:
    assert ListenAddress.read(text) == ListenAddress(host, port, plain)


@pytest.mark.parametrize("text", ["", "8765", "robot", "robot:x", "robot:70000", "ftp://a:1"])
def test_what_is_no_address_is_told(text: str) -> None:
    with pytest.raises(ValueError, match=r"address|ports"):
        ListenAddress.read(text)


@pytest.mark.parametrize("text", ["ws://0.0.0.0:1", "ws://:1", "ws://robot.local:1"])
def test_without_certificates_only_this_machine_is_let_in(text: str) -> None:
    with pytest.raises(ValueError, match="certificate"):
        ListenAddress.read(text)


async def test_a_program_of_this_machine_joins_without_a_certificate(tmp_path: Path) -> None:
    async with machines(tmp_path) as two:
        server = AccessServer(two.robot.path, two.authority, two.clock)
        address = await server.listen(ListenAddress("127.0.0.1", 0, plain=True))
        try:
            async with aiohttp.ClientSession() as client:
                with pytest.raises(aiohttp.WSServerHandshakeError):
                    await client.ws_connect(f"ws://{address}/session")
                server.adopt({LOCAL: "program"})
                with pytest.raises(aiohttp.WSServerHandshakeError):  # a page in a browser
                    await client.ws_connect(f"ws://{address}/session", origin="http://evil")
                async with client.ws_connect(f"ws://{address}/session") as socket:
                    await socket.send_json(
                        {"kind": "hello", "role": "program", "stream": "nothing"}
                    )
                    first, *_ = (await socket.receive_str()).splitlines()  # perhaps a pulse, too
                    assert json.loads(first)["kind"] == "welcome"
        finally:
            await server.close()


def test_access_files_are_secret_and_damage_is_told(tmp_path: Path) -> None:
    authority = Authority(tmp_path / "authority")
    file = tmp_path / "anna.access"
    authority.new("anna", 30, "robot.local:8765", file)
    secret = [file, *(tmp_path / "authority").iterdir()]
    assert {path.stat().st_mode & 0o777 for path in secret} == {0o600}
    access = AccessFile.read(file)
    assert (access.name, access.address) == ("anna", "robot.local:8765")
    file.write_text(file.read_text().replace("MI", "XX"))
    with pytest.raises(AccessError, match="damaged"):
        AccessFile.read(file).context()
    file.write_text("nothing")
    with pytest.raises(AccessError, match="woz access new"):
        AccessFile.read(file)


@pytest.mark.parametrize("name", ["", "a b", "../x", "x" * 41, "é"])
def test_names_that_cannot_be_used_are_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(AccessError):
        Authority(tmp_path / "a").new(name, 30, "", tmp_path / "x.access")
    assert not (tmp_path / "x.access").exists()


def test_a_list_that_cannot_be_read_lets_nobody_in(tmp_path: Path) -> None:
    authority = Authority(tmp_path / "a")
    serial = authority.new("anna", 30, "", tmp_path / "x.access").serial
    assert authority.name_of(serial) == "anna"
    (tmp_path / "a" / "names.json").write_text("[{")
    with pytest.raises(AccessError, match="names"):
        authority.name_of(serial)


def test_the_list_is_read_once_for_each_change(tmp_path: Path) -> None:
    """Whoever asks again for every connection costs the disk nothing."""
    authority, file = Authority(tmp_path / "a"), tmp_path / "a" / "names.json"
    authority.new("anna", 30, "", tmp_path / "x.access")
    assert [each.name for each in authority.names()] == ["anna"]
    was = file.stat()
    file.write_bytes(b"x" * was.st_size)
    os.utime(file, ns=(was.st_atime_ns, was.st_mtime_ns))
    assert [each.name for each in authority.names()] == ["anna"]
    os.utime(file)
    with pytest.raises(AccessError):
        authority.names()


# -- beside the robot process ------------------------------------------------------------------


async def test_the_process_that_lets_in_is_started_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    async with machines(tmp_path) as two:
        Authority().new("anna", 30, "", tmp_path / "own.access")
        remote = RemoteAccess(two.robot.path, "127.0.0.1:0", two.robot.session.hub.publish)
        remote.start({"anna": "watcher"})
        try:
            await two.robot.published(_told("can join at 127.0.0.1"))
            remote.kill()
            await two.robot.published(_told("started again"))
            two.robot.lines.clear()
            await two.robot.published(_told("can join at 127.0.0.1"))
        finally:
            await remote.close()


async def test_without_an_access_file_the_wizard_is_told_what_to_do_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setattr("woz_tui.host.remote_access._FIRST_PAUSE_S", 0.0)
    start, starts = asyncio.create_subprocess_exec, 0

    async def counted(*words: str, **pipes: Any) -> asyncio.subprocess.Process:
        nonlocal starts
        starts += 1
        return await start(*words, **pipes)

    monkeypatch.setattr(asyncio, "create_subprocess_exec", counted)
    async with machines(tmp_path) as two:
        remote = RemoteAccess(two.robot.path, "127.0.0.1:0", two.robot.session.hub.publish)
        remote.start({})
        try:
            await until(lambda: starts >= 3, WAIT_S)  # two have told their trouble
            assert len([line for line in two.robot.lines if _told("woz access new")(line)]) == 1
            Authority().new("anna", 30, "", tmp_path / "own.access")
            await two.robot.published(_told("can join at 127.0.0.1"))
        finally:
            await remote.close()


def _told(words: str) -> Callable[[m.Message], bool]:
    return lambda line: isinstance(line, m.Notice) and words in line.text
