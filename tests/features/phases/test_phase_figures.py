"""Phases in figures, tables and pictures: as trials are."""

from __future__ import annotations

from pathlib import Path

from tests.analysis.example_sessions import (
    SECOND,
    ExampleSession,
    figures_of,
    in_time,
    timeline_drawing,
)
from tests.analysis.test_trial_clipping import ON, session_figures, tables
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.protocol import messages as m


def talk() -> ExampleSession:
    """Three phases in a trial, the second one with a break; somebody is engaged all the time."""
    session = ExampleSession(condition="").add(0, ON).state(5, "Wait", "EngagedWithKnown").act(6)
    session.add(10, m.TrialStarted(trial=1, condition="warm"))
    session.add(10, PhaseChanged(phase="opening", source="trial", planned_us=5 * SECOND)).act(11)
    session.act(19).add(20, PhaseChanged(phase="whales", source="key")).act(22)
    session.add(25, m.BreakStarted()).act(26).add(30, m.BreakEnded()).act(31)
    session.add(40, PhaseChanged(phase="opening", source="palette"))
    session.add(50, m.TrialEnded(trial=1, outcome="done")).act(55)
    return session.end(60)


def test_each_phase_is_a_row_and_ends_with_the_trial(tmp_path: Path) -> None:
    found = tables(talk(), tmp_path)["phases"]
    names = ("condition", "trial", "phase", "onset", "duration", "planned", "source", "actions")
    assert [tuple(row[name] for name in names) for row in found] == [
        ("warm", "1", "opening", "10.000000", "10.000000", "5.000000", "trial", "2"),
        ("warm", "1", "whales", "20.000000", "20.000000", "", "key", "2"),
        ("warm", "1", "opening", "40.000000", "10.000000", "", "palette", "0"),
    ]


def test_phases_tear_no_stay_and_no_gap_apart(tmp_path: Path) -> None:
    without = [message for message in in_time(talk()) if not isinstance(message, PhaseChanged)]
    plain, phased = figures_of(without), session_figures(talk())
    for one, other in zip(plain.parts, phased.parts, strict=True):
        assert one.engagement.episodes.values == other.engagement.episodes.values
        assert (one.us, one.acts, one.gaps.values) == (other.us, other.acts, other.gaps.values)
    rows = tables(talk(), tmp_path)["engagement"]
    assert [(row["trial"], row["phase"]) for row in rows] == [
        ("", ""),
        ("", ""),
        ("1", "opening"),
        ("", ""),
        ("1", "whales"),
        ("", ""),
    ]


def test_phases_have_a_lane() -> None:
    lanes = {lane.sort: lane for lane in timeline_drawing(in_time(talk())).lanes}
    shown = lanes["phase"].intervals
    assert [(each.label, each.begin // SECOND, each.end // SECOND) for each in shown] == [
        ("opening", 10, 20),
        ("whales", 20, 40),
        ("opening", 40, 50),
    ]


def test_a_phase_without_an_end_is_cut() -> None:
    session = ExampleSession().add(1, PhaseChanged(phase="opening", source="session")).act(2).end(9)
    (phase,) = session_figures(session).phases
    assert (phase.trial, phase.duration, phase.actions) == (-1, None, 1)
