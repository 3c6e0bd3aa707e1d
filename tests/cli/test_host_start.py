"""Starting the robot process from the command line, and what is told when it does not start."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from queue import Queue

import pytest

from tests.e2e.program import Program
from tests.fakes.terminal import ROOT
from tests.host.rude_driver import installed
from woz_tui.cli import main
from woz_tui.cli.console_start import _restart
from woz_tui.config.screen_language import use
from woz_tui.console.link.host_start import Launch, LaunchError, host_arguments
from woz_tui.log.withdrawals import Withdrawal, add_withdrawal
from woz_tui.system import session_sockets
from woz_tui.system.session_sockets import next_session

pytestmark = pytest.mark.real_clock

WAIT_S = 300.0


@pytest.fixture(autouse=True)
def _own_world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{ROOT}")
    monkeypatch.setenv("WOZ_SOCKET", str(tmp_path / "s"))


@pytest.fixture
def started() -> Iterator[list[Launch]]:
    """Robot processes that are gone when the test ends."""
    launches: list[Launch] = []
    yield launches
    for launch in launches:
        launch.abandon()


def launch(folder: Path, rudeness: str = "", **codes: str) -> Launch:
    return Launch(
        host_arguments(
            installed(folder, rudeness),
            recordings=folder / "rec",
            spill=None,
            name="",
            codes={"session": "S03", **codes},
        )
    )


@pytest.mark.parametrize("rudeness", ["", "greets"])
def test_it_says_where_it_listens_whatever_a_library_prints(
    tmp_path: Path, started: list[Launch], rudeness: str
) -> None:
    started.append(launch(tmp_path, rudeness))
    robot = started[0].wait()
    assert session_sockets.answers(robot.socket)
    assert robot.log.parent == tmp_path / "rec"
    assert robot.host_log.exists()
    os.kill(robot.pid, 0)


def test_it_does_not_belong_to_the_terminal(tmp_path: Path, started: list[Launch]) -> None:
    started.append(launch(tmp_path))
    robot = started[0].wait()
    assert os.getsid(robot.pid) != os.getsid(0)
    with Program(robot.socket) as program:
        os.kill(robot.pid, signal.SIGHUP)
        assert program.ask("preflight")["ok"]


@pytest.mark.parametrize(
    ("rudeness", "codes", "told"),
    [
        ("raises", {}, "woz: the driver 'voice' cannot be created: LookupError: no such thing"),
        ("exits", {}, "woz: the driver 'voice' cannot be created: SystemExit: 7"),
        ("", {"participant": "Jane Doe"}, "woz: 'Jane Doe' is not a valid participant code"),
        ("", {"participant": "P01\n"}, "is not a valid participant code"),
        ("", {"session": "../x"}, "woz: '../x' is not a valid session code"),
    ],
)
def test_why_it_did_not_start_is_told_in_its_own_words(
    tmp_path: Path, rudeness: str, codes: dict[str, str], told: str
) -> None:
    with pytest.raises(LaunchError) as error:
        launch(tmp_path, rudeness, **codes).wait()
    assert told in str(error.value)
    assert "Traceback" not in str(error.value)
    assert not list((tmp_path / "rec").glob("*.jsonl")) or rudeness


def test_no_session_begins_with_the_code_of_somebody_who_withdrew(tmp_path: Path) -> None:
    (tmp_path / "rec").mkdir()
    add_withdrawal(tmp_path / "rec", Withdrawal("P07", "2026-03-01", "W1", "0.1.0"))
    with pytest.raises(LaunchError, match="the participant P07 withdrew"):
        launch(tmp_path, participant="P07").wait()
    assert not list((tmp_path / "rec").glob("*.jsonl"))


def test_a_robot_process_is_started_again_once_at_a_time_and_why_not_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Launch.wait, "__defaults__", (WAIT_S,))  # a busy machine is no subject here
    told: Queue[str] = Queue()
    restart = _restart(["nowhere.yaml"], lambda: "", lambda explain, why: explain(why), told.put)
    for _ in range(2):
        restart()
        restart()
        assert "nowhere.yaml" in told.get(timeout=WAIT_S)
        deadline = time.monotonic() + WAIT_S
        while any(thread.name == "restart" for thread in threading.enumerate()):
            assert time.monotonic() < deadline
            time.sleep(0.01)
    assert told.empty()


def test_one_that_takes_too_long_is_ended_and_said_so(tmp_path: Path) -> None:
    starting = launch(tmp_path)
    with pytest.raises(LaunchError, match="did not start within 0 s"):
        starting.wait(seconds=0)


def test_a_second_one_at_the_same_socket_is_refused(tmp_path: Path, started: list[Launch]) -> None:
    started.append(launch(tmp_path))
    robot = started[0].wait()
    second = Launch([str(tmp_path / "rude.yaml"), "--recordings", str(tmp_path / "rec")])
    with pytest.raises(LaunchError, match=r"session .* is running"):
        second.wait()
    assert session_sockets.answers(robot.socket)


# -- what is told without starting anything --------------------------------------------------


def test_a_file_that_is_not_there_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["host", str(tmp_path / "none.yaml")]) == 1
    assert "none.yaml:1:1" in capsys.readouterr().err


def test_what_is_wrong_with_the_file_is_told_in_the_screens_language(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        assert main(["host", "--language", "de", str(tmp_path / "none.yaml")]) == 1
    finally:
        use("en")
    assert "none.yaml:1:1: file: diese Datei gibt es nicht" in capsys.readouterr().err


def test_a_socket_folder_of_somebody_else_is_told_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("WOZ_SOCKET")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "woz").symlink_to(tmp_path / "elsewhere")
    assert main(["host", str(ROOT / "experiments" / "demo.yaml")]) == 1
    assert "woz: " in capsys.readouterr().err


@pytest.mark.parametrize("command", [["run", "x.yaml"], ["attach"], ["demo"]])
def test_a_console_needs_a_terminal(
    command: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with Path(os.devnull).open() as nothing:
        monkeypatch.setattr("sys.stdin", nothing)
        assert main(command) == 2
    assert capsys.readouterr().err.startswith("woz: ")


def test_session_codes_count_on_from_logs_and_from_sessions_that_run(tmp_path: Path) -> None:
    assert next_session(tmp_path / "none") == "S01"
    for name in ("2026-03-01T10-00-00_P01_S04.jsonl", "2026-03-01T10-00-00_P01_S09-2.jsonl", "x"):
        (tmp_path / name).touch()
    assert next_session(tmp_path) == "S10"
    assert next_session(tmp_path, [Path("/run/woz/S12.sock"), Path("/run/woz/mine.sock")]) == "S13"


def test_empty_codes_are_left_out_of_the_command_line(tmp_path: Path) -> None:
    words = host_arguments(
        tmp_path / "x.yaml",
        recordings=tmp_path,
        spill=tmp_path / "spill",
        name="lab",
        codes={"session": "S01", "participant": ""},
    )
    assert words[3:] == ["--spill", str(tmp_path / "spill"), "--name", "lab", "--session", "S01"]


@pytest.fixture
def modules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder: modules with the names of others, which say that they were run."""
    folder = tmp_path / "study"
    folder.mkdir()
    for name in ("msgspec", "random", "json", "yaml", "rich"):
        text = f"open({str(folder / 'run')!r}, 'a').write({name!r})\nraise ValueError({name!r})\n"
        (folder / f"{name}.py").write_text(text)
    monkeypatch.chdir(folder)
    return folder


def test_the_robot_process_runs_no_module_of_the_current_folder(
    tmp_path: Path, modules: Path, started: list[Launch]
) -> None:
    started.append(launch(tmp_path))
    assert session_sockets.answers(started[0].wait().socket)
    assert not (modules / "run").exists()


@pytest.mark.parametrize(
    "command",
    [[str(Path(sys.executable).with_name("woz"))], [sys.executable, "-m", "woz_tui"]],
    ids=["woz", "python -m woz_tui"],
)
def test_a_command_runs_no_module_of_the_current_folder(
    tmp_path: Path, modules: Path, monkeypatch: pytest.MonkeyPatch, command: list[str]
) -> None:
    monkeypatch.delenv("PYTHONPATH")
    done = subprocess.run(
        [*command, "check", str(ROOT / "experiments" / "demo.yaml")],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not (modules / "run").exists()
