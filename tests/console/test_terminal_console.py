"""The whole console on a real terminal, against a host that speaks the wire."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fakes.host import FakeHost
from tests.fakes.terminal import FakeTerminal
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol.requests import AskAction, AskStop, AskVerb

pytestmark = pytest.mark.real_clock

START = """
import sys
from pathlib import Path
from woz_tui.cli.console_start import ScreenOptions, open_console
sys.exit(open_console(ScreenOptions(Path(sys.argv[1]))).code)
"""


@pytest.fixture
def host(tmp_path: Path) -> Iterator[FakeHost]:
    keys = {"h": "Hello", "f1": "Happy", "c r": "Circle", "n": "Nod"}
    with FakeHost(tmp_path / "h.sock", keys=keys, verbs={"head": ["nudge", "say"]}) as fake:
        yield fake


@pytest.fixture
def terminal(host: FakeHost) -> Iterator[FakeTerminal]:
    command = [sys.executable, "-c", START, str(host.path)]
    with FakeTerminal(command, columns=100, rows=30) as fake:
        fake.wait_text("Hello")
        yield fake


def test_keys_sequences_arrows_and_the_script(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.send("h")
    assert host.wait(AskAction).action == "Hello"
    terminal.send(b"\x1bOP")
    assert host.wait(AskAction, 2).action == "Happy"
    terminal.send("cr")
    assert host.wait(AskAction, 3).action == "Circle"
    terminal.send(b"\x1b[A")
    assert host.wait(AskVerb).verb == "nudge"
    terminal.send("> >")
    moved = [
        (ask_script.play, ask_script.by)
        for ask_script in (host.wait(AskScript, n) for n in (1, 2, 3))
    ]
    assert moved == [(False, 1), (True, 0), (False, 1)], "in the order of the keys"


@pytest.mark.parametrize("opens", ["/", ":", ",", "?", "\x11", "\x14", "\x17"])
@pytest.mark.safety
def test_escape_stops_from_every_dialog_and_the_keys_are_free_again(
    host: FakeHost, terminal: FakeTerminal, opens: str
) -> None:
    terminal.send(opens)
    terminal.send("n\x1b")
    host.wait(AskStop)
    assert host.all(AskAction) == []
    terminal.send("h")

    assert host.wait(AskAction).action == "Hello"


def test_a_signal_ends_it(host: FakeHost, terminal: FakeTerminal) -> None:
    terminal.process.send_signal(signal.SIGTERM)

    assert terminal.wait_exit() == 128 + signal.SIGTERM
    host.until(lambda: bool(host.closed), "the end of the connection")
    assert terminal.attributes() == terminal.attributes_before
