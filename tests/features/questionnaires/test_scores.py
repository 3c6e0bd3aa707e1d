"""Scores of what was answered: in one session, in tables, and over participants."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

import msgspec
import pytest
from msgspec.structs import replace

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from tests.protocol.examples import messages as examples
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.export.redaction import redacted
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.scales import GatheredScales
from woz_tui.protocol import messages as m
from woz_tui.protocol.codec import decode_message, decode_unknown, encode
from woz_tui.protocol.welcome import (
    ItemLabel,
    Questionnaire,
    QuestionnaireItem,
    QuestionnaireScore,
)

WARM = Questionnaire(
    "ux",
    when="trial",
    items=tuple(QuestionnaireItem(name, f"{name}?", 1, 7) for name in ("a", "b", "c")),
    scores=(
        QuestionnaireScore("warmth", "mean", ("a", "b", "c"), reverse=("c",), missing=1),
        QuestionnaireScore("total", "sum", ("a", "b")),
        QuestionnaireScore("percent", "mean", ("a", "b"), onto=(0, 100)),
    ),
)
LOAD = Questionnaire(
    "load",
    items=(
        QuestionnaireItem("x", "x?", 0, 100, kind="slider"),
        QuestionnaireItem("y", "y?", 0, 100, kind="slider"),
        *(
            QuestionnaireItem(
                name, "?", kind="choice", choices=(ItemLabel(1, "x"), ItemLabel(2, "y"))
            )
            for name in ("p1", "p2", "p3")
        ),
    ),
    scores=(QuestionnaireScore("load", "weighted", ("x", "y"), pairs=("p1", "p2", "p3")),),
)
CHECK = Questionnaire("check", items=(QuestionnaireItem("who", "Who?"),), role="suspicion")


def planned(asked: Iterable[Questionnaire]) -> m.SessionPlan:
    plan = next(each for each in examples() if isinstance(each, m.SessionPlan))
    study = replace(plan.settings.study, questionnaires=[*asked])
    return replace(plan, settings=replace(plan.settings, study=study))


def answered(
    session: ExampleSession,
    at: float,
    asked: Questionnaire,
    given: Mapping[str, float | None],
    trial: int = -1,
) -> None:
    """One round; None: left out on purpose."""
    items: list[dict[str, m.Json]] = [
        {"name": item.name, "question": item.question, "low": item.low, "high": item.high}
        for item in asked.items
    ]
    session.add(
        at, QuestionnaireStarted(questionnaire=asked.name, title="", items=items, trial=trial)
    )
    for item, value in given.items():
        session.add(
            at + 1,
            QuestionnaireAnswered(
                questionnaire=asked.name,
                item=item,
                question=f"{item}?",
                value=value,
                skipped=value is None,
            ),
        )
    ended = QuestionnaireEnded(questionnaire=asked.name, answered=len(given), reason="done")
    session.add(at + 2, ended)


def played(who: str, *rounds: tuple[str, Mapping[str, float | None]]) -> SessionFigures:
    """A trial in each condition, with the first questionnaire behind it."""
    session = ExampleSession(participant=who, condition="", session=f"S{who[1:]}")
    session.add(0, planned([WARM, LOAD, CHECK]))
    for number, (condition, given) in enumerate(rounds, start=1):
        at = 100.0 * number
        session.add(at + 1, m.TrialStarted(trial=number, condition=condition)).act(at + 10)
        session.add(at + 60, m.TrialEnded(trial=number, outcome="done"))
        answered(session, at + 70, WARM, given, number)
    return figures_of(in_time(session.end(2000)))


def scores_of(figures: SessionFigures) -> dict[str, float | None]:
    return {row.score: row.value for row in asked_in(figures).scores}


def test_scores_of_a_round() -> None:
    found = scores_of(played("P01", ("warm", {"a": 6, "b": 5, "c": 2})))
    assert found["warmth"] == pytest.approx((6 + 5 + 6) / 3)
    assert found["total"] == 11
    assert found["percent"] == pytest.approx((5.5 - 1) / 6 * 100)


def test_too_few_answers_are_no_score() -> None:
    found = scores_of(played("P01", ("warm", {"a": 6, "b": None, "c": 2})))
    assert found == {"warmth": 6, "total": None, "percent": None}
    assert scores_of(played("P01", ("warm", {"a": 6})))["warmth"] is None


def test_weights_are_what_the_participant_chose() -> None:
    session = ExampleSession(participant="P01").add(0, planned([LOAD])).act(5)
    given = {"x": 80.0, "y": 20.0, "p1": 1.0, "p2": 1.0, "p3": 2.0}
    answered(session, 10, LOAD, given)
    answered(session, 20, LOAD, {name: value for name, value in given.items() if name != "p3"})
    whole, half = asked_in(figures_of(in_time(session.end(100)))).scores
    assert whole.value == pytest.approx((2 * 80 + 20) / 3)
    assert [item.weight for item in whole.items] == [2, 1]
    assert half.value is None, "nobody knows the weights"


def test_a_suspicion_check_is_of_no_condition() -> None:
    session = ExampleSession(participant="P01", condition="warm").add(0, planned([CHECK])).act(5)
    answered(session, 10, CHECK, {"who": 3})
    [answer] = asked_in(figures_of(in_time(session.end(100)))).answers
    assert (answer.condition, answer.participant) == ("", "P01")


def test_tables_have_the_score_and_how_each_item_counts(tmp_path: Path) -> None:
    with table_files(tmp_path) as files:
        files.add(played("P01", ("warm", {"a": 6, "b": None, "c": 2})))

    def rows(name: str) -> list[dict[str, str]]:
        with (tmp_path / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            return [*csv.DictReader(file)]

    warmth, total, _ = rows("questionnaire_scores")
    wanted = ("participant", "condition", "score", "how", "value", "low", "high", "missing")
    assert [warmth[name] for name in wanted] == [
        "P01",
        "warm",
        "warmth",
        "mean",
        "6",
        "1",
        "7",
        "1",
    ]
    assert [total[name] for name in ("value", "low", "high", "items")] == ["", "2", "14", "2"]
    items = [row for row in rows("questionnaire_score_items") if row["score"] == "warmth"]
    assert [[row[name] for name in ("item", "raw", "scored", "reversed")] for row in items] == [
        *(["a", "6", "6", "false"], ["b", "", "", "false"], ["c", "2", "6", "true"]),
    ]


def test_the_wide_table_has_scores_and_a_codebook_says_how_they_are_made(tmp_path: Path) -> None:
    with table_files(tmp_path) as files:
        files.add(played("P01", ("warm", {"a": 6, "b": 5, "c": 2})))

    def rows(name: str) -> list[dict[str, str]]:
        with (tmp_path / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            return [*csv.DictReader(file)]

    [wide] = rows("questionnaires_wide")
    assert [wide[name] for name in ("ux.a", "ux.c", "ux.total")] == ["6", "2", "11"]
    warmth, *others = rows("codebook_scores")
    assert len(others) == 2, "of what was asked alone"
    assert {name: text for name, text in warmth.items() if text} == {
        "variable": "ux.warmth",
        "version": "1",
        "questionnaire": "ux",
        "score": "warmth",
        "how": "mean",
        "items": "a, b, c",
        "reversed": "c",
        "may_be_missing": "1",
        "low": "1",
        "high": "7",
    }


def test_scores_are_the_same_without_words() -> None:
    session = ExampleSession(participant="P01").add(0, planned([WARM, LOAD, CHECK])).act(5)
    answered(session, 10, WARM, {"a": 6, "b": 5, "c": 2})
    answered(session, 20, LOAD, {"x": 80, "y": 20, "p1": 1, "p2": 1, "p3": 2})
    course = in_time(session.end(100))
    published = [
        decode_message(msgspec.json.encode(redacted(decode_unknown(encode(message)))))
        for message in course
    ]
    plain = asked_in(figures_of(course)).scores
    assert asked_in(figures_of(published)).scores == plain
    assert len(plain) == 4


def gathered(*sessions: SessionFigures) -> tuple[GatheredScales, GroupedSessions, str]:
    found = GroupedSessions()
    for figures in sessions:
        found.add(figures)
    scales = found.gathered["questionnaires"]
    assert isinstance(scales, GatheredScales)
    [experiment] = found.experiments
    return scales, found, experiment


def test_scores_are_compared_between_conditions() -> None:
    scales, found, experiment = gathered(
        played("P01", ("warm", {"a": 6, "b": 6, "c": 2}), ("sober", {"a": 3, "b": 3, "c": 5})),
        played("P02", ("warm", {"a": 5, "b": 5, "c": 3}), ("sober", {"a": 4, "b": 4, "c": 4})),
        played(
            "P03", ("warm", {"a": 7, "b": 7, "c": 1}), ("sober", {"a": 2, "b": None, "c": None})
        ),
    )
    means = {
        (each.score, each.condition): (each.total.mean, each.total.n)
        for each in scales.scores(experiment)
    }
    # Two of three items are missing once.
    assert [means["warmth", condition] for condition in ("warm", "sober")] == [(6, 3), (3.5, 2)]
    outcome = next(
        each for each in scales.outcomes(experiment, {}) if each.name.name == "ux.warmth"
    )
    missing = {each.condition: each.missing for each in outcome.summaries()}
    assert missing == {"warm": {}, "sober": {"items missing": 1}}
    table = next(scales.tables(experiment, found.totals(experiment)))
    assert [*table.rows[0]][:3] == ["ux", "warmth", "1 to 7"]
    assert table.rows[0][-1] == "-", "three participants say nothing of how items go together"


def test_how_items_go_together_is_of_the_first_round_of_ten() -> None:
    sessions = [
        played(
            f"P{n:02}",
            ("warm", {"a": 1 + n % 7, "b": 1 + (n + n % 2) % 7, "c": 7 - n % 7}),
            ("sober", {"a": 4, "b": 4, "c": 4}),
        )
        for n in range(10)
    ]
    scales, _, experiment = gathered(*sessions)
    told = {each.score: each.reliability for each in scales.scores(experiment)}
    assert told["warmth"] is not None
    assert (told["warmth"].name, told["warmth"].n) == ("Cronbach's alpha", 10)
    assert told["total"] is not None
    assert told["total"].name == "Spearman-Brown"


def test_a_mean_of_several_answers_is_no_point_of_the_scale() -> None:
    scales, _, experiment = gathered(
        *(played(f"P0{n}", ("warm", {"a": n, "b": n + 1, "c": 7})) for n in range(1, 5))
    )
    outcome = next(
        each for each in scales.outcomes(experiment, {}) if each.name.name == "ux.warmth"
    )
    assert outcome.summaries()[0].counts == []
