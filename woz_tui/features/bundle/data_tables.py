"""The tables of a bundle, with what describes them: a Frictionless data package, and the metadata
of Psych-DS, in which a column has one meaning in the whole data set.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TextIO

from woz_tui.analysis.csv_package import DICTIONARY, TableFiles
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.tables import EVENTS, SAMPLES, Cell, rounded
from woz_tui.export.event_model import ExportSession
from woz_tui.export.log_sources import LogSource
from woz_tui.export.output_folder import OutputFolder
from woz_tui.features.bundle.codebook import ANSWERS, Variable, defined_in
from woz_tui.features.questionnaires.figures import AnswerRow, asked_in
from woz_tui.features.questionnaires.score_rows import ScoreRow
from woz_tui.log.damage import Damage
from woz_tui.protocol import messages as m
from woz_tui.system.text_cleaning import cell

#: What tells rows of `answers` apart.
_KEYS = (
    Variable(ANSWERS, "participant", "code of the participant", "string"),
    Variable(ANSWERS, "session", "code of the session", "string"),
    Variable(
        ANSWERS, "condition", "what it was asked about; empty: once, about no condition", "string"
    ),
    Variable(ANSWERS, "round", "how often it was asked about this condition, from 1", "integer"),
)


#: From when on a plan holds, and what the variables of each questionnaire mean by it.
_Plan = tuple[int, Mapping[str, frozenset[Hashable]]]


def table_file(study: str, table: str) -> str:
    """Where a table is, as Psych-DS wants it: names are pairs of a keyword and a value, which has
    letters and digits alone.
    """
    plain = re.sub(r"[^A-Za-z0-9]", "", table)
    return f"data/study-{study}_description-{plain}_data.csv"


@dataclass(slots=True)
class DataTables:
    """Writes the tables of all sessions. `items` are the columns of `answers`."""

    folder: OutputFolder
    study: str
    items: Sequence[Variable]
    samples: bool = False
    _tables: TableFiles = field(init=False)
    _dictionary: io.StringIO = field(default_factory=io.StringIO)
    _answers: dict[tuple[str, str, str, int], dict[str, Cell]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        more = [EVENTS, *([SAMPLES] if self.samples else [])]
        self._tables = TableFiles(self._opened, more)

    def _opened(self, name: str) -> TextIO:
        table = name.removesuffix(".csv")
        if name == DICTIONARY:
            self._dictionary = _Kept()
            return self._dictionary
        return self.folder.text(table_file(self.study, table))

    def add(self, session: ExportSession, source: LogSource) -> None:
        """Write one session."""
        self._tables.add(session.figures)
        self._tables.write(EVENTS, session.figures, session.events)
        if self.samples:
            self._tables.write(SAMPLES, session.figures, source.samples(Damage()))
        self._add_answers(session.figures, [*_plans(source)])

    def _add_answers(self, figures: SessionFigures, plans: Sequence[_Plan]) -> None:
        """What counts, by the round of its questionnaire in this condition, in the columns of the
        version that was asked then.
        """
        found = asked_in(figures)
        begun = {(each.questionnaire, each.round): each.t for each in found.rounds}
        columns: dict[tuple[str, str], list[Variable]] = {}
        for each in self.items:
            columns.setdefault((each.questionnaire, each.item), []).append(each)
        rounds: dict[tuple[str, str, str], list[int]] = {}
        told: list[AnswerRow | ScoreRow] = [*found.answers, *found.missing, *found.scores]
        for row in told:
            if not row.counted:
                continue
            known = rounds.setdefault((row.participant, row.condition, row.questionnaire), [])
            if row.round not in known:
                known.append(row.round)
            number = known.index(row.round) + 1
            key = (row.participant, figures.session, row.condition, number)
            cells = self._answers.setdefault(key, {})
            name = row.score if isinstance(row, ScoreRow) else row.item
            # A score is made of what the file says at the end of the session.
            at = None if isinstance(row, ScoreRow) else begun.get((row.questionnaire, row.round))
            meanings = _meanings(plans, row.questionnaire, at)
            for each in columns.get((row.questionnaire, name), ()):
                if each.withheld or each.is_score != isinstance(row, ScoreRow):
                    continue
                if not each.version or each.meaning in meanings:
                    cells[each.name] = _cell_of(each, row)

    def finish(self) -> Mapping[str, Any]:
        """Write what is left; returns the data package, whose paths are in the bundle."""
        self._tables.finish()
        with self.folder.text(table_file(self.study, ANSWERS)) as file:
            writer = csv.writer(file, lineterminator="\r\n")
            columns = [each for each in self.items if not each.withheld]
            writer.writerow([each.name for each in (*_KEYS, *columns)])
            for key, row in sorted(self._answers.items()):
                values = [*key, *(row.get(each.name) for each in columns)]
                writer.writerow([cell(value) for value in values])
        package: dict[str, Any] = json.loads(self._dictionary.getvalue())
        resources = package["resources"]
        for each in resources:
            each["path"] = table_file(self.study, each["name"])
        resources.append(self._answers_resource(columns))
        return {**package, "resources": resources}

    def _answers_resource(self, columns: Iterable[Variable]) -> dict[str, Any]:
        return self.resource(
            ANSWERS,
            "Answers once more: a row for each participant, condition and round, a "
            "column for each item; those that count.",
            (*_KEYS, *columns),
        )

    def resource(self, name: str, about: str, columns: Iterable[Variable]) -> dict[str, Any]:
        """A table as the data package describes it."""
        # No primary key: `condition` may be empty.
        schema = {"fields": [*map(_field, columns)], "missingValues": [""]}
        return {
            "name": name,
            "path": table_file(self.study, name),
            "description": about,
            "profile": "tabular-data-resource",
            "format": "csv",
            "mediatype": "text/csv",
            "encoding": "utf-8",
            "dialect": {"delimiter": ",", "quoteChar": '"', "doubleQuote": True, "header": True},
            "schema": schema,
        }

    def close(self) -> None:
        """Close the files; also after an error."""
        self._tables.close()


def _plans(source: LogSource) -> Iterator[_Plan]:
    """What a log plans to ask, from when on."""
    for line in source.lines(Damage()):
        if isinstance(line.message, m.SessionPlan):
            asked = line.message.settings.study.questionnaires
            yield (
                line.t or 0,
                {each.name: frozenset(one.meaning for one in defined_in(each)) for each in asked},
            )


def _meanings(plans: Sequence[_Plan], questionnaire: str, at: int | None) -> frozenset[Hashable]:
    """Of the variables of a questionnaire at a moment; None: at the end."""
    before = [plan for t, plan in plans if at is None or t <= at] or [plan for _, plan in plans[:1]]
    return before[-1].get(questionnaire, frozenset()) if before else frozenset()


def _cell_of(each: Variable, row: AnswerRow | ScoreRow) -> Cell:
    if isinstance(row, ScoreRow) or each.of is None:
        return rounded(row.value)
    return each.of.cell(row)


class _Kept(io.StringIO):
    """A text file that is kept in memory, also when it was closed."""

    def close(self) -> None:
        """Keep it."""


def _field(each: Variable) -> dict[str, Any]:
    limits = {} if each.low is None else {"minimum": each.low, "maximum": each.high}
    labels = [{"value": value, "label": label} for value, label in each.labels.items()]
    return {
        "name": each.name,
        "type": each.type,
        "title": each.question or each.label,
        "description": each.label,
        **({"unit": each.unit} if each.unit and each.of is None else {}),
        **({"constraints": limits} if limits else {}),
        **({"categoryLabels": labels} if labels else {}),
    }


def columns_of(package: Mapping[str, Any]) -> Iterator[Variable]:
    """A variable for each column that is no item."""
    for resource in package["resources"]:
        if resource["name"] == ANSWERS:
            yield from _KEYS
            continue
        for each in resource["schema"]["fields"]:
            meaning, unit = each.get("description", ""), each.get("unit", "")
            yield Variable(resource["name"], each["name"], meaning, each["type"], unit=unit)


def variables_measured(package: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Every column of every table once, as schema.org has them."""
    found: dict[str, dict[str, Any]] = {}
    meanings: dict[str, dict[str, None]] = {}
    for resource in package["resources"]:
        for each in resource["schema"]["fields"]:
            name = each["name"]
            entry = found.setdefault(name, {"@type": "PropertyValue", "name": name})
            meanings.setdefault(name, {})[each.get("description", "")] = None
            limits = each.get("constraints", {})
            for key, value in (
                ("minValue", limits.get("minimum")),
                ("maxValue", limits.get("maximum")),
                ("unitText", each.get("unit")),
            ):
                if value is not None:
                    entry.setdefault(key, value)
            if labels := each.get("categoryLabels"):
                words = "; ".join(f"{label['value']} = {label['label']}" for label in labels)
                meanings[name] = {f"{each['description']} ({words})": None}
    for name, entry in found.items():
        entry["description"] = " / ".join(filter(None, meanings[name]))
    return list(found.values())
