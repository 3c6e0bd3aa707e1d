"""Logs of schemas that are read no more: every command names schema and commit, none calls them
damaged.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.test_unreadable_logs import COMMANDS, ROOT
from woz_tui.cli import main

STEM = "2026-03-01T10-00-00_P07_S01"
LINES = """\
{"kind":"session.start","seq":0,"t":0,"ts":"2026-03-01T10:00:00.000000Z","format":"woz-session",\
"schema":SCHEMA,"session":"S01","participant":"P07","condition":"warm","wizard":"W2","software":{},\
"experiment":"study.yaml","experiment_sha256":"0","seed":7,"clock":{}}
{"kind":"note","seq":1,"t":1000000,"ts":"2026-03-01T10:00:01.000000Z","text":"begins"}
"""
#: Those that go on without the log.
GOES_ON = ("design",)
MORE = {"coding": ["coding", "{log}"]}


@pytest.mark.parametrize("schema", [1, 2])
@pytest.mark.parametrize("name", [*COMMANDS, *MORE])
def test_an_old_log_is_refused_with_its_schema_and_who_reads_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, schema: int
) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    log = folder / f"{STEM}.jsonl"
    log.write_text(LINES.replace("SCHEMA", str(schema)))
    places = {
        "log": log,
        "folder": folder,
        "demo": ROOT / "experiments" / "demo.yaml",
        "eyepi": ROOT / "experiments" / "robots" / "eyepi.yaml",
        "study": ROOT / "experiments" / "study.yaml",
    }
    words = {**COMMANDS, **MORE}[name]
    code = main([word.format(**places) for word in words])
    said = capsys.readouterr()
    told = said.out + said.err
    assert f"a log of schema {schema}" in told
    assert "commit aef656da reads it" in told
    assert "damage" not in told
    assert "has no line of a session" not in told
    if name not in GOES_ON:
        assert code != 0


def test_whoever_looks_for_a_person_is_told_that_an_old_log_was_not_searched(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / f"{STEM}.jsonl"
    log.write_text(LINES.replace("SCHEMA", "2"))
    assert main(["participants", str(tmp_path), "--code", "P07"]) == 1
    assert f"{log}: a log of schema 2" in capsys.readouterr().err
