"""Tables that a spreadsheet opens as they are, in its own language."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from tests.analysis.example_sessions import ExampleSession
from woz_tui.analysis.csv_package import DICTIONARY
from woz_tui.analysis.spreadsheets import SPREADSHEETS
from woz_tui.cli import main

BEGAN = "2026-03-01T10:00:00.123456+00:00"


def study(folder: Path, participant: str = "P07") -> Path:
    session = ExampleSession(participant=participant, wall=BEGAN).act(1.25).act(3).end(10.5)
    return session.written(folder, f"2026-03-01T10-00-00_{participant}_S01")


@pytest.mark.parametrize("language", sorted(SPREADSHEETS))
@pytest.mark.parametrize("command", ["report", "export"])
def test_a_spreadsheet_finds_its_columns_and_numbers(
    language: str, command: str, tmp_path: Path
) -> None:
    log = study(tmp_path / "recordings")
    where = ["--csv"] if command == "report" else ["--to", "csv", "--out"]
    folder = tmp_path / "tables"
    assert main([command, str(log), *where, str(folder), "--spreadsheet", language]) == 0
    package = json.loads((folder / DICTIONARY).read_text(encoding="utf-8"))
    (resource,) = (each for each in package["resources"] if each["name"] == "sessions")
    data = (folder / "sessions.csv").read_bytes()
    assert data.startswith(b"\xef\xbb\xbf"), "by which Excel knows UTF-8"
    rows = csv.DictReader(
        data.decode(resource["encoding"]).splitlines(), delimiter=resource["dialect"]["delimiter"]
    )
    (row,) = rows
    comma = language not in ("en", "ja")
    assert resource["dialect"]["delimiter"] == (";" if comma else ",")
    assert row["duration"] == ("10,500000" if comma else "10.500000")
    assert (row["log"], row["started"]) == ("2026-03-01T10-00-00_P07_S01", BEGAN)


@pytest.mark.parametrize("code", ["001", "1E5", "MAR1", "TRUE"])
def test_a_code_that_a_spreadsheet_changes_is_told(
    code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = study(tmp_path, code)
    for options in (["report", "--csv"], ["export", "--to", "csv", "--out"]):
        command, *where = options
        assert main([command, str(log), *where, str(tmp_path / command)]) == 0
        assert f"changes {code} " in capsys.readouterr().err
    assert main(["report", str(study(tmp_path)), "--csv", str(tmp_path / "again")]) == 0
    assert "changes" not in capsys.readouterr().err


def test_a_spreadsheet_without_tables_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = study(tmp_path)
    for command in (["report"], ["export", "--to", "eaf", "--out", str(tmp_path / "out")]):
        assert main([*command, str(log), "--spreadsheet", "de"]) == 1
        told = capsys.readouterr()
        assert "--spreadsheet needs --" in told.err
        assert not told.out
