"""How long a robot's settings were other than asked for: gaps, trials, ends, damage."""

from __future__ import annotations

import csv
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.example_sessions import (
    SECOND,
    ExampleSession,
    figures_of,
    in_time,
    timeline_drawing,
)
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.measures import measured
from woz_tui.analysis.report_tables import settings
from woz_tui.analysis.session_reading import read_report
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

LOST = m.DriverLost(driver="pepper", detail="no answer")
BACK = m.DriverConnected(driver="pepper")


def settings_shown(
    wanted: dict[str, Json] | None = None, driver: str = "pepper", **values: Json
) -> m.SettingsShown:
    """What a robot has: `wanted` of it differs."""
    return m.SettingsShown(driver=driver, values=values, wanted=wanted or {})


def session_figures(session: ExampleSession, *, all_trials: bool = False) -> SessionFigures:
    return figures_of(in_time(session), FigureOptions(all_trials=all_trials))


def rows(figures: SessionFigures) -> list[tuple[str, int, float, float]]:
    """Setting, trial, and from when to when in seconds."""
    return [
        (each.setting, each.trial, each.begin / SECOND, each.end / SECOND)
        for each in figures.differences
    ]


def drifting() -> ExampleSession:
    """Blinking comes on in trial 1 and stays on; the robot is lost for 10 s of trial 2."""
    session = ExampleSession(condition="").add(5, settings_shown(blinking=False, volume=0.6))
    session.add(10, m.TrialStarted(trial=1, condition="warm"))
    session.add(12, settings_shown({"blinking": False}, blinking=True, volume=0.6))
    session.add(14, settings_shown({"blinking": False, "volume": 0.6}, blinking=True, volume=0.8))
    session.add(16, settings_shown({"blinking": False}, blinking=True, volume=0.6))
    session.add(20, m.TrialEnded(trial=1, outcome="done"))
    session.add(25, m.TrialStarted(trial=2, condition="cold"))
    session.add(30, LOST, settings_shown(robot="there")).add(40, BACK)
    session.add(41, settings_shown(blinking=False, volume=0.6))
    session.add(45, settings_shown({"blinking": False}, blinking=True, volume=0.6))
    session.add(50, m.TrialEnded(trial=2, outcome="done"))
    return session


def test_time_that_differs_is_told_by_trial_and_the_loss_of_the_robot_is_none_of_it() -> None:
    figures = session_figures(drifting().end(60))
    assert rows(figures) == [
        ("blinking", 1, 12, 20),
        ("volume", 1, 14, 16),
        ("blinking", -1, 20, 25),
        ("blinking", 2, 25, 30),
        ("blinking", 2, 45, 50),
        ("blinking", -1, 50, 60),
    ]
    assert figures.whole.settings_us == (60 - 5 - 10) * SECOND
    assert figures.whole.differing_us == (8 + 5 + 5 + 5 + 10) * SECOND, "each moment counts once"
    assert [(part.condition, part.differing_us // SECOND) for part in figures.parts] == [
        ("warm", 8),
        ("cold", 5 + 5),
        ("", 5 + 10),
    ]
    assert [each.changed for each in figures.differences] == [True, True, False, False, True, False]
    assert [each.cut for each in figures.differences] == [False] * 5 + [True]
    blinking = figures.differences[0]
    assert (blinking.driver, blinking.value, blinking.wanted) == ("pepper", True, False)


def test_main_figures() -> None:
    values = measured(session_figures(drifting().end(60)).whole)
    assert values["settings_known_s"] == 45
    assert values["settings_differ_s"] == 33
    assert values["settings_differ_share"] == pytest.approx(33 / 45)


def test_a_session_without_settings_has_none() -> None:
    figures = session_figures(ExampleSession().act(1).end(9))
    values = measured(figures.whole)
    assert values["settings_known_s"] == 0
    assert values["settings_differ_s"] is None
    assert values["settings_differ_share"] is None
    assert figures.differences == []


def test_what_is_as_asked_for_is_known_and_no_difference() -> None:
    figures = session_figures(ExampleSession().add(2, settings_shown(volume=0.6)).end(9))
    assert (figures.whole.settings_us, figures.whole.differing_us) == (7 * SECOND, 0)
    assert measured(figures.whole)["settings_differ_share"] == 0


def test_another_value_is_another_row() -> None:
    session = ExampleSession().add(1, settings_shown({"volume": 0.6}, volume=0.8))
    session.add(3, settings_shown({"volume": 0.6}, volume=0.9)).add(
        4, settings_shown({"volume": 0.5}, volume=0.9)
    )
    figures = session_figures(session.end(9))
    assert [(each.value, each.wanted, each.end // SECOND) for each in figures.differences] == [
        (0.8, 0.6, 3),
        (0.9, 0.6, 4),
        (0.9, 0.5, 9),
    ]
    [row] = settings(figures).rows
    assert list(row[:3]) == ["volume", "0.8, 0.9", "0.6, 0.5"]
    assert row[6] == "8.00 s"


def test_what_comes_in_late_of_a_lost_robot_tells_nothing() -> None:
    session = (
        ExampleSession()
        .add(1, settings_shown({"volume": 0.6}, volume=0.8))
        .add(3, LOST, settings_shown(state="solitary"))
    )
    figures = session_figures(session.end(9))
    assert rows(figures) == [("volume", -1, 1, 3)]
    assert figures.whole.settings_us == 2 * SECOND


def test_a_robot_whose_coming_back_is_missing_in_the_log_is_believed_when_it_differs() -> None:
    session = (
        ExampleSession()
        .add(1, settings_shown(volume=0.6))
        .add(3, LOST)
        .add(5, settings_shown({"volume": 0.6}, volume=0.8))
    )
    figures = session_figures(session.end(9))
    assert rows(figures) == [("volume", -1, 5, 9)]
    assert figures.whole.settings_us == (2 + 4) * SECOND


def test_a_robot_that_comes_back_unchanged_need_not_say_so_again() -> None:
    session = (
        ExampleSession()
        .add(1, settings_shown({"volume": 0.6}, volume=0.8))
        .add(3, LOST)
        .add(5, BACK)
    )
    assert rows(session_figures(session.end(9))) == [("volume", -1, 1, 3), ("volume", -1, 5, 9)]


def test_one_robot_is_lost_and_the_other_is_not() -> None:
    session = ExampleSession().add(
        1,
        settings_shown({"volume": 0.6}, volume=0.8),
        settings_shown({"volume": 1}, "nao", volume=2),
    )
    figures = session_figures(session.add(3, LOST).end(9))
    assert [(each.driver, each.end // SECOND) for each in figures.differences] == [
        ("nao", 9),
        ("pepper", 3),
    ]
    assert figures.whole.differing_us == 8 * SECOND
    assert [row[0] for row in settings(figures).rows] == ["nao volume", "pepper volume"]


def test_an_aborted_trial_does_not_count_but_is_told() -> None:
    session = (
        ExampleSession()
        .add(1, m.TrialStarted(trial=1))
        .add(2, settings_shown({"volume": 0.6}, volume=0.8))
    )
    session.add(5, m.TrialEnded(trial=1, outcome="aborted")).add(5, m.TrialStarted(trial=1))
    session.add(7, m.TrialEnded(trial=1, outcome="done"))
    figures = session_figures(session.end(9))
    assert figures.whole.differing_us == (9 - 5) * SECOND
    assert [(each.end // SECOND, each.counted) for each in figures.differences] == [
        (5, False),
        (7, True),
        (9, False),
    ]
    assert [row[3] for row in settings(figures).rows] == ["not counted: 1", "1", "-"]


def test_a_trial_that_is_only_numbered_divides_it_too() -> None:
    session = (
        ExampleSession()
        .add(1, settings_shown({"volume": 0.6}, volume=0.8))
        .add(3, m.SessionChanged(trial=2))
    )
    assert rows(session_figures(session.end(9))) == [("volume", -1, 1, 3), ("volume", 2, 3, 9)]


def test_a_table_has_them_for_other_programs(tmp_path: Path) -> None:
    with table_files(tmp_path) as sheets:
        sheets.add(session_figures(drifting().end(60)))
    with (tmp_path / "settings.csv").open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file, strict=True))
    names = ("setting", "trial", "condition", "value", "wanted", "duration", "changed", "cut")
    table = [row for row in table if row["differs"] == "true"]
    found = [[row[name] for name in names] for row in table]
    assert found[0] == ["blinking", "1", "warm", "true", "false", "8.000000", "true", "false"]
    assert found[-1] == ["blinking", "", "cold", "true", "false", "10.000000", "false", "true"]
    assert sum(float(row["duration"]) for row in table if row["setting"] == "blinking") == 33


def test_the_timeline_draws_each_from_its_beginning_to_its_end() -> None:
    session = (
        ExampleSession()
        .add(1, m.TrialStarted(trial=1))
        .add(2, settings_shown({"volume": 0.6, "eyes": "x"}))
    )
    session.add(4, m.TrialEnded(trial=1, outcome="done")).add(5, settings_shown({"volume": 0.6}))
    session.add(6, LOST).add(8, BACK).end(9)
    drawing = timeline_drawing(in_time(session))
    [lane] = [lane for lane in drawing.lanes if lane.sort == "setting"]
    assert [
        (each.label, each.begin // SECOND, each.end // SECOND, each.cut) for each in lane.intervals
    ] == [
        ("eyes", 2, 5, False),
        ("volume", 2, 6, False),
        ("volume", 8, 9, True),
    ]


def test_a_log_that_is_torn_counts_up_to_its_last_line(tmp_path: Path) -> None:
    session = ExampleSession().add(1, settings_shown({"volume": 0.6}, volume=0.8)).act(4, took=1.0)
    session.add(6, settings_shown(volume=0.6)).end(9)
    path = session.written(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:-2]) + lines[-2][:40])
    figures = read_report(path).figures
    assert rows(figures) == [("volume", -1, 1, 5)]
    assert figures.differences[0].cut
    assert figures.wholeness.sentences


# -- at random --------------------------------------------------------------------------------

_VALUES = st.dictionaries(st.sampled_from("ab"), st.sampled_from([True, 0.5, "x", None]))
_DRIVERS = st.sampled_from(["pepper", "nao"])
_MESSAGES: st.SearchStrategy[m.Message] = st.one_of(
    st.builds(m.SettingsShown, driver=_DRIVERS, values=_VALUES, wanted=_VALUES),
    st.builds(m.DriverLost, driver=_DRIVERS),
    st.builds(m.DriverFaulted, driver=_DRIVERS),
    st.builds(m.DriverConnected, driver=_DRIVERS),
    st.builds(m.TrialStarted, trial=st.integers(1, 2), condition=st.sampled_from(["warm", "cold"])),
    st.builds(m.TrialEnded, trial=st.just(1), outcome=st.just("done")),
    st.builds(m.BreakStarted),
    st.builds(m.BreakEnded),
    st.builds(m.SessionChanged, participant=st.sampled_from(["P07", "P08"])),
)
#: Messages, and how many seconds pass before each.
COURSES = st.lists(st.tuples(_MESSAGES, st.integers(0, 3)), min_size=10, max_size=30)


def differing_at(before: list[m.Message]) -> set[tuple[str, str]] | None:
    """Driver and setting of what differs after these messages; None: nothing is known.

    Looked up from the messages anew, with no state kept from one to the next.
    """
    found: set[tuple[str, str]] = set()
    known = False
    for driver in ("pepper", "nao"):
        of_it = [each for each in before if getattr(each, "driver", "") == driver]
        said = [each for each in of_it if isinstance(each, m.SettingsShown)]
        there = [
            not isinstance(each, m.DriverLost | m.DriverFaulted)
            for each in of_it
            if not isinstance(each, m.SettingsShown) or each.wanted
        ]
        if said and (not there or there[-1]) and (said[-1].values or said[-1].wanted):
            known = True
            found |= {(driver, name) for name in said[-1].wanted}
    return found if known else None


@given(COURSES)
def test_the_times_are_those_of_every_moment_by_itself(
    course: list[tuple[m.Message, int]],
) -> None:
    messages, t = list(ExampleSession().messages), 0
    expected: dict[tuple[str, str], int] = {}
    known = differing = 0
    for message, after in course:
        now = differing_at(messages)
        if now is not None:
            known += after
            differing += after if now else 0
            for each in now:
                expected[each] = expected.get(each, 0) + after
        t += after
        messages.append(msgspec.structs.replace(message, seq=len(messages), t=t * SECOND))
    figures = figures_of(messages, FigureOptions(all_trials=True))
    found: dict[tuple[str, str], int] = {}
    for row in figures.differences:
        key = (row.driver, row.setting)
        found[key] = found.get(key, 0) + (row.end - row.begin) // SECOND
    assert {key: us for key, us in found.items() if us} == {
        key: us for key, us in expected.items() if us
    }
    assert figures.whole.settings_us == known * SECOND
    assert figures.whole.differing_us == differing * SECOND
    assert figures.whole.differing_us == sum(part.differing_us for part in figures.parts)
