"""For how long how many people were there, by the readings of `people`."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from woz_tui.analysis.figures import PeopleRow
from woz_tui.protocol import messages as m

#: What a sensor that counts people is called, with or without its robot.
PEOPLE = "people"
#: A reading holds until the next one, but no longer than this, in microseconds.
HOLDS_US = 2_000_000


class PeopleTimes:
    """Takes samples in their order."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[int, int]] = {}
        self._us: dict[tuple[str, int], int] = defaultdict(int)

    def add(self, sample: m.Message) -> None:
        """The next sample."""
        if not isinstance(sample, m.Reading) or sample.sensor.rpartition(".")[2] != PEOPLE:
            return
        before = self._last.pop(sample.sensor, None)
        if before is not None:
            began, people = before
            self._us[sample.sensor, people] += max(0, min(sample.t - began, HOLDS_US))
        if sample.value is not None and sample.value >= 0:
            self._last[sample.sensor] = (sample.t, round(sample.value))

    def rows(self) -> Iterator[PeopleRow]:
        """By sensor and number of people."""
        for (sensor, people), us in sorted(self._us.items()):
            yield PeopleRow(sensor, people, us)
