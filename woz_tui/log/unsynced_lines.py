"""The lines of one file that may not be on the disk yet, kept so that they can be written again."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple


class UnsyncedLine(NamedTuple):
    """One line; `at_us` is when it was handed in, on the session's clock."""

    at_us: int
    line: bytes


class UnsyncedLines:
    """Lines in the order they came, numbered from 1, until the disk has confirmed them.

    At most `limit` bytes are held; beyond that the oldest line goes. While a file takes the lines
    that only means that it cannot be written a second time; while no file does, it is lost.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._entries: deque[UnsyncedLine] = deque()
        self._size = 0
        self._homeless = False
        self._forgotten = 0
        self._worst_us = 0
        self.last = 0
        self.synced = 0
        self.lost = 0

    def push(self, line: bytes, at_us: int) -> None:
        """Take one line in."""
        self._entries.append(UnsyncedLine(at_us, line))
        self._size += len(line)
        self.last += 1
        while self._size > self._limit:
            self._forget_oldest()

    def _forget_oldest(self) -> None:
        self._size -= len(self._entries.popleft().line)
        if self._homeless:
            self.lost += 1
        else:
            self._forgotten += 1

    def confirm(self, number: int, now_us: int) -> None:
        """Lines up to `number` are on the disk, as of now."""
        if number <= self.synced:
            return
        self._worst_us = max(self._worst_us, self.age_us(now_us))
        self.synced = number
        waiting = self.last - number
        while len(self._entries) > waiting:
            self._size -= len(self._entries.popleft().line)
        self._forgotten = min(self._forgotten, waiting - len(self._entries))

    def excuse(self, pause_us: int, now_us: int) -> None:
        """In a pause that has just ended nothing could reach the disk: it does not count."""
        self._worst_us = max(0, self._worst_us - pause_us)
        self._entries = deque(
            UnsyncedLine(min(entry.at_us + pause_us, now_us), entry.line) for entry in self._entries
        )

    def lose_home(self) -> None:
        """The file that took the lines failed: what memory has let go may be lost."""
        self.lost += self._forgotten
        self._forgotten = 0
        self._homeless = True

    def find_home(self) -> None:
        """A new file has taken everything that is held."""
        self._homeless = False

    def lines(self) -> list[bytes]:
        """Everything held, oldest first."""
        return [entry.line for entry in self._entries]

    @property
    def waiting(self) -> int:
        """How many lines are held."""
        return len(self._entries)

    def age_us(self, now_us: int) -> int:
        """Age of the oldest unconfirmed line, 0 if there is none."""
        return now_us - self._entries[0].at_us if self._entries else 0

    def take_worst_us(self, now_us: int) -> int:
        """The longest that a line had to wait since the last call, waiting ones included."""
        worst, self._worst_us = max(self._worst_us, self.age_us(now_us)), 0
        return worst
