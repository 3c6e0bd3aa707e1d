"""One way through a questionnaire, without a screen."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import studied
from woz_tui.console.keyboard import HELD_US
from woz_tui.console.study.questionnaire_run import SETTLING_US, QuestionnairePage, QuestionnaireRun
from woz_tui.console.study.questionnaires import ItemAnswer, OpenQuestionnaire, items_of
from woz_tui.protocol.requests import AskAnswer, AskQuestionnaire
from woz_tui.protocol.welcome import ENGLISH, Questionnaire, QuestionnaireItem

KEYS = ["enter", "tab", "up", "down", "left", "right", "backspace", "home", "end", "pageup"]
KEYS += ["pagedown", "ctrl+d", "y", "n", "space", "x", "-", *"0123456789"]


@dataclass
class Sitting:
    """A round with what it has sent, and a clock that a test turns."""

    items: tuple[QuestionnaireItem, ...] = items_of(studied.SCALES)
    sent: list[AskAnswer | AskQuestionnaire] = field(default_factory=list)
    now: int = 0
    answers: dict[str, ItemAnswer] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.asked = OpenQuestionnaire(
            Questionnaire("robot", "You", items=self.items), self.answers
        )
        self.taken = QuestionnaireRun(self.asked, self.sent.append, lambda: self.now)

    def press(self, *keys: str, apart: float = 0.8) -> None:
        """Press keys, `apart` seconds from each other."""
        for key in keys:
            self.comes(key)
            self.now += round(apart * 1_000_000)

    def comes(self, key: str) -> None:
        """A key, as the sheet hands it on; a text is what has been answered before, or nothing."""
        if not self.taken.wants_text or key != "enter":
            self.taken.key(key)
        elif not self.taken.ignores(key):
            answer = self.taken.answer
            self.taken.write(answer.text if answer else "")

    def page(self) -> QuestionnairePage:
        return self.taken.page

    def value(self, item: str) -> int | None:
        answer = self.asked.answers.get(item)
        return None if answer is None else answer.value


def scale(low: int, high: int, *, optional: bool = False) -> Sitting:
    return Sitting(
        (
            QuestionnaireItem("one", "One?", low, high, optional=optional),
            QuestionnaireItem("two", "Two?", 1, 5),
        )
    )


def test_it_begins_with_an_introduction_and_goes_through_all_items() -> None:
    seat = Sitting()
    assert seat.page() is QuestionnairePage.INTRODUCTION
    seat.press("enter", "6", "1", "0", "enter", "4", "2", "enter")
    seat.taken.write("nothing else")
    assert seat.page() is QuestionnairePage.SUMMARY
    seat.press("enter")
    assert [type(sent).__name__ for sent in seat.sent] == ["AskAnswer"] * 4 + ["AskQuestionnaire"]
    values = [sent.value for sent in seat.sent if isinstance(sent, AskAnswer)]
    assert values == [6.0, 10.0, 42.0, None]
    last = seat.sent[-1]
    assert isinstance(last, AskQuestionnaire)
    assert last.what == "done"


def test_an_answer_is_timed_from_its_item_on() -> None:
    seat = Sitting()
    seat.now = 5_000_000
    seat.press("enter")
    seat.now = 7_300_000
    seat.press("3")
    sent = seat.sent[0]
    assert isinstance(sent, AskAnswer)
    assert sent.answered_us == 2_300_000


@pytest.mark.parametrize(
    ("low", "high", "keys", "value"),
    [
        (1, 7, "4", 4),
        (0, 10, ["7", "enter"], 7),
        (0, 10, ["1", "0", "enter"], 10),
        (0, 10, ["1", "enter"], 1),
        (1, 10, ["1", "backspace", "9", "enter"], 9),
        (0, 100, ["7", "enter"], 7),
        (0, 100, ["7", "3", "enter"], 73),
        (0, 100, ["1", "0", "0", "enter"], 100),
        (-3, 3, ["-", "2", "enter"], -2),
        (-3, 3, ["2", "enter"], 2),
        (-20, 20, ["-", "1", "enter"], -1),
        (1, 7, ["right", "right", "enter"], 2),
        (1, 7, ["left", "enter"], 7),
        (1, 7, ["end", "right", "enter"], 7),
        (0, 100, ["home", "pageup", "right", "enter"], 11),
    ],
)
def test_numbers_are_typed_or_reached_with_arrows(
    low: int, high: int, keys: str | list[str], value: int
) -> None:
    seat = scale(low, high)
    seat.press("enter", *keys)
    assert seat.value("one") == value
    assert seat.taken.position == 1


def many(count: int = 10) -> Sitting:
    """On the first of so many items that a digit answers."""
    seat = Sitting(tuple(QuestionnaireItem(f"item-{n}", "How?", 1, 7) for n in range(count)))
    seat.press("enter")
    return seat


@pytest.mark.parametrize("rate", [10.9, 25, 30, 1000])
def test_a_held_key_answers_one_item(rate: float) -> None:
    seat = many()
    seat.press(*"5" * 60, apart=1 / rate)
    assert (len(seat.sent), seat.taken.position, seat.taken.complaint) == (1, 1, "")


@pytest.mark.parametrize("delay", [0.25, 0.5, 0.66])
def test_the_first_repeat_answers_nothing_however_long_the_keyboard_waits(delay: float) -> None:
    seat = many()
    seat.press("5", apart=delay)
    seat.press(*"5" * 90, apart=1 / 30)
    assert (len(seat.sent), seat.taken.complaint) == (1, "")


def test_who_presses_the_same_key_too_soon_is_told_and_may_press_again() -> None:
    seat = many()
    seat.press("5", "5", apart=0.5)
    assert (len(seat.sent), seat.taken.complaint) == (1, ENGLISH.press_again)
    seat.now += HELD_US
    seat.press("5")
    assert (len(seat.sent), seat.taken.complaint) == (2, "")


def texts(count: int) -> tuple[QuestionnaireItem, ...]:
    return tuple(
        QuestionnaireItem(f"text-{n}", "Why?", text=True, optional=True) for n in range(count)
    )


def test_a_held_enter_does_not_leave_out_what_comes_behind_the_introduction() -> None:
    seat = Sitting(texts(2))
    seat.press("enter", apart=0.5)
    seat.press(*["enter"] * 60, apart=0.03)
    assert (seat.taken.position, seat.sent) == (0, [])


ITEMS = (
    *(QuestionnaireItem(f"scale-{n}", "How?", 1, 7, optional=n % 2 == 0) for n in range(3)),
    *(QuestionnaireItem(f"number-{n}", "How much?", 0, 100, optional=n % 2 == 0) for n in range(3)),
    *texts(3),
)
#: What is done with one finger: a key, for how many seconds it is held, and the pause behind it.
PRESSES = st.tuples(
    st.sampled_from([*"123457", "enter", "enter", "tab", "down", "up", "left", "right"]),
    st.one_of(st.floats(0.02, 0.2), st.floats(0.2, 2.5)),
    st.floats(0.05, 2),
)


@given(
    items=st.permutations(ITEMS),
    presses=st.lists(PRESSES, min_size=5, max_size=25),
    delay=st.floats(0.2, 0.66),
    rate=st.floats(10, 40),
)
def test_no_press_ever_answers_two_items(
    items: list[QuestionnaireItem],
    presses: list[tuple[str, float, float]],
    delay: float,
    rate: float,
) -> None:
    seat = Sitting(tuple(items))
    for key, held, pause in presses:
        sent, began = len(seat.sent), seat.now
        seat.comes(key)
        repeats = range(int((held - delay) * rate) + 1) if held >= delay else ()
        for repeat in repeats:
            seat.now = began + round((delay + repeat / rate) * 1_000_000)
            seat.comes(key)
        assert len(seat.sent) <= sent + 1
        seat.now = began + round((held + pause) * 1_000_000)


@given(
    presses=st.lists(
        st.tuples(st.sampled_from("1234567"), st.floats(0.76, 5)), min_size=1, max_size=12
    )
)
def test_every_deliberate_press_answers_its_item(presses: list[tuple[str, float]]) -> None:
    seat = many(len(presses))
    for digit, pause in presses:
        seat.press(digit, apart=pause)
    values = [sent.value for sent in seat.sent if isinstance(sent, AskAnswer)]
    assert values == [float(digit) for digit, _ in presses]


def test_a_fist_on_the_keys_answers_one_item() -> None:
    seat = many()
    seat.press(*"46", "enter", *"5394", apart=0.02)
    assert (seat.value("item-0"), len(seat.sent), seat.taken.complaint) == (4, 1, "")


def test_of_two_keys_that_are_hit_at_once_the_held_one_answers_nothing() -> None:
    seat = many()
    seat.press("4", apart=0.02)
    seat.press("6", apart=0.5)
    seat.press(*"6" * 40, apart=0.03)
    assert (seat.value("item-0"), len(seat.sent)) == (4, 1)


@pytest.mark.parametrize(("keys", "apart"), [("55", 0.76), ("26", 0.4)])
def test_two_deliberate_presses_answer_two_items(keys: str, apart: float) -> None:
    seat = many()
    seat.press(*keys, apart=apart)
    assert len(seat.sent) == 2
    assert seat.taken.position == 2


def test_a_held_key_may_be_followed_by_an_answer() -> None:
    seat = many()
    seat.press(*"5" * 30, apart=0.03)
    seat.now += SETTLING_US
    seat.press("2")
    assert (seat.value("item-0"), seat.value("item-1")) == (5, 2)


def test_only_digits_and_enter_wait() -> None:
    seat = many()
    seat.press("5", "up", apart=0)
    assert seat.taken.position == 0
    seat.press("down", "right", apart=0)
    assert (seat.taken.position, seat.taken.mark) == (1, 1)
    seat.press("ctrl+d", "n", "backspace", apart=0)
    assert (seat.page(), seat.taken.position) == (QuestionnairePage.ITEM, 0)


def test_a_held_key_does_not_finish_behind_the_last_item() -> None:
    seat = many(1)
    seat.press("5", "enter", apart=0.03)
    assert (seat.page(), len(seat.sent)) == (QuestionnairePage.SUMMARY, 1)


def test_an_enter_too_soon_keeps_the_reason_that_was_told_before() -> None:
    seat = many()
    seat.press("enter", "enter", apart=0.5)
    assert "from 1 to 7" in seat.taken.complaint


def test_a_number_of_two_digits_may_be_typed_as_fast_as_one_likes() -> None:
    seat = scale(0, 100)
    seat.press("enter", "7", "3", "enter", apart=0)
    assert seat.value("one") == 73


def test_a_number_that_is_not_on_the_scale_is_not_taken() -> None:
    seat = scale(1, 7)
    seat.press("enter", "9")
    assert seat.value("one") is None
    assert "from 1 to 7" in seat.taken.complaint
    seat.press("enter")
    assert seat.value("one") is None
    assert seat.sent == []


def test_only_what_is_optional_can_be_left_out() -> None:
    seat = scale(1, 7)
    seat.press("enter", "tab")
    assert "wants an answer" in seat.taken.complaint
    assert seat.sent == []
    seat = scale(1, 7, optional=True)
    seat.press("enter", "tab")
    sent = seat.sent[0]
    assert isinstance(sent, AskAnswer)
    assert (sent.skipped, sent.value) == (True, None)
    assert seat.taken.position == 1


def test_an_enter_too_many_leaves_nothing_out() -> None:
    seat = scale(1, 7, optional=True)
    seat.press("enter", "enter", "enter")
    assert (seat.taken.position, seat.sent) == (0, [])
    assert "tab leaves it out" in seat.taken.complaint


def test_an_empty_text_is_left_out_only_where_it_may_be() -> None:
    seat = Sitting(
        (
            QuestionnaireItem("why", "Why?", text=True),
            QuestionnaireItem("else", "Else?", text=True, optional=True),
        )
    )
    seat.press("enter")
    seat.taken.write("   ")
    assert seat.sent == []
    seat.taken.write(" because ")
    seat.taken.write("")
    first, second = seat.sent
    assert isinstance(first, AskAnswer)
    assert isinstance(second, AskAnswer)
    assert first.text == "because"
    assert second.skipped


def test_back_shows_the_answer_and_a_new_one_replaces_it() -> None:
    seat = scale(1, 7)
    seat.press("enter", "3", "up")
    assert (seat.taken.position, seat.taken.mark) == (0, 3)
    seat.press("down")
    assert seat.taken.position == 1
    seat.press("backspace", "5")
    assert seat.value("one") == 5
    assert [sent.value for sent in seat.sent if isinstance(sent, AskAnswer)] == [3.0, 5.0]


def test_nobody_goes_past_a_question_without_an_answer() -> None:
    seat = scale(1, 7)
    seat.press("enter", "down")
    assert seat.taken.position == 0
    assert seat.taken.complaint


def test_a_line_of_the_summary_is_changed_and_the_summary_comes_back() -> None:
    seat = scale(1, 7)
    seat.press("enter", "3", "4")
    assert seat.page() is QuestionnairePage.SUMMARY
    seat.press("up", "up", "enter")
    assert (seat.page(), seat.taken.position) == (QuestionnairePage.ITEM, 0)
    seat.press("7")
    assert seat.page() is QuestionnairePage.SUMMARY
    assert seat.value("one") == 7


def test_to_decline_is_asked_about_first() -> None:
    seat = scale(1, 7)
    seat.press("enter", "ctrl+d", "n")
    assert (seat.page(), seat.sent) == (QuestionnairePage.ITEM, [])
    seat.press("ctrl+d", "y")
    sent = seat.sent[0]
    assert isinstance(sent, AskQuestionnaire)
    assert sent.what == "declined"


def test_it_goes_on_where_it_was() -> None:
    seat = Sitting(answers={"pleasant": ItemAnswer(4), "again": ItemAnswer(skipped=True)})
    assert (seat.page(), seat.taken.position) == (QuestionnairePage.ITEM, 2)


def test_what_was_not_confirmed_goes_out_again_after_a_lost_line() -> None:
    seat = scale(1, 7)
    seat.press("enter", "3", "4")
    first, second = seat.sent
    assert isinstance(first, AskAnswer)
    seat.taken.confirmed(first)
    again = OpenQuestionnaire(seat.asked.questionnaire, {"one": ItemAnswer(3)})
    seat.taken.resume(again)
    assert seat.sent == [first, second, second]
    assert again.answers == {"one": ItemAnswer(3), "two": ItemAnswer(4)}


def test_a_refused_answer_opens_its_item_again() -> None:
    seat = scale(1, 7)
    seat.press("enter", "3")
    sent = seat.sent[0]
    assert isinstance(sent, AskAnswer)
    seat.taken.refused(sent, "no")
    assert (seat.taken.position, seat.taken.complaint, seat.value("one")) == (0, "no", None)


@given(st.lists(st.sampled_from(KEYS), max_size=60))
def test_no_keys_bring_it_off_its_way(keys: list[str]) -> None:
    seat = Sitting()
    for key in keys:
        if seat.taken.wants_text and key == "enter":
            seat.taken.write("words")
        else:
            seat.press(key)
        assert 0 <= seat.taken.position <= len(seat.items)
    by_name = {item.name: item for item in seat.items}
    for sent in seat.sent:
        if isinstance(sent, AskAnswer):
            item = by_name[sent.item]
            assert not sent.skipped or item.optional
            assert sent.value is None or item.low <= sent.value <= item.high
        elif sent.what == "done":
            open_items = [item for item in seat.items if item.name not in seat.asked.answers]
            assert not open_items
