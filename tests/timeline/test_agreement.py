"""In sessions as the robot process records them the timeline says what reports and exports say."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

from hypothesis import given, settings

from tests.analysis.told import figures_of
from tests.timeline.courses import recordings
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.gather import Options
from woz_tui.analysis.lanes import Interval, drawing_of
from woz_tui.core import messages as m
from woz_tui.core import wire
from woz_tui.experiment.verbs import PERFORMERS
from woz_tui.export.course import Session
from woz_tui.export.extract import Extractor
from woz_tui.record.log import Line
from woz_tui.timeline.context import Context
from woz_tui.timeline.episodes import (
    Action,
    Break,
    Command,
    Conflict,
    Engagement,
    Episode,
    LostDriver,
    ModelOff,
    ModelState,
    Moment,
    Questionnaire,
    Setting,
    Stop,
    Trial,
    Utterance,
)
from woz_tui.timeline.state import SessionState
from woz_tui.timeline.timeline import Timeline, timeline_of

E = TypeVar("E", bound=Episode)
#: Participant and condition.
Group = tuple[str, str]


def group(context: Context) -> Group:
    return context.participant, context.condition


def time_by_group(
    timeline: Timeline, kind: type[Episode], label: str | None = None
) -> Counter[Group]:
    found: Counter[Group] = Counter()
    for episode in timeline.of(kind):
        for part in timeline.parts(episode):
            if label in (None, episode.label):
                found[group(part.context)] += part.end - part.begin
    return +found


def both(messages: list[m.AnyMessage]) -> tuple[Timeline, SessionFigures]:
    return timeline_of(messages), figures_of(messages, Options(all_trials=True))


def exported(messages: list[m.AnyMessage]) -> Session:
    extractor = Extractor(Session(name="x", log=Path("x")), Path("nowhere"))
    for message in messages:
        if not wire.is_sample(message):
            raw = wire.encode(message)
            fields = wire.decode_unknown(raw)
            kind = str(fields["kind"])
            extractor.take(message, Line(message.seq, message.t, "", kind, fields, raw, message))
    extractor.finish()
    return extractor.session


# -- reports --------------------------------------------------------------------------------------


@settings(max_examples=30)
@given(recordings())
def test_report_times_of_conditions_and_of_the_model(messages: list[m.AnyMessage]) -> None:
    timeline, figures = both(messages)
    spent: Counter[Group] = Counter()
    for span in timeline.spans:
        spent[group(span.context)] += span.end - span.begin
    parts = {(part.participant, part.condition): part for part in figures.parts}
    assert {key: part.us for key, part in parts.items() if part.us} == +spent
    models = {key: part.engagement for key, part in parts.items()}
    states = timeline.of(ModelState)
    assert {key: each.on_us for key, each in models.items() if each.on_us} == time_by_group(
        timeline, ModelState
    )
    for name in {each.state for each in states}:
        assert {
            key: each.states[name].us
            for key, each in models.items()
            if name in each.states and each.states[name].us
        } == time_by_group(timeline, ModelState, name)
    engaged = time_by_group(timeline, Engagement)
    assert {key: each.engaged_us for key, each in models.items() if each.engaged_us} == engaged
    off = time_by_group(timeline, ModelOff)
    assert {key: each.off_us for key, each in models.items() if each.off_us} == off


@settings(max_examples=30)
@given(recordings())
def test_report_actions_and_commands(messages: list[m.AnyMessage]) -> None:
    timeline, figures = both(messages)
    counted = Counter(
        (*group(each.context), each.label, each.request.panel, each.source, str(each.outcome))
        for each in timeline.of(Action)
    )
    reported: Counter[tuple[str, ...]] = Counter()
    for part in figures.parts:
        for row in part.counts:
            for end in ("done", "failed", "stopped", "refused", "open"):
                key = (part.participant, part.condition, row.action, row.panel, row.source, end)
                reported[key] += getattr(row.outcomes, end)
    assert +reported == counted
    sent = Counter(
        (*group(each.context), each.label, str(each.outcome))
        for each in timeline.of(Command)
        if each.request.driver not in PERFORMERS
    )
    assert sent == Counter(
        {
            (part.participant, part.condition, verb, end): count
            for part in figures.parts
            for verb, times in part.verbs.items()
            for end, count in times.ends.items()
        }
    )
    done = [each for each in timeline.of(Action) if each.outcome == "done"]
    assert sorted(each.duration for each in done) == list(figures.whole.took.values)
    wrong = [each for each in timeline.of(Action) if each.mistake and each.source != "engagement"]
    assert len(wrong) == figures.whole.mistakes


@settings(max_examples=30)
@given(recordings())
def test_report_rows(messages: list[m.AnyMessage]) -> None:
    timeline, figures = both(messages)
    ended = timeline.end
    assert sorted(
        (each.state, each.begin, each.end, each.reason, each.cut)
        for each in timeline.of(ModelState)
    ) == sorted(
        (each.state, each.begin, each.end, each.outcome, each.cut)
        for each in figures.visits
        if each.state != "engaged"
    )
    assert [(each.begin, each.end, each.reason) for each in timeline.of(Engagement)] == sorted(
        (each.begin, each.end, each.outcome) for each in figures.visits if each.state == "engaged"
    )
    assert [
        (each.label, *group(each.context), each.begin, each.end, str(each.outcome))
        for each in timeline.of(Trial)
    ] == [
        (
            *(str(each.trial), each.participant, each.condition, each.begin),
            *(ended if each.end is None else each.end, each.outcome or "open"),
        )
        for each in figures.trials
    ]
    assert [(each.begin, each.end) for each in timeline.of(Break)] == [
        (each.begin, each.end) for each in figures.breaks
    ]
    assert [(each.begin, each.end, each.label) for each in timeline.of(LostDriver)] == [
        (each.begin, ended if each.end is None else each.end, each.name)
        for each in figures.lost_drivers
    ]
    assert [
        (each.begin, ended if each.released is None else each.end, each.confirmed)
        for each in timeline.of(Stop)
    ] == [
        (each.t, ended if each.released is None else each.released, each.confirmed)
        for each in figures.stops
    ]
    assert [(each.label, each.begin, str(each.outcome)) for each in timeline.of(Questionnaire)] == [
        (each.questionnaire, each.t, each.reason or "open") for each in figures.rounds
    ]


@settings(max_examples=30)
@given(recordings())
def test_report_differences_of_settings(messages: list[m.AnyMessage]) -> None:
    timeline, figures = both(messages)
    found: Counter[tuple[str, int | None, str, str]] = Counter()
    for each in timeline.of(Setting):
        for part in timeline.parts(each) if each.differs else ():
            key = (part.context.participant, part.context.trial, each.driver, each.name)
            found[key] += part.end - part.begin
    reported: Counter[tuple[str, int | None, str, str]] = Counter()
    for row in figures.differences:
        trial = None if row.trial < 0 else row.trial
        reported[row.participant, trial, row.driver, row.setting] += row.end - row.begin
    assert +found == +reported


@settings(max_examples=30)
@given(recordings())
def test_report_lanes(messages: list[m.AnyMessage]) -> None:
    timeline = timeline_of(messages)
    drawn = [each for lane in drawing_of(timeline).lanes for each in lane.intervals]
    assert lane(drawn, "speech") == {
        (each.begin, each.end) for each in timeline.of(Utterance) if each.started or each.ended
    }
    assert lane(drawn, "trial") == {(each.begin, each.end) for each in timeline.of(Trial)}
    assert lane(drawn, "lost") == {(each.begin, each.end) for each in timeline.of(LostDriver)}
    assert lane(drawn, "stop") == {(each.begin, each.end) for each in timeline.of(Stop)}


def lane(drawn: list[Interval], sort: str) -> set[tuple[int, int | None]]:
    return {(each.begin, each.end) for each in drawn if each.sort == sort}


# -- exports --------------------------------------------------------------------------------------


@settings(max_examples=30)
@given(recordings())
def test_exported_events(messages: list[m.AnyMessage]) -> None:
    timeline, session = timeline_of(messages), exported(messages)
    kinds: dict[str, type[Episode]] = {
        "action": Action,
        "trial": Trial,
        "break": Break,
        "stop": Stop,
        "questionnaire": Questionnaire,
    }
    for name, kind in kinds.items():
        assert [
            (each.seq, each.begin, each.end, each.label if name != "break" else "",
             *context(each.context), str(each.outcome))
            for each in timeline.of(kind)
        ] == [
            (each.seq, each.begin, each.end, each.label, each.participant, each.condition,
             each.trial, each.outcome)
            for each in session.events
            if each.kind == name and each.end is not None
        ], name  # fmt: skip
    assert [
        (each.seq, each.begin, each.started, each.end, each.label, str(each.outcome))
        for each in timeline.of(Command)
    ] == [
        (each.seq, each.begin, each.acted, each.end, each.label, each.outcome)
        for each in session.events
        if each.kind == "command" and not passing(each.verb, each.source)
    ]


@settings(max_examples=30)
@given(recordings())
def test_exported_moments_have_the_same_context(messages: list[m.AnyMessage]) -> None:
    timeline, session = timeline_of(messages), exported(messages)
    moments = {each.seq: each for each in timeline.of(Moment)}
    for event in session.events:
        if event.kind in ("marker", "note", "mistake", "preflight.checked", "console.lost"):
            found = moments[event.seq].context
            assert context(found) == (event.participant, event.condition, event.trial)


@settings(max_examples=30)
@given(recordings())
def test_exported_settings_add_up(messages: list[m.AnyMessage]) -> None:
    timeline, session = timeline_of(messages), exported(messages)
    rows: Counter[tuple[object, ...]] = Counter()
    for each in session.settings:
        key = (each.name, str(each.value), each.differs, each.participant, each.trial)
        rows[key] += each.end - each.begin
    found: Counter[tuple[object, ...]] = Counter()
    for setting in timeline.of(Setting):
        for part in timeline.parts(setting):
            who, _, trial = context(part.context)
            found[setting.name, str(setting.value), setting.differs, who, trial] += (
                part.end - part.begin
            )
    assert +found == +rows
    conflicts = [each for each in session.events if each.kind == "conflict"]
    assert sum(each.duration for each in timeline.of(Conflict)) == sum(
        each.duration for each in conflicts
    )


@settings(max_examples=30)
@given(recordings())
def test_exported_states_add_up(messages: list[m.AnyMessage]) -> None:
    timeline, session = timeline_of(messages), exported(messages)
    rows: Counter[tuple[Group, str]] = Counter()
    for row in session.engagement:
        rows[(row.participant, row.condition), row.label] += row.duration
    found: Counter[tuple[Group, str]] = Counter()
    for state in timeline.of(ModelState):
        for part in timeline.parts(state):
            found[group(part.context), state.label] += part.end - part.begin
    assert +found == +rows
    events = [each for each in session.events if each.kind == "engagement"]
    assert [(each.begin, each.end, each.label) for each in events] == [
        (each.begin, each.end, each.label) for each in timeline.of(ModelState)
    ]


def context(found: Context) -> tuple[str, str, int | None]:
    return found.participant, found.condition, found.trial


def passing(verb: str, source: str) -> bool:
    return verb == "control" and source == "midi"


# -- the running session --------------------------------------------------------------------------


def steps(messages: list[m.AnyMessage]) -> Iterator[tuple[SessionState, m.AnyMessage]]:
    state = SessionState()
    for message in messages:
        state.take(message)
        yield state, message
