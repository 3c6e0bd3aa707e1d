"""A layer acted again: what the hand changed of it is found, whatever its timing was."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.drivers.body.rig import small
from tests.example_counts import many
from woz_tui.features.move_editor.mimicry import MimicError, fitted, mimicked
from woz_tui.motion.engine import Engine
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, LayerSamples, MoveLayer
from woz_tui.motion.move_files import ANGLES, read_move
from woz_tui.motion.move_writer import save

SHAPE = small()
STEP = 0.02


def wave(late: float = 0.0, faster: float = 1.0) -> Callable[[float], float]:
    """Two bumps of different height."""

    def at(t: float) -> float:
        place = (t - late) * faster
        first, second = (math.exp(-(((place - c) / 0.15) ** 2)) for c in (0.5, 1.3))
        return 10 * first + 6 * second

    return at


def sampled(at: Callable[[float], float], seconds: float = 2.0) -> np.ndarray:
    return np.array([at(i * STEP) for i in range(round(seconds / STEP))])


@pytest.mark.toolkit("X2")
@pytest.mark.parametrize("gain", [-1.5, 0.3, 1.0, 2.5])
@pytest.mark.parametrize("offset", [-12.0, 0.0, 5.0])
@pytest.mark.parametrize(("late", "faster"), [(0.0, 1.0), (0.2, 1.0), (0.0, 1.15), (-0.1, 0.9)])
def test_gain_and_offset_are_found_whatever_the_timing(
    gain: float, offset: float, late: float, faster: float
) -> None:
    there, done = sampled(wave()), offset + gain * sampled(wave(late, faster))
    fit = fitted(there, done, STEP)
    assert fit.gain == pytest.approx(gain, rel=0.06)
    assert fit.offset == pytest.approx(offset, abs=0.5)
    if late > 0:
        assert "late" in str(fit)


def test_a_hand_that_does_nothing_changes_nothing() -> None:
    with pytest.raises(MimicError, match="nothing was done"):
        fitted(sampled(wave()), np.zeros(100), STEP)


def test_what_stands_still_is_led_elsewhere() -> None:
    done = np.concatenate([np.zeros(10), np.full(90, 8.0)])
    assert fitted(np.full(100, 2.0), done, STEP).gain == 1.0


@pytest.mark.toolkit("R4")
@settings(deadline=None, max_examples=many(60))
@given(
    st.lists(st.floats(-300, 300), min_size=4, max_size=30),
    st.lists(st.floats(-300, 300), min_size=4, max_size=30),
    st.booleans(),
)
def test_no_take_leads_a_joint_beyond_its_limits(
    there: list[float], done: list[float], relative: bool
) -> None:
    """Whatever is acted, it can be saved, and what plays stays in range and under speed."""
    pan = SHAPE.joints["pan"]
    if not relative:
        there = [min(pan.max, max(pan.min, value)) for value in there]
    layer = MoveLayer(
        "a",
        (KeyFrame(0.2, joints={"pan": there[0]}), KeyFrame(1.0, joints={"pan": there[1]})),
        LayerSamples(25.0, joints={"tilt": tuple(there)}) if relative else None,
        relative=relative,
    )
    take = MoveLayer("a", (), LayerSamples(25.0, joints={"pan": tuple(done), "tilt": tuple(done)}))
    try:
        changed, _ = mimicked(layer, "pan", take, (0.0, 9.0), SHAPE)
        if relative:
            changed, _ = mimicked(changed, "tilt", take, (0.0, 9.0), SHAPE)
    except MimicError:
        return
    values = [frame.joints["pan"] for frame in changed.frames]
    assert all(ANGLES.contains(value) for value in values)
    if not relative:
        assert all(pan.min <= value <= pan.max for value in values)
    engine = Engine(SHAPE, {"m": KeyframeMove("m", "", (changed,))})
    engine.tick(0.0)
    engine.apply("play", {"move": "m"})
    before = engine.tick(0.02).joints
    for number in range(2, 80):
        now = engine.tick(number * 0.02).joints
        for name, joint in SHAPE.joints.items():
            assert joint.min - 1e-6 <= now[name] <= joint.max + 1e-6
            assert abs(now[name] - before[name]) <= joint.speed * 0.02 + 1e-6
        before = now


def test_only_the_piece_that_was_acted_changes_and_the_file_keeps_it(tmp_path: Path) -> None:
    ups = tuple(5 * (1 - math.cos(i / 25 * math.tau)) for i in range(101))
    layer = MoveLayer("a", (), LayerSamples(25.0, joints={"pan": ups}))
    take = MoveLayer("a", (), LayerSamples(25.0, joints={"pan": tuple(2 * v for v in ups)}))
    changed, fit = mimicked(layer, "pan", take, (1.0, 3.0), SHAPE)
    assert fit.gain == pytest.approx(2.0, rel=0.02)
    assert changed.samples is not None
    now = changed.samples.joints["pan"]
    assert now[:26] == ups[:26] and now[75:] == ups[75:]
    assert now[38] == pytest.approx(2 * ups[38], abs=0.3)
    move = KeyframeMove("m", "", (changed,))
    save(move, tmp_path / "m.yaml", SHAPE)
    assert read_move(tmp_path / "m.yaml", SHAPE) == move
