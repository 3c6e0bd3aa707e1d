"""The real console on a running robot process, with an event loop that hardly ever runs.

    python benchmarks/programs/blocked_console.py SOCKET asleep|spinning

Again and again a timer holds the loop for a second: asleep, as a call that waits for something
would, or spinning in Python code, which also wants the interpreter for itself.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from woz_tui.cli.console_start import prioritise_keys
from woz_tui.console.app import Console
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.host_connection import HostConnection
from woz_tui.console.wizard_terminal import WizardDriver

BLOCKED_S = 1.0
#: Between two blocks the loop may run so long.
FREE_S = 0.02
#: The first block comes when the first painting is done.
BEGIN_S = 1.0


class BlockedConsole(Console):
    """A console whose loop is held up."""

    spinning = False

    def on_mount(self) -> None:
        """Called besides the console's own: Textual calls every class's."""
        self.set_timer(BEGIN_S, lambda: self.set_interval(FREE_S, self._block))

    def _block(self) -> None:
        until = time.monotonic() + BLOCKED_S
        if not self.spinning:
            time.sleep(BLOCKED_S)
        while time.monotonic() < until:
            pass


def main() -> None:
    """Run it until it is killed."""
    link = HostConnection(Path(sys.argv[1]))
    console = BlockedConsole(link, Keyboard(link), driver_class=WizardDriver)
    console.spinning = sys.argv[2] == "spinning"
    prioritise_keys()
    console.run()


if __name__ == "__main__":
    main()
