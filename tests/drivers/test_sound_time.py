"""Blocks of sound on the clock."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.microphone.speech_segments import BLOCK_US, SoundClock


@given(st.lists(st.integers(0, 400_000), min_size=1, max_size=40), st.integers(0, 10**12))
def test_late_blocks_do_not_move_the_others(late: list[int], zero: int) -> None:
    """Whatever held blocks back, none seems to come before the promptest of them says."""
    time = SoundClock()
    for block, delay in enumerate(late):
        time.arrived(block, zero + (block + 1) * BLOCK_US + delay)
    assert time.begins(0) == zero + min(late)
    assert time.begins(len(late)) - time.begins(0) == len(late) * BLOCK_US


def test_a_converter_that_runs_slow_is_followed() -> None:
    time = SoundClock()
    begins = 0
    for block in range(3 * 60 * 50):  # three minutes, 200 us late each second
        heard = round((block + 1) * BLOCK_US * 1.0002)
        time.arrived(block, heard)
        begins = time.begins(block)
        assert abs(begins - (heard - BLOCK_US)) < 2_500
    assert begins > 170_000_000


def test_after_a_gap_time_is_tied_anew() -> None:
    time = SoundClock()
    time.arrived(0, BLOCK_US)
    time.forget()
    time.arrived(1, 5_000_000)
    assert time.begins(1) == 5_000_000 - BLOCK_US


def test_nothing_is_known_before_the_first_block() -> None:
    with pytest.raises(ValueError, match="no block"):
        SoundClock().begins(0)


def test_a_prompt_block_is_remembered_while_those_after_it_are_late() -> None:
    """A busy machine holds everything back for a while: at least five seconds do no harm."""
    time = SoundClock()
    for block in range(2 * 250):
        late = 300_000 if block >= 200 else 0
        time.arrived(block, (block + 1) * BLOCK_US + late)
        assert time.begins(block) == block * BLOCK_US
