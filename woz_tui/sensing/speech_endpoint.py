"""Finds where speech begins and ends, counted in chunks of sound; free of clock and files.

After section 2.2 of Maniscalco, Storniolo and Messina (Int. J. of Social Robotics 14, 2022, doi
10.1007/s12369-021-00855-w): a chunk is loud or not by its RMS; the segment that is kept begins
earlier than the first loud chunk (pre-roll) and takes the trailing silence along (hang-over). The
microphone's driver and the engagement model use this one object, live and from a log.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SpeechStart:
    """Somebody speaks: the segment's first chunk, pre-roll included. Chunks count from 0."""

    first: int


@dataclass(frozen=True, slots=True)
class SpeechEnd:
    """They have stopped: first and last chunk, both of the segment. `cut`: they speak on, but it
    was `longest` chunks long.
    """

    first: int
    last: int
    cut: bool = False


class Endpointer:
    """Finds segments of speech in the loudness of chunk after chunk.

    A chunk is loud if its RMS lies strictly above the threshold; NaN and None are quiet. `onset`
    loud chunks in a row begin speech (1: each does). The segment's first chunk is then
    max(last of the previous segment + 1, first of the loud ones - `pre`). `hang` quiet chunks in a
    row end it with the last of them, and no later than with its chunk number `longest`; who speaks
    on after that begins the next segment at once. Speech still open at the end has no end.

    Raises:
        ValueError: `hang` or `onset` below 1, `pre` below 0, or `longest` so short that a
            segment would have to end before it has begun.
    """

    def __init__(
        self, threshold: float, hang: int, pre: int, *, onset: int = 1, longest: int | None = None
    ) -> None:
        if hang < 1 or onset < 1 or pre < 0:
            raise ValueError(f"no such segments: hang={hang}, pre={pre}, onset={onset}")
        if longest is not None and longest <= pre + onset:
            raise ValueError(f"longest={longest} must exceed pre={pre} and onset={onset} together")
        self.threshold = threshold
        self._hang = hang
        self._pre = pre
        self._onset = onset
        self._longest = longest
        #: How many chunks were taken: the number of the next one.
        self.chunks = 0
        self._free = 0
        self._loud = 0
        self._quiet = 0
        self._first: int | None = None

    @property
    def speaks(self) -> bool:
        """Whether a segment is open."""
        return self._first is not None

    @property
    def first(self) -> int | None:
        """The open segment's first chunk."""
        return self._first

    @property
    def earliest(self) -> int:
        """The first chunk that a segment may still hold: those before it can be forgotten."""
        if self._first is not None:
            return self._first
        return max(self._free, self.chunks - self._loud - self._pre, 0)

    def judge(self, rms: float | None) -> SpeechStart | SpeechEnd | None:
        """Judge the next chunk; what begins or ends with it."""
        number = self.chunks
        self.chunks += 1
        if rms is not None and rms > self.threshold:
            self._loud += 1
            self._quiet = 0
        else:
            self._loud = 0
            self._quiet += 1
        if self._first is None:
            if self._loud < self._onset:
                return None
            self._first = max(self._free, number - self._loud + 1 - self._pre, 0)
            self._quiet = 0
            return SpeechStart(self._first)
        if self._quiet >= self._hang:
            return self._end(self._first, number, cut=False)
        if self._longest is not None and number - self._first + 1 >= self._longest:
            return self._end(self._first, number, cut=True)
        return None

    def split(self, last: int) -> tuple[SpeechEnd, SpeechStart]:
        """End the open segment with its chunk `last`: what came after it begins the next one."""
        first, quiet = self._first, self._quiet
        if first is None or not first <= last < self.chunks:
            raise ValueError(f"no open segment has a chunk {last}")
        ended = self._end(first, last, cut=True)
        self._first, self._quiet = last + 1, quiet
        return ended, SpeechStart(last + 1)

    @property
    def goes_on(self) -> bool:
        """Whether as many chunks as begin speech were loud just now."""
        return self._loud >= self._onset

    def close(self) -> SpeechEnd | None:
        """The sound breaks off: an open segment ends with the last chunk there was."""
        if self._first is None:
            return None
        self._loud = 0
        return self._end(self._first, self.chunks - 1, cut=True)

    def _end(self, first: int, last: int, *, cut: bool) -> SpeechEnd:
        self._first = None
        self._free = last + 1
        return SpeechEnd(first, last, cut)
