"""The camera's screen inside a real tmux: half blocks, or kitty's pictures in an envelope."""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.console.camera.camera_pictures import FilmingHost, noisy, room_picture
from tests.console.camera.drawing_terminal import DrawingTerminal
from tests.console.camera.test_camera_terminal import PLACEHOLDER, START

pytestmark = [pytest.mark.tmux, pytest.mark.real_clock]

SETTINGS = """
set -s escape-time 0
set -g default-terminal tmux-256color
set -g allow-passthrough on
"""


@contextmanager
def inside(folder: Path, pictures: str) -> Iterator[tuple[FilmingHost, DrawingTerminal]]:
    """A console in tmux, with its camera's screen open."""
    tmux = shutil.which("tmux")
    assert tmux is not None, "install tmux to run this test, or deselect it with -m 'not tmux'"
    settings = folder / "tmux.conf"
    settings.write_text(SETTINGS)
    path = folder / "h.sock"
    server = ["-L", f"woz-{uuid.uuid4().hex[:8]}"]
    console = shlex.join([sys.executable, "-c", START, str(path), pictures])
    command = [tmux, *server, "-f", str(settings), "new-session", console]
    host = FilmingHost(path, lambda n: noisy(room_picture(), n), keys={"h": "Hello"})
    with host:
        terminal = DrawingTerminal(command, sixel=True, graphics=b"OK")
        with terminal:
            try:
                terminal.wait_text("Hello")
                terminal.send("_")
                yield host, terminal
            finally:
                subprocess.run([tmux, *server, "kill-server"], check=False, capture_output=True)


def test_by_itself_it_draws_half_blocks(tmp_path: Path) -> None:
    with inside(tmp_path, "auto") as (host, terminal):
        terminal.wait_text("half blocks")
        host.until(lambda: host.given > 3, "pictures")
        terminal.wait_for(lambda text: text.count("▀") > 200)


def test_kittys_pictures_reach_the_terminal_behind_tmux(tmp_path: Path) -> None:
    with inside(tmp_path, "kitty") as (host, terminal):
        terminal.wait_text("kitty")
        terminal.wait_written(b"\x1b_Ga=T,U=1,q=2,f=100,i=21")
        terminal.wait_for(lambda text: terminal.written.count(PLACEHOLDER) > 200)
        host.until(lambda: host.given > 3, "pictures")
