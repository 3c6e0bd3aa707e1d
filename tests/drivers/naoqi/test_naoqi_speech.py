"""ALTextToSpeech, ALAnimatedSpeech, ALAnimationPlayer, ALBehaviorManager."""

from __future__ import annotations

import asyncio

import pytest
from naoqi_simulator.speech import LETTERS_PER_S, Animate, Pause, Words, animated

from tests.drivers.naoqi.robot_callers import RobotCallError, SimulatedRobotRig

HEY = "animations/Stand/Gestures/Hey_1"
YES = "animations/Stand/Gestures/Yes_1"
#: Seconds that both take here.
GESTURE_S = 2.5
DONE = "ALTextToSpeech/TextDone"


async def spoken_texts(rig: SimulatedRobotRig) -> list[tuple[str, bool]]:
    return [(one["text"], one["whole"]) for one in await rig.robot.get("said")]


async def test_speech_lasts_as_long_as_its_text(rig: SimulatedRobotRig) -> None:
    text = "a" * 45
    task = await rig.begin("ALTextToSpeech.say", text, kind="speech")
    await rig.time.advance(45 / LETTERS_PER_S)
    assert await rig.pending(task)
    await rig.time.advance(0.2)
    await rig.done(task)
    assert await spoken_texts(rig) == [(text, True)]
    assert await rig.call("ALMemory.getData", DONE) == 1


async def test_twice_the_speed_takes_half_the_time(rig: SimulatedRobotRig) -> None:
    await rig.call("ALTextToSpeech.setParameter", "speed", 200)
    task = await rig.begin("ALAnimatedSpeech.say", "a" * 60, kind="speech")
    await rig.time.advance(2.0)
    assert await rig.pending(task)
    await rig.time.advance(0.2)
    await rig.done(task)


async def test_stop_ends_what_is_said_and_what_waits(rig: SimulatedRobotRig) -> None:
    first = await rig.begin("ALTextToSpeech.say", "one sentence", kind="speech")
    second = asyncio.ensure_future(rig.call("ALTextToSpeech.say", "another sentence"))
    await rig.robot.called("ALTextToSpeech.say", 2)
    await rig.time.advance(0.3)
    await rig.call("ALTextToSpeech.stopAll")
    await rig.done(first)
    await rig.done(second)
    assert await spoken_texts(rig) == [("one sentence", False)]
    assert await rig.call("ALMemory.getData", "ALTextToSpeech/TextInterrupted") == 1
    with pytest.raises(RobotCallError):
        await rig.call("ALMemory.getData", DONE)


async def test_after_a_stop_it_speaks_again(rig: SimulatedRobotRig) -> None:
    await rig.call("ALTextToSpeech.stopAll")
    task = await rig.begin("ALTextToSpeech.say", "hello", kind="speech")
    await rig.time.advance(1)
    await rig.done(task)
    assert await spoken_texts(rig) == [("hello", True)]


async def test_one_text_after_the_other(rig: SimulatedRobotRig) -> None:
    first = await rig.begin("ALTextToSpeech.say", "a" * 30, kind="speech")
    second = asyncio.ensure_future(rig.call("ALAnimatedSpeech.say", "b" * 30))
    await rig.robot.called("ALAnimatedSpeech.say")
    await rig.time.advance(2.2)
    await rig.done(first)
    assert await rig.pending(second)
    await rig.time.advance(2.2)
    await rig.done(second)


async def test_settings_of_the_voice(rig: SimulatedRobotRig) -> None:
    await rig.call("ALTextToSpeech.setVolume", 0.25)
    assert await rig.call("ALTextToSpeech.getVolume") == 0.25
    await rig.call("ALTextToSpeech.setParameter", "pitchShift", 1.5)
    assert await rig.call("ALTextToSpeech.getParameter", "pitchShift") == 1.5


@pytest.mark.parametrize(
    ("name", "value"), [("speed", 20), ("speed", 500), ("pitchShift", 0.5), ("pitchShift", 5)]
)
async def test_settings_out_of_range_are_refused(
    rig: SimulatedRobotRig, name: str, value: float
) -> None:
    with pytest.raises(RobotCallError, match="out of range"):
        await rig.call("ALTextToSpeech.setParameter", name, value)


async def test_tags_change_the_manner_and_pause(rig: SimulatedRobotRig) -> None:
    text = r"\vct=120\ high \pau=1000\ \rspd=50\ slow \rst\ as ever"
    task = await rig.begin("ALAnimatedSpeech.say", text, kind="speech")
    await rig.time.advance(3)
    await rig.done(task)
    manners = [(one["text"], one["vct"], one["rspd"]) for one in await rig.robot.get("said")]
    assert manners == [("high", 120, 100), ("slow", 120, 50), ("as ever", 100, 100)]


async def test_a_pause_is_as_long_as_it_says(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAnimatedSpeech.say", r"\pau=3000\ hi", kind="speech")
    await rig.time.advance(3.1)
    assert await spoken_texts(rig) == []
    await rig.time.advance(0.5)
    await rig.done(task)
    assert await spoken_texts(rig) == [("hi", True)]


async def test_run_in_a_text_waits_for_the_animation(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAnimatedSpeech.say", f"hi ^run({HEY}) you", kind="speech")
    await rig.time.advance(GESTURE_S)
    assert await spoken_texts(rig) == [("hi", True)]
    await rig.time.advance(1)
    await rig.done(task)
    assert await spoken_texts(rig) == [("hi", True), ("you", True)]
    assert await rig.robot.get("animations") == [HEY]


async def test_start_in_a_text_goes_on_beside_it_until_wait(rig: SimulatedRobotRig) -> None:
    text = f"^start({HEY}) hello ^wait({HEY})"
    task = await rig.begin("ALAnimatedSpeech.say", text, kind="speech")
    await rig.time.advance(1.5)
    assert await spoken_texts(rig) == [("hello", True)]
    assert await rig.robot.get("animations") == []
    assert await rig.pending(task)
    await rig.time.advance(GESTURE_S)
    await rig.done(task)
    assert await rig.robot.get("animations") == [HEY]


async def test_stop_in_a_text_ends_the_animation(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAnimatedSpeech.say", f"^start({HEY}) hi ^stop({HEY})", kind="speech")
    await rig.time.advance(1.0)
    await rig.done(task)
    assert await rig.robot.get("going") == []
    assert await rig.robot.get("animations") == []


async def test_an_unknown_animation_in_a_text_is_noted_and_speech_goes_on(
    rig: SimulatedRobotRig,
) -> None:
    task = await rig.begin("ALAnimatedSpeech.say", "one ^run(nothing/here) two", kind="speech")
    await rig.time.advance(2)
    await rig.done(task)
    assert await spoken_texts(rig) == [("one", True), ("two", True)]
    assert "nothing/here is not installed" in str(await rig.robot.get("notes"))


async def test_a_tag_in_a_text_stands_for_any_of_its_animations(rig: SimulatedRobotRig) -> None:
    text = "^startTag(hey) hi ^waitTag(hey) ^runTag(nonsense) ^pCall(ALMotion.rest()) bye"
    task = await rig.begin("ALAnimatedSpeech.say", text, kind="speech")
    await rig.time.advance(4)
    await rig.done(task)
    assert await spoken_texts(rig) == [("hi", True), ("bye", True)]
    (played,) = await rig.robot.get("animations")
    assert "/Hey_" in played
    unknown, not_simulated = await rig.robot.get("notes")
    assert "nonsense" in unknown
    assert "^pCall" in not_simulated


async def test_an_animation_lasts_its_length(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAnimationPlayer.run", HEY, kind="animation")
    assert await rig.call("ALBehaviorManager.getRunningBehaviors") == [HEY]
    await rig.time.advance(GESTURE_S - 0.1)
    assert await rig.pending(task)
    await rig.time.advance(0.2)
    await rig.done(task)


async def test_two_animations_cannot_have_the_body_at_once(rig: SimulatedRobotRig) -> None:
    first = await rig.begin("ALAnimationPlayer.run", HEY, kind="animation")
    second = asyncio.ensure_future(rig.call("ALAnimationPlayer.run", YES))
    await rig.robot.called("ALAnimationPlayer.run", 2)
    await rig.time.advance(1.1)
    with pytest.raises(RobotCallError, match="Hey_1 has the body"):
        await rig.done(second)
    await rig.time.advance(GESTURE_S)
    await rig.done(first)


async def test_an_animation_needs_the_motors(rig: SimulatedRobotRig) -> None:
    rest = await rig.begin("ALMotion.rest", kind="posture")
    await rig.time.advance(3)
    await rig.done(rest)
    with pytest.raises(RobotCallError, match="not awake"):
        await rig.call("ALAnimationPlayer.run", HEY)


@pytest.mark.parametrize("path", ["nothing", "animations/Stand/Gestures/Hey_99", ""])
async def test_an_unknown_animation_is_refused(rig: SimulatedRobotRig, path: str) -> None:
    with pytest.raises(RobotCallError, match="not installed"):
        await rig.call("ALAnimationPlayer.run", path)


async def test_patterns_in_paths_are_filled_in(rig: SimulatedRobotRig) -> None:
    task = await rig.begin(
        "ALAnimationPlayer.run", "animations/[posture]/Gestures/Hey_1", kind="animation"
    )
    await rig.time.advance(GESTURE_S)
    await rig.done(task)
    assert await rig.robot.get("animations") == [HEY]


async def test_cancelling_the_call_ends_the_animation(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAnimationPlayer.run", HEY, kind="animation")
    task.cancel()

    async def ended() -> bool:
        return not rig.pepper.world.going.of("animation")

    await rig.robot.until(ended)
    assert await rig.robot.get("animations") == []


async def test_cancelling_the_call_does_not_end_speech(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALTextToSpeech.say", "hello there", kind="speech")
    task.cancel()
    await rig.call("ALSystem.robotName")
    assert rig.pepper.voice.speaking
    await rig.time.advance(2)
    assert await spoken_texts(rig) == [("hello there", True)]


async def test_a_behaviour_is_stopped_by_its_path(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALAnimationPlayer.run", HEY, kind="animation")
    await rig.call("ALBehaviorManager.stopBehavior", YES)
    assert await rig.pending(task)
    await rig.call("ALBehaviorManager.stopBehavior", HEY)
    await rig.done(task)


async def test_all_behaviours_are_listed(rig: SimulatedRobotRig) -> None:
    there = await rig.call("ALBehaviorManager.getInstalledBehaviors")
    assert {HEY, YES} <= set(there)
    assert len(there) == len(set(there)) > 300


@pytest.mark.parametrize("begun", ["\\a=", "^run(", "^run(()"])
def test_a_tag_that_is_never_closed_is_looked_for_quickly(begun: str) -> None:
    """With a search that goes back over the blanks this test does not end."""
    (words,) = animated(begun + " " * 20_000)
    assert isinstance(words, Words)
    assert words.text == begun


def test_blanks_in_a_tag_do_not_count() -> None:
    pieces = animated("\\ pau = 500 \\ ^run( a/b )")
    assert pieces == [Pause(0.5), Animate("run", "a/b")]
