"""The console of `woz replay`: the usual screen, fed from a log, with keys that move through it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import Any

from woz_tui.config.keys.keymap import key_map
from woz_tui.console.app import FLASH_S, Console
from woz_tui.console.drawing.key_caps import cap_of
from woz_tui.console.link.message_feed import Incoming, MessageFeed
from woz_tui.console.replay.commands import COMMANDS, ReplayKeyboard
from woz_tui.console.replay.timeline import TimeBar
from woz_tui.console.screen_app import PAINT_S, Inbox
from woz_tui.console.widgets.main_screen import MainScreen
from woz_tui.protocol.action_messages import HANDS
from woz_tui.protocol.messages import ActionRequested
from woz_tui.protocol.requests import Reply, Welcome
from woz_tui.system.text_cleaning import elapsed

#: Beats between two paintings up to a rate.
PACES = ((2.0, 1), (4.0, 2), (8.0, 3), (math.inf, 4))


class _Inbox(Inbox):
    """Collects the actions that were played by hand."""

    def __init__(self, wake: Callable[[], None]) -> None:
        super().__init__(wake)
        self.played: deque[str] = deque(maxlen=8)

    def receive(self, batch: list[Incoming]) -> None:
        self.played.extend(
            message.action
            for message in batch
            if isinstance(message, ActionRequested) and message.source in HANDS
        )
        super().receive(batch)


class ReplayConsole(Console):
    """See the module's text. Returns `left`.

    Args:
        feed: Plays the log.
        keyboard: Its keys.
        options: As for `Console`.
    """

    def __init__(self, feed: MessageFeed, keyboard: ReplayKeyboard, **options: Any) -> None:
        super().__init__(feed, keyboard, commands=COMMANDS, **options)
        self.inbox: _Inbox = _Inbox(self.wake)
        self._main_screen = MainScreen(bar=TimeBar())
        self._panels = self._main_screen.panels
        self._greeted = False

    def _pace(self) -> float:
        """The faster it goes, the more of the screen a painting changes: a slow line gets fewer."""
        return next(beats for rate, beats in PACES if self.state.rate <= rate) * PAINT_S

    def beat(self) -> None:
        """As in a session; what hurries is painted as often as it may be."""
        pace = self._pace()
        since = self.clock.now_us() - self._painted
        if pace > PAINT_S and since < (pace - PAINT_S / 2) * 1_000_000:
            self.keyboard.tick()
            return
        super().beat()
        if self.state.rate > 1:
            self.wake()

    def _take_in(self, local: int) -> None:
        super()._take_in(local)
        while self.inbox.played:
            action = self.inbox.played.popleft()
            self._panels.turn_to(action)
            self._panels.press(action)
            self._flash_until = local + round(FLASH_S * 1_000_000)

    def _stop_changed(self) -> None:
        """A stop of then; what the viewer is told stays."""

    def _welcomed(self, welcome: Welcome) -> None:
        """Name the most important keys once."""
        if not self._greeted:
            self._greeted = True
            self.news("  ".join(f"{key} {word}" for key, word in self._hints()))

    def _replied(self, reply: Reply) -> None:
        """Show which line a step came to."""
        told = reply.data
        if reply.ok and isinstance(told, dict) and isinstance(told.get("t"), int):
            t = int(told["t"])
            self.news(f"{elapsed(t)}.{t % 1_000_000 // 1000:03} {told.get('kind', '')}")
        super()._replied(reply)

    def _adopt(self) -> None:
        """Caps show the session's keys; the keyboard has those of the replay."""
        state = self.state
        played = key_map(state.panels, self.terminal, state.plan.keyboard)
        self.caps = {name: cap_of(found) for name, found in played.actions.items()}
        self._panels.bear(self.caps)
        self.keymap = key_map((), self.terminal, state.plan.keyboard, self._builtins)
        self.keyboard.bind({}, self._own_keys())

    def _stopping(self) -> None:
        """Every dialog closes, as in a session; there is nothing to stop."""
        while self.dialog is not None:
            self.close_dialog()
        self.paint()
