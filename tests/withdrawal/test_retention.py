"""What is kept longer than the lab has promised is listed, and stays."""

from __future__ import annotations

import json
import os
from datetime import date
from pathlib import Path

import pytest

from tests.export.logs import speak, visit, write
from woz_tui.cli import main
from woz_tui.config.about_file import RetentionEntry
from woz_tui.withdrawal.retention import LOGS, MEDIA, overdue
from woz_tui.withdrawal.stored_files import stored_sessions

KEPT = RetentionEntry(media="30 d", logs="10 y")


def recorded(folder: Path) -> Path:
    """Two sessions, of the first of March and April, with sound."""
    for month in ("03", "04"):
        stem = f"2026-{month}-01T10-00-00_P0{month[1]}_S01"
        write(folder, visit(), stem)
        speak(folder / f"{stem}.media", "a.wav", 0.1)
    return folder


def told(folder: Path, today: date, kept: RetentionEntry = KEPT) -> list[tuple[str, str]]:
    found = overdue(stored_sessions([folder]).sessions, kept, today)
    return [(each.what, each.path.name[:7]) for each in found]


def test_a_day_after_its_last_day_it_is_over(tmp_path: Path) -> None:
    folder = recorded(tmp_path)
    assert told(folder, date(2026, 3, 31)) == []
    assert told(folder, date(2026, 4, 1)) == [(MEDIA, "2026-03")]
    assert told(folder, date(2026, 5, 2)) == [(MEDIA, "2026-03"), (MEDIA, "2026-04")]
    assert [what for what, _ in told(folder, date(2036, 4, 2))] == [MEDIA, MEDIA, LOGS, LOGS]
    assert told(folder, date(2036, 4, 2), RetentionEntry()) == []


def test_a_log_without_a_day_in_its_name_has_that_of_its_last_change(tmp_path: Path) -> None:
    log = write(tmp_path, visit()).rename(tmp_path / "visit.jsonl")
    os.utime(log, (0, 0))
    [kept] = overdue(stored_sessions([tmp_path]).sessions, KEPT, date(2026, 1, 1))
    assert (kept.recorded, kept.what) == (date(1970, 1, 1), LOGS)


def test_the_command_lists_and_deletes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = recorded(tmp_path / "recordings")
    before = sorted(folder.rglob("*"))
    about = tmp_path / "about.yaml"
    given = ["participants", str(folder), "--due", "--about", str(about), "--json"]
    about.write_text("title: x\n")
    assert main(given) == 1
    assert "write retention: {media: 30 d, logs: 10 y}" in capsys.readouterr().err
    about.write_text("retention: {logs: 0 d}\n")
    assert main(given) == 0
    rows = json.loads(capsys.readouterr().out)["due"]
    assert [(row["what"], row["until"]) for row in rows] == [
        (LOGS, "2026-03-01"),
        (LOGS, "2026-04-01"),
    ]
    assert sorted(folder.rglob("*")) == before
    assert main([*given, "--code", "P03"]) == 2
