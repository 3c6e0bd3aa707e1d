"""Cuts a voice into what is said between two pauses. Free of input and output."""

from __future__ import annotations

import math
import sys
from array import array
from collections.abc import Iterator

from woz_tui.sensing.speech_endpoint import Endpointer, SpeechEnd

#: Frames a second of the voice (S16_LE, one channel), and bytes of a chunk of 20 ms.
RATE = 16_000
CHUNK = RATE // 50 * 2
#: In chunks: silence that ends a piece, what is kept before it, loud ones that begin it, and its
#: greatest length.
_HANG, _PRE, _ONSET, _LONGEST = 40, 15, 4, 1500


class SpeechPieces:
    """Pieces of a voice.

    Args:
        threshold: Louder than this RMS is speech, 0 to 1.
    """

    def __init__(self, threshold: float) -> None:
        self._ends = Endpointer(threshold, _HANG, _PRE, onset=_ONSET, longest=_LONGEST)
        self._bytes = bytearray()
        #: Chunks that a piece may still hold, the first of them by number.
        self._chunks: list[bytes] = []
        self._first = 0

    def add(self, data: bytes) -> Iterator[bytes]:
        """What ends with these bytes."""
        self._bytes += data
        while len(self._bytes) >= CHUNK:
            chunk = bytes(self._bytes[:CHUNK])
            del self._bytes[:CHUNK]
            self._chunks.append(chunk)
            ended = self._ends.judge(loudness(chunk))
            if isinstance(ended, SpeechEnd):
                yield self._cut(ended)
            gone = self._ends.earliest - self._first
            del self._chunks[:gone]
            self._first += gone

    def end(self) -> Iterator[bytes]:
        """What was being said when the voice ended."""
        ended = self._ends.close()
        if ended is not None:
            yield self._cut(ended)

    def _cut(self, ended: SpeechEnd) -> bytes:
        return b"".join(self._chunks[ended.first - self._first : ended.last + 1 - self._first])


def loudness(chunk: bytes) -> float:
    """RMS, 0 to 1."""
    samples = array("h", chunk)
    if sys.byteorder == "big":
        samples.byteswap()
    return math.sqrt(sum(value * value for value in samples) / len(samples)) / 32768
