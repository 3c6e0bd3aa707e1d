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
    found = load(ROOT / "experiments" / "eyepi.yaml", plugins.installed())
    body = next(spec.settings for spec in found.drivers if spec.name == "body")
    assert isinstance(body, BodySettings)
    return body


@cache
def verbs() -> Mapping[str, Verb]:
    return {verb.name: verb for verb in body_verbs(eyepi(), eyepi().playable)}


class Stage(RecordingContext):
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

    def hear(self, data: str) -> Stage:
        """Bytes from the panel, as they were recorded."""
        self.panel._received(bytes.fromhex(data))
        return self

    def turn(self, number: int, value: int) -> Stage:
        return self.hear(f"b0 {number:02x} {value:02x}")

    def press(self, number: int) -> Stage:
        return self.hear(f"b0 {number:02x} 7f {number:02x} 00")

    def values(self) -> Mapping[str, Any]:
        return self.engine.values()

    def places(self) -> Mapping[str, float]:
        return self.engine.state().controls


@pytest.fixture
def stage(tmp_path: Path) -> Stage:
    return Stage(tmp_path)


@pytest.mark.parametrize(
    ("number", "joint", "at"),
    [
        pytest.param(16, "pitch", (-90, 0, 90), id="K1 knob 1"),
        pytest.param(0, "middle", (0, 45, 90), id="K1 slider 1"),
        pytest.param(1, "top", (0, 45, 90), id="K1 slider 2"),
    ],
)
def test_a_joints_own_control(
    stage: Stage, number: int, joint: str, at: tuple[float, float, float]
) -> None:
    angles = []
    for value in (0, 32, 64, 96, 127):
        stage.turn(number, value).play(2.0)
        angles.append(stage.tick.joints[joint])
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
def test_a_control_of_the_body(stage: Stage, number: int, control: str) -> None:
    for value, place in ((127, 1.0), (64, 0.5), (0, 0.0)):
        stage.turn(number, value).play(0.1)
        assert stage.places()[control] == pytest.approx(place, abs=0.005)
    assert stage.refused == []


@pytest.mark.toolkit("P2")
def test_knob_2_at_its_lowest_end_still_plays(stage: Stage) -> None:
    stage.turn(17, 0).press(34).play(30.0)
    assert stage.tick.move == ""
    assert stage.values()["tempo"] > 0


@pytest.mark.parametrize(
    ("number", "move"),
    [
        pytest.param(34, "nod", id="K1 button 7"),
        pytest.param(50, "shake", id="K1 button 8"),
        pytest.param(66, "dance", id="K1 button 9"),
    ],
)
def test_a_press_starts_a_move_and_letting_go_does_nothing(
    stage: Stage, number: int, move: str
) -> None:
    stage.hear(f"b0 {number:02x} 7f").play(0.5)
    assert stage.tick.move == move
    stage.hear(f"{number:02x} 00").play(0.1)
    assert stage.tick.move == move
    assert len(stage.asks) == 1
    assert stage.asks[0].when_busy == "replace", "pressed again it starts anew"


@pytest.mark.toolkit("M3")
@pytest.mark.parametrize("number", [35, 51, 67], ids=[f"K1 button {n}" for n in (10, 11, 12)])
@pytest.mark.parametrize("going", [34, 36, 52, 68])
def test_all_three_stops_end_whatever_goes_on(stage: Stage, number: int, going: int) -> None:
    stage.press(going).play(1.0)
    assert stage.tick.move or stage.tick.mode.value != "normal"
    stage.press(number).play(TICK_S)
    assert (stage.tick.move, stage.tick.mode.value) == ("", "normal")
    stage.play(3.0)
    assert stage.asks[-1].args == {"mode": "normal"}


@pytest.mark.toolkit("S3")
@pytest.mark.parametrize(
    ("number", "mode"),
    [
        pytest.param(36, "demo", id="K1 button 13"),
        pytest.param(52, "tracking", id="K1 button 14"),
        pytest.param(68, "saccade", id="K1 button 15"),
    ],
)
def test_a_mode(stage: Stage, number: int, mode: str) -> None:
    stage.press(number).play(0.1)
    assert stage.tick.mode.value == mode
    stage.turn(17, 127)
    assert len(stage.refused) == 1, "the personality does not count in a mode"


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
    stage: Stage, number: int, emotion: str
) -> None:
    stage.press(39).turn(6, 80).play(1.0)
    joints = dict(stage.tick.joints)
    stage.press(number).play(0.5)
    assert stage.tick.emotion == emotion
    assert stage.places()["intensity"] == pytest.approx(0.5 + 16 / 126, abs=0.01)
    assert stage.tick.joints == pytest.approx(joints)


@pytest.mark.toolkit("F3")
def test_slider_7_sets_the_intensity(stage: Stage) -> None:
    stage.press(39)
    for value in (0, 64, 127):
        stage.turn(6, value).play(0.5)
        assert stage.tick.intensity == pytest.approx((0, 0.5, 1)[value // 63], abs=0.01)


@pytest.mark.toolkit("F4")
def test_sliders_5_and_6_in_the_middle_are_no_mood(stage: Stage) -> None:
    stage.turn(5, 127).turn(4, 64).play(0.5)
    assert stage.tick.emotion == "happy"
    stage.turn(5, 64).play(2.0)
    assert stage.tick.emotion == "neutral"


def test_slider_3_zooms_both_upper_joints_in_opposite_directions(stage: Stage) -> None:
    stage.turn(0, 64).turn(1, 64).turn(2, 64).play(2.0)
    before = stage.tick.joints
    stage.turn(2, 96).play(2.0)
    after = stage.tick.joints
    moved = after["middle"] - before["middle"]
    assert moved > 5
    assert after["top"] - before["top"] == pytest.approx(-moved)
    stage.turn(2, 127).turn(0, 127).play(2.0)
    at_limit = stage.tick.joints
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
def test_what_is_not_mapped_has_no_effect(stage: Stage, number: int) -> None:
    before = stage.tick.joints
    stage.hear(f"b0 {number:02x} 00 {number:02x} 7f {number:02x} 40").play(0.5)
    assert stage.asks == []
    assert stage.tick.joints == before


@pytest.mark.toolkit("G7")
@pytest.mark.parametrize("name", BUILT_IN)
def test_the_first_touch_of_anything_that_turns_changes_nothing(tmp_path: Path, name: str) -> None:
    stage = Stage(tmp_path, name, take_over="soft")
    values, joints = stage.values(), stage.tick.joints
    turning = [
        it for it in mapped_controls(MidiSettings(map=name)) if not it.pressed and not it.free
    ]
    at_the_end = [it for it in turning if abs(stage.places()[it.mapped.control] - 1) < 0.02]
    for it in turning:
        value = 0 if it in at_the_end and not it.mapped.reversed else 127
        stage.turn(signal_of(it).number, value)
        ticks = stage.play(0.2)
        assert all(tick.joints == pytest.approx(joints) for tick in ticks), it.name
    assert stage.asks == []
    assert stage.values() == values


@pytest.mark.toolkit("R4")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    data=st.lists(st.binary(max_size=40), max_size=12), take_over=st.sampled_from(["soft", "jump"])
)
def test_whatever_the_panel_sends_the_body_stays_within_its_limits(
    tmp_path: Path, data: list[bytes], take_over: str
) -> None:
    stage = Stage(tmp_path, "nanokontrol2", take_over)
    for piece in data:
        # Half of it as control changes of known numbers, so that it means something.
        stage.hear(piece.hex()).hear("b0 " + bytes(byte & 0x7F for byte in piece).hex())
        for tick in stage.play(0.1):
            for joint, angle in tick.joints.items():
                shape = eyepi().joints[joint]
                assert shape.min <= angle <= shape.max


@pytest.mark.toolkit("M3")
def test_sliders_moved_during_the_demo_count_for_the_way_back(stage: Stage) -> None:
    stage.turn(16, 64).press(36).play(3.0)
    stage.turn(16, 127)
    assert stage.refused == []
    stage.press(35).play(3.0)
    assert stage.tick.mode.value == "normal"
    assert stage.tick.joints["pitch"] == pytest.approx(90, abs=0.01)


@pytest.mark.toolkit("G5")
def test_transport_keys_are_the_sessions(stage: Stage) -> None:
    for number in (42, 46, 41, 45):
        stage.press(number)
    assert [ask.what for ask in stage.asks] == ["stop", "release", "script", "mark"]
