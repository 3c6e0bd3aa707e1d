"""The tablet's server on a system that has no place left, or that it must not fill."""

from __future__ import annotations

import errno
import os
import socket
import threading
import urllib.request
from pathlib import Path

import pytest
from woz_drivers.naoqi_robot.served_files import FileServer, ListedFile

HOST, PATIENCE_S = "127.0.0.1", 20.0


def test_it_is_told_and_keeps_nothing_busy(monkeypatch: pytest.MonkeyPatch) -> None:
    troubles: list[str] = []
    refused: list[socket.socket] = []
    thrice = threading.Event()

    def accept(door: socket.socket) -> None:
        refused.append(door)
        if len(refused) == 3:
            thrice.set()
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr("asyncio.constants.ACCEPT_RETRY_DELAY", 0.01)
    server = FileServer(HOST, 0, troubles.append)
    url = server.list_page("page")
    with monkeypatch.context() as meanwhile:
        meanwhile.setattr(socket.socket, "accept", accept)
        with socket.create_connection((HOST, server.port), timeout=PATIENCE_S):
            assert thrice.wait(PATIENCE_S)
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url) as answer:
        assert answer.read() == b"page"
    server.close()
    assert troubles == ["the robot cannot load files at the moment: Too many open files"]


def test_what_is_no_file_any_more_holds_nothing_open(tmp_path: Path) -> None:
    film = tmp_path / "film.mp4"
    film.write_bytes(b"film")
    listed = ListedFile(".mp4", path=film)
    film.unlink()
    film.mkdir()
    before = len([*Path("/proc/self/fd").iterdir()])
    for _ in range(20):
        with pytest.raises(OSError):
            listed.open()
    film.rmdir()
    os.mkfifo(film)
    for _ in range(20):
        with pytest.raises(OSError):
            listed.open()
    assert len([*Path("/proc/self/fd").iterdir()]) < before + 20
