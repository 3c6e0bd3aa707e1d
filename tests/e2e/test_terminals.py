"""Sizes, poor terminals, no terminal at all, and commands that cannot be carried out."""

from __future__ import annotations

import re
import subprocess

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, until
from tests.fakes.terminal import WAIT_S
from woz_tui.system.user_folders import WIZARD

pytestmark = pytest.mark.real_clock


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (160, 50), (60, 20)])
def test_sizes_and_a_resize_while_running(lab: Lab, columns: int, rows: int) -> None:
    terminal = lab.run(lab.file("guide.yaml", scenes.guide()), columns=columns, rows=rows)
    for size in ((columns, rows), (160, 50), (60, 20), (80, 24), (30, 8), (columns, rows)):
        terminal.resize(*size)
        drawn = "Events ──" if size[0] >= 80 else f"{size[0]} x {size[1]} is small"
        terminal.wait_text(drawn)
    terminal.send("h")
    terminal.wait_text("Hello")
    lab.log.wait("action.done")
    terminal.send("\x1b")
    terminal.wait_text("STOPPED by key")


def test_a_size_that_comes_and_goes_leaves_a_whole_screen(lab: Lab) -> None:
    terminal = lab.run(lab.file("guide.yaml", scenes.guide()), columns=160, rows=50)
    parts = ("Events ──", "Sensors ──", "Script ──", "Hello P01.", "attached", "● Recording")
    terminal.wait_for(lambda screen: all(part in screen for part in parts))
    for _ in range(5):
        terminal.resize(30, 8)
        terminal.resize(160, 50)
        terminal.wait_for(lambda screen: all(part in screen for part in parts))


@pytest.mark.parametrize(
    ("env", "never"),
    [
        ({"TERM": "linux"}, rb"\x1b\[[0-9;]*[34]8;[25];"),
        ({"NO_COLOR": "1"}, rb"\x1b\[([0-9;]*;)?([34]8;[25]|3[0-7]|4[0-7]|9[0-7]|10[0-7])[;m]"),
    ],
)
def test_terminals_with_few_colours(lab: Lab, env: dict[str, str], never: bytes) -> None:
    terminal = lab.run(lab.file("guide.yaml", scenes.guide()), env=env)
    terminal.send("h")
    lab.log.wait("action.done")
    terminal.wait_text("✓ Hello" if env.get("TERM") != "linux" else "Hello")
    terminal.send("\x1b")
    terminal.wait_text("STOPPED by key")
    assert re.search(never, bytes(terminal.written)) is None


@pytest.mark.parametrize("command", ["run", "attach"])
def test_a_dumb_terminal_is_refused(lab: Lab, command: str) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    words = [command, str(file)] if command == "run" else [command]
    terminal = lab.terminal(words, env={"TERM": "dumb"})
    assert terminal.wait_exit() == 2
    terminal.wait_text("TERM=dumb cannot show the console")
    assert lab.sockets() == []


def error_text(process: subprocess.Popen[bytes]) -> str:
    """What it wrote on standard error until it ended."""
    return process.communicate(timeout=WAIT_S)[1].decode()


@pytest.mark.parametrize("command", ["run", "attach"])
def test_without_a_terminal_it_is_refused(lab: Lab, command: str) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    process = lab.woz(*([command, str(file)] if command == "run" else [command]))
    assert "needs a terminal" in error_text(process)
    assert process.returncode == 2
    assert lab.sockets() == []


def test_a_code_that_is_typed_while_the_session_starts_stands_in_the_dialog(lab: Lab) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    terminal = lab.terminal(["run", str(file), "--recordings", str(lab.recordings)])
    terminal.send("P07\r")
    terminal.wait_text("│ P07 ")
    terminal.send("8")
    terminal.wait_text("│ P078 ")
    assert "A participant needs" not in terminal.text
    assert lab.log.lines("session.changed") == [], "enter was pressed before anybody could see it"


def test_keys_that_are_pressed_before_the_screen_is_there_play_nothing(lab: Lab) -> None:
    text = scenes.guide().replace(
        "robot: simulated",
        "robot: {drivers: {robot: {type: simulated},"
        " far: {type: rangefinder, port: /dev/none, framing: lines}}}",
    )
    terminal = lab.terminal(["run", str(lab.file("guide.yaml", text)), *lab.session()])
    terminal.send("h\r*/\r")
    terminal.wait_text("Keys pressed during the start were not played")
    terminal.send("n")
    assert lab.log.wait("action.requested").fields["action"] == "Nod"
    assert not any(f"╭─ {box}" in terminal.text for box in ("Failed", "Trial", "Say"))


def test_the_first_session_asks_who_plays(lab: Lab) -> None:
    (lab.folder / "state" / WIZARD).unlink()
    file = lab.file("guide.yaml", scenes.guide())
    terminal = lab.terminal(["run", str(file), *lab.session()])
    terminal.wait_text("Your code as the wizard")
    terminal.send("W3\r")
    assert lab.log.wait("session.start").fields["wizard"] == "W3"


def test_a_console_that_cannot_open_leaves_no_robot_process(lab: Lab) -> None:
    lab.file("textual.py", "raise ImportError('a broken installation')\n")
    file = lab.file("guide.yaml", scenes.guide())
    terminal = lab.terminal(["run", str(file), *lab.session()], env={"PYTHONPATH": str(lab.folder)})
    assert terminal.wait_exit() == 1
    assert lab.processes() == []
    terminal.wait_text("the robot process was ended")


def test_attach_without_a_session(lab: Lab) -> None:
    terminal = lab.terminal(["attach"])
    assert terminal.wait_exit() == 1
    terminal.wait_text("no session is running")
    terminal = lab.terminal(["attach", "S99"])
    assert terminal.wait_exit() == 1
    terminal.wait_text("no session is running at")


def test_a_broken_file_is_refused_with_every_error_and_its_place(lab: Lab) -> None:
    text = scenes.guide().replace("play: nod", "play: nood").replace("drive: 5", "drive: far")
    file = lab.file("guide.yaml", text)
    terminal = lab.terminal(["run", str(file), *lab.session()], columns=200)
    assert terminal.wait_exit() == 1
    for word in ("nood", "far}"):
        line = next(n for n, row in enumerate(text.splitlines(), 1) if word in row)
        terminal.wait_text(f"guide.yaml:{line}:")
    assert lab.processes() == []


def test_a_second_robot_process_on_one_socket_is_refused(lab: Lab) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    lab.host(file, "--session", "S01")
    second = lab.woz("host", str(file), *lab.session("--session", "S01"))
    words = error_text(second)
    assert "is running" in words
    assert "Traceback" not in words
    assert second.returncode == 1
    attached = lab.attach()
    attached.send("h")
    lab.log.wait("action.done")


def test_a_socket_left_by_a_crash_is_replaced(lab: Lab) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    host = lab.host(file, "--session", "S01")
    lab.log.wait("driver.connected")
    host.kill()
    host.wait()
    assert lab.socket().exists()
    lab.host(file, "--session", "S01")
    until(lambda: len(list(lab.recordings.glob("*S01*.jsonl"))) >= 4, "a second log")
    lab.attach()
