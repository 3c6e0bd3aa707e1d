"""Texts of files and logs are shown as they are, whatever they look like, and command nothing."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import msgspec
import pytest

from tests.analysis.example_sessions import ExampleSession
from tests.cli.test_report import session
from tests.export.logs import Timed, visit
from tests.fakes.hostile_texts import HOSTILE, MARKUP, OBEYED, hostile
from tests.protocol import examples
from woz_tui.cli import main
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

EXPERIMENT = """
title: "T H"
robot: simulated
conditions: ["warm H", "cold H"]
variables: {room: "room H"}
design: {trials: 2}
questionnaires:
  - name: ux
    title: "How H"
    when: end
    items: [{name: hard, question: "How hard H?", scale: {low: 1, high: 5}}]
preflight: ["the door H"]
panels:
  - title: "Speech H"
    actions:
      - {key: h, label: "Hello H", say: "Hi H {room}"}
      - {key: g, label: "Guten H", say: "Tag H"}
""".replace(" H", f" {json.dumps(HOSTILE)[1:-1]}")


def write_log(folder: Path, messages: Iterable[m.Message], stem: str) -> Path:
    path = folder / f"{stem}.jsonl"
    lines = [json.loads(codec.encode(message)) for message in messages]
    for number, line in enumerate(lines):
        line["seq"] = number
    path.write_text(
        "".join(json.dumps(hostile(line), ensure_ascii=False) + "\n" for line in lines),
        encoding="utf-8",
    )
    return path


def timed(course: Iterable[Timed]) -> list[m.Message]:
    return [
        msgspec.structs.replace(message, t=round(seconds * 1_000_000))
        for seconds, message in course
        if not codec.is_sample(message)
    ]


@pytest.fixture
def logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("COLUMNS", "NO_COLOR", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    folder = tmp_path / "recordings"
    folder.mkdir()
    note = ExampleSession().add(1, m.Note(text="laughs")).add(2, m.Marker(text="unclear")).end(3)
    write_log(folder, session().messages, "2026-03-01T10-00-00_P07_S01")
    write_log(folder, timed(visit()), "2026-03-01T11-00-00_P08_S02")
    write_log(folder, examples.messages(), "2026-03-01T12-00-00_P09_S03")
    write_log(folder, note.messages, "2026-03-01T13-00-00_P10_S04")
    (tmp_path / "e.yaml").write_text(EXPERIMENT, encoding="utf-8")
    return folder


#: A command, and whether its table or page shows texts of the log or of the file.
COMMANDS = [
    ("report recordings/2026-03-01T10-00-00_P07_S01.jsonl", True),
    ("report recordings/2026-03-01T11-00-00_P08_S02.jsonl --all", True),
    ("report recordings/2026-03-01T12-00-00_P09_S03.jsonl --verify", True),
    ("report recordings/2026-03-01T13-00-00_P10_S04.jsonl", True),
    ("report recordings --csv csv", True),
    ("report recordings --html page.html", False),
    ("report recordings --json", True),
    ("methods recordings", True),
    ("methods recordings --markdown", True),
    ("check e.yaml", True),
    ("check e.yaml --format json", True),
    ("design e.yaml", True),
    ("design e.yaml --labels --format json", True),
    ("doctor e.yaml", False),
    ("doctor e.yaml --json", False),
    ("train --history --recordings recordings", True),
    ("replay recordings/2026-03-01T11-00-00_P08_S02.jsonl --robot --dry-run", False),
    (
        "compare recordings/2026-03-01T11-00-00_P08_S02.jsonl"
        " recordings/2026-03-01T12-00-00_P09_S03.jsonl --changed --all",
        True,
    ),
    ("compare recordings/2026-03-01T11-00-00_P08_S02.jsonl recordings/none --json", False),
    ("engagement recordings/2026-03-01T11-00-00_P08_S02.jsonl", False),
    ("engagement recordings/2026-03-01T12-00-00_P09_S03.jsonl", False),
    ("engagement recordings/2026-03-01T11-00-00_P08_S02.jsonl --compare", False),
    ("engagement recordings/2026-03-01T12-00-00_P09_S03.jsonl --compare --json", True),
    ("engagement recordings/2026-03-01T11-00-00_P08_S02.jsonl --trials", False),
    ("export recordings --to csv --out exported --samples", False),
    ("render e.yaml idle --seconds 0.1", False),
    ("visitors --recordings recordings list", False),
    ("midi show e.yaml", False),
    ("convert e.yaml", False),
    ("schema", False),
]


@pytest.mark.parametrize(("words", "shows"), COMMANDS, ids=[words for words, _ in COMMANDS])
def test_every_command_shows_texts_as_they_are(
    logs: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: str,
    shows: bool,
) -> None:
    monkeypatch.setenv("COLUMNS", "2000")
    main(words.split())
    out, err = capsys.readouterr()
    assert not OBEYED.search(out)
    assert not OBEYED.search(err)
    assert not shows or MARKUP in out


def test_colours_are_all_that_a_terminal_gets_to_obey(
    logs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm-256color")
    for words in ("check e.yaml", "report recordings", "design e.yaml"):
        main(words.split())
        out, looks = re.subn("\x1b\\[[0-9;]*m", "", capsys.readouterr().out)
        assert looks
        assert not OBEYED.search(out)


def test_a_program_gets_the_texts_unchanged(logs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["report", "recordings/2026-03-01T13-00-00_P10_S04.jsonl", "--json"])
    found = json.loads(capsys.readouterr().out)
    marks = found["sessions"][0]["marks"]
    assert [mark["text"] for mark in marks] == [f"laughs {HOSTILE}", f"unclear {HOSTILE}"]


@pytest.mark.parametrize(
    "words",
    [
        ["check", f"nowhere {HOSTILE}.yaml"],
        ["check", "broken.yaml"],
        ["report", f"nowhere {HOSTILE}"],
        ["replay", f"nowhere {HOSTILE}"],
        ["compare", f"nowhere {HOSTILE}", "recordings"],
        ["export", f"nowhere {HOSTILE}", "--to", "csv", "--out", "out"],
        ["design", "e.yaml", f"--{HOSTILE}"],
        [HOSTILE],
    ],
    ids=lambda words: repr(words[0][:8]),
)
def test_errors_command_nothing(
    logs: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    Path("broken.yaml").write_text(f"title: T\npanels: [{HOSTILE}\n", encoding="utf-8")
    try:
        assert main(words) > 0
    except SystemExit as error:
        assert error.code
    out, err = capsys.readouterr()
    assert err
    assert not OBEYED.search(out + err)


def test_a_traceback_commands_nothing(logs: Path) -> None:
    program = f"""
import sys
from woz_tui import cli
from woz_tui.cli import check
def run(arguments):
    raise ValueError({HOSTILE!r})
check.run = run
sys.argv = ["woz", "check", "e.yaml"]
cli.program()
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONUTF8": "1"},
        capture_output=True,
        encoding="utf-8",
        timeout=60,
        check=False,
    )
    assert done.returncode == 1
    assert "ValueError: [/x]" in done.stderr
    assert not OBEYED.search(done.stderr)
