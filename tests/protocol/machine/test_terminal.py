"""What the terminal answers, and what is found when it does not."""

from __future__ import annotations

import termios

import pytest

from tests.fakes.answering_terminal import answering
from woz_tui.drivers.contract import Finding
from woz_tui.machine import terminal_check

KITTY = b"\x1b[?u"
STATUS = b"\x1b[c"
CURSOR = b"\x1b[6n"
#: Long enough for a loaded machine: a terminal that answers is never waited for this long.
PATIENT = 30.0
#: For terminals that never answer.
HASTY = 0.02


def subjects(findings: list[Finding]) -> dict[str, str]:
    return {finding.subject: finding.level for finding in findings}


def test_a_kitty_terminal_tells_all_keys_apart() -> None:
    answers = {KITTY: b"\x1b[?0u", STATUS: b"\x1b[?62;c", CURSOR: b"\x1b[1;1R"}
    with answering(answers) as descriptor:
        keys, line = terminal_check.conversation(descriptor, PATIENT)
    assert (keys.level, line.subject) == ("ok", "connection")
    assert "kitty" in keys.text
    assert "there and back" in line.text


def test_a_plain_terminal_is_told_by_its_other_answer() -> None:
    with answering({STATUS: b"\x1b[?1;2c", CURSOR: b"\x1b[24;80R"}) as descriptor:
        keys, _ = terminal_check.conversation(descriptor, PATIENT)
    assert keys.level == "info"
    assert keys.text.startswith("plain")


def test_a_silent_terminal_is_not_waited_for() -> None:
    with answering({}) as descriptor:
        findings = terminal_check.conversation(descriptor, HASTY)
    assert subjects(findings) == {"keys": "warning", "connection": "warning"}


def test_garbage_is_no_answer() -> None:
    garbage = b"\xff\x1b[?\x00\x1b["
    with answering({STATUS: garbage, CURSOR: garbage}) as descriptor:
        findings = terminal_check.conversation(descriptor, HASTY)
    assert subjects(findings) == {"keys": "warning", "connection": "warning"}


def test_the_terminals_mode_is_as_it_was_afterwards() -> None:
    with answering({STATUS: b"\x1b[?1;2c"}) as descriptor:
        before = termios.tcgetattr(descriptor)
        terminal_check.conversation(descriptor, HASTY)
        assert termios.tcgetattr(descriptor) == before


@pytest.mark.parametrize(
    ("environ", "levels"),
    [
        ({"TERM": "xterm-256color"}, {"terminal": "ok", "colours": "ok"}),
        ({"TERM": "linux"}, {"terminal": "ok", "colours": "info"}),
        ({"TERM": "xterm", "COLORTERM": "truecolor"}, {"terminal": "ok", "colours": "ok"}),
        ({"TERM": "xterm-kitty", "NO_COLOR": "1"}, {"terminal": "ok", "colours": "info"}),
        ({"TERM": "dumb"}, {"terminal": "error", "colours": "info"}),
        ({}, {"terminal": "error", "colours": "info"}),
    ],
)
def test_the_environment_is_judged(environ: dict[str, str], levels: dict[str, str]) -> None:
    found = subjects(terminal_check.environment(environ))
    assert {subject: found[subject] for subject in levels} == levels


@pytest.mark.parametrize(
    ("wait", "version", "level", "words"),
    [
        ("500", "tmux 3.3a", "warning", "500 ms (tmux 3.3a is older than 3.5"),
        ("500", "tmux 3.5a", "warning", "500 ms"),
        ("10", "tmux 3.5a", "ok", "10 ms"),
        ("0", "tmux 2.9", "ok", "0 ms"),
        (None, "tmux 3.3a", "info", "older than 3.5"),
        ("soon", "tmux next-3.6", "info", "does not report"),
        (None, None, "info", "does not report"),
    ],
)
def test_tmux_must_not_hold_the_stop_back(
    wait: str | None, version: str | None, level: str, words: str
) -> None:
    finding = terminal_check.tmux_escape(wait, version)
    assert finding.level == level
    assert words in finding.text
    if level != "ok":
        assert "set -sg escape-time 10" in finding.remedy


def test_screen_holds_the_stop_back() -> None:
    hidden, finding = terminal_check.multiplexers({"STY": "4711.pts-0.robot"})
    assert hidden.subject == "connection"
    assert "hold a key to drive" in hidden.remedy
    assert (finding.level, finding.subject) == ("warning", "screen")
    assert "maptimeout" in finding.remedy


def test_without_a_multiplexer_nothing_is_found() -> None:
    assert terminal_check.multiplexers({"TERM": "xterm"}) == []


@pytest.mark.parametrize(
    ("columns", "lines", "level"),
    [("80", "24", "ok"), ("79", "24", "warning"), ("80", "23", "warning"), ("200", "60", "ok")],
)
def test_the_size_is_judged(
    columns: str, lines: str, level: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setenv("LINES", lines)
    assert terminal_check.size().level == level
