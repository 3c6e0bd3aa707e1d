"""For how long how many people were there, by the readings of `people`, and who was addressed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator

from woz_tui.analysis.figures import AddressedRow, PeopleRow
from woz_tui.protocol import messages as m

#: What a sensor that counts people is called, with or without its robot; and one that tells the
#: name (as text) of the face whose number is the value.
PEOPLE, NAME = "people", "identity.face"
#: A reading holds until the next one, but no longer than this, in microseconds.
HOLDS_US = 2_000_000


class PeopleTimes:
    """Takes all messages of a session in their order."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[int, int]] = {}
        self._us: dict[tuple[str, int], int] = defaultdict(int)
        self._addressed: dict[str, m.AddressedChanged] = {}
        #: By driver and face: by the rule, and by hand.
        self._addressed_us: dict[tuple[str, int], dict[str, int]] = {}
        self._names: dict[tuple[str, int], str] = {}
        self._now_us = 0

    def add(self, message: m.Message) -> None:
        """The next message; readings of sensors that nobody `takes` may be left out."""
        self.now(message.t)
        if isinstance(message, m.AddressedChanged):
            self._end(message.driver)
            self._addressed[message.driver] = message
        elif isinstance(message, m.Reading) and (take := self.takes(message.sensor)):
            take(message)

    def now(self, t: int) -> None:
        """The session went on at least to this moment."""
        self._now_us = max(self._now_us, t)

    def takes(self, sensor: str) -> Callable[[m.Reading], None] | None:
        """What takes the readings of a sensor; None: nothing does."""
        if _is(sensor, NAME):
            return self._name
        return self._count if _is(sensor, PEOPLE) else None

    def _name(self, sample: m.Reading) -> None:
        if sample.text and sample.value is not None:
            self._names[sample.driver, round(sample.value)] = sample.text

    def _count(self, sample: m.Reading) -> None:
        before = self._last.pop(sample.sensor, None)
        if before is not None:
            began, people = before
            self._us[sample.sensor, people] += max(0, min(sample.t - began, HOLDS_US))
        if sample.value is not None and sample.value >= 0:
            self._last[sample.sensor] = (sample.t, round(sample.value))

    def _end(self, driver: str) -> None:
        """The face that this driver saw is addressed no longer, or not in the same way."""
        before = self._addressed.pop(driver, None)
        if before is not None and before.face is not None:
            times = self._addressed_us.setdefault((driver, before.face), {"rule": 0, "hand": 0})
            times["hand" if before.chosen == "hand" else "rule"] += max(0, self._now_us - before.t)

    def rows(self) -> Iterator[PeopleRow]:
        """By sensor and number of people."""
        for (sensor, people), us in sorted(self._us.items()):
            yield PeopleRow(sensor, people, us)

    def addressed_rows(self) -> Iterator[AddressedRow]:
        """By driver and face; who is addressed at the end is so until the last message."""
        for driver in [*self._addressed]:
            self._end(driver)
        for (driver, face), us in sorted(self._addressed_us.items()):
            name = self._names.get((driver, face), "")
            yield AddressedRow(driver, face, name, us["rule"], us["hand"])


def _is(sensor: str, name: str) -> bool:
    """Whether a sensor is this one, of whichever robot."""
    return sensor == name or sensor.endswith(f".{name}")
