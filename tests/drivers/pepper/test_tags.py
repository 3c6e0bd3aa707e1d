"""Tags in an utterance: what is offered, and what is said about wrong ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot import tags

#: What real experiments say: no warning belongs here.
RIGHT = (
    r"\rspd=80\Hello there.\pau=500\ How are you?\rst\ ",
    r"\vct=50\low \vct=200\high \vol=0\ silent \vol=100\ loud",
    "Hi ^start(animations/Stand/Gestures/Hey_1) you ^wait(animations/Stand/Gestures/Hey_1)",
    "^run(animations/Stand/Gestures/Yes_1) ^stop(animations/Stand/Gestures/Yes_1)",
    r"\style=joyful\ \emph=1\ ^mode(disabled) ^startTag(happy)",
    "AT&T said: 50 % & #1, {participant} \"quoted\" 'so' <b>, 2^3 = 8, ünïcödé 日本語",
    "",
)


@pytest.mark.parametrize("text", RIGHT)
def test_right_tags_and_plain_text_are_not_complained_about(text: str) -> None:
    assert tags.problems(text) == []


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (r"\vct=49\ ", r"\vct=49\ needs a number of 50 to 200 %"),
        (r"\vct=201\ ", "50 to 200 %"),
        (r"\rspd=401\ ", "50 to 400 %"),
        (r"\pau=-1\ ", "0 to 60000 ms"),
        (r"\vol=101\ ", "0 to 100 %"),
        (r"\vol=loud\ ", "needs a number"),
        (r"\pau\ ", "needs a number"),
        (r"\rst=1\ ", r"takes no value: write \rst"),
        (r"\rsqd=80\ ", r"did you mean \rspd?"),
        (r"\rspd=80 hello", "not closed"),
        ("^srart(animations/Stand/Gestures/Hey_1)", "did you mean ^start?"),
        ("^run()", "names no animation"),
        ("^run(animations/Stand/Gestures/Hey_1 hello", "not closed"),
    ],
)
def test_a_wrong_tag_is_one_sentence_that_says_what_would_be_right(text: str, says: str) -> None:
    found = tags.problems(f"Hello {text}")
    assert len(found) == 1, found
    assert says in found[0]


def test_every_wrong_tag_is_told() -> None:
    assert len(tags.problems(r"\vct=1\ a \vol=900\ b ^run() c \nope=1\ ")) == 4


@given(st.text(alphabet=r"\^=()abcrsptvo0159. ", max_size=40))
def test_nothing_that_is_typed_breaks_the_check(text: str) -> None:
    assert all(isinstance(sentence, str) for sentence in tags.problems(text))


@given(st.sampled_from(sorted(tags.VOICE_TAGS)), st.integers(-1000, 70_000))
def test_a_tag_is_right_exactly_within_its_range(name: str, value: int) -> None:
    allowed = tags.VOICE_TAGS[name].range
    complaint = tags.problems(f"\\{name}={value}\\")
    assert (complaint == []) == (allowed is not None and allowed.contains(value))


def test_what_is_offered_is_right_itself_and_explained() -> None:
    offered = tags.offered()
    assert [tag.text for tag in offered if tags.problems(tag.text)] == []
    assert all(tag.help for tag in offered)
    assert {tag.text.strip("\\^").partition("=")[0].partition("(")[0] for tag in offered} == {
        *("vct", "rspd", "pau", "vol", "rst"),
        *("run", "start", "stop", "wait"),
    }
