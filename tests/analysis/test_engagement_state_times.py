"""Time in the states of the engagement model, also while it is off."""

from __future__ import annotations

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time, seconds
from woz_tui.analysis.figures import SessionFigures
from woz_tui.protocol import messages as m

SETTINGS = m.EngagementAdopted(settings={"start": "run"})


def session_figures(session: ExampleSession) -> SessionFigures:
    return figures_of(in_time(session))


def switched(run: str) -> m.Done:
    return m.Done(command="c", driver="engagement", sent={"run": run}, latency_us=0, duration_us=0)


def visit() -> ExampleSession:
    """10 s of nobody, 20 s of somebody, 30 s engaged in two states, nobody again to 100 s."""
    session = (
        ExampleSession().add(0, SETTINGS).state(10, "Wait", "PersonDetected", "human_presence")
    )
    session.state(30, "PersonDetected", "EngagedWithUnknown").state(
        40, "EngagedWithUnknown", "EngagedWithKnown", visitor="V01", forced=True
    )
    return session.state(60, "EngagedWithKnown", "PersonDetected").state(
        70, "PersonDetected", "Wait"
    )


def test_time_visits_and_shares() -> None:
    engagement = session_figures(visit().end(100)).whole.engagement
    assert engagement.on_us == 100 * SECOND
    assert {name: state.us // SECOND for name, state in engagement.states.items()} == {
        "Wait": 40,
        "PersonDetected": 30,
        "EngagedWithUnknown": 10,
        "EngagedWithKnown": 20,
    }
    assert engagement.states["PersonDetected"].visits == 2
    assert seconds(engagement.states["PersonDetected"].lengths.values) == [10, 20]
    assert seconds(engagement.episodes.values) == [30]
    assert engagement.share == 0.3
    assert engagement.transitions["PersonDetected"] == {"EngagedWithUnknown": 1, "Wait": 1}
    assert (engagement.forced, engagement.off_us) == (1, 0)


def test_each_stay_is_a_row() -> None:
    visits = session_figures(visit().end(100)).visits
    engaged = [each for each in visits if each.state == "engaged"]
    assert [(each.begin, each.end, each.cut) for each in engaged] == [
        (30 * SECOND, 60 * SECOND, False)
    ]
    assert [each.state for each in visits if each.cut] == ["Wait"]
    known = next(each for each in visits if each.state == "EngagedWithKnown")
    assert (known.visitor, known.condition) == ("V01", "warm")


def test_time_off_is_no_time_in_any_state() -> None:
    session = visit()
    session.add(45, switched("off")).add(55, switched("run"))
    engagement = session_figures(session.end(100)).whole.engagement
    assert (engagement.on_us, engagement.off_us) == (90 * SECOND, 10 * SECOND)
    assert seconds(engagement.episodes.values) == [5, 15]
    assert engagement.states["EngagedWithKnown"].us == 10 * SECOND
    assert engagement.share == 20 / 90


def test_a_model_that_starts_off_is_on_when_it_is_switched_on() -> None:
    session = ExampleSession().add(0, m.EngagementAdopted(settings={"start": "off"}))
    session.add(20, switched("hold")).state(30, "Wait", "PersonDetected").end(50)
    engagement = session_figures(session).whole.engagement
    assert (engagement.on_us, engagement.off_us) == (30 * SECOND, 20 * SECOND)
    assert engagement.states["Wait"].us == 10 * SECOND


def test_a_section_that_is_removed_takes_the_model_along() -> None:
    session = ExampleSession().add(0, SETTINGS).state(10, "Wait", "PersonDetected")
    session.add(20, m.EngagementAdopted(settings={})).end(100)
    engagement = session_figures(session).whole.engagement
    assert (engagement.on_us, engagement.off_us) == (20 * SECOND, 0)


def test_a_log_of_schema_1_has_a_model_if_it_ever_moved() -> None:
    session = ExampleSession().state(10, "Wait", "PersonDetected").end(40)
    engagement = session_figures(session).whole.engagement
    assert engagement.on_us == 40 * SECOND
    assert engagement.states["Wait"].us == 10 * SECOND
    assert session_figures(ExampleSession().end(40)).whole.engagement.share is None


def test_time_counts_in_its_condition_and_a_stay_is_clipped_to_it() -> None:
    session = visit()
    session.add(50, m.SessionChanged(condition="cold")).end(100)
    warm, cold = session_figures(session).parts
    assert (warm.engagement.on_us, cold.engagement.on_us) == (50 * SECOND, 50 * SECOND)
    assert (warm.engagement.engaged_us, cold.engagement.engaged_us) == (20 * SECOND, 10 * SECOND)
    assert (warm.engagement.episodes.n, cold.engagement.episodes.n) == (1, 1)
    assert session_figures(session).whole.engagement.on_us == 100 * SECOND


def test_the_log_may_end_in_the_middle_of_an_engagement() -> None:
    session = ExampleSession().add(0, SETTINGS).state(10, "Wait", "EngagedWithKnown")
    figures = session_figures(session.act(25))
    assert seconds(figures.whole.engagement.episodes.values) == [15.5]
    assert [each.cut for each in figures.visits if each.state == "engaged"] == [True]


def test_an_engagement_has_the_visitor_and_the_trial_of_its_beginning() -> None:
    session = ExampleSession().add(0, SETTINGS).add(1, m.TrialStarted(trial=1, condition="warm"))
    session.state(2, "Wait", "EngagedWithKnown", visitor="V01")
    session.add(5, m.TrialEnded(trial=1, outcome="done"), m.TrialStarted(trial=2, condition="cold"))
    session.state(8, "EngagedWithKnown", "PersonDetected").end(9)
    rows = {each.state: each for each in session_figures(session).visits}
    for state in ("EngagedWithKnown", "engaged"):
        row = rows[state]
        assert (row.condition, row.trial, row.visitor) == ("warm", 1, "V01")


def test_what_changes_while_the_model_is_off_is_no_state_and_no_cue() -> None:
    session = (
        ExampleSession()
        .add(0, SETTINGS)
        .add(1, switched("off"))
        .state(2, "UserSpeaks", "RobotThinks")
    )
    figures = session_figures(session.act(3).end(9))
    assert figures.cues == ()
    assert {each.state for each in figures.visits} == {"Wait"}
    assert figures.whole.engagement.transitions == {"UserSpeaks": {"RobotThinks": 1}}


def test_a_model_that_is_switched_off_waits_for_no_answer() -> None:
    session = (
        ExampleSession()
        .add(0, SETTINGS)
        .state(2, "UserSpeaks", "RobotThinks")
        .add(4, switched("off"))
    )
    assert [cue.result for cue in session_figures(session.act(6).end(9)).cues] == ["superseded"]
