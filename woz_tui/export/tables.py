"""The tables of an export and what their columns mean: the one place from which the CSV files, the
data dictionary and BIDS' sidecars come.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import msgspec

from woz_tui.analysis.rows import worded
from woz_tui.core.messages import Json, Reading
from woz_tui.export.course import OPEN, Answer, Event, Session, Setting
from woz_tui.export.text import seconds

Row = TypeVar("Row")
#: None: there is no value.
Cell = str | int | float | bool | None


@dataclass(frozen=True, slots=True)
class Column(Generic[Row]):
    """A column: its name, Frictionless type (string, number, integer, boolean, datetime), unit,
    meaning, and how a row's cell is found.
    """

    name: str
    type: str
    meaning: str
    cell: Callable[[Session, Row], Cell]
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Table(Generic[Row]):
    """Columns of one file; `key` are those that together tell rows apart."""

    name: str
    meaning: str
    columns: tuple[Column[Row], ...]
    key: tuple[str, ...] = ()

    def cells(self, session: Session, row: Row) -> list[Cell]:
        """One row."""
        return [column.cell(session, row) for column in self.columns]


def _s(us: int | None) -> Cell:
    return None if us is None else seconds(us)


def _value(value: Json) -> Cell:
    """Numbers stay numbers, so that no guard stands before a negative one."""
    return value if isinstance(value, int | float) else worded(value)


def _json(value: Mapping[str, object]) -> Cell:
    if not value:
        return None
    plain = msgspec.json.decode(msgspec.json.encode(value))
    return json.dumps(plain, ensure_ascii=False, allow_nan=False)


def _log(session: Session, _: object) -> Cell:
    return session.name


_WHOSE: tuple[Column[Any], ...] = (
    Column("log", "string", "name of the session's log, its own in this export", _log),
    Column("session", "string", "the session's code", lambda s, _: s.code or None),
    Column("participant", "string", "the participant's code", lambda _, e: e.participant or None),
    Column("condition", "string", "the condition at this time", lambda _, e: e.condition or None),
    Column("trial", "integer", "number of the trial; empty: in none", lambda _, e: e.trial),
)


EVENTS: Table[Event] = Table(
    "events",
    "What happened: one row each for an action, a command, a state of the engagement machine, a "
    "sentence of the visitor, a trial, a marker and so on, by time.",
    (
        *_WHOSE,
        Column(
            "onset_s",
            "number",
            "beginning, from the session's start",
            lambda _, e: _s(e.begin),
            "s",
        ),
        Column(
            "duration_s",
            "number",
            "from beginning to end; empty: a moment",
            lambda _, e: _s(e.duration) if e.end is not None else None,
            "s",
        ),
        Column(
            "kind",
            "string",
            "action, command, engagement, speech (the visitor's), trial, break, stop, "
            "questionnaire; difference: a robot's setting was other than asked for; conflict: of "
            "settings; of moments, the kind of the log's line: marker, note, sensor.changed ...",
            lambda _, e: e.kind,
        ),
        Column(
            "label",
            "string",
            "which one of its kind: the action's name, the command's verb, the state, the trial, "
            "the setting",
            lambda _, e: e.label or None,
        ),
        Column("panel", "string", "title of the action's panel", lambda _, e: e.panel or None),
        Column("action", "string", "name of the action", lambda _, e: e.action or None),
        Column("verb", "string", "what a command does: say, play ...", lambda _, e: e.verb or None),
        Column("driver", "string", "name of the driver", lambda _, e: e.driver or None),
        Column(
            "source",
            "string",
            "who asked: key, script, palette, midi, program, engagement, replay",
            lambda _, e: e.source or None,
        ),
        Column("key", "string", "the key that was pressed", lambda _, e: e.key or None),
        Column(
            "outcome",
            "string",
            "of actions and commands: done, failed, stopped, refused, timed_out, superseded; of "
            "states the transition that led to them; of settings and speech lost: its driver was "
            "lost; open: the log ended first",
            lambda _, e: e.outcome or None,
        ),
        Column(
            "latency_s",
            "number",
            "of actions and commands: from the request to the driver's start; of actions, to that "
            "of their first command to a driver",
            lambda _, e: _s(e.latency),
            "s",
        ),
        Column(
            "mistake",
            "boolean",
            "of actions: the wizard labelled it a mistake",
            lambda _, e: e.mistake if e.kind == "action" else None,
        ),
        Column(
            "text",
            "string",
            "said, typed or recognised; of a difference what the robot had and what was wanted",
            lambda _, e: e.text or None,
        ),
        Column("reason", "string", "why it ended so, in words", lambda _, e: e.reason or None),
        Column(
            "run", "string", "ties an action, its commands and mistakes", lambda _, e: e.run or None
        ),
        Column("command", "string", "id of the command", lambda _, e: e.command or None),
        Column(
            "details",
            "string",
            "what else the log says, a JSON object",
            lambda _, e: _json(e.details),
        ),
        Column("seq", "integer", "number of the line in the log", lambda _, e: e.seq),
    ),
)

ENGAGEMENT: Table[Event] = Table(
    "engagement",
    "States of the engagement machine: one row for each, from its beginning to its end, and one "
    "more wherever participant, condition or trial change, so that times add up by trial. While "
    "the machine is off it is in no state.",
    (
        *_WHOSE,
        Column(
            "onset_s",
            "number",
            "beginning, from the session's start",
            lambda _, e: _s(e.begin),
            "s",
        ),
        Column("duration_s", "number", "length", lambda _, e: _s(e.duration), "s"),
        Column("state", "string", "the state", lambda _, e: e.label),
        Column(
            "entered_by",
            "string",
            "name of the transition that led to it; empty: the machine began there",
            lambda _, e: e.outcome if e.outcome not in ("", OPEN) else None,
        ),
        Column(
            "left_by",
            "string",
            "name of the transition that ended it; empty: the log ended first, or the machine was "
            "switched off",
            lambda _, e: _of(e, "left_by"),
        ),
        Column("visitor", "string", "code of who was known", lambda _, e: _of(e, "visitor")),
        Column(
            "forced",
            "boolean",
            "the wizard led to it, or decided a verdict on which it rests",
            lambda _, e: bool(e.details.get("forced")),
        ),
        Column("why", "string", "why it was entered, in words", lambda _, e: e.text or None),
        Column(
            "changed",
            "boolean",
            "the state changed; false: only participant, condition or trial did",
            lambda _, e: e.changed,
        ),
    ),
)

ANSWERS: Table[Answer] = Table(
    "questionnaires",
    "The last answer to each item in each round of a questionnaire.",
    (
        *_WHOSE,
        Column(
            "questionnaire", "string", "name of the questionnaire", lambda _, a: a.questionnaire
        ),
        Column(
            "round",
            "integer",
            "how often it was put before in this session, plus 1",
            lambda _, a: a.round,
        ),
        Column("item", "string", "name of the item", lambda _, a: a.item),
        Column("value", "number", "the answer on the item's scale", lambda _, a: a.value),
        Column("low", "number", "lower end of the scale", lambda _, a: a.low),
        Column("high", "number", "upper end of the scale", lambda _, a: a.high),
        Column(
            "text", "string", "the answer to an item without a scale", lambda _, a: a.text or None
        ),
        Column("skipped", "boolean", "left out on purpose", lambda _, a: a.skipped),
        Column(
            "answered_s",
            "number",
            "from its being shown to the answer",
            lambda _, a: _s(a.took),
            "s",
        ),
        Column(
            "onset_s",
            "number",
            "when it was answered, from the session's start",
            lambda _, a: _s(a.at),
            "s",
        ),
        Column("question", "string", "the item's words", lambda _, a: a.question or None),
    ),
    key=("log", "questionnaire", "round", "item"),
)

SETTINGS: Table[Setting] = Table(
    "settings",
    "What robots had set, as it was read back from them: one row for each change of one setting, "
    "and one more wherever participant, condition or trial change, so that times add up by trial. "
    "Only robots that tell their settings are in it.",
    (
        *_WHOSE,
        Column(
            "onset_s",
            "number",
            "when it was read so, from the session's start",
            lambda _, each: _s(each.begin),
            "s",
        ),
        Column(
            "duration_s",
            "number",
            "until the next row of this setting, or the session's end",
            lambda _, each: _s(each.end - each.begin),
            "s",
        ),
        Column("driver", "string", "name of the driver", lambda _, each: each.driver or None),
        Column("setting", "string", "name of the setting", lambda _, each: each.name),
        Column(
            "value",
            "string",
            "what the robot had: true, false, a number, a text, or JSON; empty: an empty text, or "
            "unknown",
            lambda _, each: None if each.differs is None else _value(each.value),
        ),
        Column(
            "wanted",
            "string",
            "what was asked for, by the robot file or a command, where it differs",
            lambda _, each: _value(each.wanted) if each.differs else None,
        ),
        Column(
            "differs",
            "boolean",
            "it was other than asked for; empty: unknown, since the robot was lost or did not tell",
            lambda _, each: each.differs,
        ),
        Column(
            "changed",
            "boolean",
            "the setting changed; false: only participant, condition or trial did",
            lambda _, each: each.changed,
        ),
        Column("seq", "integer", "number of the line in the log", lambda _, each: each.seq),
    ),
)

SAMPLES: Table[tuple[Reading, str]] = Table(
    "samples",
    "Every value of every sensor, by time.",
    (
        Column("log", "string", "name of the session's log, its own in this export", _log),
        Column("t_s", "number", "time, from the session's start", lambda _, r: _s(r[0].t), "s"),
        Column("sensor", "string", "the quantity that is sensed", lambda _, r: r[0].sensor),
        Column("value", "number", "its value, in `unit`", lambda _, r: r[0].value),
        Column("unit", "string", "unit of `value`", lambda _, r: r[0].unit or None),
        Column("text", "string", "what is not a number: an identity", lambda _, r: r[1] or None),
        Column("driver", "string", "name of the driver", lambda _, r: r[0].driver or None),
        Column("raw", "number", "what the device said, in its unit", lambda _, r: r[0].raw),
    ),
)

SESSIONS: Table[None] = Table(
    "sessions",
    "The sessions of this export.",
    (
        Column("log", "string", "name of the session's log, its own in this export", _log),
        Column("session", "string", "the session's code", lambda s, _: s.code or None),
        Column(
            "participants",
            "string",
            "codes of all who took part, with blanks between",
            lambda s, _: " ".join(s.participants) or None,
        ),
        Column(
            "conditions",
            "string",
            "all conditions in order, a JSON list",
            lambda s, _: json.dumps(conditions_of(s), ensure_ascii=False),
        ),
        Column("wizard", "string", "the wizard's code", lambda s, _: s.wizard or None),
        Column("experiment", "string", "the experiment file", lambda s, _: _start(s, "experiment")),
        Column(
            "experiment_sha256",
            "string",
            "SHA-256 of the experiment file, hexadecimal",
            lambda s, _: _start(s, "experiment_sha256"),
        ),
        Column(
            "software",
            "string",
            "the program that recorded it",
            lambda s, _: " ".join(s.start.software.values()) if s.start else None,
        ),
        Column(
            "schema",
            "integer",
            "version of the log's format",
            lambda s, _: s.start.schema if s.start else None,
        ),
        Column(
            "seed",
            "integer",
            "seed of everything random",
            lambda s, _: s.start.seed if s.start else None,
        ),
        Column(
            "started",
            "datetime",
            "wall clock (UTC) at 0 of onset_s; empty: unknown, or dates were taken out",
            lambda s, _: s.started.isoformat() if s.started else None,
        ),
        Column("duration_s", "number", "time of the last line", lambda s, _: _s(s.duration), "s"),
        Column(
            "end",
            "string",
            "why it ended; empty: the log has no end",
            lambda s, _: s.end_reason or None,
        ),
        Column("lines", "integer", "lines in the log, samples not counted", lambda s, _: s.lines),
        Column(
            "damage",
            "string",
            "what is wrong with the log; empty: nothing",
            lambda s, _: "; ".join(s.damage) or None,
        ),
        Column("redacted", "boolean", "texts and dates were taken out", lambda s, _: s.redacted),
    ),
    key=("log",),
)


def conditions_of(session: Session) -> list[str]:
    """All conditions of a session in the order in which they came."""
    first = session.start.condition if session.start else ""
    conditions = dict.fromkeys([first, *(event.condition for event in session.events)])
    return [condition for condition in conditions if condition]


def _of(event: Event, name: str) -> Cell:
    value = event.details.get(name)
    return value if isinstance(value, str) and value else None


def _start(session: Session, name: str) -> Cell:
    value = getattr(session.start, name, None)
    return value if isinstance(value, str) and value else None
