"""`woz page`: where it listens, what it prints, and that it needs nothing of the robot's."""

from __future__ import annotations

import asyncio
import re
import ssl
import sys
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import aiohttp
import pytest
from cryptography import x509
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

from tests.host.rig import ServedSession, served_session
from tests.session.rig import WAIT_S, ScriptedDriver, experiment
from woz_tui.cli import main
from woz_tui.drivers.contract import Argument, Job, Offer, Verb
from woz_tui.features.page.command import ENDS
from woz_tui.features.page.control import open_pages, order
from woz_tui.features.page.qr import drawn, modules
from woz_tui.features.page.visitors import PageRole
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json


@pytest.mark.parametrize(
    ("options", "needed"),
    [
        (["--at", "0.0.0.0:8080"], "--plain allows that, --certificate encrypts"),
        (["--at", "robot.local:8080"], "--plain allows that"),
        (["--at", "8080"], "'8080' is no address"),
        (["--at", ":1", "--certificate", "a.pem"], "--certificate and --key belong together"),
        (["--certificate", "no.pem", "--key", "no.key"], "no.pem: "),
        (["--debrief", "--access", "a.pem"], "--debrief needs the log"),
        (["nobody"], "no session is running at "),
    ],
)
def test_what_would_be_open_to_everybody_has_to_be_said(
    options: list[str], needed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["page", *options]) == 1
    assert needed in capsys.readouterr().err


@asynccontextmanager
async def opened_page(host: ServedSession, *options: str) -> AsyncIterator[list[str]]:
    """`woz page` on a port of its own; what it says at first."""
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "woz_tui", "page", str(host.path)),
        *("--at", "127.0.0.1:0", *options),
        stdout=asyncio.subprocess.PIPE,
    )
    assert process.stdout is not None
    said: list[str] = []
    try:
        while not said or said[-1] != ENDS:
            line = await asyncio.wait_for(process.stdout.readline(), WAIT_S)
            assert line, said
            said.append(line.decode().rstrip("\n"))
        yield said
    finally:
        process.terminate()
        ended = await asyncio.wait_for(process.wait(), WAIT_S)
    assert ended == 0


class TabletDriver(ScriptedDriver):
    """A robot with a tablet."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        screen = Verb("screen", "", (Argument("file", "text"),), lane="screen")
        return Offer(verbs=(screen,))

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        return dict(job.args)


async def test_the_robots_tablet_shows_the_participants_page(tmp_path: Path) -> None:
    made = experiment(tmp_path)
    drivers = (replace(made.drivers[0], offer=TabletDriver.offer(None)),)
    made = replace(made, drivers=drivers, panels=())
    async with served_session(tmp_path, made=made, catalogue={"puppet": TabletDriver}) as host:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", "page", str(host.path)),
            *("--at", "127.0.0.1:0", "--tablet"),
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        said = [await asyncio.wait_for(process.stdout.readline(), WAIT_S) for _ in range(3)]
        sent = await host.published(lambda line: isinstance(line, m.Command))
        assert isinstance(sent, m.Command)
        assert (sent.verb, sent.args) == ("screen", {"file": said[2].split()[-1].decode()})
        (path,) = open_pages(host.path.stem)
        told = await asyncio.to_thread(order, path, [PageRole.ANSWER])
        assert told is not None
        await host.until(lambda: len(host.of(m.Command)) == 2)
        address = told[2].split()[-1]
        assert host.of(m.Command)[1].args == {"file": address}, "not the page of the old code"
        assert address != sent.args["file"]
        process.terminate()
        assert await asyncio.wait_for(process.wait(), WAIT_S) == 0


def test_an_address_as_a_qr_code_has_all_modules_and_a_margin() -> None:
    dark = modules("http://192.168.4.1:8080/join/0123456789abcdef01234567")
    assert len(dark) == len(dark[0]) >= 25
    lines = drawn(dark, colours=False)
    halves = {"█": (True, True), "▀": (True, False), "▄": (False, True), " ": (False, False)}
    rows = [[halves[cell][half] for cell in line] for line in lines for half in (0, 1)]
    assert [row[4:-4] for row in rows[4 : 4 + len(dark)]] == dark
    assert not any(any(row) for row in rows[:4] + rows[4 + len(dark) :])
    assert not any(any(row[:4] + row[-4:]) for row in rows)
    coloured = drawn(dark, colours=True)
    assert [line[len("\x1b[30;107m") : -len("\x1b[0m")] for line in coloured] == lines


def test_without_the_package_for_qr_codes_it_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "segno", None)
    assert main(["page", "--qr"]) == 1
    assert "QR codes need the package `segno`" in capsys.readouterr().err


def certificate(folder: Path) -> tuple[Path, Path]:
    """A certificate for 127.0.0.1 that has signed itself, and its key."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "robot")])
    here = x509.SubjectAlternativeName([x509.IPAddress(ip_address("127.0.0.1"))])
    begins = datetime(2000, 1, 1, tzinfo=UTC)
    made = (
        x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
        .not_valid_before(begins)
        .not_valid_after(begins + timedelta(days=36500))
        .add_extension(here, critical=False)
        .sign(key, SHA256())
    )
    form = Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()
    (folder / "page.pem").write_bytes(made.public_bytes(Encoding.PEM))
    (folder / "page.key").write_bytes(key.private_bytes(*form))
    return folder / "page.pem", folder / "page.key"


async def test_the_wizard_reads_that_pages_are_not_encrypted(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", "page", str(host.path)),
            *("--at", "0.0.0.0:0", "--plain"),
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        said = [await asyncio.wait_for(process.stdout.readline(), WAIT_S) for _ in range(5)]
        assert b"whoever is in this network can read the pages" in said[-1]
        attached = await host.published(lambda line: isinstance(line, m.ConsoleAttached))
        assert isinstance(attached, m.ConsoleAttached)
        assert (attached.role, attached.name) == ("watcher", "page, not encrypted")
        process.terminate()
        assert await asyncio.wait_for(process.wait(), WAIT_S) == 0


async def test_with_a_certificate_pages_and_forms_are_encrypted(tmp_path: Path) -> None:
    made, key = certificate(tmp_path)
    async with served_session(tmp_path) as host:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", "page", str(host.path)),
            *("--at", "127.0.0.1:0", "--certificate", str(made), "--key", str(key)),
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        said = [await asyncio.wait_for(process.stdout.readline(), WAIT_S) for _ in range(3)]
        front, code = re.findall(r"(https://\S+/) with the code (\d+)", said[1].decode())[0]
        trusted = ssl.create_default_context(cafile=made)
        async with aiohttp.ClientSession() as http:
            own = {"Origin": front.rstrip("/")}
            address, form = f"{front}code", {"code": code}
            async with http.post(address, ssl=trusted, data=form, headers=own) as response:
                assert response.status == 200
                (cookie,) = response.cookies.values()
                assert cookie["secure"]
            with pytest.raises(aiohttp.ClientError):
                await http.get(front.replace("https", "http"))
        process.terminate()
        assert await asyncio.wait_for(process.wait(), WAIT_S) == 0


async def test_it_prints_an_address_for_each_and_leaves_when_told(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", "page", str(host.path), "--at", "127.0.0.1:0"),
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        said = [await asyncio.wait_for(process.stdout.readline(), WAIT_S) for _ in range(4)]
        text = b"".join(said).decode()
        assert re.search(
            r"^For a class: +http://127\.0\.0\.1:\d+/ with the code \d{6}$", text, re.M
        )
        assert "Nothing there plays or stops the robot." in text
        for role, path in (("To watch", "/watch"), ("The participant", "/answer")):
            address = re.search(rf"^{role}: +(http\S+)$", text, re.M)
            assert address is not None
            async with aiohttp.ClientSession() as http, http.get(address[1]) as response:
                assert f'url={path}"' in await response.text()
        process.terminate()
        assert await asyncio.wait_for(process.wait(), WAIT_S) == 0
