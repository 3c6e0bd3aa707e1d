"""Robots' settings as they were read back: the value of each, and whether it is the wanted one.

A driver publishes its settings when they change (`settings.shown`), so its last message holds.
While its robot is lost nothing is known of them: that is no difference.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from msgspec.structs import replace

from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import (
    MOST_KEPT,
    ConflictEpisode,
    Episode,
    EpisodeOutcome,
    SettingEpisode,
    keep_latest,
)

#: A driver's settings by name, its conflicts by sentence.
_Key = tuple[type[Episode], str]


@dataclass(slots=True)
class RobotSettings:
    """What is known of robots' settings. Each method takes a message and returns the episodes that
    ended with it or began.

    Attributes:
        shown: The last message of each driver.
        lost: Drivers whose robot is lost, and the line that says so.
    """

    shown: dict[str, m.SettingsShown] = field(default_factory=dict)
    lost: dict[str, m.DriverHealth] = field(default_factory=dict)
    #: What showed that a robot is back, where no line said so.
    _back: dict[str, m.SettingsShown] = field(default_factory=dict)
    _open: dict[str, dict[_Key, SettingEpisode | ConflictEpisode]] = field(default_factory=dict)

    def copy(self) -> RobotSettings:
        """An independent copy."""
        held = {driver: dict(episodes) for driver, episodes in self._open.items()}
        return RobotSettings(dict(self.shown), dict(self.lost), dict(self._back), held)

    def of(self, driver: str) -> dict[str, SettingEpisode]:
        """The driver's settings by name as they are now; those of a lost robot are unknown."""
        found = self._open.get(driver, {})
        return {name: each for (_, name), each in found.items() if isinstance(each, SettingEpisode)}

    @property
    def lines(self) -> Iterator[m.Message]:
        """The messages from which a copy can be rebuilt, except for when each setting began."""
        yield from self.shown.values()
        yield from self.lost.values()
        yield from self._back.values()

    def open(self) -> Iterator[Episode]:
        """Episodes that have not ended."""
        for episodes in self._open.values():
            yield from episodes.values()

    def show(self, message: m.SettingsShown, t: int) -> Iterator[Episode]:
        """A driver publishes its robot's settings.

        The line of its coming back may be missing, or later: a robot from which a difference was
        read is there.
        """
        keep_latest(self.shown, message.driver, message)
        if message.wanted and self.lost.pop(message.driver, None) is not None:
            keep_latest(self._back, message.driver, message)
        if message.driver not in self.lost:
            yield from self._compare(message.driver, t, message.seq)

    def lose(self, message: m.DriverHealth, t: int) -> Iterator[Episode]:
        """A driver's robot is lost: its settings are unknown from now on."""
        if message.driver not in self.lost:
            keep_latest(self.lost, message.driver, message)
            self._back.pop(message.driver, None)
            yield from self._compare(message.driver, t, message.seq)

    def find(self, message: m.DriverConnected, t: int) -> Iterator[Episode]:
        """A robot is connected again: its last settings hold again."""
        if self.lost.pop(message.driver, None) is not None:
            yield from self._compare(message.driver, t, message.seq)

    def _compare(self, driver: str, t: int, seq: int) -> Iterator[Episode]:
        """Ends episodes that no longer hold, begins new ones."""
        now = {} if driver in self.lost else _open_episodes(self.shown.get(driver), t, seq)
        if driver not in self._open and len(self._open) >= MOST_KEPT:
            return
        before = self._open.setdefault(driver, {})
        for key in dict.fromkeys((*before, *now)):
            old, new = before.get(key), now.get(key)
            if new is None and key[0] is SettingEpisode:  # that it is unknown lasts, too
                new = SettingEpisode(begin=t, seq=seq, driver=driver, name=key[1], differs=None)
            if old is not None and new is not None and _same(old, new):
                continue
            if old is not None:
                lost = driver in self.lost
                yield replace(
                    old, end=t, outcome=EpisodeOutcome.LOST if lost else EpisodeOutcome.CHANGED
                )
                del before[key]
            if new is not None and len(before) < MOST_KEPT:
                before[key] = new
                yield new


def _same(one: SettingEpisode | ConflictEpisode, other: SettingEpisode | ConflictEpisode) -> bool:
    if isinstance(one, ConflictEpisode) or isinstance(other, ConflictEpisode):
        return True  # its sentence is its key
    return (one.differs, one.value, one.wanted) == (other.differs, other.value, other.wanted)


def _open_episodes(
    shown: m.SettingsShown | None, t: int, seq: int
) -> dict[_Key, SettingEpisode | ConflictEpisode]:
    """The settings and conflicts in a message; nothing without a message."""
    if shown is None:
        return {}
    driver, found = shown.driver, dict[_Key, SettingEpisode | ConflictEpisode]()
    for name in dict.fromkeys((*shown.values, *shown.wanted)):
        found[SettingEpisode, name] = SettingEpisode(
            begin=t,
            seq=seq,
            driver=driver,
            name=name,
            value=shown.values.get(name),
            wanted=shown.wanted.get(name),
            differs=name in shown.wanted,
        )
    for sentence in shown.conflicts:
        found[ConflictEpisode, sentence] = ConflictEpisode(
            begin=t, seq=seq, driver=driver, sentence=sentence
        )
    return found
