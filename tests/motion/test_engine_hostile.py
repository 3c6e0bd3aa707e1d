"""Whatever comes from outside, the setpoints stay what servos may get."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.example_counts import many
from tests.motion.bodies import BODIES, EYEPI, Rig
from tests.motion.hostile import ABSURD, ARGUMENTS, VERBS, Hostile
from tests.motion.setpoint_watch import Watch
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine import Engine
from woz_tui.motion.modes import Mode, Operator

#: Inputs of each run.
INPUTS = many(2_000, 30_000)


def applied(engine: Engine, verb: Any, args: Any, hand: Operator, *, look: bool = True) -> bool:
    """Whether the input was taken; a refused one has left everything as it was (if we `look`)."""
    before = (engine.values(), engine.state()) if look else None
    try:
        engine.apply(verb, args, hand)
    except RejectedError as refusal:
        assert "failed inside" not in refusal.what
        assert before is None or (engine.values(), engine.state()) == before
        return False
    return True


@pytest.mark.toolkit("R4", "R6", "M4")
@pytest.mark.hypothesis
@pytest.mark.parametrize("run", range(3))
def test_nothing_from_outside_makes_a_setpoint_that_no_servo_may_get(run: int) -> None:
    shape = list(BODIES.values())[run]
    engine, hostile = Engine(shape, BUILT_IN, seed=run), Hostile(shape, run)
    tick = engine.tick(0.0)
    watch = Watch(shape, tick)
    taken, modes = 0, set()
    for _ in range(INPUTS):
        taken += applied(engine, *hostile.input(), look=hostile.often(0.2))
        if hostile.often(0.02):
            engine.see(hostile.seen())
        if hostile.often(0.4):
            tick = engine.tick(hostile.time())
            watch.check(tick)
            modes.add(tick.mode)
    assert INPUTS * 0.1 < taken < INPUTS * 0.9
    assert modes == set(Mode)


@pytest.mark.toolkit("R4")
def test_what_is_refused_leaves_no_trace() -> None:
    """A twin that only gets what was taken moves and looks exactly the same."""
    rig, twin, hostile = Rig(EYEPI), Rig(EYEPI), Hostile(EYEPI, "twin")
    for _ in range(1000):
        verb, args, hand = hostile.input()
        if applied(rig.engine, verb, args, hand):
            twin.engine.apply(verb, args, hand)
        if hostile.often(0.3):
            one, other = rig.tick(), twin.tick()
            assert one == other


@pytest.mark.toolkit("R4")
def test_freeze_restart_and_resume_between_everything() -> None:
    engine, hostile = Engine(EYEPI, BUILT_IN), Hostile(EYEPI, "freeze")
    tick = engine.tick(0.0)
    watch = Watch(EYEPI, tick)
    for count in range(1500):
        with contextlib.suppress(RejectedError):
            engine.apply(*hostile.input())
        if hostile.often(0.01):
            engine.freeze("stop")
        if hostile.often(0.02):
            engine.resume()
        if count % 750 == 350:
            engine.restart(hostile.angles())
            tick = engine.tick(tick.t)  # the joints were found elsewhere: no movement of ours
            watch = Watch(EYEPI, tick)
        if any(not j.min <= tick.joints[n] <= j.max for n, j in EYEPI.joints.items()):
            tick = engine.tick(tick.t + 0.02)
            watch = Watch(EYEPI, tick)
            continue
        tick = engine.tick(tick.t + 0.02)
        watch.check(tick)


_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner),
    max_leaves=8,
)
_ARGS = st.dictionaries(
    st.sampled_from(ARGUMENTS), _JSON | st.sampled_from([*BUILT_IN, "sad", "pitch", "demo"])
)


@pytest.mark.toolkit("R4")
@given(st.lists(st.tuples(st.sampled_from(VERBS), _ARGS, st.sampled_from(Operator)), max_size=12))
def test_any_json_is_taken_or_refused(
    inputs: list[tuple[str, Mapping[str, Any], Operator]],
) -> None:
    engine = Engine(EYEPI, BUILT_IN)
    tick = engine.tick(0.0)
    watch = Watch(EYEPI, tick)
    for count, (verb, args, hand) in enumerate(inputs, 1):
        applied(engine, verb, args, hand)
        watch.check(engine.tick(count * 0.02))


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize("absurd", ABSURD, ids=lambda value: repr(value)[:20])
def test_an_absurd_angle_keeps_the_joint_and_is_named(absurd: Any) -> None:
    rig = Rig(EYEPI)
    rig.do("breathing", on=False)
    rig.run(3.0)
    answer = rig.do("joints", joints={"pitch": 20.0, "middle": absurd})
    rig.run(1.0)
    assert rig.last.joints["pitch"] == pytest.approx(20.0)
    number = isinstance(absurd, int | float) and not isinstance(absurd, bool)
    if number and abs(absurd) < 1e308:
        assert 0.0 <= rig.last.joints["middle"] <= 90.0
    else:
        assert rig.last.joints["middle"] == pytest.approx(45.0)
        left_out = answer.sent["left_out"]
        assert isinstance(left_out, dict)
        assert list(left_out) == ["middle"]
