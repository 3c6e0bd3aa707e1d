"""The terminal's own size counts; what is no size ends neither in a traceback nor in silence."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.fakes.terminal import ROOT, WAIT_S, FakeTerminal
from woz_tui.cli import main

COMMANDS = (
    ["report", str(ROOT / "recordings")],
    ["robots"],
    ["check", str(ROOT / "experiments" / "demo.yaml"), "--keys"],
    ["design", str(ROOT / "experiments" / "study.yaml")],
)


@pytest.mark.parametrize("columns", ["0", "10", "-3"])
@pytest.mark.parametrize("command", COMMANDS, ids=[words[0] for words in COMMANDS])
def test_no_size_ends_in_a_traceback_or_in_silence(
    command: list[str],
    columns: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setenv("LINES", columns)
    assert main(command) == 0
    assert capsys.readouterr().out.strip()


@pytest.mark.real_clock
@pytest.mark.parametrize(("columns", "said"), [(60, "200"), (60, "0"), (120, "40"), (10, "")])
def test_a_terminal_knows_its_own_size(columns: int, said: str) -> None:
    command = [sys.executable, "-m", "woz_tui", *COMMANDS[2]]
    env = {"COLUMNS": said, "LINES": said} if said else {}
    with FakeTerminal(command, columns=columns, rows=40, env=env) as terminal:
        assert terminal.process.wait(WAIT_S) == 0
        terminal.wait_written(b"no errors")
        rules = [line for line in terminal.written.decode().splitlines() if "\u2500\u2500" in line]
    assert max(map(len, rules), default=0) <= max(columns, 20)
