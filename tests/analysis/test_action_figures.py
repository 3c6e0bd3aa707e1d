"""Counts and latencies of sessions whose figures are known."""

from __future__ import annotations

import msgspec

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time, seconds
from woz_tui.analysis import report_tables
from woz_tui.analysis.figures import ActionOutcomes, SessionFigures
from woz_tui.protocol import messages as m


def session_figures(session: ExampleSession) -> SessionFigures:
    return figures_of(in_time(session))


def test_actions_are_counted_by_how_they_ended() -> None:
    session = (
        ExampleSession()
        .act(1, "Hello")
        .act(2, "Hello", end="failed")
        .act(3, "Nod", "Body", end="refused")
    )
    session.act(4, "Nod", "Body", source="script", end="stopped").act(5, "Nod", "Body", took=None)
    whole = session_figures(session.end(10)).whole
    assert whole.outcomes == ActionOutcomes(done=1, failed=1, stopped=1, refused=1, open=1)
    assert whole.by("action") == {
        "Nod": ActionOutcomes(stopped=1, refused=1, open=1),
        "Hello": ActionOutcomes(done=1, failed=1),
    }
    assert whole.by("panel")["Body"].total == 3
    assert {source: ends.total for source, ends in whole.by("source").items()} == {
        "key": 4,
        "script": 1,
    }
    assert (whole.actions, whole.by_hand, whole.us) == (5, 5, 10 * SECOND)
    assert whole.per_minute == 30.0


def test_the_robots_own_actions_are_not_by_hand() -> None:
    session = ExampleSession().act(1).act(2, source="engagement").act(3, source="program").end(60)
    whole = session_figures(session).whole
    assert (whole.actions, whole.by_hand, whole.acts) == (3, 1, 1)
    assert (whole.press.n, whole.gaps.n) == (1, 0)


def test_what_a_body_asks_for_by_itself_is_no_act_of_the_wizard() -> None:
    session = ExampleSession().act(1)
    for at, source, key in ((2, "body", ""), (3, "driver", ""), (4, "midi", "pad 3")):
        command = m.Command(
            command=f"x{at}", verb="sound", args={}, driver="robot", source=source, key=key
        )
        session.add(at, command)
    whole = session_figures(session.end(60)).whole
    assert (whole.acts, whole.direct) == (2, 1)


def test_a_press_lasts_until_its_first_command_starts() -> None:
    session = ExampleSession().act(1, latency_ms=2, took=1.0).act(5, latency_ms=4, took=2.0)
    second = m.Command(
        command="x", run="a00002", verb="play", args={}, driver="robot", source="key"
    )
    session.add(5.1, second).add(
        6.1, m.Dispatched(command="x", driver="robot", latency_us=1_000_000)
    )
    whole = session_figures(session.end(10)).whole
    assert list(whole.press.values) == [2000, 4000]
    assert list(whole.verbs["play"].dispatched.values) == [1_000_000]
    assert whole.verbs["play"].ends == {"open": 1}
    assert list(whole.verbs["say"].done.values) == [998_000, 1_996_000]
    assert seconds(whole.took.values) == [1.0, 2.0]


def test_a_command_on_the_spot_is_an_act() -> None:
    spot = m.Command(command="c9", verb="say", args={"text": "x"}, driver="robot", source="key")
    knob = m.Command(command="k", verb="control", args={}, driver="robot", source="midi")
    forced = m.Command(command="f", verb="force", args={}, driver="engagement", source="key")
    session = ExampleSession().act(1).add(3, spot).add(3.5, knob, forced)
    session.add(3.002, m.Dispatched(command="c9", driver="robot", latency_us=2000)).act(7).end(10)
    whole = session_figures(session).whole
    assert (whole.by_hand, whole.direct, whole.acts) == (2, 1, 3)
    assert seconds(whole.gaps.values) == [2.0, 4.0]
    assert list(whole.press.values) == [1000, 1000, 2000]
    assert "force" not in whole.verbs
    assert "control" not in whole.verbs


def test_sentences_that_were_typed_anew_are_counted_where_they_were_said() -> None:
    session = ExampleSession(condition="warm").act(1, edited=True).act(2)
    session.add(3, m.SessionChanged(condition="cold")).act(4).act(5, edited=True, source="script")
    figures = session_figures(session.act(6, edited=True).end(10))
    assert [part.edited for part in figures.parts] == [1, 2]
    assert [part.acts for part in figures.parts] == [2, 3], "they are acts as any other"
    rows = {row[0]: row[1:] for row in report_tables.figures_table(figures).rows}
    assert rows["Sentences edited before said"] == ["3", "1", "2"]


def test_mistakes_count_once_and_where_the_act_was() -> None:
    session = ExampleSession(condition="warm").act(1).act(2)
    session.add(3, m.SessionChanged(condition="cold")).act(4)
    mistake = m.Mistake(run="a00002", action="Hello")
    session.add(5, mistake, mistake).add(6, m.Mistake(run="a00003", action="Hello")).end(10)
    warm, cold = session_figures(session).parts
    assert (warm.mistakes, warm.mistake_rate) == (1, 0.5)
    assert (cold.mistakes, cold.mistake_rate) == (1, 1.0)


def test_an_action_counts_in_the_condition_in_which_it_was_asked_for() -> None:
    session = ExampleSession(condition="warm").act(1).act(2.9, took=1.0)
    session.add(3, m.SessionChanged(condition="cold")).act(4).act(6)
    session.add(7, m.SessionChanged(condition="warm")).act(8).end(10)
    figures = session_figures(session)
    warm, cold = figures.parts
    assert (warm.condition, warm.us, warm.actions) == ("warm", 6 * SECOND, 3)
    assert (cold.condition, cold.us, cold.actions) == ("cold", 4 * SECOND, 2)
    assert seconds(warm.took.values) == [0.5, 0.5, 1.0]
    assert figures.condition == "warm, cold"
    assert figures.whole.us == 10 * SECOND
    assert figures.whole.actions == warm.actions + cold.actions
    # No gap reaches over the border between two conditions.
    assert seconds(figures.whole.gaps.values) == [1.9, 2.0]


def test_another_participant_has_a_part_of_their_own() -> None:
    session = ExampleSession().act(1).add(5, m.SessionChanged(participant="P08")).act(6).end(10)
    assert [(part.participant, part.actions) for part in session_figures(session).parts] == [
        ("P07", 1),
        ("P08", 1),
    ]


def test_a_log_without_its_first_line_has_figures() -> None:
    session = ExampleSession().act(1).end(3)
    figures = figures_of(in_time(session)[1:])
    assert (figures.whole.actions, figures.wizard, figures.schema) == (1, "", 0)


def test_time_never_goes_back() -> None:
    session = ExampleSession().act(5).end(10)
    back = msgspec.structs.replace(m.Note(text="late"), seq=99, t=2 * SECOND)
    figures = figures_of([*in_time(session), back])
    assert figures.duration_us == 10 * SECOND
    assert figures.marks[0].t == 10 * SECOND
