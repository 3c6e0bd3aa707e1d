"""The files of one session: where they may lie, how they are called, how each of them begins."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path

from woz_tui.log.file_names import FileName, from_folder, session_code, without_home
from woz_tui.log.log_segment import OpenSegment
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Segment
from woz_tui.system.clock import Clock, timestamp

_MOST_NAMES = 10_000


class FileSeries:
    """Gives out names, each once. `places` are the folders in the order of preference."""

    def __init__(self, places: list[Path], stem: str, clock: Clock) -> None:
        self.places = places
        self._wanted = self._stem = stem
        self._clock = clock
        self._zero_us: int | None = None
        self._number = 1
        self._copies = 1

    def tie(self, now_us: int, t: int) -> None:
        """Learn where the session's `t` axis begins, from the first line that comes in."""
        if self._zero_us is None:
            self._zero_us = now_us - max(t, 0)

    def first_path(self, samples: bool) -> Path:
        """Where the session's first file belongs."""
        return self.places[0] / str(FileName(self._stem, 1, samples))

    def order(self, left: Path | None) -> list[Path]:
        """All places, the one that is being left last."""
        if left is None:
            return self.places
        return [place for place in self.places if place != left] + [left]

    def create(self, folder: Path, make: Callable[[FileName], OpenSegment]) -> OpenSegment:
        """New files in `folder` under the next name that is free there. Raises `OSError`."""
        for _ in range(_MOST_NAMES):
            try:
                new = make(FileName(self._stem, self._number))
            except FileExistsError:
                self._skip()
                continue
            if not new.samples_path.exists():
                return new
            new.discard()
            self._skip()
        raise FileExistsError(errno.EEXIST, "all file names are in use", str(folder))

    def _skip(self) -> None:
        """A name is taken: a session that has not begun takes another stem, a running one the
        next number.
        """
        if self._number > 1:
            self._number += 1
            return
        self._copies += 1
        self._stem = f"{self._wanted}-{self._copies}"

    def used(self) -> None:
        """The last name is taken for good."""
        self._number += 1

    def claim(self, samples: bool) -> FileName:
        """A name for a file that stands alone, such as the copy of a deleted one."""
        self.used()
        return FileName(self._stem, self._number - 1, samples)

    def header(
        self,
        path: Path,
        number: int,
        *,
        reason: str = "",
        previous: Path | None = None,
        copied: bool = False,
        next_file: Path | None = None,
        lost: tuple[int, int] = (0, 0),
    ) -> bytes:
        """The line with which the file `path` begins, or with `next_file` the one with which it
        ends; `lost` counts actions and samples.
        """
        now_us = self._clock.now_us()
        return codec.encode(
            Segment(
                t=-1 if self._zero_us is None else now_us - self._zero_us,
                ts=timestamp(self._clock.wall()),
                log=self._stem,
                session=session_code(self._stem),
                number=number,
                previous=from_folder(previous, path.parent) if previous else "",
                copied=copied,
                next_file=without_home(next_file) if next_file else "",
                reason=reason,
                dropped=lost[0],
                dropped_samples=lost[1],
            )
        )
