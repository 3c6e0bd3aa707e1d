"""`woz design`: who gets what, by the file and by earlier logs. What `woz check` says of it."""

from __future__ import annotations

import argparse
import json
import re
from pathlib import Path
from typing import Any

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, panel
from tests.session.study_rig import had, log
from woz_tui.cli import check
from woz_tui.features.study import command

FILE = panel(
    HELLO,
    head=f"{HEAD}conditions: [warm, cold]\ndesign: {{trials: 2, blind: {{warm: A, cold: B}}}}\n",
)


@pytest.fixture(autouse=True)
def _a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    for name in ("FORCE_COLOR", "COLUMNS", "TMUX", "STY"):
        monkeypatch.delenv(name, raising=False)


def designed(folder: Path, *options: str, text: str = FILE) -> int:
    path = folder / "e.yaml"
    path.write_text(text, encoding="utf-8")
    parser = argparse.ArgumentParser()
    command.add(parser)
    given = [str(path), "--recordings", str(folder / "recordings"), *options]
    return command.design(parser.parse_args(given), CATALOGUE)


def logs(folder: Path) -> None:
    where = folder / "recordings"
    log(where, "2026-03-01T10-00-00_S01", had("P01", ["warm", "cold"], "dddd", row=0), title="T")
    log(where, "2026-03-02T10-00-00_S01", had("P02", ["cold", "warm"], "aa", row=1), title="T")
    log(
        where,
        "2026-03-03T10-00-00_S01",
        had("P03", ["warm", "cold"], "d", row=-1, method="hand"),
        title="T",
    )
    log(where, "2026-03-04T10-00-00_S01", had("P04", ["mild"], "d"), title="T")
    log(where, "2026-03-05T10-00-00_S01", had("P05", ["cold", "warm"], "d"), title="Another")


def rows(printed: str) -> list[list[str]]:
    return [line.split() for line in printed.splitlines()]


def test_a_plan_before_anybody_came(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert designed(tmp_path) == 0
    printed = capsys.readouterr().out
    lines = [line.rstrip() for line in printed.splitlines()]
    assert lines[:3] == [
        "T",
        "Latin square (Williams): everybody gets all 2 conditions, 2 trials in each;"
        " the wizard sees labels",
        "4 trials for each participant",
    ]
    assert "nobody" in lines
    assert rows(printed)[-2:] == [
        ["1", "1", "warm", "(A),", "cold", "(B)"],
        ["2", "2", "cold", "(B),", "warm", "(A)"],
    ]


def test_what_was_used_and_what_comes_next(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs(tmp_path)
    assert designed(tmp_path, "--participants", "3", "--labels") == 0
    printed = capsys.readouterr().out
    found = rows(printed)
    assert ["P01", "1", "4", "of", "4", "A,", "B"] in found
    assert any(row[:7] == ["P02", "2", "0", "of", "4", "B,", "A"] for row in found)
    assert "aborted or excluded: this order can be used again" in printed
    assert ["P03", "-", "1", "of", "4", "A,", "B", "chosen", "by", "hand"] in found
    assert "from another design" in printed
    assert "P05" not in printed
    assert [row[1] for row in found[-3:]] == ["2", "2", "1"]


@pytest.mark.parametrize("form", ["text", "json"])
def test_labels_alone_name_no_condition_that_there_is_or_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], form: str
) -> None:
    logs(tmp_path)
    assert designed(tmp_path, "--labels", "--format", form) == 0
    printed = capsys.readouterr().out
    assert not {"warm", "cold", "mild"} & {*re.findall(r"\w+", printed)}
    if form == "json":
        told = json.loads(printed)
        orders = {each["participant"]: each["order"] for each in told["participants"]}
        assert (orders["P02"], orders["P04"]) == (["B", "A"], ["?"])
        assert told["next"][0]["order"] == ["B", "A"]


def test_the_plan_for_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    logs(tmp_path)
    assert designed(tmp_path, "--format", "json") == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["logs"], told["planned"]) == (4, 4)
    assert [each["counts"] for each in told["participants"]] == [True, False, True, False]
    assert told["next"] == [{"row": 1, "order": ["cold", "warm"]}] * 2


@pytest.mark.parametrize(
    ("section", "shown"),
    [
        ("{order: blocks, within: no, block: 4, seed: 1}", ["1", "2", "3", "4"]),
        ("{order: fixed}", ["1"]),
        ("{order: fixed, within: no}", ["1", "2"]),
    ],
)
def test_other_designs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], section: str, shown: list[str]
) -> None:
    text = panel(HELLO, head=f"{HEAD}conditions: [warm, cold]\ndesign: {section}\n")
    assert designed(tmp_path, text=text) == 0
    last = rows(capsys.readouterr().out)[-len(shown) :]
    assert [row[1] for row in last] == shown


def test_an_experiment_without_a_design_is_told_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert designed(tmp_path, text=panel(HELLO)) == 1
    assert "the file has no design; add one" in capsys.readouterr().err


def test_a_log_that_cannot_be_read_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "recordings" / "2026-03-01T10-00-00_S01.jsonl").mkdir(parents=True)
    assert designed(tmp_path) == 0
    assert "2026-03-01T10-00-00_S01.jsonl cannot be read" in capsys.readouterr().err


@pytest.mark.parametrize("count", ["0", "x", "1001", "-1"])
def test_how_many_participants_there_can_be(
    tmp_path: Path, count: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        designed(tmp_path, f"--participants={count}")
    assert "is not a whole number from 1 to 1000" in capsys.readouterr().err


STUDY = (Path(__file__).parents[2] / "config" / "good" / "study.yaml").read_text()


def checked(folder: Path, text: str, *options: str) -> int:
    path = folder / "e.yaml"
    path.write_text(text, encoding="utf-8")
    parser = argparse.ArgumentParser()
    check.add(parser)
    return check.check(parser.parse_args([str(path), *options]), CATALOGUE)


def test_check_shows_the_study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(tmp_path, STUDY, "--all") == 0
    printed = capsys.readouterr().out.split("\nstudy")[1]
    told = [" ".join(line.split()) for line in printed.splitlines()]
    for line in (
        "design Latin square (Williams): everybody gets all 3 conditions, 2 trials in each;"
        " the wizard sees labels",
        "row 1 warm (Lemon), cold (Orange), none (No)",
        "robot-ux after each condition: 4 items, scales 0 to 4 and -3 to 3, 1 in words",
        "again when the wizard starts it: 1 item, scales 1 to 7",
        "preflight The camera sees the whole table",
        "shaping the robot answers no earlier than 0.8 to 1.2 s after marker",
        "hidden distance, face",
        "blurred transcript",
    ):
        assert line in told
    assert [line for line in told if line.startswith("row ")][-1].startswith("row 6")


def test_check_says_nothing_of_a_study_that_is_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert checked(tmp_path, panel(HELLO)) == 0
    assert "\nstudy" not in capsys.readouterr().out


def test_check_tells_programs_of_the_study(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert checked(tmp_path, STUDY, "--format", "json") == 0
    study: dict[str, Any] = json.loads(capsys.readouterr().out)["study"]
    assert (len(study["orders"]), study["planned"]) == (6, 6)
