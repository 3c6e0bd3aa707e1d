"""Scores of questionnaires as files give them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from woz_tui.config.annotated_decoder import read_partly
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.fields import Doc, Entry, NotEmpty, OneOf, Range, Unique
from woz_tui.features.questionnaires.item_entries import NAME_PATTERN, ReadItem
from woz_tui.features.questionnaires.items import NUMBERS
from woz_tui.features.questionnaires.scoring import (
    HOWS,
    SUM,
    SUS,
    SUS_HIGH,
    SUS_ITEMS,
    SUS_LOW,
    WEIGHTED,
)
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import QuestionnaireScore


@dataclass(frozen=True, slots=True)
class OntoEntry(Entry):
    """A scale onto which a score is laid."""

    what = Sentence("questionnaires.scale_of_score", "a scale of a score")
    example = "{low: 0, high: 100}"
    low: Annotated[float, Range(-1000, 1000), Doc("what stands for the lowest score")]
    high: Annotated[float, Range(-1000, 1000), Doc("what stands for the highest score")]


@dataclass(frozen=True, slots=True)
class ScoreEntry(Entry):
    """What several items amount to, as a file gives it."""

    what = Sentence("questionnaires.a_score", "a score")
    example = "{items: [a, b, c], how: mean}"
    items: Annotated[
        tuple[str, ...],
        NotEmpty(),
        Unique(),
        Doc("names of items; those with reverse: true count from the other end"),
    ]
    how: Annotated[
        str,
        OneOf(HOWS),
        Doc("mean, sum, System Usability Scale (which reverses by itself), or mean by weights"),
    ] = "mean"
    weights: Annotated[
        dict[str, float] | None, Range(0, 1000), Doc("of a weighted one: each item's weight")
    ] = None
    pairs: Annotated[
        tuple[str, ...],
        Doc(
            "instead: names of choices between two items each, by their places in this score; an"
            " item weighs as often as it was chosen"
        ),
    ] = ()
    missing: Annotated[
        int, Range(0, 1000), Doc("so many items may be without an answer; with more, no score")
    ] = 0
    onto: Annotated[OntoEntry | None, Doc("another scale onto which it is laid")] = None


def read_scores(cursor: Cursor | None, items: Sequence[ReadItem]) -> tuple[QuestionnaireScore, ...]:
    """All scores of a questionnaire with these items; what is wrong has been reported."""
    table = (
        cursor.table(Sentence("questionnaires.scores", "scores by their names"))
        if cursor is not None
        else None
    )
    found = [_score(name, entry, items) for name, entry in (table or {}).items()]
    return tuple(score for score in found if score is not None)


def _score(name: str, cursor: Cursor, items: Sequence[ReadItem]) -> QuestionnaireScore | None:
    if not NAME_PATTERN.fullmatch(name):
        cursor.error(
            Sentence(
                "questionnaires.score_name",
                "the name of a score begins with a letter (a to z), and goes on with"
                " letters, digits, - and _; 40 characters at most",
            )
        )
    known = {item.name: item for item in items if item.name}
    if name in known:
        cursor.error(
            Sentence(
                "questionnaires.name_of_item",
                "is the name of an item already; give the score another name",
            )
        )
    read = read_partly(cursor, ScoreEntry)
    if read is None:
        return None
    table = dict(cursor.entries())
    numbers = [item.name for item in items if item.kind in NUMBERS]
    scored = [
        known[one]
        for one in _named(
            table.get("items"), known, numbers, Sentence("check.a_number", "a number")
        )
    ]
    score = _Checked(cursor, table, read, scored)
    score.check()
    choices = [item.name for item in items if item.kind == "choice"]
    for pair in _named(
        table.get("pairs"), known, choices, Sentence("questionnaires.a_choice", "a choice")
    ):
        if not {*known[pair].choices} <= {*range(1, len(read.items) + 1)}:
            table["pairs"].error(
                Sentence(
                    "questionnaires.codes_no_places",
                    "the codes of {pair} are no places in this score: write choices:"
                    " {{1: ..., 2: ...}}, from 1 to {number}",
                    pair=quoted(pair),
                    number=len(read.items),
                )
            )
    return QuestionnaireScore(
        name=name,
        how=read.how,
        items=read.items,
        reverse=tuple(item.name for item in scored if item.entry.reverse),
        weights=tuple((read.weights or {}).get(one, 0.0) for one in read.items)
        if read.weights is not None
        else (),
        pairs=read.pairs,
        missing=read.missing,
        onto=(read.onto.low, read.onto.high) if read.onto is not None else None,
    )


def _named(
    cursor: Cursor | None, known: Mapping[str, ReadItem], fitting: Collection[str], what: str
) -> Iterator[str]:
    """The items that are named here and fit; what is wrong with others has been reported."""
    for entry in cursor.items() if cursor is not None else ():
        name = getattr(entry.node, "text", "")
        if name in fitting:
            yield name
        elif name in known:
            entry.error(
                Sentence(
                    "questionnaires.answer_is_not",
                    "the answer to {name} is not {what}",
                    name=quoted(name),
                    what=what,
                )
            )
        elif name:
            near = (
                cursor.report.hint(name, fitting, or_list=Sentence("check.there_are", "there are"))
                if cursor
                else ""
            )
            entry.error(
                Sentence(
                    "questionnaires.no_item_called",
                    "no item is called {name}{near}",
                    name=quoted(name),
                    near=near,
                )
            )


@dataclass(frozen=True, slots=True)
class _Checked:
    """A score with the items that it really has."""

    cursor: Cursor
    table: Mapping[str, Cursor]
    read: ScoreEntry
    items: Sequence[ReadItem]

    def check(self) -> None:
        """Report what makes no score."""
        if self.read.items and self.read.missing >= len(self.read.items):
            self.table["missing"].error(
                Sentence(
                    "questionnaires.all_missing",
                    "then all may be missing, and there is nothing to score",
                )
            )
        if "how" in self.table and getattr(self.table["how"].node, "text", "") not in HOWS:
            return  # which has been said: what goes with it, nobody knows
        if len(self.items) == len(self.read.items):  # else it has been said what is wrong
            self._scales()
        self._weights()

    def _scales(self) -> None:
        scales = {(item.scale.low, item.scale.high, item.scale.shift) for item in self.items}
        texts = ", ".join(f"{low} to {high}" for low, high, _ in sorted(scales))
        onto = self.read.onto
        if self.read.how == SUS:
            self._sus(texts)
        elif len(scales) > 1 and self.read.how != SUM:
            self.table["items"].error(
                Sentence(
                    "questionnaires.different_scales",
                    "these items have different scales ({texts}), so that their mean"
                    " says nothing; score items with one scale, or take how: sum",
                    texts=texts,
                )
            )
        if onto is not None and onto.low >= onto.high:
            self.table["onto"].error(
                Sentence(
                    "questionnaires.goes_down",
                    "goes from {low:g} to {high:g}",
                    low=onto.low,
                    high=onto.high,
                )
            )
        elif onto is not None and (self.read.how == SUS or len(scales) > 1):
            self.table["onto"].error(
                Sentence(
                    "questionnaires.one_scale",
                    "needs items with one scale, and is not for how: sus",
                )
            )

    def _sus(self, texts: str) -> None:
        if len(self.items) != SUS_ITEMS or texts != f"{SUS_LOW} to {SUS_HIGH}":
            self.table["items"].error(
                Sentence(
                    "questionnaires.sus",
                    "the System Usability Scale has {wanted} items from {low} to {high},"
                    " not {number} with {texts}",
                    wanted=SUS_ITEMS,
                    low=SUS_LOW,
                    high=SUS_HIGH,
                    number=len(self.items),
                    texts=texts,
                )
            )
        for item in self.items:
            if item.entry.reverse:
                dict(item.cursor.entries())["reverse"].error(
                    Sentence(
                        "questionnaires.sus_reverses",
                        "the score {score} (how: sus) reverses every second item by itself;"
                        " leave this out",
                        score=self.cursor.path.rpartition(".")[2],
                    )
                )

    def _weights(self) -> None:
        weights, given = self.read.weights, [k for k in ("weights", "pairs") if k in self.table]
        if self.read.how != WEIGHTED:
            for key in given:
                self.table[key].error(
                    Sentence(
                        "questionnaires.not_weighted", "only a score with how: weighted has some"
                    )
                )
        elif len(given) != 1:
            self.cursor.error(
                Sentence(
                    "questionnaires.weights_or_pairs",
                    "a weighted score needs either weights: {{item: ...}} or pairs: [...]",
                )
            )
        elif weights is not None:
            other = [one for one in weights if one not in self.read.items]
            lacking = [one for one in self.read.items if one not in weights]
            for one in other:
                dict(self.table["weights"].entries())[one].error(
                    Sentence("questionnaires.not_of_score", "is no item of this score")
                )
            if lacking:
                self.table["weights"].error(
                    Sentence(
                        "questionnaires.weights_lack",
                        "there is none for {names}",
                        names=", ".join(lacking),
                    )
                )
            elif not math.fsum(weights.values()) > 0:
                self.table["weights"].error(
                    Sentence(
                        "questionnaires.weights_zero", "all are 0; some item must weigh something"
                    )
                )
