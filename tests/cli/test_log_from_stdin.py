"""A session's log on standard input."""

from __future__ import annotations

import io
import json
import os
import sys
import tempfile
from pathlib import Path

import pytest

from tools import EXPERIMENTS
from woz_tui import cli
from woz_tui.cli.log_from_stdin import PipedError, stdin_as_log

LOG = EXPERIMENTS.parent / "recordings" / "sample.jsonl"
SAMPLES = LOG.with_name("sample.samples.jsonl")
BOTH = LOG.read_bytes() + SAMPLES.read_bytes()


@pytest.fixture(autouse=True)
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where standard input is kept; it has to be empty behind each command."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def pipe(monkeypatch: pytest.MonkeyPatch, data: bytes) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))


@pytest.mark.parametrize("data", [BOTH, SAMPLES.read_bytes() + LOG.read_bytes()])
def test_a_report_is_that_of_the_file(
    data: bytes, shelf: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    said = []
    for name in ("-", str(LOG)):
        pipe(monkeypatch, data)
        assert cli.main(["report", name, "--json", "--verify"]) == 0
        captured = capsys.readouterr()
        assert captured.err == ""
        told = json.loads(captured.out)
        (session,) = told["sessions"]
        path, stem = session.pop("path"), session.pop("stem")
        assert Path(path).stem == stem
        said.append(told)
    assert said[0] == said[1]
    assert not [*shelf.iterdir()]


def test_so_is_the_method_section(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pipe(monkeypatch, LOG.read_bytes())
    assert cli.main(["methods", "-"]) == 0
    piped = capsys.readouterr().out
    assert cli.main(["methods", str(LOG)]) == 0
    assert capsys.readouterr().out == piped


def test_the_model_is_run_over_a_log_from_a_pipe(
    shelf: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    said = []
    for name in ("-", str(LOG)):
        pipe(monkeypatch, BOTH)
        assert cli.main(["engagement", name, "--compare", "--samples", "2"]) == 0
        said.append(capsys.readouterr().out)
    assert "computed" in said[0]
    assert said[0] == said[1]
    assert not [*shelf.iterdir()]


def test_what_is_no_log_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pipe(monkeypatch, b"title: Guide\n")
    assert cli.main(["report", "-"]) == 1
    assert "standard-input" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["report", "methods"])
def test_it_can_be_read_once_only(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pipe(monkeypatch, BOTH)
    assert cli.main([command, "-", "-"]) == 2
    assert "can be used only once" in capsys.readouterr().err


def test_nobody_types_a_log(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    master, slave = os.openpty()
    with os.fdopen(master, "rb"), os.fdopen(slave, "r") as terminal:
        monkeypatch.setattr(sys, "stdin", terminal)
        assert cli.main(["report", "-"]) == 2
    assert "nothing is piped into it" in capsys.readouterr().err


def test_there_is_an_end_to_what_is_kept(shelf: Path) -> None:
    with (
        pytest.raises(PipedError, match="larger than 1 MiB"),
        stdin_as_log(io.BytesIO(BOTH * 99), b"", 1 << 20),
    ):
        pass
    assert not [*shelf.iterdir()]


@pytest.mark.parametrize("command", ["report", "engagement"])
def test_no_room_for_it_is_told_with_what_helps(
    command: str,
    shelf: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(shelf / "nowhere"))
    pipe(monkeypatch, BOTH)
    assert cli.main([command, "-"]) == 1
    said = capsys.readouterr().err
    assert "No such file" in said
    assert "TMPDIR" in said


@pytest.mark.parametrize("kind", ["sample", "marker"])
def test_a_line_that_is_longer_than_a_part_stays_whole(kind: str) -> None:
    lines = [f'{{"kind":"{kind}","text":"{"x" * (3 << 20)}"}}\n'.encode(), b'{"kind":"note"}\n']
    with stdin_as_log(io.BytesIO(lines[1]), lines[0]) as path:
        found = {each.name: each.read_bytes() for each in path.parent.iterdir()}
    samples, actions = "standard-input.samples.jsonl", "standard-input.jsonl"
    where = samples if kind == "sample" else actions
    assert found[where].startswith(lines[0])
    assert found[actions].endswith(lines[1])
    assert b"".join(found.values()).count(b"\n") == 2
