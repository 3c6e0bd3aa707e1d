"""Values that go from place to place, each time from rest to rest."""

from __future__ import annotations

from woz_tui.motion.easing import ease

#: Places (seconds or beats, rising) and the values there.
Path = tuple[tuple[float, float], ...]


def along(path: Path, place: float) -> float:
    """The value at `place`, by minimum jerk; outside the path that of its nearer end."""
    before_place, before = path[0]
    for after_place, after in path:
        if place < after_place:
            if before_place == after_place:
                return after
            share = (place - before_place) / (after_place - before_place)
            return before + (after - before) * ease("minimum-jerk", share)
        before_place, before = after_place, after
    return before
