"""What a wizard reads in the shell where a session ends or is left."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from woz_tui.cli.console_start import ClosedConsole, farewell

LEFT = ClosedConsole("detached", 0, abandon_after=600.0)
ENDED = ClosedConsole("ended", 0)


def test_the_end_names_the_log_what_to_do_with_it_and_what_the_robot_process_said(
    tmp_path: Path,
) -> None:
    log, said = tmp_path / "t_P07_S01.jsonl", tmp_path / "t_P07_S01.host.log"
    asked = tmp_path / "t_S01.jsonl"  # before the participant was known
    log.touch()
    said.touch()
    told = [f"Log: {log}", f"Its figures: woz report {log}", f"See it again: woz replay {log}"]
    assert farewell(ENDED, "attach", asked) == told
    said.write_text("Traceback")
    told.append(f"Errors of drivers and of the robot process: {said}")
    assert farewell(ENDED, "attach", asked) == told


def test_the_end_says_where_the_sentences_are_that_were_typed(tmp_path: Path) -> None:
    log = tmp_path / "t_P07_S01.jsonl"
    log.touch()
    closed = ClosedConsole("ended", 0, typed_copy="/study/talk-typed.yaml")
    assert farewell(closed, "attach", log)[-1] == "Typed sentences: /study/talk-typed.yaml"
    told = farewell(closed, "attach", None)  # on another computer, as the log
    assert told == []


def test_who_leaves_it_running_reads_how_to_come_back_and_when_it_ends(tmp_path: Path) -> None:
    log = tmp_path / "t_P07_S01.jsonl"
    log.touch()
    assert farewell(LEFT, "attach --as head", log) == [
        "The session continues; join it again with `woz attach --as head`.",
        "Without a console it ends by itself after 10 min"
        " (`session: {abandon_after: 1 h}` in the experiment file changes that).",
        f"Log: {log}",
    ]


def test_where_a_shell_does_not_find_woz_it_is_told_by_its_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As after `make demo`, before anybody has linked it."""
    monkeypatch.setattr(sys, "argv", [".venv/bin/woz", "demo"])
    monkeypatch.setenv("PATH", str(tmp_path))
    told = farewell(LEFT, "attach", None)
    assert told[0] == "The session continues; join it again with `.venv/bin/woz attach`."
    log = tmp_path / "t_P07_S01.jsonl"
    assert f"Its figures: .venv/bin/woz report {log}" in farewell(ENDED, "attach", log)
