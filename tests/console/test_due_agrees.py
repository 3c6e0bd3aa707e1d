"""Console and robot process never differ in what is due."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from tests.console import studied
from woz_tui.console.study.picture import Study
from woz_tui.core import messages as m
from woz_tui.timeline.state import SessionState

WHENS = ("trial", "condition", "end", "hand")
TRIALS = st.tuples(st.integers(0, 6), st.sampled_from(["done", "aborted", "excluded"]))
ASKED = st.tuples(st.sampled_from(WHENS), st.sampled_from(["done", "declined", "left"]))
PEOPLE = st.sampled_from(["P01", "P02"])


def messages(step: object) -> list[m.AnyMessage]:
    match step:
        case (int(number), str(outcome)):
            return [
                m.TrialStarted(trial=number, condition="warm", planned=4),
                m.TrialEnded(trial=number, outcome=outcome),
            ]
        case (str(name), str(reason)):
            return [
                m.QuestionnaireStarted(questionnaire=name, title=name, items=[]),
                m.QuestionnaireEnded(questionnaire=name, reason=reason, answered=0),
            ]
        case str(who):
            return [m.ConditionsAssigned(participant=who, order=["warm", "cold"], method="fixed")]
    raise AssertionError(step)


@given(st.lists(st.one_of(TRIALS, ASKED, PEOPLE), max_size=12))
def test_what_is_due_is_the_same_for_both(steps: list[object]) -> None:
    questionnaires = [
        {"name": when, "title": when, "when": when, "items": []} for when in reversed(WHENS)
    ]
    told = studied.typed(studied.told(questionnaires=questionnaires))
    shown, robot = Study(), SessionState()
    robot.study.settings = told
    shown.tell(told)
    for message in (message for step in ["P01", *steps] for message in messages(step)):
        shown.take(message)
        robot.take(message)
        assert shown.due == [due.questionnaire for due in robot.study.due]
