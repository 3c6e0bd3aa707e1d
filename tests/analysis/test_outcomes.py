"""What is compared between conditions, beside figures that were computed elsewhere."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from woz_tui.analysis import figures_json
from woz_tui.analysis.figure_files import write_figures
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.intervals import welch_difference
from woz_tui.analysis.outcome_tables import (
    caption,
    conditions_table,
    differences_sentence,
    differences_table,
    missing_table,
)
from woz_tui.analysis.outcomes import Outcome
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.cli import main
from woz_tui.cli.report_layout import report_page
from woz_tui.cli.report_sessions import show_sessions
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m

WARM, SOBER = [4.0, 2.0, 6.0, 3.0, 5.0], [6.0, 5.0, 7.0, 3.0, 6.0]
QUESTION = "How pleasant was it?"
ENDS = ("not at all", "very much")
#: What somebody answers: a number, `None` for what was left out, or how the round ended.
Reply = float | str | None


def play(
    session: ExampleSession, at: float, trial: int, condition: str, reply: Reply, *, high: int = 7
) -> None:
    """A trial with a question of one item behind it."""
    session.add(at, m.TrialStarted(trial=trial, condition=condition)).act(at + 10)
    session.add(at + 60, m.TrialEnded(trial=trial, outcome="done"))
    item: dict[str, m.Json] = {
        "name": "pleasant", "question": QUESTION, "low": 1, "high": high, "ends": [*ENDS],
    }  # fmt: skip
    session.add(
        at + 61, QuestionnaireStarted(questionnaire="ux", title="", items=[item], trial=trial)
    )
    if not isinstance(reply, str):
        answer = QuestionnaireAnswered(
            questionnaire="ux", item="pleasant", question=QUESTION, value=reply,
            skipped=reply is None, answered_us=1,
        )  # fmt: skip
        session.add(at + 65, answer)
    reason = reply if isinstance(reply, str) else "done"
    session.add(at + 66, QuestionnaireEnded(questionnaire="ux", answered=1, reason=reason))


def played(participant: str, high: int = 7, /, **replies: Reply) -> SessionFigures:
    """One participant in one condition after the other."""
    session = ExampleSession(participant=participant, condition="", session=f"S{participant[1:]}")
    for place, (condition, reply) in enumerate(replies.items()):
        play(session, 100.0 * place + 1, place + 1, condition, reply, high=high)
    return figures_of(in_time(session.end(900)))


def grouped(*sessions: SessionFigures) -> GroupedSessions:
    found = GroupedSessions()
    for figures in sessions:
        found.add(figures)
    return found


def pleasant(found: GroupedSessions) -> Outcome:
    [experiment] = found.experiments
    [outcome] = found.outcomes(experiment).scales()
    return outcome


@pytest.fixture
def within() -> GroupedSessions:
    """Five people in both conditions."""
    return grouped(
        *(
            played(f"P{number:02}", warm=warm, sober=sober)
            for number, (warm, sober) in enumerate(zip(WARM, SOBER, strict=True), 1)
        )
    )


@pytest.fixture
def between() -> GroupedSessions:
    """Ten people, each in one condition."""
    return grouped(
        *(played(f"P{number:02}", warm=value) for number, value in enumerate(WARM, 1)),
        *(played(f"P{number:02}", sober=value) for number, value in enumerate(SOBER, 11)),
    )


def halves(outcome: Outcome) -> list[float]:
    found = [each.estimate.half for each in outcome.summaries() if each.estimate is not None]
    return [each for each in found if each is not None]


def test_within_a_design_people_are_compared_with_themselves(within: GroupedSessions) -> None:
    outcome = pleasant(within)
    sober, warm = outcome.summaries()
    assert (sober.estimate, warm.estimate) != (None, None)
    assert outcome.within
    assert [each.n for each in (sober, warm)] == [5, 5]
    assert halves(outcome) == pytest.approx([1.001, 1.001], abs=5e-4)
    [difference] = outcome.differences()
    assert (difference.first, difference.other, difference.paired) == ("sober", "warm", True)
    assert difference.estimate.mean == pytest.approx(-1.4)
    assert difference.estimate.half == pytest.approx(1.416, abs=5e-4)
    assert "Cousineau and Morey" in caption(outcome)
    assert differences_sentence(outcome) == (
        "warm - sober: -1.40 ± 1.42 (n = 5 pairs); 95 % paired difference, t interval."
    )
    assert [list(row) for row in differences_table([outcome]).rows] == [
        [QUESTION, "warm - sober", "5", "-1.40", "-2.82 to 0.02", "paired"]
    ]


def test_between_groups_each_has_its_own_interval(between: GroupedSessions) -> None:
    outcome = pleasant(between)
    assert not outcome.within
    assert halves(outcome) == pytest.approx([1.883, 1.963], abs=5e-4)
    [difference] = outcome.differences()
    assert (difference.paired, difference.estimate.n) == (False, 10)
    assert "of each group" in caption(outcome)
    assert "Welch" in differences_sentence(outcome)


def test_what_came_first_is_told_apart() -> None:
    """Half of the people begin with the other condition; nothing before has had an effect on it."""
    people = list(zip(WARM, SOBER, strict=True))
    found = grouped(
        *(played(f"P{n:02}", warm=warm, sober=sober) for n, (warm, sober) in enumerate(people)),
        *(played(f"P{n:02}", sober=sober, warm=warm) for n, (warm, sober) in enumerate(people, 9)),
    )
    outcome = pleasant(found)
    [together], [first] = outcome.differences(), outcome.first_differences()
    assert (together.paired, together.estimate.n) == (True, 10)
    assert (first.paired, first.estimate.n) == (False, 10)
    assert first.estimate == welch_difference(SOBER, WARM)
    assert [row[-1] for row in differences_table([outcome]).rows] == ["paired", "first, Welch"]
    assert "Of first conditions alone (Welch): warm - sober: -1.40" in differences_sentence(outcome)


def test_below_three_values_stand_instead_of_means() -> None:
    found = grouped(played("P01", warm=4.0, sober=6.0), played("P02", warm=2.0, sober=7.0))
    table = conditions_table(pleasant(found))
    assert [row[4] for row in table.rows] == ["values: 6.00, 7.00", "values: 4.00, 2.00"]
    assert {row[5] for row in table.rows} == {"-"}
    assert halves(pleasant(found)) == []
    stream = io.StringIO()
    show_sessions(report_page(stream, 120), found)
    assert re.search(r"ux +pleasant +1 to 7 +6.00, 7.00 +4.00, 2.00", stream.getvalue())


def test_who_did_not_answer_is_counted_by_the_reason() -> None:
    found = grouped(
        played("P00", warm="declined", sober="left"),  # before anybody's answer told the scale
        played("P01", warm=4.0, sober=None),
        played("P02", warm=5.0, sober=6.0),
        played("P03", warm=6.0, sober=7.0),
    )
    outcome = pleasant(found)
    assert [(each.condition, each.asked, each.n) for each in outcome.summaries()] == [
        *(("sober", 4, 2), ("warm", 4, 3))
    ]
    assert [list(row) for row in missing_table([outcome]).rows] == [
        [QUESTION, "sober", "4", "2", "1 left, 1 skipped"],
        [QUESTION, "warm", "4", "3", "1 declined"],
    ]
    assert outcome.complete == ["P02", "P03"]
    assert "2 participants with all conditions; 1 participant without" in caption(outcome)


def test_answers_are_counted_point_by_point(within: GroupedSessions) -> None:
    sober, warm = pleasant(within).summaries()
    assert list(sober.counts) == [0, 0, 1, 0, 1, 2, 1]
    assert list(warm.counts) == [0, 1, 1, 1, 1, 1, 0]
    assert (sober.median, warm.median) == (6.0, 4.0)


def test_no_probability_is_told_anywhere(within: GroupedSessions, tmp_path: Path) -> None:
    stream = io.StringIO()
    show_sessions(report_page(stream, 120), within)
    write_figures(tmp_path, within)
    texts = [stream.getvalue(), *(path.read_text() for path in tmp_path.iterdir())]
    assert not any(re.search(r"\bp\s*[<=>]|signific|\*\*", text) for text in texts)


def test_pictures_are_files_with_a_table_beside_each(
    within: GroupedSessions, tmp_path: Path
) -> None:
    write_figures(tmp_path, within)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"ux.pleasant.svg", "ux.pleasant-answers.svg", "ux.pleasant.csv"} <= names
    for path in tmp_path.glob("*.svg"):
        root = ElementTree.fromstring(path.read_text())
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert "style" not in path.read_text()
        assert path.with_name(f"{path.stem.removesuffix('-answers')}.csv") in tmp_path.iterdir()
    with (tmp_path / "ux.pleasant.csv").open(newline="") as file:
        sober, warm, difference = csv.DictReader(file)
    assert [float(each["interval_mean"]) for each in (sober, warm, difference)] == pytest.approx(
        [5.4, 4.0, -1.4]
    )
    assert float(difference["interval_low"]) == pytest.approx(-2.816, abs=5e-4)
    assert difference["condition"] == "warm - sober (paired)"
    assert (tmp_path / "ux.pleasant.svg").stat().st_mode & 0o777 == 0o600


def test_the_ends_of_a_scale_stand_at_both(within: GroupedSessions, tmp_path: Path) -> None:
    write_figures(tmp_path, within)
    head = f"{QUESTION} (1 not at all to 7 very much)"
    assert conditions_table(pleasant(within)).title == head
    assert (tmp_path / "ux.pleasant.txt").read_text().startswith(head)
    for name in ("ux.pleasant.svg", "ux.pleasant-answers.svg"):
        words = re.findall(
            r">([^<>]*(?:not at all|very much))</text>", (tmp_path / name).read_text()
        )
        assert [each.lstrip("17 ") for each in words] == [*ENDS]


def test_a_picture_has_a_line_for_each_participant(
    within: GroupedSessions, between: GroupedSessions, tmp_path: Path
) -> None:
    drawn = []
    for name, found in (("within", within), ("between", between)):
        write_figures(tmp_path / name, found)
        text = (tmp_path / name / "ux.pleasant.svg").read_text()
        drawn.append((text.count("<polyline"), text.count("<circle")))
    assert drawn == [(5, 12), (0, 12)]


def test_what_was_asked_once_is_shown_without_conditions(tmp_path: Path) -> None:
    found = grouped(*(played(f"P{number:02}", **{"": value}) for number, value in enumerate(WARM)))
    outcome = pleasant(found)
    assert outcome.is_once
    assert [list(row)[:5] for row in conditions_table(outcome).rows] == [
        ["all", "5", "5", "", "4.00"]
    ]
    assert outcome.differences() == []
    write_figures(tmp_path, found)
    assert ">all<" in (tmp_path / "ux.pleasant.svg").read_text()


def test_a_scale_that_was_changed_has_files_of_its_own(tmp_path: Path) -> None:
    found = grouped(played("P01", warm=4.0), played("P02", 5, warm=2.0))
    write_figures(tmp_path, found)
    assert {path.name for path in tmp_path.glob("ux*.csv")} == {
        *("ux.pleasant.csv", "ux.pleasant-2.csv")
    }


def test_programs_get_the_same(within: GroupedSessions) -> None:
    [experiment] = json.loads(json.dumps(figures_json.grouped(within)))
    [found] = [each for each in experiment["outcomes"] if each["name"] == "ux.pleasant"]
    assert found["within"] is True
    assert found["differences"][0]["estimate"]["n"] == 5


def test_one_log_with_several_people_has_means_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session = ExampleSession(participant="P01", condition="")
    people: Sequence[tuple[float, float]] = list(zip(WARM, SOBER, strict=True))
    for number, (warm, sober) in enumerate(people):
        at = 300.0 * number
        if number:
            session.add(at, m.SessionChanged(participant=f"P{number + 1:02}", condition=""))
        play(session, at + 1, 1, "warm", warm)
        play(session, at + 101, 2, "sober", sober)
    session.messages = in_time(session)
    log = session.end(2000).written(tmp_path)
    assert main(["report", str(log)]) == 0
    printed = capsys.readouterr().out
    assert "By condition" in printed
    assert re.search(r"warm - sober +5 +-1.40 +-2.82 to 0.02 +paired", printed)
    assert main(["report", str(log), "--html", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text()
    assert "Participants together" in page
    assert "-1.40 ± 1.42 (n = 5 pairs)" in page
