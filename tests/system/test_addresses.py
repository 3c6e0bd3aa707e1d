"""Passwords in addresses are not shown, and what is none stays as it is."""

from __future__ import annotations

import pytest

from woz_tui.system.addresses import without_passwords

LONG = "x" * 100_000


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("http://u:secret@host", "http://u:***@host"),
        ("http://u:secret@host:80/a.png?b=c", "http://u:***@host:80/a.png?b=c"),
        ("rtsp://u:secret@host or ftp://v:secret@host!", "rtsp://u:***@host or ftp://v:***@host!"),
        ("http:///u:secret@host", "http:///u:***@host"),
        ("http://:secret@host", "http://:***@host"),
        ("http://u:se@cret@host", "http://u:***@host"),
        ("http://u:se/secret@host", "http://u:***@host"),
        ("http://u:12secret@host", "http://u:***@host"),
        ("http://u:1234@host", "http://u:***@host"),
        (f"http://u:{LONG}@host", "http://u:***@host"),
        ("http://proxy/http://u:secret@host", "http://proxy/http://u:***@host"),
        ("http://proxy:80/?to=http://u:secret@host", "http://proxy:80/?to=http://u:***@host"),
        ('["http://u:secret@host"]', '["http://u:***@host"]'),
        ("http://u:***@host", "http://u:***@host"),
    ],
)
def test_a_password_is_not_shown(text: str, shown: str) -> None:
    assert without_passwords(text) == shown
    assert without_passwords(shown) == shown


@pytest.mark.parametrize(
    "text",
    [
        "Hello",
        "http://host/picture.png",
        "http://host:8080/picture@2x.png",
        "http://host/12:30@noon.png",
        "http://user@host/",
        "meet me at 12:30 @ the door",
        "anna:berta@example.org",
        "a:/" + LONG,
        "a://b/" * 300_000 + "@",
    ],
)
def test_what_is_no_password_stays(text: str) -> None:
    assert without_passwords(text) == text
