"""How actions, drivers and sensors are shown; times are microseconds on the session's `t` axis."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from woz_tui.protocol.sentence import Sentence

#: Readings older than this look stale even if nobody said so; those of a sensor that is seldom by
#: nature from so many of its periods on.
STALE_US, STALE_PERIODS = 2_000_000, 3


class ButtonState(enum.Enum):
    """How an action stands, as its button shows it."""

    READY = "ready"
    QUEUED = "queued"
    HELD = "held"
    RUNNING = "running"
    DONE = "done"
    SENT = "sent"
    WAITS = "waits"
    LEFT_OUT = "left_out"
    FAILED = "failed"
    REFUSED = "refused"
    STOPPED = "stopped"
    REPLACED = "replaced"
    LOCKED = "locked"
    UNREACHABLE = "unreachable"


@dataclass(frozen=True, slots=True)
class ButtonView:
    """An action's state at one moment.

    `left_us` is the time still to go, `share` (0..1) how much of the expected time has passed;
    both None while the driver has not said how long it takes; of what is held until it may answer
    a cue, the same until it begins. `note` is a word to go with the
    state: what is missing, why it was refused.
    """

    state: ButtonState
    left_us: int | None = None
    share: float | None = None
    note: str = ""

    @property
    def of_run(self) -> bool:
        """Whether it is that of a run, under way or over."""
        return self.state not in (ButtonState.READY, ButtonState.LOCKED, ButtonState.UNREACHABLE)


#: What is said of a sensor, for a screen; a driver may say anything else.
SENSOR_STATES: Mapping[str, Sentence] = {
    "ok": Sentence("meters.ok", "ok"),
    "stale": Sentence("meters.stale", "stale"),
    "speaking": Sentence("meters.speaking", "speaking"),
    "quiet": Sentence("meters.quiet", "quiet"),
    "silent": Sentence("meters.silent", "silent"),
    "clipping": Sentence("meters.clipping", "clipping"),
}


#: What stands for a reading: a distance by Hall's spaces, what is shown roughly, and what a robot
#: feels.
READING_WORDS: Mapping[str, Sentence] = {
    "intimate": Sentence("meters.intimate", "intimate"),
    "personal": Sentence("meters.personal", "personal"),
    "social": Sentence("meters.social", "social"),
    "public": Sentence("meters.public", "public"),
    "near": Sentence("meters.near", "near"),
    "far": Sentence("meters.far", "far"),
    "loud": Sentence("meters.loud", "loud"),
    "quiet": Sentence("meters.quiet", "quiet"),
    "free": Sentence("meters.free", "free"),
    "touched": Sentence("meters.touched", "touched"),
    "pressed": Sentence("meters.pressed", "pressed"),
    "no": Sentence("meters.says_no", "no"),
    "yes": Sentence("meters.says_yes", "yes"),
}


class DriverView(NamedTuple):
    """A driver's health: unknown, connecting, connected, lost or faulted; since `t`."""

    name: str
    health: str = "unknown"
    detail: str = ""
    remedy: str = ""
    t: int = 0


class SensorView(NamedTuple):
    """The last reading of one sensor and the last word about its state. `every`: microseconds from
    one reading to the next, where it is seldom; 0: nobody said.
    """

    name: str
    t: int
    value: float | None = None
    text: str = ""
    unit: str = ""
    driver: str = ""
    state: str = ""
    every: int = 0

    def is_stale(self, now: int, health: str) -> bool:
        """Whether the value should not be trusted any more."""
        limit = max(STALE_US, STALE_PERIODS * self.every)
        return self.state == "stale" or health == "lost" or now - self.t > limit
