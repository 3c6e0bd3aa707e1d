"""No word of a report is broken, however narrow the terminal is."""

from __future__ import annotations

import io
import re
import tempfile
from functools import cache
from pathlib import Path

import pytest

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time, study
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import SessionReport, read_report
from woz_tui.cli import report_sessions
from woz_tui.cli.report_layout import report_page
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered, QuestionnaireStarted
from woz_tui.protocol import messages as m

WORD = re.compile(r"[^\W\d_]{2,}")
CONDITIONS = ("empathic", "neutral", "matter-of-fact")


@cache
def session() -> SessionReport:
    """Every table that there is, with long names and every result of a cue."""
    example = ExampleSession(condition="").add(0, m.EngagementAdopted(settings={"start": "run"}))
    for number, condition in enumerate(CONDITIONS):
        at = 100 * number + 10
        example.add(at, m.TrialStarted(trial=number + 1, condition=condition))
        example.state(at + 1, "PersonDetected", "EngagedWithUnknown")
        example.speech(at + 2, at + 4, 10 * number).act(
            at + 3.5, "Introduce the exhibition", "Opening"
        )
        example.speech(at + 10, at + 11, 10 * number + 1).speech(at + 12, at + 13, 10 * number + 2)
        example.act(
            at + 14, "Encouragement without any words", "Nonverbal behaviour", verb="emotion"
        )
        example.act(at + 15, "Encouragement", "Nonverbal behaviour", end="failed")
        example.act(at + 16, "Encouragement", "Nonverbal behaviour", end="refused")
        example.state(at + 17, "UserSpeaks", "RobotThinks").speech(
            at + 20, at + 21, 10 * number + 3
        )
        example.add(at + 40, m.Marker(text="laughs, then hesitates", source="wizard"))
        example.add(
            at + 80, m.TrialEnded(trial=number + 1, outcome="done", text="a remark of some length")
        )
    example.add(295, m.StopPressed(source="no wizard's console is attached"))
    confirmed = ["microphone", "simulated"]
    example.add(296, m.StopConfirmed(confirmed=confirmed, missing=["head"], elapsed_us=SECOND))
    question = "The robot understood all that I said to it"
    item: dict[str, m.Json] = {"name": "got", "question": question, "low": 1, "high": 7}
    example.add(297, QuestionnaireStarted(questionnaire="ux", title="Acceptance", items=[item]))
    example.add(
        298,
        QuestionnaireAnswered(questionnaire="ux", item="got", question=question, value=6.0),
    )
    wanted: dict[str, m.Json] = {"autonomous blinking": False}
    settings_shown = m.SettingsShown(
        driver="pepper", values={"autonomous blinking": True}, wanted=wanted
    )
    example.add(298, settings_shown)
    return SessionReport(figures_of(in_time(example.speech(299, 300, 99).end(301))))


def words(text: str) -> set[str]:
    return set(WORD.findall(text))


def printed(width: int, what: SessionReport | GroupedSessions) -> str:
    stream = io.StringIO()
    paper = report_page(stream, width)
    if isinstance(what, GroupedSessions):
        report_sessions.show_sessions(paper, what)
    else:
        report_sessions.show_session(paper, what, 99)
    return stream.getvalue()


@cache
def sessions() -> GroupedSessions:
    grouped_sessions = GroupedSessions()
    with tempfile.TemporaryDirectory() as folder:
        for path in study(Path(folder)):
            grouped_sessions.add(read_report(path, places=[]).figures)
    grouped_sessions.add(session().figures)
    return grouped_sessions


@cache
def all_words() -> list[set[str]]:
    return [words(printed(1000, what)) for what in (session(), sessions())]


@pytest.mark.parametrize("width", range(80, 161, 3))
def test_no_word_is_broken(width: int) -> None:
    whats: list[SessionReport | GroupedSessions] = [session(), sessions()]
    for what, whole in zip(whats, all_words(), strict=True):
        narrow = printed(width, what)
        figures = [line for line in narrow.splitlines() if "--csv" not in line]  # how many are not
        assert words("\n".join(figures)) <= whole
        assert max(map(len, narrow.splitlines())) <= width


@pytest.mark.parametrize("width", [80, 130, 160])
def test_nothing_is_left_out_where_it_is_narrow(width: int) -> None:
    assert words(printed(width, session())) == all_words()[0]


def test_a_name_that_is_longer_than_a_line_goes_on_in_the_next(tmp_path: Path) -> None:
    name = "x" * 200
    example = ExampleSession(condition=name).act(1, name, name).end(60)
    report = read_report(example.written(tmp_path), places=[])
    assert max(map(len, printed(80, report).splitlines())) <= 80
    assert printed(80, report).replace("\n", "").count("x") >= 400
