"""What reports and exports make of trainings."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time
from tests.analysis.html.pages import render
from tests.analysis.html.sessions import SessionLogBuilder, ordinary
from tests.export.export_runs import export_logs
from tests.export.logs import session_of, start, write
from woz_tui.analysis import figures_json
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.report_tables import circumstances
from woz_tui.analysis.study_figures import Studies
from woz_tui.features.training.figures import TrainingFigures
from woz_tui.features.training.kinds import CueAnswered, CueGiven, TrainingChanged
from woz_tui.protocol import messages as m


def session_figures(session: ExampleSession) -> SessionFigures:
    return figures_of(in_time(session))


def counted(figures: SessionFigures) -> TrainingFigures:
    found: TrainingFigures = figures.features["training"]
    return found


def training() -> ExampleSession:
    """As `woz train` has it: a code and a condition, so that their sentences can be said."""
    cue_given = CueGiven(cue="q", sort="leave", expects=["Nod"], window_us=SECOND)
    right = CueAnswered(cue="q", judged="right", reaction_us=500_000)
    session = ExampleSession(session="T01", participant="TRAINING", condition="warm")
    session.add(0.5, TrainingChanged(state="runs", planned=1))
    return session.add(1, cue_given, right).speech(2, 3).act(4).end(9)


def test_its_cues_are_judged_by_the_training() -> None:
    session = ExampleSession()
    for number, judged in enumerate(("right", "wrong", "missed", "right")):
        cue = f"q{number}"
        session.add(
            number * 10 + 1,
            CueGiven(cue=cue, sort="question", expects=["Hello"], window_us=4 * SECOND),
        )
        reaction = -1 if judged == "missed" else (number + 1) * 100_000
        session.add(
            number * 10 + 3,
            CueAnswered(cue=cue, judged=judged, action="Hello", reaction_us=reaction),
        )
    session.add(50, CueAnswered(cue="", judged="uncalled", action="Nod"))
    session.add(51, CueGiven(cue="q9", sort="leave", expects=["Nod"], window_us=SECOND)).end(60)
    figures = session_figures(session)
    found = counted(figures)
    assert (found.cues, found.right, found.wrong, found.missed) == (5, 2, 1, 1)
    assert (found.uncalled, found.score) == (1, 0.4)
    assert [us / 1e6 for us in found.times.values] == [0.1, 0.2, 0.4]
    assert [cue.result for cue in figures.cues] == [
        *("answered", "answered", "missed", "answered", "cut")
    ]
    assert "all" not in figures.whole.reactions
    [sentence] = circumstances(figures)
    assert sentence.startswith("training: 2 of 5 cues answered correctly (40.0 %), 1 wrongly, 1")


def test_a_session_without_one_has_none() -> None:
    figures = session_figures(ExampleSession().act(1).end(2))
    assert "training" not in figures.features
    assert figures_json.plain(figures)["training"] is None


def test_one_whose_cues_became_void_is_one() -> None:
    session = ExampleSession().add(
        1, CueGiven(cue="q1", sort="question", expects=[], window_us=4_000_000)
    )
    found = counted(session_figures(session.add(2, CueAnswered(cue="q1", judged="void")).end(9)))
    assert (found.cues, found.score) == (0, None)


def test_it_is_no_session_of_a_participant(tmp_path: Path) -> None:
    grouped = GroupedSessions()
    with table_files(tmp_path) as folder:
        for session in (training(), ExampleSession().speech(1, 2).act(3).end(9)):
            figures = session_figures(session)
            grouped.add(figures)
            folder.add(figures)
    assert [row.session for row in grouped.rows] == ["S01"]
    assert grouped.sessions == 2
    [told] = figures_json.apart(grouped)["trainings"]
    assert (told["session"], told["training"]["right"]) == ("T01", 1)
    rows = {
        path.stem: [*csv.DictReader(path.read_text(encoding="utf-8").splitlines())]
        for path in tmp_path.glob("*.csv")
    }
    assert [row["training"] for row in rows["sessions"]] == ["true", "false"]
    assert [(row["right"], row["reaction_median_s"]) for row in rows["trainings"]] == [("1", "0.5")]
    for name in ("conditions", "cues", "actions", "wizards", "latencies"):
        said = {(row["session"], row["counted"]) for row in rows[name]}
        assert said == {("T01", "false"), ("S01", "true")}


def test_one_that_ended_before_its_first_cue_is_none_either() -> None:
    session = ExampleSession(session="T02", participant="TRAINING")
    session.add(1, TrainingChanged(state="waits", planned=20)).act(2).end(60)
    figures = session_figures(session)
    grouped = GroupedSessions()
    grouped.add(figures)
    [kept] = grouped.apart["training"]
    assert (kept.session, kept.figures.cues) == ("T02", 0)
    assert not grouped.rows
    assert not any(part.counted for part in figures.parts)


def trained(right: int, wall: str) -> SessionFigures:
    session = ExampleSession(participant="", wizard="W2", wall=wall)
    for number in range(4):
        cue, judged = f"q{number}", "right" if number < right else "missed"
        cue_given = CueGiven(cue=cue, sort="question", expects=["Hello"], window_us=SECOND)
        reaction = 900_000 if number < right else -1
        session.add(number, cue_given, CueAnswered(cue=cue, judged=judged, reaction_us=reaction))
    return session_figures(session.end(60))


def test_a_method_section_says_how_wizards_practised() -> None:
    early, late = trained(1, "2026-02-01T10:00:00Z"), trained(3, "2026-02-02T10:00:00Z")
    studies = Studies()
    for figures in (late, session_figures(ExampleSession().act(1).end(60)), early):
        studies.add(figures)
    [facts] = studies.found.values()
    assert facts.sessions == 1
    assert " ".join(paragraphs(facts)[1].sentences).endswith(
        "W2 practised in 2 training sessions and answered 3 of 4 cues (75.0 %) correctly in the"
        " last one, with a median reaction time of 0.9 s."
    )


def test_the_page_has_its_score_and_compares_it_with_no_session(tmp_path: Path) -> None:
    story = SessionLogBuilder(session="S03")
    for place, judged in enumerate(("right", "right", "right", "missed")):
        cue = f"q{place}"
        cue_given = CueGiven(cue=cue, sort="question", expects=["Hello"], window_us=4_000_000)
        story.tell(place * 5, cue_given)
        story.tell(place * 5 + 2, CueAnswered(cue=cue, judged=judged, reaction_us=2_000_000))
    stories = (ordinary("P01", "warm"), ordinary("P02", "cold", "S02"), story)
    page = render([each.report(tmp_path) for each in stories])
    plain = re.sub(r"<[^>]+>", " ", page)
    assert "75.0 %  3 of 4 cues right, 1 missed, 0 wrong, 0 uncalled" in plain
    [compared] = re.findall(r'<table class="sortable">.*?</table>', page, re.DOTALL)
    assert set(re.findall(r"S0\d", re.sub(r"<[^>]+>", " ", compared))) == {"S01", "S02"}


def test_it_is_no_subject_of_a_data_set(tmp_path: Path) -> None:
    logs = [
        write(tmp_path / "r", [(0, start()), (20, m.Note(text="a"))]),
        write(
            tmp_path / "r",
            [(0, start("TRAINING", "T01")), (20, TrainingChanged(state="over", planned=9))],
            "2026-03-03T10-00-00_TRAINING_T01",
        ),
    ]
    _, left_out = export_logs(logs, "bids", tmp_path / "out")
    assert "a training of a wizard, in which nobody took part" in str(left_out.notes)
    assert [path.name for path in (tmp_path / "out").glob("sub-*")] == ["sub-P07"]


def test_nothing_in_it_counts(tmp_path: Path) -> None:
    changed = TrainingChanged(state="runs", planned=9)
    session = session_of(
        tmp_path, [(0, start("TRAINING")), (1, changed), (20, m.Note(text="late"))]
    )
    assert {event.counted for event in session.events} == {False}
