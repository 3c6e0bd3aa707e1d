"""Answers in tables: what they mean, why there is none, what is published of them."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import frictionless
import pytest
from msgspec.structs import replace

from tests.config.catalogue import CATALOGUE
from tests.export.export_runs import course_to
from tests.export.logs import Timed, start, write
from tests.export.test_bids import validated
from tests.export.test_csv import check_dictionary, package
from tests.protocol.examples import messages as examples
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import read_report
from woz_tui.config.loading import load
from woz_tui.features.questionnaires.in_session import _item_view
from woz_tui.features.questionnaires.items import arranged, wording
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.scales import GatheredScales, choice_table
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.protocol import messages as m

FILE = Path(__file__).parents[2] / "config" / "good" / "questionnaire-items.yaml"
#: By item; what is not here was skipped, and what is ruled out is not shown.
ANSWERS: dict[str, dict[str, Any]] = {
    "natural": {"value": 3.0},
    "effort": {"value": 35.0},
    "often": {"skipped": True, "reason": "does_not_apply"},
    "marked": {"value": 2.0},
    "known": {"value": 1.0},
    "which": {"ticked": [1, 6], "text": "Anna's mower"},
    "age": {"value": 31.0, "given": "own_terminal"},
    "since": {"text": "2026-11"},
    "words": {"text": "Anna was kind", "private": True},
    "hard": {"value": 20.0},
}


def course(reason: str = "done") -> list[Timed]:
    """A round in which a participant answers items of every kind."""
    (asked,) = QUESTIONNAIRES.of(load(FILE, CATALOGUE)).questionnaires
    plan = next(each for each in examples() if isinstance(each, m.SessionPlan))
    study = replace(plan.settings.study, questionnaires=[asked])
    items = arranged(asked, "7/P07/robot-ux/1")
    started = QuestionnaireStarted(
        questionnaire=asked.name,
        title=asked.title,
        items=[*map(_item_view, items)],
        language="en",
        given="read_aloud",
    )
    told = [
        QuestionnaireAnswered(
            **{
                "questionnaire": asked.name,
                "item": item.name,
                "question": wording(item),
                "given": "read_aloud",
                **ANSWERS[item.name],
            }
        )
        for item in items
        if item.name in ANSWERS
    ]
    ended = QuestionnaireEnded(questionnaire=asked.name, reason=reason, answered=len(told))
    return [
        (0, start()),
        (0, replace(plan, settings=replace(plan.settings, study=study))),
        (1, started),
        *((2 + n, each) for n, each in enumerate(told)),
        (60, ended),
    ]


def rows(out: Path, table: str) -> list[dict[str, str]]:
    with (out / f"{table}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def by_item(out: Path) -> dict[str, dict[str, str]]:
    return {row["item"]: row for row in rows(out, "questionnaires")}


def test_each_answer_says_what_it_means(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", course())
    check_dictionary(out)
    found = by_item(out)
    natural = found["natural"]
    assert [natural[name] for name in ("value", "low", "high")] == ["3", "-3", "3"]
    assert (natural["low_label"], natural["high_label"]) == ("fake", "natural")
    assert (natural["question"], natural["answer_label"]) == (
        "The robot was fake - natural",
        "natural",
    )
    assert found["marked"]["answer_label"] == "half"
    assert (found["known"]["value"], found["known"]["answer_label"]) == ("1", "yes")
    assert found["which"]["choices"] == "1;6"
    assert found["which"]["answer_label"] == "a vacuum cleaner, other: Anna's mower"
    assert found["since"]["text"] == "2026-11"
    assert (found["age"]["given"], found["hard"]["given"]) == ("own_terminal", "read_aloud")
    positions = [int(row["position"]) for row in found.values()]
    assert sorted(positions) == [*range(1, 12)]
    assert "page-1" not in found


def test_what_has_no_answer_says_why(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", course())
    missing = {name: row["missing"] for name, row in by_item(out).items() if row["missing"]}
    assert missing == {"often": "does_not_apply", "words": "private", "why": "not_shown"}


@pytest.mark.parametrize("reason", ["declined", "left"])
def test_what_was_not_reached_says_how_it_ended(tmp_path: Path, reason: str) -> None:
    out = course_to(tmp_path, "csv", [*course(reason)[:5], course(reason)[-1]])
    missing = [row["missing"] for row in by_item(out).values()]
    assert {*missing} - {"does_not_apply"} == {"", reason, "not_shown"}


def test_the_wide_table_is_typed_and_labelled(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", course())
    [row] = rows(out, "questionnaires_wide")
    assert (row["robot-ux.natural"], row["robot-ux.often"], row["robot-ux.why"]) == ("3", "", "")
    assert [row[f"robot-ux.which.{each}"] for each in (1, 5, 6)] == ["1", "0", "1"]
    assert row["robot-ux.which.other"] == "Anna's mower"
    [resource] = (
        each for each in package(out)["resources"] if each["name"] == "questionnaires_wide"
    )
    fields = {field["name"]: field for field in resource["schema"]["fields"]}
    natural = fields["robot-ux.natural"]
    assert (natural["type"], natural["title"]) == ("integer", "The robot was fake - natural")
    assert natural["constraints"] == {"minimum": -3, "maximum": 3}
    assert natural["categories"] == [
        {"value": -3, "label": "fake"},
        {"value": 3, "label": "natural"},
    ]
    assert fields["robot-ux.known"]["constraints"] == {"enum": [1, 2, 3]}
    assert fields["robot-ux.which.5"]["title"] == "Which ones?: a toy"
    assert fields["robot-ux.words"]["type"] == "string"


def test_the_codebook_comes_from_the_file(tmp_path: Path) -> None:
    """Of items that nobody has answered, too."""
    out = course_to(tmp_path, "csv", [*course()[:3], course()[-1]])
    book = {row["variable"]: row for row in rows(out, "codebook")}
    natural = book["robot-ux.natural"]
    assert (natural["labels"], natural["shown_offset"]) == ("fake = -3; natural = 3", "4")
    assert natural["other_languages"] == "de: Der Roboter war fake - natürlich"
    assert (natural["reverse"], natural["flip"], natural["shuffled"]) == ("true", "true", "true")
    assert book["robot-ux.often"]["missing"] == (
        "does_not_apply = does not fit; skipped; declined; left"
    )
    assert book["robot-ux.why"]["only_if"] == "hard >= 60"
    assert book["robot-ux.age"]["unit"] == "years"
    assert book["robot-ux.words"]["private"] == "true"


@pytest.mark.parametrize("to", ["csv", "bids", "jsonl", "mcap"])
def test_a_private_answer_is_in_no_export_unasked(tmp_path: Path, to: str) -> None:
    def said(out: Path) -> bool:
        return any(b"Anna was kind" in path.read_bytes() for path in out.rglob("*.*"))

    assert not said(course_to(tmp_path, to, course()))
    if to != "mcap":  # it is compressed
        assert said(course_to(tmp_path, to, course(), private=True))


def test_what_was_asked_may_be_published_and_what_was_said_not(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", course(), redact=True)
    check_dictionary(out)
    assert not any("Anna" in path.read_text(encoding="utf-8") for path in out.iterdir())
    found = by_item(out)
    assert found["natural"]["question"] == "The robot was fake - natural"
    assert (found["natural"]["low_label"], found["natural"]["value"]) == ("fake", "3")
    assert (found["known"]["answer_label"], found["known"]["item_type"]) == ("yes", "choice")
    assert found["since"]["text"] == "[redacted]"
    book = {row["variable"]: row for row in rows(out, "codebook")}
    assert book["robot-ux.known"]["labels"] == "yes = 1; no = 2; unsure = 3"
    assert book["robot-ux.why"]["only_if"] == "hard >= 60"
    log = course_to(tmp_path, "jsonl", course(), redact=True)
    text = "".join(path.read_text(encoding="utf-8") for path in log.glob("*.jsonl"))
    assert ("Anna" in text, "natürlich" in text, "does not fit" in text) == (False, True, True)


def test_bids_names_what_items_ask(tmp_path: Path) -> None:
    out = course_to(tmp_path, "bids", course())
    validated(out)
    [sidecar] = out.rglob("*_beh.json")
    said = json.loads(sidecar.read_text(encoding="utf-8"))
    assert (
        said["item"]["Levels"]["often"]
        == "The robot was listening to me (1 = never; 2 = seldom; 3 = often)"
    )
    assert {*said["missing"]["Levels"]} == {"does_not_apply", "private", "not_shown"}


def test_what_depends_on_a_private_answer_keeps_its_own(tmp_path: Path) -> None:
    told = [
        (t, replace(each, private=True))
        if isinstance(each, QuestionnaireAnswered) and each.item == "known"
        else (t, each)
        for t, each in course()
    ]
    found = by_item(course_to(tmp_path, "csv", told))
    assert (found["known"]["value"], found["known"]["missing"]) == ("", "private")
    assert (found["which"]["choices"], found["which"]["missing"]) == ("1;6", "")


@pytest.mark.parametrize("redact", [False, True])
@pytest.mark.parametrize("reason", ["done", "declined", "left"])
def test_frictionless_accepts_the_tables_of_every_kind_of_item(
    tmp_path: Path, reason: str, redact: bool
) -> None:
    """With their types, limits and labels, whether all was answered or next to nothing."""
    told = course() if reason == "done" else [*course(reason)[:6], course(reason)[-1]]
    out = course_to(tmp_path, "csv", told, redact=redact)
    report = frictionless.Package(str(out / "datapackage.json")).validate()
    assert report.flatten(["name", "rowNumber", "fieldName", "type", "message"]) == []
    assert {"questionnaires", "questionnaires_wide", "codebook"} <= {
        task.name for task in report.tasks
    }


def test_codes_of_choices_are_counted_and_have_no_mean(tmp_path: Path) -> None:
    """`yes` is 1 and `unsure` 3: a mean of 2 would be *no*."""
    for number, code in enumerate((1, 3, 3, None), start=1):
        who = f"P{number:02}"
        said = {"skipped": True, "reason": "prefer_not", "value": None}
        told = [
            (t, replace(each, **(said if code is None else {"value": float(code)})))
            if isinstance(each, QuestionnaireAnswered) and each.item == "known"
            else (t, start(who, f"S{number}") if isinstance(each, m.SessionStart) else each)
            for t, each in course()
        ]
        write(tmp_path, told, f"2026-03-0{number}T10-00-00_{who}_S{number}")
    grouped = GroupedSessions()
    for log in sorted(tmp_path.glob("*.jsonl")):
        if ".samples." not in log.name:
            grouped.add(read_report(log).figures)
    gathered = grouped.gathered["questionnaires"]
    assert isinstance(gathered, GatheredScales)
    [experiment] = grouped.experiments
    assert "known" not in [each.item for each in gathered.items(experiment)]
    assert [
        (each.label, each.chose, each.answered)
        for each in gathered.choices(experiment)
        if each.item == "known"
    ] == [("yes", 1, 3), ("no", 0, 3), ("unsure", 2, 3)]
    which = [each for each in gathered.choices(experiment) if each.item == "which"]
    assert [(each.label, each.chose) for each in which] == [
        ("a vacuum cleaner", 3), ("a toy", 0), ("other", 3),
    ]  # fmt: skip
    table = choice_table([], [*gathered.without_choice(experiment)])
    assert [list(row)[:4] for row in table.rows] == [
        ["robot-ux", "known", "no answer: prefer not to say", "1"]
    ], "who was not shown `which` did not leave it out"
