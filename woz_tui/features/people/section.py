"""Fields of the section `participants`: what sentences may say of a participant, or depend on.

participants:
  fields: {first: text, group: [child, adult]}
  table: people.csv       # participant,first,group
"""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from woz_tui.config import utterance_template
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents, FileSurroundings, NoKeys
from woz_tui.config.file_text import SourceFileError, read_source
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.config.yaml_nodes import ListNode, MappingNode, ScalarNode
from woz_tui.drivers.contract import KEPT
from woz_tui.features.slots.slot_value import SlotValueError, checked_value
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence, said_by

#: What a field can be beside one of several words, and the table's column of codes.
TEXT, CODE = "text", utterance_template.PARTICIPANT


@dataclass(frozen=True, slots=True)
class ParticipantFields:
    """Fields by name with the words that each can be (none: any text), and what the table says, by
    code.
    """

    fields: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    rows: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    def checked(self, name: str, text: str) -> str:
        """What a field can hold; empty: nothing is known. Raises `SlotValueError`."""
        words = self.fields[name]
        if not text.strip():
            return ""
        value = checked_value(text)
        if words and value not in words:
            raise SlotValueError(
                Sentence(
                    "people.not_one_of",
                    "is not {value}; it can be {words}",
                    value=quoted(value),
                    words=", ".join(words),
                )
            )
        return value


class PeopleSection(FeatureSection[ParticipantFields]):
    """The table lies beside the experiment and is no part of it: no log gets its text."""

    def begin(self, around: FileSurroundings) -> FeatureSection[ParticipantFields]:
        return _Reader(self.keys, self.empty, around.folder)

    def changes(self, old: ParticipantFields, new: ParticipantFields) -> Iterable[str]:
        if old.fields != new.fields:
            yield Sentence("reload.fields", "fields of participants changed")
        if old.rows != new.rows:
            yield Sentence("reload.people", "the table of participants changed")

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        if fields := self.of(experiment).fields:
            told = (f"{name} ({', '.join(words) or TEXT})" for name, words in fields.items())
            yield KEPT, f"of each participant: {', '.join(told)}, in the log"

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        known = self.of(experiment)
        if known.fields:
            told = (f"{name} ({', '.join(words) or TEXT})" for name, words in known.fields.items())
            rows = f"; the table has {len(known.rows)}" if known.rows else ""
            yield "participants", f"{', '.join(told)}{rows}"

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        fields: dict[str, Json] = {
            name: [*words] or TEXT for name, words in self.of(experiment).fields.items()
        }
        return {"participant_fields": fields} if fields else {}

    def schemas(self) -> Mapping[str, Any]:
        word = {"type": ["string", "number", "boolean"]}
        one = {"anyOf": [{"const": TEXT}, {"type": "array", "items": word, "minItems": 2}]}
        return {"participant_fields": {"type": "object", "additionalProperties": one}}


class _Reader(PeopleSection):
    """Reads one file, and the table in its folder."""

    def __init__(self, keys: type, empty: ParticipantFields, folder: Path) -> None:
        super().__init__(keys, empty)
        self._folder = folder

    def variables(self, table: Mapping[str, Cursor]) -> Mapping[str, Collection[str] | None]:
        return {f"{CODE}.{name}": words for name, words in _fields(table, silent=True).items()}

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> ParticipantFields:
        fields = _fields(table)
        entry = _section(table).get("table")
        if entry is None or not file.participants.table:
            return ParticipantFields(fields)
        path = self._folder / file.participants.table
        try:
            text = read_source(path, str(path)).text
        except SourceFileError as error:
            entry.error(error.message)
            return ParticipantFields(fields)
        return ParticipantFields(fields, dict(_rows(text, ParticipantFields(fields), entry)))


def _section(table: Mapping[str, Cursor]) -> dict[str, Cursor]:
    cursor = table.get("participants")
    found = cursor is not None and isinstance(cursor.node, MappingNode)
    return dict(cursor.entries()) if cursor is not None and found else {}


def _fields(table: Mapping[str, Cursor], *, silent: bool = False) -> dict[str, tuple[str, ...]]:
    """Fields with their words. What is wrong is told once: `silent` reads ahead."""
    cursor = _section(table).get("fields")
    if cursor is None:
        return {}
    if not isinstance(cursor.node, MappingNode):
        if not silent:
            cursor.table(
                Sentence("people.fields", "fields, such as {{first: text, group: [child, adult]}}")
            )
        return {}
    fields: dict[str, tuple[str, ...]] = {}
    for name, entry in cursor.entries():
        fields[name] = ()
        if isinstance(entry.node, ListNode) and entry.node.nodes:
            fields[name] = tuple(word for _, word in texts_of(entry))
        if not silent:
            _check_field(name, entry, fields[name])
    return fields


def _check_field(name: str, entry: Cursor, words: tuple[str, ...]) -> None:
    if not utterance_template.NAME.fullmatch(name):
        entry.error(
            Sentence(
                "people.field_name",
                "a field's name can have letters, digits and _, and cannot begin with a digit",
            )
        )
    if not words and not (isinstance(entry.node, ScalarNode) and entry.node.text == TEXT):
        entry.error(
            Sentence(
                "people.text_or_words",
                "expected {text}, or the words that it can be, such as [child, adult]",
                text=TEXT,
            )
        )
    for word in words:
        try:
            checked_value(word)
        except SlotValueError as error:
            entry.error(
                Sentence(
                    "slots.value_is_wrong", "{value} {why}", value=quoted(word), why=said_by(error)
                )
            )
        if word == "else":
            entry.error(
                Sentence(
                    "people.else_reserved", "'else' stands for everybody else; choose another word"
                )
            )


def _rows(
    text: str, known: ParticipantFields, entry: Cursor
) -> Iterator[tuple[str, Mapping[str, str]]]:
    """Participants with their fields. A mistake is told with its line, and not with its text: that
    may be a name.
    """
    head = text.split("\n", 1)[0]
    reader = csv.DictReader(io.StringIO(text), delimiter=";" if ";" in head else ",")
    columns = [(each or "").strip() for each in reader.fieldnames or ()]
    if CODE not in columns:
        entry.error(
            Sentence(
                "people.no_codes",
                "the table has no column {name} in its first line",
                name=quoted(CODE),
            )
        )
        return
    for name in known.fields:
        if name not in columns:
            entry.warning(
                Sentence("people.no_column", "the table has no column {name}", name=quoted(name))
            )
    seen: set[str] = set()
    for row in reader:
        told = {(name or "").strip(): value or "" for name, value in row.items() if name}
        code = str(told.get(CODE, "")).strip()
        if not code:
            continue
        if code in seen:
            entry.error(
                Sentence(
                    "people.code_again",
                    "line {line} of the table is about {code} again",
                    line=reader.line_num,
                    code=quoted(code),
                )
            )
        seen.add(code)
        fields: dict[str, str] = {}
        for name in known.fields:
            try:
                fields[name] = known.checked(name, str(told.get(name, "")))
            except SlotValueError as error:
                words = known.fields[name]  # the value itself may be a name
                it_can_be = Sentence("people.can_be", " it can be {words}", words=", ".join(words))
                why = it_can_be if words else f" {error}"
                entry.error(
                    Sentence(
                        "people.line_wrong",
                        "line {line} of the table: {name} is wrong;{why}",
                        line=reader.line_num,
                        name=quoted(name),
                        why=why,
                    )
                )
        yield code, {name: value for name, value in fields.items() if value}


PEOPLE = PeopleSection(NoKeys, ParticipantFields())
