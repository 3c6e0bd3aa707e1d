"""Which files a session names where it ends."""

from __future__ import annotations

from pathlib import Path

from woz_tui.cli.run import files_of


def test_the_end_names_the_log_and_what_the_robot_process_said(tmp_path: Path) -> None:
    log, said = tmp_path / "t_P07_S01.jsonl", tmp_path / "t_P07_S01.host.log"
    asked = tmp_path / "t_S01.jsonl"  # before the participant was known
    log.touch()
    said.touch()
    assert files_of(asked) == [f"Log: {log}"]
    said.write_text("Traceback")
    assert files_of(asked) == [
        f"Log: {log}",
        f"Errors of drivers and of the robot process: {said}",
    ]
