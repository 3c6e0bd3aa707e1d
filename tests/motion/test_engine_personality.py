"""Traits: what they do, that they change without a jump, that they read back."""

from __future__ import annotations

import itertools
import math
from dataclasses import asdict

import pytest

from tests.motion.bodies import DT, EYEPI, STILL, Rig, column, moves_safely, reach
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_verbs import CONTROLS
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.control_scales import TRAITS
from woz_tui.motion.easing import low_pass
from woz_tui.motion.engine import Engine
from woz_tui.motion.personality import GLIDES, NAMES
from woz_tui.protocol.messages import Json

#: Each trait that a body can be seen by, from one end to the other.
TURNS: list[tuple[dict[str, Json], dict[str, Json]]] = [
    ({"tempo": 1.1}, {"tempo": 3.2}),
    ({"breathing": 0.0}, {"breathing": 8.0}),
    ({"breathing_rate": 0.1}, {"breathing_rate": 1.0}),
    ({"blink_rate": 0.0}, {"blink_rate": 40.0}),
    ({"blink_time": 0.1}, {"blink_time": 1.0}),
    ({"smoothing": 0.0}, {"smoothing": 0.5}),
    ({"compression": 0.0}, {"compression": 1.0}),
    ({"speed": 0.5}, {"speed": 2.0}),
    ({"amplitude": 0.2}, {"amplitude": 1.5}),
]


@pytest.mark.toolkit("P1")
@pytest.mark.parametrize(("one", "other"), TURNS, ids=[next(iter(t[0])) for t in TURNS])
def test_every_trait_changes_on_the_way_without_a_jump(
    one: dict[str, Json], other: dict[str, Json]
) -> None:
    """Not even what is wanted goes faster than the joints may, so no limit has to hide a jump."""
    rig = Rig(EYEPI)
    rig.do("play", move="dance", amplitude=0.3)
    ticks = rig.run(1.0)
    for traits in (other, one, other, one):
        rig.do("personality", **traits)
        ticks += rig.run(0.7)
    assert moves_safely(EYEPI, ticks)
    for name, joint in EYEPI.joints.items():
        wanted = [tick.wanted[name] for tick in ticks]
        steps = [abs(b - a) for a, b in itertools.pairwise(wanted)]
        assert max(steps) < joint.speed * DT, f"{name} jumps"


@pytest.mark.toolkit("P1")
@pytest.mark.parametrize("trait", ["compression", "smoothing"])
def test_a_held_pose_glides_when_a_size_changes(trait: str) -> None:
    rig = Rig(STILL)
    rig.do("pose", joints={"pitch": 80.0})
    rig.run(1.0)
    rig.do("personality", **{trait: 1.0})
    ticks = [rig.last, *rig.run(3.0)]
    steps = [abs(b - a) for a, b in itertools.pairwise(column(ticks, "pitch"))]
    assert max(steps) <= 80 * GLIDES / math.e * DT * 1.01
    assert steps[0] < max(steps) / 2 + 1e-9
    assert rig.last.joints["pitch"] == pytest.approx(0.0 if trait == "compression" else 80.0)


@pytest.mark.toolkit("P3")
def test_without_smoothing_the_setpoint_is_the_target() -> None:
    rig = Rig(STILL)
    rig.do("joints", joints={"pitch": 3.0})
    assert rig.tick().wanted["pitch"] == 3.0
    assert rig.last.joints["pitch"] == 3.0


@pytest.mark.toolkit("P3")
def test_the_smoother_the_slower_never_beyond_and_always_there_in_the_end() -> None:
    times = []
    for place in (0.0, 0.1, 0.3, 0.6, 1.0):
        rig = Rig(STILL)
        rig.do("control", control="smoothing", value=place)
        rig.run(3.0)
        rig.do("joints", joints={"pitch": 6.0})
        angles = column(rig.run(8.0), "pitch")
        assert angles == sorted(angles)
        assert max(angles) <= 6.0
        assert angles[-1] == pytest.approx(6.0, abs=1e-4)
        times.append(next(i for i, angle in enumerate(angles) if angle > 5.4) * DT)
    assert times == sorted(set(times))
    assert times[-1] == pytest.approx(0.5 * math.log(10), abs=0.1)


@pytest.mark.toolkit("P3")
@pytest.mark.parametrize("ticks", [1, 7, 100])
def test_smoothing_does_not_depend_on_the_rate(ticks: int) -> None:
    value = 0.0
    for _ in range(ticks):
        value = low_pass(value, 1.0, 0.3, 0.6 / ticks)
    assert value == pytest.approx(1 - math.exp(-2))


@pytest.mark.toolkit("P4")
@pytest.mark.parametrize("compression", [0.0, 0.25, 0.5, 0.9, 1.0])
def test_compression_scales_about_the_middle_of_the_range(compression: float) -> None:
    rig = Rig(STILL)
    rig.do("control", control="compression", value=compression)
    for share in (0.0, 0.2, 0.5, 0.77, 1.0):
        pose: dict[str, Json] = {
            name: joint.min + share * (joint.max - joint.min)
            for name, joint in STILL.joints.items()
        }
        rig.do("joints", joints=pose)
        rig.run(4.0)
        for name, joint in STILL.joints.items():
            middle = (joint.min + joint.max) / 2
            asked = joint.min + share * (joint.max - joint.min)
            expected = middle + (1 - compression) * (asked - middle)
            assert rig.last.joints[name] == pytest.approx(expected)
            assert abs(rig.last.joints[name] - middle) <= abs(asked - middle) + 1e-9


@pytest.mark.toolkit("P5")
def test_a_named_set_is_recalled_and_reads_back_exactly() -> None:
    rig = Rig(EYEPI)
    for name, traits in EYEPI.personalities.items():
        rig.do("personality", name=name)
        values = rig.engine.values()
        assert values["personality"] == name
        assert {trait: values[trait] for trait in NAMES} == asdict(traits)
        assert rig.engine.state().personality == name
    rig.do("personality", name="upbeat", tempo=2.0)
    assert rig.engine.values()["tempo"] == 2.0
    assert rig.engine.values()["speed"] == 1.3


@pytest.mark.toolkit("P5", "U1")
def test_two_bodies_have_their_own_sets_at_once() -> None:
    happy, grumpy = Rig(EYEPI), Rig(EYEPI)
    happy.do("personality", name="upbeat")
    grumpy.do("personality", name="grumpy")
    swings = [max(column(rig.run(8.0), "top")) - 28.65 for rig in (happy, grumpy)]
    assert swings[0] == pytest.approx(4.0, abs=0.1)
    assert swings[1] != pytest.approx(swings[0], abs=1.0)
    assert happy.engine.values()["tempo"] == 3.0
    assert grumpy.engine.values()["tempo"] == 1.2


@pytest.mark.toolkit("P5")
@pytest.mark.parametrize("trait", NAMES)
def test_a_trait_out_of_its_range_is_refused(trait: str) -> None:
    engine = Engine(EYEPI, BUILT_IN)
    before = engine.values()
    low, high = reach(trait)
    wrongs: list[Json] = [low - 1.0, high + 1.0, math.nan, "much", [], True]
    for wrong in wrongs:
        with pytest.raises(RejectedError):
            engine.apply("personality", {"tempo": 1.5, trait: wrong, "name": "upbeat"})
    with pytest.raises(RejectedError, match="must be one of"):
        engine.apply("personality", {"name": "angelic"})
    assert engine.values() == before


@pytest.mark.toolkit("P2")
def test_the_knob_of_the_tempo_goes_from_64_to_192_beats_a_minute() -> None:
    rig = Rig(EYEPI)
    for place, beats in ((0.0, 64), (0.5, 128), (1.0, 192)):
        rig.do("control", control="tempo", value=place)
        tempo = rig.engine.values()["tempo"]
        assert isinstance(tempo, float)
        assert tempo * 60 == pytest.approx(beats)


@pytest.mark.parametrize("control", [*EYEPI.joints, *CONTROLS])
def test_every_control_reads_back_where_it_was_put(control: str) -> None:
    rig = Rig(EYEPI)
    for place in (0.0, 0.2, 0.5, 0.8, 1.0):
        rig.do("control", control=control, value=place)
        assert rig.engine.state().controls[control] == pytest.approx(place)
    rig.do("control", control=control, value=0.5)
    answer = rig.do("control", control=control, by=0.25)
    assert rig.engine.state().controls[control] == pytest.approx(0.75)
    assert answer.sent == {"control": control, "value": 0.75}
    assert rig.do("control", control=control, by=0.5).sent["clamped"] == {control: 1.25}
    assert rig.engine.state().controls[control] == 1.0
    wrongs: list[dict[str, Json]] = [
        {},
        {"value": 0.1, "by": 0.1},
        {"value": math.nan},
        {"value": "up"},
    ]
    for wrong in wrongs:
        with pytest.raises(RejectedError):
            rig.engine.apply("control", {"control": control, **wrong})
    assert rig.engine.state().controls[control] == 1.0


@pytest.mark.parametrize("control", ["eye-x", "eye-y", "valence", "arousal"])
def test_64_of_127_is_the_middle_of_a_knob_that_has_one(control: str) -> None:
    rig = Rig(EYEPI)
    rig.do("control", control=control, value=64 / 127)
    assert rig.engine.state().controls[control] == 0.5


@pytest.mark.parametrize("trait", TRAITS)
def test_knobs_keep_to_the_ranges_of_robot_files(trait: str) -> None:
    low, high = reach(trait)
    values = [TRAITS[trait].value(place / 20) for place in range(21)]
    assert values == sorted(values)
    assert low <= values[0] < values[-1] <= high


@pytest.mark.toolkit("P5")
def test_a_character_whose_trait_was_turned_is_told_as_changed() -> None:
    rig = Rig(EYEPI)
    rig.do("personality", name="grumpy")
    assert rig.engine.values()["changed"] is False
    rig.do("personality", tempo=1.3)
    values = rig.engine.values()
    assert (values["personality"], values["changed"]) == ("grumpy", True)
    rig.do("personality", name="grumpy")
    assert rig.engine.values()["changed"] is False
