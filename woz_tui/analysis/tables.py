"""The tables of `woz report --csv` and `woz export`: the one place that says which columns there
are and what they mean. CSV files, data dictionary, BIDS' sidecars and docs/reference/tables.md
come from it.

Names are those of BIDS where it has some: `onset` and `duration` in seconds, `response_time`. A
time without a unit in its name is in seconds; figures (medians, shares, sums) end in their unit.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any, Generic, TypeVar

import msgspec

from woz_tui.analysis.event_rows import (
    CUE_TYPES,
    CueRow,
    PhaseRow,
    SettingRow,
    TrialRow,
    VisitRow,
    value_text,
)
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.figures import (
    COMMAND_ENDS,
    ENDS,
    ActionCount,
    PartFigures,
    SessionFigures,
    VerbTimes,
    WizardCount,
)
from woz_tui.analysis.measures import MEASURES, Measure, milliseconds, seconds
from woz_tui.analysis.text_format import listed
from woz_tui.feature import pieces
from woz_tui.protocol.action_messages import EVIDENCE
from woz_tui.protocol.messages import Json, Reading
from woz_tui.system.text_cleaning import seconds as exact

Row = TypeVar("Row")
#: None: there is no value.
Cell = str | int | float | bool | None


@dataclass(frozen=True, slots=True)
class Column(Generic[Row]):
    """A column: its name, Frictionless type (string, number, integer, boolean, datetime), meaning,
    how a row's cell is found, unit; `more`: what a data package says of the field besides.
    """

    name: str
    type: str
    meaning: str
    cell: Callable[[SessionFigures, Row], Cell]
    unit: str = ""
    more: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class TableDefinition(Generic[Row]):
    """Columns of one file; `rows` are what it has of a session, `key` the columns that together
    tell rows apart.
    """

    name: str
    meaning: str
    columns: tuple[Column[Row], ...]
    rows: Callable[[SessionFigures], Iterable[Row]]
    key: tuple[str, ...] = ()


def _nothing(_: SessionFigures) -> tuple[()]:
    """No rows: those of this table are written by whoever reads the log."""
    return ()


def _value(value: Json) -> Cell:
    """A setting's value: numbers stay numbers, so that no guard is put before a negative one."""
    return value if isinstance(value, int | float) else value_text(value)


def _mistake(_: SessionFigures, event: Any) -> Cell:
    own = event.kind == "action" or (event.kind == "command" and not event.run)
    return bool(event.mistake) if own else None


def _details(_: SessionFigures, event: Any) -> Cell:
    if not event.details:
        return None
    plain = msgspec.json.decode(msgspec.json.encode(event.details))
    return json.dumps(plain, ensure_ascii=False, allow_nan=False)


def _plain(type_: str, name: str, meaning: str) -> Column[Any]:
    """An attribute of the row as it is."""
    return Column(name, type_, meaning, lambda _, row: getattr(row, name))


def _text(name: str, meaning: str, of: str = "") -> Column[Any]:
    """An attribute that is a text; there is no value where it is empty."""
    return Column(name, "string", meaning, lambda _, row: getattr(row, of or name) or None)


def rounded(value: float | None) -> Cell:
    """A number with nine decimals at most; a whole one without a dot."""
    if not isinstance(value, float):
        return value
    return int(value) if value.is_integer() and abs(value) < 1e15 else round(value, 9)


def _time(name: str, meaning: str, of: str) -> Column[Any]:
    """An attribute in microseconds, in seconds."""

    def cell(_: SessionFigures, row: object) -> Cell:
        us: int | None = getattr(row, of)
        return None if us is None else exact(us)

    return Column(name, "number", meaning, cell, "s")


def _figure(
    name: str, type_: str, meaning: str, of: Callable[[Any], Any], unit: str = ""
) -> Column[Any]:
    """A number that was computed."""
    return Column(name, type_, meaning, lambda _, row: rounded(of(row)), unit)


def _session(type_: str, name: str, meaning: str, of: str = "") -> Column[Any]:
    """An attribute of the session."""

    def cell(figures: SessionFigures, _: object) -> Cell:
        found: Cell = getattr(figures, of or name)
        return None if found == "" else found

    return Column(name, type_, meaning, cell)


_LOG = _session("string", "log", "name of the session's log, without `.jsonl`", "stem")
_CODE = _session("string", "session", "the session's code")
_PARTICIPANT = _text("participant", "the participant's code")
_CONDITION = _text("condition", "the condition at this time")


def wall_time(text: str) -> datetime | None:
    """Parses a wall clock time, in UTC; None if the log does not say or dates were taken out."""
    try:
        wall = datetime.fromisoformat(text)
        return wall.astimezone(UTC) if wall.tzinfo else wall.replace(tzinfo=UTC)
    except (ValueError, OverflowError):
        return None


def _begun(figures: SessionFigures, _: object) -> Cell:
    wall = wall_time(figures.started)
    return wall.isoformat() if wall is not None else None


_STARTED: Column[Any] = Column(
    *("started", "datetime"),
    "wall clock (UTC) at 0 of `onset`; empty: unknown, or dates were taken out",
    _begun,
)


_SCOPE = _text(
    "scope",
    "trials: the time in trials of this condition; outside: outside of trials, in whatever "
    "condition, breaks included; session: the session has no trials",
)


def _number(_: SessionFigures, row: Any) -> Cell:
    trial: int | None = row.trial
    return None if trial is None or trial < 0 else trial


_WHOSE: tuple[Column[Any], ...] = (
    *(_LOG, _CODE, _PARTICIPANT, _CONDITION),
    Column("trial", "integer", "number of the trial; empty: in none", _number),
)
_WHERE: tuple[Column[Any], ...] = (
    *_WHOSE,
    _text("phase", "name of the phase of the experiment in which it began; empty: in none"),
)
_ONSET = _time("onset", "beginning, from the session's start", "begin")
_MOMENT = _time("onset", "its moment, from the session's start", "t")
_DURATION = _time("duration", "from beginning to end", "duration")
_SEQ: Column[Any] = Column(
    *("seq", "integer", "number of the line in the log; empty: it is none"),
    lambda _, row: None if row.seq < 0 else row.seq,
)
_COUNTED = _plain(
    *("boolean", "counted"),
    "means include it: it has a participant, and where there are trials it was in one that counts",
)
_PIECE = "false: only participant, condition, trial or a break changed"


# -- sessions and conditions ----------------------------------------------------------------------


def _named(name: str, meaning: str, of: Callable[[SessionFigures], Cell]) -> Column[SessionFigures]:
    return Column(name, "string", meaning, lambda figures, _: of(figures) or None)


def _is_apart(name: str, meaning: str) -> Column[SessionFigures]:
    return Column(name, "boolean", meaning, lambda figures, _: name in figures.features)


#: What can be a cue, those that features give included.
_ALL_CUE_TYPES = (
    *CUE_TYPES,
    *(sort for each in pieces("figures", FeatureFigures).values() for sort in each.cue_types),
)

SESSIONS: TableDefinition[SessionFigures] = TableDefinition(
    "sessions",
    "One row for each session.",
    (
        *(_LOG, _CODE),
        _named(
            "participants", "codes of all who took part, with blanks between",
            lambda it: " ".join(it.participants),
        ),
        _named(
            "conditions", "all conditions in order, a JSON list",
            lambda it: json.dumps(it.conditions, ensure_ascii=False),
        ),
        _session("string", "wizard", "the wizard's code"),
        _session("string", "experiment", "the experiment file"),
        _session(
            "string", "experiment_sha256",
            "SHA-256 of the experiment file and its robot files, one behind the other",
        ),
        _session("string", "file_sha256", "SHA-256 of the experiment file; empty: not recorded"),
        _session("string", "software", "the program that recorded it, its version and commit"),
        _plain("integer", "schema", "version of the log's format"),
        _plain("integer", "seed", "seed of everything random"),
        _STARTED,
        _plain(
            *("integer", "monotonic_us"),
            "CLOCK_MONOTONIC of the robot's computer at 0 of `onset`, in microseconds: what else"
            " was recorded there has this clock; empty: not recorded",
        ),
        _time("duration", "from its first to its last line of actions", "duration_us"),
        _session("string", "end", "why it ended; empty: the log has no end", "ended"),
        *(
            _is_apart(name, each.apart.meaning)
            for name, each in pieces("figures", FeatureFigures).items()
            if each.apart is not None
        ),
        _session("string", "rerun_of", "the log whose commands were run again"),
        _plain("integer", "lines", "lines in the log, samples not counted"),
        _named(
            "damage", "damage of the log; empty: none",
            lambda it: "; ".join(it.wholeness.sentences),
        ),
        _plain("boolean", "redacted", "texts and dates were taken out"),
        _session("string", "robot", "the robot that played instead of the file's own; empty: none"),
    ),
    lambda figures: (figures,),
    key=("log",),
)  # fmt: skip


def _main(measure: Measure) -> Column[PartFigures]:
    kind = "number" if measure.unit else "integer"
    return _figure(measure.name, kind, measure.meaning, measure.of, measure.unit)


_IN_MEANS: Column[PartFigures] = Column(
    *("counted", "boolean", "means include it: it has a participant, and it is not outside"),
    lambda _, part: part.in_means,
)
CONDITIONS: TableDefinition[PartFigures] = TableDefinition(
    "conditions",
    "The main figures: one row for each participant and condition of a session, and one for the "
    "time outside of trials.",
    (
        *(_LOG, _CODE, _PARTICIPANT, _CONDITION, _SCOPE, _IN_MEANS),
        *map(_main, MEASURES),
    ),
    lambda figures: figures.parts,
)


# -- what happened --------------------------------------------------------------------------------


EVENTS: TableDefinition[Any] = TableDefinition(
    "events",
    "What happened: one row each for an action, a command, a state of the engagement machine, a "
    "sentence of the visitor, a trial, a marker and so on, by time. What lasts is in the condition "
    "and trial in which it began.",
    (
        *_WHERE,
        _ONSET,
        Column(
            *("duration", "number", "from beginning to end; empty: a moment"),
            lambda _, event: None if event.end is None else exact(event.duration),
            "s",
        ),
        _text(
            "kind",
            "action, command, engagement, speech (the visitor's), trial, phase, break, stop, "
            "questionnaire; difference: a robot's setting differed from the requested value;"
            " conflict: of "
            "settings; code: what a coder (`source`) set in a replay, with its tier as `label`; of "
            "moments, the kind of the log's line: marker, note, sensor.changed ...",
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
        _text(
            "source",
            "who asked: key, script, palette, midi, gamepad, stream-deck, spacemouse, "
            "wii-remote, imu, program, phase, "
            "engagement, replay; of a command also driver",
        ),
        _text("key", "the key that was pressed"),
        _text(
            "outcome",
            "of actions and commands: done, failed, stopped, refused, timed_out, superseded, "
            "left_out (an action of which this robot does nothing); of "
            "states the transition that led to them; of settings and speech lost: its driver was "
            "lost; open: the log ended first",
        ),
        _time(
            "latency",
            "of actions and commands: from the request to the driver's start; of actions, to that "
            "of their first command to a driver",
            "latency",
        ),
        Column(
            "mistake",
            "boolean",
            "of actions, and of commands that belong to none: the wizard labelled it a mistake",
            _mistake,
        ),
        Column(
            *("edited", "boolean"),
            "of actions: the wizard typed their sentence anew before it was said",
            lambda _, event: event.edited if event.kind == "action" else None,
        ),
        _text(
            "text",
            "said, typed or recognised; of a difference what the robot had and what was wanted",
        ),
        _text(
            "evidence",
            "of actions and commands, on what it stands that they were done: measured (a sensor of "
            "the device), reported (by the device or its program), timed (sent; nobody can know "
            "more); empty: it reaches no hardware, or the log does not say",
        ),
        _text("reason", "why it ended so, in words"),
        _text("run", "ties an action, its commands and mistakes"),
        _text("command", "id of the command"),
        Column(
            *("details", "string", "what else the log says, a JSON object"),
            _details,
        ),
        _COUNTED,
        _SEQ,
    ),
    _nothing,
)

TRIALS: TableDefinition[TrialRow] = TableDefinition(
    "trials",
    "One row for each trial that was begun, also those that are not counted.",
    (
        *_WHOSE,
        _ONSET,
        _time("duration", "until its end; empty if it has none", "duration"),
        _text("outcome", "done, aborted or excluded; empty if it has no end"),
        _text("text", "what the wizard remarked"),
        _plain(
            "boolean",
            "counted",
            "its data count: neither aborted nor excluded, no practice (number 0), and the log "
            "does not break off in it",
        ),
        _plain("integer", "actions", "actions that were asked for in it"),
    ),
    lambda figures: figures.trials,
)


PHASES: TableDefinition[PhaseRow] = TableDefinition(
    "phases",
    "One row for each phase of the experiment that was begun; its time goes on through breaks.",
    (
        *_WHOSE,
        _text("phase", "name of the phase"),
        _ONSET,
        _time("duration", "until the next phase or the trial's end; empty: no end in the log",
              "duration"),
        _time("planned", "how long it was to last; empty: nobody said", "planned"),
        _text("source", "who began it: key, palette, program; trial, session: it began with that"),
        _plain("integer", "actions", "actions that were asked for in it"),
        _COUNTED,
    ),
    lambda figures: figures.phases,
)  # fmt: skip


def _counts(figures: SessionFigures) -> Iterator[tuple[PartFigures, ActionCount]]:
    return ((part, count) for part in figures.parts for count in part.counts)


def _of_first(column: Column[Any]) -> Column[Any]:
    """The column of rows that begin with the part to which they belong."""
    return replace(column, cell=lambda figures, row: column.cell(figures, row[0]))


_PARTS = (_LOG, _CODE, *map(_of_first, (_PARTICIPANT, _CONDITION, _SCOPE, _IN_MEANS)))


def _count(name: str, meaning: str, of: Callable[[ActionCount], Cell], kind: str) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, row: of(row[1]))


def _ended(end: str) -> Column[Any]:
    return _count(
        *(end, f"how often it ended so: {end}"), lambda it: getattr(it.outcomes, end), "integer"
    )


ACTIONS: TableDefinition[tuple[PartFigures, ActionCount]] = TableDefinition(
    "actions",
    "One row for each participant, condition, action, panel and source: how often, and how it "
    "ended.",
    (
        *_PARTS,
        _count("action", "name of the action", lambda it: it.action, "string"),
        _count("panel", "title of the panel", lambda it: it.panel or None, "string"),
        _count(
            "source",
            "who asked: key, script, palette, midi, gamepad, stream-deck, spacemouse, "
            "wii-remote, imu, program, phase, "
            "engagement, replay",
            *(lambda it: it.source or None, "string"),
        ),
        _count("total", "how often it was asked for", lambda it: it.outcomes.total, "integer"),
        *map(_ended, ENDS),
    ),
    _counts,
)


def _by_wizard(
    name: str, meaning: str, of: Callable[[WizardCount], Cell], kind: str = "integer"
) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, row: of(row[1]))


WIZARDS: TableDefinition[tuple[PartFigures, WizardCount]] = TableDefinition(
    "wizards",
    "One row for each participant, condition and connection over which somebody played by hand: "
    "what each of several wizards did.",
    (
        *_PARTS,
        _by_wizard(
            *("part", "the wizard's part of the panels; empty: none in particular"),
            *(lambda it: it.part or None, "string"),
        ),
        _by_wizard(
            *("console", "name of the connection; of a control panel, its driver; empty: unknown"),
            *(lambda it: it.console or None, "string"),
        ),
        _by_wizard("total", "actions that were asked for", lambda it: it.outcomes.total),
        *map(_ended, ENDS),
        _by_wizard("direct", "commands by hand that belong to no action", lambda it: it.direct),
        _by_wizard("mistakes", "acts that were called a mistake", lambda it: it.mistakes),
        _by_wizard(
            "edited",
            "actions whose sentence was typed anew before it was said",
            lambda it: it.edited,
        ),
    ),
    lambda figures: ((part, each) for part in figures.parts for each in part.wizards),
)


def _verbs(figures: SessionFigures) -> Iterator[tuple[PartFigures, str, VerbTimes]]:
    return ((part, *item) for part in figures.parts for item in part.verbs.items())


def _how_many(end: str) -> Column[Any]:
    return Column(
        end, "integer", f"how many ended so: {end}", lambda _, row: row[2].ends.get(end, 0)
    )


def _how_sure(evidence: str) -> Column[Any]:
    return Column(
        *(evidence, "integer", f"how many of `done` are known so: {evidence}"),
        lambda _, row: row[2].evidence.get(evidence, 0),
    )


def _spread(name: str, meaning: str, attribute: str, *, fine: bool) -> Iterator[Column[Any]]:
    unit, convert = ("ms", milliseconds) if fine else ("s", seconds)

    def column(figure: str, words: str, of: str) -> Column[Any]:
        return _figure(
            *(f"{name}_{figure}_{unit}", "number", f"{words} {meaning}"),
            *(lambda row: convert(getattr(getattr(row[2], attribute), of)), unit),
        )

    yield column("median", "median", "median")
    yield column("p95", "95 % quantile of the", "p95")
    yield column("max", "longest", "most")


LATENCIES: TableDefinition[tuple[PartFigures, str, VerbTimes]] = TableDefinition(
    "latencies",
    "One row for each participant, condition and verb: a robot's commands and how long they took; "
    "knobs on their way, and what a robot shows of the engagement model by itself, are not "
    "counted.",
    (
        *_PARTS,
        Column("verb", "string", "what was to be done", lambda _, row: row[1]),
        Column("commands", "integer", "how many commands", lambda _, row: row[2].commands),
        *map(_how_many, COMMAND_ENDS),
        *map(_how_sure, reversed(EVIDENCE)),
        *_spread("dispatch", "time from a command's request to its start", "dispatched", fine=True),
        *_spread("perform", "time from its start to `command.done`", "done", fine=False),
    ),
    _verbs,
)

CUES: TableDefinition[CueRow] = TableDefinition(
    "cues",
    "One row for each cue, and the wizard's answer.",
    (
        *_WHERE,
        _MOMENT,
        _text("cue_type", listed(_ALL_CUE_TYPES, "or")),
        _text("label", "the utterance, the state, the marker's text, the trained cue", "what"),
        _text("result", "answered, answered_early, missed, superseded or cut"),
        _time("response_time", "from the cue to the act that answered it", "reaction_us"),
        _text("action", "that act: the action's name, or a command's verb"),
        _text("run", "id of that run or command in the log"),
        _plain("boolean", "echo", "stands for the same event as another cue within 1 s"),
        _text("judged", "of trained cues: right, wrong or missed"),
        _COUNTED,
    ),
    lambda figures: figures.cues,
)


# -- engagement and settings ----------------------------------------------------------------------

_STAY: tuple[Column[VisitRow], ...] = (
    *_WHERE,
    _ONSET,
    _DURATION,
    _text("state", "name of the state"),
    _text("entered_by", "name of the transition that led to it; empty: the machine began there"),
    _text(
        "left_by",
        "name of the transition that ended it; empty: the log ended first, or the machine was "
        "switched off",
    ),
    _text("visitor", "code of the identified visitor"),
    _plain("boolean", "forced", "somebody caused it by hand, or set a sign that caused it"),
    _text("why", "why it was entered, in words"),
)
_CUT = _plain("boolean", "cut", "the log, or the machine, ended before it")

ENGAGEMENT: TableDefinition[VisitRow] = TableDefinition(
    "engagement",
    "States of the engagement machine, clipped to trials: one row for each, from its beginning to "
    "its end, and one more wherever participant, condition or trial change, so that times add up "
    "by trial. While the machine is off it is in no state.",
    (*_STAY, _plain("boolean", "changed", f"the state changed; {_PIECE}"), _CUT, _COUNTED),
    lambda figures: figures.stays,
)

EPISODES: TableDefinition[VisitRow] = TableDefinition(
    "episodes",
    "Not clipped: one row for each stay in a state of the engagement machine, and for each "
    "unbroken engagement (`engaged`), however many trials it spans; participant, condition, trial "
    "and visitor are those of its beginning.",
    (*_STAY, _CUT),
    lambda figures: figures.visits,
)

SETTINGS: TableDefinition[SettingRow] = TableDefinition(
    "settings",
    "What robots had set, as it was read back from them: one row for each change of one setting, "
    "and one more wherever participant, condition or trial change, so that times add up by trial. "
    "Only robots that tell their settings are in it.",
    (
        *_WHERE,
        _ONSET,
        _time("duration", "until the next row of this setting, or the session's end", "duration"),
        _text("driver", "name of the driver"),
        _text("setting", "name of the setting"),
        Column(
            "value",
            "string",
            "value in the robot: true, false, a number, a text, or JSON; empty: an empty text, or "
            "unknown",
            lambda _, each: None if each.differs is None else _value(each.value),
        ),
        Column(
            "wanted",
            "string",
            "value that the robot file or a command requested, where it differs",
            lambda _, each: _value(each.wanted) if each.differs else None,
        ),
        _plain(
            "boolean",
            "differs",
            "it differed from the requested value; empty: unknown, because the robot was"
            " disconnected or did not report it",
        ),
        _plain("boolean", "changed", f"the setting changed; {_PIECE}"),
        _plain("boolean", "cut", "the log ended before it did"),
        _COUNTED,
        _SEQ,
    ),
    lambda figures: figures.settings,
)


# -- samples -------------------------------------------------------------------------------------

SAMPLES: TableDefinition[Reading] = TableDefinition(
    "samples",
    "Every value of every sensor, by time.",
    (
        _LOG,
        _time("onset", "time, from the session's start", "t"),
        _text("sensor", "the quantity that is sensed"),
        _plain("number", "value", "its value, in `unit`"),
        _text("unit", "unit of `value`"),
        _text("text", "what is not a number: an identity"),
        _text("driver", "name of the driver"),
        _plain("number", "raw", "value of the device, in its unit"),
    ),
    _nothing,
)

#: What is computed of a session's timeline: `woz report --csv` has these, `woz export` has them and
#: those of single lines.
FIGURES: tuple[TableDefinition[Any], ...] = (
    *(
        SESSIONS,
        CONDITIONS,
        TRIALS,
        PHASES,
        ACTIONS,
        WIZARDS,
        LATENCIES,
        CUES,
        ENGAGEMENT,
        EPISODES,
        SETTINGS,
    ),
)
