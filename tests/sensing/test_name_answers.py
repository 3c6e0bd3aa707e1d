"""Answers in eight languages, written for the purpose, with the name that is to be read from each.

A table, `name_answers.tsv`: language, answer, name (empty: there is none). Many answers are what
people say to a robot that has asked for something else, or nothing.
"""

from __future__ import annotations

import csv
from collections import Counter
from pathlib import Path

import pytest

from woz_tui.sensing.answer_parsing import LANGUAGES, NameAnswerParser

ANSWERS = NameAnswerParser(("yes", "yeah", "right", "ok"), ("no", "nope", "wrong"))
HERE = Path(__file__).parent
#: Shares: of the answers from which a name is read that nobody said; of the names that are missed.
WRONG, MISSED = 0.01, 0.03


def table() -> list[dict[str, str]]:
    with (HERE / "name_answers.tsv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


@pytest.mark.parametrize("told", [str, str.lower], ids=["as written", "without capitals"])
def test_hardly_any_name_is_read_that_nobody_said(told: type[str]) -> None:
    rows = table()
    read = [(row, ANSWERS.read(told(row["answer"])).name) for row in rows]
    wrong = [
        (row["answer"], name)
        for row, name in read
        if name and name.casefold() != row["name"].casefold()
    ]
    missed = [row["answer"] for row, name in read if row["name"] and not name]
    named = sum(bool(row["name"]) for row in rows)
    assert len(wrong) <= WRONG * len(rows), wrong
    assert len(missed) <= MISSED * named, missed


def test_each_language_has_its_share_of_the_table() -> None:
    rows = table()
    assert len(rows) >= 300
    counted = Counter(row["language"] for row in rows)
    assert counted.keys() == LANGUAGES.keys()
    assert min(counted.values()) >= 30


@pytest.mark.parametrize("said", ["{}", "My name is {}.", "Hallo, ich bin {}.", "je suis {}"])
def test_no_everyday_word_is_a_first_name(said: str) -> None:
    names = (HERE / "first_names.txt").read_text("utf-8").split()
    missed = [name for name in names if ANSWERS.read(said.format(name)).name != name]
    assert len(missed) <= 0.005 * len(names), missed


@pytest.mark.parametrize("said", ["My name is {}.", "Mein Name ist {}", "Mi chiamo {}."])
@pytest.mark.parametrize(
    "name", ["Bella", "Misty", "Dina", "Winter", "Sunny", "Clemente", "Paul Ehrlich"]
)
def test_an_everyday_word_with_a_capital_is_a_name_where_only_names_stand(
    name: str, said: str
) -> None:
    assert ANSWERS.read(said.format(name)).name == name
    assert ANSWERS.read("My name is I do not know.").name == ""
    assert ANSWERS.read("Mein Name ist nicht wichtig.").name == ""
    assert ANSWERS.read("my name is sunny").name == ""
