from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.console.surroundings import escape_time_ms, findings


@pytest.fixture
def tmux(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A `tmux` first in the path that says what its test writes into `said`."""
    program = tmp_path / "tmux"
    program.write_text(
        f'#!/bin/sh\n[ "$*" = "show-options -sv escape-time" ] && cat {tmp_path}/said'
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    return tmp_path / "said"


@pytest.mark.parametrize(("said", "ms"), [("500\n", 500), ("0\n", 0), ("", None), ("what?", None)])
def test_what_tmux_says(tmux: Path, said: str, ms: int | None) -> None:
    tmux.write_text(said)

    assert escape_time_ms() == ms


@pytest.mark.parametrize(("said", "level"), [("500", "warning"), ("10", "ok"), ("", "warning")])
def test_a_held_stop_is_a_warning_with_a_remedy(tmux: Path, said: str, level: str) -> None:
    tmux.write_text(said)

    found = findings({"TMUX": "/tmp/tmux-0/default,1,0"})[0]

    assert found.level == level
    assert ("escape-time" in found.remedy) == (level == "warning")


def test_screen_and_nothing() -> None:
    assert findings({"STY": "1.tty"})[0].level == "warning"
    assert [found.level for found in findings({})] == ["ok"]
