"""Whatever stands in a log: figures come of it, they add up, and nothing raises."""

from __future__ import annotations

import json
import tempfile
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.example_sessions import STEM, figures_of, timeline_drawing
from tests.analysis.html.pages import render
from tests.protocol.examples import messages as examples
from woz_tui.analysis import figures_json
from woz_tui.analysis.csv_package import table_files
from woz_tui.analysis.event_rows import CUE_RESULTS
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figure_files import write_figures
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.kept_figures import KeptPlace
from woz_tui.analysis.measures import TIMES_OF_FEATURES
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import (
    NoSessionError,
    ReportExtras,
    SessionReport,
    read_report,
)
from woz_tui.analysis.study_figures import Studies
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

#: Messages of every kind, at any time, in any order.
ANY = st.lists(
    st.tuples(st.sampled_from(examples()), st.integers(-1, 10**15)), min_size=0, max_size=60
)
RUNS = st.sampled_from(["a1", "a2", "a3"])
CONDITIONS = st.sampled_from(["warm", "cold"])
ACTIONS = st.sampled_from(["Hello", "Nod"])
STATES = st.sampled_from(["Wait", "PersonDetected", "EngagedWithKnown", "RobotThinks", "Odd"])
SOURCES = st.sampled_from(["key", "engagement"])
EMPTY: st.SearchStrategy[dict[str, Any]] = st.just({})
SETTINGS: st.SearchStrategy[dict[str, Any]] = st.sampled_from([{}, {"volume": 1}, {"eyes": "x"}])
STARTS = st.sampled_from([{}, {"start": "off"}, {"start": "run"}])
WOUNDS = st.tuples(st.integers(0, 10**6), st.sampled_from(["flip", "cut", "nul", "twice", "drop"]))
#: Lines of a session that make sense more often than not.
LIKELY: st.SearchStrategy[m.Message] = st.one_of(
    st.builds(m.ActionRequested, run=RUNS, action=ACTIONS, source=SOURCES),
    st.builds(m.ActionDone, run=RUNS, action=ACTIONS),
    st.builds(m.ActionFailed, run=RUNS, action=ACTIONS),
    st.builds(m.Command, command=RUNS, run=RUNS, verb=ACTIONS, args=EMPTY, source=SOURCES),
    st.builds(m.Dispatched, command=RUNS, latency_us=st.integers(-5, 10**9)),
    st.builds(m.SessionChanged, condition=CONDITIONS),
    st.builds(m.TrialStarted, trial=st.integers(0, 3), condition=CONDITIONS),
    st.builds(m.TrialEnded, trial=st.integers(0, 3), outcome=st.sampled_from(["done", "excluded"])),
    st.builds(m.BreakStarted),
    st.builds(m.BreakEnded),
    st.builds(m.Marker, text=st.just("x"), source=st.just("wizard")),
    st.builds(m.Mistake, run=RUNS),
    st.builds(
        m.EngagementChanged, was=STATES, now=STATES, outcome=st.just("o"), why=st.just(""),
        verdicts=st.just({}),
    ),
    st.builds(m.EngagementAdopted, settings=STARTS),
    st.builds(m.SettingsShown, driver=st.just("robot"), values=SETTINGS, wanted=SETTINGS),
    st.builds(m.DriverLost, driver=st.just("robot")),
    st.builds(
        m.Done, command=RUNS, driver=st.sampled_from(["engagement", "robot"]),
        sent=st.sampled_from([{"run": "off"}, {"run": "run"}, {}]), latency_us=st.just(0),
        duration_us=st.just(5),
    ),
    st.builds(
        m.SpeechEnded, driver=st.just("mic"), segment=st.just(1), began=st.integers(0, 10**8),
        ended=st.integers(0, 10**8),
    ),
)  # fmt: skip
COURSE = st.lists(st.tuples(LIKELY, st.integers(0, 8_000_000)), max_size=80)


def timed(course: list[tuple[m.Message, int]]) -> list[m.Message]:
    """Each message so much later than the one before."""
    found, t = [], 0
    for seq, (message, after) in enumerate(course):
        t += after
        found.append(msgspec.structs.replace(message, seq=seq, t=t))
    return found


def used(figures: SessionFigures, report: SessionReport) -> None:
    """All that is made of figures."""
    json.dumps(figures_json.plain(figures), allow_nan=False)
    studies = Studies()
    studies.add(figures)
    for facts in studies.found.values():
        assert all(sentence for each in paragraphs(facts) for sentence in each.sentences)
    grouped = GroupedSessions()
    for each in (figures, replace(figures, session="another")):
        grouped.add(each)
    json.dumps(figures_json.grouped(grouped), allow_nan=False)
    if report.timeline is not None:
        assert "</html>" in render([report])
    with tempfile.TemporaryDirectory() as folder, table_files(Path(folder)) as sheets:
        sheets.add(figures)
        write_figures(Path(folder) / "figures", grouped)
        for table in (Path(folder) / "figures").rglob("*.csv"):
            assert "'-," not in table.read_text(), "nothing is an empty cell, not a dash"
        place = KeptPlace(Path(folder) / "kept", "log", "sum")
        place.keep(figures)
        assert place.load(SessionFigures) == figures


@given(ANY)
def test_messages_in_any_order_raise_nothing(course: list[tuple[m.Message, int]]) -> None:
    messages = [
        msgspec.structs.replace(message, seq=seq, t=t) for seq, (message, t) in enumerate(course)
    ]
    figures = figures_of(messages)
    used(figures, SessionReport(figures, timeline_drawing(messages)))


@given(COURSE)
def test_the_parts_add_up_to_the_whole(course: list[tuple[m.Message, int]]) -> None:
    figures = figures_of(timed(course), FigureOptions(all_trials=True))
    whole, parts = figures.whole, figures.parts
    assert whole.us == sum(part.us for part in parts) == figures.duration_us
    for name in ("actions", "by_hand", "direct", "mistakes", "markers", "stops"):
        assert getattr(whole, name) == sum(getattr(part, name) for part in parts)
    for name in ("press", "took", "gaps", "speech"):
        assert getattr(whole, name).n == sum(getattr(part, name).n for part in parts)
    for name in TIMES_OF_FEATURES:
        found = [part.times[name].n for part in (whole, *parts) if name in part.times]
        assert sum(found[1:]) == sum(found[:1])
    engagement = whole.engagement
    assert engagement.on_us == sum(part.engagement.on_us for part in parts)
    assert engagement.on_us == sum(state.us for state in engagement.states.values())
    assert 0 <= engagement.engaged_us <= engagement.on_us <= whole.us - engagement.off_us
    assert engagement.episodes.total == engagement.engaged_us
    assert 0 <= whole.differing_us <= whole.settings_us <= whole.us
    assert whole.differing_us == sum(part.differing_us for part in parts)
    requests = sum(isinstance(message, m.ActionRequested) for message, _ in course)
    assert whole.actions == whole.outcomes.total == requests


@given(COURSE)
def test_cues_have_one_fate_and_reactions_are_in_the_window(
    course: list[tuple[m.Message, int]],
) -> None:
    figures = figures_of(timed(course), FigureOptions(all_trials=True))
    for cue in figures.cues:
        assert cue.result in CUE_RESULTS
        assert (cue.reaction_us is not None) == (cue.result == "answered")
        assert cue.reaction_us is None or 0 <= cue.reaction_us <= figures.window_us
    markers = sum(isinstance(message, m.Marker) for message, _ in course)
    assert sum(cue.cue_type == "marker" for cue in figures.cues) == markers


@given(COURSE)
def test_leaving_trials_out_only_takes_away(course: list[tuple[m.Message, int]]) -> None:
    messages = timed(course)
    some, every = figures_of(messages), figures_of(messages, FigureOptions(all_trials=True))
    assert some.whole.actions <= every.whole.actions
    assert some.whole.us <= every.whole.us
    left_out = [trial for trial in every.trials if not trial.counted]
    if not left_out:
        assert figures_json.plain(some.whole) == figures_json.plain(every.whole)


@given(COURSE, st.randoms())
def test_what_tells_nothing_changes_nothing(course: list[tuple[m.Message, int]], rnd: Any) -> None:
    messages = timed(course)
    more: list[m.Message] = []
    for message in messages:
        more.append(message)
        if rnd.random() < 0.3:
            more.append(m.ClockTie(seq=message.seq, t=message.t, wall="x"))
            more.append(m.FaceShown(t=message.t, width=1, rows="", emotion="", intensity=0.0))
    assert figures_json.plain(figures_of(more)) == figures_json.plain(figures_of(messages))


@given(COURSE, st.lists(WOUNDS, max_size=4))
def test_a_damaged_log_raises_nothing_and_tells_so(
    course: list[tuple[m.Message, int]], wounds: list[tuple[int, str]]
) -> None:
    data = bytearray(b"".join(map(codec.encode, timed(course))))
    for where, wound in wounds:
        if not data:
            break
        at = where % len(data)
        match wound:
            case "flip":
                data[at] ^= 0xFF
            case "cut":
                del data[at:]
            case "nul":
                data[at : at + 5] = bytes(5)
            case "twice":
                data[at:at] = data[max(0, at - 100) : at]
            case "drop":
                del data[at : at + 30]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{STEM}.jsonl"
        path.write_bytes(data)
        with suppress(NoSessionError):
            report = read_report(path, extras=ReportExtras(timeline=True), places=[])
            assert report.figures.wholeness.sentences  # at least: it has no end
            used(report.figures, report)
