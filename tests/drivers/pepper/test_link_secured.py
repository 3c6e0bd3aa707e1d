"""Secured lines: user, password, certificate, with both clients; no password in any text."""

from __future__ import annotations

import hashlib
import ssl
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from qimessaging.hosted_objects import HostedMethod
from qimessaging.server import QiServer
from woz_drivers.naoqi_robot.address import parse
from woz_drivers.naoqi_robot.link import ConnectionRefusedByRobotError, NaoqiLink, open_link
from woz_drivers.pepper.model import PEPPER
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.connection_rig import started_connection
from woz_tui.drivers.contract import DeviceLostError, Health
from woz_tui.protocol.messages import Notice

KEPT = Path(__file__).parents[1] / "qimessaging"
CERTIFICATE, KEY = KEPT / "certificate.pem", KEPT / "key.pem"
PASSWORD = "Hush!42"
WITHIN_S = 10.0


class Guarded:
    """A robot behind a login."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, str]] = []
        self.address = ""
        self.server = QiServer(authenticator=self._lets_in)
        self.server.add("Desk", methods=[HostedMethod("echo", "(m)", "m", lambda value: value)])

    def _lets_in(self, user: str, password: str) -> bool:
        self.asked.append((user, password))
        return (user, password) == ("ada", PASSWORD)

    async def listen(self) -> None:
        tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        tls.load_cert_chain(CERTIFICATE, KEY)
        endpoint = await self.server.listen("127.0.0.1", tls=tls)
        self.address = f"tcps://ada@127.0.0.1:{endpoint.port}"

    async def open(self, **settings: str) -> NaoqiLink:
        pepper_settings = PepperSettings(robots=(), password="ROBOT_PASSWORD", **settings)  # type: ignore[arg-type]
        return await open_link(parse(self.address), pepper_settings, within=WITHIN_S)


@pytest.fixture
async def guarded() -> AsyncIterator[Guarded]:
    made = Guarded()
    await made.listen()
    yield made
    await made.server.close()


def fingerprint() -> str:
    return hashlib.sha256(ssl.PEM_cert_to_DER_cert(CERTIFICATE.read_text())).hexdigest()


async def test_user_and_password_let_us_in(
    guarded: Guarded, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", PASSWORD)
    link = await guarded.open()
    assert await link.call("Desk", "echo", 1, within=WITHIN_S) == 1
    assert set(guarded.asked) == {("ada", PASSWORD)}
    await link.close()


@pytest.mark.parametrize("given", ["wrong-Hush", ""])
async def test_a_wrong_password_is_told_with_its_remedy(
    guarded: Guarded, given: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", given)
    with pytest.raises(DeviceLostError) as lost:
        await guarded.open()
    assert "ROBOT_PASSWORD" in lost.value.remedy
    assert "Hush" not in lost.value.what + lost.value.remedy + repr(lost.value)
    assert isinstance(lost.value, ConnectionRefusedByRobotError)


async def test_the_trusted_certificate_is_taken(
    guarded: Guarded, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", PASSWORD)
    spelled = ":".join(fingerprint()[at : at + 2] for at in range(0, 64, 2)).upper()
    for trusted in ("", fingerprint(), spelled):
        link = await guarded.open(trusted=trusted)
        assert link.certificate == fingerprint()
        await link.close()


async def test_which_certificate_is_accepted_is_told(
    guarded: Guarded, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", PASSWORD)
    for name in sorted(PEPPER.services):
        guarded.server.add(name)
    given = {"password": "ROBOT_PASSWORD"}
    async with started_connection(tmp_path, guarded.address, **given) as rig:
        await rig.is_so(Health.CONNECTED)
        (notice,) = rig.published.all(Notice)
        assert fingerprint() in notice.text
        assert f"trusted: {fingerprint()}" in notice.remedy
        assert PASSWORD not in str(rig.published.messages)
    async with started_connection(tmp_path, guarded.address, trusted=fingerprint(), **given) as rig:
        await rig.is_so(Health.CONNECTED)
        assert not rig.published.all(Notice)


async def test_to_a_robot_with_another_certificate_no_password_is_sent(
    guarded: Guarded, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", PASSWORD)
    with pytest.raises(ConnectionRefusedByRobotError) as raised:
        await guarded.open(trusted="00" * 32)
    assert "certificate" in raised.value.what
    assert fingerprint() in raised.value.remedy
    assert guarded.asked == []


async def test_a_plain_line_to_a_secured_port_ends_in_a_sentence(guarded: Guarded) -> None:
    plain = guarded.address.replace("tcps://ada@", "tcp://")
    with pytest.raises(DeviceLostError) as lost:
        await open_link(parse(plain), PepperSettings(robots=()), within=1.0)
    assert lost.value.remedy
