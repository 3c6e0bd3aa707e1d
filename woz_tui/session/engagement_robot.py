"""What the engagement model uses of a session: robot commands, whether it may move, timers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from typing import Protocol

from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Call, Experiment
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.session.action_runner import ActionRunner
from woz_tui.session.action_texts import ActionTexts
from woz_tui.system.clock import Clock

#: The least that it waits, in seconds: whoever is late is woken soon, and not without a pause.
_SOON_S = 0.001


class WakeUpTimer:
    """Calls `on_due` in the session's thread when the moment comes that was set last."""

    def __init__(self, hub: Hub, on_due: Callable[[], object]) -> None:
        self._hub = hub
        self._on_due = on_due
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None

    def set(self, due: int | None) -> None:
        """Call `on_due` at `due` microseconds only; None: not at all."""
        self.cancel()
        if due is not None:
            seconds = max((due - self._hub.now()) / 1_000_000, _SOON_S)
            self._timer = self._loop.call_later(seconds, self._on_due)

    def cancel(self) -> None:
        """Do not call it."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


#: Whose hand it is, in the log.
ORIGIN = RequestOrigin(ENGAGEMENT)


class EngagementSession(Protocol):
    """What the engagement model uses of a session. `bus`, `runner` and `texts` come after the
    model: what it offers belongs on the bus, too.
    """

    clock: Clock
    hub: Hub
    #: As its file was read last.
    experiment: Experiment
    bus: Bus
    runner: ActionRunner
    texts: ActionTexts
    ended: bool


@dataclass
class EngagementRobot:
    """Sends the commands of the engagement model, and knows whether the robot may move."""

    session: EngagementSession

    @property
    def today(self) -> date:
        """The day on the calendar."""
        return self.session.clock.wall().date()

    @property
    def is_stopped(self) -> bool:
        return self.session.bus.latched

    @property
    def may_move(self) -> bool:
        """Whether anything may be asked of it."""
        return not (self.is_stopped or self.session.ended)

    def send(self, call: Call, on_end: Callable[[m.End], None] | None = None) -> m.Command:
        """Send one verb; it waits while its driver is busy."""
        return self.session.runner.send(call, ORIGIN, "queue", None, on_end)
