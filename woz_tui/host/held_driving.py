"""Ends what a held key drives as soon as the key's repeats stay away.

A terminal says of no key that it was let go, and behind tmux, screen or mosh the loss of the
wizard's line may be seen late or never: whatever is asked there is answered by them. A key that is
held down repeats, so its repeats are the evidence that somebody is still there.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import Literal

from woz_tui.gate.table import LET_GO
from woz_tui.host.repeat_delay import RepeatDelays
from woz_tui.protocol.messages import Notice
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session import Session

#: How long after a press, and after a repeat, the next repeat may take, in seconds. Keyboards wait
#: 250 to 660 ms before the first repeat, and 25 to 100 ms between the others; lines have jitter.
#: The first holds until a console's own is known (`RepeatDelays`).
FIRST_REPEAT_S, NEXT_REPEAT_S = 0.75, 0.4

#: How a line drives: while a key is held, or as far as one press says.
DrivingMode = Literal["held", "pressed"]


@dataclass(slots=True)
class _Hold:
    """A key that is down, as far as is known."""

    run: str
    until: float
    #: Commands that drive because of it.
    commands: list[str] = field(default_factory=list)
    timer: asyncio.TimerHandle | None = None


class HeldDriving:
    """The keys that drive and are held down at the moment.

    Args:
        session: Whose commands drive.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._holds: dict[tuple[str, str], _Hold] = {}
        self._delays = RepeatDelays()
        self._loop = asyncio.get_running_loop()

    def repeat(self, console: str, key: str) -> str:
        """A key that may drive came: the run that it goes on with, if it is a repeat; else empty.

        A repeat begins nothing, also where what it held has ended meanwhile.
        """
        if (delay := self._delays.came(console, key, self._loop.time())) is not None:
            first = self._delays.first_repeat_s(console, FIRST_REPEAT_S)
            text = Sentence(
                "host.keyboard_delay",
                "The keyboard of {console} repeats a held key after {delay:.2f} s: one press now"
                " drives for {first:.2f} s",
                console=console,
                delay=delay,
                first=first,
            )
            self._session.hub.publish(Notice(level="info", text=text))
        hold = self._holds.get((console, key))
        if hold is None:
            return ""
        self._prolong(console, key, hold, NEXT_REPEAT_S)
        return hold.run

    def press(self, console: str, key: str, play: Callable[[], str]) -> str:
        """Play what the key means, which may drive while it is held; the run."""
        hold = self._holds[console, key] = _Hold("", 0.0)
        self._prolong(*(console, key, hold), self._delays.first_repeat_s(console, FIRST_REPEAT_S))
        try:
            hold.run = play()
        except BaseException:
            self._forget(console, key)
            raise
        return hold.run

    @property
    def keys(self) -> Collection[tuple[str, str]]:
        """Those that are down, by console."""
        return self._holds.keys()

    def drive(self, console: str, key: str, command: str) -> None:
        """A command drives, and it may be because of a key that is down."""
        if (hold := self._holds.get((console, key))) is not None:
            hold.commands.append(command)

    def let_go(self, console: str, key: str = "") -> None:
        """A key is up, or all keys of a console are: what they drive ends."""
        for held in [held for held in self._holds if held[0] == console and key in ("", held[1])]:
            self._end(*held)

    def _prolong(self, console: str, key: str, hold: _Hold, seconds: float) -> None:
        until = self._loop.time() + seconds
        if until > hold.until:  # a repeat right behind the press takes nothing from its time
            hold.until = until
            if hold.timer is not None:
                hold.timer.cancel()
            hold.timer = self._loop.call_at(until, self._end, console, key)

    def _forget(self, console: str, key: str) -> _Hold:
        hold = self._holds.pop((console, key))
        if hold.timer is not None:
            hold.timer.cancel()
        return hold

    def _end(self, console: str, key: str) -> None:
        for command in self._forget(console, key).commands:
            self._session.bus.cancel(command, LET_GO)
