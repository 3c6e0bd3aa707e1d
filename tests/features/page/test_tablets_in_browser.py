"""Tablets in real browsers: encrypted, two at once, asleep, without a network."""

from __future__ import annotations

import base64
import ssl
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from ipaddress import ip_address
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
)

from tests.analysis.html.browser import Page, browser
from tests.features.page.rig import PageRig, pages
from tests.features.page.test_pages_in_browser import TLX, aside, join
from tests.host.rig import Peer, ServedSession, served_session
from tests.session.study_rig import STUDY, study_experiment
from woz_tui.features.page.visitors import PageRole
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem

pytestmark = [pytest.mark.browser, pytest.mark.real_clock]

BEGIN = "button[value=begin]"


class Laboratory:
    """An authority of a laboratory, and what it signed for 127.0.0.1."""

    def __init__(self, folder: Path) -> None:
        self._key = ec.generate_private_key(ec.SECP256R1())
        name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "laboratory")])
        root = self._signed(name, name, self._key, x509.BasicConstraints(ca=True, path_length=0))
        key = ec.generate_private_key(ec.SECP256R1())
        robot = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "robot")])
        here = x509.SubjectAlternativeName([x509.IPAddress(ip_address("127.0.0.1"))])
        page = self._signed(robot, name, key, here)
        self._chain, self._page_key = folder / "page.pem", folder / "page.key"
        self._chain.write_bytes(b"".join(one.public_bytes(Encoding.PEM) for one in (page, root)))
        form = Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()
        self._page_key.write_bytes(key.private_bytes(*form))

    def _signed(
        self,
        subject: x509.Name,
        issuer: x509.Name,
        key: ec.EllipticCurvePrivateKey,
        more: x509.ExtensionType,
    ) -> x509.Certificate:
        begins = datetime.now(UTC) - timedelta(days=1)
        return (
            x509.CertificateBuilder(issuer, subject, key.public_key(), x509.random_serial_number())
            .not_valid_before(begins)
            .not_valid_after(begins + timedelta(days=300))
            .add_extension(more, critical=isinstance(more, x509.BasicConstraints))
            .sign(self._key, SHA256())
        )

    @property
    def pin(self) -> str:
        """By which a browser knows its key."""
        form = Encoding.DER, PublicFormat.SubjectPublicKeyInfo
        return base64.b64encode(
            sha256(self._key.public_key().public_bytes(*form)).digest()
        ).decode()

    @property
    def tls(self) -> ssl.SSLContext:
        """For the server of pages."""
        made = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        made.load_cert_chain(self._chain, self._page_key)
        return made


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> Laboratory:
    return Laboratory(tmp_path_factory.mktemp("laboratory"))


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser(tmp_path_factory.mktemp("first"), "127.0.0.1") as page:
        yield page


@pytest.fixture(scope="module")
def second(tmp_path_factory: pytest.TempPathFactory, laboratory: Laboratory) -> Iterator[Page]:
    """It trusts the laboratory."""
    folder = tmp_path_factory.mktemp("second")
    with browser(folder, "127.0.0.1", trusts=laboratory.pin) as page:
        yield page


class Stage:
    """A session that asks TLX, and its pages."""

    def __init__(self, host: ServedSession, rig: PageRig, wizard: Peer) -> None:
        self.host, self.rig, self.wizard = host, rig, wizard

    async def ask(self, what: str = "begin") -> None:
        """The wizard begins the questionnaire, or takes it back."""
        reply = await self.wizard.ask("questionnaire", questionnaire="tlx", what=what)
        assert reply["ok"], reply

    async def enter(self, *tablets: Page) -> None:
        """They are before the first question."""
        for tablet in tablets:
            await join(tablet, self.rig, PageRole.ANSWER)
        await self.ask()
        for tablet in tablets:
            await aside(tablet.until, lambda tablet=tablet: tablet.all(BEGIN))
            await aside(lambda tablet=tablet: tablet.one(BEGIN).click())
            await aside(asked, tablet, TLX.items[0].name)

    def answers(self) -> list[tuple[str, float | None]]:
        """What the session has."""
        return [(line.item, line.value) for line in self.host.of(QuestionnaireAnswered)]


@asynccontextmanager
async def on_stage(
    folder: Path, tls: ssl.SSLContext | None = None, asked: Questionnaire = TLX
) -> AsyncIterator[Stage]:
    made = study_experiment(folder, STUDY, {QUESTIONNAIRES: Asked((asked,))})
    async with served_session(folder, made=made) as host, pages(host, tls=tls) as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        yield Stage(host, rig, wizard)


def asked(tablet: Page, item: str) -> None:
    """Wait for this question."""
    legends = "return [...document.querySelectorAll('legend')].map(one => one.textContent)"
    tablet.until(lambda: tablet.run(legends) == [f"{item}?"])


def answer(tablet: Page, value: int) -> None:
    """Choose a point and send it."""
    tablet.hands().click(tablet.one(f"input[name=value][value='{value}']")).perform()
    tablet.hands().double_click(tablet.one("button[value=answer]")).perform()


def says(tablet: Page, text: str) -> None:
    """Until this is all that it says."""
    said = "return document.querySelector('.said')?.textContent"
    tablet.until(lambda: tablet.run(said) == text)


def online(tablet: Page, there: bool) -> None:
    """The network is there, or not."""
    speed = -1 if there else 0
    tablet.driver.execute_cdp_cmd("Network.enable", {})
    tablet.driver.execute_cdp_cmd(
        "Network.emulateNetworkConditions",
        {
            "offline": not there,
            "latency": 0,
            "downloadThroughput": speed,
            "uploadThroughput": speed,
        },
    )


def asleep(tablet: Page, sleeps: bool) -> None:
    """The tablet sleeps: nothing runs in its pages."""
    state = {"state": "frozen" if sleeps else "active"}
    tablet.driver.execute_cdp_cmd("Page.setWebLifecycleState", state)


async def test_pages_are_encrypted_with_the_laboratorys_own_authority(
    tmp_path: Path, first: Page, second: Page, laboratory: Laboratory
) -> None:
    """Who has not installed it gets nothing; who has it watches and answers, without a warning."""
    async with on_stage(tmp_path, laboratory.tls) as stage:
        await aside(first.visit, stage.rig.here)
        assert "ERR_CERT_AUTHORITY_INVALID" in first.driver.page_source
        await join(second, stage.rig, PageRole.WATCH)
        await aside(second.until, lambda: second.text("#plays") == "The wizard plays")
        stage.host.session.hub.publish(m.Marker(source="program", text="by news"))
        await aside(second.until, lambda: "by news" in second.text("#events"))
        assert [each["secure"] for each in second.driver.get_cookies()] == [True]
        await stage.enter(second)
        await aside(answer, second, 7)
        await aside(asked, second, TLX.items[1].name)
        assert stage.answers() == [("Mental", 7.0)]
        assert await aside(second.complaints) == []


WIDE = Questionnaire(
    "tlx",
    when="hand",
    items=(QuestionnaireItem("load", "How much?", 0, 100, ("none", "all"), kind="slider", step=5),),
)


async def test_each_number_stands_on_its_button_in_one_piece(tmp_path: Path, first: Page) -> None:
    async with on_stage(tmp_path, asked=WIDE) as stage:
        await join(first, stage.rig, PageRole.ANSWER)
        await stage.ask()
        await aside(first.until, lambda: first.all(BEGIN))
        await aside(lambda: first.one(BEGIN).click())
        await aside(asked, first, "How much")
        outside = """
        return [...document.querySelectorAll(".points input + span")].filter((one) => {
          const words = document.createRange();
          words.selectNodeContents(one);
          const [text, ...more] = words.getClientRects(), box = one.getBoundingClientRect();
          return more.length || text.left < box.left || text.right > box.right;
        }).map((one) => one.textContent);
        """
        wide = "return [innerWidth, document.documentElement.scrollWidth]"
        for width in (320, 360, 768, 1024, 1366):
            await aside(first.size, width, 740)
            assert await aside(first.run, outside) == [], width
            inside, needed = await aside(first.run, wide)
            assert (inside, needed <= width) == (width, True)


async def test_two_tablets_at_once_go_on_together(
    tmp_path: Path, first: Page, second: Page
) -> None:
    async with on_stage(tmp_path) as stage:
        await stage.enter(first, second)
        for number, item in enumerate(TLX.items):
            tablet, other = (first, second) if number % 2 else (second, first)
            await aside(asked, tablet, item.name)
            await aside(asked, other, item.name)
            await aside(answer, tablet, number)
        done = "button[value=done]"
        await aside(second.until, lambda: second.all(done))
        await aside(first.until, lambda: first.all(done))
        await aside(lambda: first.one(done).click())
        for tablet in (first, second):
            await aside(
                tablet.until, lambda tablet=tablet: tablet.one(".said").text == "Thank you!"
            )
        names = [item.name for item in TLX.items]
        assert stage.answers() == [(name, float(place)) for place, name in enumerate(names)]


@pytest.mark.parametrize("network", [True, False], ids=["network", "no-network"])
async def test_a_tablet_that_wakes_after_it_was_taken_back_asks_nothing(
    tmp_path: Path, first: Page, network: bool
) -> None:
    async with on_stage(tmp_path) as stage:
        await stage.enter(first)
        await aside(asleep, first, True)
        await aside(online, first, network)
        await stage.ask("left")
        await aside(online, first, True)
        await aside(asleep, first, False)
        await aside(says, first, "Please wait.")
        assert stage.answers() == []


async def test_what_was_not_sent_before_it_was_taken_back_goes_nowhere(
    tmp_path: Path, first: Page
) -> None:
    async with on_stage(tmp_path) as stage:
        await stage.enter(first)
        await aside(online, first, False)
        await aside(answer, first, 3)
        await aside(first.until, lambda: "Not sent yet" in first.text("#complaint"))
        await stage.ask("left")
        await aside(online, first, True)
        await aside(says, first, "Please wait.")
        assert stage.answers() == []


async def test_an_answer_without_a_network_is_sent_when_it_is_there_again(
    tmp_path: Path, first: Page
) -> None:
    """Also on the page that was loaded anew meanwhile, where it is still ticked."""
    async with on_stage(tmp_path) as stage:
        await stage.enter(first)
        await aside(online, first, False)
        await aside(answer, first, 11)
        await aside(first.until, lambda: "Not sent yet" in first.text("#complaint"))
        assert stage.answers() == []
        await aside(online, first, True)
        await aside(asked, first, TLX.items[1].name)
        assert stage.answers() == [("Mental", 11.0)]
        tick = "document.querySelector(\"input[name=value][value='4']\")"
        await aside(first.run, f"{tick}.click()")
        await aside(first.driver.refresh)
        await aside(first.until, lambda: first.run(f"return {tick}.checked"))
