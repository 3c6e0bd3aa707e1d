"""What coders set in replays, in all formats, and compared at the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.export.export_runs import export_logs
from tests.export.logs import STEM, Timed, start, write
from tests.export.test_bids import table
from tests.export.test_csv import check_dictionary, read_back
from tests.export.test_eaf import read_back as read_eaf
from tests.export.test_textgrid import read_back as read_grid
from tests.export.test_textgrid import tier_annotations
from woz_tui.cli import main
from woz_tui.log.coding_file import Coding, coding_path
from woz_tui.log.log_index import LogIndex
from woz_tui.protocol import messages as m

CODES = {
    "K1": ((2.0, "gaze: robot"), (5.0, "gaze: away"), (3.0, "smiles"), (9.0, "gaze: robot")),
    "K2": ((2.5, "gaze: robot"), (6.0, "gaze: away"), (3.2, "smiles")),
}


def session(folder: Path, *more: Timed) -> Path:
    """One trial from 1 to 8 s, coded by two."""
    course: list[Timed] = [
        (0, start()),
        (1, m.TrialStarted(trial=1, condition="cold")),
        (8, m.TrialEnded(trial=1, outcome="done")),
        (10, m.Note(text="over")),
        *more,
    ]
    course.sort(key=lambda timed: timed[0])
    log = write(folder / "recordings", course)
    with LogIndex.open(log) as index:
        first = next(line for line in index.actions if isinstance(line, m.SessionStart))
    for coder, codes in CODES.items():
        coding = Coding(coding_path(log), coder, first)
        for t, text in codes:
            coding.add(round(t * 1e6), text)
        coding.add(7_000_000, "not sure of this", note=True)
        coding.close()
    return log


def test_elan_and_praat_have_a_tier_for_each_coder_and_tier(tmp_path: Path) -> None:
    log = session(tmp_path)
    export_logs(log, "eaf", tmp_path / "eaf")
    tiers = read_eaf(tmp_path / "eaf" / f"{STEM}.eaf")
    assert tiers["K1 gaze"] == [
        *((2000, 5000, "robot"), (5000, 8000, "away"), (9000, 10000, "robot"))
    ], "a code ends with the trial"
    assert tiers["K2 gaze"] == [(2500, 6000, "robot"), (6000, 8000, "away")]
    assert [each[2] for each in tiers["K1 markers"]] == ["smiles"]
    assert [each[2] for each in tiers["K1 notes"]] == ["not sure of this"]
    export_logs(log, "textgrid", tmp_path / "grid")
    grid = read_grid(tmp_path / "grid" / f"{STEM}.TextGrid")
    assert tier_annotations(grid.getTier("K2 gaze")) == [(2.5, 6, "robot"), (6, 8, "away")]


def test_tables_have_codes_with_whose_time_it_was(tmp_path: Path) -> None:
    log = session(tmp_path)
    before = {path.name: path.read_bytes() for path in log.parent.iterdir()}
    export_logs(log, "csv", tmp_path / "csv")
    check_dictionary(tmp_path / "csv")
    rows = [row for row in read_back(tmp_path / "csv" / "events.csv") if row["kind"] == "code"]
    found = [
        (row["source"], row["label"], row["text"], row["trial"], float(row["onset"]))
        for row in rows
        if row["label"] == "gaze"
    ]
    assert found == [
        ("K1", "gaze", "robot", "1", 2),
        ("K2", "gaze", "robot", "1", 2.5),
        ("K1", "gaze", "away", "1", 5),
        ("K2", "gaze", "away", "1", 6),
        ("K1", "gaze", "robot", "", 9),
    ]
    assert {row["seq"] for row in rows} == {""}
    assert {path.name: path.read_bytes() for path in log.parent.iterdir()} == before
    export_logs(log.parent, "bids", tmp_path / "bids")
    [path] = (tmp_path / "bids").rglob("*_events.tsv")
    assert "smiles" in [row["text"] for row in table(path) if row["trial_type"] == "code"]


def test_published_copies_have_no_words_of_coders(tmp_path: Path) -> None:
    export_logs(session(tmp_path), "csv", tmp_path / "out", redact=True)
    for path in (tmp_path / "out").iterdir():
        for word in ("smiles", "robot,", "not sure"):
            assert word not in path.read_text(encoding="utf-8")


def test_two_coders_are_compared_within_trials(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bins of the trial: K1 has - R R R A A A, K2 has - - R R R A A (half of a bin each at 2.5)."""
    log = str(session(tmp_path))
    assert main(["coding", log, "--coders", "K1", "K2", "--json"]) == 0
    found = {each["tier"]: each for each in json.loads(capsys.readouterr().out)}
    gaze = found["gaze"]
    assert (gaze["bins"], sum(count for _, _, count in gaze["table"])) == (7, 7)
    assert gaze["agreement"] == pytest.approx(5 / 7)
    table_ = {(one, other): count for one, other, count in gaze["table"]}
    assert table_["robot", "robot"] == 2
    assert table_["away", "robot"] == 1
    assert found["markers"]["kappa"] == 1
    assert main(["coding", log, "--coders", "K1", "K2", "--tier", "gaze"]) == 0
    out = capsys.readouterr().out
    assert "gaze: agreement 71.4% of 7 bins, Cohen's kappa" in out
    assert "K1 \\ K2" in out


def test_a_trial_with_a_break_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = str(session(tmp_path, (4, m.BreakStarted()), (5, m.BreakEnded())))
    assert main(["coding", log, "--coders", "K1", "K2"]) == 0
    assert "in 1 trial, 6.0 s" in capsys.readouterr().out


def test_coders_are_listed_and_who_is_none_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = session(tmp_path)
    assert main(["coding", str(log)]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()[1:]] == ["K1", "K2"]
    assert main(["coding", str(log), "--coders", "K1", "K3"]) == 1
    assert "K3 has set no code; K1, K2 did" in capsys.readouterr().err
    coding_path(log).unlink()
    assert main(["coding", str(log)]) == 1
    assert "has no codes" in capsys.readouterr().err
