"""Names of visitors: what may be one, and which are the same."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.visitor_names import (
    LONGEST,
    VisitorNameError,
    key_of,
    label_of,
    name_of,
    quoted_name,
    word_of,
)

#: A name that is not written right without a joiner.
PERSIAN = "\u0639\u0644\u06cc\u200c\u0631\u0636\u0627"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Anna", "Anna"),
        ("  Anna \n", "Anna"),
        ("Anna   Maria\u00a0Rossi", "Anna Maria Rossi"),
        ("Zoe\u0308", "Zo\u00eb"),
        ("P07", "P07"),
        ("O'Neil-Smith", "O'Neil-Smith"),
        ("李雷", "李雷"),
        (PERSIAN, PERSIAN),
        ("x" * LONGEST, "x" * LONGEST),
    ],
)
def test_what_is_a_name(text: str, name: str) -> None:
    assert name_of(text) == name


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "is empty"),
        (" \t ", "is empty"),
        ("x" * (LONGEST + 1), "65 characters, 64 are allowed"),
        ("An\x00na", r"U\+0000"),
        ("An\tna", r"U\+0009"),
        ("Anna\x1b[31m!", r"U\+001B"),
        ("Anna\u202ebob", r"U\+202E"),
        ("An\u200bna", r"U\+200B"),
        ("Anna\u2028Bob", r"U\+2028"),
        ("Anna\ud800", r"U\+D800"),
        ("...", "has no letters and no digits"),
        ("Unknown", "is the word for a visitor without a name"),
        (" uNKNOWN", "is the word for a visitor without a name"),
        ("sensor", "is a command"),
    ],
)
def test_what_is_none_and_why(text: str, reason: str) -> None:
    with pytest.raises(VisitorNameError, match=reason) as error:
        name_of(text)
    assert error.value.remedy


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("anna", "Anna"),
        ("ANNA  maria", " Anna Maria"),
        ("Stra\u00dfe", "STRASSE"),
        ("Zoe\u0308", "zo\u00eb"),
        ("\uff21nna", "anna"),
        (PERSIAN, PERSIAN.replace("\u200c", "")),
    ],
)
def test_names_that_people_take_for_the_same(one: str, other: str) -> None:
    assert key_of(one) == key_of(other)


def test_names_that_differ() -> None:
    assert len({key_of(name) for name in ("Anna", "Hanna", "Ann", "P1", "P01", "Zoe", "Zoë")}) == 7


def test_words_of_a_profile_may_be_empty_and_labels_may_not() -> None:
    assert word_of("  young  adult ", "an age group") == "young adult"
    assert word_of("", "an age group") == ""
    with pytest.raises(VisitorNameError, match="an age group has 33 characters"):
        word_of("x" * 33, "an age group")
    assert label_of("unknown") == "unknown"
    with pytest.raises(VisitorNameError, match="empty"):
        label_of(" ")


def test_what_would_not_be_seen_is_shown_escaped() -> None:
    assert quoted_name("a\x1b[2Jb\u202e") == r'"a\x1b[2Jb\u202e"'
    assert quoted_name("x" * 1000).endswith('..."')


@given(st.text())
def test_a_name_is_its_own_name_and_safe_to_show(text: str) -> None:
    try:
        name = name_of(text)
    except VisitorNameError as error:
        assert error.reason.isprintable() or "\u200c" in text or "\u200d" in text
        return
    assert name_of(name) == name
    assert key_of(name) == key_of(text) == key_of(key_of(name))
    assert 0 < len(name) <= LONGEST
    assert unicodedata.is_normalized("NFC", name)
    assert not any(unicodedata.category(one) in ("Cc", "Cs") for one in name)
