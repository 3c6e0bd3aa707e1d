"""Sound as numbers: PCM bytes to samples, samples to loudness. Free of any input or output.

Samples are float32 arrays of shape (frames, channels), full scale -1 to 1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Samples = npt.NDArray[np.float32]

#: From this fraction of full scale on, a sample counts as clipped.
CLIPPED = 0.999


@dataclass(frozen=True, slots=True)
class SampleFormat:
    """A sample format: `width` in bytes, whether it is a float, byte order, sign, used bits."""

    width: int
    dtype: str
    bits: int
    unsigned: bool = False
    floating: bool = False


#: Sample formats under ALSA's names. 24 bits come packed (S24_3LE) or in the low three bytes of
#: four (S24_LE).
FORMATS: Mapping[str, SampleFormat] = {
    "U8": SampleFormat(1, "<u1", 8, unsigned=True),
    "S8": SampleFormat(1, "<i1", 8),
    "S16_LE": SampleFormat(2, "<i2", 16),
    "S16_BE": SampleFormat(2, ">i2", 16),
    "S24_3LE": SampleFormat(3, "<u1", 24),
    "S24_LE": SampleFormat(4, "<i4", 24),
    "S32_LE": SampleFormat(4, "<i4", 32),
    "FLOAT_LE": SampleFormat(4, "<f4", 32, floating=True),
}


def decode(data: bytes, name: str, channels: int) -> Samples:
    """PCM bytes as samples of shape (frames, channels); an unfinished frame at the end is left
    out. In float PCM, NaN becomes 0 and what exceeds full scale is cut off.
    """
    form = FORMATS[name]
    frame = form.width * channels
    whole = data[: len(data) // frame * frame]
    integers = _packed_24(whole) if form.width == 3 else np.frombuffer(whole, dtype=form.dtype)
    if form.floating:
        samples = np.clip(np.nan_to_num(integers.astype(np.float32), nan=0.0), -1.0, 1.0)
    else:
        if form.width == 4 and form.bits == 24:
            integers = (integers << 8) >> 8  # the top byte holds anything
        half = 2.0 ** (form.bits - 1)
        offset = half if form.unsigned else 0.0
        samples = ((integers - offset) / half).astype(np.float32)
    return samples.reshape(-1, channels)


def encode(samples: Samples, name: str) -> bytes:
    """The reverse of `decode`; louder than full scale is cut off."""
    form = FORMATS[name]
    limited = np.clip(samples, -1.0, 1.0).reshape(-1).astype(np.float64)
    if form.floating:
        return limited.astype(form.dtype).tobytes()
    half = 2.0 ** (form.bits - 1)
    integers = np.minimum(np.rint(limited * half), half - 1).astype(np.int64)
    if form.unsigned:
        integers = integers + int(half)
    if form.width == 3:
        return integers.astype("<i4").view(np.uint8).reshape(-1, 4)[:, :3].tobytes()
    return integers.astype(form.dtype).tobytes()


def one_channel(samples: Samples, channel: int) -> Samples:
    """Channel number `channel`, counted from 1; 0: the mean of all. Shape (frames,)."""
    if channel:
        chosen: Samples = samples[:, channel - 1]
        return chosen
    mixed: Samples = samples.mean(axis=1, dtype=np.float32)
    return mixed


def rms(samples: Samples) -> float:
    """Root of the mean square about the mean, 0 to 1 of full scale (a full-scale square wave is 1).

    What does not change makes no sound: some converters add a constant.
    """
    if samples.size == 0:
        return 0.0
    flat = samples.reshape(-1)
    flat = flat - flat.mean(dtype=np.float64).astype(np.float32)
    return min(1.0, math.sqrt(float(np.dot(flat, flat)) / flat.size))


def clipped(samples: Samples) -> int:
    """How many samples stand at full scale."""
    return int(np.count_nonzero(np.abs(samples) >= CLIPPED))


def decibels(level: float) -> float:
    """A level (0 to 1 of full scale) in dB of full scale; silence is -120."""
    return max(-120.0, 20.0 * math.log10(level)) if level > 0 else -120.0


def _packed_24(data: bytes) -> npt.NDArray[np.int32]:
    """Three bytes a sample, put into the upper three of four and shifted down with their sign."""
    wide = np.zeros((len(data) // 3, 4), dtype=np.uint8)
    wide[:, 1:] = np.frombuffer(data, dtype=np.uint8).reshape(-1, 3)
    shifted: npt.NDArray[np.int32] = wide.view("<i4").reshape(-1) >> 8
    return shifted
