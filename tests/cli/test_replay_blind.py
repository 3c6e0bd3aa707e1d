"""A changed experiment, and commands of then, told to a wizard who is blind to the condition."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.replay.rerun_rig import write_log
from tests.replay.test_rerun_plan import END, LOG, Timed, command, dispatched, done_message
from woz_tui.cli import main
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.host.experiment_view import ExperimentView, plan_of
from woz_tui.protocol import messages as m
from woz_tui.replay.experiment_origin import _places
from woz_tui.replay.rerun_progress import RerunLines
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_start import experiment_files

pytestmark = pytest.mark.safety

EXPERIMENT = """\
title: Small
robot: simulated
conditions: [warm, cold]
design: {trials: 1, blind: {warm: Lemon, cold: Orange}}
variables:
  greeting:
    warm: How lovely to see you
    cold: Good day
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: "{greeting}"}
"""
SECRETS = ("warm", "cold", "lovely", "Good day", "Lemon", "Orange")
#: What a command says of itself whose text depends on the condition.
TELLING: dict[str, Any] = {"tells": ("condition",), "unfilled": {"text": "{greeting}"}}
HINT = "--reveal shows the texts"
#: What may have been changed since, and where it is then.
CHANGES = {
    "a text": (EXPERIMENT.replace("Good day", "Good night"), "line 8 in the log, line 8 now"),
    "another text": (EXPERIMENT.replace("lovely", "very lovely"), "line 7 in the log, line 7 now"),
    "no blindness": (
        EXPERIMENT.replace(", blind: {warm: Lemon, cold: Orange}", ""),
        "line 4 in the log, line 4 now",
    ),
    "errors": (EXPERIMENT.replace("Orange", "warm"), ":4:"),
}


def log(folder: Path, *messages: Timed, plan: bool = True) -> Path:
    """The log of a session that was played blind, beside its experiment."""
    file = folder / "small.yaml"
    file.write_text(EXPERIMENT, encoding="utf-8")
    read = load(file, installed())
    start = m.SessionStart(
        session="S07",
        participant="P07",
        condition="cold",
        wizard="",
        software={},
        experiment="small.yaml",
        experiment_sha256=read.sha256,
        seed=3,
        clock={},
    )
    session_plan = plan_of(ExperimentView(read, values=dict(read.variables)))
    beginning: list[Timed] = [(0, start), (0, experiment_files(read))]
    return write_log(
        folder / LOG, [*beginning, *([(0, session_plan)] if plan else []), *messages, (9, END)]
    )


def said_greeting() -> list[Timed]:
    return [
        (1, command("c1", args={"text": "Good day"}, **TELLING)),
        (1, dispatched("c1")),
        (2, done_message("c1")),
    ]


def printed_text(
    words: Sequence[str],
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> str:
    """All that is printed, without the name of the test's own folder."""
    monkeypatch.setattr("woz_tui.cli.console_start.terminal_problem", lambda: "")
    assert main(["replay", str(path), *words]) == 1
    return "".join(capsys.readouterr()).replace(str(path.parent), "")


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("words", [[], ["--dry-run"], ["--robot", "--headless", "--yes"]])
def test_a_blind_wizard_is_told_where_it_has_changed_and_no_text(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    change: str,
) -> None:
    path = log(tmp_path, *said_greeting())
    text, place = CHANGES[change]
    (tmp_path / "small.yaml").write_text(text, encoding="utf-8")
    _told_where_and_no_text(place, path, monkeypatch, capsys, words)


def _told_where_and_no_text(
    place: str,
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: Sequence[str] = (),
) -> None:
    printed = printed_text(words, path, monkeypatch, capsys)
    assert place in printed
    assert HINT in printed
    assert not [secret for secret in SECRETS if secret in printed]
    everything = printed_text([*words, "--reveal"], path, monkeypatch, capsys)
    assert [secret for secret in SECRETS if secret in everything]
    assert HINT not in everything


def test_a_study_that_is_blind_by_now_only_keeps_its_texts_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, plan=False)
    file = tmp_path / "small.yaml"
    path.write_bytes(path.read_bytes().replace(b"blind", b"other"))
    text, place = CHANGES["a text"]
    file.write_text(text, encoding="utf-8")
    _told_where_and_no_text(place, path, monkeypatch, capsys)


def test_a_log_whose_plan_is_lost_is_taken_for_blind_by_its_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, plan=False)
    file = tmp_path / "small.yaml"
    text, place = CHANGES["no blindness"]
    file.write_text(text, encoding="utf-8")
    _told_where_and_no_text(place, path, monkeypatch, capsys)


def test_the_commands_of_then_are_shown_as_the_wizard_saw_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, *said_greeting())
    assert main(["replay", str(path), "--dry-run"]) == 0
    printed = capsys.readouterr().out
    assert "{greeting}" in printed
    assert "Good day" not in printed
    assert main(["replay", str(path), "--dry-run", "--reveal"]) == 0
    assert "Good day" in capsys.readouterr().out


def test_so_are_they_while_it_runs_without_a_console(tmp_path: Path) -> None:
    log(tmp_path)
    read = load(tmp_path / "small.yaml", installed())
    study = plan_of(ExperimentView(read, values=dict(read.variables))).settings.study
    long = command("c1", args={"text": "Good day. " * 9}, source="replay", **TELLING)
    rerun_sent = m.RerunSent(command="c1", original_command="c9", due=0, late_us=0)
    progress = RerunLines(redactor=Redactor(study))
    lines = [line for message in (long, rerun_sent) for line in progress.lines(message)]
    assert "{greeting}" in "".join(lines)
    assert not [secret for secret in SECRETS[:4] if secret in "".join(lines)]


_NAMED = re.compile(r"lines? (\d+)(?: to (\d+))? (in the log|now)")


@given(st.lists(st.sampled_from("ab")), st.lists(st.sampled_from("ab")))
def test_what_is_not_named_is_the_same_in_both(then: list[str], now: list[str]) -> None:
    rest = {"in the log": dict(enumerate(then, 1)), "now": dict(enumerate(now, 1))}
    for line in _places("f", "\n".join(then), "\n".join(now)):
        for first, last, which in _NAMED.findall(line):
            for number in range(int(first), int(last or first) + 1):
                del rest[which][number]
    assert [*rest["in the log"].values()] == [*rest["now"].values()]
