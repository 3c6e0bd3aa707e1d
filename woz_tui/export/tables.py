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


def _plain(type_: str, name: str, meaning: str, of: str = "") -> Column[Any]:
    """An attribute of the row as it is: the one called `of`, by default as the column."""
    return Column(name, type_, meaning, lambda _, row: getattr(row, of or name))


def _text(name: str, meaning: str, of: str = "") -> Column[Any]:
    """An attribute that is a text; there is no value where it is empty."""
    return Column(name, "string", meaning, lambda _, row: getattr(row, of or name) or None)


def _time(name: str, meaning: str, of: str) -> Column[Any]:
    """An attribute in microseconds, in seconds."""
    return Column(name, "number", meaning, lambda _, row: _s(getattr(row, of)), "s")


def _detail(name: str, meaning: str) -> Column[Event]:
    """A text among the details of an event."""

    def cell(_: Session, event: Event) -> Cell:
        value = event.details.get(name)
        return value if isinstance(value, str) and value else None

    return Column(name, "string", meaning, cell)


def _start(type_: str, name: str, meaning: str) -> Column[Session]:
    """What the first line of a session's log says."""
    return Column(name, type_, meaning, lambda s, _: getattr(s.start, name, None))


_LOG: Column[Any] = Column(
    "log", "string", "name of the session's log, its own in this export", lambda s, _: s.name
)
_SESSION: Column[Any] = Column(
    "session", "string", "the session's code", lambda s, _: s.code or None
)
_WHOSE: tuple[Column[Any], ...] = (
    _LOG,
    _SESSION,
    _text("participant", "the participant's code"),
    _text("condition", "the condition at this time"),
    _plain("integer", "trial", "number of the trial; empty: in none"),
)
_ONSET = _time("onset_s", "beginning, from the session's start", "begin")
_SEQ = _plain("integer", "seq", "number of the line in the log")


EVENTS: Table[Event] = Table(
    "events",
    "What happened: one row each for an action, a command, a state of the engagement machine, a "
    "sentence of the visitor, a trial, a marker and so on, by time.",
    (
        *_WHOSE,
        _ONSET,
        Column(
            "duration_s",
            "number",
            "from beginning to end; empty: a moment",
            lambda _, e: _s(e.duration) if e.end is not None else None,
            "s",
        ),
        _text(
            "kind",
            "action, command, engagement, speech (the visitor's), trial, break, stop, "
            "questionnaire; difference: a robot's setting was other than asked for; conflict: of "
            "settings; of moments, the kind of the log's line: marker, note, sensor.changed ...",
        ),
        _text(
            "label",
            "which one of its kind: the action's name, the command's verb, the state, the trial, "
            "the setting",
        ),
        _text("panel", "title of the action's panel"),
        _text("action", "name of the action"),
        _text("verb", "what a command does: say, play ..."),
        _text("driver", "name of the driver"),
        _text("source", "who asked: key, script, palette, midi, program, engagement, replay"),
        _text("key", "the key that was pressed"),
        _text(
            "outcome",
            "of actions and commands: done, failed, stopped, refused, timed_out, superseded; of "
            "states the transition that led to them; of settings and speech lost: its driver was "
            "lost; open: the log ended first",
        ),
        _time(
            "latency_s",
            "of actions and commands: from the request to the driver's start; of actions, to that "
            "of their first command to a driver",
            "latency",
        ),
        Column(
            "mistake",
            "boolean",
            "of actions: the wizard labelled it a mistake",
            lambda _, e: e.mistake if e.kind == "action" else None,
        ),
        _text(
            "text",
            "said, typed or recognised; of a difference what the robot had and what was wanted",
        ),
        _text("reason", "why it ended so, in words"),
        _text("run", "ties an action, its commands and mistakes"),
        _text("command", "id of the command"),
        Column(
            "details",
            "string",
            "what else the log says, a JSON object",
            lambda _, e: _json(e.details),
        ),
        _SEQ,
    ),
)

ENGAGEMENT: Table[Event] = Table(
    "engagement",
    "States of the engagement machine: one row for each, from its beginning to its end, and one "
    "more wherever participant, condition or trial change, so that times add up by trial. While "
    "the machine is off it is in no state.",
    (
        *_WHOSE,
        _ONSET,
        _time("duration_s", "length", "duration"),
        _text("state", "the state", "label"),
        Column(
            "entered_by",
            "string",
            "name of the transition that led to it; empty: the machine began there",
            lambda _, e: e.outcome if e.outcome not in ("", OPEN) else None,
        ),
        _detail(
            "left_by",
            "name of the transition that ended it; empty: the log ended first, or the machine was "
            "switched off",
        ),
        _detail("visitor", "code of who was known"),
        Column(
            "forced",
            "boolean",
            "the wizard led to it, or decided a verdict on which it rests",
            lambda _, e: bool(e.details.get("forced")),
        ),
        _text("why", "why it was entered, in words", "text"),
        _plain(
            "boolean",
            "changed",
            "the state changed; false: only participant, condition or trial did",
        ),
    ),
)

ANSWERS: Table[Answer] = Table(
    "questionnaires",
    "The last answer to each item in each round of a questionnaire.",
    (
        *_WHOSE,
        _text("questionnaire", "name of the questionnaire"),
        _plain("integer", "round", "how often it was put before in this session, plus 1"),
        _text("item", "name of the item"),
        _plain("number", "value", "the answer on the item's scale"),
        _plain("number", "low", "lower end of the scale"),
        _plain("number", "high", "upper end of the scale"),
        _text("text", "the answer to an item without a scale"),
        _plain("boolean", "skipped", "left out on purpose"),
        _time("answered_s", "from its being shown to the answer", "took"),
        _time("onset_s", "when it was answered, from the session's start", "at"),
        _text("question", "the item's words"),
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
        _time("onset_s", "when it was read so, from the session's start", "begin"),
        _time("duration_s", "until the next row of this setting, or the session's end", "duration"),
        _text("driver", "name of the driver"),
        _text("setting", "name of the setting", "name"),
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
        _plain(
            "boolean",
            "differs",
            "it was other than asked for; empty: unknown, since the robot was lost or did not tell",
        ),
        _plain(
            "boolean",
            "changed",
            "the setting changed; false: only participant, condition or trial did",
        ),
        _SEQ,
    ),
)

SAMPLES: Table[Reading] = Table(
    "samples",
    "Every value of every sensor, by time.",
    (
        _LOG,
        _time("t_s", "time, from the session's start", "t"),
        _text("sensor", "the quantity that is sensed"),
        _plain("number", "value", "its value, in `unit`"),
        _text("unit", "unit of `value`"),
        _text("text", "what is not a number: an identity"),
        _text("driver", "name of the driver"),
        _plain("number", "raw", "what the device said, in its unit"),
    ),
)

SESSIONS: Table[Session] = Table(
    "sessions",
    "The sessions of this export.",
    (
        _LOG,
        _SESSION,
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
        _text("wizard", "the wizard's code"),
        _start("string", "experiment", "the experiment file"),
        _start("string", "experiment_sha256", "SHA-256 of the experiment file, hexadecimal"),
        Column(
            "software",
            "string",
            "the program that recorded it",
            lambda s, _: " ".join(s.start.software.values()) if s.start else None,
        ),
        _start("integer", "schema", "version of the log's format"),
        _start("integer", "seed", "seed of everything random"),
        Column(
            "started",
            "datetime",
            "wall clock (UTC) at 0 of onset_s; empty: unknown, or dates were taken out",
            lambda s, _: s.started.isoformat() if s.started else None,
        ),
        _time("duration_s", "time of the last line", "duration"),
        _text("end", "why it ended; empty: the log has no end", "end_reason"),
        _plain("integer", "lines", "lines in the log, samples not counted"),
        Column(
            "damage",
            "string",
            "what is wrong with the log; empty: nothing",
            lambda s, _: "; ".join(s.damage) or None,
        ),
        _plain("boolean", "redacted", "texts and dates were taken out"),
    ),
    key=("log",),
)


def conditions_of(session: Session) -> list[str]:
    """All conditions of a session in the order in which they came."""
    first = session.start.condition if session.start else ""
    conditions = dict.fromkeys([first, *(event.condition for event in session.events)])
    return [condition for condition in conditions if condition]
