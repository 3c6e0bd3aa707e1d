"""A session's log to go about in: what was at a moment, and what came between two moments.

    with LogIndex.open(path) as log:
        log.length_us                     # how long the session was
        log.actions                       # every message but samples, in order of `seq`
        log.damage.sentences()            # what was wrong with the files
        state = log.at(t_us)              # state.readings["distance"].value, state.shown
        for message in log.between(t_us, t_us + 50_000):
            ...                           # actions and samples, in order of `seq`

Actions are in memory. Samples stay on the disk (`woz_tui.log.sample_blocks`) and are read when they
are asked for.
"""

from __future__ import annotations

import heapq
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from woz_tui.log.damage import Damage
from woz_tui.log.line_order import count_falls, seq_of, t_of
from woz_tui.log.log_files import LogFiles, files_of
from woz_tui.log.log_scan import LogScan, scan
from woz_tui.log.message_stream import LogItem
from woz_tui.log.sample_blocks import SampleBlocks, SampleState, in_steady_series
from woz_tui.log.samples_index import StaleIndexError

__all__ = ["LogIndex", "SampleState"]

#: Bytes of samples that are decoded to find one moment: a second and more of four at 100 Hz.
_BLOCK = 1 << 16


class LogIndex:
    """The log of a session, opened. Made by `open`; used by one thread at a time.

    Attributes:
        actions: Every message that is no sample, in order of `seq`, in memory. What this version
            does not know or cannot take is there as its `Line`.
        damage: What was wrong with the files; the same as `woz_tui.log.log_reader.read` says.
        no_end: What it may mean if no message says that the session ended.
        length_us: The last moment of the session, in microseconds since it began; 0 if the log is
            empty.
    """

    def __init__(self, found: LogScan, files: ExitStack, log: LogFiles, block: int) -> None:
        self.actions: list[LogItem] = found.actions
        self.damage: Damage = found.damage
        self.no_end = log.no_end()
        self._files = files
        self._log, self._block = log, block
        self._samples = SampleBlocks(found.blocks)
        self._times = list(map(t_of, self.actions))
        self._straight = not count_falls(self._times)
        self.length_us = max(0, self._samples.last_us, _last(self._times))

    @classmethod
    def open(cls, path: Path, *, places: Iterable[Path] | None = None, block: int = _BLOCK) -> Self:
        """Open the session to which `path` belongs; any of its files will do.

        A log that is still being written is opened as far as it has got. `block`: bytes of samples
        that are read at once when they are needed. Raises what `woz_tui.log.log_reader.files_of`
        raises; nothing damaged raises, now or later.
        """
        with ExitStack() as files:
            log = files_of(path, places)
            found = scan(log, files, block)
            found.damage.lacks(log.missing)
            return cls(found, files.pop_all(), log, block)

    def at(self, t_us: int) -> SampleState:
        """The last reading of each sensor, and the engagement model, at `t_us` (included), however
        long ago they spoke.
        """
        try:
            return self._samples.at(t_us)
        except StaleIndexError:
            self._scan_again()
            return self._samples.at(t_us)

    def between(self, after_us: int, until_us: int) -> Iterator[LogItem]:
        """Every message with `after_us` < t <= `until_us`, in order of `seq`.

        They are read while one goes through them. `after_us` -1 includes the very first.
        """
        actions = self.actions_between(after_us, until_us)
        samples = self.samples_between(after_us, until_us)
        return heapq.merge(actions, samples, key=seq_of) if actions else samples

    def samples_between(self, after_us: int, until_us: int) -> Iterator[LogItem]:
        """Those of `between` that are samples."""
        last = -1
        while True:
            try:
                for items in self._samples.between(after_us, until_us):
                    yield from (item for item in items if item.seq > last)
                    last = items[-1].seq
            except StaleIndexError:
                self._scan_again()
            else:
                return

    def _scan_again(self) -> None:
        """The index of the samples was wrong: everything from the log itself."""
        found = scan(self._log, self._files, self._block, indexed=False)
        found.damage.lacks(self._log.missing)
        self.damage = found.damage
        self._samples = SampleBlocks(found.blocks)

    def actions_between(self, after_us: int, until_us: int) -> list[LogItem]:
        """Those of `actions` with `after_us` < t <= `until_us`."""
        if self._straight:
            first = bisect_right(self._times, after_us)
            return self.actions[first : bisect_right(self._times, until_us, first)]
        return [each for each in self.actions if after_us < each.t <= until_us]

    def close(self) -> None:
        """Close the files; `actions` stay."""
        self._files.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _last(times: list[int]) -> int:
    """The latest of these times, but for wild ones."""
    fits = in_steady_series([(t, t) for t in times])
    return max((t for t, fit in zip(times, fits, strict=True) if fit), default=-1)
