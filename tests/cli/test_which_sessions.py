"""All commands that take logs mean the same sessions, whatever else lies in the folder."""

from __future__ import annotations

import csv
import errno
import json
import os
from pathlib import Path

import pytest

from tests.analysis.example_sessions import ExampleSession
from woz_tui.cli import main
from woz_tui.features.study.earlier_sessions import EarlierSessions
from woz_tui.log.sessions import sessions_in
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

FIRST, SECOND, THIRD = (f"2026-03-0{day}T10-00-00_P0{day}_S0{day}" for day in (1, 2, 3))


def session(day: int) -> ExampleSession:
    """The session of one participant on one day."""
    code = f"0{day}"
    wall = f"2026-03-{code}T10:00:00.000000Z"
    example = ExampleSession(participant=f"P{code}", session=f"S{code}", wall=wall)
    return example.act(1 + day / 1000).act(3).end(10 + day)


@pytest.fixture
def folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    """Three sessions, and what people leave beside them."""
    recordings = tmp_path / "recordings"
    first, second, third = (session(day).written(recordings, name) for day, name in names())
    sample = codec.encode(m.Reading(seq=99, t=2_000_000, sensor="loudness", value=0.5))
    first.with_suffix(".samples.jsonl").write_bytes(sample)
    # Copies: by a file manager, in a second folder, cut short, redacted.
    (recordings / f"{FIRST} (1).jsonl").write_bytes(first.read_bytes())
    (recordings / "backup").mkdir()
    (recordings / "backup" / second.name).write_bytes(second.read_bytes())
    lines = third.read_bytes().splitlines(keepends=True)
    (recordings / f"0 {third.name}").write_bytes(b"".join(lines[:4]))
    redacting = ["--to", "jsonl", "--redact-text", "--out", str(recordings / "published")]
    assert main(["export", str(first), str(second), *redacting]) == 0
    # Left behind, and others' files.
    (recordings / "2026-02-01T10-00-00_P09_S09.samples.jsonl").write_bytes(sample)
    (recordings / "answers.jsonl").write_text('{"question": 1}\n')
    (recordings / f"{FIRST}.coding.jsonl").write_text("")
    capsys.readouterr()
    return recordings


def names() -> list[tuple[int, str]]:
    return [(1, FIRST), (2, SECOND), (3, THIRD)]


def told(text: str) -> set[str]:
    """The files that are named at the beginning of lines on stderr, without their folder."""
    lines = (line.split(": ", 1)[1] for line in text.splitlines() if ": /" in line)
    return {Path(line.split(".jsonl: ")[0] + ".jsonl").name for line in lines}


LEFT_OUT = {
    *(f"{FIRST} (1).jsonl", f"{SECOND}.jsonl", f"0 {THIRD}.jsonl"),
    *("P01_S01.jsonl", "P02_S02.jsonl", "2026-02-01T10-00-00_P09_S09.samples.jsonl"),
}


def test_every_command_means_the_same_sessions(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs, problems = sessions_in([str(folder)])
    assert [log.stem for log in logs] == [FIRST, SECOND, THIRD]
    assert {Path(problem.split(": ")[0]).name for problem in problems} == LEFT_OUT

    assert main(["report", str(folder), "--json"]) == 1
    shown = capsys.readouterr()
    assert [each["session"] for each in json.loads(shown.out)["sessions"]] == ["S01", "S02", "S03"]
    assert told(shown.err) == LEFT_OUT

    assert main(["export", str(folder), "--to", "csv", "--out", str(tmp_path / "out")]) == 1
    assert told(capsys.readouterr().err) >= LEFT_OUT
    with (tmp_path / "out" / "sessions.csv").open(encoding="utf-8") as file:
        assert [row["log"] for row in csv.DictReader(file)] == [FIRST, SECOND, THIRD]

    earlier = EarlierSessions(folder).read("", "experiments/guide.yaml")
    assert (earlier.logs, len(earlier.past)) == (3, 3)

    assert (
        main(["compare", str(folder / f"{FIRST}.jsonl"), str(folder / f"{FIRST} (1).jsonl")]) == 0
    )
    assert told(capsys.readouterr().err) == {f"{FIRST} (1).jsonl"}

    assert main(["methods", str(folder)]) == 1
    shown = capsys.readouterr()
    assert "3 participants" in shown.out or "three participants" in shown.out.lower()
    assert told(shown.err) == LEFT_OUT


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_a_log_that_another_program_saved_is_read(
    encoding: str, ends: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = session(1).written(tmp_path, FIRST)
    main(["report", str(log), "--json"])
    before = json.loads(capsys.readouterr().out)["sessions"][0]
    log.write_bytes(log.read_text(encoding="utf-8").replace("\n", ends).encode(encoding))
    assert main(["report", str(log), "--json", "--verify"]) == 0
    after = json.loads(capsys.readouterr().out)["sessions"][0]
    wholeness = after["wholeness"]["sentences"]
    assert [sentence for sentence in wholeness if encoding[:5] in sentence]
    assert not [sentence for sentence in wholeness if "changed" in sentence]
    assert {**after, "wholeness": 0} == {**before, "wholeness": 0}


def test_codes_that_are_probably_one_persons_are_named_everywhere(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "recordings"
    for day, code in enumerate(("P07", "p07", "P8", "P008"), 1):
        wall = f"2026-03-0{day}T10:00:00.000000Z"
        example = ExampleSession(participant=code, session=f"S{day}", wall=wall).act(1).end(20)
        example.written(folder, f"2026-03-0{day}T10-00-00_{code}_S{day}")
    for command in (
        ["report", str(folder)],
        ["methods", str(folder)],
        ["export", str(folder), "--to", "bids", "--out", str(tmp_path / "bids")],
    ):
        assert main(command) == 0
        shown = capsys.readouterr()
        assert "P008 and P8, P07 and p07" in (shown.out + shown.err).replace("\n", " ")
    labels = [path.name.casefold() for path in (tmp_path / "bids").glob("sub-*")]
    assert len(labels) == len(set(labels)) == 4


def test_a_folder_below_that_cannot_be_read_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for place, (day, name) in zip((".", "closed"), names()[:2], strict=True):
        session(day).written(tmp_path / place, name)
    scandir = os.scandir

    def refusing(path: str = ".") -> object:
        if Path(path).name == "closed":
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refusing)
    logs, problems = sessions_in([str(tmp_path)])
    assert [log.stem for log in logs] == [FIRST]
    assert problems == [f"{tmp_path}/closed: Permission denied: sessions in it are left out"]
    assert main(["participants", str(tmp_path), "--code", "P02"]) == 1
    assert f"{tmp_path}/closed: Permission denied" in capsys.readouterr().err


def test_the_copy_with_more_lines_is_read_in_whatever_encoding(tmp_path: Path) -> None:
    log = session(1).written(tmp_path, FIRST)
    lines = log.read_text(encoding="utf-8").splitlines(keepends=True)
    saved = tmp_path / f"{FIRST} a.jsonl"
    for left, read in ((lines[:-2], log), (lines, log), ([*lines, lines[-1]], saved)):
        saved.write_text("".join(left), encoding="utf-16")
        assert sessions_in([str(tmp_path)])[0] == [read]
    log.rename(tmp_path / f"{FIRST} longer name.jsonl")
    saved.write_text("".join(lines), encoding="utf-16")
    assert sessions_in([str(tmp_path)])[0] == [tmp_path / f"{FIRST} longer name.jsonl"]
