"""When a picture has reached the terminal: asked of it, or guessed where it answers nothing."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator

import pytest

from tests.console.scripted_feed import ScriptedFeed
from woz_tui.console.camera.picture_terminal import PictureTerminal
from woz_tui.console.drawing.terminal_output import Output
from woz_tui.console.input.terminal_monitor import (
    DEAD_S,
    EVERY_S,
    PUT_OFF_S,
    TerminalMonitor,
)
from woz_tui.system.clock import ManualClock


class TerminalRig:
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
def rig() -> Iterator[TerminalRig]:
    terminal_rig = TerminalRig()
    yield terminal_rig
    if terminal_rig.output is not None:
        terminal_rig.output.finish("", 0.1)
    os.close(terminal_rig.master)
    os.close(terminal_rig.slave)


def test_only_a_question_asked_behind_it_tells(rig: TerminalRig) -> None:
    rig.line.question_sent()
    rig.clock.advance(0.01)
    written = rig.clock.now_us()
    rig.line.answered()
    assert rig.side.arrived_us(written) is None, "it was asked before"
    rig.question(0.4)
    assert rig.side.arrived_us(written) == written + 400_000


def test_hurry_asks_at_once_or_right_behind_the_question_that_is_out(rig: TerminalRig) -> None:
    rig.question()
    assert rig.line.question_in_s == EVERY_S
    rig.side.hurry()
    assert rig.woken == 1
    assert rig.line.question_in_s == 0
    rig.line.question_sent()
    assert rig.line.question_in_s == EVERY_S
    rig.side.hurry()
    assert rig.line.question_in_s == EVERY_S, "one question at a time"
    rig.line.answered()
    assert rig.line.question_in_s == 0
    rig.line.put_off()
    assert rig.line.question_in_s == PUT_OFF_S, "it takes nothing: no hurry"


def test_a_terminal_that_never_answers_has_what_it_has_taken(rig: TerminalRig) -> None:
    written = rig.clock.now_us()
    rig.line.question_sent()
    assert rig.side.arrived_us(written) is None, "it may still answer"
    rig.clock.advance(DEAD_S)
    assert rig.side.write("x" * 200_000)
    assert rig.side.waiting > 100_000
    assert rig.side.arrived_us(written) is None
    taken = 0
    while taken < 200_000:
        taken += len(os.read(rig.master, 65536))
    until = time.monotonic() + 20.0
    while rig.side.waiting and time.monotonic() < until:  # it is counted a bit later
        time.sleep(0.005)
    assert rig.side.arrived_us(written) == written


def test_the_shortest_way_is_remembered(rig: TerminalRig) -> None:
    assert rig.side.shortest_us == 0
    for seconds in (0.05, 0.02, 0.9):
        rig.question(seconds)
    assert rig.side.shortest_us == 20_000


def test_bytes_are_counted_and_cells_measured(rig: TerminalRig) -> None:
    before = rig.side.written
    assert rig.side.write("é" * 10)
    assert rig.side.written == before + 20
    assert rig.side.cell is None, "this terminal has no pixels"
    rig.output, old = None, rig.output
    assert (rig.side.written, rig.side.waiting, rig.side.cell) == (0, 0, None)
    assert not rig.side.write("x")
    rig.output = old
