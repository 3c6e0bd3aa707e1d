"""App that shows what a feed brings: the base of the wizard's and of the participant's screen."""

from __future__ import annotations

import asyncio
import contextlib
import contextvars
import functools
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path

from textual.app import App
from textual.driver import Driver
from textual.screen import Screen

from woz_tui.config.screen_language import follow, worded
from woz_tui.console.drawing.glyphs import UNICODE
from woz_tui.console.drawing.partial_update import PartialScreen
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.console.drawing.theme import SIXTEEN, THEMES, Appearance
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.message_feed import Incoming, Loss, MessageFeed
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.requests import Welcome
from woz_tui.system.clock import Clock, RealClock


class Inbox:
    """Batches of messages and losses of the connection.

    Args:
        wake: Called in the screen's thread when something has come after a silence.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._came: deque[list[Incoming] | Loss] = deque()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._surroundings: contextvars.Context | None = None

    def open(self) -> None:
        """The screen's loop runs; called in it, where a dialog will find its app."""
        self._loop = asyncio.get_running_loop()
        self._surroundings = contextvars.copy_context()

    def __bool__(self) -> bool:
        """Whether there is anything to take."""
        return bool(self._came)

    # -- in any thread --------------------------------------------------------------------------

    def receive(self, batch: list[Incoming]) -> None:
        """Keep a batch for the next painting; wake the screen if it has been still."""
        idle = not self._came
        self._came.append(batch)
        if idle:
            self._call(self._wake)

    def cut(self, loss: Loss) -> None:
        """The connection is lost."""
        self._came.append(loss)
        self._call(self._wake)

    def elsewhere(self, callback: Callable[..., None]) -> Callable[..., None]:
        """`callback`, to be called from any thread."""
        return functools.partial(self._call, callback)

    def _call(self, callback: Callable[..., None], *args: object) -> None:
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has closed: nothing to show
                self._loop.call_soon_threadsafe(callback, *args, context=self._surroundings)

    # -- in the screen's thread -----------------------------------------------------------------

    def taken(self) -> Iterator[list[Incoming] | Loss]:
        """Take what has come, oldest first."""
        while self._came:
            came = self._came.popleft()
            if isinstance(came, Loss):
                yield came
                continue
            for message in came:
                if isinstance(message, Welcome):
                    follow(message.settings.study.language)
            yield [*map(worded, came)]


#: Seconds between two paintings: ten a second is as much as an eye and a line can use.
PAINT_S = 0.1


class ScreenApp(App[str], inherit_bindings=False):  # Textual's ctrl+q would quit unasked
    """An app that shows what a feed brings.

    Args:
        feed: Where messages come from and requests go.
        keyboard: What happens to keys; shared with the terminal's driver.
        look: Signs and colours for this terminal.
        clock: Local time.
        driver_class: Textual's driver; None for its own.
    """

    CSS_PATH = Path(__file__).parent / "drawing" / "woz.tcss"
    ENABLE_COMMAND_PALETTE = False
    ESCAPE_TO_MINIMIZE = False

    def __init__(
        self,
        feed: MessageFeed,
        keyboard: Keyboard,
        *,
        look: Appearance | None = None,
        clock: Clock | None = None,
        driver_class: type[Driver] | None = None,
    ) -> None:
        look = look or Appearance(UNICODE)
        # Told at once, so that NO_COLOR leaves no colours at all instead of greys.
        sixteen = look.theme == SIXTEEN.name or None
        super().__init__(driver_class=driver_class, ansi_color=sixteen)
        self.error_console = TextConsole(stderr=True)  # for a crash, whose traceback quotes texts
        for theme in THEMES:
            self.register_theme(theme)
        self.look, self.theme = look, look.theme
        self.feed, self.keyboard = feed, keyboard
        self.clock = clock or RealClock()
        self.state = ConsoleState()
        self.inbox = Inbox(self.wake)

    def get_default_screen(self) -> Screen[object]:
        """One that paints little."""
        return PartialScreen(id="_default")

    def on_mount(self) -> None:
        """Begin to listen and to paint."""
        self.inbox.open()
        self.set_class(self.look.glyphs.ascii, "-ascii")
        self.set_class(self.no_color, "-plain")
        self.begin()
        self.set_interval(PAINT_S, self.beat)
        self.feed.start(self.inbox.receive, self.inbox.cut)

    def on_unmount(self) -> None:
        """Nothing comes any more."""
        self.feed.close()

    def begin(self) -> None:
        """What is to be done before anything is heard."""

    def wake(self) -> None:
        """Something has come after a silence."""
        raise NotImplementedError

    def beat(self) -> None:
        """A beat has passed since the last."""
        self.wake()
