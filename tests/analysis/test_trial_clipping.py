"""What lasts is clipped to trials wherever a trial's or condition's figure is computed; what was
outside of trials, and in one that was aborted, is in no mean.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time
from tests.export.export_runs import export_logs
from tests.features.questionnaires.scales import scale_totals
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.study_figures import Studies
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m

ON = m.EngagementAdopted(settings={"start": "run"})


def trial(
    session: ExampleSession, number: int, condition: str, when: tuple[float, float]
) -> ExampleSession:
    """A trial that was done, unless it was shorter than 5 s."""
    begin, end = when
    session.add(begin, m.TrialStarted(trial=number, condition=condition))
    outcome = "done" if end - begin >= 5 else "aborted"
    return session.add(end, m.TrialEnded(trial=number, outcome=outcome))


def study() -> ExampleSession:
    """Two trials with a questionnaire between them, and one of 3 s that was aborted. Somebody is
    engaged from 15 to 65 s.
    """
    session = ExampleSession(condition="").add(0, ON).state(15, "Wait", "EngagedWithKnown")
    trial(session, 1, "warm", (10, 20)).act(11).act(19)
    session.add(21, QuestionnaireStarted(questionnaire="ux", title="UX", items=[])).act(25)
    session.add(38, QuestionnaireEnded(questionnaire="ux", reason="done", answered=0))
    trial(session, 2, "cold", (40, 43)).act(41).act(42).act(42.5)
    trial(session, 2, "cold", (50, 80)).act(51)
    return session.state(65, "EngagedWithKnown", "PersonDetected").end(90)


def session_figures(session: ExampleSession, *, all_trials: bool = False) -> SessionFigures:
    return figures_of(in_time(session), FigureOptions(all_trials=all_trials))


def tables(session: ExampleSession, folder: Path) -> dict[str, list[dict[str, str]]]:
    with table_files(folder) as files:
        files.add(session_figures(session))
    return read_tables(folder)


def read_tables(folder: Path) -> dict[str, list[dict[str, str]]]:
    return {
        path.stem: list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
        for path in folder.glob("*.csv")
    }


def test_time_between_trials_and_in_questionnaires_is_a_row_of_its_own() -> None:
    parts = [
        (part.condition, part.scope, part.us // SECOND) for part in session_figures(study()).parts
    ]
    assert parts == [("warm", "trials", 10), ("cold", "trials", 30), ("", "outside", 90 - 43)]
    assert [part.acts for part in session_figures(study()).parts] == [2, 1, 1]


def test_an_episode_that_spans_conditions_is_clipped_in_figures_and_tables(tmp_path: Path) -> None:
    figures = session_figures(study())
    lengths = {
        part.condition: [us // SECOND for us in part.engagement.episodes.values]
        for part in figures.parts
    }
    assert lengths == {"warm": [5], "cold": [15], "": [7, 20]}
    assert [us // SECOND for us in figures.whole.engagement.episodes.values] == [22, 25], (
        "in all there is one, but for the trial that was aborted"
    )
    rows = tables(study(), tmp_path)
    [whole] = [row for row in rows["episodes"] if row["state"] == "engaged"]
    assert (whole["condition"], float(whole["onset"]), float(whole["duration"])) == ("warm", 15, 50)
    pieces = [row for row in rows["engagement"] if row["state"] == "EngagedWithKnown"]
    assert [(row["trial"], float(row["duration"]), row["counted"]) for row in pieces] == [
        ("1", 5, "true"),
        ("", 20, "false"),
        ("2", 3, "false"),
        ("", 7, "false"),
        ("2", 15, "true"),
    ]


def test_a_session_without_trials_has_no_time_outside() -> None:
    session = ExampleSession().act(1).add(5, m.SessionChanged(condition="cold")).act(8).end(20)
    parts = [
        (part.condition, part.scope, part.us // SECOND) for part in session_figures(session).parts
    ]
    assert parts == [("warm", "session", 5), ("cold", "session", 15)]


def means(*, all_trials: bool) -> dict[str, dict[str, float | None]]:
    grouped = GroupedSessions()
    grouped.add(session_figures(study(), all_trials=all_trials))
    names = ("duration", "wizard_actions", "wizard_actions_per_minute")
    return {
        total.condition: {name: total.values[name].mean for name in names}
        for total in grouped.totals("guide.yaml")
    }


def test_an_aborted_trial_is_in_no_mean_unless_somebody_wants_it() -> None:
    warm = {"duration": 10, "wizard_actions": 2, "wizard_actions_per_minute": 12}
    cold = {"duration": 30, "wizard_actions": 1, "wizard_actions_per_minute": 2}
    assert means(all_trials=False) == {"warm": warm, "cold": cold}
    every = {"duration": 33, "wizard_actions": 4, "wizard_actions_per_minute": 7.2727}
    assert means(all_trials=True)["cold"] == pytest.approx(every, rel=1e-3)


def test_every_table_says_what_means_leave_out(tmp_path: Path) -> None:
    session = study()
    session.messages = in_time(session)
    export_logs(session.written(tmp_path / "in"), "csv", tmp_path / "out")
    rows = read_tables(tmp_path / "out")
    actions = [row for row in rows["events"] if row["kind"] == "action"]
    assert [row["counted"] == "true" for row in actions] == [
        *(True, True, False, False, False, False, True)
    ]
    assert [(row["trial"], row["counted"]) for row in rows["trials"]] == [
        *(("1", "true"), ("2", "false"), ("2", "true"))
    ]
    assert [(row["scope"], row["counted"]) for row in rows["conditions"]] == [
        *(("trials", "true"), ("trials", "true"), ("outside", "false"))
    ]


def test_a_paper_counts_what_was_done_in_trials() -> None:
    studies = Studies()
    studies.add(session_figures(study()))
    [facts] = studies.found.values()
    text = " ".join(each for paragraph in paragraphs(facts) for each in paragraph.sentences)
    assert "3 actions were asked for" in text
    assert "time outside of trials" in text


def answers(*conditions: str) -> list[tuple[str, str, Any]]:
    """A cue 2 s before the end of trial 1, and an act 1 s after the next trial has begun."""
    session = ExampleSession(condition=conditions[0])
    trial(session, 1, conditions[0], (10, 20)).speech(16, 18)
    trial(session, 2, conditions[-1], (21, 40)).act(22)
    return [
        (cue.condition, cue.result, cue.reaction_us)
        for cue in session_figures(session.end(50)).cues
    ]


def test_what_is_done_in_the_next_trial_answers_no_cue_of_this_one() -> None:
    assert answers("warm", "cold") == [("warm", "cut", None)]
    assert answers("warm", "warm") == [("warm", "cut", None)]


def test_an_answer_to_a_questionnaire_in_an_aborted_trial_is_in_no_mean() -> None:
    item = {"name": "liked", "question": "?", "low": 1, "high": 7}
    session = ExampleSession().add(10, m.TrialStarted(trial=1, condition="warm"))
    session.add(11, QuestionnaireStarted(questionnaire="ux", title="UX", items=[item]))
    session.add(
        12, QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=2.0)
    )
    session.add(14, m.TrialEnded(trial=1, outcome="aborted")).end(20)
    for all_trials, count in ((False, 0), (True, 1)):
        grouped = GroupedSessions()
        grouped.add(session_figures(session, all_trials=all_trials))
        assert len(scale_totals(grouped, "guide.yaml")) == count
