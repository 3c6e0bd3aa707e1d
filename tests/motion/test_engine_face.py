"""Who writes the face last, and the breakdown that leads back."""

from __future__ import annotations

import math

import pytest

from tests.motion.bodies import NODDER, STILL, Rig
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.emotions import emotion_affect
from woz_tui.motion.face_drawing import CRASH_S


@pytest.mark.toolkit("F5")
def test_the_last_one_to_write_an_emotion_counts_and_the_others_follow() -> None:
    rig = Rig()
    rig.do("emotion", emotion="happy", intensity=0.8)
    assert (rig.tick().emotion, rig.last.intensity) == ("happy", 0.8)
    values = rig.engine.values()
    assert (values["valence"], values["arousal"]) == emotion_affect("happy", 0.8)

    rig.do("affect", valence=-0.5, arousal=0.5)
    assert rig.tick().emotion == "angry"
    assert rig.last.intensity == pytest.approx(math.sqrt(0.5))
    controls = rig.engine.state().controls
    assert controls["valence"] == pytest.approx(0.25)
    assert controls["arousal"] == pytest.approx(0.75)
    assert controls["intensity"] == pytest.approx(math.sqrt(0.5))

    rig.do("control", control="intensity", value=0.3)
    assert (rig.tick().emotion, rig.last.intensity) == ("angry", 0.3)
    assert rig.engine.values()["valence"] == emotion_affect("angry", 0.3)[0]

    rig.do("emotion", emotion="sleepy")  # a button: the intensity is kept
    assert (rig.tick().emotion, rig.last.intensity) == ("sleepy", 0.3)

    rig.do("control", control="valence", value=1.0)
    rig.do("control", control="arousal", value=0.5)
    assert (rig.tick().emotion, rig.last.intensity) == ("happy", 1.0)


@pytest.mark.toolkit("F5")
def test_a_mood_turned_to_the_middle_is_neutral_and_keeps_the_intensity_for_later() -> None:
    rig = Rig()
    rig.do("emotion", emotion="sad", intensity=0.7)
    rig.do("affect", valence=0.0, arousal=0.0)
    assert (rig.tick().emotion, rig.last.intensity) == ("neutral", 0.0)
    rig.do("emotion", emotion="happy")
    assert (rig.tick().emotion, rig.last.intensity) == ("happy", 0.7)


@pytest.mark.toolkit("F7")
@pytest.mark.parametrize("former", ["happy", "neutral"])
def test_a_breakdown_is_the_faces_alone_and_ends_with_the_former_emotion(former: str) -> None:
    rig = Rig()
    rig.do("emotion", emotion=former, intensity=0.6)
    before = rig.run(0.1)[-1]
    answer = rig.do("emotion", emotion="crash")
    ticks = rig.wait(answer)
    assert answer.seconds == CRASH_S
    assert len(ticks) * 0.02 == pytest.approx(CRASH_S, abs=0.03)
    assert {tick.emotion for tick in ticks[:-1]} == {"crash"}
    assert len({tick.face for tick in ticks}) > 20
    assert {tuple(tick.joints.items()) for tick in ticks} == {tuple(before.joints.items())}
    rig.tick()
    assert (rig.last.emotion, rig.last.intensity) == (before.emotion, before.intensity)
    assert rig.last.face == before.face


@pytest.mark.toolkit("F7")
def test_the_stop_or_another_emotion_ends_a_breakdown() -> None:
    rig = Rig()
    rig.do("emotion", emotion="sad")
    first = rig.do("emotion", emotion="crash")
    rig.run(1.0)
    rig.do("mode", mode="normal")
    ticks = rig.run(0.04)
    assert [(e.token, e.why) for e in ticks[0].ended] == [(first.token, "stopped")]
    assert rig.last.emotion == "sad"
    second = rig.do("emotion", emotion="crash")
    rig.run(0.5)
    rig.do("emotion", emotion="happy")
    assert [(e.token, e.why) for e in rig.tick().ended] == [(second.token, "replaced by happy")]
    assert rig.last.emotion == "happy"


@pytest.mark.toolkit("F5", "F7")
def test_a_breakdown_goes_on_while_a_move_is_played() -> None:
    rig = Rig()
    rig.do("emotion", emotion="crash")
    ticks = rig.wait(rig.do("play", move="nod"))
    assert {tick.emotion for tick in ticks} == {"crash"}
    assert len({tick.joints["top"] for tick in ticks}) > 10


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_every_emotion_can_be_shown(emotion: str) -> None:
    rig = Rig(NODDER)
    rig.do("emotion", emotion=emotion, intensity=1.0)
    assert rig.tick().emotion == emotion
    assert rig.engine.state().emotion == emotion


def test_brightness_and_gaze() -> None:
    rig = Rig()
    middle = rig.last.face
    rig.do("brightness", level=0.2)
    rig.do("look", x=1.0, y=-1.0)
    assert rig.tick().brightness == 0.2
    assert rig.last.face != middle
    for args in ({"x": 1.5}, {"y": math.nan}, {"x": "left"}):
        with pytest.raises(RejectedError):
            rig.engine.apply("look", args)
    assert rig.engine.eyes == (1.0, -1.0)
    assert STILL.face is not None
