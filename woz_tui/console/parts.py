"""The pieces a picture is made of; times are microseconds on the session's `t` axis."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Any

#: Readings older than this look stale even if nobody said so.
STALE_US = 2_000_000


class State(enum.Enum):
    """How an action stands, as its button shows it."""

    READY = "ready"
    QUEUED = "queued"
    HELD = "held"
    RUNNING = "running"
    DONE = "done"
    WAITS = "waits"
    FAILED = "failed"
    REFUSED = "refused"
    STOPPED = "stopped"
    LOCKED = "locked"
    UNREACHABLE = "unreachable"


@dataclass(frozen=True, slots=True)
class Standing:
    """An action's state at one moment.

    `left_us` is the time still to go, `share` (0..1) how much of the expected time has passed;
    both None while the driver has not said how long it takes; of what is held until it may answer
    a cue, the same until it begins. `note` is a word to go with the
    state: what is missing, why it was refused.
    """

    state: State
    left_us: int | None = None
    share: float | None = None
    note: str = ""


@dataclass(slots=True)
class DriverPicture:
    """A driver's health: unknown, connecting, connected, lost or faulted; since `t`."""

    name: str
    health: str = "unknown"
    detail: str = ""
    remedy: str = ""
    t: int = 0


@dataclass(slots=True)
class SensorPicture:
    """The last reading of one sensor and the last word about its state."""

    name: str
    t: int
    value: float | None = None
    text: str = ""
    unit: str = ""
    driver: str = ""
    state: str = ""
    why: str = ""

    def is_stale(self, now: int, health: str) -> bool:
        """Whether the value should not be trusted any more."""
        return self.state == "stale" or health == "lost" or now - self.t > STALE_US


@dataclass(slots=True)
class StopPicture:
    """A latched stop: since when, by whom, and who confirmed. `settled`: the host has decided.
    `unreached`: those of `missing` that were not connected.

    `parts` and `missing_parts`: of drivers that have several, which did and which did not.
    """

    t: int
    source: str
    confirmed: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    unreached: tuple[str, ...] = ()
    settled: bool = False
    parts: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing_parts: dict[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(slots=True)
class RecorderPicture:
    """The log's health; `level` is ok, warn, alarm, failed or unknown.

    `news`: more than the lag is different from what was said before.
    """

    level: str = "unknown"
    lag_us: int = 0
    path: str = ""
    detail: str = ""
    remedy: str = ""
    news: bool = True


@dataclass(slots=True)
class LastRun:
    """The run that backspace calls a mistake."""

    run: str
    action: str


@dataclass(slots=True)
class KnobsPicture:
    """A panel's knobs, sliders and buttons: where each stands (0..127), which of them do not count
    yet and where they will, which are lit, which moved last.
    """

    values: dict[str, int] = field(default_factory=dict)
    waiting: frozenset[str] = frozenset()
    targets: dict[str, int] = field(default_factory=dict)
    lit: frozenset[str] = frozenset()
    moved: str = ""


@dataclass(frozen=True, slots=True)
class RobotPicture:
    """A robot's settings as it has them: all `values`, what was `wanted` of those that are
    otherwise, and `conflicts` among them as sentences.
    """

    values: dict[str, Any] = field(default_factory=dict)
    wanted: dict[str, Any] = field(default_factory=dict)
    conflicts: tuple[str, ...] = ()

    @property
    def differing(self) -> tuple[str, ...]:
        """Names of settings that are not as they were asked for."""
        return tuple(self.wanted)
