"""Every control of the thesis's appendix A, from recorded bytes to what the robot does.

The appendix counts its 24 buttons from above to below, then from left to right: button 7 is the
upper one of the third column, which sends control change 34, button 8 the one below it, 50.

The body is EyePi's own, moved by its engine: the panel's asks go into it as the bus would hand them
on, and time passes tick by tick.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from woz_drivers.body.settings import BodySettings
from woz_drivers.midi import MidiPanel
from woz_drivers.midi.panel_maps import BUILT_IN
from woz_drivers.midi.resolved_map import mapped_controls, signal_of
from woz_drivers.midi.settings import MidiSettings

from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.drivers.argument_check import checked
from woz_tui.drivers.contract import Ask, RejectedError, Verb
from woz_tui.motion.body_feeds import STATE
from woz_tui.motion.body_verbs import body_verbs
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import Tick
from woz_tui.testing import RecordingContext

ROOT = Path(__file__).parents[3]
TICK_S = 0.02
pytestmark = pytest.mark.toolkit("K1")


@cache
def eyepi() -> BodySettings:
    experiment = load(ROOT / "experiments" / "eyepi.yaml", plugins.installed())
    body = next(spec.settings for spec in experiment.drivers if spec.name == "body")
    assert isinstance(body, BodySettings)
    return body


@cache
def verbs() -> Mapping[str, Verb]:
    return {verb.name: verb for verb in body_verbs(eyepi(), eyepi().playable)}


class EngineRig(RecordingContext):
    """The panel in front of the engine; `jump`: without soft take-over."""

    def __init__(self, folder: Path, name: str = "thesis", take_over: str = "jump") -> None:
        super().__init__(folder)
        self.engine = Engine(eyepi(), eyepi().repertoire.moves)
        self.engine.apply("breathing", {"on": False})
        self.now = 0.0
        self.refused: list[str] = []
        self.tick = self.engine.tick(self.now)
        self.play(2.0)
        self.panel = MidiPanel("panel", MidiSettings(map=name, take_over=take_over), self)

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        self.asks.append(ask)
        assert done is not None
        try:
            if ask.what == "verb":
                assert ask.on == "body"
                self.engine.apply(ask.name, checked(verbs()[ask.name], ask.args))
        except RejectedError as refused:
            self.refused.append(refused.what)
            done(False, refused.what)
        else:
            done(True, "")

    def play(self, seconds: float) -> list[Tick]:
        """Let time pass."""
        ticks = []
        for _ in range(round(seconds / TICK_S)):
            self.now += TICK_S
            self.tick = self.engine.tick(self.now)
            self.feed(STATE, of="body").put(self.engine.state())
            ticks.append(self.tick)
        return ticks

    def hear(self, data: str) -> EngineRig:
        """Bytes from the panel, as they were recorded."""
        self.panel._received(bytes.fromhex(data))
        return self

    def turn(self, number: int, value: int) -> EngineRig:
        return self.hear(f"b0 {number:02x} {value:02x}")

    def press(self, number: int) -> EngineRig:
        return self.hear(f"b0 {number:02x} 7f {number:02x} 00")

    def values(self) -> Mapping[str, Any]:
        return self.engine.values()

    def places(self) -> Mapping[str, float]:
        return self.engine.state().controls


@pytest.fixture
def rig(tmp_path: Path) -> EngineRig:
    return EngineRig(tmp_path)


@pytest.mark.parametrize(
    ("number", "joint", "at"),
    [
        pytest.param(16, "pitch", (-90, 0, 90), id="K1 knob 1"),
        pytest.param(0, "middle", (0, 45, 90), id="K1 slider 1"),
        pytest.param(1, "top", (0, 45, 90), id="K1 slider 2"),
    ],
)
def test_a_joints_own_control(
    rig: EngineRig, number: int, joint: str, at: tuple[float, float, float]
) -> None:
    angles = []
    for value in (0, 32, 64, 96, 127):
        rig.turn(number, value).play(2.0)
        angles.append(rig.tick.joints[joint])
    assert (angles[0], angles[2], angles[4]) == pytest.approx(at, abs=0.01)
    assert angles == sorted(set(angles))


@pytest.mark.parametrize(
    ("number", "control"),
    [
        pytest.param(17, "tempo", id="K1 knob 2"),
        pytest.param(18, "smoothing", id="K1 knob 3"),
        pytest.param(19, "compression", id="K1 knob 4"),
        pytest.param(23, "eye-x", id="K1 knob 8"),
        pytest.param(4, "arousal", id="K1 slider 5"),
        pytest.param(5, "valence", id="K1 slider 6"),
    ],
)
def test_a_control_of_the_body(rig: EngineRig, number: int, control: str) -> None:
    for value, place in ((127, 1.0), (64, 0.5), (0, 0.0)):
        rig.turn(number, value).play(0.1)
        assert rig.places()[control] == pytest.approx(place, abs=0.005)
    assert rig.refused == []


@pytest.mark.toolkit("P2")
def test_knob_2_at_its_lowest_end_still_plays(rig: EngineRig) -> None:
    rig.turn(17, 0).press(34).play(30.0)
    assert rig.tick.move == ""
    assert rig.values()["tempo"] > 0


@pytest.mark.parametrize(
    ("number", "move"),
    [
        pytest.param(34, "nod", id="K1 button 7"),
        pytest.param(50, "shake", id="K1 button 8"),
        pytest.param(66, "dance", id="K1 button 9"),
    ],
)
def test_a_press_starts_a_move_and_letting_go_does_nothing(
    rig: EngineRig, number: int, move: str
) -> None:
    rig.hear(f"b0 {number:02x} 7f").play(0.5)
    assert rig.tick.move == move
    rig.hear(f"{number:02x} 00").play(0.1)
    assert rig.tick.move == move
    assert len(rig.asks) == 1
    assert rig.asks[0].when_busy == "replace", "pressed again it starts anew"


@pytest.mark.toolkit("M3")
@pytest.mark.parametrize("number", [35, 51, 67], ids=[f"K1 button {n}" for n in (10, 11, 12)])
@pytest.mark.parametrize("going", [34, 36, 52, 68])
def test_all_three_stops_end_whatever_goes_on(rig: EngineRig, number: int, going: int) -> None:
    rig.press(going).play(1.0)
    assert rig.tick.move or rig.tick.mode.value != "normal"
    rig.press(number).play(TICK_S)
    assert (rig.tick.move, rig.tick.mode.value) == ("", "normal")
    rig.play(3.0)
    assert rig.asks[-1].args == {"mode": "normal"}


@pytest.mark.toolkit("S3")
@pytest.mark.parametrize(
    ("number", "mode"),
    [
        pytest.param(36, "demo", id="K1 button 13"),
        pytest.param(52, "tracking", id="K1 button 14"),
        pytest.param(68, "saccade", id="K1 button 15"),
    ],
)
def test_a_mode(rig: EngineRig, number: int, mode: str) -> None:
    rig.press(number).play(0.1)
    assert rig.tick.mode.value == mode
    rig.turn(17, 127)
    assert len(rig.refused) == 1, "the personality does not count in a mode"


@pytest.mark.parametrize(
    ("number", "emotion"),
    [
        pytest.param(69, "crash", id="K1 button 18"),
        pytest.param(38, "neutral", id="K1 button 19"),
        pytest.param(54, "sleepy", id="K1 button 20"),
        pytest.param(70, "sad", id="K1 button 21"),
        pytest.param(39, "happy", id="K1 button 22"),
        pytest.param(55, "amazed", id="K1 button 23"),
        pytest.param(71, "angry", id="K1 button 24"),
    ],
)
def test_an_emotion_with_the_intensity_that_was_set(
    rig: EngineRig, number: int, emotion: str
) -> None:
    rig.press(39).turn(6, 80).play(1.0)
    joints = dict(rig.tick.joints)
    rig.press(number).play(0.5)
    assert rig.tick.emotion == emotion
    assert rig.places()["intensity"] == pytest.approx(0.5 + 16 / 126, abs=0.01)
    assert rig.tick.joints == pytest.approx(joints)


@pytest.mark.toolkit("F3")
def test_slider_7_sets_the_intensity(rig: EngineRig) -> None:
    rig.press(39)
    for value in (0, 64, 127):
        rig.turn(6, value).play(0.5)
        assert rig.tick.intensity == pytest.approx((0, 0.5, 1)[value // 63], abs=0.01)


@pytest.mark.toolkit("F4")
def test_sliders_5_and_6_in_the_middle_are_no_mood(rig: EngineRig) -> None:
    rig.turn(5, 127).turn(4, 64).play(0.5)
    assert rig.tick.emotion == "happy"
    rig.turn(5, 64).play(2.0)
    assert rig.tick.emotion == "neutral"


def test_slider_3_zooms_both_upper_joints_in_opposite_directions(rig: EngineRig) -> None:
    rig.turn(0, 64).turn(1, 64).turn(2, 64).play(2.0)
    before = rig.tick.joints
    rig.turn(2, 96).play(2.0)
    after = rig.tick.joints
    moved = after["middle"] - before["middle"]
    assert moved > 5
    assert after["top"] - before["top"] == pytest.approx(-moved)
    rig.turn(2, 127).turn(0, 127).play(2.0)
    at_limit = rig.tick.joints
    assert at_limit["middle"] == pytest.approx(90)
    assert at_limit["top"] == pytest.approx(45), "its own slider alone: one stops, both stop"


FREE = {
    **{f"K1 knob {number}": 15 + number for number in (5, 6, 7)},
    **{f"K1 button {it}": cc for it, cc in enumerate((32, 48, 64, 33, 49, 65), 1)},
    "K1 button 16": 37,
    "K1 button 17": 53,
    "K1 slider 4": 3,
}


@pytest.mark.parametrize("number", FREE.values(), ids=FREE)
def test_what_is_not_mapped_has_no_effect(rig: EngineRig, number: int) -> None:
    before = rig.tick.joints
    rig.hear(f"b0 {number:02x} 00 {number:02x} 7f {number:02x} 40").play(0.5)
    assert rig.asks == []
    assert rig.tick.joints == before


@pytest.mark.toolkit("G7")
@pytest.mark.parametrize("name", BUILT_IN)
def test_the_first_touch_of_anything_that_turns_changes_nothing(tmp_path: Path, name: str) -> None:
    engine_rig = EngineRig(tmp_path, name, take_over="soft")
    values, joints = engine_rig.values(), engine_rig.tick.joints
    turning = [
        control
        for control in mapped_controls(MidiSettings(map=name))
        if not control.pressed and not control.free
    ]
    at_the_end = [
        control
        for control in turning
        if abs(engine_rig.places()[control.mapped.control] - 1) < 0.02
    ]
    for control in turning:
        value = 0 if control in at_the_end and not control.mapped.reversed else 127
        engine_rig.turn(signal_of(control).number, value)
        ticks = engine_rig.play(0.2)
        assert all(tick.joints == pytest.approx(joints) for tick in ticks), control.name
    assert engine_rig.asks == []
    assert engine_rig.values() == values


@pytest.mark.toolkit("R4")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    data=st.lists(st.binary(max_size=40), max_size=12), take_over=st.sampled_from(["soft", "jump"])
)
def test_whatever_the_panel_sends_the_body_stays_within_its_limits(
    tmp_path: Path, data: list[bytes], take_over: str
) -> None:
    engine_rig = EngineRig(tmp_path, "nanokontrol2", take_over)
    for piece in data:
        # Half of it as control changes of known numbers, so that it means something.
        engine_rig.hear(piece.hex()).hear("b0 " + bytes(byte & 0x7F for byte in piece).hex())
        for tick in engine_rig.play(0.1):
            for joint, angle in tick.joints.items():
                shape = eyepi().joints[joint]
                assert shape.min <= angle <= shape.max


@pytest.mark.toolkit("M3")
def test_sliders_moved_during_the_demo_count_for_the_way_back(rig: EngineRig) -> None:
    rig.turn(16, 64).press(36).play(3.0)
    rig.turn(16, 127)
    assert rig.refused == []
    rig.press(35).play(3.0)
    assert rig.tick.mode.value == "normal"
    assert rig.tick.joints["pitch"] == pytest.approx(90, abs=0.01)


@pytest.mark.toolkit("G5")
def test_transport_keys_are_the_sessions(rig: EngineRig) -> None:
    for number in (42, 46, 41, 45):
        rig.press(number)
    assert [ask.what for ask in rig.asks] == ["stop", "release", "script", "mark"]
