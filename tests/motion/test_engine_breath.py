"""Breathing and blinking: what makes a body that does nothing look alive."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest

from tests.motion.bodies import DT, EYEPI, STILL, Rig, column, moves_safely
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.face_control import Blinks
from woz_tui.motion.face_drawing import FaceState, draw


def peak(angles: Sequence[float]) -> float:
    """The frequency (Hz) that most of a swing has: the middle of its spectrum's highest peak."""
    swing = np.asarray(angles) - np.mean(angles)
    power = np.abs(np.fft.rfft(swing * np.hanning(len(swing)), 16 * len(swing))) ** 2
    return float(np.argmax(power)) / (16 * len(swing) * DT)


@pytest.mark.toolkit("L8", "P2")
@pytest.mark.parametrize(("tempo", "rate"), [(1.2, 0.3), (2.4, 0.6), (64 / 30, 64 / 120)])
@pytest.mark.parametrize("amplitude", [1.5, 4.0])
def test_breath_has_the_frequency_and_the_size_that_were_set(
    tempo: float, rate: float, amplitude: float
) -> None:
    rig = Rig(EYEPI)
    rig.do("personality", tempo=tempo, breathing=amplitude)
    rig.run(3.0)
    ticks = rig.run(round(12 / rate) / 1.0)  # whole breaths
    for joint, desired in (("middle", 45.0), ("top", 28.65)):
        angles = column(ticks, joint)
        assert peak(angles) == pytest.approx(rate, rel=0.05)
        assert max(angles) - min(angles) == pytest.approx(2 * amplitude, rel=0.05)
        assert np.mean(angles) == pytest.approx(desired, abs=0.05)
    assert set(column(ticks, "pitch")) == {0.0}
    assert moves_safely(EYEPI, ticks)


@pytest.mark.toolkit("L8")
def test_a_rate_of_its_own_frees_breath_from_the_tempo() -> None:
    rig = Rig(EYEPI)
    rig.do("personality", tempo=3.0, breathing_rate=0.25)
    assert peak(column(rig.run(40.0), "top")) == pytest.approx(0.25, rel=0.05)


@pytest.mark.toolkit("L8", "P1")
def test_another_rate_keeps_the_phase() -> None:
    rig = Rig(EYEPI)
    rig.run(5.0)
    steps = []
    for tempo in (3.0, 0.5, 5.0, 1.0):
        before = rig.last.joints["top"]
        rig.do("personality", tempo=tempo)
        ticks = rig.run(0.5)
        steps += [abs(b - a) for a, b in itertools.pairwise([before, *column(ticks, "top")])]
    assert max(steps) <= 180 / 70 * 2 * math.pi * 5.0 / 4 * DT * 1.01


@pytest.mark.toolkit("L8")
def test_breath_can_be_held_and_comes_back_without_a_jump() -> None:
    rig = Rig(EYEPI)
    rig.run(3.4)
    for on in (False, True):
        before = rig.last.joints["top"]
        rig.do("breathing", on=on)
        ticks = rig.run(1.0)
        steps = [b - a for a, b in itertools.pairwise([before, *column(ticks, "top")])]
        assert max(map(abs, steps)) < 0.5
        if not on:
            rig.run(2.0)
            assert set(column(rig.run(1.0), "top")) == {28.65}
    assert len(set(column(rig.run(1.0), "top"))) > 10


@pytest.mark.toolkit("L8", "R1")
def test_at_a_limit_the_pose_gives_way_and_the_breath_stays_whole() -> None:
    rig = Rig(EYEPI)
    rig.wait(rig.do("pose", joints={"middle": 90.0, "top": 0.0}))
    rig.run(1.0)
    ticks = rig.run(10.0)
    size = 180 / 70
    for joint, low, high in (("middle", 90 - 2 * size, 90.0), ("top", 0.0, 2 * size)):
        assert min(column(ticks, joint)) == pytest.approx(low, abs=0.05)
        assert max(column(ticks, joint)) == pytest.approx(high, abs=0.05)
        assert peak(column(ticks, joint)) == pytest.approx(64 / 120, rel=0.05)


@pytest.mark.toolkit("U4")
def test_ten_minutes_alone_it_stays_alive_where_it_is() -> None:
    rig = Rig(EYEPI)
    minutes = [rig.run(60.0) for _ in range(10)]
    breath = 60 * 64 / 120
    for ticks in minutes:
        whole = ticks[-round(int(breath) / (64 / 120) / DT) :]
        for joint, desired in (("pitch", 0.0), ("middle", 45.0), ("top", 28.65)):
            assert np.mean(column(whole, joint)) == pytest.approx(desired, abs=0.05)
        assert np.ptp(column(ticks, "top")) > 4
        assert count_blinks(ticks) >= 6
    assert not [notice for ticks in minutes for tick in ticks for notice in tick.notices]


def count_blinks(ticks: list[Tick]) -> int:
    """How often the picture leaves that of open eyes."""
    assert EYEPI.face is not None
    is_open = draw(FaceState(), EYEPI.face)
    closed = [tick.face != is_open for tick in ticks]
    return sum(b and not a for a, b in itertools.pairwise(closed))


@pytest.mark.toolkit("L9")
@pytest.mark.parametrize("length", [0.1, 0.5])
def test_a_blink_closes_the_eyes_and_opens_them_again(length: float) -> None:
    blinks = Blinks(3)
    blinks.begin()
    lids = [blinks.step(0.005, 0.0, length, 0.0) for _ in range(round(length / 0.005) + 5)]
    lowest = lids.index(min(lids))
    assert lids[: lowest + 1] == sorted(lids[: lowest + 1], reverse=True)
    assert lids[lowest:] == sorted(lids[lowest:])
    assert 0.0 <= min(lids) < 0.01
    assert max(lids) <= 1.0
    assert lids[-1] == 1.0


@pytest.mark.toolkit("L9")
@pytest.mark.parametrize(("rate", "irregularity"), [(6.0, 0.0), (15.0, 0.3), (20.0, 1.0)])
def test_blinks_come_as_often_and_as_regularly_as_set(rate: float, irregularity: float) -> None:
    blinks = Blinks(8)
    lids = [blinks.step(DT, rate, 0.3, irregularity) < 1.0 for _ in range(round(600 / DT))]
    begins = [i * DT for i, (a, b) in enumerate(itertools.pairwise(lids)) if b and not a]
    assert len(begins) == pytest.approx(rate * 10, rel=0.08)
    pauses = [b - a for a, b in itertools.pairwise(begins)]
    mean = 60 / rate
    assert min(pauses) >= mean * (1 - irregularity / 2) - 2 * DT
    assert max(pauses) <= mean * (1 + irregularity / 2) + 2 * DT
    assert max(pauses) - min(pauses) >= mean * irregularity * 0.8 - 2 * DT


@pytest.mark.toolkit("L9")
def test_a_blink_leaves_emotion_and_gaze_alone() -> None:
    rig = Rig()
    rig.do("look", x=0.4, y=0.0)
    rig.do("emotion", emotion="happy", intensity=1.0)
    rig.run(0.1)
    before = rig.last
    assert before.face is not None
    rig.do("blink")
    ticks = rig.run(0.6)
    assert {(tick.emotion, tick.intensity) for tick in ticks} == {("happy", 1.0)}
    assert {tuple(tick.joints.items()) for tick in ticks} == {tuple(before.joints.items())}
    heights = [sum(row > 0 for row in tick.face.rows) for tick in ticks if tick.face is not None]
    assert max(heights) == sum(row > 0 for row in before.face.rows)
    assert min(heights) < max(heights)
    assert rig.last.face == before.face


@pytest.mark.toolkit("L9")
def test_blinking_by_itself_can_be_switched_off() -> None:
    rig = Rig(EYEPI)
    rig.do("blinking", on=False)
    assert count_blinks(rig.run(60.0)) == 0
    rig.do("blinking", on=True)
    assert count_blinks(rig.run(60.0)) > 6


def test_the_same_seed_blinks_the_same() -> None:
    one, two, other = (
        [tick.face for tick in Rig(EYEPI, seed=seed).run(60.0)] for seed in (4, 4, 5)
    )
    assert one == two
    assert one != other
    assert STILL.face is not None
