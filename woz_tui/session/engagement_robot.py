"""What the engagement model uses of a session: robot commands, whether it may move, timers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import date

from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Call, Experiment
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.session.action_runner import ActionRunner
from woz_tui.session.action_texts import ActionTexts

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


@dataclass
class EngagementRobot:
    """Sends the commands of the engagement model, and knows whether the robot may move.

    Args:
        hub: Where everything is published.
        experiment: As its file was read last.
        is_over: Whether the session has ended.
        today: The day on the calendar.
    """

    hub: Hub
    experiment: Callable[[], Experiment]
    is_over: Callable[[], bool]
    today: Callable[[], date]
    #: They come later: what the model offers belongs on the bus, too.
    bus: Bus = field(init=False)
    runner: ActionRunner = field(init=False)
    texts: ActionTexts = field(init=False)

    @property
    def is_stopped(self) -> bool:
        """Whether the stop is pressed."""
        return self.bus.latched

    @property
    def may_move(self) -> bool:
        """Whether anything may be asked of it."""
        return not (self.is_stopped or self.is_over())

    def send(self, call: Call, on_end: Callable[[m.End], None] | None = None) -> m.Command:
        """Send one verb; it waits while its driver is busy."""
        return self.runner.send(call, ORIGIN, "queue", None, on_end)
