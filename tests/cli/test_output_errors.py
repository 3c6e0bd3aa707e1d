"""What a command prints goes where it cannot go: it says so, in a line."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from woz_tui.cli import main


def test_a_full_disk_is_told_and_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        monkeypatch.setattr("sys.stdout", full)
        assert main(["schema"]) == 1
    monkeypatch.undo()
    assert capsys.readouterr().err == "woz: standard output: No space left on device\n"


def test_a_terminal_without_a_sign_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "zoë.yaml"
    file.write_text("title: Zoë\nrobot: simulated\npanels:\n- title: Zoë\n  actions: []\n")
    monkeypatch.setattr("sys.stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert main(["check", str(file)]) == 1
    monkeypatch.undo()
    assert "cannot show U+00EB: its encoding is ascii" in capsys.readouterr().err


def test_closed_output_is_no_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout", None)
    assert main(["schema"]) == 0
