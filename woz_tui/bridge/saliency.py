"""Which place is looked at, of those that several programs call salient; arithmetic, no clock.

Source: the node ram_hmmm of ArticulatedSocialAgentsPlatform/UTRobotics.
"""

from __future__ import annotations

from collections.abc import Iterable

from woz_tui.bridge.topic_table import MIDDLE, SalientPlace

#: A program that says nothing for so long is gone, and its places with it, in seconds.
SILENCE_S = 5.0


class SaliencyMap:
    """The places of each program, and when it last spoke (seconds of any clock)."""

    def __init__(self) -> None:
        self._places: dict[str, tuple[float, tuple[SalientPlace, ...]]] = {}
        self._chosen = MIDDLE

    def put(self, program: str, places: Iterable[SalientPlace], now: float) -> None:
        """All that is salient to a program at this moment."""
        self._places[program] = (now, tuple(places))

    def chosen(self, now: float) -> SalientPlace:
        """The heaviest place; of equally heavy ones that which is nearest to the last one."""
        self._places = {
            program: entry for program, entry in self._places.items() if now - entry[0] < SILENCE_S
        }
        last = self._chosen
        places = [place for _, each in self._places.values() for place in each if place.weight > 0]
        self._chosen = min(
            places,
            key=lambda one: (-one.weight, abs(one.x - last.x) + abs(one.y - last.y)),
            default=MIDDLE,
        )
        return self._chosen
