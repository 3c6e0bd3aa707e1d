"""Settings that work against each other, or against the wizard, in sentences."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Collection, Iterator, Mapping

from woz_tui.core.clock import Clock
from woz_tui.core.driver import Lost, Rejected
from woz_tui.core.messages import Json

#: Closer than this the robot touches what it passes, in metres; 0.1 is what NAOqi begins with.
NEAR_M = 0.1
#: States of autonomous life in which the robot begins things by itself.
BUSY = ("solitary", "interactive")
STEERS_HEAD = ("gaze", "nudge")
GESTURES = ("play", "pose")
#: What the wizard did longer ago than this, in seconds, nothing works against any more.
RECENT_S = 60.0


class Uses:
    """Which verbs the wizard uses: those under way, and those that ended within `RECENT_S`.

    So a sentence about a verb, once told, stays for a minute at least, and goes only after a minute
    without that verb: what a wizard does again and again leaves the status line alone.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._going: Counter[str] = Counter()
        self._ended_us: dict[str, int] = {}

    @contextlib.contextmanager
    def of(self, verb: str) -> Iterator[None]:
        """While it is carried out. What was refused, or found no robot, was not used."""
        self._going[verb] += 1
        used = True
        try:
            yield
        except (Rejected, Lost):
            used = False
            raise
        finally:
            self._going[verb] -= 1
            if used:
                self._ended_us[verb] = self._clock.now_us()

    def now(self) -> frozenset[str]:
        """The verbs that count at this moment."""
        since = self._clock.now_us() - round(RECENT_S * 1_000_000)
        recent = (verb for verb, ended in self._ended_us.items() if ended > since)
        return frozenset((*(+self._going), *recent))


def conflicts(
    values: Mapping[str, Json], used: Collection[str], asked: Mapping[str, Json] | None = None
) -> list[str]:
    """What may surprise the wizard.

    Args:
        values: Settings as the robot has them; what is missing is unknown and no conflict.
        used: Verbs that the wizard uses (`Uses.now`). What may hurt somebody, or keeps the robot
            from obeying, does not depend on them.
        asked: Settings that the file or the wizard asked for.
    """
    # What may hurt somebody or keeps the robot from obeying comes first: a console with little room
    # shows the first ones.
    said = [*_distances(values), *_asleep(values), *_head(values, used), *_arms(values, used)]
    eyes = _blinks(values, asked or {}) or _eyes(values, used)
    return [*said, *eyes, *_life(values)]


def _life(values: Mapping[str, Json]) -> list[str]:
    state = values.get("state")
    if state in BUSY:
        return [f"autonomous life is {state}: the robot moves and talks by itself"]
    if state == "safeguard":
        return ["autonomous life is safeguard: the robot protects itself and may not obey"]
    return []


def _asleep(values: Mapping[str, Json]) -> list[str]:
    if values.get("awake") is not False or values.get("state") in (*BUSY, "safeguard"):
        return []
    return ["the motors are off: nothing moves until the robot is woken up"]


def _head(values: Mapping[str, Json], used: Collection[str]) -> list[str]:
    if not any(verb in used for verb in STEERS_HEAD):
        return []
    said = []
    if values.get("awareness") is True:
        said.append("awareness turns the head away from where the wizard has turned it")
    if _breathes(values, "head_breathing"):
        said.append("the head breathes while the wizard turns it")
    return said


def _arms(values: Mapping[str, Json], used: Collection[str]) -> list[str]:
    said = []
    if any(verb in used for verb in GESTURES) and _breathes(values, "arms_breathing"):
        said.append("the arms breathe: animations and poses begin and end with a jerk")
    if "say" in used and values.get("speaking_movement") is True:
        said.append("speaking movement adds gestures of its own to those in a sentence's tags")
    return said


def _eyes(values: Mapping[str, Json], used: Collection[str]) -> list[str]:
    if "eyes" in used and values.get("blinking") is True:
        return ["blinking darkens the eyes now and then, whatever their colour"]
    return []


def _blinks(values: Mapping[str, Json], asked: Mapping[str, Json]) -> list[str]:
    """The example of WoZ4U's paper. Where nobody asked for it, nobody waits for it either."""
    state = values.get("state")
    if not (values.get("blinking") is True and asked.get("blinking") is True):
        return []
    if state in (None, "interactive"):
        return []
    return [f"a Pepper blinks only while autonomous life is interactive, not {state}"]


def _distances(values: Mapping[str, Json]) -> list[str]:
    said = []
    for name in ("tangential", "orthogonal"):
        metres = values.get(name)
        if isinstance(metres, int | float) and not isinstance(metres, bool) and metres < NEAR_M:
            said.append(f"the {name} security distance is {metres:g} m: the robot may hit people")
    return said


def _breathes(values: Mapping[str, Json], part: str) -> bool:
    return values.get(part) is True or values.get("body_breathing") is True
