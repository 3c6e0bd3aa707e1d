"""What a report says of delayed answers."""

from __future__ import annotations

from typing import Any

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.figures_json import plain
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.report_tables import circumstances, condition_rows, condition_totals
from woz_tui.analysis.study_figures import StudyFacts
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.protocol import messages as m


def session_figures(session: ExampleSession) -> SessionFigures:
    return figures_of(in_time(session))


def test_what_was_held_back_counts_apart() -> None:
    session = ExampleSession().add(
        1, ActionHeld(run="a1", action="Hello", sort="speech", cued=0, until=1_400_000)
    )
    assert list(session_figures(session.end(5)).whole.times["held"].values) == [400_000]


def test_a_press_contains_the_time_for_which_it_was_held_back() -> None:
    session = ExampleSession().act(1, latency_ms=2)
    action_held = ActionHeld(run="a", action="Hello", sort="speech", cued=0, until=4 * SECOND)
    say = m.Command(command="c", run="a", verb="say", args={}, driver="robot", source="key")
    session.add(3, m.ActionRequested(run="a", action="Hello", source="key"), action_held).add(
        4, say
    )
    session.add(4.25, m.Dispatched(command="c", driver="robot", latency_us=250_000))
    whole = session_figures(session.end(9)).whole
    assert list(whole.press.values) == [2000, 1_250_000]
    assert list(whole.times["held"].values) == [SECOND]
    assert list(whole.verbs["say"].dispatched.values) == [2000, 250_000]


def test_how_answers_were_delayed_is_said() -> None:
    session = ExampleSession()
    session.add(2, ShapingChanged(floor_us=800_000, jitter_us=400_000, cues=["speech"]))
    session.add(2.5, ShapingChanged(floor_us=0, jitter_us=0, cues=[]))
    delays = [each for each in circumstances(session_figures(session.end(9))) if "answer" in each]
    assert ["no sooner than 0.8 s" in each for each in delays] == [True, False]
    assert "at once" in delays[1]


def test_the_methods_section_says_it_of_the_study() -> None:
    session = ExampleSession()
    session.add(0, ShapingChanged(floor_us=800_000, jitter_us=400_000, cues=["speech"]))
    session.add(1, ActionHeld(run="a1", action="a", sort="speech", cued=0, until=1_250_000))
    facts = StudyFacts("x", 0)
    facts.add(session_figures(session.act(2).end(60)))
    found = " ".join(sentence for each in paragraphs(facts) for sentence in each.sentences)
    assert (
        "In 1 session the robot answered the end of the visitor's speech no sooner than 0.8 s"
        " after it, plus a random 0 to 0.4 s." in found
    )
    assert "Earlier actions were delayed: 1 action, by 0.25 s in the median." in found


def test_programs_find_it_where_it_has_always_been() -> None:
    without: dict[str, Any] = plain(session_figures(ExampleSession().act(1).end(9)))
    assert (without["shaping"], without["whole"]["held"]["n"]) == ([], 0)
    session = ExampleSession().act(2)
    session.add(1, ShapingChanged(floor_us=800_000, jitter_us=0, cues=["speech"]))
    session.add(1, ActionHeld(run="a1", action="a", sort="speech", cued=0, until=1_250_000))
    figures: dict[str, Any] = plain(session_figures(session.end(9)))
    assert figures["shaping"] == [
        {"t": SECOND, "floor_us": 800_000, "jitter_us": 0, "cues": ["speech"]}
    ]
    assert figures["whole"]["held"]["median"] == 250_000
    assert figures["whole"]["main"]["held_median_s"] == 0.25


def test_reports_of_many_sessions_tell_it_where_answers_were_delayed() -> None:
    plain_ones = [ExampleSession(participant=code).act(2).end(30) for code in ("P02", "P03")]
    delayed = ExampleSession(participant="P01").act(2)
    delayed.add(1, ActionHeld(run="a1", action="a", sort="speech", cued=0, until=1_250_000))
    for sessions, told in ((plain_ones, False), ([delayed.end(30), *plain_ones], True)):
        grouped = GroupedSessions()
        for session in sessions:
            grouped.add(session_figures(session))
        assert ("Held" in condition_rows(grouped.rows).heads) is told
        totals = condition_totals(grouped.totals(grouped.experiments[0]))
        assert ("Answers delayed on purpose" in [row[0] for row in totals.rows]) is told
