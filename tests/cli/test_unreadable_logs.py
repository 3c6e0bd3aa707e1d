"""What stands in a folder of logs under a log's name, and is no file: named, never waited for."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STEM = "2026-03-01T10-00-00_P07_S01"
COMMANDS = {
    "report": ["report", "{log}"],
    "a folder": ["report", "{folder}"],
    "page": ["report", "--verify", "--html", "{folder}/page.html", "{log}"],
    "methods": ["methods", "{log}"],
    "engagement": ["engagement", "{log}"],
    "trials": ["engagement", "--trials", "{log}"],
    "compare": ["compare", "{log}", "{log}"],
    "replay": ["replay", "--robot", "--dry-run", "--experiment", "{demo}", "{log}"],
    "export": ["export", "--to", "csv", "--samples", "--out", "{folder}/out", "{folder}"],
    "design": ["design", "{study}", "--recordings", "{folder}"],
    "render": ["render", "{eyepi}", "idle", "--seconds", "0", "--inputs", "{log}"],
}


def recorded_folder(folder: Path) -> Path:
    folder.mkdir()
    sample = ROOT / "recordings" / "sample"
    shutil.copy(f"{sample}.jsonl", folder / f"{STEM}.jsonl")
    shutil.copy(f"{sample}.samples.jsonl", folder / f"{STEM}.samples.jsonl")
    os.mkfifo(folder / f"{STEM}.2.jsonl")
    os.mkfifo(folder / f"{STEM}.2.samples.jsonl")
    (folder / f"{STEM}.3.jsonl").symlink_to("/dev/zero")
    os.mkfifo(folder / "2026-03-02T10-00-00_P08_S02.jsonl")
    (folder / "2026-03-03T10-00-00_P09_S03.jsonl").symlink_to("/dev/zero")
    return folder


@pytest.mark.parametrize("name", COMMANDS)
def test_no_command_waits_for_a_pipe_or_reads_a_device(tmp_path: Path, name: str) -> None:
    folder = recorded_folder(tmp_path / "recordings")
    places = {
        "log": folder / f"{STEM}.jsonl",
        "folder": folder,
        "demo": ROOT / "experiments" / "demo.yaml",
        "eyepi": ROOT / "experiments" / "robots" / "eyepi.yaml",
        "study": ROOT / "experiments" / "study.yaml",
    }
    done = subprocess.run(
        [sys.executable, "-m", "woz_tui", *(word.format(**places) for word in COMMANDS[name])],
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert "Traceback" not in done.stderr
    # A rendering of half a log would be another one: it is refused.
    assert done.returncode == (2 if name == "render" else 0), done.stderr
