"""Tidy tables, read back with the standard library and checked against their own dictionary."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings

from tests.export.export_runs import course_to, export_logs
from tests.export.logs import STEM, Timed, courses, session_of, start, visit, write
from woz_tui.analysis.feature_report import figure_tables
from woz_tui.analysis.tables import EVENTS, SAMPLES
from woz_tui.export.csv_files import CsvExporter
from woz_tui.protocol import messages as m
from woz_tui.system.text_cleaning import visible

Rows = list[dict[str, str]]


def read_back(path: Path) -> Rows:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, strict=True))


def plain(cell: str) -> str:
    """A text without the guard against formulas, as the README says."""
    return cell[1:] if cell.startswith("'") else cell


def package(out: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((out / "datapackage.json").read_text(encoding="utf-8"))
    return found


_TYPES: dict[str, Callable[[str], object]] = {
    "string": str,
    "number": float,
    "integer": int,
    "boolean": {"true": True, "false": False}.__getitem__,
    "datetime": datetime.fromisoformat,
}


def check_dictionary(out: Path) -> None:
    """Every file and column is described, and every cell is of its column's type."""
    resources = {resource["path"]: resource for resource in package(out)["resources"]}
    assert set(resources) == {path.name for path in out.glob("*.csv")}
    for name, resource in resources.items():
        fields = resource["schema"]["fields"]
        rows = read_back(out / name)
        for row in rows:
            assert list(row) == [field["name"] for field in fields]
            for field in fields:
                if row[field["name"]]:
                    _TYPES[field["type"]](row[field["name"]])
        key = resource["schema"].get("primaryKey", [])
        if key:
            assert len({tuple(row[name] for name in key) for row in rows}) == len(rows)
        assert all(field["description"] for field in fields)


def test_a_visit_in_tables(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", visit())
    check_dictionary(out)
    hello = next(row for row in read_back(out / "events.csv") if row["kind"] == "action")
    assert hello == {
        **dict.fromkeys(hello, ""),
        "log": STEM,
        "session": "S01",
        "participant": "P07",
        "condition": "cold",
        "trial": "1",
        "onset": "2.000000",
        "duration": "1.500000",
        "kind": "action",
        "label": "Hello",
        "panel": "Speech",
        "action": "Hello",
        "source": "key",
        "key": "h",
        "outcome": "done",
        "latency": "0.011000",
        "mistake": "true",
        "edited": "false",
        "run": "r1",
        "counted": "true",
        "seq": "6",
    }
    states = [(row["state"], row["duration"]) for row in read_back(out / "engagement.csv")]
    assert states == [
        *(("Idle", "0.500000"), ("Idle", "0.500000")),
        *(("Engaged", "7.500000"), ("Engaged", "2.500000")),
    ], "the trial divides both"
    answers = [
        (row["item"], row["value"], row["text"]) for row in read_back(out / "questionnaires.csv")
    ]
    assert answers == [("friendly", "6", ""), ("else", "", "'-it blinked")]
    (session,) = read_back(out / "sessions.csv")
    assert (session["started"], session["end"]) == ("2026-03-01T10:00:00+00:00", "wizard")
    assert json.loads(session["conditions"]) == ["warm", "cold"]


def test_a_sentence_that_was_typed_anew_says_so(tmp_path: Path) -> None:
    asked = m.ActionRequested(run="r1", action="Hello", panel="P", source="script", edited=True)
    course: list[Timed] = [
        (0, start()),
        (1_000, asked),
        (2_000, m.ActionDone(run="r1", action="Hello")),
    ]
    (row,) = read_back(course_to(tmp_path, "csv", course) / "events.csv")
    assert (row["kind"], row["edited"], row["details"]) == ("action", "true", "")


def test_a_sentence_of_its_own_can_be_a_mistake(tmp_path: Path) -> None:
    command = m.Command(command="c1", verb="say", driver="voice", args={}, source="palette")
    part = m.Command(command="c2", run="r1", verb="say", driver="voice", args={}, source="key")
    course: list[Timed] = [
        (0, start()),
        (1, command),
        (2, m.Mistake(run="c1", action="say")),
        (3, m.ActionRequested(run="r1", action="Hello", source="key")),
        (3, part),
        (4, m.Mistake(run="r1", action="Hello")),
    ]
    rows = read_back(course_to(tmp_path, "csv", course) / "events.csv")
    labelled = [(row["kind"], row["mistake"]) for row in rows if row["kind"] != "mistake"]
    assert labelled == [("command", "true"), ("action", "true"), ("command", "")]


def test_rows_end_as_in_rfc_4180(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", visit())
    for path in out.glob("*.csv"):
        content = path.read_bytes()
        assert content.endswith(b"\r\n")
        assert not content.startswith(b"\xef\xbb\xbf")


def test_nothing_can_be_taken_for_a_formula(tmp_path: Path) -> None:
    wicked = ["=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", "'quoted'", "\uff1d1"]
    course: list[Timed] = [(0, start())]
    course += [(1, m.Note(text=text)) for text in wicked]
    rows = read_back(course_to(tmp_path, "csv", course) / "events.csv")
    cells = [row["text"] for row in rows if row["kind"] == "note"]
    assert all(cell.startswith("'") for cell in cells)
    assert [plain(cell) for cell in cells] == [visible(text) for text in wicked]


@settings(suppress_health_check=list(HealthCheck))
@given(courses())
def test_any_course_comes_back(tmp_path: Path, course: list[Timed]) -> None:
    out = course_to(tmp_path, "csv", course)
    check_dictionary(out)
    session = session_of(tmp_path, course)
    rows = read_back(out / "events.csv")
    assert len(rows) == len(session.events)
    for row, event in zip(rows, session.events, strict=True):
        assert plain(row["text"]) == visible(event.text)
        assert float(row["onset"]) == event.begin / 1e6
        assert float(row["duration"] or 0) == event.duration / 1e6
        if event.details:
            json.loads(plain(row["details"]))


def test_samples_are_there_when_asked_for(tmp_path: Path) -> None:
    assert not (course_to(tmp_path, "csv", visit()) / "samples.csv").exists()
    out = course_to(tmp_path, "csv", visit(), samples=True)
    check_dictionary(out)
    rows = read_back(out / "samples.csv")
    assert [
        (row["onset"], row["sensor"], row["value"], row["unit"], row["text"]) for row in rows
    ] == [
        ("1.200000", "distance", "1.25", "m", ""),
        ("1.300000", "distance", "", "m", ""),
        ("1.400000", "identity", "", "", "V012"),
    ]


def test_several_sessions_stand_in_the_same_tables_under_names_of_their_own(tmp_path: Path) -> None:
    one = write(tmp_path / "monday", visit())
    two = write(tmp_path / "tuesday", [(0, start("P08")), *visit()[1:]])
    export_logs([one, two, one.parent], "csv", tmp_path / "out")
    check_dictionary(tmp_path / "out")
    sessions = read_back(tmp_path / "out" / "sessions.csv")
    assert [row["log"] for row in sessions] == [STEM, f"{STEM}-2"], "each session once"
    logs = {row["log"] for row in read_back(tmp_path / "out" / "events.csv")}
    assert logs == {STEM, f"{STEM}-2"}


def test_the_readme_names_every_table() -> None:
    tables = {f"`{table.name}.csv`" for table in (*figure_tables(), EVENTS, SAMPLES)}
    assert {name for name in tables if name not in CsvExporter.about} == set()
