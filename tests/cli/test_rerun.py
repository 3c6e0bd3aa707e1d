"""`woz replay FILE --robot` and `--dry-run`: what is said before anything moves."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.fakes.terminal import FakeTerminal
from tests.replay.rerun_rig import write_log
from tests.replay.test_rerun_plan import END, LOG, Timed, command, dispatched, done_message
from woz_tui.cli import main
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.real_clock

EXPERIMENT = """\
title: Small
robot: simulated
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: Hello.}
"""


def log(tmp_path: Path, *messages: Timed) -> Path:
    """A log beside its experiment."""
    file = tmp_path / "small.yaml"
    file.write_text(EXPERIMENT, encoding="utf-8")
    start = m.SessionStart(
        session="S07",
        participant="P07",
        condition="",
        wizard="",
        software={},
        experiment="small.yaml",
        experiment_sha256=load(file, installed()).sha256,
        seed=3,
        clock={},
    )
    return write_log(tmp_path / LOG, [(0, start), *messages])


def one(at: float, name: str, verb: str = "say") -> list[Timed]:
    return [
        (at, command(name, verb)),
        (at, dispatched(name)),
        (at + 1, done_message(name)),
    ]


def test_the_dry_run_tells_every_command_and_what_becomes_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(
        tmp_path,
        *one(1, "c1"),
        (2.5, command("c2", "drive", args={"x": 1.0})),
        (2.5, dispatched("c2")),
        (3, m.Stopped(command="c2", reason="stop pressed")),
        (4, command("c3")),
        (4, m.Refused(command="c3", code="stopped", reason="the stop is pressed")),
        (9, END),
    )
    assert main(["replay", str(path), "--dry-run"]) == 0
    out = capsys.readouterr().out
    assert "session     S07" in out
    assert "commands    2 in 0:02.000" in out
    assert "robot: 1 say, 1 drive" in out
    assert "drives      1: they need a wizard at the console" in out
    assert '0:00.000  robot.say    {"text": "Hello"}' in out
    assert "drives, cut at 0:02.000 (stop pressed)" in out
    assert "left out: refused in the log: the stop is pressed" in out
    assert out.endswith("2 would be sent, 1 left out\n")
    main(["replay", str(path), "--dry-run", "--headless"])
    assert "are refused, because no wizard watches" in capsys.readouterr().out


def test_what_the_robot_cannot_do_gives_the_exit_code_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, *one(1, "c1"), *one(2, "c2", "fly"), (9, END))
    assert main(["replay", str(path), "--dry-run"]) == 1
    out = capsys.readouterr().out
    assert "not possible now: robot does not offer 'fly'" in out
    assert "1 of them because this robot cannot do them" in out


def test_a_changed_experiment_is_shown_and_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, *one(1, "c1"), (9, END))
    (tmp_path / "small.yaml").write_text(EXPERIMENT.replace("Hello.", "Hi."), encoding="utf-8")
    assert main(["replay", str(path), "--dry-run"]) == 1
    assert "its hash was" in capsys.readouterr().out
    assert main(["replay", str(path), "--dry-run", "--changed"]) == 0
    capsys.readouterr()
    assert main(["replay", str(path), "--robot", "--headless", "--yes"]) == 1
    assert "use --changed to run it nevertheless" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "alien"),
    [
        (["--robot", "--at", "0:02", "--headless", "--yes"], "--at"),
        (["--robot", "--speed", "0.5", "--paused", "--headless"], "--paused, --speed"),
        (["--dry-run", "--max-idle", "3"], "--max-idle"),
        (["--headless", "--yes"], "--yes, --headless"),
        (["--keymap", "mine.yaml"], "--keymap"),
        (["--dry-run", "--coder", "C"], "--dry-run"),
    ],
)
def test_options_of_the_screen_and_of_the_robot_are_not_mixed(
    words: list[str], alien: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, *one(1, "c1"), (9, END))
    assert main(["replay", str(path), *words]) == 2
    assert f"leave {alien} out" in capsys.readouterr().err
    assert [each.name for each in tmp_path.glob("*.jsonl")] == [LOG]


def test_nobody_to_ask_is_a_no(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = log(tmp_path, *one(1, "c1"), (9, END))
    assert main(["replay", str(path), "--robot", "--headless"]) == 1
    assert "use --yes" in capsys.readouterr().err
    assert [each.name for each in tmp_path.glob("*.jsonl")] == [LOG]


def replay(words: Sequence[str], tmp_path: Path) -> FakeTerminal:
    env = {"XDG_RUNTIME_DIR": str(tmp_path), "WOZ_SOCKET": str(tmp_path / "s")}
    command = [sys.executable, "-m", "woz_tui", "replay", *words, "--robot", "--headless"]
    return FakeTerminal(command, columns=100, env=env)


def test_it_asks_and_only_the_whole_word_counts(tmp_path: Path) -> None:
    path = log(tmp_path, *one(1, "c1"), (9, END))
    with replay([str(path)], tmp_path) as terminal:
        terminal.wait_text("Type yes to run it again")
        terminal.send("y\r")
        terminal.wait_text("Nothing was run.")
        assert terminal.process.wait(30) == 1
    with replay([str(path)], tmp_path) as terminal:
        terminal.wait_text("Type yes to run it again")
        terminal.send("yes\r")
        terminal.wait_text("robot.say text Hello")
        terminal.wait_text("1 sent, 0 skipped")
        assert terminal.process.wait(30) == 0
    assert len([each for each in tmp_path.glob("*.jsonl") if "samples" not in each.name]) == 2


@pytest.mark.safety
def test_escape_stops_it(tmp_path: Path) -> None:
    commands = [line for n in range(50) for line in one(1 + n * 3, f"c{n}")]
    path = log(tmp_path, *commands, (999, END))
    with replay([str(path), "--yes"], tmp_path) as terminal:
        terminal.wait_text("robot.say text Hello")
        terminal.send("\x1b")
        terminal.wait_text("the re-run has ended (stopped)")
        assert terminal.process.wait(30) == 130


def test_no_log_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("nothing.jsonl", "small.yaml"):
        assert main(["replay", str(tmp_path / name), "--dry-run"]) == 1
        assert "woz: " in capsys.readouterr().err
