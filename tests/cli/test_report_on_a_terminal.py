"""`woz report` on a terminal: what fits a screen first, everything with --all, progress."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from tests.analysis.example_sessions import study
from tests.fakes.terminal import ROOT, FakeTerminal
from woz_tui.cli.progress import progress

SAMPLE = ROOT / "recordings" / "sample.jsonl"


def report(*words: str | Path, rows: int = 24) -> list[str]:
    """The lines on the screen, without empty ones."""
    command = [sys.executable, "-m", "woz_tui", "report", *map(str, words)]
    with FakeTerminal(command, rows=rows) as terminal:
        assert terminal.wait_exit() == 0
        text = terminal.wait_for(lambda text: bool(text.strip()))
    return [line for line in text.splitlines() if line.strip()]


@pytest.mark.real_clock
def test_one_session_is_ten_lines_and_all_of_it_is_asked_for() -> None:
    lines = report(SAMPLE)
    assert len(lines) == 10
    assert lines[0].startswith("P01")
    assert any("Mistakes" in line for line in lines)
    assert "--all" in lines[-1]
    assert any(line.startswith("Timeline") for line in report(SAMPLE, "--all", rows=200))


@pytest.mark.real_clock
def test_many_sessions_are_a_screen_too(tmp_path: Path) -> None:
    study(tmp_path)
    lines = report(tmp_path)
    assert len(lines) <= 10
    assert "4 sessions, 2 participants" in lines[0]
    assert any(line.startswith("Wizard actions") for line in lines)


@pytest.mark.real_clock
def test_beside_a_page_no_tables_are_printed(tmp_path: Path) -> None:
    lines = report(SAMPLE, "--html", tmp_path / "p.html")
    assert lines[0].startswith("woz report: wrote")
    assert "P01" not in "".join(lines)


class Tty(io.StringIO):
    def isatty(self) -> bool:
        return True


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Tty:
    stream = Tty()
    monkeypatch.setattr(sys, "stderr", stream)
    return stream


def test_what_takes_over_a_second_says_how_far_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = on_terminal(monkeypatch)
    times = iter([0.0, 0.5, 1.2, 1.2, 1.3, 1.5, 1.5])
    with progress(lambda: next(times)) as show:
        for number in range(1, 5):
            show(f"session {number}")
    shown = [text for text in terminal.getvalue().split("\r\x1b[K") if text]
    assert shown == ["session 2", "session 4"]
    assert terminal.getvalue().endswith("\r\x1b[K")


def test_what_is_quick_or_piped_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with progress(lambda: 0.0) as show:
        show("session 1")
    assert terminal.getvalue() == ""
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    with progress(lambda: 0.0, patience_s=0.0) as show:
        show("session 1")
    assert pipe.getvalue() == ""
