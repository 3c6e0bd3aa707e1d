"""Which action is likely next."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.features.proposals.ranker import Act, Moment, Ranker, moments, words_of

ABOUT = {
    "Hello": ["Hello", "Good morning"],
    "Whale": ["Whale", "This is the blue whale."],
    "Size": ["Size", "It is thirty metres long."],
    "Bye": ["Bye", "Goodbye!"],
}
SCRIPT = {"": ("Hello", "Whale", "Bye")}


def heard(text: str) -> tuple[int, ...]:
    return tuple(words_of(text))


def ranked(ranker: Ranker, **moment: object) -> list[str]:
    filled = Moment(script=SCRIPT[""], **moment)  # type: ignore[arg-type]
    return [each.action for each in ranker.rank(filled)]


def test_without_any_session_the_script_goes_first_and_what_was_played_last() -> None:
    ranker = Ranker(ABOUT, SCRIPT)
    assert ranked(ranker)[0] == "Hello"
    assert ranked(ranker, before=("Hello",), played={"Hello"}, position=1)[0] == "Whale"
    assert ranked(ranker, before=("Whale",), played={"Hello", "Whale"}, position=2)[-1] != "Bye"


def test_words_of_the_file_and_of_earlier_visitors_count() -> None:
    ranker = Ranker(ABOUT, SCRIPT)
    assert ranked(ranker, heard=heard("how many metres is it?"))[0] == "Size"
    ranker.learn([Act("Hello", new=True), Act("Size", heard=heard("is it enormous?"))])
    assert ranked(ranker, heard=heard("so enormous!"), before=("Hello",))[0] == "Size"


def test_what_followed_before_follows_again() -> None:
    ranker = Ranker(ABOUT, {"": ()})
    for _ in range(5):
        ranker.learn([Act("Bye", new=True), Act("Size"), Act("Whale")])
    assert ranker.rank(Moment(before=("Bye",), played={"Bye"}))[0].action == "Size"


def test_only_what_is_allowed_is_offered() -> None:
    ranker = Ranker(ABOUT, SCRIPT)
    assert [each.action for each in ranker.rank(Moment(), {"Bye"})] == ["Bye"]


acts = st.lists(
    st.builds(
        Act,
        st.sampled_from([*ABOUT, "gone from the file"]),
        st.just(""),
        st.none() | st.lists(st.integers(0, 9), max_size=4).map(tuple),
        st.booleans(),
    ),
    max_size=12,
)


@given(st.lists(acts, max_size=4), acts)
def test_shares_add_up_and_what_is_forgotten_was_never_there(
    sessions: list[list[Act]], more: list[Act]
) -> None:
    ranker = Ranker(ABOUT, SCRIPT)
    for session in sessions:
        ranker.learn(session)
    asked = [moment for _, moment in moments(more, SCRIPT)] or [Moment()]
    before = [ranker.rank(moment) for moment in asked]
    for found in before:
        assert math.isclose(sum(each.share for each in found), 1.0, abs_tol=1e-6)
    ranker.learn(more)
    ranker.learn(more, -1)
    again = [ranker.rank(moment) for moment in asked]
    for one, other in zip(before, again, strict=True):
        for each, same in zip(sorted(one), sorted(other), strict=True):
            assert each.action == same.action
            assert math.isclose(each.share, same.share, abs_tol=1e-6)
    ranker.calibrate(sessions)
