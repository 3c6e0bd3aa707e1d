"""The modes: which input counts where, how one gets in and out."""

from __future__ import annotations

import contextlib
import itertools
import random
from collections.abc import Callable

import pytest

from tests.motion.bodies import DT, EYEPI, STILL, Rig, column, moves_safely, reach
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_verbs import CONTROL_KINDS, CONTROLS, EMOTIONS, KINDS
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.modes import MODE_RULES, InputKind, Mode, Operator, is_accepted
from woz_tui.motion.personality import NAMES
from woz_tui.protocol.messages import Json

Input = tuple[str, dict[str, Json]]
OTHERS = [mode for mode in Mode if mode is not Mode.NORMAL]


def enter(rig: Rig, mode: Mode) -> None:
    if mode is not Mode.NORMAL:
        rig.do("mode", mode=mode.value)


def any_input(kind: InputKind, chance: random.Random) -> Input:
    """A random input of a row of the table, sensible in itself."""
    u = chance.uniform
    joints: Json = {n: u(j.min, j.max) for n, j in STILL.joints.items()}
    controls = [name for name, of in CONTROL_KINDS.items() if of is kind]
    by_control: list[Input] = [("control", {"control": c, "value": u(0, 1)}) for c in controls]
    trait = chance.choice(NAMES)
    rows: dict[InputKind, list[Input]] = {
        InputKind.JOINTS: [
            ("joints", {"joints": joints}),
            ("control", {"control": chance.choice(list(STILL.joints)), "value": u(0, 1)}),
        ],
        InputKind.POSE: [
            ("pose", {"joints": joints, "seconds": u(0, 2)}),
            ("home", {}),
            ("gaze", {"yaw": u(-80, 80), "pitch": u(-30, 30)}),
            ("nudge", {"yaw": u(-10, 10)}),
            ("poses", {"poses": [{"joints": joints}]}),
        ],
        InputKind.EMOTION: [
            ("emotion", {"emotion": chance.choice(EMOTIONS), "intensity": u(0, 1)}),
            ("affect", {"valence": u(-1, 1), "arousal": u(-1, 1)}),
        ],
        InputKind.EYES: [("look", {"x": u(-1, 1), "y": u(-1, 1)})],
        InputKind.FACE: [
            ("brightness", {"level": u(0, 1)}),
            ("blink", {}),
            ("blinking", {"on": chance.random() < 0.5}),
        ],
        InputKind.ANIMATION: [("play", {"move": chance.choice(list(BUILT_IN))})],
        InputKind.PERSONALITY: [
            ("personality", {trait: u(*reach(trait))}),
            ("personality", {"name": chance.choice(["upbeat", "grumpy"])}),
            ("breathing", {"on": chance.random() < 0.5}),
        ],
        InputKind.MODE: [("mode", {"mode": chance.choice(OTHERS).value})],
        InputKind.STOP: [("mode", {"mode": "normal"})],
    }
    return chance.choice(rows[kind] + by_control)


def shown_state(tick: Tick) -> tuple[object, ...]:
    return (
        dict(tick.joints),
        tick.face,
        tick.mode,
        tick.emotion,
        tick.intensity,
        tick.brightness,
        tick.move,
    )


NO = [
    (kind, mode, hand)
    for kind, mode, hand in itertools.product(InputKind, Mode, Operator)
    if not is_accepted(kind, mode)
]
YES = [
    (kind, mode, hand)
    for kind, mode, hand in itertools.product(InputKind, Mode, Operator)
    if is_accepted(kind, mode)
]


@pytest.mark.toolkit("M1")
def test_it_begins_in_normal() -> None:
    rig = Rig(EYEPI)
    assert rig.last.mode is Mode.NORMAL
    assert rig.engine.state().mode == "normal"


@pytest.mark.toolkit("M2", "O6")
@pytest.mark.parametrize(("kind", "mode", "hand"), NO)
def test_what_does_not_count_changes_nothing(kind: InputKind, mode: Mode, hand: Operator) -> None:
    """1000 random inputs against a twin that gets none: joints, face and mode are the same."""
    chance = random.Random(f"{kind} {mode} {hand}")
    rig, twin = Rig(EYEPI), Rig(EYEPI)
    for one in (rig, twin):
        one.run(0.5)
        enter(one, mode)
        one.run(0.3)
    refused = 0
    for _ in range(20):
        for _ in range(50):
            verb, args = any_input(kind, chance)
            try:
                answer = rig.do(verb, hand, **args)
            except RejectedError as refusal:
                refused += 1
                assert mode.value in refusal.what
            else:
                assert answer.sent["waits"] == "normal"
        assert shown_state(rig.tick()) == shown_state(twin.tick())
    assert refused == 1000 or kind is InputKind.JOINTS
    assert [shown_state(tick) for tick in rig.run(1.0)] == [
        shown_state(tick) for tick in twin.run(1.0)
    ]


@pytest.mark.toolkit("M2")
@pytest.mark.parametrize(("kind", "mode", "hand"), YES)
def test_what_counts_shows_within_two_ticks(kind: InputKind, mode: Mode, hand: Operator) -> None:
    tell: dict[InputKind, Input] = {
        InputKind.JOINTS: ("control", {"control": "pitch", "value": 0.7}),
        InputKind.POSE: ("gaze", {"yaw": 50.0}),
        InputKind.EMOTION: ("emotion", {"emotion": "angry", "intensity": 1.0}),
        InputKind.EYES: ("look", {"x": 1.0}),
        InputKind.FACE: ("brightness", {"level": 0.3}),
        InputKind.ANIMATION: ("play", {"move": "dance"}),
        InputKind.PERSONALITY: ("personality", {"compression": 0.5}),
        InputKind.MODE: ("mode", {"mode": "demo"}),
        InputKind.STOP: ("mode", {"mode": "normal"}),
    }
    rig, twin = Rig(STILL), Rig(STILL)
    for one in (rig, twin):
        enter(one, mode)
        one.run(2.0)
    if kind is InputKind.STOP and mode is Mode.NORMAL:
        for one in (rig, twin):
            one.do("play", move="dance")
            one.run(1.0)
    verb, args = tell[kind]
    rig.do(verb, hand, **args)
    assert shown_state(rig.run(2 * DT)[-1]) != shown_state(twin.run(2 * DT)[-1])


@pytest.mark.toolkit("M2")
def test_every_verb_and_control_has_its_row() -> None:
    rig = Rig()
    rows = set(KINDS.values()) | set(CONTROL_KINDS.values()) | {InputKind.STOP}
    assert rows == set(MODE_RULES)
    assert set(CONTROL_KINDS) == set(CONTROLS)
    for verb in KINDS:
        with contextlib.suppress(RejectedError):
            rig.do(verb)


def after_stop(mode: Mode, turned: bool) -> tuple[Rig, list[Tick], dict[str, float]]:
    rig = Rig(STILL)
    rig.do("control", control="pitch", value=0.6)
    rig.run(1.0)
    enter(rig, mode)
    if mode is Mode.SACCADE:
        rig.do("look", x=-0.8, y=0.3)
    rig.run(3.7)
    if turned:
        rig.do("control", control="pitch", value=0.2)
        rig.do("control", control="top", value=0.9)
        rig.run(1.0)
    before = dict(rig.last.joints)
    rig.do("mode", mode="normal")
    return rig, rig.run(2.5), before


@pytest.mark.toolkit("M3")
@pytest.mark.parametrize("mode", OTHERS)
@pytest.mark.parametrize("turned", [False, True])
def test_the_stop_leads_back_to_the_pose_of_the_controls(mode: Mode, turned: bool) -> None:
    rig, ticks, before = after_stop(mode, turned)
    end = {"pitch": -54.0, "middle": 45.0, "top": 81.0} if turned else {"pitch": 18.0}
    for joint, angle in end.items():
        assert ticks[-1].joints[joint] == pytest.approx(angle)
    assert {tick.mode for tick in ticks} == {Mode.NORMAL}
    assert moves_safely(STILL, ticks)
    for joint in STILL.joints:
        start, goal = before[joint], ticks[-1].joints[joint]
        for count, tick in enumerate(ticks, 1):
            share = min(1.0, count * DT / 1.0)
            assert tick.joints[joint] == pytest.approx(start + (goal - start) * share, abs=1e-4)
    assert rig.engine.state().controls["pitch"] == pytest.approx(0.2 if turned else 0.6)


@pytest.mark.toolkit("M3")
def test_pressing_the_stop_again_does_not_halt_the_way_back() -> None:
    rig = Rig(STILL)
    enter(rig, Mode.SACCADE)
    rig.do("look", x=1.0)
    rig.run(2.0)
    assert rig.last.joints["pitch"] > 40
    for _ in range(5):
        rig.do("mode", mode="normal")
        rig.run(0.1)
    rig.run(1.0)
    assert rig.last.joints["pitch"] == pytest.approx(0.0)


@pytest.mark.toolkit("M3", "L8", "O6")
@pytest.mark.parametrize("mode", [Mode.DEMO, Mode.TRACKING])
def test_it_holds_its_breath_in_modes_and_breathes_again_after(mode: Mode) -> None:
    alive, calm = Rig(EYEPI), Rig(STILL)
    for rig in (alive, calm):
        enter(rig, mode)
        rig.run(1.0)
    for a, b in zip(alive.run(2.0), calm.run(2.0), strict=True):
        assert a.joints == pytest.approx(b.joints, abs=1e-6)
    alive.do("mode", mode="normal")
    alive.run(2.0)
    assert len(set(column(alive.run(1.0), "top"))) > 20


Begin = Callable[[Rig], object]
IN_FLIGHT: dict[str, Begin] = {
    "nothing": lambda rig: None,
    "move": lambda rig: rig.do("play", move="dance"),
    "gaze": lambda rig: rig.do("gaze", yaw=70.0, seconds=1.0),
    "joints": lambda rig: rig.do("joints", joints={"pitch": -90, "middle": 0, "top": 90}),
}


@pytest.mark.toolkit("M4")
@pytest.mark.parametrize("flight", IN_FLIGHT)
@pytest.mark.parametrize(("first", "second"), list(itertools.product(Mode, Mode)))
def test_no_change_of_mode_jumps_or_loses_the_stop(first: Mode, second: Mode, flight: str) -> None:
    rig = Rig(EYEPI)
    ticks = rig.run(0.3)
    IN_FLIGHT[flight](rig)
    ticks += rig.run(0.26)
    enter(rig, first)
    ticks += rig.run(0.5)
    if second is not Mode.NORMAL and first is not Mode.NORMAL:
        with pytest.raises(RejectedError):
            enter(rig, second)
        assert rig.tick().mode is first
        ticks.append(rig.last)
    rig.do("mode", mode="normal")
    ticks += rig.run(0.12)
    IN_FLIGHT[flight](rig)
    ticks += rig.run(0.1)
    enter(rig, second)
    ticks += rig.run(0.5)
    assert rig.last.mode is second
    rig.do("mode", mode="normal")
    ticks.append(rig.tick())
    assert rig.last.mode is Mode.NORMAL
    assert rig.last.move == ""
    ticks += rig.run(1.5)
    assert moves_safely(EYEPI, ticks)
    assert rig.engine.values()["move"] == ""


@pytest.mark.toolkit("E2", "E4", "L3")
def test_the_later_hand_wins_and_the_stop_ends_what_a_program_began() -> None:
    rig = Rig(STILL)
    first = rig.do("gaze", Operator.PROGRAM, yaw=60.0, seconds=2.0)
    rig.run(0.5)
    second = rig.do("gaze", Operator.WIZARD, yaw=-30.0, seconds=0.5)
    assert [e.token for e in rig.tick().ended] == [first.token]
    rig.wait(second)
    assert rig.last.joints["pitch"] == pytest.approx(-30.0, abs=0.5)
    rig.do("joints", Operator.PROGRAM, joints={"pitch": 12.0})
    rig.run(1.0)
    assert rig.last.joints["pitch"] == 12.0
    third = rig.do("play", Operator.PROGRAM, move="dance")
    rig.run(0.5)
    rig.do("mode", Operator.WIZARD, mode="normal")
    assert [(e.token, e.why) for e in rig.tick().ended] == [(third.token, "stopped")]
    rig.do("mode", Operator.WIZARD, mode="demo")
    rig.run(0.2)
    with pytest.raises(RejectedError, match="demo"):
        rig.do("play", Operator.PROGRAM, move="nod")
    with pytest.raises(RejectedError, match="demo"):
        rig.do("control", Operator.PROGRAM, control="pitch", value=0.9)
