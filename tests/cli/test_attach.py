"""Which session `woz attach` joins, and what it proposes where that is not clear."""

from __future__ import annotations

import argparse
import asyncio
import shlex
import socket
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fakes.terminal import FakeTerminal
from tests.host.rig import served_session
from woz_tui.cli import attach, console_start, main, session_choice
from woz_tui.cli.console_start import ClosedConsole
from woz_tui.system import session_sockets


@pytest.fixture
def sessions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Path]]:
    """Sockets of two robot processes that stand still."""
    monkeypatch.setattr(session_choice, "_ABOUT_S", 0.01)
    monkeypatch.delenv("WOZ_SOCKET", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    paths = [session_sockets.socket_path("S01"), session_sockets.socket_path("S02")]
    listeners: list[socket.socket] = [session_sockets.bind(path) for path in paths]
    yield paths
    for listener in listeners:
        listener.close()


def arguments(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    attach.add(parser)
    return parser.parse_args(words)


@pytest.mark.parametrize(
    ("words", "options"),
    [
        ([], ""),
        (["--watch"], " --watch"),
        (["--questionnaire"], " --questionnaire"),
        (["--questionnaire", "robot-ux"], " --questionnaire robot-ux"),
    ],
)
@pytest.mark.usefixtures("sessions")
def test_what_is_proposed_keeps_the_options(
    words: list[str], options: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert attach.find_socket(arguments(*words)) is None
    told = capsys.readouterr().err
    proposed = [line.partition("   # running ") for line in sorted(told.splitlines()[1:])]
    assert [line for line, _, _ in proposed] == [f"  woz attach S0{n}{options}" for n in (1, 2)]
    assert all(age.endswith(" min") for _, _, age in proposed), "how long it has been running"


@pytest.mark.parametrize(
    "words",
    [
        "",
        "S01 --watch",
        "--access 'my files/bea.access' robot.local:7460 --as head",
    ],
)
def test_who_leaves_reads_how_to_come_back(
    words: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(console_start, "open_console", lambda options: ClosedConsole("detached", 0))
    given = arguments(*shlex.split(words), "--take-over")
    assert attach._open(given, Path("socket")) == 0
    assert f"`{f'woz attach {words}'.strip()}`" in capsys.readouterr().out


def test_who_ends_a_session_reads_what_to_do_with_its_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    log = tmp_path / "t_P07_S01.jsonl"
    log.touch()
    ended = ClosedConsole("ended", 0, str(log))
    monkeypatch.setattr(console_start, "open_console", lambda options: ended)
    assert attach._open(arguments(), Path("socket")) == 0
    assert f"woz report {log}" in capsys.readouterr().out
    attach._open(arguments("--access", "bea.access", "robot.local:7460"), Path("socket"))
    assert str(log) not in capsys.readouterr().out, "it is on the robot's computer"


async def test_the_list_says_what_runs_there_and_for_whom(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("WOZ_SOCKET", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    places = [session_sockets.socket_path(name) for name in ("S01", "S02")]
    async with (
        served_session(tmp_path, path=places[0]) as first,
        served_session(tmp_path, path=places[1]) as second,
    ):
        first.session.set(participant="P08")
        second.session.identity = replace(second.session.identity, participant="")
        assert await asyncio.to_thread(attach.find_socket, arguments()) is None
    told = sorted(capsys.readouterr().err.splitlines()[1:])
    assert told == [
        "  woz attach S01   # Made by hand, P08, running 0 min",
        "  woz attach S02   # Made by hand, no participant yet, running 0 min",
    ]


def test_a_session_behind_the_option_is_the_session(sessions: list[Path]) -> None:
    given = arguments("--questionnaire", "S02")
    assert attach.find_socket(given) == sessions[1]
    assert given.questionnaire == ""


def test_a_questionnaire_of_a_session(sessions: list[Path]) -> None:
    given = arguments("S01", "--questionnaire", "S02")
    assert attach.find_socket(given) == sessions[0]
    assert given.questionnaire == "S02"


@pytest.mark.parametrize(
    ("words", "alien"),
    [
        (["--watch", "--take-over"], "--watch, --take-over"),
        (["--as", "voice", "--pictures", "off"], "--as, --pictures"),
        (["--keymap", "mine.yaml"], "--keymap"),
    ],
)
def test_a_participants_terminal_has_no_options_of_a_wizard(
    words: list[str], alien: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert attach.run(arguments("--questionnaire", "S02", *words)) == 2
    assert f"leave {alien} out" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "needed"),
    [
        (["host", "x.yaml", "--rerun-wait", "3"], "--rerun"),
        (["hands", "--to", "robot", "--access", "a.access"], "leave one out"),
        (["bml", "--stomp", "localhost", "--feedback"], "files"),
    ],
)
def test_an_option_without_effect_is_refused(
    words: list[str], needed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    assert needed in capsys.readouterr().err


@pytest.mark.parametrize("words", [[], ["--watch"], ["--questionnaire"]])
def test_a_robot_process_that_ends_before_the_console_opens_is_told_in_a_sentence(
    tmp_path: Path, words: list[str]
) -> None:
    path = tmp_path / "s"
    listener = session_sockets.bind(path)
    listener.setblocking(True)

    def answer_once() -> None:  # whoever looks whether it is there; then it is killed
        listener.accept()[0].close()
        listener.close()

    threading.Thread(target=answer_once, daemon=True).start()
    command = [sys.executable, "-m", "woz_tui", "attach", str(path), *words]
    with FakeTerminal(command, columns=120) as terminal:
        assert terminal.wait_exit() == 1
        told = terminal.wait_for(lambda text: str(path) in text.replace("\n", ""))
    assert "woz run" in told.replace("\n", " ")
    assert "Traceback" not in told
    assert "Errno" not in told
