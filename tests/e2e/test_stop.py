"""The stop arrives from every screen, whatever follows it, and tells what it ended."""

from __future__ import annotations

import pytest

from tests.e2e import interleavings, stops
from tests.e2e.lab import Lab
from tests.e2e.stops import DIALOGS, KEYS, Stopping
from tests.fakes.terminal import FakeTerminal

#: Hundreds of keys one after the other: on a busy machine that takes its time.
pytestmark = [pytest.mark.timeout(300), pytest.mark.real_clock, pytest.mark.safety]

#: The dialogs are shared out among so many sessions.
SESSIONS = 4


@pytest.fixture
def terminal(lab: Lab) -> FakeTerminal:
    return stops.plain(lab)


@pytest.fixture
def stopping(lab: Lab, terminal: FakeTerminal) -> Stopping:
    return stops.begin(lab, terminal)


def test_with_every_key_behind_it(stopping: Stopping) -> None:
    for key in KEYS:
        stopping.press("\x1b" + key)
    stopping.back()
    stopping.release()
    stopping.press("\x1b\x1a")


@pytest.mark.parametrize("first", range(SESSIONS))
def test_with_keys_behind_it_in_a_dialog(stopping: Stopping, first: int) -> None:
    for dialog in [*DIALOGS][first::SESSIONS]:
        for key in stops.share(dialog):
            stopping.back()
            stopping.open(dialog)
            stopping.press("\x1b" + key)
    stopping.back()
    stopping.release()


def test_in_the_moment_in_which_a_dialog_opens(
    lab: Lab, terminal: FakeTerminal, stopping: Stopping
) -> None:
    for _ in range(12):
        for key in ("/", ":", ",", "\x14", "\x06"):
            stopping.press("\x1b" + key)  # the next one comes while this dialog is put together
    stopping.back()
    stopping.release()
    assert terminal.process.poll() is None
    assert not lab.log.lines("console.lost")


def test_other_stop_keys(stopping: Stopping) -> None:
    for key in ("\x03", "\x1b[27u", "\x1b[99;5u"):
        stopping.press(key)
        stopping.press(key + "h")
        stopping.open("?")
        stopping.press(key)
        stopping.back()
    stopping.release()


def test_half_a_sentence_is_kept(terminal: FakeTerminal, stopping: Stopping) -> None:
    stopping.open("/")
    terminal.send("half a sen")
    terminal.wait_text("half a sen")
    stopping.back()
    terminal.wait_for(lambda text: "half a sen" not in text)
    stopping.release()
    stopping.open("/")
    terminal.wait_text("half a sen")


def test_it_ends_what_runs_and_nothing_begins_until_it_is_released(
    lab: Lab, terminal: FakeTerminal
) -> None:
    log = lab.log
    terminal.send("l")
    log.wait("command.progress")
    terminal.send("\x1bh")
    log.wait("action.stopped", action="Long story")
    log_line = log.wait("action.refused", action="Hello")
    assert log_line.fields["reason"] == "the stop is pressed"
    terminal.wait_for(lambda text: "STOPPED by key" in text and "confirmed: robot" in text)
    terminal.send("\x12")
    log.wait("stop.released")
    terminal.wait_for(lambda text: "STOPPED by key" not in text)
    terminal.send("h")
    log.wait("action.done", action="Hello")


@pytest.mark.tmux
@pytest.mark.parametrize("escape_ms", [0, 500])
def test_inside_tmux(lab: Lab, escape_ms: int) -> None:
    stopping = stops.begin(lab, stops.in_tmux(lab, escape_ms))
    stopping.press("\x1b")
    for key in stops.allowed("", (*KEYS[::4], "\x1b[H", "\x1b[F"), tmux=True):
        stopping.press("\x1b" + key)
    stopping.back()
    for dialog in DIALOGS:
        stopping.open(dialog)
        stopping.back()
    stopping.press("\x03")
    stopping.release()


def test_nothing_goes_out_under_a_stop_whoever_presses_it(lab: Lab) -> None:
    found = interleavings.run(lab, rounds=2 * len(interleavings.KINDS), seed=3)
    assert found.complaints == []
    assert found.dispatched > found.stops
    assert found.missing > 0, "a robot that confirms too late is named"
