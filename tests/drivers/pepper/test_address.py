"""Addresses of robots: what is understood, what is refused, and that no password shows."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot.address import Address, parse, without_password
from woz_drivers.naoqi_robot.link import Secret, password
from woz_drivers.pepper.settings import PepperSettings

from woz_tui.drivers.contract import RejectedError


@pytest.mark.parametrize(
    ("text", "address", "shown"),
    [
        ("pepper.local", Address("pepper.local"), "pepper.local"),
        (" 10.0.0.7:9600 ", Address("10.0.0.7", 9600), "10.0.0.7:9600"),
        ("tcp://pepper", Address("pepper"), "pepper"),
        ("TCP://pepper:9559/", Address("pepper"), "pepper"),
        ("tcps://p", Address("p", 9503, True, "nao"), "p"),
        ("tcps://ada@p:1", Address("p", 1, True, "ada"), "p:1"),
        ("[fe80::1]", Address("fe80::1"), "[fe80::1]"),
        ("tcp://[fe80::1%eth0]:7", Address("fe80::1%eth0", 7), None),
        ("Simulated", Address(), "simulated"),
    ],
)
def test_what_is_understood(text: str, address: Address, shown: str | None) -> None:
    found = parse(text)
    assert found == address
    assert shown is None or found.shown == shown
    assert found.simulated == (text == "Simulated")


@pytest.mark.parametrize(
    ("text", "what", "remedy"),
    [
        ("", "no address", "tcp://HOST:9559"),
        ("http://pepper", "http://", "tcp://HOST:9559"),
        ("pepper:", "port", "tcp://HOST:9559"),
        ("pepper:0", "port", "tcp://HOST:9559"),
        ("pepper:65536", "port", "tcp://HOST:9559"),
        ("pepper:٣", "port", "tcp://HOST:9559"),
        ("pepper room", "name of a host", "tcp://HOST:9559"),
        ("a..b", "name of a host", "tcp://HOST:9559"),
        ("fe80::1", "brackets", "[ADDRESS]"),
        ("tcp://nao@pepper", "secured line", "tcps://nao@"),
        ("nao@pepper", "secured line", "tcps://nao@"),
        ("tcps://@pepper", "user", "tcps://USER@HOST"),
        ("tcps://a b@pepper", "user", "tcps://USER@HOST"),
    ],
)
def test_what_is_refused_says_what_to_write(text: str, what: str, remedy: str) -> None:
    with pytest.raises(RejectedError) as raised:
        parse(text)
    assert what in raised.value.what
    assert remedy in raised.value.remedy


#: With a password, whatever else is wrong, and what may be seen of it.
TELLING = (
    ("tcps://nao:Hush!42@pepper:9503", "tcps://nao:***@pepper:9503"),
    ("tcp://nao:Hush!42@pepper", "tcp://nao:***@pepper"),
    (" nao:Hush!42@pepper ", "nao:***@pepper"),
    ("tcps://nao:Hush!42", "tcps://nao:***"),
    ("nao:Hush!42", "nao:***"),
    ("nao:Hush!42:9503", "nao:***"),
    ("http://nao:Hush!42@pepper", "http://nao:***@pepper"),
    ("tcps://nao@pepper:Hush!42", "tcps://***:***@***"),
    ("tcps://nao:H@sh:Hush!42/@pepper", "tcps://nao:***@pepper"),
    ("tcps://nao:H@Hush!42", "tcps://nao:***@***"),
    ("tcps:/nao:Hush!42@pepper", "tcps:***@pepper"),
    ("tcps://nao{Hush}:{Hush}@pepper", "tcps://***:***@pepper"),
)


@pytest.mark.parametrize(("text", "seen_of_it"), TELLING)
def test_a_password_in_an_address_is_refused_and_not_repeated(text: str, seen_of_it: str) -> None:
    with pytest.raises(RejectedError) as raised:
        parse(text)
    assert "Hush" not in raised.value.what + raised.value.remedy + repr(raised.value)
    assert without_password(text) == seen_of_it
    with pytest.raises(RejectedError):  # nobody connects to what is left
        parse(seen_of_it)


@given(st.one_of(st.text(max_size=40), st.text("tcpsnao:@/[]*.1", max_size=40)))
def test_what_may_be_seen_is_all_of_an_address_and_the_same_seen_twice(text: str) -> None:
    once = without_password(text)
    assert without_password(once) == once
    try:
        parse(text)
    except RejectedError:
        assert ":" not in text or "***" in once
    else:
        assert once == text


def test_a_file_with_a_password_is_told_where_without_it() -> None:
    wrong = PepperSettings(robots=("10.0.0.1", *(text for text, _ in TELLING)))
    told = wrong.problems()
    assert [path for path, _ in told] == [f"robots[{n + 1}]" for n in range(len(TELLING))]
    assert "Hush" not in str(told)
    assert PepperSettings(robots=("no such/name", "tcps://nao@10.0.0.1")).problems() == []


def test_a_user_with_a_password_is_told_where_that_belongs() -> None:
    with pytest.raises(RejectedError) as raised:
        parse("tcps://nao:Hush!42@pepper")
    assert "WOZ_PEPPER_PASSWORD" in raised.value.remedy


@given(st.text(max_size=40))
def test_any_text_is_understood_or_refused(text: str) -> None:
    try:
        address = parse(text)
    except RejectedError as refused:
        assert refused.what
        assert refused.remedy
    else:
        assert 1 <= address.port <= 65535
        assert address.simulated or parse(address.shown).host == address.host


def test_a_secret_shows_nowhere_but_on_the_wire(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", "Hush!42")
    secret = password("ROBOT_PASSWORD")
    assert secret.reveal() == "Hush!42"
    assert "Hush" not in f"{secret} {secret!r} {[secret]}"
    assert secret.hidden_in("no Hush!42 here") == "no *** here"


def test_without_a_password_nothing_is_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROBOT_PASSWORD", raising=False)
    assert not password("ROBOT_PASSWORD")
    assert not password("")
    assert Secret("").hidden_in("as it is") == "as it is"
