"""The header of a WAV file whose samples come, or go, piece by piece."""

from __future__ import annotations

import struct

#: The length that a WAV file has whose end nobody knows.
_ENDLESS = 0x7FFFFF00
#: Bytes of a sample.
_WIDTH = 2


def endless_header(rate: int) -> bytes:
    """Of a WAV file without an end: S16_LE, one channel."""
    shape = struct.pack("<HHIIHH", 1, 1, rate, rate * _WIDTH, _WIDTH, 8 * _WIDTH)
    return (
        b"RIFF" + struct.pack("<I", _ENDLESS + 36) + b"WAVEfmt " + struct.pack("<I", len(shape))
        + shape + b"data" + struct.pack("<I", _ENDLESS)
    )  # fmt: skip


def is_wav(head: bytes | bytearray) -> bool:
    """Whether a WAV file begins like this."""
    return head[:4] == b"RIFF" and head[8:12] == b"WAVE"


def _chunk(head: bytes | bytearray, wanted: bytes) -> int | None:
    """Where the body of this chunk begins; None: not in what has come."""
    at = 12
    while at + 8 <= len(head):
        name, size = struct.unpack_from("<4sI", head, at)
        if name == wanted:
            return at + 8
        at += 8 + size + size % 2
    return None


def sound_begins(head: bytes | bytearray) -> int | None:
    """The byte at which a WAV file's samples begin; None: they have not come yet."""
    return _chunk(head, b"data")


def sound_length(head: bytes | bytearray) -> int:
    """The bytes of samples that a WAV file says to have; 0: it does not say."""
    at = sound_begins(head)
    return 0 if at is None else int(struct.unpack_from("<I", head, at - 4)[0])


def wav_shape(head: bytes | bytearray) -> tuple[int, int, int, int]:
    """Format tag, channels, rate and bits of a WAV file; zeros if it does not say."""
    at = _chunk(head, b"fmt ")
    if at is None or at + 16 > len(head):
        return 0, 0, 0, 0
    tag, channels, rate, _, _, bits = struct.unpack_from("<HHIIHH", head, at)
    return tag, channels, rate, bits
