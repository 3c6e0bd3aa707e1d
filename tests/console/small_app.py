"""A small console for tests of what lies under the screen: link, keyboard, terminal's driver.

`python -m tests.console.small_app SOCKET`. What the host says in markers it obeys: `block FILE`
blocks the event loop until FILE exists, `flood` writes two megabytes, `crash` raises.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import Any, ClassVar

from textual.app import App, ComposeResult
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from woz_tui.config.keys import Terminal
from woz_tui.console.commands import COMMANDS
from woz_tui.console.input.exit_handler import missing_terminal
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.host_connection import HostConnection
from woz_tui.console.link.message_feed import Incoming
from woz_tui.console.wizard_terminal import WizardDriver
from woz_tui.protocol.messages import Marker
from woz_tui.protocol.requests import AskNote, Welcome


class Say(ModalScreen[None]):
    """A text field; enter says what stands in it."""

    def __init__(self, app: SmallApp) -> None:
        super().__init__()
        self._small = app
        self._changes = 0

    def compose(self) -> ComposeResult:
        yield Input(id="say", placeholder="utterance")

    def on_input_changed(self, event: Input.Changed) -> None:
        self._changes += 1

    def on_input_submitted(self, event: Input.Submitted) -> None:
        self._small.tell(f"pieces:{self._changes} ")
        self._small.feed.ask(AskNote(text=f"said {event.value}"))
        self._small.close_dialog()


class SmallApp(App[None]):
    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar = []

    def __init__(self, path: Path) -> None:
        super().__init__(driver_class=WizardDriver)
        self.feed = HostConnection(path)
        self.keyboard = Keyboard(self.feed)
        own = {key.chord: command for command in COMMANDS for key in command.keys}
        self.keyboard.bind({}, own)
        self.seen: list[str] = []

    def compose(self) -> ComposeResult:
        yield Static("starting", id="state")

    def on_mount(self) -> None:
        self.keyboard.on_pressed = self._pressed
        self.keyboard.on_stale = lambda chord, action, ref: self.tell(f"stale:{chord}")
        self.keyboard.on_prefix = lambda prefix: self.tell(f"prefix:{prefix}")
        self.feed.start(self._heard, lambda why: self.tell(f"lost:{why}"))

    def terminal_found(self, terminal: Terminal) -> None:
        self._show(f"terminal:{terminal.name}")

    # -- from other threads ---------------------------------------------------------------------

    def _heard(self, batch: list[Incoming]) -> None:
        for message in batch:
            if isinstance(message, Welcome):
                actions = [action for panel in message.panels for action in panel.actions]
                self.keyboard.bind({action.key: action.name for action in actions})
                self.keyboard.verbs = message.verbs
                self.tell("ready")
            elif isinstance(message, Marker):
                self.call_later(self._obey, message.text)

    def tell(self, text: str) -> None:
        self.call_later(self._show, text)

    def _pressed(self, chord: str, action: str, ref: int) -> None:
        self.tell(f"pressed:{chord}")
        if not action and chord in ("escape", "ctrl+c"):
            self.call_later(self.close_dialog)

    # -- in the app's thread --------------------------------------------------------------------

    def _show(self, text: str) -> None:
        self.seen = [*self.seen[-15:], text]
        self.query_one("#state", Static).update("\n".join(self.seen))

    def _obey(self, order: str) -> None:
        word, _, rest = order.partition(" ")
        if word == "block":
            self.feed.ask(AskNote(text="blocked"))
            while not Path(rest).exists():
                time.sleep(0.01)
            self.feed.ask(AskNote(text="unblocked"))
        elif word == "flood" and self._driver is not None:
            for _ in range(200):
                self._driver.write("flood " * 1700 + "\r")
            self.feed.ask(AskNote(text="flooded"))
        elif word == "crash":
            raise RuntimeError("crashed as told")

    def close_dialog(self) -> None:
        if len(self.screen_stack) > 1:
            self.pop_screen()
        self.keyboard.free = True

    async def on_event(self, event: Any) -> None:
        key = getattr(event, "key", None)
        if key is not None and not event.is_forwarded and len(self.screen_stack) == 1:
            event.stop()
            if key == "slash":
                self.keyboard.free, self.keyboard.typed_into = False, True
                self.push_screen(Say(self))
            elif not self.keyboard.press(event.character or key):
                self._show(f"screen:{key}")
            return
        await super().on_event(event)


def main() -> int:
    reason = missing_terminal(sys.stdin, sys.stdout, os.environ)
    if reason:
        print(f"woz: {reason}", file=sys.stderr)  # noqa: T201
        return 2
    app = SmallApp(Path(sys.argv[1]))
    app.run(mouse=False)
    return app.return_code or 0


if __name__ == "__main__":
    sys.exit(main())
