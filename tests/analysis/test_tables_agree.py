"""Whatever two tables both say of a session, they say the same, to the microsecond: those of the
report, its page and its picture, those of exports, and the tiers for ELAN and Praat.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import given

from tests.analysis.example_sessions import figures_of
from tests.timeline.random_sessions import SECOND, damaged, recordings, start, timed
from woz_tui.analysis import tables
from woz_tui.analysis.feature_report import figure_tables
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import ENDS, PartFigures, SessionFigures
from woz_tui.analysis.html import timeline_items
from woz_tui.analysis.participants import condition_text
from woz_tui.analysis.timeline_lanes import drawing_of
from woz_tui.config.performers import performers
from woz_tui.export.event_extraction import EventExtractor
from woz_tui.export.event_model import ExportSession
from woz_tui.export.tiers import TierSpan, tiers_of
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.log.log_reader import LogLine
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.sensing.state_machine import ENGAGED
from woz_tui.timeline.timeline import timeline_of

Row = dict[str, Any]
#: Participant, condition, trial.
WHOSE = ("participant", "condition", "trial")
#: Participant, and the condition or "outside trials".
PART = ("participant", "part")


def us(seconds: object) -> int:
    """A time of a table in microseconds."""
    return round(float(str(seconds)) * SECOND)


@dataclass
class Tables:
    """All that is written of one session, as rows of the tables."""

    rows: dict[str, list[Row]]
    tiers: dict[str, list[TierSpan]]
    lanes: dict[str, list[timeline_items.TimelineItem]]
    figures: SessionFigures
    end: int

    def events(self, kind: str) -> list[Row]:
        """Those of this kind in `events.csv`."""
        return [row for row in self.rows["events"] if row["kind"] == kind]

    def tier(self, name: str) -> list[tuple[int, int]]:
        """When each of the spans begins and ends."""
        return sorted((span.begin, span.end) for span in self.tiers.get(name, []))

    def lane(self, title: str) -> list[tuple[int, int]]:
        """When each of the intervals begins and ends."""
        found = self.lanes.get(title, [])
        return sorted((item.begin, item.end) for item in found if item.end is not None)


def tables_of(lines: Sequence[m.Message]) -> Tables:
    """Each table, with empty cells as empty texts."""
    messages = [line for line in lines if not codec.is_sample(line)]
    figures = figures_of(messages, FigureOptions(all_trials=True))
    session, timeline = export_session(messages), timeline_of(messages)
    return Tables(
        rows={
            table.name: [
                _with_part(
                    {column.name: _cell(column.cell(figures, row)) for column in table.columns},
                    timeline.has_trials,
                )
                for row in rows
            ]
            for table, rows in (
                (tables.EVENTS, session.events),
                *((table, table.rows(figures)) for table in figure_tables()),
            )
        },
        tiers={tier.name: tier.spans for tier in tiers_of(session)},
        lanes={row.title: list(row.items) for row in timeline_items.rows(drawing_of(timeline))},
        figures=figures,
        end=timeline.end,
    )


def _with_part(row: Row, has_trials: bool) -> Row:
    """The row, and to which part of the figures it belongs."""
    outside = has_trials and row.get("trial", "") == ""
    return {**row, "part": "outside trials" if outside else row.get("condition", "")}


def _cell(value: object) -> object:
    return "" if value is None else value


def export_session(messages: Iterable[m.Message]) -> ExportSession:
    """As exports see it."""
    extractor = EventExtractor(ExportSession(name="x"))
    for message in messages:
        raw = codec.encode(message)
        fields = codec.decode_unknown(raw)
        kind = str(fields["kind"])
        extractor.add(message, LogLine(message.seq, message.t, "", kind, fields, raw, message))
    extractor.finish()
    return extractor.session


# -- what is compared -----------------------------------------------------------------------------


def added(rows: Iterable[Row], length: str, *keys: str) -> Counter[tuple[object, ...]]:
    """The lengths of rows together, by the values of these columns."""
    found: Counter[tuple[object, ...]] = Counter()
    for row in rows:
        found[tuple(row[key] for key in keys)] += us(row[length])
    return +found


def row_counts(rows: Iterable[Row], *keys: str) -> Counter[tuple[object, ...]]:
    """How many rows there are, by the values of these columns."""
    return Counter(tuple(row[key] for key in keys) for row in rows)


def _part(part: PartFigures) -> str:
    return condition_text(part.condition, part.scope)


def by_part(
    session_tables: Tables, of: Callable[[PartFigures], dict[tuple[object, ...], int]]
) -> Counter[Any]:
    """A figure of the report by participant, condition and what `of` tells apart."""
    found: Counter[Any] = Counter()
    for part in session_tables.figures.parts:
        for key, figure in of(part).items():
            found[part.participant, _part(part), *key] += figure
    return +found


def from_to(rows: Iterable[Row]) -> list[tuple[int, int]]:
    """When each event of an export began and ended."""
    times = [(us(row["onset"]), us(row["duration"] or 0)) for row in rows]
    return sorted((begin, begin + duration) for begin, duration in times)


def check_states(session_tables: Tables) -> None:
    """Time in states of the engagement model and engaged: by condition, and each stay."""
    stays = session_tables.rows["engagement"]
    engaged = [row for row in stays if row["state"] in ENGAGED]
    whose = PART
    assert added(stays, "duration", *whose) == by_part(
        session_tables, lambda p: {(): p.engagement.on_us}
    )
    assert added(stays, "duration", *whose, "state") == by_part(
        session_tables, lambda p: {(name,): state.us for name, state in p.engagement.states.items()}
    )
    assert added(engaged, "duration", *whose) == by_part(
        session_tables, lambda p: {(): p.engagement.engaged_us}
    )
    whole = [row for row in session_tables.rows["episodes"] if row["state"] == "engaged"]
    assert added(whole, "duration") == added(engaged, "duration")
    states = [row for row in session_tables.rows["episodes"] if row["state"] != "engaged"]
    events = session_tables.events("engagement")
    assert added(states, "duration", "state") == added(stays, "duration", "state")
    assert added(states, "duration", *WHOSE, "state") == added(
        ({**row, "state": row["label"]} for row in events), "duration", *WHOSE, "state"
    )
    assert row_counts(states, "state", "visitor") == row_counts(
        ({**row, "state": row["label"], "visitor": visitor(row)} for row in events),
        *("state", "visitor"),
    )
    begins = sorted((us(row["onset"]), us(row["onset"]) + us(row["duration"])) for row in states)
    assert (
        begins
        == from_to(events)
        == session_tables.tier("engagement")
        == session_tables.lane("engagement")
    )


def visitor(event: Row) -> object:
    return json.loads(event["details"] or "{}").get("visitor", "")


def check_trials(session_tables: Tables) -> None:
    """Trials with whose they were and how they ended, and breaks."""
    events = session_tables.events("trial")
    assert [
        (*(row[name] for name in WHOSE), us(row["onset"]), row["outcome"] or "open")
        for row in session_tables.rows["trials"]
    ] == [(*(row[name] for name in WHOSE), us(row["onset"]), row["outcome"]) for row in events]
    assert [us(row["duration"]) for row in session_tables.rows["trials"] if row["outcome"]] == [
        us(row["duration"]) for row in events if row["outcome"] != "open"
    ]
    breaks = sorted((each.begin, each.end) for each in session_tables.figures.breaks)
    assert breaks == from_to(session_tables.events("break")) == session_tables.tier("breaks")
    assert sorted([*from_to(events), *breaks]) == session_tables.lane("trials")
    assert from_to(events) == session_tables.tier("trials")


def check_actions(session_tables: Tables) -> None:
    """Actions by condition, panel, source and end; each on its tier and lane; commands."""
    events = session_tables.events("action")
    keys = (*PART, "label", "panel", "source", "outcome")
    assert row_counts(events, *keys) == by_part(
        session_tables,
        lambda part: {
            (row.action, row.panel, row.source, end): getattr(row.outcomes, end)
            for row in part.counts
            for end in ENDS
        },
    )
    for panel in {row["panel"] for row in events}:
        of_it = from_to(row for row in events if row["panel"] == panel)
        assert of_it == session_tables.tier(f"panel {panel}") == session_tables.lane(panel)
    direct = [
        row
        for row in session_tables.events("command")
        if not row["run"] and row["driver"] not in performers() and row["verb"] != "control"
    ]
    assert from_to(direct) == session_tables.lane("(improvised)")
    assert row_counts(direct, *PART) == by_part(session_tables, lambda p: {(): p.direct})
    anew = [row for row in events if row["edited"] and row["source"] != "engagement"]
    assert row_counts(anew, *PART) == by_part(session_tables, lambda p: {(): p.edited})
    wrong = [row for row in events if row["mistake"] and row["source"] != "engagement"]
    assert row_counts(wrong, *PART) == by_part(session_tables, lambda p: {(): p.mistakes})
    hands = [row for row in [*events, *direct] if row["source"] != "engagement"]
    assert sorted(us(row["latency"]) for row in hands if row["latency"] != "") == list(
        session_tables.figures.whole.press.values
    )


def check_speech(session_tables: Tables) -> None:
    events = session_tables.events("speech")
    ended = [row for row in events if row["outcome"] not in ("open", "lost")]
    assert row_counts(ended, *PART) == by_part(session_tables, lambda part: {(): part.utterances})
    assert added(ended, "duration") == Counter({(): session_tables.figures.whole.speech.total})
    assert (
        from_to(events)
        == session_tables.tier("visitor speech")
        == session_tables.lane("visitor speaks")
    )


def check_settings(session_tables: Tables) -> None:
    """Settings that differ, by whose they are and one by one."""
    rows = [row for row in session_tables.rows["settings"] if row["differs"] is True]
    events = session_tables.events("difference")
    keys = (*WHOSE, "driver", "setting")
    named = [{**row, "setting": row["label"]} for row in events]
    assert added(rows, "duration", *keys) == added(named, "duration", *keys)
    pieces = from_to(rows)
    assert pieces == from_to(events) == session_tables.tier("settings that differ")
    together = session_tables.lane("settings differ")
    assert sum(end - begin for begin, end in pieces) == sum(end - begin for begin, end in together)


def check_moments(session_tables: Tables) -> None:
    """Stops, markers, notes, questionnaires, answers."""
    assert sorted(
        (each.t, session_tables.end if each.released is None else each.released)
        for each in session_tables.figures.stops
    ) == from_to(session_tables.events("stop"))
    assert (
        from_to(session_tables.events("stop"))
        == session_tables.tier("stops")
        == session_tables.lane("stop")
    )
    whose = PART
    assert row_counts(session_tables.events("stop"), *whose) == by_part(
        session_tables, lambda part: {(): part.stops}
    )
    assert row_counts(session_tables.events("marker"), *whose) == by_part(
        session_tables, lambda part: {(): part.markers}
    )
    assert row_counts(session_tables.events("note"), *whose) == by_part(
        session_tables, lambda part: {(): part.notes}
    )
    assert sorted(
        (each.questionnaire, each.t) for each in asked_in(session_tables.figures).rounds
    ) == sorted((row["label"], us(row["onset"])) for row in session_tables.events("questionnaire"))


def check_times(messages: Sequence[m.Message]) -> Tables:
    """Time by condition, and what of it was spent how."""
    session_tables = tables_of(messages)
    assert sum(part.us for part in session_tables.figures.parts) == session_tables.figures.whole.us
    assert session_tables.figures.whole.us == session_tables.figures.duration_us
    check_states(session_tables)
    check_settings(session_tables)
    return session_tables


def check(messages: Sequence[m.Message]) -> Tables:
    """Everything."""
    session_tables = check_times(messages)
    check_trials(session_tables)
    check_actions(session_tables)
    check_speech(session_tables)
    check_moments(session_tables)
    return session_tables


@given(recordings())
def test_all_tables_say_the_same(messages: list[m.Message]) -> None:
    check(messages)


@given(damaged())
def test_times_of_a_damaged_log_are_the_same_in_all_tables(messages: list[m.Message]) -> None:
    check_times(messages)


# -- one engagement over three conditions ---------------------------------------------------------


def engagement_changed(was: str, now: str, **more: Any) -> m.EngagementChanged:
    return m.EngagementChanged(was=was, now=now, outcome="o", why="", verdicts={}, **more)


ENGAGED_95_S = timed(
    (0, start(condition="neutral")),
    (0, m.EngagementAdopted(settings={"start": "run"})),
    (1, m.TrialStarted(trial=1, condition="neutral")),
    (10, engagement_changed("Wait", "EngagedWithKnown", visitor="V01")),
    (20, m.TrialEnded(trial=1, outcome="done")),
    (20, m.TrialStarted(trial=2, condition="empathic")),
    (80, m.TrialEnded(trial=2, outcome="done")),
    (80, m.TrialStarted(trial=3, condition="funny")),
    (105, engagement_changed("EngagedWithKnown", "PersonDetected")),
    (120, m.SessionEnd(reason="wizard")),
)


def test_an_engagement_that_begins_before_a_condition_and_covers_it_is_one_in_every_table() -> None:
    """95 s: it begins in *neutral* and covers all of *empathic*."""
    session_tables = check(ENGAGED_95_S)
    engaged = {part.condition: part.engagement for part in session_tables.figures.parts}
    assert {name: each.engaged_us // SECOND for name, each in engaged.items()} == {
        "neutral": 10, "empathic": 60, "funny": 25, "": 0,
    }  # fmt: skip
    assert engaged["empathic"].share == 1
    assert {name: list(each.episodes.values) for name, each in engaged.items()} == {
        "neutral": [10 * SECOND], "empathic": [60 * SECOND], "funny": [25 * SECOND], "": [],
    }  # fmt: skip
    whole = session_tables.figures.whole.engagement
    assert list(whole.episodes.values) == [95 * SECOND]
    assert sum(each.visits for each in whole.states.values()) == 3
    [row] = [row for row in session_tables.rows["episodes"] if row["state"] == "engaged"]
    assert (row["condition"], row["trial"], us(row["duration"])) == ("neutral", 1, 95 * SECOND)
    stays = [row for row in session_tables.rows["engagement"] if row["state"] == "EngagedWithKnown"]
    assert [
        (row["condition"], row["trial"], us(row["duration"]), row["changed"]) for row in stays
    ] == [
        ("neutral", 1, 10 * SECOND, True),
        ("empathic", 2, 60 * SECOND, False),
        ("funny", 3, 25 * SECOND, False),
    ]
    [event] = [
        row for row in session_tables.events("engagement") if row["label"] == "EngagedWithKnown"
    ]
    assert (event["condition"], us(event["duration"])) == ("neutral", 95 * SECOND)
    assert (10 * SECOND, 105 * SECOND) in session_tables.tier("engagement")
    assert (10 * SECOND, 105 * SECOND) in session_tables.lane("engagement")
