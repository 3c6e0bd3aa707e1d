"""Cues, the acts that answer them, and what becomes of those that nothing answers."""

from __future__ import annotations

from msgspec.structs import replace

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time, seconds
from tests.protocol.examples import messages as examples
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.report_tables import condition_rows, figures_table
from woz_tui.analysis.report_tables import cues as cues_table
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView


def session_figures(
    session: ExampleSession, options: FigureOptions | None = None
) -> SessionFigures:
    return figures_of(in_time(session), options or FigureOptions())


def fates(figures: SessionFigures) -> list[tuple[str, str, float | None]]:
    return [
        (cue.cue_type, cue.result, None if cue.reaction_us is None else cue.reaction_us / SECOND)
        for cue in figures.cues
    ]


def test_the_next_act_answers() -> None:
    session = ExampleSession().speech(1, 3).act(4.5).act(5).end(20)
    figures = session_figures(session)
    assert fates(figures) == [("speech", "answered", 1.5)]
    assert (figures.cues[0].action, figures.cues[0].run) == ("Hello", "a00001")
    assert figures.whole.reactions["all"].answered == 1


def test_an_act_that_is_refused_is_a_reaction_all_the_same() -> None:
    assert (
        fates(session_figures(ExampleSession().speech(1, 3).act(4, end="refused").end(20)))[0][1]
        == "answered"
    )


def left_out(session: ExampleSession, seconds: float, verb: str) -> ExampleSession:
    """A press of which this robot does nothing."""
    request = m.ActionRequested(run="x", action="Blue", source="key", key="b", without=[verb])
    session.add(seconds, request)
    return session.add(seconds, m.ActionDone(run="x", action="Blue"))


def test_an_act_that_is_left_out_counts_as_such_and_answers_as_the_file_meant_it() -> None:
    figures = session_figures(left_out(ExampleSession().speech(1, 3).act(9), 4, "eyes").end(20))
    assert fates(figures) == [("speech", "answered", 6.0)]
    assert (figures.whole.outcomes.left_out, figures.whole.outcomes.done) == (1, 1)
    assert figures.whole.actions == 2
    said = session_figures(left_out(ExampleSession().speech(1, 3), 4, "say").end(20))
    assert fates(said) == [("speech", "answered", 1.0)]


def test_the_robot_by_itself_answers_nothing() -> None:
    session = ExampleSession().speech(1, 3).act(4, source="engagement").end(20)
    assert fates(session_figures(session)) == [("speech", "missed", None)]


def said_by_the_file(answers: dict[str, list[str]]) -> m.SessionPlan:
    plan = next(each for each in examples() if isinstance(each, m.SessionPlan))
    study = replace(plan.settings.study, answers=answers)
    return replace(plan, settings=replace(plan.settings, study=study))


def test_a_nod_answers_nothing_unless_the_file_says_so() -> None:
    def course(answers: dict[str, list[str]]) -> list[tuple[str, str, float | None]]:
        session = (
            ExampleSession()
            .add(0, said_by_the_file(answers))
            .add(2, m.Marker(text="go", source="key"))
        )
        session.speech(2, 3).act(4, "Nod", "Gestures", verb="play").act(6)
        return sorted(fates(session_figures(session.end(20))))

    speech = [("marker", "answered", 4.0), ("speech", "answered", 3.0)]
    assert course({}) == speech, "the default, as in older logs"
    assert course({"speech": ["play"]}) == [speech[0], ("speech", "answered", 1.0)]
    assert course({"marker": ["Gestures"]}) == [("marker", "answered", 2.0), speech[1]]


def test_a_typed_sentence_answers_and_a_turn_of_the_head_does_not() -> None:
    session = ExampleSession().speech(1, 3)
    for at, verb in ((4, "gaze"), (5, "say")):
        session.add(at, m.Command(command=verb, verb=verb, args={}, driver="robot", source="key"))
    assert fates(session_figures(session.end(20))) == [("speech", "answered", 2.0)]


def test_an_act_that_was_refused_is_judged_by_what_it_would_have_done() -> None:
    plan = said_by_the_file({})
    nod = ActionView(name="Nod", label="Nod", verbs=["play"])
    plan = replace(plan, panels=[PanelView(title="Body", actions=[nod])])
    session = ExampleSession().add(0, plan).speech(1, 3).act(4, "Nod", "Body", end="refused")
    assert fates(session_figures(session.end(20))) == [("speech", "missed", None)]


def test_at_the_end_of_the_window_an_answer_still_counts() -> None:
    session = ExampleSession().speech(1, 3).act(13).speech(20, 22, 2).act(32.001).end(60)
    assert fates(session_figures(session)) == [
        ("speech", "answered", 10.0),
        ("speech", "missed", None),
    ]
    wide = session_figures(session, FigureOptions(window_us=11 * SECOND))
    assert [fate for _, fate, _ in fates(wide)] == ["answered", "answered"]


def test_who_speaks_on_wants_no_answer_to_what_came_before() -> None:
    session = ExampleSession().speech(1, 3).speech(4, 6, 2).act(7).end(20)
    assert fates(session_figures(session)) == [
        ("speech", "superseded", None),
        ("speech", "answered", 1.0),
    ]


def test_what_is_overtaken_after_the_window_was_missed() -> None:
    session = ExampleSession().speech(1, 3).speech(40, 42, 2).act(43).end(60)
    assert [fate for _, fate, _ in fates(session_figures(session))] == ["missed", "answered"]


def test_a_cue_at_the_end_of_the_log_is_cut() -> None:
    figures = session_figures(ExampleSession().speech(1, 3).end(9))
    assert fates(figures) == [("speech", "cut", None)]
    assert figures.whole.reactions["speech"].missed == 0


def test_an_answer_may_come_before_the_line_that_tells_of_the_cue() -> None:
    session = ExampleSession().speech(1, 3, late=1.0).act(3.4).end(20)
    assert fates(session_figures(session)) == [("speech", "answered", 0.4)]


def test_an_act_just_before_the_end_of_speech_is_the_answer() -> None:
    session = ExampleSession().speech(1, 4).act(3.5).act(8).speech(20, 22, 2).act(20.9).end(60)
    figures = session_figures(session)
    assert fates(figures) == [("speech", "answered_early", None), ("speech", "missed", None)]
    assert figures.whole.reactions["all"].times.n == 0
    assert figures.cues[0].action == "Hello"


def test_what_came_before_the_visitor_spoke_answers_something_else() -> None:
    session = ExampleSession().speech(1, 3).act(3.4).speech(3.5, 4, 2).end(30)
    assert fates(session_figures(session)) == [
        ("speech", "answered", 0.4),
        ("speech", "missed", None),
    ]


def test_a_marker_asks_for_what_comes_after_it() -> None:
    session = ExampleSession().act(2.8).add(3, m.Marker(text="go", source="key")).act(5).end(30)
    assert fates(session_figures(session)) == [("marker", "answered", 2.0)]


def test_the_models_echo_of_an_anticipated_cue_counts_once() -> None:
    session = ExampleSession().speech(1, 3).act(2.9)
    session.add(
        3.1,
        m.EngagementChanged(
            was="UserSpeaks", now="RobotThinks", outcome="listening", why="", verdicts={}
        ),
    )
    figures = session_figures(session.end(30))
    assert [fate for _, fate, _ in fates(figures)] == ["answered_early", "answered_early"]
    assert figures.whole.reactions["all"].cues == 1


def test_one_event_is_not_two_cues() -> None:
    session = ExampleSession().speech(1, 3)
    session.state(3.1, "UserSpeaks", "RobotThinks").act(5).end(20)
    figures = session_figures(session)
    assert [(cue.cue_type, cue.echo) for cue in figures.cues] == [
        ("speech", False),
        ("engagement", True),
    ]
    assert figures.whole.reactions["all"].cues == 1
    assert seconds(figures.whole.reactions["engagement"].times.values) == [1.9]


def test_a_state_that_is_left_wants_no_answer_any_more() -> None:
    session = (
        ExampleSession()
        .state(3, "UserSpeaks", "RobotThinks")
        .state(6, "RobotThinks", "PersonDetected")
    )
    assert fates(session_figures(session.act(7).end(20))) == [("engagement", "superseded", None)]


def test_which_states_are_cues_can_be_said() -> None:
    session = ExampleSession().state(3, "PersonDetected", "EngagedWithUnknown").act(4).end(20)
    assert session_figures(session).cues == ()
    figures = session_figures(session, FigureOptions(waiting=("EngagedWithUnknown",)))
    assert fates(figures) == [("engagement", "answered", 1.0)]
    assert figures.cues[0].what == "EngagedWithUnknown"


def test_a_marker_counts_from_the_moment_that_its_program_measured() -> None:
    session = ExampleSession().add(3, m.Marker(text="go", source="program", at=2_000_000)).act(4)
    session.add(9, m.Marker(text="go", source="program", at=7_000_000)).end(30)
    assert fates(session_figures(session)) == [
        ("marker", "answered", 2.0),
        ("marker", "missed", None),
    ]
    early = ExampleSession().act(2.5)
    early.add(3, m.Marker(text="go", source="program", at=2_000_000))
    assert fates(session_figures(early.end(20))) == [("marker", "answered", 0.5)]


def test_markers_of_humans_are_cues() -> None:
    session = ExampleSession().add(3, m.Marker(text="asks", source="wizard")).act(5)
    session.add(7, m.Marker(text="x", source="action")).add(
        8, m.Marker(text="y", source="preflight")
    )
    figures = session_figures(session.end(30))
    assert fates(figures) == [("marker", "answered", 2.0)]
    assert (figures.whole.markers, figures.cues[0].what) == (2, "asks")


def test_nobody_reacts_within_150_milliseconds() -> None:
    for moment, expected in ((3.081, ("answered_early", None)), (3.15, ("answered", 0.15))):
        figures = session_figures(ExampleSession().speech(1, 3).act(moment).end(20))
        assert [fate[1:] for fate in fates(figures)] == [expected]
    marked = ExampleSession().add(3, m.Marker(text="go", source="key")).act(3.1).end(20)
    assert fates(session_figures(marked)) == [("marker", "answered_early", None)]


def test_fewer_than_five_reactions_have_no_main_figure() -> None:
    for cues in (4, 5):
        session = ExampleSession()
        for place in range(cues):
            session.speech(20 * place + 1, 20 * place + 3).act(20 * place + 4)
        figures = session_figures(session.end(200))
        shown = {str(row[0]) for row in figures_table(figures).rows}
        assert ("Reaction time, median" in shown) is (cues == 5)
        grouped = GroupedSessions()
        grouped.add(figures)
        assert ("Reaction" in condition_rows(grouped.rows).heads) is (cues == 5)
        assert cues_table(figures).rows[0][-3] == "1.00 s", (
            "the table of cues says how long each took"
        )
