"""Many sessions: rows by participant and condition, totals over participants, CSV, sentences."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path

import pytest

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time, study
from tests.features.questionnaires.scales import scale_totals
from woz_tui.analysis import figures_json
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.measures import MEASURES
from woz_tui.analysis.participant_groups import ConditionRow, GroupedSessions, totals
from woz_tui.analysis.session_reading import read_report
from woz_tui.analysis.tables import rounded
from woz_tui.cli.report_layout import report_page
from woz_tui.cli.report_sessions import show_sessions
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.scales import item_tables
from woz_tui.protocol import messages as m
from woz_tui.system.text_cleaning import cell


def sessions(folder: Path) -> list[SessionFigures]:
    return [read_report(path, places=[]).figures for path in study(folder)]


def grouped_sessions(folder: Path) -> GroupedSessions:
    found = GroupedSessions()
    for figures in sessions(folder):
        found.add(figures)
    return found


def test_one_row_for_each_participant_and_condition(tmp_path: Path) -> None:
    found = grouped_sessions(tmp_path)
    assert found.experiments == ["guide.yaml"]
    assert [
        (row.participant, row.condition, row.session, row.values["reaction_median_s"])
        for row in found.of("guide.yaml")
    ] == [
        ("P01", "cold", "S02", 2.0),
        ("P01", "warm", "S01", 2.0),
        ("P02", "cold", "S04", 4.0),
        ("P02", "warm", "S03", 5.0),
    ]


def test_totals_are_over_participants(tmp_path: Path) -> None:
    cold, warm = grouped_sessions(tmp_path).totals("guide.yaml")
    assert (cold.condition, cold.participants, cold.rows) == ("cold", 2, 2)
    reaction = warm.values["reaction_median_s"]
    assert (reaction.n, reaction.mean) == (2, 3.5)
    assert reaction.sd == pytest.approx(4.5**0.5)
    assert cold.values["cues_missed"].mean == 0.5
    assert cold.values["engaged_share"].n == 0


def test_somebody_with_two_sessions_counts_once() -> None:
    def row(who: str, value: float | None) -> ConditionRow:
        return ConditionRow("x", who, "c", "S", {measure.name: value for measure in MEASURES})

    [total] = totals([row("P01", 1.0), row("P01", 3.0), row("P02", 6.0), row("P03", None)])
    acts = total.values["wizard_actions"]
    assert (total.participants, total.rows) == (3, 4)
    assert (acts.n, acts.mean) == (2, 4.0)
    assert acts.sd == pytest.approx(8.0**0.5)


def test_experiments_are_kept_apart(tmp_path: Path) -> None:
    found = grouped_sessions(tmp_path)
    found.add(figures_of(in_time(ExampleSession(experiment="C:\\lab\\other.yaml").act(1).end(2))))
    assert found.experiments == ["guide.yaml", "other.yaml"]
    assert len(found.of("other.yaml")) == 1
    assert found.versions("guide.yaml") == 1


def answered_questionnaire(
    who: str, condition: str, *values: float | None, high: int = 7, question: str = "I liked it"
) -> SessionFigures:
    item = {"name": "liked", "question": question, "low": 1, "high": high}
    session = ExampleSession(participant=who, condition=condition)
    for place, value in enumerate(values):
        session.add(place, QuestionnaireStarted(questionnaire="ux", title="UX", items=[item]))
        session.add(
            place,
            QuestionnaireAnswered(
                questionnaire="ux", item="liked", question=question, value=value,
                skipped=value is None,
            ),
        )  # fmt: skip
    return figures_of(in_time(session.end(60)))


def rerun_session() -> ExampleSession:
    """A re-run: it has no code."""
    session = ExampleSession(session="S09", participant="")
    return session.add(1, m.RerunStarted(original="x", original_session="S01")).speech(2, 3).end(9)


def test_re_runs_are_no_sessions_of_participants(tmp_path: Path) -> None:
    found = GroupedSessions()
    with table_files(tmp_path) as folder:
        for session in (rerun_session(), ExampleSession().speech(1, 2).act(3).end(9)):
            figures = figures_of(in_time(session))
            found.add(figures)
            folder.add(figures)
    assert [row.session for row in found.rows] == ["S01"]
    assert (found.reruns, found.sessions) == (["S09"], 2)
    rows = tables(tmp_path)
    assert [row["rerun_of"] for row in rows["sessions"]] == ["x", ""]
    for name in ("conditions", "cues"):
        counted = {(row["session"], row["counted"]) for row in rows[name]}
        assert counted == {("S09", "false"), ("S01", "true")}
    for name in ("actions", "wizards", "latencies"):  # nobody played anything in the re-run
        counted = {(row["session"], row["counted"]) for row in rows[name]}
        assert counted == {("S01", "true")}


def test_scales_have_means_over_participants() -> None:
    found = GroupedSessions()
    found.add(answered_questionnaire("P01", "warm", 4.0, 6.0))
    found.add(answered_questionnaire("P02", "warm", 7.0, None))
    found.add(answered_questionnaire("P03", "cold", None))
    [item] = scale_totals(found, "guide.yaml")
    assert (item.item, item.condition, item.low, item.high) == ("liked", "warm", 1.0, 7.0)
    assert (item.total.n, item.total.mean) == (2, 6.0)


def test_a_scale_that_was_changed_has_a_mean_of_its_own() -> None:
    found = GroupedSessions()
    found.add(answered_questionnaire("P01", "warm", 5.0, high=5))
    found.add(answered_questionnaire("P02", "warm", 6.0))
    assert [
        (item.high, item.total.n, item.total.mean) for item in scale_totals(found, "guide.yaml")
    ] == [*((5.0, 1, 5.0), (7.0, 1, 6.0))]


def test_a_question_whose_words_were_changed_is_told() -> None:
    found = GroupedSessions()
    found.add(answered_questionnaire("P01", "warm", 5.0))
    found.add(answered_questionnaire("P02", "warm", 6.0, question="I did not like it"))
    found.add(answered_questionnaire("P03", "cold", 6.0))
    cold, warm = scale_totals(found, "guide.yaml")
    assert (warm.total.n, cold.total.n) == (2, 1)
    assert warm.wordings == cold.wordings == ("I liked it", "I did not like it")
    [row] = next(item_tables([warm, cold], found.totals("guide.yaml"))).rows
    assert row[-1] == "I liked it / I did not like it"
    stream = io.StringIO()
    show_sessions(report_page(stream, 80), found)
    assert "words of ux.liked" in stream.getvalue()


def test_figures_can_be_said_in_json(tmp_path: Path) -> None:
    figures = sessions(tmp_path)[0]
    told = json.loads(json.dumps(figures_json.plain(figures), allow_nan=False))
    assert told["whole"]["main"]["reaction_median_s"] == 2.0
    assert told["whole"]["press"]["n"] == 2
    assert told["cues"][0]["reaction_us"] == SECOND
    [experiment] = json.loads(
        json.dumps(figures_json.grouped(grouped_sessions(tmp_path)), allow_nan=False)
    )
    assert experiment["conditions"][0]["values"]["wizard_actions"]["mean"] == 1.0


# -- CSV ------------------------------------------------------------------------------------------


def tables(folder: Path) -> dict[str, list[dict[str, str]]]:
    return {
        path.stem: list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
        for path in folder.glob("*.csv")
    }


@pytest.fixture
def written(tmp_path: Path) -> dict[str, list[dict[str, str]]]:
    with table_files(tmp_path / "csv") as folder:
        for figures in sessions(tmp_path / "logs"):
            folder.add(figures)
        folder.add(answered_questionnaire("P09", "warm", 4.0, None))
    return tables(tmp_path / "csv")


def test_rows_are_tidy(written: dict[str, list[dict[str, str]]]) -> None:
    rows = written["conditions"]
    assert [(row["participant"], row["condition"]) for row in rows] == [
        *(("P01", "warm"), ("P01", "cold"), ("P02", "warm"), ("P02", "cold"), ("P09", "warm"))
    ]
    assert [row["reaction_median_s"] for row in rows] == ["2", "2", "5", "4", ""]
    assert [(row["session"], row["damage"]) for row in written["sessions"]][:4] == [
        (f"S0{number}", "") for number in range(1, 5)
    ]
    cues = [(row["result"], row["response_time"].rstrip("0.")) for row in written["cues"]]
    assert cues == [
        *(("answered", "1"), ("answered", "3"), ("answered", "2"), ("missed", "")),
        *(("answered", "5"), ("answered", "4")),
    ]
    assert written["actions"][0]["total"] == "2"
    assert written["latencies"][0]["dispatch_median_ms"] == "1"
    assert written["latencies"][0]["perform_median_s"] == "0.499"


def test_answers_are_long_and_wide(written: dict[str, list[dict[str, str]]]) -> None:
    assert [(row["item"], row["value"], row["skipped"]) for row in written["questionnaires"]] == [
        ("liked", "4", "false"),
        ("liked", "", "true"),
    ]
    assert [row["ux.liked"] for row in written["questionnaires_wide"]] == ["4", ""]


def test_answers_say_whether_means_include_them(tmp_path: Path) -> None:
    def asked(session: ExampleSession, seconds: float, value: float) -> None:
        asks = QuestionnaireStarted(questionnaire="ux", title="UX", items=[])
        answer = QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=value)
        session.add(seconds, asks, answer)
        session.add(seconds, QuestionnaireEnded(questionnaire="ux", reason="done", answered=1))

    session = ExampleSession(participant="")
    asked(session, 1, 1.0)
    session.add(2, m.SessionChanged(participant="P07")).add(
        3, m.TrialStarted(trial=1, condition="warm")
    )
    asked(session, 4, 2.0)
    session.add(20, m.TrialEnded(trial=1, outcome="aborted"))
    asked(session, 21, 3.0)
    figures = figures_of(in_time(session.end(60)))
    found = GroupedSessions()
    found.add(figures)
    with table_files(tmp_path) as folder:
        folder.add(figures)
    rows = tables(tmp_path)
    assert [item.total.mean for item in scale_totals(found, "guide.yaml")] == [3.0]
    answers = [(row["value"], row["counted"]) for row in rows["questionnaires"]]
    assert answers == [("1", "false"), ("2", "false"), ("3", "true")]
    wide = [(row["ux.liked"], row["counted"]) for row in rows["questionnaires_wide"]]
    assert wide == answers
    every = GroupedSessions()
    every.add(figures_of(in_time(session), FigureOptions(all_trials=True)))
    assert [item.total.mean for item in scale_totals(every, "guide.yaml")] == [2.5]


def test_cells() -> None:
    assert [cell(rounded(value)) for value in (None, True, 2.0, 0.1234567894, 3)] == [
        *("", "true", "2", "0.123456789", "3")
    ]


_FORMULA = '=HYPERLINK("http://e.x";"click")'


def formulas(text: str) -> list[str]:
    """Cells that a spreadsheet would take for a formula."""
    rows = csv.reader(text.splitlines())
    return [value for row in rows for value in row if re.match(r"[=+@]|-(?![0-9.]+$)", value)]


def test_no_text_is_a_formula_to_a_spreadsheet(tmp_path: Path) -> None:
    session = ExampleSession(participant=_FORMULA, condition=_FORMULA, session=_FORMULA)
    session.add(0.5, m.TrialStarted(trial=1, condition=_FORMULA)).speech(1, 2).act(
        3, _FORMULA, _FORMULA
    )
    answer = QuestionnaireAnswered(
        questionnaire=_FORMULA, item="+i", question=_FORMULA, text=_FORMULA, answered_us=1
    )
    session.add(4, answer).add(5, m.TrialEnded(trial=1, outcome="done", text=_FORMULA)).end(6)
    with table_files(tmp_path) as folder:
        folder.add(figures_of(in_time(session)))
    files = [path.read_text(encoding="utf-8") for path in tmp_path.glob("*.csv")]
    assert any(f"'{_FORMULA}".replace('"', '""') in text for text in files)
    assert not [found for text in files for found in formulas(text)]


def test_tables_are_for_their_owner_only_as_logs_are(tmp_path: Path) -> None:
    before = tmp_path / "tables" / "sessions.csv"
    before.parent.mkdir()
    before.touch(0o644)
    with table_files(before.parent) as folder:
        folder.add(figures_of(in_time(ExampleSession().act(1).end(2))))
    assert {path.stat().st_mode & 0o777 for path in before.parent.iterdir()} == {0o600}


def test_texts_with_commas_and_lines_stay_in_their_cell(tmp_path: Path) -> None:
    session = ExampleSession().add(1, m.Marker(text='a, "b"\nc', source="wizard")).act(2).end(3)
    with table_files(tmp_path) as folder:
        folder.add(figures_of(in_time(session)))
    text = (tmp_path / "cues.csv").read_text(encoding="utf-8")
    [row] = csv.DictReader(text.splitlines(keepends=True))
    assert re.sub(r"\s+", " ", row["label"]) == 'a, "b" c'
