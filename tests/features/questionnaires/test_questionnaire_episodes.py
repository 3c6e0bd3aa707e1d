"""What lasts of questionnaires in a log, what of them is due, and what was had."""

from __future__ import annotations

from tests.timeline.random_sessions import SECOND, plan, start, timed
from woz_tui.features.questionnaires.history import (
    DueQuestionnaire,
    QuestionnaireEpisode,
    QuestionnaireHistory,
)
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import MomentEpisode
from woz_tui.timeline.session_state import SessionState
from woz_tui.timeline.timeline import timeline_of


def answer(item: str, value: float) -> QuestionnaireAnswered:
    return QuestionnaireAnswered(questionnaire="each", item=item, question="?", value=value)


def questionnaire_started(name: str) -> QuestionnaireStarted:
    return QuestionnaireStarted(questionnaire=name, title="", items=[])


def questionnaire_ended(name: str, reason: str = "done") -> QuestionnaireEnded:
    return QuestionnaireEnded(questionnaire=name, reason=reason, answered=0)


def episodes(*course: tuple[float, m.Message]) -> list[QuestionnaireEpisode]:
    return timeline_of(timed((0, start()), *course)).of(QuestionnaireEpisode)


def test_a_questionnaire_keeps_the_last_answer_to_each_item() -> None:
    [each] = episodes(
        (1, questionnaire_started("each")),
        (2, answer("b", 1)),
        (3, answer("a", 5)),
        (4, answer("b", 7)),
        (5, questionnaire_ended("each")),
    )
    assert [
        (item, questionnaire_answered.value)
        for item, questionnaire_answered in each.answers.items()
    ] == [("b", 7), ("a", 5)]
    assert (each.outcome, each.duration, each.source) == ("done", 4 * SECOND, "wizard")


def test_answers_whose_questionnaire_has_no_beginning_are_not_lost() -> None:
    [each] = episodes((2, answer("a", 1)), (5, questionnaire_ended("each", "left")))
    assert (each.label, each.started, each.outcome) == ("each", None, "left")


def state_of(*course: tuple[float, m.Message]) -> SessionState:
    state = SessionState()
    for message in timed((0, start()), (0, plan()), *course):
        state.apply(message)
    return state


def due(*course: tuple[float, m.Message]) -> list[DueQuestionnaire]:
    state = state_of(*course)
    return state.history(QuestionnaireHistory).due(state)


ASSIGNED = m.ConditionsAssigned(participant="P01", order=["warm", "cold"], method="hand")


def test_questionnaires_are_due_behind_a_trial_until_they_were_had() -> None:
    trials: list[tuple[float, m.Message]] = [
        (1, ASSIGNED),
        (2, m.TrialStarted(trial=2)),
        (3, m.TrialEnded(trial=2, outcome="done")),
    ]
    study = state_of(*trials).study
    assert due(*trials) == [DueQuestionnaire("each", 2), DueQuestionnaire("ux", 2)]
    assert (study.next_trial, study.planned, list(study.order)) == (3, 4, ["warm", "cold"])
    assert due(*trials, (4, questionnaire_ended("ux", "left"))) == due(*trials)
    assert due(*trials, (4, questionnaire_ended("ux", "declined"))) == [DueQuestionnaire("each", 2)]
    assert due(*trials, (4, m.TrialStarted(trial=3))) == []
    assert due(*trials, (4, m.TrialEnded(trial=4, outcome="done"))) == [
        DueQuestionnaire("each", 4),
        DueQuestionnaire("ux", 4),
        DueQuestionnaire("last", -1),
    ]


def test_a_questionnaire_that_was_had_once_stays_had_when_it_is_left() -> None:
    state = state_of(
        (1, questionnaire_ended("ux")),
        (2, questionnaire_started("ux")),
        (3, questionnaire_ended("ux", "left")),
    )
    late = SessionState()
    for message in state.messages():
        late.apply(message)
    assert all(set(each.history(QuestionnaireHistory).had) == {"ux"} for each in (state, late))


def test_who_comes_back_has_been_asked_nothing_yet() -> None:
    timeline = timeline_of(
        timed(
            (0, start("P01")),
            (0, plan()),
            (1, QuestionnaireStarted(questionnaire="ux", title="", items=[])),
            (2, QuestionnaireEnded(questionnaire="ux", reason="done", answered=1)),
            (3, m.SessionChanged(participant="P02")),
            (4, m.SessionChanged(participant="P01")),
        )
    )
    assert timeline.state.history(QuestionnaireHistory).had == {}


def test_an_end_without_a_beginning_is_a_moment() -> None:
    [each] = timeline_of(timed((0, start()), (1, questionnaire_ended("q")))).of(MomentEpisode)
    assert isinstance(each.message, QuestionnaireEnded)
