"""Values that one driver hands to another many times a second, inside the robot process.

A feed holds the latest value only: setpoints for the servos, frames for a face, what a camera sees.
Whoever reads is never woken and never waits, and whoever writes does not know who reads: any side
may be missing, late or restarted. Nothing here is logged; what belongs in the log is published.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any

#: Feed of each driver: how it is, as its last `HealthStatement`.
HEALTH = "health"


@dataclass(frozen=True, slots=True)
class Latest:
    """The newest value of a feed; `serial` counts the values, 0 means that there is none yet."""

    serial: int = 0
    value: Any = None


class Feed:
    """One latest value, for any number of threads."""

    def __init__(self) -> None:
        self._latest = Latest()
        self._lock = threading.Lock()

    def put(self, value: object) -> None:
        """Replace the value. Give what nobody changes afterwards."""
        with self._lock:
            self._latest = Latest(self._latest.serial + 1, value)

    def latest(self) -> Latest:
        """The newest value with its serial number, so that a reader knows it has seen it."""
        return self._latest


class Feeds:
    """All feeds of a session, made when somebody first names them."""

    def __init__(self) -> None:
        self._feeds: dict[str, dict[str, Feed]] = {}
        self._lock = threading.Lock()

    def feed(self, driver: str, topic: str) -> Feed:
        """The feed `topic` of the driver `driver`, in full (`left.body`)."""
        with self._lock:
            return self._feeds.setdefault(topic, {}).setdefault(driver, Feed())

    def put_everywhere(self, topic: str, value: Any) -> None:
        """Put `value` into every feed `topic` that somebody has named."""
        with self._lock:
            feeds = [*self._feeds.get(topic, {}).values()]
        for feed in feeds:
            feed.put(value)

    def drivers(self, topic: str) -> list[str]:
        """Full names of the drivers whose feed `topic` somebody has named, oldest first."""
        with self._lock:
            return [*self._feeds.get(topic, ())]
