"""WAV files: how long they are, and louder or softer copies of them.

The standard library's `wave` refuses float and extensible files and believes the length in the
header, which programs that write to a pipe cannot know.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from woz_drivers.sound import pcm_audio

#: What is below this share of a sound's loudest sample is silence in it.
_SILENT = 0.02

_PCM, _FLOAT, _EXTENSIBLE = 0x0001, 0x0003, 0xFFFE
_NAMES: Mapping[tuple[int, int], str] = {
    (_PCM, 8): "U8",
    (_PCM, 16): "S16_LE",
    (_PCM, 24): "S24_3LE",
    (_PCM, 32): "S32_LE",
    (_FLOAT, 32): "FLOAT_LE",
}


class NotWavError(ValueError):
    """Bytes that are no WAV file of a known kind; the text says why."""


@dataclass(frozen=True, slots=True)
class Wav:
    """Uncompressed sound: ALSA's name of the sample format, Hz, channels, PCM bytes."""

    format: str
    rate: int
    channels: int
    data: bytes

    @property
    def seconds(self) -> float:
        """How long it plays."""
        return len(self.data) / (self.rate * self.channels * pcm_audio.FORMATS[self.format].width)

    @property
    def shape(self) -> tuple[str, int, int]:
        """Format, rate and channels: sounds of one shape can follow each other."""
        return self.format, self.rate, self.channels

    def with_silence(self, seconds: float) -> Wav:
        """The same with so much silence behind it."""
        frames = np.zeros((round(seconds * self.rate), self.channels), np.float32)
        return Wav(*self.shape, self.data + pcm_audio.encode(frames, self.format))

    def at(self, volume: float) -> Wav:
        """The same at `volume`, 0 to 1."""
        samples = pcm_audio.decode(self.data, self.format, self.channels)
        data = pcm_audio.encode((samples * volume).astype(np.float32), self.format)
        return Wav(self.format, self.rate, self.channels, data)

    def without_end(self, keep: float) -> Wav:
        """The same without the silence at its end, but for `keep` seconds of it."""
        samples = pcm_audio.decode(self.data, self.format, self.channels)
        loud = np.flatnonzero(
            np.abs(samples).max(axis=1) > _SILENT * np.abs(samples).max(initial=0)
        )
        frame = pcm_audio.FORMATS[self.format].width * self.channels
        last = int(loud[-1]) + 1 if loud.size else 0
        data = self.data[: (last + round(keep * self.rate)) * frame]
        return Wav(self.format, self.rate, self.channels, data)

    def to_bytes(self) -> bytes:
        """A whole file with a plain header and true lengths."""
        width = pcm_audio.FORMATS[self.format].width
        tag = _FLOAT if pcm_audio.FORMATS[self.format].floating else _PCM
        frame = width * self.channels
        shape = struct.pack(
            "<HHIIHH", tag, self.channels, self.rate, self.rate * frame, frame, 8 * width
        )
        chunks = b"WAVEfmt " + struct.pack("<I", len(shape)) + shape
        padding = b"\0" * (len(self.data) % 2)
        chunks += b"data" + struct.pack("<I", len(self.data)) + self.data + padding
        return b"RIFF" + struct.pack("<I", len(chunks)) + chunks


def parse(content: bytes) -> Wav:
    """Read a WAV file; its sound may end earlier than the header says. Raises `NotWavError`."""
    if content[:4] != b"RIFF" or content[8:12] != b"WAVE":
        raise NotWavError("it is no WAV file")
    shape: tuple[str, int, int] | None = None
    position = 12
    while position + 8 <= len(content):
        name, size = struct.unpack_from("<4sI", content, position)
        body = content[position + 8 : position + 8 + size]
        if name == b"fmt ":
            shape = _shape(body)
        elif name == b"data":
            if shape is None:
                raise NotWavError("its sound comes before its format")
            format_, rate, channels = shape
            frame = pcm_audio.FORMATS[format_].width * channels
            return Wav(format_, rate, channels, body[: len(body) // frame * frame])
        position += 8 + size + size % 2
    raise NotWavError("it holds no sound")


def _shape(body: bytes) -> tuple[str, int, int]:
    if len(body) < 16:
        raise NotWavError("its format is cut off")
    tag, channels, rate, _, _, bits = struct.unpack_from("<HHIIHH", body)
    if tag == _EXTENSIBLE and len(body) >= 26:
        (tag,) = struct.unpack_from("<H", body, 24)
    name = _NAMES.get((tag, bits))
    if name is None or not channels or not rate:
        raise NotWavError(f"its sound is compressed or unusual (format {tag}, {bits} bits)")
    return name, rate, channels
