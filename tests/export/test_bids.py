"""BIDS datasets, checked with the validator of the standard's own authors.

It is run by Deno without leave to use the network, so what it says does not hang on one.
"""

from __future__ import annotations

import csv
import gzip
import json
import os
import subprocess
from importlib import resources
from pathlib import Path
from typing import Any

import deno
import pytest
from hypothesis import HealthCheck, given, settings

from tests.export.export_runs import course_to, export_logs
from tests.export.logs import Timed, courses, start, visit, write
from woz_tui.export import bids
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered
from woz_tui.protocol import messages as m

VALIDATOR = resources.files("bids_validator_deno") / "bids-validator.js"
#: What nobody but the researcher can know; the README's readers are told to add it.
UNKNOWN = {
    *("Instructions", "TaskDescription", "CogAtlasID", "CogPOID", "License", "HEDVersion"),
    *("InstitutionName", "InstitutionAddress", "InstitutionalDepartmentName", "Authors"),
    *("SourceDatasets", ""),
}


def validated(dataset: Path) -> list[dict[str, Any]]:
    """What the validator has to say; no error."""
    leave = ["--no-remote", "--cached-only", "--no-lock", "--allow-env", "--allow-read"]
    ran = subprocess.run(
        [
            *(deno.find_deno_bin(), "run", *leave, str(VALIDATOR)),
            *(dataset.name, "--format", "json", "--max-rows", "-1"),
        ],
        cwd=dataset.parent,
        env={"DENO_DIR": os.environ["XDG_STATE_HOME"], "DENO_NO_UPDATE_CHECK": "1"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    issues: list[dict[str, Any]] = json.loads(ran.stdout)["issues"]["issues"]
    errors = [issue for issue in issues if issue["severity"] == "error"]
    assert errors == []
    assert ran.returncode == 0, ran.stderr
    return issues


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE, strict=True))


def files(dataset: Path) -> list[str]:
    found = (path.relative_to(dataset) for path in dataset.rglob("*") if path.is_file())
    return sorted(map(str, found))


def test_a_visit_is_valid(tmp_path: Path) -> None:
    dataset = course_to(tmp_path, "bids", visit(), samples=True)
    issues = validated(dataset)
    assert {issue.get("subCode", "") for issue in issues} <= UNKNOWN
    beh = "sub-P07/ses-S01/beh/sub-P07_ses-S01_task-museumguide"
    assert files(dataset) == [
        *("README.md", "dataset_description.json", "participants.json", "participants.tsv"),
        *(f"{beh}_{suffix}" for suffix in ("beh.json", "beh.tsv", "events.json", "events.tsv")),
        *(f"{beh}_physio.json", f"{beh}_physio.tsv.gz"),
        "sub-P07/ses-S01/sub-P07_ses-S01_scans.tsv",
    ]
    events = table(dataset / f"{beh}_events.tsv")
    assert [float(row["onset"]) for row in events] == sorted(float(row["onset"]) for row in events)
    (hello, *_) = (row for row in events if row["trial_type"] == "action")
    assert (hello["onset"], hello["duration"], hello["label"]) == ("2.000000", "1.500000", "Hello")
    note = next(row for row in events if row["trial_type"] == "note")
    assert (note["duration"], note["text"]) == ("0", "a child␊has joined")
    assert [row["value"] for row in table(dataset / f"{beh}_beh.tsv")] == ["6", "n/a"]
    assert table(dataset / "participants.tsv") == [
        {"participant_id": "sub-P07", "conditions": "warm, cold"}
    ]


def test_no_text_is_a_formula_to_a_spreadsheet(tmp_path: Path) -> None:
    formula = '=HYPERLINK("http://e.x";"click")'
    course: list[Timed] = [
        (0, start(condition=formula)),
        (1, m.TrialStarted(trial=1, condition=formula)),
        (2, m.Note(text=f" {formula}")),
        (3, m.Marker(text="@SUM(A1)")),
        (4, QuestionnaireAnswered(questionnaire="q", item="i", question="?", text="+1+cmd")),
    ]
    dataset = course_to(tmp_path, "bids", course)
    validated(dataset)
    cells = [
        cell for path in dataset.rglob("*.tsv") for row in table(path) for cell in row.values()
    ]
    assert {f"'{formula}", "'@SUM(A1)", "'+1+cmd"} <= set(cells)
    assert not [cell for cell in cells if cell.startswith(("=", "+", "@"))]
    assert {path.stat().st_mode & 0o777 for path in dataset.rglob("*.tsv")} == {0o600}


def test_every_column_is_described(tmp_path: Path) -> None:
    dataset = course_to(tmp_path, "bids", visit())
    for path in dataset.rglob("*_events.tsv"):
        described = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
        assert set(table(path)[0]) - {"onset", "duration"} <= set(described)
        assert set(described["trial_type"]["Levels"]) == {row["trial_type"] for row in table(path)}


def test_values_of_sensors_come_at_one_rate(tmp_path: Path) -> None:
    course: list[Timed] = [(0, start())]
    course += [(0.05, m.reading("distance", 1.5, unit="m")), (0.07, m.reading("loudness", 0.25))]
    course += [(0.09, m.reading("distance", 2.5, unit="m"))]
    beh = course_to(tmp_path, "bids", course, samples=True) / "sub-P07" / "ses-S01" / "beh"
    (path,) = beh.glob("*_physio.json")
    described = json.loads(path.read_text(encoding="utf-8"))
    assert (described["SamplingFrequency"], described["StartTime"]) == (50, 0)
    assert described["Columns"] == ["distance", "loudness"]
    assert described["distance"]["Units"] == "m"
    with gzip.open(beh / path.with_suffix(".tsv.gz").name, "rt") as file:
        rows = [line.rstrip("\n").split("\t") for line in file]
    assert rows == [  # at 0, 20, 40, 60, 80, 100 ms
        *[["n/a", "n/a"]] * 3,
        ["1.5", "n/a"],
        ["1.5", "0.25"],
        ["2.5", "0.25"],
    ]


def test_a_time_far_off_fills_no_disk(tmp_path: Path) -> None:
    course: list[Timed] = [(0, start()), (1, m.reading("distance", 1.5))]
    course += [(10**9, m.reading("distance", 2.5))]
    log = write(tmp_path / "recordings", course)
    (session_summary,) = export_logs(log, "bids", tmp_path / "out", samples=True)
    assert "values after a gap of more than an hour were left out" in session_summary.notes
    (path,) = (tmp_path / "out").rglob("*_physio.tsv.gz")
    assert len(gzip.decompress(path.read_bytes()).splitlines()) == 51


def test_times_that_lead_far_off_in_small_steps_fill_no_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bids, "_LONGEST_US", 10_000_000)
    course: list[Timed] = [(0, start())]
    course += [(seconds, m.reading("distance", 1.5)) for seconds in range(0, 100, 2)]
    log = write(tmp_path / "recordings", course)
    (session_summary,) = export_logs(log, "bids", tmp_path / "out", samples=True)
    assert any("left out" in note for note in session_summary.notes)
    (path,) = (tmp_path / "out").rglob("*_physio.tsv.gz")
    assert len(gzip.decompress(path.read_bytes()).splitlines()) == 501


def test_many_sessions_are_one_valid_dataset(tmp_path: Path) -> None:
    folder = tmp_path / "recordings"
    write(folder, visit(), "2026-03-01T10-00-00_P07_S01")
    write(folder, visit(), "2026-03-02T10-00-00_P07_S01")
    others = [("P08", "S02"), ("", "S03"), ("", "S04")]
    for number, (participant, code) in enumerate(others):
        course = [(0.0, start(participant, code)), *visit()[1:]]
        write(folder, course, f"2026-03-0{3 + number}T10-00-00_{code}")
    told = export_logs(folder, "bids", tmp_path / "out")
    validated(tmp_path / "out")
    subjects = [row["participant_id"] for row in table(tmp_path / "out" / "participants.tsv")]
    assert subjects == ["sub-P07", "sub-P08", "sub-unknown01", "sub-unknown02"]
    assert told[3].notes == ["no participant's code: it is in sub-unknown01"]
    runs = [name for name in files(tmp_path / "out") if "P07" in name and "_events.tsv" in name]
    assert [name.split("_")[-2] for name in runs] == ["run-1", "run-2"]
    scans = table(tmp_path / "out/sub-P07/ses-S01/sub-P07_ses-S01_scans.tsv")
    assert len(scans) == 4, "events and answers of both runs"
    assert {row["acq_time"] for row in scans} == {"2026-03-01T10:00:00.000000Z"}


def test_each_participant_of_a_session_has_what_happened_under_their_code(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.Note(text="first")),
        (2, m.SessionChanged(participant="P08")),
        (3, m.Note(text="second")),
    ]
    dataset = course_to(tmp_path, "bids", course)
    validated(dataset)
    for code, text in (("P07", "first"), ("P08", "second")):
        (path,) = (dataset / f"sub-{code}").rglob("*_events.tsv")
        notes = [row["text"] for row in table(path) if row["trial_type"] == "note"]
        assert notes == [text]


def test_a_code_that_was_corrected_at_once_took_no_part(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start("P10")),
        (1, m.DriverConnected(driver="head")),
        (2, m.SessionChanged(participant="P01")),
        (3, m.reading("distance", 1.5)),
        (60, m.Note(text="late")),
    ]
    log = write(tmp_path / "recordings", course)
    (session_summary,) = export_logs(log, "bids", tmp_path / "out", samples=True)
    assert session_summary.participants == ["P01"]
    (path,) = (tmp_path / "out").rglob("*_physio.tsv.gz")
    assert "sub-P01" in path.parts
    export_logs(log, "eaf", tmp_path / "eaf", redact=True)
    assert (tmp_path / "eaf" / "P01_S01.eaf").exists()


def test_re_runs_are_no_subjects(tmp_path: Path) -> None:
    again = m.RerunStarted(original="x", original_session="S01")
    logs = [
        write(tmp_path / "r", [(0, start()), (20, m.Note(text="a"))]),
        write(tmp_path / "r", [(0, start("", "S09")), (20, again)], "2026-03-02T10-00-00_S09"),
    ]
    _, rerun = export_logs(logs, "bids", tmp_path / "out")
    assert "re-run" in str(rerun.notes)
    subjects = [row["participant_id"] for row in table(tmp_path / "out" / "participants.tsv")]
    assert subjects == ["sub-P07"]
    assert [path.name for path in (tmp_path / "out").glob("sub-*")] == ["sub-P07"]


def test_a_marker_stands_at_the_moment_that_its_program_measured(tmp_path: Path) -> None:
    late = m.Marker(text="onset", source="program", at=2_000_000)
    dataset = course_to(tmp_path, "bids", [(0, start()), (3, late), (4, m.Marker(text="key"))])
    (path,) = dataset.rglob("*_events.tsv")
    rows = [row for row in table(path) if row["trial_type"] == "marker"]
    assert [float(row["onset"]) for row in rows] == [2, 4]


def test_what_came_before_the_first_code_makes_no_person(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start(participant="")),
        (1, m.Note(text="early")),
        (1.5, m.reading("distance", 1.5)),
        (2, m.SessionChanged(participant="P08")),
        (3, m.Note(text="first")),
    ]
    slip = [(4, m.SessionChanged(participant="P80")), (5, m.SessionChanged(participant="P08"))]
    log = write(tmp_path / "recordings", [*course, *slip, (20, m.Note(text="last"))])
    (session_summary,) = export_logs(log, "bids", tmp_path / "out", samples=True)
    dataset = tmp_path / "out"
    validated(dataset)
    (path,) = dataset.rglob("*_events.tsv")
    notes = [(row["text"], row["counted"]) for row in table(path) if row["trial_type"] == "note"]
    assert notes == [("early", "false"), ("first", "true"), ("last", "true")]
    assert [row["participant_id"] for row in table(dataset / "participants.tsv")] == ["sub-P08"]
    assert not any("nobody's code" in note for note in session_summary.notes)
    assert any("under P80, who did not take part" in note for note in session_summary.notes)
    assert [path.name[:7] for path in dataset.rglob("*_physio.tsv.gz")] == ["sub-P08"]


def test_a_session_in_which_nothing_was_played_has_no_subject(tmp_path: Path) -> None:
    setup = [(0.028, m.DriverConnected(driver="head")), (0.5, m.Note(text="only a try"))]
    logs = [
        write(tmp_path / "r", [(0, start("", "S08")), *setup], "2026-03-01T09-00-00_S08"),
        write(tmp_path / "r", [(0, start("", "S09")), *visit()[1:]], "2026-03-01T09-30-00_S09"),
        write(tmp_path / "r", visit()),
    ]
    told, *_ = export_logs(logs, "bids", tmp_path / "out")
    assert told.notes == ["no participant's code, and nothing was played: it is left out"]
    validated(tmp_path / "out")
    subjects = [row["participant_id"] for row in table(tmp_path / "out" / "participants.tsv")]
    assert subjects == ["sub-unknown01", "sub-P07"]


@settings(suppress_health_check=list(HealthCheck))
@given(courses())
def test_tables_of_any_course_have_a_cell_for_each_column(
    tmp_path: Path, course: list[Timed]
) -> None:
    for path in course_to(tmp_path, "bids", course).rglob("*.tsv"):
        names, *rows = path.read_text(encoding="utf-8").split("\n")[:-1]
        for row in rows:
            cells = row.split("\t")
            assert len(cells) == len(names.split("\t"))
            assert all(cell and cell == cell.strip() for cell in cells)


def test_a_wild_course_is_valid(tmp_path: Path) -> None:
    """One dataset of all that the other tests make up at random: the validator needs a second."""
    course: list[Timed] = [(0, start())]
    wild = ["", " ", "n/a", "\t", "\x00\x0b", "\u2028", '"', "=1", "😀\u202e", "\ufffe"]
    course += [(1 + number, m.Note(text=text)) for number, text in enumerate(wild)]
    course += [
        (20, m.ActionRequested(run="a", action=text, panel=text, source="key")) for text in wild
    ]
    values: dict[str, m.Json] = {text: text for text in wild}
    course.append((30, m.SettingsShown(values=values, wanted=values, conflicts=wild)))
    validated(course_to(tmp_path, "bids", course))
