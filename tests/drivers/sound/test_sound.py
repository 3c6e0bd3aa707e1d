"""PCM in every format, levels, WAV files, and when somebody speaks."""

from __future__ import annotations

import math
import struct
import wave
from io import BytesIO

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from woz_drivers.microphone.speech_detection import BLOCK_S, SpeechCriteria, SpeechDetector
from woz_drivers.programs.byte_stream import ChunkCutter
from woz_drivers.sound import pcm_audio
from woz_drivers.sound.pcm_audio import FORMATS, Samples
from woz_drivers.sound.room_threshold import room_noise
from woz_drivers.sound.wav import NotWavError, Wav, parse

NAMES = st.sampled_from(sorted(FORMATS))
SAMPLES = arrays.arrays(
    np.float32,
    st.tuples(st.integers(0, 40), st.integers(1, 4)),
    elements=st.floats(-1, 1, width=32),
)


@pytest.mark.parametrize(
    ("name", "data", "expected"),
    [
        ("U8", b"\x00\x80\xff", [-1.0, 0.0, 127 / 128]),
        ("S8", b"\x80\x00\x7f", [-1.0, 0.0, 127 / 128]),
        ("S16_LE", struct.pack("<3h", -32768, 0, 16384), [-1.0, 0.0, 0.5]),
        ("S16_BE", struct.pack(">3h", -32768, 0, 16384), [-1.0, 0.0, 0.5]),
        ("S24_3LE", b"\x00\x00\x80\x00\x00\x40\xff\xff\xff", [-1.0, 0.5, -(2.0**-23)]),
        ("S24_LE", b"\x00\x00\x80\x77\x00\x00\x40\x77", [-1.0, 0.5]),
        ("S32_LE", struct.pack("<2i", -(2**31), 2**30), [-1.0, 0.5]),
        ("FLOAT_LE", struct.pack("<3f", 0.25, math.nan, math.inf), [0.25, 0.0, 1.0]),
    ],
)
def test_every_format(name: str, data: bytes, expected: list[float]) -> None:
    assert pcm_audio.decode(data, name, 1)[:, 0].tolist() == pytest.approx(expected)


@given(SAMPLES, NAMES)
def test_what_is_encoded_is_decoded(samples: Samples, name: str) -> None:
    again = pcm_audio.decode(pcm_audio.encode(samples, name), name, samples.shape[1])
    assert again.shape == samples.shape
    assert np.abs(again - samples).max(initial=0) <= 2.0 ** -(min(FORMATS[name].bits, 23) - 1)


@given(st.binary(max_size=200), NAMES, st.integers(1, 4))
def test_any_bytes_have_a_level(data: bytes, name: str, channels: int) -> None:
    samples = pcm_audio.decode(data, name, channels)
    assert samples.shape[1] == channels
    assert 0.0 <= pcm_audio.rms(pcm_audio.one_channel(samples, 0)) <= 1.0


@given(arrays.arrays(np.float32, st.integers(1, 400), elements=st.floats(-1, 1, width=32)))
def test_level_is_the_root_of_the_mean_square_of_what_changes(samples: Samples) -> None:
    mean = math.fsum(map(float, samples)) / len(samples)
    exact = math.sqrt(math.fsum((float(x) - mean) ** 2 for x in samples) / len(samples))
    assert pcm_audio.rms(samples) == pytest.approx(exact, rel=1e-4, abs=1e-6)


def test_channels_are_chosen_or_mixed() -> None:
    samples = np.array([[0.5, -0.5], [1.0, 0.0]], np.float32)
    assert pcm_audio.one_channel(samples, 2).tolist() == [-0.5, 0.0]
    assert pcm_audio.one_channel(samples, 0).tolist() == [0.0, 0.5]


def test_decibels() -> None:
    assert pcm_audio.decibels(1.0) == 0
    assert pcm_audio.decibels(0.1) == pytest.approx(-20)
    assert pcm_audio.decibels(0.0) == -120


@given(st.binary(max_size=300), st.integers(1, 50), st.lists(st.integers(0, 300), max_size=10))
def test_blocks_do_not_depend_on_how_the_stream_is_split(
    data: bytes, size: int, cuts: list[int]
) -> None:
    got: list[bytes] = []
    blocks = ChunkCutter(size, got.append)
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    for start, end in zip(edges, edges[1:], strict=False):  # noqa: RUF007 - reads better here
        blocks.feed(data[start:end])
    assert got == [data[i : i + size] for i in range(0, len(data) // size * size, size)]


# -- speaking ----------------------------------------------------------------------------------

EAR = SpeechCriteria(
    threshold=0.1, onset=2 * BLOCK_S, hang_over=3 * BLOCK_S, silent_after=4 * BLOCK_S
)


def states(levels: list[float], ear: SpeechCriteria = EAR) -> str:
    """The first letter of the state after each block: quiet, speaking, clipping, mute (silent)."""
    one = SpeechDetector(ear)
    found = ""
    for level in levels:
        one.judge(np.tile(np.array([level, -level], np.float32), 160))
        found += "m" if one.state == "silent" else one.state[0]
    return found


def test_speech_begins_after_the_onset_and_ends_after_the_hang_over() -> None:
    loud, low = 0.5, 0.05
    assert states([low, loud, low, loud, loud, low, low, loud, low, low, low]) == "qqqqssssssq"


def test_exactly_the_threshold_is_quiet() -> None:
    assert states([0.125] * 3, SpeechCriteria(0.125, 0, 0, 1)) == "qqq"


def test_only_zeros_are_a_silent_microphone_and_any_noise_is_not() -> None:
    assert states([0, 0, 0, 0, 0.0001]) == "qqqmq"


def test_clipping_is_shown_for_a_second_of_speech() -> None:
    assert states([0.5, 1.0, 0.5]) == "qcc"
    assert states([0.5, 1.0] + [0.5] * 50)[-2:] == "cs"


def test_a_room_is_learned() -> None:
    room = room_noise([0.01, 0.03])
    assert (room.mean, room.sd, room.loudest, room.blocks) == pytest.approx((0.02, 0.01, 0.03, 2))
    assert room.threshold(4) == pytest.approx(0.06)
    assert room_noise([0.0]).threshold(4) == 0.001
    assert room_noise([1.0, 0.0]).threshold(4) == 0.9


# -- WAV files ---------------------------------------------------------------------------------


@given(SAMPLES, st.sampled_from(["U8", "S16_LE", "S24_3LE", "S32_LE", "FLOAT_LE"]))
def test_a_wav_file_is_read_as_it_was_written(samples: Samples, name: str) -> None:
    one = Wav(name, 22050, samples.shape[1], pcm_audio.encode(samples, name))
    assert parse(one.to_bytes()) == one


def test_the_standard_library_reads_our_files_the_same() -> None:
    data = struct.pack("<4h", 1, -2, 3, -4)
    with wave.open(BytesIO(Wav("S16_LE", 8000, 2, data).to_bytes())) as file:
        assert file.getparams()[:4] == (2, 2, 8000, 2)
        assert file.readframes(10) == data


def test_a_length_that_nobody_knew_is_what_is_there() -> None:
    content = bytearray(Wav("S16_LE", 8000, 1, bytes(16000)).to_bytes())
    content[40:44] = b"\x00\xf0\xff\x7f"  # as espeak-ng --stdout writes it
    assert parse(bytes(content)).seconds == 1.0


def test_volume() -> None:
    one = Wav("S16_LE", 8000, 1, struct.pack("<2h", 20000, -20000))
    assert struct.unpack("<2h", one.at(0.5).data) == (10000, -10000)
    assert one.at(0.0).data == bytes(4)


@given(st.binary(max_size=100), st.integers(0, 60), st.binary(max_size=8))
def test_broken_files_are_no_wav_and_nothing_worse(noise: bytes, at: int, patch: bytes) -> None:
    whole = Wav("S16_LE", 8000, 1, bytes(20)).to_bytes()
    for content in (noise, whole[:at] + patch + whole[at + len(patch) :]):
        try:
            assert parse(content).seconds >= 0
        except NotWavError as error:
            assert str(error)
