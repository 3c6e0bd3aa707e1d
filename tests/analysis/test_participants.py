"""Who counts: neither the time before a participant nor a code that was corrected at once."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from tests.analysis.example_sessions import SECOND, STEM, ExampleSession, figures_of, in_time
from tests.analysis.html.pages import render
from tests.features.questionnaires.scales import scale_totals
from woz_tui.analysis import figures_json
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import ReportExtras, read_report
from woz_tui.analysis.study_figures import Studies, StudyFacts
from woz_tui.cli.report_layout import report_page
from woz_tui.cli.report_sessions import show_sessions
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered, QuestionnaireStarted
from woz_tui.protocol import messages as m

MARKER = m.Marker(text="x", source="key")


def chosen(session: ExampleSession, seconds: float, participant: str) -> ExampleSession:
    return session.add(seconds, m.SessionChanged(participant=participant, condition="warm"))


def late() -> ExampleSession:
    """20 s of trying out with an act, a cue and a mistake; then P70 for a second, then P07."""
    session = (
        ExampleSession(participant="", condition="")
        .act(2)
        .add(3, m.Mistake(run="a00001"))
        .add(5, MARKER)
    )
    chosen(session, 20, "P70")
    chosen(session, 21, "P07").add(30, MARKER).act(31).act(40)
    return session.end(81)


def session_figures(session: ExampleSession) -> SessionFigures:
    return figures_of(in_time(session))


def grouped_sessions(*sessions: SessionFigures) -> GroupedSessions:
    found = GroupedSessions()
    for figures in sessions:
        found.add(figures)
    return found


def facts(*sessions: SessionFigures) -> StudyFacts:
    studies = Studies()
    for figures in sessions:
        studies.add(figures)
    return next(iter(studies.found.values()))


def text(*sessions: SessionFigures) -> str:
    return " ".join(
        sentence for each in paragraphs(facts(*sessions)) for sentence in each.sentences
    )


def counting(figures: SessionFigures) -> list[tuple[str, bool]]:
    return [(part.participant, part.counted) for part in figures.parts]


def test_nobody_and_a_slip_have_rows_that_do_not_count() -> None:
    figures = session_figures(late())
    assert counting(figures) == [("", False), ("P70", False), ("P07", True)]
    assert (figures.participant, figures.participants) == ("P07", ("P07",))
    # The session as such has everything.
    assert (figures.whole.acts, figures.whole.mistakes, figures.whole.us) == (3, 1, 81 * SECOND)


def test_totals_are_of_those_who_took_part() -> None:
    found = grouped_sessions(session_figures(late()))
    assert len(found.of("guide.yaml")) == 3
    [warm] = found.totals("guide.yaml")
    assert (warm.condition, warm.participants, warm.rows) == ("warm", 1, 1)
    acts, length = warm.values["wizard_actions"], warm.values["duration"]
    assert (acts.n, acts.mean, acts.sd) == (1, 2.0, None)
    assert (length.n, length.mean) == (1, 60.0)
    assert warm.values["cues_missed"].mean == 0
    [told_so] = figures_json.grouped(found)[0]["conditions"]
    assert (told_so["participants"], told_so["values"]["wizard_actions"]["n"]) == (1, 1)


def test_the_sentences_are_of_those_who_took_part() -> None:
    found = text(session_figures(late()))
    assert found.startswith(
        "In all, 1 participant took part in 1 session of 1.0 min. The condition warm had 1"
    )
    assert "In all, 2 actions were asked for" in found
    assert "Of 2 wizard actions, 0 (0.0 %) were marked as mistakes." in found
    assert "Of 1 cue that needed an answer, the wizard answered 1" in found
    assert "No participant was recorded" not in found
    assert "left out" not in found


def briefly(seconds: float) -> ExampleSession:
    """P70 for so long, then P07."""
    return chosen(ExampleSession(participant="P70"), seconds, "P07").act(50).end(60)


@pytest.mark.parametrize(("seconds", "counts"), [(9.9, False), (10.0, True)])
def test_who_was_there_for_ten_seconds_took_part(seconds: float, counts: bool) -> None:
    assert counting(session_figures(briefly(seconds)))[0] == ("P70", counts)


ITEM = {"name": "liked", "question": "?", "low": 1, "high": 7}
ANSWERED = (
    QuestionnaireStarted(questionnaire="ux", title="UX", items=[ITEM]),
    QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=4.0),
)
SPOT = m.Command(command="c9", verb="say", args={"text": "x"}, driver="robot", source="key")
TRIAL = (m.TrialStarted(trial=1), m.TrialEnded(trial=1, outcome="aborted"))


@pytest.mark.parametrize("done", [(MARKER,), ANSWERED, (SPOT,), TRIAL])
def test_who_did_something_in_a_moment_took_part(done: tuple[m.Message, ...]) -> None:
    assert session_figures(briefly(2).add(1, *done)).participants == ("P70", "P07")


@pytest.mark.parametrize("source", ["program", "engagement"])
def test_what_the_robot_did_by_itself_makes_nobody_a_participant(source: str) -> None:
    figures = session_figures(briefly(2).act(1, source=source))
    assert figures.participants == ("P07",)
    assert facts(figures).outcomes["done"] == 1


def test_a_moment_counts_with_what_came_later_of_the_same_person() -> None:
    session = chosen(chosen(ExampleSession(), 2, "P08"), 4, "P07").act(20).end(30)
    assert counting(session_figures(session)) == [("P07", True), ("P08", False)]


def test_sessions_that_are_run_without_codes_count_each() -> None:
    sessions = [
        session_figures(ExampleSession(participant="", session=name).act(1).end(5))
        for name in ("S01", "S02")
    ]
    assert [counting(each) for each in sessions] == [[("", True)], [("", True)]]
    [warm] = grouped_sessions(*sessions).totals("guide.yaml")
    assert (warm.participants, warm.values["wizard_actions"].n) == (2, 2)
    found = text(*sessions)
    assert "There were 2 sessions" in found
    assert "No participant was recorded in 2 sessions." in found
    assert "In all, 2 actions were asked for" in found


def test_answers_without_codes_are_told_apart_by_session_too() -> None:
    sessions = [
        session_figures(ExampleSession(participant="", session=name).add(1, *ANSWERED).end(60))
        for name in ("A", "B")
    ]
    [item] = scale_totals(grouped_sessions(*sessions), "guide.yaml")
    assert item.total.n == 2


def test_answers_of_nobody_are_in_no_mean() -> None:
    session = ExampleSession(participant="").add(1, *ANSWERED)
    assert (
        scale_totals(
            grouped_sessions(session_figures(chosen(session, 20, "P07").end(60))), "guide.yaml"
        )
        == []
    )


def test_a_trial_of_nobody_is_not_counted_out() -> None:
    session = chosen(ExampleSession(participant="").add(1, *TRIAL), 20, "P07").end(60)
    assert facts(session_figures(session)).trials == 0


def test_a_session_in_which_nobody_took_part_is_left_out() -> None:
    deserted = session_figures(ExampleSession(participant="P70").end(3))
    found = grouped_sessions(deserted)
    assert deserted.participant == "P70"
    assert found.totals("guide.yaml") == []
    assert len(found.of("guide.yaml")) == 1
    assert text(deserted) == (
        "The logs contain no session with a participant. "
        "One session without a participant was left out."
    )
    both = text(deserted, session_figures(ExampleSession().act(1).end(60)))
    assert both.startswith("In all, 1 participant took part in 1 session of 1.0 min.")
    assert "One session without a participant was left out." in both


def test_tables_say_what_counts(tmp_path: Path) -> None:
    with table_files(tmp_path) as folder:
        folder.add(session_figures(late()))

    def column(sheet: str, *names: str) -> list[tuple[str, ...]]:
        rows = csv.DictReader((tmp_path / f"{sheet}.csv").read_text(encoding="utf-8").splitlines())
        return [tuple(row[name] for name in names) for row in rows]

    assert column("conditions", "participant", "counted") == [
        *(("", "false"), ("P70", "false"), ("P07", "true"))
    ]
    assert column("cues", "participant", "counted") == [("", "false"), ("P07", "true")]


def test_the_terminal_names_what_is_in_no_total() -> None:
    stream = io.StringIO()
    show_sessions(report_page(stream, 80), grouped_sessions(session_figures(late())))
    found = " ".join(stream.getvalue().split())
    assert "1 session, 1 participant" in found
    assert "Excluded: time before a participant was set, P70 (less than 10 s" in found
    assert "warm (n = 1)" in found
    assert "none (n" not in found
    stream = io.StringIO()
    show_sessions(
        report_page(stream, 80),
        grouped_sessions(session_figures(ExampleSession(participant="P70").end(3))),
    )
    assert "By condition" not in stream.getvalue()


def test_the_page_names_what_is_in_no_total(tmp_path: Path) -> None:
    late().written(tmp_path)
    session = ExampleSession(participant="P09", session="S02").act(1).end(60)
    session.written(tmp_path, STEM.replace("P07_S01", "P09_S02"))
    paths = sorted(tmp_path.glob("*.jsonl"))
    found = render(
        [read_report(path, extras=ReportExtras(timeline=True), places=[]) for path in paths]
    )
    assert ">no participant</bdi></a><small> (excluded)</small>" in found
    assert ">P70</bdi></a><small> (excluded)</small>" in found
    assert ">P09</bdi></a></th>" in found
    assert "(n = 2)" in found
    assert "none (n" not in found


def test_a_page_of_sessions_without_anybody_has_no_means(tmp_path: Path) -> None:
    for name in ("S01", "S02"):
        ExampleSession(session=name).end(3).written(tmp_path, STEM.replace("S01", name))
    paths = sorted(tmp_path.glob("*.jsonl"))
    found = render(
        [read_report(path, extras=ReportExtras(timeline=True), places=[]) for path in paths]
    )
    assert "By participant and condition" in found
    assert "By condition" not in found


@pytest.mark.parametrize(
    ("source", "verb"), [("midi", "control"), ("replay", "control"), ("engagement", "eyes")]
)
def test_what_only_passes_is_no_mistake_of_an_act(source: str, verb: str) -> None:
    passing = m.Command(command="k", verb=verb, args={}, driver="robot", source=source)
    session = (
        ExampleSession().act(1).add(2, passing, m.Mistake(run="k")).add(3, m.Mistake(run="a00001"))
    )
    assert passing.passing
    figures = session_figures(session.end(60))
    assert (figures.whole.acts, figures.whole.mistakes, figures.whole.mistake_rate) == (1, 1, 1.0)
