"""Where the code and docs/reference/report.md once said different things."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from tests.analysis.example_sessions import (
    SECOND,
    STEM,
    ExampleSession,
    figures_of,
    in_time,
    seconds,
)
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import OUTSIDE, TRIALS, SessionFigures
from woz_tui.analysis.session_reading import NO_BEGINNING, read_report
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.log.sessions import sessions_in
from woz_tui.protocol import messages as m

SETTINGS = m.EngagementAdopted(settings={"start": "run"})


def session_figures(session: ExampleSession, *, all_trials: bool = False) -> SessionFigures:
    return figures_of(in_time(session), FigureOptions(all_trials=all_trials))


def trial(
    session: ExampleSession, begin: float, end: float, outcome: str, number: int = 1
) -> ExampleSession:
    session.add(begin, m.TrialStarted(trial=number))
    return session.add(end, m.TrialEnded(trial=number, outcome=outcome))


def test_a_break_inside_a_trial_belongs_to_no_trial() -> None:
    session = trial(ExampleSession(), 10, 50, "aborted").act(15).act(25, "Nod").act(45)
    session.add(20, m.BreakStarted()).add(30, m.BreakEnded()).end(60)
    figures = session_figures(session)
    assert (figures.whole.actions, figures.trials[0].actions) == (1, 2)
    assert figures.whole.us == (10 + 10 + 10) * SECOND
    assert figures.trials[0].end == 50 * SECOND


def test_a_break_that_ends_with_its_trial() -> None:
    session = ExampleSession().add(10, m.TrialStarted(trial=1)).add(20, m.BreakStarted())
    session.add(30, m.TrialEnded(trial=1, outcome="excluded")).add(30, m.BreakEnded()).act(40).end(
        50
    )
    figures = session_figures(session)
    assert [(each.end, each.outcome) for each in figures.trials] == [(30 * SECOND, "excluded")]
    assert (figures.whole.actions, figures.whole.us) == (1, 40 * SECOND)


def test_the_number_of_the_next_trial_is_no_trials_yet() -> None:
    session = ExampleSession().add(1, m.SessionChanged(trial=1))
    session.add(2, m.ConditionsAssigned(participant="P07", order=["warm"], method="hand"))
    session.add(3, m.Marker(text="before", source="key"))
    session = trial(session, 10, 20, "done").add(15, m.Marker(text="in it", source="key"))
    session.add(30, m.SessionChanged(trial=2)).add(31, m.Marker(text="after", source="key")).end(60)
    assert [(cue.what, cue.trial) for cue in session_figures(session).cues] == [
        ("before", -1), ("in it", 1), ("after", -1),
    ]  # fmt: skip


def test_a_practice_trial_does_not_count() -> None:
    session = trial(ExampleSession(), 10, 20, "done", 0).act(15)
    figures = session_figures(trial(session, 30, 40, "done", 1).act(35).end(60))
    assert [each.left_out for each in figures.trials] == ["practice", ""]
    assert (figures.parts[0].trials, figures.parts[0].by_hand) == (1, 1)
    every = session_figures(session, all_trials=True)
    assert (every.parts[0].trials, every.parts[0].by_hand) == (2, 2)


def test_an_answer_about_a_practice_trial_does_not_count() -> None:
    session = ExampleSession()
    for number in (0, 1):
        trial(session, 10 + 10 * number, 15 + 10 * number, "done", number)
        questionnaire_started = QuestionnaireStarted(
            questionnaire="ux", title="UX", items=[], trial=number
        )
        answer = QuestionnaireAnswered(questionnaire="ux", item="a", question="A?", value=1)
        session.add(16 + 10 * number, questionnaire_started, answer)
        session.add(
            17 + 10 * number, QuestionnaireEnded(questionnaire="ux", reason="done", answered=1)
        )
    answers = asked_in(session_figures(session.end(60))).answers
    assert [(each.trial, each.counted) for each in answers] == [(0, False), (1, True)]


@pytest.mark.parametrize(
    ("ended", "left_out", "counts"), [(False, ["", "cut off"], 1), (True, ["", ""], 2)]
)
def test_the_trial_in_which_a_log_breaks_off_does_not_count(
    ended: bool, left_out: list[str], counts: int
) -> None:
    """It is run again; without its end in a log that has one, it counts."""
    session = trial(ExampleSession(), 10, 20, "done").act(15)
    session.add(30, m.TrialStarted(trial=2)).act(35)
    figures = session_figures(session.end(60) if ended else session)
    assert [each.left_out for each in figures.trials] == left_out
    assert (figures.parts[0].trials, figures.parts[0].by_hand) == (counts, counts)


def means(figures: SessionFigures) -> list[tuple[str, int]]:
    """Condition and time of the parts that means include."""
    return [(part.condition, part.us) for part in figures.parts if part.in_means]


def test_between_the_lines_that_give_an_order_is_no_time_of_a_trial() -> None:
    session = ExampleSession().add(1, m.SessionChanged(condition="warm", trial=1))
    session.add(
        1.001, m.ConditionsAssigned(participant="P07", order=["warm", "cold"], method="hand")
    )
    session.add(10, m.TrialStarted(trial=1, condition="warm"))
    session.add(20, m.TrialEnded(trial=1, outcome="excluded"))
    session.add(30, m.TrialStarted(trial=2, condition="cold"))
    session.add(45, m.TrialEnded(trial=2, outcome="done")).end(60)
    assert means(session_figures(session)) == [("cold", 15 * SECOND)]


def test_who_got_an_order_and_began_no_trial_is_in_no_mean() -> None:
    session = ExampleSession().add(1, m.SessionChanged(condition="warm", trial=1))
    session.add(
        1.001, m.ConditionsAssigned(participant="P07", order=["warm", "cold"], method="hand")
    )
    figures = session_figures(session.act(15).end(60))
    assert means(figures) == []
    assert [(part.scope, part.by_hand) for part in figures.parts] == [(OUTSIDE, 1)]


def test_what_is_done_before_the_trial_whose_number_was_set_is_outside_of_trials() -> None:
    session = ExampleSession().add(1, m.SessionChanged(trial=3)).act(30)
    figures = session_figures(trial(session, 60, 70, "done", 3).act(65).end(80))
    assert means(figures) == [("warm", 10 * SECOND)]
    assert [(part.scope, part.by_hand) for part in figures.parts] == [(TRIALS, 1), (OUTSIDE, 1)]


def test_without_trials_the_number_that_was_set_holds() -> None:
    session = (
        ExampleSession()
        .add(1, m.SessionChanged(trial=3))
        .add(2, m.Marker(text="x", source="key"))
        .end(60)
    )
    assert [cue.trial for cue in session_figures(session).cues] == [3]


def test_only_acts_by_hand_are_mistakes() -> None:
    session = ExampleSession().act(1).act(5, source="program")
    session.add(2, m.Mistake(run="a00001")).add(6, m.Mistake(run="a00002"))
    assert session_figures(session.end(10)).whole.mistakes == 1


def test_a_mistake_whose_act_is_lost_counts() -> None:
    assert (
        session_figures(ExampleSession().add(2, m.Mistake(run="a00009")).end(10)).whole.mistakes
        == 1
    )


def test_a_press_counts_from_where_and_when_the_act_was_asked_for() -> None:
    session = ExampleSession().add(1, m.ActionRequested(run="a", action="Hello", source="key"))
    mark = m.Command(command="c1", run="a", verb="mark", args={}, driver="session", source="key")
    say = m.Command(command="c2", run="a", verb="say", args={}, driver="robot", source="key")
    session.add(1, mark).add(1, m.Dispatched(command="c1", driver="session", latency_us=7))
    session.add(2, m.SessionChanged(condition="cold")).add(3, say)
    session.add(3, m.Dispatched(command="c2", driver="robot", latency_us=500)).end(9)
    warm, cold = session_figures(session).parts
    assert (seconds(warm.press.values), seconds(cold.press.values)) == ([2], [])


def test_an_engagement_is_clipped_in_figures_and_whole_where_it_is_listed() -> None:
    session = ExampleSession().add(0, SETTINGS).state(10, "Wait", "EngagedWithKnown")
    session.add(20, m.SessionChanged(condition="cold"))
    session.state(30, "EngagedWithKnown", "Wait", outcome="lost").end(40)
    figures = session_figures(session)
    rows = [(each.state, each.condition, each.left_by) for each in figures.visits]
    assert ("engaged", "warm", "lost") in rows
    assert ("EngagedWithKnown", "warm", "lost") in rows
    assert {part.condition: part.engagement.episodes.n for part in figures.parts} == {
        "warm": 1,
        "cold": 1,
    }


def test_cues_of_trials_that_do_not_count_stay_marked() -> None:
    session = (
        trial(ExampleSession(), 10, 20, "aborted").add(15, m.Marker(text="x", source="key")).end(60)
    )
    for all_trials in (False, True):
        figures = session_figures(session, all_trials=all_trials)
        assert [cue.counted for cue in figures.cues] == [False]
        assert figures.whole.reactions.keys() == ({"marker", "all"} if all_trials else set())


def test_time_that_the_log_has_lost_is_no_time_of_the_session() -> None:
    session = ExampleSession().add(0, SETTINGS).state(40, "Wait", "PersonDetected").act(60).end(70)
    rest = figures_of(in_time(session)[2:])
    assert seconds([rest.duration_us, rest.whole.us]) == [30, 30]
    assert rest.whole.per_minute == 2.0


def with_checkpoint(session: ExampleSession, at: float) -> ExampleSession:
    return session.add(at, m.Checkpoint(sha256="ab", lines=len(session.messages)))


@pytest.mark.parametrize("lost", [slice(0, 2), slice(3, 5), slice(0, 6)])
def test_lines_that_are_gone_are_missed_without_a_checksum(lost: slice, tmp_path: Path) -> None:
    path = with_checkpoint(ExampleSession().act(1).act(2).act(3), 9).end(10).written(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    gone = len(lines[lost])
    del lines[lost]
    path.write_bytes(b"".join(lines))
    whole = read_report(path, places=[]).figures.wholeness
    assert f"{gone} line(s) of actions missing" in whole.sentences
    assert (NO_BEGINNING in whole.sentences) == (lost.start == 0)
    assert whole.missing == gone


def test_a_damaged_line_is_not_missed_once_more(tmp_path: Path) -> None:
    path = with_checkpoint(ExampleSession().act(1).act(2), 9).end(10).written(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[3] = b"{]\n"
    path.write_bytes(b"".join(lines))
    whole = read_report(path, places=[]).figures.wholeness
    assert (whole.left_out, whole.missing) == (1, 0)


def test_links_that_lead_in_a_circle_are_named(tmp_path: Path) -> None:
    one, other = tmp_path / f"{STEM}.jsonl", tmp_path / "other.jsonl"
    one.symlink_to(other)
    other.symlink_to(one)
    paths, problems = sessions_in([str(one), str(tmp_path)])
    assert paths + problems
    for path in paths:
        with pytest.raises(FileNotFoundError):
            read_report(path, places=[])


def test_what_may_not_be_read_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests may run as root, who may read everything: so the system's answer is given by hand."""
    closed, log = tmp_path / "closed", tmp_path / "odd.jsonl"
    closed.mkdir()
    log.touch()
    listed, opened, looked = Path.iterdir, os.open, Path.stat

    def refused(real: Any, path: Path) -> Any:
        def call(self: Path | str, *args: Any, **more: Any) -> Any:
            if Path(self) == path:
                raise PermissionError(13, "Permission denied", str(self))
            return real(self, *args, **more)

        return call

    monkeypatch.setattr(Path, "iterdir", refused(listed, closed))
    monkeypatch.setattr(os, "open", refused(opened, log))
    monkeypatch.setattr(Path, "stat", refused(looked, tmp_path / "inside" / "x.jsonl"))
    named = [str(closed), str(tmp_path / "inside" / "x.jsonl")]
    assert sessions_in(named) == ([], [f"{name}: Permission denied" for name in named])
    assert sessions_in([str(tmp_path)]) == ([log], [])
