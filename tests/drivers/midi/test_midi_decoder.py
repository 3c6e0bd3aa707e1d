"""The decoder of raw MIDI bytes."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.midi.wire import (
    MidiDecoder,
    MidiMessage,
    control_change,
    note_on,
)
from woz_drivers.panels.control_functions import control_place, control_value

DATA = st.integers(0, 127)


def decoded(data: bytes) -> list[MidiMessage]:
    return MidiDecoder().feed(data)


@pytest.mark.toolkit("K1")
@pytest.mark.parametrize(
    ("data", "messages"),
    [
        ("b0 10 40", [("cc", 1, 16, 64)]),
        ("b0 10 40 10 41 11 00", [("cc", 1, 16, 64), ("cc", 1, 16, 65), ("cc", 1, 17, 0)]),
        ("bf 00 7f", [("cc", 16, 0, 127)]),
        ("90 3c 64 3c 00", [("note", 1, 60, 100), ("note", 1, 60, 0)]),
        ("80 3c 40", [("note", 1, 60, 0)]),
        ("c2 05 06", [("program", 3, 5, 127), ("program", 3, 6, 127)]),
        ("e0 00 40", [("bend", 1, 0, 64)]),
        ("e0 7f 7f 00 00", [("bend", 1, 0, 127), ("bend", 1, 0, 0)]),
        ("d0 33", [("pressure", 1, 0, 51)]),
        ("a0 3c 21", [("key-pressure", 1, 60, 33)]),
        # Real-time bytes in the middle of a message, and of one with running status.
        ("b0 f8 10 fe 40 fa 10 ff 41", [("cc", 1, 16, 64), ("cc", 1, 16, 65)]),
        # System exclusive: its data are no values, and no status survives it.
        ("b0 10 40 f0 42 40 00 01 f7 10 41 b0 10 42", [("cc", 1, 16, 64), ("cc", 1, 16, 66)]),
        # Unfinished, and cut off by the next message.
        ("f0 42 10 40 b0 10 40", [("cc", 1, 16, 64)]),
        # System common: position (two bytes), song (one), tune request, undefined.
        ("b0 10 40 f2 01 02 10 41", [("cc", 1, 16, 64)]),
        ("f3 05 b0 10 40", [("cc", 1, 16, 64)]),
        ("f4 f5 f6 f7 b0 10 40", [("cc", 1, 16, 64)]),
        # Data before any status, and a message cut off by another one.
        ("10 40 b0 10", []),
        ("b0 10 90 3c 40", [("note", 1, 60, 64)]),
    ],
)
def test_what_the_bytes_mean(data: str, messages: list[tuple[str, int, int, int]]) -> None:
    assert decoded(bytes.fromhex(data)) == [MidiMessage(*it) for it in messages]


@pytest.mark.toolkit("K1")
@given(st.binary(max_size=400))
def test_any_bytes_are_survived_and_what_comes_out_is_in_range(data: bytes) -> None:
    for message in decoded(data):
        assert 1 <= message.channel <= 16
        assert 0 <= message.number <= 127
        assert 0 <= message.value <= 127


@pytest.mark.toolkit("K1")
@given(st.binary(max_size=300), st.lists(st.integers(0, 300), max_size=20))
def test_where_the_stream_is_cut_makes_no_difference(data: bytes, cuts: list[int]) -> None:
    decoder = MidiDecoder()
    messages = []
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    for begin, end in pairwise(edges):
        messages += decoder.feed(data[begin:end])
    assert messages == decoded(data)


@given(st.lists(st.tuples(st.integers(1, 16), DATA, DATA, st.booleans()), max_size=60))
def test_what_the_encoder_writes_is_read_back(moves: list[tuple[int, int, int, bool]]) -> None:
    data, wanted = b"", []
    for channel, number, value, note in moves:
        data += (note_on if note else control_change)(channel, number, value)
        wanted.append(MidiMessage("note" if note else "cc", channel, number, value))
    assert decoded(data) == wanted


def test_the_middle_of_a_knob_is_exactly_the_middle() -> None:
    assert (control_place(0), control_place(64), control_place(127)) == (0.0, 0.5, 1.0)
    places = [control_place(value) for value in range(128)]
    assert places == sorted(set(places))
    assert [control_value(where) for where in places] == list(range(128))
