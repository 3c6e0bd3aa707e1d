"""The stop inside tmux, which holds back an ESC for its `escape-time`."""

from __future__ import annotations

import shutil
import subprocess
import sys
import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fakes.host import FakeHost
from tests.fakes.terminal import FakeTerminal
from woz_tui.protocol.requests import AskAction, AskStop

pytestmark = [pytest.mark.tmux, pytest.mark.real_clock, pytest.mark.safety]

KEYS = ["a", "Z", "5", "!", "é", "#"]


@pytest.fixture
def host(tmp_path: Path) -> Iterator[FakeHost]:
    with FakeHost(tmp_path / "h.sock", keys={key: f"play {key}" for key in KEYS}) as fake:
        yield fake


@pytest.fixture
def terminal(host: FakeHost, tmp_path: Path) -> Iterator[FakeTerminal]:
    tmux = shutil.which("tmux")
    assert tmux is not None, "install tmux to run this test, or deselect it with -m 'not tmux'"
    settings = tmp_path / "tmux.conf"
    settings.write_text("set -s escape-time 0\n")
    server = ["-L", f"woz-{uuid.uuid4().hex[:8]}"]
    inside = f"{sys.executable} -m tests.console.small_app {host.path}"
    with FakeTerminal([tmux, *server, "-f", str(settings), "new-session", inside]) as fake:
        try:
            fake.wait_text("ready")
            yield fake
        finally:
            subprocess.run([tmux, *server, "kill-server"], check=False, capture_output=True)


def test_escape_stops(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"\x1b")

    assert host.wait(AskStop).source == "key"


def test_escape_right_before_a_key_stops_and_the_key_counts(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    for count, key in enumerate(KEYS, 1):
        terminal.send(b"\x1b" + key.encode())
        host.wait(AskStop, count)
        assert host.wait(AskAction, count).key == key


def test_it_is_found_to_be_tmux_and_its_answers_play_nothing(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.wait_text("terminal:tmux")

    assert "screen:" not in terminal.text


def test_the_window_is_closed(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send(b"\x02&")
    terminal.wait_text("kill-window")
    terminal.send(b"y")

    host.until(lambda: bool(host.closed), "the end of the connection")
