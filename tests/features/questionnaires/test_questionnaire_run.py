"""One way through a questionnaire, without a screen."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import study_scene
from woz_tui.console.input.keyboard import HELD_US
from woz_tui.features.questionnaires.answers import OpenQuestionnaire, items_of
from woz_tui.features.questionnaires.items import ItemAnswer
from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.features.questionnaires.run import SETTLING_US, QuestionnairePage, QuestionnaireRun
from woz_tui.protocol.welcome import ENGLISH, Questionnaire, QuestionnaireItem

KEYS = ["enter", "tab", "up", "down", "left", "right", "backspace", "home", "end", "pageup"]
KEYS += ["pagedown", "ctrl+d", "y", "n", "space", "x", "-", *"0123456789"]


@dataclass
class QuestionnaireRig:
    """A round with what it has sent, and a clock that a test turns."""

    items: tuple[QuestionnaireItem, ...] = items_of(study_scene.SCALES)
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


def scale(low: int, high: int, *, optional: bool = False) -> QuestionnaireRig:
    return QuestionnaireRig(
        (
            QuestionnaireItem("one", "One?", low, high, optional=optional),
            QuestionnaireItem("two", "Two?", 1, 5),
        )
    )


def test_it_begins_with_an_introduction_and_goes_through_all_items() -> None:
    rig = QuestionnaireRig()
    assert rig.page() is QuestionnairePage.INTRODUCTION
    rig.press("enter", "6", "1", "0", "enter", "4", "2", "enter")
    rig.taken.write("nothing else")
    assert rig.page() is QuestionnairePage.SUMMARY
    rig.press("enter")
    assert [type(sent).__name__ for sent in rig.sent] == ["AskAnswer"] * 4 + ["AskQuestionnaire"]
    values = [sent.value for sent in rig.sent if isinstance(sent, AskAnswer)]
    assert values == [6.0, 10.0, 42.0, None]
    last = rig.sent[-1]
    assert isinstance(last, AskQuestionnaire)
    assert last.what == "done"


def test_an_answer_is_timed_from_its_item_on() -> None:
    rig = QuestionnaireRig()
    rig.now = 5_000_000
    rig.press("enter")
    rig.now = 7_300_000
    rig.press("3")
    sent = rig.sent[0]
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
    rig = scale(low, high)
    rig.press("enter", *keys)
    assert rig.value("one") == value
    assert rig.taken.position == 1


def many(count: int = 10) -> QuestionnaireRig:
    """On the first of so many items that a digit answers."""
    rig = QuestionnaireRig(
        tuple(QuestionnaireItem(f"item-{n}", "How?", 1, 7) for n in range(count))
    )
    rig.press("enter")
    return rig


@pytest.mark.parametrize("rate", [10.9, 25, 30, 1000])
def test_a_held_key_answers_one_item(rate: float) -> None:
    rig = many()
    rig.press(*"5" * 60, apart=1 / rate)
    assert (len(rig.sent), rig.taken.position, rig.taken.complaint) == (1, 1, "")


@pytest.mark.parametrize("delay", [0.25, 0.5, 0.66])
def test_the_first_repeat_answers_nothing_however_long_the_keyboard_waits(delay: float) -> None:
    rig = many()
    rig.press("5", apart=delay)
    rig.press(*"5" * 90, apart=1 / 30)
    assert (len(rig.sent), rig.taken.complaint) == (1, "")


def test_who_presses_the_same_key_too_soon_is_told_and_may_press_again() -> None:
    rig = many()
    rig.press("5", "5", apart=0.5)
    assert (len(rig.sent), rig.taken.complaint) == (1, ENGLISH.press_again)
    rig.now += HELD_US
    rig.press("5")
    assert (len(rig.sent), rig.taken.complaint) == (2, "")


def texts(count: int) -> tuple[QuestionnaireItem, ...]:
    return tuple(
        QuestionnaireItem(f"text-{n}", "Why?", text=True, optional=True) for n in range(count)
    )


def test_a_held_enter_does_not_leave_out_what_comes_behind_the_introduction() -> None:
    rig = QuestionnaireRig(texts(2))
    rig.press("enter", apart=0.5)
    rig.press(*["enter"] * 60, apart=0.03)
    assert (rig.taken.position, rig.sent) == (0, [])


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
    rig = QuestionnaireRig(tuple(items))
    for key, held, pause in presses:
        sent, began = len(rig.sent), rig.now
        rig.comes(key)
        repeats = range(int((held - delay) * rate) + 1) if held >= delay else ()
        for repeat in repeats:
            rig.now = began + round((delay + repeat / rate) * 1_000_000)
            rig.comes(key)
        assert len(rig.sent) <= sent + 1
        rig.now = began + round((held + pause) * 1_000_000)


@given(
    presses=st.lists(
        st.tuples(st.sampled_from("1234567"), st.floats(0.76, 5)), min_size=1, max_size=12
    )
)
def test_every_deliberate_press_answers_its_item(presses: list[tuple[str, float]]) -> None:
    rig = many(len(presses))
    for digit, pause in presses:
        rig.press(digit, apart=pause)
    values = [sent.value for sent in rig.sent if isinstance(sent, AskAnswer)]
    assert values == [float(digit) for digit, _ in presses]


def test_a_fist_on_the_keys_answers_one_item() -> None:
    rig = many()
    rig.press(*"46", "enter", *"5394", apart=0.02)
    assert (rig.value("item-0"), len(rig.sent), rig.taken.complaint) == (4, 1, "")


def test_of_two_keys_that_are_hit_at_once_the_held_one_answers_nothing() -> None:
    rig = many()
    rig.press("4", apart=0.02)
    rig.press("6", apart=0.5)
    rig.press(*"6" * 40, apart=0.03)
    assert (rig.value("item-0"), len(rig.sent)) == (4, 1)


@pytest.mark.parametrize(("keys", "apart"), [("55", 0.76), ("26", 0.4)])
def test_two_deliberate_presses_answer_two_items(keys: str, apart: float) -> None:
    rig = many()
    rig.press(*keys, apart=apart)
    assert len(rig.sent) == 2
    assert rig.taken.position == 2


def test_a_held_key_may_be_followed_by_an_answer() -> None:
    rig = many()
    rig.press(*"5" * 30, apart=0.03)
    rig.now += SETTLING_US
    rig.press("2")
    assert (rig.value("item-0"), rig.value("item-1")) == (5, 2)


def test_only_digits_and_enter_wait() -> None:
    rig = many()
    rig.press("5", "up", apart=0)
    assert rig.taken.position == 0
    rig.press("down", "right", apart=0)
    assert (rig.taken.position, rig.taken.mark) == (1, 1)
    rig.press("ctrl+d", "n", "backspace", apart=0)
    assert (rig.page(), rig.taken.position) == (QuestionnairePage.ITEM, 0)


def test_a_held_key_does_not_finish_behind_the_last_item() -> None:
    rig = many(1)
    rig.press("5", "enter", apart=0.03)
    assert (rig.page(), len(rig.sent)) == (QuestionnairePage.SUMMARY, 1)


def test_an_enter_too_soon_keeps_the_reason_that_was_told_before() -> None:
    rig = many()
    rig.press("enter", "enter", apart=0.5)
    assert "from 1 to 7" in rig.taken.complaint


def test_a_number_of_two_digits_may_be_typed_as_fast_as_one_likes() -> None:
    rig = scale(0, 100)
    rig.press("enter", "7", "3", "enter", apart=0)
    assert rig.value("one") == 73


def test_a_number_that_is_not_on_the_scale_is_not_taken() -> None:
    rig = scale(1, 7)
    rig.press("enter", "9")
    assert rig.value("one") is None
    assert "from 1 to 7" in rig.taken.complaint
    rig.press("enter")
    assert rig.value("one") is None
    assert rig.sent == []


def test_only_what_is_optional_can_be_left_out() -> None:
    rig = scale(1, 7)
    rig.press("enter", "tab")
    assert "Please answer this question" in rig.taken.complaint
    assert rig.sent == []
    rig = scale(1, 7, optional=True)
    rig.press("enter", "tab")
    sent = rig.sent[0]
    assert isinstance(sent, AskAnswer)
    assert (sent.skipped, sent.value) == (True, None)
    assert rig.taken.position == 1


def test_an_enter_too_many_leaves_nothing_out() -> None:
    rig = scale(1, 7, optional=True)
    rig.press("enter", "enter", "enter")
    assert (rig.taken.position, rig.sent) == (0, [])
    assert "Tab to skip" in rig.taken.complaint


def test_an_empty_text_is_left_out_only_where_it_may_be() -> None:
    rig = QuestionnaireRig(
        (
            QuestionnaireItem("why", "Why?", text=True),
            QuestionnaireItem("else", "Else?", text=True, optional=True),
        )
    )
    rig.press("enter")
    rig.taken.write("   ")
    assert rig.sent == []
    rig.taken.write(" because ")
    rig.taken.write("")
    first, second = rig.sent
    assert isinstance(first, AskAnswer)
    assert isinstance(second, AskAnswer)
    assert first.text == "because"
    assert second.skipped


def test_back_shows_the_answer_and_a_new_one_replaces_it() -> None:
    rig = scale(1, 7)
    rig.press("enter", "3", "up")
    assert (rig.taken.position, rig.taken.mark) == (0, 3)
    rig.press("down")
    assert rig.taken.position == 1
    rig.press("backspace", "5")
    assert rig.value("one") == 5
    assert [sent.value for sent in rig.sent if isinstance(sent, AskAnswer)] == [3.0, 5.0]


def test_nobody_goes_past_a_question_without_an_answer() -> None:
    rig = scale(1, 7)
    rig.press("enter", "down")
    assert rig.taken.position == 0
    assert rig.taken.complaint


def test_a_line_of_the_summary_is_changed_and_the_summary_comes_back() -> None:
    rig = scale(1, 7)
    rig.press("enter", "3", "4")
    assert rig.page() is QuestionnairePage.SUMMARY
    rig.press("up", "up", "enter")
    assert (rig.page(), rig.taken.position) == (QuestionnairePage.ITEM, 0)
    rig.press("7")
    assert rig.page() is QuestionnairePage.SUMMARY
    assert rig.value("one") == 7


def test_to_decline_is_asked_about_first() -> None:
    rig = scale(1, 7)
    rig.press("enter", "ctrl+d", "n")
    assert (rig.page(), rig.sent) == (QuestionnairePage.ITEM, [])
    rig.press("ctrl+d", "y")
    sent = rig.sent[0]
    assert isinstance(sent, AskQuestionnaire)
    assert sent.what == "declined"


def test_it_goes_on_where_it_was() -> None:
    rig = QuestionnaireRig(answers={"pleasant": ItemAnswer(4), "again": ItemAnswer(skipped=True)})
    assert (rig.page(), rig.taken.position) == (QuestionnairePage.ITEM, 2)


def test_what_was_not_confirmed_goes_out_again_after_a_lost_line() -> None:
    rig = scale(1, 7)
    rig.press("enter", "3", "4")
    first, second = rig.sent
    assert isinstance(first, AskAnswer)
    rig.taken.confirmed(first)
    again = OpenQuestionnaire(rig.asked.questionnaire, {"one": ItemAnswer(3)})
    rig.taken.resume(again)
    assert rig.sent == [first, second, second]
    assert again.answers == {"one": ItemAnswer(3), "two": ItemAnswer(4)}


def test_a_refused_answer_opens_its_item_again() -> None:
    rig = scale(1, 7)
    rig.press("enter", "3")
    sent = rig.sent[0]
    assert isinstance(sent, AskAnswer)
    rig.taken.refused(sent, "no")
    assert (rig.taken.position, rig.taken.complaint, rig.value("one")) == (0, "no", None)


@given(st.lists(st.sampled_from(KEYS), max_size=60))
def test_no_keys_bring_it_off_its_way(keys: list[str]) -> None:
    rig = QuestionnaireRig()
    for key in keys:
        if rig.taken.wants_text and key == "enter":
            rig.taken.write("words")
        else:
            rig.press(key)
        assert 0 <= rig.taken.position <= len(rig.items)
    by_name = {item.name: item for item in rig.items}
    for sent in rig.sent:
        if isinstance(sent, AskAnswer):
            item = by_name[sent.item]
            assert not sent.skipped or item.optional
            assert sent.value is None or item.low <= sent.value <= item.high
        elif sent.what == "done":
            open_items = [item for item in rig.items if item.name not in rig.asked.answers]
            assert not open_items
