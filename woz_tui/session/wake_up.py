"""Waking up at a moment on the axis of the messages' `t`."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from woz_tui.bus.hub import Hub

#: The least that it waits, in seconds: whoever is late is woken soon, and not without a pause.
_SOON_S = 0.001


class WakeUpTimer:
    """Calls `ring` in the session's thread when the moment comes that was set last."""

    def __init__(self, hub: Hub, ring: Callable[[], object]) -> None:
        self._hub = hub
        self._ring = ring
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None

    def set(self, due: int | None) -> None:
        """Ring at `due` microseconds, and at no other moment; None: not at all."""
        self.cancel()
        if due is not None:
            seconds = max((due - self._hub.now()) / 1_000_000, _SOON_S)
            self._timer = self._loop.call_later(seconds, self._ring)

    def cancel(self) -> None:
        """Do not ring."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
