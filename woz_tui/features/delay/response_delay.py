"""Holds answers that come too soon after a cue until a minimum and a random time have passed.

A robot that answers in 300 ms one time and in 3 s the next tells that a human is behind it; and
wizards who differ in quickness are a difference between conditions. So what is asked for too soon
after a cue waits; what comes later anyway is not held up. Two things never wait: driving, because
it would begin when nobody expects it any more, and what streams (arrow keys, knobs).
"""

from __future__ import annotations

import asyncio
import random
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import Verb
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import BY_ITSELF


@dataclass(frozen=True, slots=True)
class PendingCue:
    """Something that wants an answer: its sort, its moment, and from when on it may be answered;
    both in microseconds on the axis of `t`.
    """

    sort: str
    cued: int
    until: int


def may_wait(verb: Verb) -> bool:
    """Whether what comes too soon after a cue may wait: whatever it is, it shows a hand."""
    return not (verb.stream or verb.drives or verb.brief)


class ResponseDelay:
    """Holds what answers the last cue too soon, as `shaping.changed` says.

    Args:
        hub: Where it is told what is held, and what time it is.
        seed: Of the jitter.
    """

    #: What it has to hear: settings and cues.
    HEARS: ClassVar[tuple[type[m.Message], ...]] = (
        *(ShapingChanged, m.SpeechEnded, m.EngagementChanged, m.Marker),
    )

    def __init__(self, hub: Hub, seed: int) -> None:
        self._hub = hub
        self._random = random.Random(f"{seed} shaping")
        self._settings = ShapingChanged(floor_us=0, jitter_us=0, cues=[])
        self._cue: PendingCue | None = None
        #: What is held, each with its cue and the moment at which it begins.
        self._held: deque[tuple[PendingCue, str, Callable[[], object]]] = deque()
        self._timer: asyncio.TimerHandle | None = None

    def hear(self, message: m.Message) -> None:
        """One of `HEARS`."""
        match message:
            case ShapingChanged():
                self._settings, self._cue = message, None
            case m.SpeechEnded(ended=ended, own=own) if not own:
                self._cued("speech", ended)
            case m.EngagementChanged(t=t):
                self._cued("engagement", t)
            case m.Marker(source=source) as marker if source not in m.AUTOMATIC_MARKERS:
                self._cued("marker", marker.moment)

    def _cued(self, sort: str, t: int) -> None:
        if sort in self._settings.cues:
            jitter = round(self._random.uniform(0.0, self._settings.jitter_us))
            if self._cue is None or t >= self._cue.cued:  # a marker may come after a later cue
                self._cue = PendingCue(sort, t, t + self._settings.floor_us + jitter)

    # -- holding -----------------------------------------------------------------------------

    def hold(self, run: str, name: str, source: str, begin: Callable[[], object]) -> bool:
        """Whether `begin` waits, because it would answer a cue too soon; then it is called later.

        `run` and `name` say what is held: an action's run, or a command.
        """
        last = self._held[-1][0] if self._held else None
        cue = self._cue or last
        if cue is None or source in BY_ITSELF:
            return False
        if last is not None:  # behind it: the order of the presses is the order of the acts
            cue = replace(cue, until=max(cue.until, last.until))
        elif cue.until <= self._hub.now():
            return False
        self._hub.publish(
            ActionHeld(run=run, action=name, sort=cue.sort, cued=cue.cued, until=cue.until)
        )
        self._held.append((cue, run, begin))
        self._wait()
        return True

    @property
    def holds(self) -> bool:
        """Whether something waits."""
        return bool(self._held)

    def drop(self, run: str) -> None:
        """Forget what is held as `run`."""
        self._held = deque(entry for entry in self._held if entry[1] != run)
        self._wait()

    def _wait(self) -> None:
        """Wake up for the first that is held now, not for one that has been dropped."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._held:
            delay = max(0, self._held[0][0].until - self._hub.now()) / 1_000_000
            self._timer = asyncio.get_running_loop().call_later(delay, self._release)

    def _release(self) -> None:
        """Begin all whose moment has come; if one of them cannot, those behind it still do."""
        self._timer = None
        try:
            while self._held and self._held[0][0].until <= self._hub.now():
                self._held.popleft()[2]()
        finally:
            self._wait()
