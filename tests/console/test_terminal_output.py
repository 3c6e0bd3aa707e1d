from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator

import pytest

from woz_tui.console.drawing.terminal_output import Output

FRAME = "\x1b[1;1H" + "x" * 4000


class Pty:
    """A pseudo-terminal whose other end is read only when a test says so."""

    def __init__(self) -> None:
        self.master, self.slave = os.openpty()
        os.set_blocking(self.master, False)
        self.recovered = threading.Event()
        self.output = Output(self.slave, self.recovered.set, limit=64 * 1024)

    def fill(self) -> None:
        """Write until output is dropped, and the terminal itself is full."""
        self.output.write(FRAME * 50)  # taken whole while nothing waits
        while self.output._waiting:
            time.sleep(0.001)
        for _ in range(1000):
            if not self.output.write(FRAME):
                return
        raise AssertionError("a terminal that nobody reads took four megabytes")

    def read_until(self, end: bytes) -> bytes:
        data = b""
        os.set_blocking(self.master, True)
        while end not in data:
            data += os.read(self.master, 65536)
        return data

    def drain(self) -> bytes:
        """Read until the terminal has recovered."""
        data = b""
        while not self.recovered.wait(0.01):
            try:
                data += os.read(self.master, 65536)
            except BlockingIOError:
                continue
        return data


@pytest.fixture
def pty() -> Iterator[Pty]:
    made = Pty()
    yield made
    made.output.finish("", 0.1)
    os.close(made.master)
    os.close(made.slave)


def test_texts_arrive_whole_and_in_order(pty: Pty) -> None:
    for number in range(100):
        assert pty.output.write(f"<{number}>")
    assert pty.output.write("end")

    data = pty.read_until(b"end")
    assert data == b"".join(f"<{number}>".encode() for number in range(100)) + b"end"


def test_a_terminal_that_takes_nothing_blocks_nobody_and_is_redrawn_later(pty: Pty) -> None:
    pty.fill()
    before = pty.output.stalled
    assert not pty.output.write("dropped")

    pty.drain()

    assert (before, pty.output.stalled) == (True, False)
    assert pty.output.write("again")
    assert b"dropped" not in pty.read_until(b"again")


def test_what_arrives_after_a_stall_are_whole_texts(pty: Pty) -> None:
    pty.fill()
    data = pty.drain()
    pty.output.write("end")
    data += pty.read_until(b"end")

    frames = data.removesuffix(b"end")
    assert frames == FRAME.encode() * (len(frames) // len(FRAME))


def test_finishing_writes_what_waits_and_then_the_last(pty: Pty) -> None:
    pty.output.write("first ")
    pty.output.finish("last", 1.0)
    pty.output.finish("never", 1.0)

    assert pty.read_until(b"last") == b"first last"
    assert not pty.output.write("too late")


def test_finishing_gives_up_on_a_terminal_that_takes_nothing(pty: Pty) -> None:
    pty.fill()
    pty.output.finish("last", 0.1)

    assert not pty.output.write("too late")


def test_the_shared_terminal_stays_blocking(pty: Pty) -> None:
    assert os.get_blocking(pty.slave)


def test_a_terminal_that_is_gone_takes_everything() -> None:
    master, slave = os.openpty()
    output = Output(slave, lambda: None, limit=64 * 1024)
    os.close(master)

    for _ in range(100):
        output.write(FRAME)
    output.finish("last", 1.0)
    os.close(slave)
