"""What a driver may tell the session, from whichever thread it runs in."""

from __future__ import annotations

import asyncio
import threading
from pathlib import Path

from woz_tui.core.clock import Clock
from woz_tui.core.driver import Health
from woz_tui.core.hub import Hub
from woz_tui.core.messages import (
    DriverConnected,
    DriverConnecting,
    DriverFaulted,
    DriverHealth,
    DriverLost,
    Message,
    ModeChanged,
    Notice,
    SensorChanged,
    reading,
)

_HEALTH: dict[Health, type[DriverHealth]] = {
    Health.CONNECTING: DriverConnecting,
    Health.CONNECTED: DriverConnected,
    Health.LOST: DriverLost,
    Health.FAULTED: DriverFaulted,
}


class DriverOutlet:
    """`core.driver.Outlet` for one driver; repeats of a state are swallowed here."""

    def __init__(self, driver: str, hub: Hub, clock: Clock, folder: Path) -> None:
        self._driver = driver
        self._hub = hub
        self._clock = clock
        self._folder = folder
        self._loop = asyncio.get_running_loop()
        self._thread = threading.get_ident()
        self._health: tuple[Health, str] | None = None
        self._sensors: dict[str, str] = {}
        self._mode = ""

    @property
    def clock(self) -> Clock:
        """The session's clock."""
        return self._clock

    @property
    def folder(self) -> Path:
        """Where relative paths start."""
        return self._folder

    def reading(
        self,
        sensor: str,
        value: float | None,
        *,
        text: str = "",
        unit: str = "",
        raw: float | None = None,
    ) -> None:
        """Publish a sample."""
        self._publish(reading(sensor, value, text=text, driver=self._driver, unit=unit, raw=raw))

    def sensor(self, sensor: str, state: str, why: str = "") -> None:
        """Publish a sensor's change of state."""
        was = self._sensors.get(sensor, "")
        if was != state:
            self._sensors[sensor] = state
            self._publish(SensorChanged(sensor=sensor, state=state, was=was, why=why))

    def health(self, health: Health, detail: str = "", remedy: str = "") -> None:
        """Publish the driver's change of health."""
        if self._health != (health, detail):
            self._health = (health, detail)
            self._publish(_HEALTH[health](driver=self._driver, detail=detail, remedy=remedy))

    def mode(self, mode: str, why: str = "") -> None:
        """Publish the robot's change of mode."""
        was, self._mode = self._mode, mode
        if was != mode:
            self._publish(ModeChanged(driver=self._driver, was=was, now=mode, why=why))

    def notice(self, level: str, text: str, remedy: str = "") -> None:
        """Publish a sentence for the wizard."""
        self._publish(Notice(level=level, text=f"{self._driver}: {text}", remedy=remedy))

    def _publish(self, message: Message) -> None:
        if threading.get_ident() == self._thread:
            self._hub.publish(message)
        elif not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._hub.publish, message)
