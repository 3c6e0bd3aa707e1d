"""Every way the console can end or pause, on a real terminal."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from tests.fakes.host import FakeHost
from tests.fakes.terminal import LAUNCH, ROOT, WAIT_S, FakeTerminal
from woz_tui.protocol.messages import Marker
from woz_tui.protocol.requests import AskAction, AskNote, AskStop, Beat

pytestmark = pytest.mark.real_clock

LFLAG = 3


@pytest.fixture
def host(tmp_path: Path) -> Iterator[FakeHost]:
    with FakeHost(tmp_path / "h.sock", keys={"a": "A", "b": "B"}) as fake:
        yield fake


def command(host: FakeHost) -> list[str]:
    return [sys.executable, "-m", "tests.console.small_app", str(host.path)]


@pytest.fixture
def terminal(host: FakeHost) -> Iterator[FakeTerminal]:
    with FakeTerminal(command(host)) as fake:
        fake.wait_text("ready")
        yield fake


def assert_restored(terminal: FakeTerminal) -> None:
    """Cooked mode again, the normal screen, no kitty keyboard, cursor, no paste marks."""
    assert terminal.attributes() == terminal.attributes_before
    for sequence in (b"\x1b[?1049l", b"\x1b[<u", b"\x1b[?25h", b"\x1b[?2004l", b"\x1b[?1004l"):
        terminal.wait_written(sequence)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
def test_signals_that_end_it(host: FakeHost, terminal: FakeTerminal, number: int) -> None:
    assert not terminal.attributes()[LFLAG] & termios.ICANON

    terminal.process.send_signal(number)

    assert terminal.wait_exit() == 128 + number
    host.until(lambda: bool(host.closed), "the end of the connection")
    assert_restored(terminal)


def test_a_signal_ends_it_with_the_loop_blocked_for_ever(
    host: FakeHost, terminal: FakeTerminal, tmp_path: Path
) -> None:
    host.say(Marker(text=f"block {tmp_path / 'never'}"))
    host.wait(AskNote)
    terminal.process.send_signal(signal.SIGTERM)

    assert terminal.wait_exit() == 128 + signal.SIGTERM
    host.until(lambda: bool(host.closed), "the end of the connection")
    assert_restored(terminal)


@pytest.mark.parametrize("nohup", [False, True])
def test_the_terminal_is_closed(host: FakeHost, nohup: bool) -> None:
    with FakeTerminal(command(host), nohup=nohup) as terminal:
        terminal.wait_text("ready")
        terminal.close()

        assert terminal.wait_exit() == 128 + signal.SIGHUP
        host.until(lambda: bool(host.closed), "the end of the connection")


def test_the_terminal_is_closed_with_the_loop_blocked(host: FakeHost, tmp_path: Path) -> None:
    with FakeTerminal(command(host)) as terminal:
        terminal.wait_text("ready")
        host.say(Marker(text=f"block {tmp_path / 'never'}"))
        host.wait(AskNote)
        terminal.close()

        assert terminal.wait_exit() == 128 + signal.SIGHUP


@pytest.mark.safety
def test_an_interrupt_is_the_stop_and_not_the_end(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.process.send_signal(signal.SIGINT)
    host.wait(AskStop)
    terminal.send("a")

    assert host.wait(AskAction).action == "A"


def test_a_crash_of_the_screen_leaves_the_terminal_in_order(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    host.say(Marker(text="crash"))

    assert terminal.wait_exit() == 1
    assert_restored(terminal)
    terminal.wait_written(b"crashed as told")


def test_a_crash_at_the_start_leaves_the_terminal_in_order(tmp_path: Path) -> None:
    nowhere = [sys.executable, "-m", "tests.console.small_app", str(tmp_path / "nobody.sock")]
    with FakeTerminal(nowhere) as terminal:
        assert terminal.wait_exit() == 1
        assert_restored(terminal)
        terminal.wait_written(b"FileNotFoundError")


def test_ctrl_z_suspends_and_fg_redraws(host: FakeHost) -> None:
    bash = shutil.which("bash")
    assert bash is not None
    with FakeTerminal([bash, "--norc", "--noprofile", "-i"], env={"PS1": "shell> "}) as terminal:
        terminal.wait_text("shell>")
        terminal.send(" ".join(command(host)) + "\r")
        terminal.wait_text("ready")
        terminal.send(b"\x1a")
        host.until(lambda: any(not beat.line_ok for beat in host.all(Beat)), "driving ended")
        terminal.wait_text("Stopped")
        (console,) = psutil.Process(terminal.process.pid).children()
        assert console.status() == psutil.STATUS_STOPPED
        terminal.send("fg\r")
        terminal.wait_for(lambda text: text.startswith("ready") or "\nready" in text)
        host.until(lambda: host.line_ok() is True, "driving allowed again")
        terminal.send("a")
        assert host.wait(AskAction).action == "A"
        os.kill(console.pid, signal.SIGTERM)
        console.wait(WAIT_S)
        terminal.wait_text("shell>")


def test_ctrl_z_where_nobody_could_continue_it_does_not_freeze_it(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.send(b"\x1a")
    host.until(lambda: any(not beat.line_ok for beat in host.all(Beat)), "driving ended")
    host.until(lambda: host.line_ok() is True, "driving allowed again")
    terminal.send("a")

    assert host.wait(AskAction).action == "A"


@pytest.mark.safety
def test_an_escape_right_behind_ctrl_z_stops(host: FakeHost, terminal: FakeTerminal) -> None:
    for count, reads in enumerate(([b"\x1a\x1b"], [b"\x1a", b"\x1b"], [b"\x1a", b"a\x03"]), 1):
        for data in reads:
            terminal.send(data)
        host.wait(AskStop, count)
        host.until(lambda: host.line_ok() is True, "driving allowed again")


def test_continued_after_sigstop_it_draws_anew(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.process.send_signal(signal.SIGSTOP)
    terminal.process.send_signal(signal.SIGCONT)

    terminal.wait_for(lambda text: terminal.written.count(b"\x1b[?1049h") == 2)
    again = terminal.written.rindex(b"\x1b[?1049h")
    terminal.wait_for(lambda text: b"ready" in terminal.written[again:])
    terminal.send("a")
    assert host.wait(AskAction).action == "A"


@pytest.mark.safety
def test_a_frozen_terminal_blocks_neither_keys_nor_stop_nor_screen(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.freeze()
    host.say(Marker(text="flood"))
    assert host.wait(AskNote).text == "flooded"
    terminal.send("a")
    host.wait(AskAction)
    terminal.send(b"\x1b")
    host.wait(AskStop)
    terminal.thaw()

    terminal.wait_for(lambda text: "pressed:escape" in text and "flood " not in text)


@pytest.mark.safety
def test_a_frozen_terminal_stops_driving_and_it_goes_on_when_thawed(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.wait_written(b"\x1b[5n")
    terminal.freeze()
    host.until(lambda: host.line_ok() is False, "a beat with a dead line")
    terminal.thaw()

    host.until(lambda: host.line_ok() is True, "a beat with a good line")


@pytest.mark.safety
def test_keys_from_before_a_thaw_are_stale_and_those_after_it_are_not(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.wait_written(b"\x1b[5n")
    terminal.freeze()
    host.until(lambda: host.line_ok() is False, "a beat with a dead line")
    terminal.send("a")
    assert host.wait(AskAction).stale
    terminal.thaw()
    host.until(lambda: host.line_ok() is True, "a beat with a good line")
    terminal.send("b")

    assert not host.wait(AskAction, 2).stale


@pytest.mark.safety
def test_keys_behind_an_answer_that_was_under_way_for_long_are_stale(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.wait_written(b"\x1b[5n")
    terminal.stall()
    terminal.wait_for(lambda text: b"\x1b[0n" in terminal.under_way)
    terminal.send("a")
    host.until(lambda: host.line_ok() is False, "a beat with a dead line")
    terminal.flow()
    assert host.wait(AskAction).stale
    host.until(lambda: host.line_ok() is True, "a beat with a good line")
    terminal.send("b")

    assert not host.wait(AskAction, 2).stale


@pytest.mark.safety
def test_a_stop_behind_such_an_answer_counts(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.wait_written(b"\x1b[5n")
    terminal.stall()
    host.until(lambda: host.line_ok() is False, "a beat with a dead line")
    terminal.send(b"a\x1b")
    terminal.flow()

    host.wait(AskStop)


@pytest.mark.safety
def test_driving_ends_where_keys_come_and_no_answer_does(
    host: FakeHost, terminal: FakeTerminal
) -> None:
    terminal.wait_written(b"\x1b[5n")
    terminal.freeze()

    def pressed() -> bool:
        terminal.send("a")
        return host.line_ok() is False

    host.until(pressed, "a beat with a dead line")


def test_a_frozen_terminal_that_is_closed(host: FakeHost) -> None:
    with FakeTerminal(command(host)) as terminal:
        terminal.wait_text("ready")
        terminal.freeze()
        host.say(Marker(text="flood"))
        host.wait(AskNote)
        terminal.process.send_signal(signal.SIGHUP)

        assert terminal.wait_exit() == 128 + signal.SIGHUP


def test_no_terminal_on_standard_input(host: FakeHost) -> None:
    with FakeTerminal(["sh", "-c", " ".join(command(host)) + " </dev/null"]) as terminal:
        assert terminal.wait_exit() == 2
        terminal.wait_text("standard input is none")


def test_no_terminal_on_standard_output(host: FakeHost) -> None:
    with FakeTerminal(["sh", "-c", " ".join(command(host)) + " | cat; echo over"]) as terminal:
        terminal.wait_text("standard output is none")
        terminal.wait_text("over")


def test_a_dumb_terminal(host: FakeHost) -> None:
    with FakeTerminal(command(host), env={"TERM": "dumb"}) as terminal:
        assert terminal.wait_exit() == 2
        terminal.wait_text("TERM=dumb")


def test_without_any_terminal_it_says_one_sentence(host: FakeHost) -> None:
    done = subprocess.run(
        command(host), stdin=subprocess.DEVNULL, capture_output=True, cwd=ROOT, check=False
    )

    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1


def test_reset_puts_back_what_a_killed_console_left(terminal: FakeTerminal) -> None:
    line = os.open(terminal.device, os.O_RDWR | os.O_NOCTTY)
    terminal.process.kill()
    terminal.process.wait(WAIT_S)
    assert not terminal.attributes()[LFLAG] & termios.ICANON
    reset = [sys.executable, "-m", "woz_tui", "reset"]
    done = subprocess.run(
        [sys.executable, "-c", LAUNCH, *reset],
        stdin=line, stdout=line, stderr=line, cwd=ROOT, start_new_session=True, timeout=WAIT_S,
        check=False,
    )  # fmt: skip
    os.close(line)
    assert done.returncode == 0
    wanted = termios.ICANON | termios.ECHO | termios.ISIG
    assert terminal.attributes()[LFLAG] & wanted == wanted
    for sequence in (b"\x1b[?1049l", b"\x1b[<32u", b"\x1b[?25h", b"\x1b[?2004l", b"\x1b[?1004l"):
        terminal.wait_written(sequence)


def test_reset_without_a_terminal_says_so() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "woz_tui", "reset"], cwd=ROOT, start_new_session=True,
        capture_output=True, text=True, timeout=WAIT_S, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (1, "")
    assert "there is no terminal" in done.stderr
