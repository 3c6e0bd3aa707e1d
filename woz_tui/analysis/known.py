"""What is known of robots' settings: the value of each, and how long it was other than asked for.

A driver tells its settings on a change (`settings.shown`), so what it told last holds. While its
robot is lost nothing is known of them: that is no difference.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

from woz_tui.core import messages as m
from woz_tui.core.messages import Json

Place = TypeVar("Place")
#: A setting, or a sentence about settings that work against each other.
Sort = Literal["setting", "conflict"]
#: Sort, driver, and the setting's name or the conflict's sentence.
Key = tuple[Sort, str, str]
#: Kinds of message that say something of robots' settings.
TELLING = (m.SettingsShown, m.DriverLost, m.DriverFaulted, m.DriverConnected)


@dataclass(frozen=True, slots=True)
class State:
    """What a robot has, and if it `differs`, what was asked for."""

    value: Json
    wanted: Json = None
    differs: bool = False


@dataclass(slots=True, kw_only=True)
class Stretch(Generic[Place]):
    """Time in which nothing changed about a setting, within one place of the session.

    Attributes:
        state: None: unknown from `begin` on.
        seq: The line with which this state began.
        begin: Microseconds on the axis of `t`, as is `end`.
        place: Participant, condition, trial: whatever whoever asks tells apart.
        changed: The state is another one than before; else only the place is.
        cut: The log ended before it did.
    """

    sort: Sort
    driver: str
    name: str
    state: State | None
    seq: int
    begin: int
    end: int
    place: Place
    changed: bool = True
    cut: bool = False

    @property
    def differs(self) -> bool | None:
        """Whether it was other than asked for; None: unknown."""
        return None if self.state is None else self.state.differs

    @property
    def lost(self) -> bool:
        """Whether nothing is known of it."""
        return self.state is None


class Known(Generic[Place]):
    """Takes messages in the order of the log; `over` are the stretches that have ended.

    Args:
        place: Where the session begins.
        kept: Which stretches are wanted; the others cost no memory.
    """

    def __init__(self, place: Place, kept: Callable[[Stretch[Place]], bool]) -> None:
        self._place = place
        self._kept = kept
        self._t = 0
        self._told: dict[str, m.SettingsShown] = {}
        #: Drivers whose robot is lost.
        self._away: set[str] = set()
        self._open: dict[Key, Stretch[Place]] = {}
        self.over: list[Stretch[Place]] = []

    @property
    def known(self) -> bool:
        """Whether any setting of any robot is known now."""
        return any(not each.lost for each in self._open.values() if each.sort == "setting")

    @property
    def differing(self) -> bool:
        """Whether any setting is known to be other than asked for now."""
        return any(each.differs for each in self._open.values())

    def take(self, message: m.Message, t: int, seq: int) -> None:
        """A line at `t`, which counts as no earlier than the one before."""
        self._t = max(self._t, t)
        match message:
            case m.SettingsShown():
                self._told[message.driver] = message
                # The line of its coming back may be missing, or later; a robot from which a
                # difference was read is there.
                if message.wanted:
                    self._away.discard(message.driver)
            case m.DriverLost() | m.DriverFaulted():
                self._away.add(message.driver)
            case m.DriverConnected():
                self._away.discard(message.driver)
            case _:
                return
        self._compare(message.driver, seq)

    def move(self, place: Place, t: int) -> None:
        """Another trial, condition or participant from `t` on: what lasts is begun anew there."""
        self._t = max(self._t, t)
        if place == self._place:
            return
        self._place = place
        for key, each in list(self._open.items()):
            if each.begin == self._t:
                each.place = place
                continue
            self._end(key)
            self._begin(key, each.state, each.seq, changed=False)

    def finish(self, t: int) -> None:
        """The log is over; what lasts is cut."""
        self._t = max(self._t, t)
        for key in list(self._open):
            self._end(key, cut=True)

    def _compare(self, driver: str, seq: int) -> None:
        """End what is not so any more, begin what is so now."""
        now = {} if driver in self._away else _states(self._told.get(driver))
        before = [key for key in self._open if key[1] == driver]
        for key in dict.fromkeys((*before, *now)):
            each, state = self._open.get(key), now.get(key)
            if each is not None and each.state == state:
                continue
            if each is not None:
                self._end(key)
            if state is not None or key[0] == "setting":  # that one is unknown is told, too
                self._begin(key, state, seq, changed=True)

    def _begin(self, key: Key, state: State | None, seq: int, *, changed: bool) -> None:
        sort, driver, name = key
        self._open[key] = Stretch(
            sort=sort,
            driver=driver,
            name=name,
            state=state,
            seq=seq,
            begin=self._t,
            end=self._t,
            place=self._place,
            changed=changed,
        )

    def _end(self, key: Key, *, cut: bool = False) -> None:
        each = self._open.pop(key)
        each.end, each.cut = self._t, cut
        if self._kept(each):
            self.over.append(each)


def _states(told: m.SettingsShown | None) -> Mapping[Key, State]:
    """All that a line says; nothing without a line."""
    if told is None:
        return {}
    driver = told.driver
    states: dict[Key, State] = {
        ("setting", driver, name): State(value) for name, value in told.values.items()
    }
    for name, wanted in told.wanted.items():
        states["setting", driver, name] = State(told.values.get(name), wanted, differs=True)
    for sentence in told.conflicts:
        states["conflict", driver, sentence] = State(sentence)
    return states


def worded(value: Json) -> str:
    """A setting's value in words: a text as it is, anything else as JSON has it."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
