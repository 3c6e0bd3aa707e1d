"""Trials, stops, questionnaires, marks, hardware, and what the wizard could see."""

from __future__ import annotations

import pytest

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time
from tests.features.questionnaires.scales import scale_totals
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.features.profiles.kinds import ProfileChanged
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import DesignView, Questionnaire, StudySettings, WelcomeSettings


def session_figures(session: ExampleSession, *, all_trials: bool = False) -> SessionFigures:
    return figures_of(in_time(session), FigureOptions(all_trials=all_trials))


def plan(study: StudySettings) -> m.SessionPlan:
    """The line that says what the experiment file has, of the study alone."""
    return m.SessionPlan(
        title="Guide", panels=[], script=[], verbs={}, variables=[], conditions=[],
        keyboard="us", drivers=[], settings=WelcomeSettings(study=study),
    )  # fmt: skip


def trials() -> ExampleSession:
    """One action before, two trials of which one was aborted, a break, one after."""
    session = ExampleSession(condition="").act(1)
    session.add(5, m.TrialStarted(trial=1, condition="warm")).act(6).act(7)
    session.add(10, m.TrialEnded(trial=1, outcome="done"))
    session.add(11, m.BreakStarted(text="water")).add(14, m.BreakEnded())
    session.add(15, m.TrialStarted(trial=2, condition="cold")).speech(16, 17).act(18)
    session.add(20, m.TrialEnded(trial=2, outcome="aborted", text="fire alarm"))
    session.add(21, m.TrialStarted(trial=2, condition="cold")).act(22)
    return session.add(30, m.TrialEnded(trial=2, outcome="done")).end(40)


def test_an_aborted_trial_does_not_count() -> None:
    figures = session_figures(trials())
    assert [(part.condition, part.actions, part.trials) for part in figures.parts] == [
        ("warm", 2, 1),
        ("cold", 1, 1),
        ("", 1, 0),
    ]
    assert [part.scope for part in figures.parts] == ["trials", "trials", "outside"]
    assert figures.whole.actions == 4
    assert figures.whole.us == (40 - 5) * SECOND
    assert [cue.counted for cue in figures.cues] == [False]
    assert "speech" not in figures.whole.reactions


def test_all_trials_count_if_somebody_wants_them() -> None:
    figures = session_figures(trials(), all_trials=True)
    assert (figures.whole.actions, figures.whole.trials) == (5, 3)
    assert figures.whole.us == 40 * SECOND
    assert figures.whole.reactions["speech"].answered == 1


def test_that_a_lost_console_stops_the_drive_is_no_emergency_stop() -> None:
    session = ExampleSession().add(
        1, m.StopPressed(source="no wizard's console is attached", scope="drive")
    )
    figures = session_figures(session.add(5, m.StopPressed(source="key")).end(9))
    assert figures.whole.stops == 1
    assert [stop.scope for stop in figures.stops] == ["drive", "all"], "the list has both"


def test_trials_and_breaks_are_rows() -> None:
    figures = session_figures(trials())
    assert [(each.trial, each.outcome, each.actions, each.counted) for each in figures.trials] == [
        (1, "done", 2, True),
        (2, "aborted", 1, False),
        (2, "done", 1, True),
    ]
    assert figures.trials[1].text == "fire alarm"
    assert [(each.begin, each.end, each.text) for each in figures.breaks] == [
        (11 * SECOND, 14 * SECOND, "water")
    ]


def test_a_trial_whose_end_is_lost_counts() -> None:
    figures = session_figures(ExampleSession().add(1, m.TrialStarted(trial=1)).act(2).end(9))
    assert (figures.trials[0].end, figures.trials[0].outcome) == (None, "")
    assert figures.whole.actions == 1


def test_stops_know_who_confirmed_them() -> None:
    session = ExampleSession().add(1, m.StopPressed(source="key"))
    session.add(1.4, m.StopConfirmed(confirmed=["head"], missing=["base"], elapsed_us=400_000))
    session.add(3, m.StopReleased(source="key")).add(
        5, m.StopPressed(source="program", scope="drive")
    )
    first, second = session_figures(session.end(9)).stops
    assert (first.confirmed, first.missing, first.elapsed_us) == (("head",), ("base",), 400_000)
    assert (first.released, second.released) == (3 * SECOND, None)
    assert (second.scope, second.elapsed_us, second.confirmed) == ("drive", None, ())
    assert session_figures(session).whole.stops == 1


def test_every_press_counts_however_often_it_is_pressed() -> None:
    session = ExampleSession()
    for number in range(40):
        session.add(1 + number / 10, m.StopPressed(source="key"))
    assert session_figures(session.add(6, m.StopReleased(source="key")).end(9)).whole.stops == 40


def test_a_stop_of_driving_is_over_when_it_is_confirmed() -> None:
    session = ExampleSession().add(1, m.StopPressed(source="no console", scope="drive"))
    session.add(2, m.StopConfirmed(confirmed=["base"], missing=[], elapsed_us=SECOND))
    [stop] = session_figures(session.end(9)).stops
    assert (stop.confirmed, stop.released) == (("base",), 2 * SECOND)


def test_a_driver_of_several_parts_tells_which_of_them_stand_still() -> None:
    session = ExampleSession().add(1, m.StopPressed(source="key"))
    confirmed = m.StopConfirmed(
        confirmed=["head"],
        missing=["pepper"],
        elapsed_us=1,
        parts={"pepper": ["motion", "speech"]},
        missing_parts={"pepper": ["tablet"]},
    )
    [stop] = session_figures(session.add(2, confirmed).end(9)).stops
    assert (stop.confirmed, stop.missing) == (("head",), ("pepper (tablet)",))


def test_a_driver_that_a_stop_did_not_reach_is_named_as_that() -> None:
    session = ExampleSession().add(1, m.StopPressed(source="key"))
    confirmed = m.StopConfirmed(
        confirmed=["head"], missing=["base", "robot"], unreached=["robot"], elapsed_us=1
    )
    [stop] = session_figures(session.add(2, confirmed).end(9)).stops
    assert (stop.confirmed, stop.missing) == (("head",), ("base", "robot (not reached)"))
    assert stop.unreached == ("robot",)


def test_marks_are_in_order() -> None:
    session = (
        ExampleSession().add(1, m.Note(text="shy")).add(2, m.Marker(text="laughs", source="wizard"))
    )
    session.add(3, m.Marker(text="4 checks", source="preflight")).act(4)
    session.add(5, m.Mistake(run="a00001", action="Hello", text="wrong key"))
    figures = session_figures(session.end(9))
    assert [(each.sort, each.text, each.action) for each in figures.marks] == [
        ("note", "shy", ""),
        ("marker", "laughs", ""),
        ("mistake", "wrong key", "Hello"),
    ]
    assert (figures.whole.notes, figures.whole.markers, figures.whole.mistakes) == (1, 1, 1)


def questionnaire() -> ExampleSession:
    scale = {"name": "liked", "question": "I liked it", "low": 1, "high": 7}
    free = {"name": "why", "question": "Why?", "text": True}
    session = ExampleSession().add(
        1, QuestionnaireStarted(questionnaire="ux", title="UX", items=[scale, free])
    )

    def answer(at: float, item: str, **given: object) -> None:
        message = QuestionnaireAnswered(
            questionnaire="ux",
            item=item,
            question="?",
            **given,  # type: ignore[arg-type]
        )
        session.add(at, message)

    answer(2, "liked", value=3.0, answered_us=900_000)
    answer(3, "why", text="it was kind")
    answer(4, "liked", value=5.0)
    session.add(5, QuestionnaireEnded(questionnaire="ux", reason="done", answered=2))
    session.add(
        6, QuestionnaireStarted(questionnaire="ux", title="UX", items=[scale, free], trial=3)
    )
    answer(7, "liked", skipped=True)
    return session.add(8, QuestionnaireEnded(questionnaire="ux", reason="left", answered=0)).end(9)


def test_the_last_answer_of_a_round_counts() -> None:
    figures = session_figures(questionnaire())
    liked, why, skipped = asked_in(figures).answers
    assert (liked.value, liked.round, liked.low, liked.high) == (5.0, 1, 1.0, 7.0)
    assert (why.value, why.text, why.low) == (None, "it was kind", None)
    assert (skipped.value, skipped.skipped, skipped.round, skipped.trial) == (None, True, 2, 3)
    assert [(each.reason, each.answered, each.items) for each in asked_in(figures).rounds] == [
        ("done", 2, 2),
        ("left", 0, 2),
    ]


def test_answers_of_a_round_that_was_left_beside_a_whole_one_do_not_count() -> None:
    session = ExampleSession(participant="P01")
    for at, value, reason in ((1, 1.0, "left"), (4, 7.0, "done"), (7, 2.0, "left")):
        session.add(at, QuestionnaireStarted(questionnaire="ux", title="UX", items=[]))
        questionnaire_answered = QuestionnaireAnswered(
            questionnaire="ux", item="liked", question="?", value=value
        )
        session.add(at + 1, questionnaire_answered)
        session.add(at + 2, QuestionnaireEnded(questionnaire="ux", reason=reason, answered=1))
    answers = asked_in(session_figures(session.end(12))).answers
    assert [(each.value, each.counted) for each in answers] == [(1, False), (7, True), (2, False)]


def test_a_round_that_was_left_counts_beside_one_without_answers() -> None:
    session = ExampleSession(participant="P01")
    for at, given in ((1, True), (4, False)):
        session.add(at, QuestionnaireStarted(questionnaire="ux", title="UX", items=[]))
        if given:
            session.add(
                at + 1,
                QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=5.0),
            )
        session.add(at + 2, QuestionnaireEnded(questionnaire="ux", reason="left", answered=1))
    assert [each.counted for each in asked_in(session_figures(session.end(12))).answers] == [True]


def test_questionnaires_that_were_due_and_not_answered_are_named() -> None:
    listed = [
        Questionnaire(name, name.upper(), when=when)
        for name, when in (("each", "trial"), ("last", "end"))
    ]
    study = StudySettings(design=DesignView(trials=2), questionnaires=listed)
    session = ExampleSession().add(0, plan(study))
    session.add(1, m.TrialStarted(trial=1)).add(2, m.TrialEnded(trial=1, outcome="done"))
    session.add(3, m.TrialStarted(trial=2)).add(4, m.TrialEnded(trial=2, outcome="done"))
    answered = QuestionnaireEnded(questionnaire="each", reason="done", answered=0)
    session.add(5, QuestionnaireStarted(questionnaire="each", title="EACH", items=[]), answered)
    assert asked_in(session_figures(session.end(9))).unanswered == (
        "EACH (after trial 1)",
        "LAST (at the end)",
    )


def test_answers_whose_beginning_is_lost_are_kept() -> None:
    session = ExampleSession().add(
        2, QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=2.0)
    )
    assert [each.value for each in asked_in(session_figures(session.end(3))).answers] == [2.0]


def test_lost_drivers_and_consoles() -> None:
    session = ExampleSession().add(
        0, m.DriverConnected(driver="head"), m.DriverConnected(driver="voice")
    )
    session.add(1, m.DriverLost(driver="head", detail="cable")).add(
        2, m.DriverFaulted(driver="head")
    )
    session.add(4, m.DriverConnected(driver="head")).add(6, m.DriverLost(driver="voice"))
    session.add(7, m.ConsoleAttached(console="k1", role="wizard"))
    session.add(8, m.ConsoleLost(console="k1", role="wizard", why="silent"))
    figures = session_figures(session.end(9))
    assert [(each.name, each.begin, each.end, each.text) for each in figures.lost_drivers] == [
        ("head", 1 * SECOND, 4 * SECOND, "cable"),
        ("voice", 6 * SECOND, None, ""),
    ]
    assert figures.drivers == ("head", "voice")
    assert [(each.lost, each.why) for each in figures.consoles] == [(False, ""), (True, "silent")]


def test_what_the_wizard_had_and_could_see() -> None:
    action = ActionView(name="Hello", label="Hello")
    plan = m.SessionPlan(
        title="Guide", panels=[PanelView(title="Speech", actions=[action], locked=True)],
        script=[], verbs={}, variables=[], conditions=[], keyboard="us", drivers=[],
        settings=WelcomeSettings(),
    )  # fmt: skip
    session = (
        ExampleSession()
        .add(0, plan)
        .add(1, m.PerceptionChanged(hidden=["gaze"], blurred=["transcript"]))
    )
    session.add(3, ProfileChanged(profile="child")).add(4, ProfileChanged())
    session.add(5, m.ConditionsAssigned(participant="P07", order=["a", "b"], method="latin-square"))
    session.add(6, m.ExperimentReloaded(experiment_sha256="x", changes=[]))
    session.add(7, m.RerunStarted(original="other", original_session="S00"))
    figures = session_figures(session.end(9))
    assert figures.title == "Guide"
    assert [(each.title, each.actions, each.locked) for each in figures.panels] == [
        ("Speech", ("Hello",), True)
    ]
    assert [(each.hidden, each.blurred) for each in figures.restrictions] == [
        (("gaze",), ("transcript",))
    ]
    assert figures.features["profiles"] == ("child",)
    assert (figures.order, figures.reloads) == (("a", "b"), 1)
    assert figures.rerun_of == "other"


@pytest.mark.parametrize(("outcome", "counted"), [("done", True), ("excluded", False)])
def test_answers_about_a_trial_count_as_it_does(outcome: str, counted: bool) -> None:
    session = ExampleSession(condition="").add(1, m.TrialStarted(trial=1, condition="warm"))
    session.add(9, m.TrialEnded(trial=1, outcome=outcome))
    session.add(10, QuestionnaireStarted(questionnaire="ux", title="UX", items=[], trial=1))
    answer = QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=5.0)
    session.add(11, answer)
    session.add(12, QuestionnaireEnded(questionnaire="ux", reason="done", answered=1)).end(20)
    (row,) = asked_in(session_figures(session)).answers
    assert row.counted is counted
    grouped = GroupedSessions()
    grouped.add(session_figures(session))
    assert len(scale_totals(grouped, grouped.experiments[0])) == counted


def test_answers_about_a_condition_count_with_one_of_its_trials() -> None:
    settings = StudySettings(questionnaires=[Questionnaire("ux", "UX", when="condition")])
    for outcomes in (("done", "excluded"), ("excluded", "aborted")):
        session = ExampleSession(condition="").add(0.1, plan(settings))
        for trial, outcome in enumerate(outcomes, 1):
            session.add(trial * 2, m.TrialStarted(trial=trial, condition="warm"))
            session.add(trial * 2 + 1, m.TrialEnded(trial=trial, outcome=outcome))
        session.add(10, QuestionnaireStarted(questionnaire="ux", title="UX", items=[], trial=2))
        answer = QuestionnaireAnswered(questionnaire="ux", item="liked", question="?", value=5.0)
        (row,) = asked_in(session_figures(session.add(11, answer).end(20))).answers
        assert row.counted is ("done" in outcomes)
