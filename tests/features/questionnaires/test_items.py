"""Which items are asked, in which order, and what is stored of what somebody sees."""

from __future__ import annotations

from woz_tui.features.questionnaires.items import (
    ItemAnswer,
    arranged,
    as_shown,
    asked_items,
    said,
    shown_value,
    stored_value,
)
from woz_tui.protocol.welcome import ItemCondition, ItemLabel, Questionnaire, QuestionnaireItem

KNOWN = QuestionnaireItem(
    "known",
    kind="choice",
    choices=(ItemLabel(1, "yes"), ItemLabel(2, "no"), ItemLabel(3, "other")),
    other=3,
)
WHICH = QuestionnaireItem("which", only_if=ItemCondition("known", (1,)))
WHY = QuestionnaireItem("why", text=True, only_if=ItemCondition("which", at_least=3, at_most=5))
BRANCHES = (KNOWN, WHICH, WHY)


def names(**answers: ItemAnswer) -> list[str]:
    return [item.name for item in asked_items(BRANCHES, answers)]


def test_an_item_is_asked_after_the_answers_that_it_names() -> None:
    assert names() == ["known"]
    assert names(known=ItemAnswer(2)) == ["known"]
    assert names(known=ItemAnswer(1)) == ["known", "which"]
    assert names(known=ItemAnswer(1), which=ItemAnswer(2)) == ["known", "which"]
    assert names(known=ItemAnswer(1), which=ItemAnswer(3)) == ["known", "which", "why"]
    assert names(known=ItemAnswer(1), which=ItemAnswer(skipped=True)) == ["known", "which"]
    # Who changes the first answer is not asked any more what hangs on it.
    assert names(known=ItemAnswer(2), which=ItemAnswer(3)) == ["known"]


def test_chance_decides_the_order_within_groups_and_instructions() -> None:
    page = QuestionnaireItem("page", kind="page")
    items = [QuestionnaireItem(name, group="g" if name in "bc" else "") for name in "abcd"]
    more = [QuestionnaireItem(name) for name in "wxyz"]
    asked = Questionnaire("q", items=(*items, page, *more), shuffled=True)
    orders = set()
    for number in range(40):
        order = [item.name for item in arranged(asked, f"1/P01/q/{number}")]
        assert order == [item.name for item in arranged(asked, f"1/P01/q/{number}")]
        assert order.index("c") == order.index("b") + 1
        assert (order[4], {*order[:4]}) == ("page", {*"abcd"})
        orders.add((*order,))
    assert len(orders) > 10


def test_chance_decides_which_end_is_on_the_left() -> None:
    asked = Questionnaire("q", items=(QuestionnaireItem("a", ends=("fake", "natural"), flip=True),))
    sides = [arranged(asked, str(number))[0].flipped for number in range(40)]
    assert 10 < sum(sides) < 30


def test_what_is_stored_is_the_same_on_both_sides() -> None:
    item = QuestionnaireItem("a", "", -3, 3, ("fake", "natural"), shift=4)
    turned = QuestionnaireItem("a", "", -3, 3, ("fake", "natural"), shift=4, flipped=True)
    assert [shown_value(item, value) for value in (-3, 0, 3)] == [1, 4, 7]
    assert [shown_value(turned, value) for value in (-3, 0, 3)] == [7, 4, 1]
    assert [stored_value(turned, shown) for shown in (7, 4, 1)] == [-3, 0, 3]
    shown = as_shown(turned)
    assert (shown.low, shown.high, shown.ends) == (1, 7, ("natural", "fake"))
    assert said(turned, ItemAnswer(-3), "left out") == "7"


def test_an_answer_in_words() -> None:
    assert said(KNOWN, ItemAnswer(3, "a toy"), "") == "other: a toy"
    assert said(KNOWN, ItemAnswer(skipped=True), "left out") == "left out"
    hidden = QuestionnaireItem(
        "a", "", 1, 2, labels=(ItemLabel(1, "no"), ItemLabel(2, "yes")), numbers=False
    )
    assert said(hidden, ItemAnswer(2), "") == "yes"
    fits = QuestionnaireItem("a", does_not_apply="does not fit")
    assert said(fits, ItemAnswer(skipped=True, reason="does_not_apply"), "") == "does not fit"
