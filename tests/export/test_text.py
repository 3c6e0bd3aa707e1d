"""Texts survive, or what does not is shown."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from tests.export.logs import WORDS
from woz_tui.export.event_model import letters
from woz_tui.system.text_cleaning import guarded, one_line, seconds, visible

_ANY = st.one_of(WORDS, st.text(st.characters(), max_size=10))


@given(_ANY)
def test_any_text_can_stand_in_xml_and_comes_back(text: str) -> None:
    shown = visible(text)
    read = ET.fromstring(ET.tostring(_element(shown))).text or ""
    assert read == shown


def _element(text: str) -> ET.Element:
    element = ET.Element("t")
    element.text = text
    return element


@given(_ANY)
def test_nothing_disappears_but_doubled_line_ends(text: str) -> None:
    assert len(visible(text)) == len(text.replace("\r\n", "\n"))


@given(st.text(st.characters(exclude_categories=["Cc", "Cs", "Cn", "Zl", "Zp"]), max_size=10))
def test_what_is_no_control_character_stays(text: str) -> None:
    assert visible(text) == one_line(text) == text


@given(_ANY)
def test_one_line_is_one_line(text: str) -> None:
    line = one_line(text)
    assert line.splitlines() in ([], [line])
    assert "\t" not in line


def test_control_characters_have_pictures() -> None:
    assert visible("a\x00b\x1b\x7f\x85") == "a\u2400b\u241b\u2421\ufffd"
    assert one_line("a\tb\r\nc\rd\n") == "a\u2409b\u240ac\u240ad\u240a"


@given(_ANY)
def test_the_guard_comes_off_again(text: str) -> None:
    cell = guarded(text)
    assert not cell.startswith(("=", "+", "-", "@", "\t", "\r", "\n"))
    assert (cell[1:] if cell.startswith("'") else cell) == text


def test_seconds_have_all_places() -> None:
    assert seconds(0) == "0.000000"
    assert seconds(12_345_678) == "12.345678"
    assert seconds(-1) == "-0.000001"
    assert seconds(10**15 + 1) == "1000000000.000001"


def test_letters_are_what_bids_takes() -> None:
    assert letters("museum guide-2", "x") == "museumguide2"
    assert letters("über", "x") == "ber"
    assert letters("--", "x") == "x"
