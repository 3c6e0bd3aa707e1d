"""What was asked once, of people who had several conditions, is about none of them."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from tests.features.questionnaires.scales import scale_totals
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.scales import item_tables
from woz_tui.protocol import messages as m

PERSON, LIKED = "Was it a person?", "I liked it"


def asked(session: ExampleSession, at: float, question: str, value: float, trial: int = -1) -> None:
    """A questionnaire of one item, behind this trial (-1: behind none)."""
    name, about = ("end", "person") if question == PERSON else ("ux", "liked")
    item: dict[str, m.Json] = {"name": about, "question": question, "low": 1, "high": 5}
    started = QuestionnaireStarted(questionnaire=name, title="", items=[item], trial=trial)
    answer = QuestionnaireAnswered(
        questionnaire=name, item=about, question=question, value=value, answered_us=1
    )
    session.add(at, started).add(at + 1, answer)
    session.add(at + 2, QuestionnaireEnded(questionnaire=name, answered=1, reason="done"))


def played(participant: str, conditions: list[str], person: int) -> SessionFigures:
    """A trial in each condition with a question behind it, and one at the end of all."""
    session = ExampleSession(participant=participant, condition="", session=f"S{participant[1:]}")
    for place, condition in enumerate(conditions):
        at = 100.0 * place
        session.add(at + 1, m.TrialStarted(trial=place + 1, condition=condition)).act(at + 10)
        session.add(at + 60, m.TrialEnded(trial=place + 1, outcome="done"))
        asked(session, at + 70, LIKED, 3, place + 1)
    asked(session, 500, PERSON, person)
    session.end(510)
    return figures_of(in_time(session))


def test_what_is_asked_at_the_end_is_of_no_condition(tmp_path: Path) -> None:
    found = GroupedSessions()
    with table_files(tmp_path) as files:
        for who, conditions, person in (
            *(("P01", ["warm", "sober"], 2), ("P02", ["warm", "sober"], 2)),
            ("P03", ["sober", "warm"], 3),
        ):
            figures = played(who, conditions, person)
            found.add(figures)
            files.add(figures)
    [experiment] = found.experiments
    by_condition, once = item_tables(scale_totals(found, experiment), found.totals(experiment))
    assert list(by_condition.heads[3:5]) == ["sober", "warm"]
    assert [row[1] for row in by_condition.rows] == ["liked"]
    assert once.title == "Asked once, about no condition (n = 3)"
    assert list(once.heads[3:4]) == ["all"]
    [[_, item, scale, mean, _]] = once.rows
    assert (item, scale, mean) == ("person", "1 to 5", "2.33 (0.577) n=3")
    for name in ("questionnaires", "questionnaires_wide"):
        with (tmp_path / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["questionnaire"] == "end"]
        assert [row["condition"] for row in rows] == [""] * 3


def test_who_had_one_condition_answers_about_it_at_the_end_too() -> None:
    figures = played("P01", ["warm"], 4)
    assert {answer.condition for answer in asked_in(figures).answers} == {"warm"}


def test_a_study_without_conditions_has_one_table() -> None:
    found = GroupedSessions()
    found.add(played("P01", ["", ""], 4))
    [experiment] = found.experiments
    [table] = item_tables(scale_totals(found, experiment), found.totals(experiment))
    assert [row[1] for row in table.rows] == ["liked", "person"]


def test_rounds_say_whose_they_are_and_what_was_asked() -> None:
    first, second, last = asked_in(played("P01", ["warm", "sober"], 4)).rounds
    assert [first.condition, second.condition, last.condition] == ["warm", "sober", ""]
    assert (last.participant, last.asked, last.counted) == ("P01", ("person",), True)
