"""Slots in an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HEAD, errors, panel, read_experiment
from woz_tui.config.reload_changes import compare
from woz_tui.features.slots.section import SLOTS, Slot, slots_of

ASK = "{label: Ask, say: 'Do you like {colour}?'}"
SLOT = "slots: {colour: {offer: [red, blue], heard: true, keep: participant}}\n"


def test_slots_of_a_file(tmp_path: Path) -> None:
    experiment = read_experiment(tmp_path, panel(ASK) + SLOT)
    assert SLOTS.of(experiment) == {"colour": Slot(("red", "blue"), True, "participant")}
    assert [*SLOTS.summary(experiment)] == [
        (
            "slot colour",
            "'red', 'blue', a word that was heard, what is typed; kept for the participant;"
            " in 'Ask'",
        )
    ]
    assert not experiment.warnings
    other = read_experiment(tmp_path, panel(ASK) + SLOT.replace("red", "green"))
    assert compare(experiment, other).changes == ("slot 'colour' changed",)


def test_what_is_wrong_is_told_with_its_place(tmp_path: Path) -> None:
    for slots, told in (
        ("{color: {}}", "there is no variable {colour}; did you mean 'color'?"),
        ("{colour: {}, participant: {}}", "there is a variable 'participant' already"),
        ("{colour: {offer: ['a\\b']}}", "begins a tag of a voice"),
        ("{colour: {keep: ever}}", "keep"),
        ("{colour: {offer: [a, b, c, d, e, f, g, h, i, j]}}", "9 have a digit"),
    ):
        assert any(told in each for each in errors(tmp_path, panel(ASK) + f"slots: {slots}\n")), (
            told
        )


LIKE = "conditions: [warm, cold]\nvariables: {like: {warm: 'a {colour} one', cold: 'one'}}\n"


@pytest.mark.parametrize(
    ("say", "warm", "cold"),
    [
        ("'{{So}} {like}?'", ("{{So}} a {colour} one?",), ("{{So}} one?",)),
        ("{any: ['{like}?', Hm]}", ("a {colour} one?", "Hm"), ("one?", "Hm")),
        ("{warm: 'W {like}', cold: 'C {like}'}", ("W a {colour} one",), ("C one",)),
    ],
)
def test_in_a_variable_by_condition_it_is_asked_for_in_every_condition(
    tmp_path: Path, say: str, warm: tuple[str, ...], cold: tuple[str, ...]
) -> None:
    text = panel(f"{{label: Ask, say: {say}}}", head=HEAD + LIKE) + SLOT
    experiment = read_experiment(tmp_path, text)
    (action,) = experiment.panels[0].actions
    (call,) = action.calls
    assert call.choices["text"].texts == {"warm": warm, "cold": cold}
    assert slots_of(action, SLOTS.of(experiment)) == ("colour",)


def test_where_something_else_decides_such_a_variable_cannot_stand(tmp_path: Path) -> None:
    say = "{by: visitor.age_group, child: 'Well, {like}?', else: Hm}"
    text = panel(f"{{label: Ask, say: {say}}}", head=HEAD + LIKE) + SLOT + "engagement: {}\n"
    [wrong] = errors(tmp_path, text)
    assert "{like} has another text in each condition" in wrong
    assert "here visitor.age_group decides: write its words out" in wrong


def test_a_repair_cannot_have_one_and_one_without_a_sentence_is_odd(tmp_path: Path) -> None:
    [wrong] = errors(tmp_path, panel(ASK) + SLOT + "repairs: {yes: 'Yes, {colour}!'}\n")
    assert "'yes' cannot have a slot: its key plays it at once" in wrong
    text = panel("{label: Hi, say: Hello}") + "slots: {colour: {}}\n"
    [odd] = read_experiment(tmp_path, text).warnings
    assert odd.message == "no sentence has {colour}"


def test_where_nobody_can_be_asked_a_warning_says_who(tmp_path: Path) -> None:
    text = panel(ASK) + "phases: [{name: talk, on_enter: Ask}]\nslots: {colour: {}}\n"
    [odd] = read_experiment(tmp_path, text).warnings
    assert odd.message.startswith("'Ask' is refused when the phase 'talk' begins, unless {colour}")
    text = panel(ASK) + "engagement: {on_enter: {PersonDetected: Ask}}\nslots: {colour: {}}\n"
    said = [each.message for each in read_experiment(tmp_path, text).warnings]
    assert any("when the engagement model enters PersonDetected" in each for each in said), said
