"""Running the console without a terminal, and waiting for what it shows."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from textual._context import visible_screen_stack
from textual.app import App
from textual.events import Key
from textual.keys import _character_to_key, key_to_character
from textual.pilot import Pilot
from textual.screen import Screen
from textual.strip import Strip

from tests.console import scenes
from tests.console.scripted_feed import ScriptedFeed
from woz_tui.console.app import Console
from woz_tui.console.drawing.cells import Cells
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.message_feed import Incoming
from woz_tui.system.clock import ManualClock

#: Seconds after which a condition counts as never coming true.
PATIENCE = 40.0
#: Turns of the loop without a message after which none is expected.
QUIET_TURNS = 6


@dataclass
class ConsolePilot:
    """A console being driven."""

    console: Console
    feed: ScriptedFeed
    pilot: Pilot[str]
    clock: ManualClock

    def text(self, name: str) -> str:
        """What a widget of the main screen shows (Status, Panels, Meters, Events, StopBar)."""
        return self.console.screen_stack[0].query_one(name, Cells).text

    async def until(self, condition: Callable[[], bool], what: str = "") -> None:
        """Wait until `condition` holds and is laid out; fail after a bounded time.

        A widget has its new text before it has its new size: who looks in between sees half of it.
        """
        deadline = asyncio.get_running_loop().time() + PATIENCE
        while not condition():
            if asyncio.get_running_loop().time() > deadline:
                raise AssertionError(f"never came true: {what or condition}")
            await self.pilot.pause(0.01)
        await self.settle()

    async def settle(self) -> None:
        """Let every widget work through what it has been sent.

        Unlike the pilot's own `press` and `pause` this does not wait for an idle processor, which
        takes a tenth of a second for each key, and much longer on a busy machine.
        """
        for _ in range(3):
            await work_through(self.pilot)
        for _ in range(400):  # beats of Textual, at which what waits for it happens
            if not any(map(_waits, self.console.screen_stack)):
                break
            await self.pilot.pause(0.005)

    async def tell(self, *messages: Incoming) -> None:
        """Let the feed deliver from another thread; painted when this returns."""
        await asyncio.to_thread(self.feed.deliver, *messages)
        await self.settle()
        self.console.paint()
        await self.settle()

    async def tell_quietly(self, *messages: Incoming) -> None:
        """Let the feed deliver; painted when the console thinks fit."""
        await asyncio.to_thread(self.feed.deliver, *messages)

    async def press(self, *keys: str) -> None:
        """Press keys, and let everything that follows happen."""
        for key in keys:
            name = _character_to_key(key) if len(key) == 1 else key
            self.console.post_message(Key(name, key_to_character(name)))
            await self.settle()
        self.console.paint()
        await self.settle()

    async def type(self, text: str) -> None:
        """Type text into a field, so fast that it has come before anything is painted."""
        for letter in text:
            name = _character_to_key(letter)
            self.console.post_message(Key(name, key_to_character(name)))
        await self.press()

    async def pass_time(self, seconds: float) -> None:
        """Let the local clock go on."""
        self.clock.advance(seconds)
        self.console.paint()
        await self.settle()

    def drawn(self) -> str:
        """Every cell as text."""
        return screen_text(self.console)


async def work_through(pilot: Pilot[str]) -> None:
    """Let app, screen and widgets work through their messages, and the screen take what is new.

    The pilot's `pause` sends each of them a message for that, which was a third of all messages
    in the console's tests. Here only those are waited for that have something to do.
    """
    quiet = 0  # turns of the loop; what follows from a message may need some to be sent
    for _ in range(200):
        await asyncio.sleep(0)
        quiet = 0 if _is_busy(pilot.app) else quiet + 1
        if quiet == QUIET_TURNS:
            pilot.app.screen._on_timer_update()
            return
    await pilot.pause(0)  # somebody waits for more than a message, or has failed


def _is_busy(app: App[str]) -> bool:
    """Whether the app, its screen or a widget of it has anything else to do than wait."""
    for pump in (app, *app.screen.walk_children(with_self=True)):
        message_comes: asyncio.Event = pump._message_queue.ready_event
        if message_comes.is_set() or not message_comes._waiters:
            return True
    return False


def screen_text(console: Console) -> str:
    """What the screen on top draws, and what shines through it."""
    width, height = console.size
    lines = []
    for strip in screen_strips(console.screen)[:height]:
        lines.append("".join(segment.text for segment in strip)[:width])
    return "\n".join(lines)


def screen_strips(screen: Screen[object]) -> list[Strip]:
    """The lines of the screen on top. Textual has to be told what shines through."""
    beneath = visible_screen_stack.set(list(screen.app._background_screens))
    try:
        return screen._compositor.render_strips()
    finally:
        visible_screen_stack.reset(beneath)


@asynccontextmanager
async def piloted_console(
    *first: Incoming, size: tuple[int, int] = (80, 24), **options: Any
) -> AsyncIterator[ConsolePilot]:
    """A console whose feed begins with `first`, by default the museum guide's session."""
    feed = ScriptedFeed()
    feed.begin_with(*(first or (scenes.welcome(),)))
    clock = ManualClock()
    console = Console(feed, Keyboard(feed, clock), clock=clock, **options)
    async with console.run_test(size=size) as pilot:
        console_pilot = ConsolePilot(console, feed, pilot, clock)
        await console_pilot.settle()
        console.paint()
        await console_pilot.settle()
        yield console_pilot


def _waits(screen: Screen[object]) -> bool:
    """Whether something is to be laid out, painted or called at Textual's next beat; of a screen
    that is hidden nothing is.
    """
    waits = screen._layout_required or screen._dirty_widgets or screen._callbacks
    return screen.is_current and bool(waits)
