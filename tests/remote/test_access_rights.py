"""Who may do what at each door: the table of docs/how-to/network.md, tried row by row."""

from __future__ import annotations

import asyncio
import re
import ssl
from dataclasses import replace
from pathlib import Path

import aiohttp
import pytest

from tests.fakes.ports import free_port
from tests.network.other_computer import (
    PLACE,
    Arm,
    OtherComputer,
    listens,
    remote_driver,
)
from tests.remote.network import Machines, machines
from woz_tui.cli.mcp import SessionTools
from woz_tui.client import WozRefusedError
from woz_tui.drivers.contract import Health
from woz_tui.gate.table import WATCHER_MAY
from woz_tui.network import remote_driver as remote_side
from woz_tui.network import zenoh_line
from woz_tui.network.certificates import SERVER_NAME, AccessError, AccessFile, Authority
from woz_tui.network.driver_line import LineError
from woz_tui.network.driver_router import DriverRouter
from woz_tui.remote.remote_session import RemoteSession, RemoteSessionError
from woz_tui.system import session_sockets
from woz_tui.system.clock import RealClock
from woz_tui.testing import PlainJob, RecordingContext, until

pytestmark = pytest.mark.safety

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "how-to" / "network.md"
CERTIFICATE = "-----BEGIN CERTIFICATE-----"


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whose connection takes long on a busy machine is not refused."""
    monkeypatch.setattr(zenoh_line, "CONNECT_S", 20.0)
    monkeypatch.setattr(remote_side, "LATE_S", 10.0)


def table() -> list[list[str]]:
    """Rows of the page: who, then what each door gives."""
    lines = (
        PAGE.read_text(encoding="utf-8").split("## Who may do what at each door")[1].splitlines()
    )
    rows = [line for line in lines if line.startswith("|")][2:]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def access(two: Machines, who: str) -> AccessFile | None:
    """What this somebody has."""
    match who:
        case "without a certificate":
            return None
        case "with one of another robot":
            mine = two.access(PLACE, "wizard")
            other = Authority(two.folder / "other")
            other.new(PLACE, 30, "", two.folder / "other.access")
            return replace(mine, path=two.folder / "other.access")
        case "with one that was revoked":
            access_file = two.access(PLACE, "wizard")
            two.authority.revoke(PLACE)
            return access_file
        case "with a watcher's":
            return two.access("eve", "watcher")
        case "with a program's":
            return two.access("stimulus", "program")
        case "with a served computer's":
            return two.access(PLACE, None)
    raise AssertionError(who)


# -- doors -----------------------------------------------------------------------------------------


async def web_socket(two: Machines, given: AccessFile | None) -> str:
    """As a program of its own that speaks WebSocket."""
    if given is None:
        context = ssl.create_default_context(cadata=two.access("x", "wizard").authority)
    else:
        context = given.context()
    async with aiohttp.ClientSession() as client:
        for role, may in (("program", "plays"), ("watcher", "watches, stops")):
            try:
                socket = await client.ws_connect(
                    f"wss://{two.address}/session", ssl=context, server_hostname=SERVER_NAME
                )
                await socket.send_json({"kind": "hello", "ref": 1, "role": role})
                answer = (await socket.receive_str()).partition("\n")[0]
            except (aiohttp.ClientError, TypeError):
                return "refused"
            if '"kind":"welcome"' in answer:
                plays = [{"kind": "verb", "ref": 2, "verb": "say", "args": {"text": "Hi"}}]
                found: dict[int, bool] = {}
                for request in [*plays, {"kind": "stop", "ref": 3}]:  # a stop goes before others
                    await socket.send_json(request)
                    while request["ref"] not in found:
                        for line in (await socket.receive_str()).splitlines():
                            if '"kind":"reply"' in line:
                                ref = int(line.split('"ref":')[1].split(",")[0])
                                found[ref] = '"ok":true' in line
                await socket.close()
                assert found == {2: may == "plays", 3: True}
                return may
    return "refused"


async def served_drivers(two: Machines, given: AccessFile | None) -> str:
    """As a computer that calls itself as the one with the drivers, which comes after it."""
    named = any(each.name == PLACE for each in two.authority.names())
    own = None if named else two.access(PLACE, None)
    port = free_port()
    context = RecordingContext()
    router = DriverRouter(f"127.0.0.1:{port}", [PLACE], two.authority, 3.0)
    remote = remote_driver(context, router)
    other, rightful = (OtherComputer(Arm, Arm.Settings(), two.folder) for _ in range(2))
    await remote.open()
    try:
        await until(lambda: router._line is not None or context.healths[-1][0] is Health.FAULTED)
        if router._line is None:
            assert not listens(port)
            return "refused"
        if given is None:
            await _handshake(port, two.access("x", None).authority)
            return "refused"
        await other.start(f"127.0.0.1:{port}", replace(given, name=PLACE))
        if own is not None:
            await rightful.start(f"127.0.0.1:{port}", own)
        await until(lambda: context.healths[-1][0] is Health.CONNECTED)
        assert await remote.perform(PlainJob("wave")) == {"waved": 1}
        assert not context.notices
        return "its own drivers" if other.lines else "hears nothing"
    except LineError:
        return "refused"
    finally:
        await remote.close()
        await other.end()
        await rightful.end()


async def _handshake(port: int, authority: str) -> None:
    """Come without a certificate: the other side asks for one, whatever comes after that."""
    context = ssl.create_default_context(cadata=authority)
    with pytest.raises(ssl.SSLError, match=r"(?i)certificate required"):
        reader, _ = await asyncio.open_connection(
            "127.0.0.1", port, ssl=context, server_hostname=SERVER_NAME
        )
        await reader.read()


async def assistant(two: Machines, given: AccessFile | None) -> str:
    """`woz mcp --access`."""
    if given is None:
        file = two.access("x", "wizard").path
        before, _, after = file.read_text(encoding="utf-8").partition(CERTIFICATE)
        file.write_text(before + after[after.index(CERTIFICATE) :], encoding="utf-8")
        with pytest.raises(AccessError):
            RemoteSession(AccessFile.read(file), two.address, two.clock)
        return "refused"
    remote = RemoteSession(given, two.address, two.clock)
    refused, usable = asyncio.create_task(_refused(remote)), asyncio.create_task(remote.usable())
    try:
        await asyncio.wait([refused, usable], return_when=asyncio.FIRST_COMPLETED)
        if not usable.done():
            return "refused"
        tools = SessionTools(str(usable.result()))
        try:
            assert (await (await tools.caller()).call("say", {"text": "Hi"}))["done"]
        except WozRefusedError:
            return "refused"
        finally:
            await tools.close()
        return "plays"
    finally:
        refused.cancel()
        usable.cancel()
        await asyncio.gather(refused, usable, return_exceptions=True)


async def _refused(remote: RemoteSession) -> None:
    """Return when the other side lets nobody in; a busy machine may say nothing before."""
    said = ""
    while not re.search("does not let us in|Server disconnected", said):
        try:
            await remote.connect_once()
        except RemoteSessionError as error:
            said = str(error)


DOORS = (web_socket, served_drivers, assistant)


@pytest.mark.parametrize("row", table(), ids=lambda row: row[0])
async def test_who_may_do_what_at_each_door(tmp_path: Path, row: list[str]) -> None:
    who, *cells = row
    for door, expected in zip(DOORS, cells, strict=True):
        folder = tmp_path / door.__name__
        folder.mkdir()
        async with machines(folder, RealClock()) as two:
            assert await door(two, access(two, who)) == expected, (who, door.__name__)
            if expected != "plays":
                assert {verb for verb, _ in two.robot.driver().calls} <= {"stop"}


async def test_another_user_of_the_robots_computer_is_not_heard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with machines(tmp_path) as two:
        peer = await two.robot.connect()
        assert (await peer.hello("wizard"))["role"] == "wizard"
        monkeypatch.setattr(session_sockets, "peer_uid", lambda connection: 54_321)
        stranger = await two.robot.connect()
        with pytest.raises((EOFError, ConnectionError)):
            await stranger.ask("stop")
        assert not two.robot.session.bus.latched


def test_the_page_of_the_protocol_names_all_that_a_watcher_may_ask() -> None:
    page = (DOCS / "reference" / "protocol.md").read_text(encoding="utf-8")
    named = page.partition("`watcher` looks on: only ")[2].partition(" are open to it")[0]
    kinds = {str(each.__struct_config__.tag) for each in WATCHER_MAY}
    assert {*re.findall("`([a-z-]+)`", named)} == kinds | {"stop", "beat"}
