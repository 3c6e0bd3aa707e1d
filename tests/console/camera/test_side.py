"""When a picture has reached the terminal: asked of it, or guessed where it answers nothing."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator

import pytest

from tests.console.scripted import ScriptedFeed
from woz_tui.console.camera.picture_terminal import PictureTerminal
from woz_tui.console.terminal_monitor import (
    DEAD_S,
    EVERY_S,
    PUT_OFF_S,
    TerminalMonitor,
)
from woz_tui.console.terminal_output import Output
from woz_tui.system.clock import ManualClock


class Seat:
    """A terminal that takes nothing until it is read, and its line."""

    def __init__(self) -> None:
        self.master, self.slave = os.openpty()
        self.clock = ManualClock()
        self.line = TerminalMonitor(ScriptedFeed(), self.clock)
        self.output: Output | None = Output(self.slave, lambda: None)
        self.woken = 0
        self.side = PictureTerminal(lambda: self.output, self.line, self._wake)

    def _wake(self) -> None:
        self.woken += 1

    def question(self, after: float = 0.0) -> None:
        """It is asked, and answers `after` seconds."""
        self.line.question_sent()
        self.clock.advance(after)
        self.line.answered()


@pytest.fixture
def seat() -> Iterator[Seat]:
    made = Seat()
    yield made
    if made.output is not None:
        made.output.finish("", 0.1)
    os.close(made.master)
    os.close(made.slave)


def test_only_a_question_asked_behind_it_tells(seat: Seat) -> None:
    seat.line.question_sent()
    seat.clock.advance(0.01)
    written = seat.clock.now_us()
    seat.line.answered()
    assert seat.side.arrived_us(written) is None, "it was asked before"
    seat.question(0.4)
    assert seat.side.arrived_us(written) == written + 400_000


def test_hurry_asks_at_once_or_right_behind_the_question_that_is_out(seat: Seat) -> None:
    seat.question()
    assert seat.line.question_in_s == EVERY_S
    seat.side.hurry()
    assert seat.woken == 1
    assert seat.line.question_in_s == 0
    seat.line.question_sent()
    assert seat.line.question_in_s == EVERY_S
    seat.side.hurry()
    assert seat.line.question_in_s == EVERY_S, "one question at a time"
    seat.line.answered()
    assert seat.line.question_in_s == 0
    seat.line.put_off()
    assert seat.line.question_in_s == PUT_OFF_S, "it takes nothing: no hurry"


def test_a_terminal_that_never_answers_has_what_it_has_taken(seat: Seat) -> None:
    written = seat.clock.now_us()
    seat.line.question_sent()
    assert seat.side.arrived_us(written) is None, "it may still answer"
    seat.clock.advance(DEAD_S)
    assert seat.side.write("x" * 200_000)
    assert seat.side.waiting > 100_000
    assert seat.side.arrived_us(written) is None
    taken = 0
    while taken < 200_000:
        taken += len(os.read(seat.master, 65536))
    until = time.monotonic() + 20.0
    while seat.side.waiting and time.monotonic() < until:  # it is counted a bit later
        time.sleep(0.005)
    assert seat.side.arrived_us(written) == written


def test_the_shortest_way_is_remembered(seat: Seat) -> None:
    assert seat.side.shortest_us == 0
    for seconds in (0.05, 0.02, 0.9):
        seat.question(seconds)
    assert seat.side.shortest_us == 20_000


def test_bytes_are_counted_and_cells_measured(seat: Seat) -> None:
    before = seat.side.written
    assert seat.side.write("é" * 10)
    assert seat.side.written == before + 20
    assert seat.side.cell is None, "this terminal has no pixels"
    seat.output, old = None, seat.output
    assert (seat.side.written, seat.side.waiting, seat.side.cell) == (0, 0, None)
    assert not seat.side.write("x")
    seat.output = old
