"""Escape with any other key right behind it, in every screen and dialog of the real console.

`python -m tests.e2e.stops` tries every key in every dialog; the tests try every key on the main
screen and a share of them in each dialog. `--tmux 0` or `--tmux 500` does so inside tmux, with
that escape-time in milliseconds.
"""

from __future__ import annotations

import argparse
import re
import string
import subprocess
import sys

from tests.e2e import scenes
from tests.e2e.lab import Lab, Log, recording, until
from tests.fakes.terminal import FakeTerminal

#: Key that opens a dialog -> what stands in its frame.
DIALOGS = {
    "/": "─ Say ─",
    ":": "─ Find ─",
    ",": "─ Note ─",
    "\x17": "─ That was a mistake ─",
    "?": "─ Keys ─",
    "\x14": "─ Participant ─",
    "\x06": "─ Preflight ─",
    "\x05": "─ Read the experiment",
    "\x04": "─ Drivers ─",
    "\x11": "─ Leave ─",
    "-": "─ Profile ─",
    "\r": "─ Failed ─",
}
ARROWS = {letter: f"\x1b[{letter}" for letter in "ABCD"}
_SINGLE = (
    *string.ascii_letters,
    *string.digits,
    *"!\"#$%&'()*+,-./:;<=>?@\\]^_`{|}~ é",
    # ctrl+letters, tab, enter, backspace; not ctrl+c, which is a stop of its own, nor ctrl+z:
    # what comes while it suspends is not the console's
    *(chr(code) for code in range(1, 26) if code != 3),
    "\x7f",
)
_SEQUENCES = (
    *ARROWS.values(),
    *(f"\x1b[1;{modifier}{letter}" for modifier in (2, 3, 5) for letter in "ABCD"),
    *(f"\x1bO{letter}" for letter in "PQRS"),
    *(f"\x1b[{number}~" for number in (15, 17, 18, 19, 20, 21, 23, 24)),
    *("\x1b[1;2P", "\x1b[15;2~", "\x1b[H", "\x1b[F", "\x1b[2~", "\x1b[3~", "\x1b[5~", "\x1b[6~"),
    *("\x1b[Z", "\x1b[200~pasted words\x1b[201~"),
)
#: What may follow an escape: every key as a plain terminal sends it, and the start of a paste.
KEYS = (*_SINGLE, *_SEQUENCES, "[", "O")


class Stopping:
    """A session whose stops are counted."""

    def __init__(self, terminal: FakeTerminal, log: Log) -> None:
        self._terminal = terminal
        self._log = log

    def press(self, data: str) -> None:
        """Send bytes in one write: a stop must come of them, and be confirmed."""
        before = len(self._log.lines("stop.pressed", scope="all"))
        self._terminal.send(data)
        try:
            pressed = self._log.wait("stop.pressed", before + 1, scope="all")
        except AssertionError as error:
            screen = self._terminal.text
            raise AssertionError(f"no stop after {data!r}: {error}\n{screen}") from None
        # A stop while one is under way joins it: each must be over before the next is counted.
        until(
            lambda: any(line.seq > pressed.seq for line in self._log.lines("stop.confirmed")),
            f"the confirmation of the stop by {data!r}",
        )

    def back(self) -> None:
        """To the main screen."""
        self.press("\x1b")
        self._terminal.wait_for(lambda text: not any(head in text for head in DIALOGS.values()))

    def open(self, key: str) -> None:
        """A dialog, from the main screen."""
        self._terminal.send(key)
        self._terminal.wait_text(DIALOGS[key])

    def release(self) -> None:
        """ctrl+r takes the stop back."""
        count = len(self._log.lines("stop.released"))
        self._terminal.send("\x12")
        self._log.wait("stop.released", count + 1)


def begin(lab: Lab, terminal: FakeTerminal) -> Stopping:
    """The session on `terminal`, with a failure to show in the dialog of failures."""
    log = lab.log
    terminal.send("x")
    log.wait("action.failed")
    terminal.wait_text("1 failed")
    return Stopping(terminal, log)


def experiment(lab: Lab, text: str = "") -> list[str]:
    """The arguments of `woz run`; without a `text` of the file the guide's."""
    path = lab.file("guide.yaml", text or scenes.guide())
    return ["run", str(path), *lab.session()]


def plain(lab: Lab) -> FakeTerminal:
    """A session on a plain terminal."""
    terminal = lab.terminal(experiment(lab))
    recording(terminal)
    return terminal


def in_tmux(lab: Lab, escape_ms: int, text: str = "") -> FakeTerminal:
    """The same session inside tmux, or another experiment."""
    config = lab.file(
        "tmux.conf",
        f"set -s escape-time {escape_ms}\nset -g status off\n"
        "set -g default-terminal screen-256color\n",
    )
    words = ["tmux", "-S", str(lab.folder / "tmux"), "-f", str(config), "new-session", "-x", "80"]
    words += ["-y", "24", sys.executable, "-m", "woz_tui", *experiment(lab, text)]
    terminal = lab.program(words)
    recording(terminal)
    return terminal


def share(dialog: str) -> tuple[str, ...]:
    """The keys that the tests try in one dialog: each key in at least one of them."""
    order = list(DIALOGS)
    return allowed(dialog, KEYS[order.index(dialog) :: len(order)])


def allowed(dialog: str, keys: tuple[str, ...], *, tmux: bool = False) -> tuple[str, ...]:
    """Without keys that would take the ground from under a try: enter in the dialog of failures
    sees them all, and it does not open again; ctrl+b belongs to tmux, and tmux 3.5 makes of
    escape and shift+tab in one read a shift+tab alone, so that no escape leaves it.
    """
    left_out = {"\r"} if dialog == "\r" else set()
    if tmux:
        left_out |= {"\x02"} if _tmux_version() < (3, 5) else {"\x02", "\x1b[Z"}
    return tuple(key for key in keys if key not in left_out)


def _tmux_version() -> tuple[int, int]:
    """As `tmux -V` says; one built from its newest source is newer than all."""
    said = subprocess.run(["tmux", "-V"], capture_output=True, text=True, check=True).stdout
    number = re.search(r"(\d+)\.(\d+)", said)
    return (int(number[1]), int(number[2])) if number else (sys.maxsize, 0)


def main() -> int:
    """Run as a program."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tmux", type=int, default=None, metavar="MS")
    options = parser.parse_args()
    tried, failed = 0, 0
    for dialog in ("", *DIALOGS):
        with Lab() as lab:
            terminal = plain(lab) if options.tmux is None else in_tmux(lab, options.tmux)
            stopping = begin(lab, terminal)
            for key in allowed(dialog, KEYS, tmux=options.tmux is not None):
                tried += 1
                try:
                    stopping.back()
                    if dialog:
                        stopping.open(dialog)
                    stopping.press("\x1b" + key)
                except AssertionError as error:
                    failed += 1
                    sys.stdout.write(f"{dialog!r} {key!r}: {str(error)[:120]}\n")
    sys.stdout.write(f"{tried} stops with a key behind them, {failed} did not arrive\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
