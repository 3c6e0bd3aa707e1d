"""Files of a BIDS dataset: tables of tab-separated values, each with a JSON file beside it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any, get_args

from woz_tui.core.cleaning import cell, one_line
from woz_tui.core.messages import AnyMessage
from woz_tui.export.course import Answer, Event, Session
from woz_tui.export.folder import Folder
from woz_tui.export.tables import ANSWERS, EVENTS, Cell, Column, Table

#: What stands where there is no value.
NONE = "n/a"
_KINDS = {
    "action": "an action of the robot that was asked for, from the request to its end",
    "command": "one verb sent to one driver, from the request to its end",
    "engagement": "a state of the engagement machine",
    "speech": "a sentence of the visitor",
    "trial": "a trial",
    "break": "a break between trials",
    "stop": "the emergency stop, from its being pressed to its release; of driving alone, to its "
    "confirmation",
    "questionnaire": "a questionnaire was put to the participant",
    "difference": "a robot's setting was other than asked for; the text is what it had and what "
    "was wanted",
    "conflict": "settings of a robot that worked against each other, or against the wizard",
    "marker": "a moment that the wizard marked",
    "note": "a sentence that the wizard typed",
    "mistake": "the wizard labelled an action a mistake",
}
_MOMENTS = {
    str(kind.__struct_config__.tag): (kind.__doc__ or "").strip().partition("\n\n")[0]
    for kind in get_args(AnyMessage)
}
#: BIDS has its own names for these, and wants the first three first.
_RENAMED = {"onset_s": "onset", "duration_s": "duration", "kind": "trial_type"}
_OF_EVENTS = (
    *("onset_s", "duration_s", "kind", "label", "panel", "action", "verb", "driver", "source"),
    *("outcome", "latency_s", "mistake", "condition", "trial", "text", "run", "seq"),
)
_OF_ANSWERS = (
    *("questionnaire", "round", "item", "value", "low", "high", "text", "skipped", "answered_s"),
    *("onset_s", "condition", "trial", "question"),
)


def write_events(
    folder: Folder, stem: str, session: Session, events: Iterable[Event], common: Mapping[str, Any]
) -> None:
    """`<stem>_events.tsv` and its sidecar."""
    events = list(events)
    columns = _columns(EVENTS, _OF_EVENTS)
    rows = (
        [bids_cell(_event_cell(session, event, of), text=of.type == "string") for of in columns]
        for event in events
    )
    names = [_RENAMED.get(column.name, column.name) for column in columns]
    write_table(folder, f"{stem}_events.tsv", names, rows)
    meanings: dict[str, Any] = {
        name: _meaning(column) for name, column in zip(names, columns, strict=True)
    }
    del meanings["onset"], meanings["duration"]  # BIDS' own
    meanings["trial_type"] = {
        "Description": "What happened; of moments, the kind of the log's line.",
        "Levels": {kind: _level(kind) for kind in dict.fromkeys(each.kind for each in events)},
    }
    write_json(folder, f"{stem}_events.json", {**common, **meanings})


def write_answers(
    folder: Folder,
    stem: str,
    session: Session,
    answers: Iterable[Answer],
    common: Mapping[str, Any],
) -> None:
    """`<stem>_beh.tsv` and its sidecar: answers to questionnaires."""
    columns = _columns(ANSWERS, _OF_ANSWERS)
    rows = (
        [bids_cell(of.cell(session, answer), text=of.type == "string") for of in columns]
        for answer in answers
    )
    write_table(folder, f"{stem}_beh.tsv", [column.name for column in columns], rows)
    meanings = {column.name: _meaning(column) for column in columns}
    write_json(folder, f"{stem}_beh.json", {**common, **meanings})


def write_table(
    folder: Folder, name: str, columns: Iterable[str], rows: Iterable[Iterable[str]]
) -> None:
    """A file of tab-separated cells with a row of names."""
    with folder.text(name) as file:
        file.write("\t".join(columns) + "\n")
        for row in rows:
            file.write("\t".join(row) + "\n")


def write_json(folder: Folder, name: str, content: Mapping[str, Any]) -> None:
    """A JSON file."""
    folder.write(name, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def _columns(table: Table[Any], names: Iterable[str]) -> list[Column[Any]]:
    of_table = {column.name: column for column in table.columns}
    return [of_table[name] for name in names]


def _level(kind: str) -> str:
    """What a kind of event is; of moments, what the log's format says of the line."""
    return _KINDS.get(kind) or _MOMENTS.get(
        kind, "a line of the log that this version does not know"
    )


def _event_cell(session: Session, event: Event, column: Column[Any]) -> Cell:
    if column.name == "duration_s" and event.end is None:
        return 0  # as BIDS has it of moments
    return column.cell(session, event)


def _meaning(column: Column[Any]) -> dict[str, str]:
    units = {"Units": column.unit} if column.unit else {}
    return {"Description": column.meaning, **units}


def bids_cell(value: Cell, *, text: bool = True) -> str:
    """A value as BIDS has it: no quoting, and nothing begins or ends in a blank."""
    return cell(one_line(value).strip() if isinstance(value, str) else value, text=text) or NONE
