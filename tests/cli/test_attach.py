"""Which session `woz attach` joins, and what it proposes where that is not clear."""

from __future__ import annotations

import argparse
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from woz_tui.cli import attach
from woz_tui.host import place


@pytest.fixture
def sessions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Path]]:
    """Two robot processes' sockets."""
    monkeypatch.delenv("WOZ_SOCKET", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    paths = [place.socket_path("S01"), place.socket_path("S02")]
    listeners: list[socket.socket] = [place.bind(path) for path in paths]
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
    assert attach.chosen(arguments(*words)) is None
    told = capsys.readouterr().err
    assert sorted(told.splitlines()[1:]) == [f"  woz attach S0{n}{options}" for n in (1, 2)]


def test_a_session_behind_the_option_is_the_session(sessions: list[Path]) -> None:
    given = arguments("--questionnaire", "S02")
    assert attach.chosen(given) == sessions[1]
    assert given.questionnaire == ""


def test_a_questionnaire_of_a_session(sessions: list[Path]) -> None:
    given = arguments("S01", "--questionnaire", "S02")
    assert attach.chosen(given) == sessions[0]
    assert given.questionnaire == "S02"
