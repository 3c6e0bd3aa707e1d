"""Strangers without a certificate at the port of other computers, while a wizard comes and the log
moves.
"""

from __future__ import annotations

import contextlib
import itertools
import resource
import socket
import threading
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, Log, end_session, until
from tests.fakes.ports import free_port
from tests.network.other_computer import listens
from woz_tui.log import log_reader

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

#: Connections of strangers in all, and how many of them they keep open at the same time.
CONNECTIONS, HELD = 2000, 300
#: The beginning of a handshake that goes wrong.
NONSENSE = b"\x16\x03\x01\x00\x05hello"
#: Descriptors that the robot process may have beside those that it has before they come.
SPARE = 16
#: What it may take more of memory with two consoles more, in bytes.
MEMORY = 4 << 20
FREE = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)


class Strangers(threading.Thread):
    """They open, hold and close connections until they are told to go."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self._port = port
        self._going = threading.Event()
        #: Connections so far.
        self.count = 0

    def run(self) -> None:
        """One after the other: silent ones are held, those that say something wrong soon end."""
        held: deque[socket.socket] = deque()
        with contextlib.ExitStack() as all_of_them:
            for number in itertools.count():
                if self._going.is_set():
                    return
                with contextlib.suppress(OSError):  # it is closed at the other end
                    stranger = socket.create_connection(("127.0.0.1", self._port), 20)
                    held.append(all_of_them.enter_context(stranger))
                    self.count += 1
                    if number % 3 == 0:
                        stranger.sendall(NONSENSE)
                if len(held) > HELD:
                    held.popleft().close()

    def go(self) -> None:
        """All of them."""
        self._going.set()
        self.join()


@contextlib.contextmanager
def strangers_at(port: int) -> Iterator[Strangers]:
    strangers = Strangers(port)
    strangers.start()
    try:
        yield strangers
    finally:
        strangers.go()


def done(log: Log, spill: Path, action: str) -> list[log_reader.LogLine]:
    lines = log_reader.read(log.path, log_reader.Damage(), places=[spill])
    ends = [line for line in lines if line.kind == "action.done"]
    return [line for line in ends if line.fields["action"] == action]


def descriptors(process: psutil.Process) -> int:
    return len([*Path(f"/proc/{process.pid}/fd").iterdir()])


def test_a_wizard_comes_and_the_log_moves_among_strangers(lab: Lab) -> None:
    assert lab.woz("access", "new", "arm-pi", "-o", str(lab.folder / "arm.access")).wait() == 0
    port, spill = free_port(), lab.folder / "spill"
    at = f"{{name: arm-pi, listen: '127.0.0.1:{port}'}}"
    there = f"{{type: rangefinder, port: /dev/null, at: {at}}}"
    text = scenes.guide(f"{{name: guide, drivers: {{eye: {there}, ada: {{type: simulated}}}}}}")
    first = lab.run(lab.file("guide.yaml", text), "--spill", str(spill), columns=120)
    log, host = lab.log, lab.host_process()
    until(lambda: listens(port), "a process that listens")
    first.send("h")
    log.wait("action.done", action="Hello")
    before = descriptors(host), host.memory_info().rss
    few = before[0] + SPARE
    host.rlimit(resource.RLIMIT_NOFILE, (few, few))
    with strangers_at(port) as strangers:
        until(lambda: strangers.count > HELD, "strangers")
        second = lab.attach(columns=120)
        second.send("n")
        second.wait_text("only watches")
        host.rlimit(resource.RLIMIT_FSIZE, (log.path.stat().st_size + 200, resource.RLIM_INFINITY))
        first.send("n")
        first.wait_for(lambda text: "RECORDING TROUBLE" in text.split("\n")[0])
        until(lambda: [*spill.glob("*[0-9].jsonl")], "a log in the second folder")
        host.rlimit(resource.RLIMIT_FSIZE, FREE)
        third = lab.attach("--take-over", columns=120)
        until(lambda: strangers.count > CONNECTIONS, "2,000 connections")
        third.send("n")
        # A busy disk may have moved it on once more: all files of the session are looked at.
        until(lambda: len(done(log, spill, "Nod")) == 2, "the second nod's end")
        more = descriptors(host) - before[0], host.memory_info().rss - before[1]
        assert more[0] <= 2, "those of the two consoles"
        assert more[1] < MEMORY
        end_session(third)
        assert third.wait_exit() == 0
    damage = log_reader.Damage()
    lines = [*log_reader.read(log.path, damage, places=[spill])]
    assert [line.seq for line in lines] == list(range(len(lines)))
    assert not damage.unreadable
    assert lines[-1].kind == "session.end"
