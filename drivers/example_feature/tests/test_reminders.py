"""The reminders of an experiment file reach the log of a session, and its report."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from woz_feature_reminders.section import REMINDERS

from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

HERE = Path(__file__).parents[1]
#: For a process to start and a reminder to come, on a slow machine.
PATIENCE_S = 60.0


def written(folder: Path, reminders: str) -> Path:
    """The example file with these reminders."""
    text = (HERE / "reminders.yaml").read_text()
    path = folder / "reminders.yaml"
    path.write_text(f"{text[: text.index('reminders:')]}reminders: {reminders}\n")
    return path


def test_the_file_says_of_what_and_when() -> None:
    experiment = load(HERE / "reminders.yaml", installed())
    assert [(each.after, each.text) for each in REMINDERS.of(experiment)] == [
        (1.0, "Ask for consent"),
        (600.0, "Offer a break"),
    ]


@pytest.mark.parametrize(
    ("reminders", "where", "said"),
    [
        ("[{after: soon, text: Now}]", "8:14", "reminders[0].after"),
        ("[{after: 1 s}]", "8:13", "text"),
        ("[{after: 1 s, txet: Now}]", "8:26", "did you mean 'text'"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    tmp_path: Path, reminders: str, where: str, said: str
) -> None:
    with pytest.raises(ExperimentError) as raised:
        load(written(tmp_path, reminders), installed())
    problems = [str(problem) for problem in raised.value.problems]
    assert any(f":{where}" in each and said in each for each in problems), problems


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The log of a session in which a reminder has been due."""
    folder = tmp_path_factory.mktemp("session")
    words = (sys.executable, "-m", "woz_tui", "host", str(HERE / "reminders.yaml"), "--announce")
    host = subprocess.Popen(
        [*words, "--recordings", str(folder)], stdout=subprocess.PIPE, text=True, cwd=folder
    )
    try:
        assert host.stdout is not None
        path = Path(json.loads(host.stdout.readline())["log"])
        until = time.monotonic() + PATIENCE_S
        while not due(path) and time.monotonic() < until:
            threading.Event().wait(0.1)
    finally:
        host.send_signal(signal.SIGTERM)
        host.wait(PATIENCE_S)
    yield path


def due(log: Path) -> list[dict[str, Any]]:
    """The lines that say that a reminder is due."""
    lines = map(json.loads, log.read_bytes().splitlines(keepends=False))
    return [line for line in lines if line["kind"] == "reminder.due"]


def test_it_is_in_the_log_when_it_is_due(log: Path) -> None:
    (line,) = due(log)
    assert line["text"] == "Ask for consent"
    assert line["t"] >= 1_000_000


def test_it_is_an_event_of_exports_and_a_redacted_one_does_not_have_its_text(log: Path) -> None:
    for redact, text in (([], "Ask for consent"), (["--redact"], "[redacted]")):
        out = log.parent / f"out{len(redact)}"
        words = ["export", str(log), "--to", "csv", "--out", str(out), *redact]
        subprocess.run([sys.executable, "-m", "woz_tui", *words], check=True, timeout=PATIENCE_S)
        rows = [row for row in (out / "events.csv").read_text().splitlines() if "reminder" in row]
        assert len(rows) == 1
        assert text in rows[0]
