r"""Tags in an utterance while it is typed. `|` is the caret."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console.robot import pepper
from woz_tui.console.robot_settings.completion import (
    NumberEntry,
    PartialTag,
    completed,
    names_beginning,
    names_containing,
    partial_tag,
    tag_offers,
)
from woz_tui.protocol.robot_outline import RobotOutline, Tag

OUTLINE = pepper.OUTLINE
HEY = "animations/Stand/Gestures/Hey_1"


def partial_tag_in(marked: str) -> str | None:
    """What of a text counts as a tag in the making."""
    text, caret = marked.replace("|", ""), marked.index("|")
    found = partial_tag(text, caret)
    return found.typed if found is not None else None


@pytest.mark.parametrize(
    ("marked", "typed"),
    [
        ("\\|", "\\"),
        ("Hi \\rs|", "\\rs"),
        ("Hi \\rspd=1|00\\ you", "\\rspd=1"),
        ("\\rst\\ Hi \\v|", "\\v"),
        ("^|", "^"),
        ("Hi ^ru|", "^ru"),
        ("Hi ^run(Hey|", "^run(Hey"),
        ("\\rspd=80\\^st|", "^st"),
        ("Hi|", None),
        ("Hi \\rst\\|", None),
        ("Hi \\rst\\ you|", None),
        ("Hi \\ you|", None),
        ("^run(Hey_1)|", None),
        ("^run(Hey_1) and|", None),
        ("^run(a b|", None),
        ("2^3|", None),
        ("|\\rs", None),
        ("|", None),
    ],
)
def test_where_a_tag_is_being_typed(marked: str, typed: str | None) -> None:
    assert partial_tag_in(marked) == typed


def completes(marked: str, outline: RobotOutline = OUTLINE) -> str | None:
    """The text after tab."""
    text, caret = marked.replace("|", ""), marked.index("|")
    found = partial_tag(text, caret)
    offered = tag_offers(found, outline) if found is not None else []
    if found is None or not offered:
        return None
    after, caret = completed(text, found, offered[0])
    return f"{after[:caret]}|{after[caret:]}"


@pytest.mark.parametrize(
    ("marked", "after"),
    [
        ("Hi \\rs|", "Hi \\rspd=100\\|"),
        ("Hi \\RS|", "Hi \\rspd=100\\|"),
        ("Hi \\p| you", "Hi \\pau=500\\| you"),
        ("Hi \\rspd=80|", "Hi \\rspd=80\\|"),
        ("Hi \\rspd=8|0\\ you", "Hi \\rspd=8\\| you"),
        ("Hi \\rspd=|", "Hi \\rspd=100\\|"),
        ("Hi \\nothing|", None),
        ("Hi \\nothing=3|", None),
        ("^ru|", "^run(|"),
        ("^st| now", "^start(| now"),
        ("^run(hey_2|", "^run(animations/Stand/Gestures/Hey_2)|"),
        ("^run(happy| now", "^run(animations/Stand/Emotions/Positive/Happy_1)| now"),
        (f"^run(Hey|{HEY[:9]})!", f"^run({HEY})|!"),
        ("^run(dance|", None),
    ],
)
def test_what_tab_makes_of_it(marked: str, after: str | None) -> None:
    assert completes(marked) == after


def test_a_tag_that_is_told_with_an_example_is_put_in_without_it() -> None:
    outline = RobotOutline(
        tags=[Tag(text=f"^run({HEY})", help="plays"), Tag(text="\\rst\\", help="as before")],
        moves=[HEY],
    )
    assert completes("^r|", outline) == "^run(|"
    assert completes("\\r|", outline) == "\\rst\\|"
    assert completes("^run(|", outline) == f"^run({HEY})|"


def test_every_offer_has_its_help() -> None:
    found = partial_tag("\\", 1)
    assert found is not None
    told = {offer.text: offer.help for offer in tag_offers(found, OUTLINE)}
    assert told == {tag.text: tag.help for tag in OUTLINE.tags if tag.text.startswith("\\")}


texts = st.text(alphabet="\\^ab=(1) _/", max_size=30)


@given(texts, st.integers(0, 30))
def test_tab_changes_only_the_tag(text: str, caret: int) -> None:
    caret = min(caret, len(text))
    found = partial_tag(text, caret)
    if found is None:
        return
    assert found.start < caret <= found.end <= len(text)
    assert text[found.start : caret] == found.typed
    for offer in tag_offers(found, OUTLINE):
        after, at = completed(text, found, offer)
        assert after[: found.start] == text[: found.start]
        assert after[at:] == text[found.end :]


@pytest.mark.parametrize(
    ("typed", "after"),
    [
        (["1", "5", "0"], "Hi \\rspd=150\\| you"),
        (["150"], "Hi \\rspd=150\\| you"),  # in one go
        (["150\\"], "Hi \\rspd=150\\| you"),
        (["80", "\\", " 3"], "Hi \\rspd=80\\ 3| you"),
        (["80\\", "3"], "Hi \\rspd=80\\3| you"),
        ([" and", "3"], "Hi \\rspd=100\\ and3| you"),
        (["\\"], "Hi \\rspd=100\\\\| you"),
    ],
)
def test_digits_behind_a_tag_that_was_put_in_are_its_number(typed: list[str], after: str) -> None:
    begun = partial_tag("Hi \\rs you", 6)
    assert begun is not None
    text, caret = completed("Hi \\rs you", begun, tag_offers(begun, OUTLINE)[0])
    tag = NumberEntry.put_in(text, begun, caret)
    for more in typed:
        text, caret = text[:caret] + more + text[caret:], caret + len(more)
        tag = tag.goes_on(text) if tag is not None else None
        if tag is not None:
            text, caret = tag.text, tag.caret
    assert f"{text[:caret]}|{text[caret:]}" == after


@given(texts, st.sampled_from(["", "1", "15"]), texts)
def test_any_other_change_leaves_the_tag_alone(before: str, digits: str, now: str) -> None:
    text = f"{before}\\rspd=100\\ you"
    begun = PartialTag(len(before), len(text) - 4, "\\rspd=100\\")
    tag = NumberEntry.put_in(text, begun, len(text) - 4)
    assert tag is not None
    tag = tag.goes_on(f"{text[:-4]}{digits} you")
    assert tag is not None
    left = tag.goes_on(now)
    assert left is None or left.text == now or now.startswith(before)


def test_only_a_number_is_typed_over() -> None:
    for text in ("^run(Hey)", "\\rst\\"):
        assert NumberEntry.put_in(text, PartialTag(0, len(text), text), len(text)) is None


def test_names_by_a_part_of_them() -> None:
    names = ["a/Wave_1", "a/b/Hey_1", "wave", "a/ShortWave_2"]
    assert names_containing("wave", names) == ["wave", "a/Wave_1", "a/ShortWave_2"]
    assert names_containing("HEY", names) == ["a/b/Hey_1"]
    assert names_containing("", names) == names
    assert names_beginning("a/W", names) == ["a/Wave_1"]
    assert names_beginning("wave", names) == []
