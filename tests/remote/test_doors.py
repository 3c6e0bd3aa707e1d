"""Who may do what at each door: the table of docs/how-to/network.md, tried row by row."""

from __future__ import annotations

import asyncio
import contextlib
import re
import ssl
from dataclasses import replace
from pathlib import Path

import aiohttp
import pytest

from tests.network.other_computer import PLACE, Arm, OtherComputer, free_port, remote_driver
from tests.remote.network import Machines, machines
from woz_tui.cli.mcp import SessionTools
from woz_tui.client import WozError
from woz_tui.drivers.contract import Health
from woz_tui.host.request_handlers import WATCHER_MAY
from woz_tui.network.certificates import SERVER_NAME, AccessFile, Authority
from woz_tui.network.driver_line import DriverRouter, LineError
from woz_tui.remote.remote_session import RemoteSession
from woz_tui.system import session_sockets
from woz_tui.system.clock import RealClock
from woz_tui.testing import PlainJob, RecordingContext, until

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "how-to" / "network.md"
#: How long somebody may wait for an answer that does not come, in seconds.
NOTHING_S = 1.0


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
            given = two.access(PLACE, "wizard")
            two.authority.revoke(PLACE)
            return given
        case "with a watcher's":
            return two.access("eve", "watcher")
        case "with a program's":
            return two.access("stimulus", "program")
        case "with a served computer's":
            return two.access(PLACE, None)
    raise AssertionError(who)


# -- doors -----------------------------------------------------------------------------------------


async def web_socket(two: Machines, given: AccessFile | None, patience: float) -> str:
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
                for request in [*plays, {"kind": "stop", "ref": 3}]:
                    await socket.send_json(request)
                found: dict[int, bool] = {}
                while len(found) < 2:
                    for line in (await socket.receive_str()).splitlines():
                        if '"kind":"reply"' in line:
                            found[int(line.split('"ref":')[1].split(",")[0])] = '"ok":true' in line
                await socket.close()
                assert found == {2: may == "plays", 3: True}
                return may
    return "refused"


async def served_drivers(two: Machines, given: AccessFile | None, patience: float) -> str:
    """As a computer that calls itself by the name of the one with the drivers."""
    if not any(each.name == PLACE for each in two.authority.names()):
        two.access(PLACE, None)
    port = await free_port()
    context = RecordingContext()
    router = DriverRouter(f"127.0.0.1:{port}", [PLACE], two.authority, 3.0)
    remote = remote_driver(context, router)
    other = OtherComputer(Arm, Arm.Settings(), two.folder)
    await remote.open()
    try:
        if given is None:
            await until(lambda: router._line is not None)
            return await _handshake(port, two.access("x", None).authority)
        await until(lambda: router._line is not None or context.healths[-1][0] is Health.FAULTED)
        async with asyncio.timeout(patience * 3):
            await other.start(f"127.0.0.1:{port}", replace(given, name=PLACE))
            await until(lambda: context.healths[-1][0] is Health.CONNECTED, patience)
        assert await remote.perform(PlainJob("wave")) == {"waved": 1}
        return "its own drivers"
    except LineError:
        return "refused"
    except TimeoutError:
        connected = context.healths[-1][0] is Health.CONNECTED
        return "refused" if router._line is None else "hears nothing" if not connected else "?"
    finally:
        await remote.close()
        await other.end()


async def _handshake(port: int, authority: str) -> str:
    context = ssl.create_default_context(cadata=authority)
    with contextlib.suppress(OSError):
        reader, writer = await asyncio.open_connection(
            "127.0.0.1", port, ssl=context, server_hostname=SERVER_NAME
        )
        writer.write(b"hello")
        assert await reader.read() == b""
    return "refused"


async def assistant(two: Machines, given: AccessFile | None, patience: float) -> str:
    """`woz mcp --access`."""
    if given is None:
        return "refused"  # there is no file to name
    remote = RemoteSession(given, two.address, two.clock)
    running, usable = asyncio.create_task(remote.run()), asyncio.create_task(remote.usable())
    try:
        await asyncio.wait(
            [running, usable], return_when=asyncio.FIRST_COMPLETED, timeout=3 * patience
        )
        if not usable.done():
            return "refused"
        tools = SessionTools(str(usable.result()))
        try:
            assert (await (await tools.caller()).call("say", {"text": "Hi"}))["done"]
        except WozError:
            return "refused"
        finally:
            await tools.close()
        return "plays"
    finally:
        running.cancel()
        usable.cancel()
        await asyncio.gather(running, usable, return_exceptions=True)


DOORS = (web_socket, served_drivers, assistant)


@pytest.mark.parametrize("row", table(), ids=lambda row: row[0])
async def test_who_may_do_what_at_each_door(tmp_path: Path, row: list[str]) -> None:
    who, *cells = row
    for door, expected in zip(DOORS, cells, strict=True):
        folder = tmp_path / door.__name__
        folder.mkdir()
        async with machines(folder, RealClock()) as two:
            patience = NOTHING_S if expected in ("refused", "hears nothing") else 20.0
            found = await door(two, access(two, who), patience)
            assert found == expected, (who, door.__name__)
            if expected != "plays":
                assert {verb for verb, _ in two.robot.puppet().calls} <= {"stop"}


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
