"""ALTextToSpeech, ALAnimatedSpeech, ALAnimationPlayer, ALBehaviorManager."""

from __future__ import annotations

import asyncio

import pytest
from naoqi_simulator.speech import LETTERS_PER_S, Animate, Pause, Words, animated

from tests.drivers.naoqi.hands import Said, Wired

HEY = "animations/Stand/Gestures/Hey_1"
YES = "animations/Stand/Gestures/Yes_1"
#: Seconds that both take here.
GESTURE_S = 2.5
DONE = "ALTextToSpeech/TextDone"


async def said(wired: Wired) -> list[tuple[str, bool]]:
    return [(one["text"], one["whole"]) for one in await wired.robot.get("said")]


async def test_speech_lasts_as_long_as_its_text(wired: Wired) -> None:
    text = "a" * 45
    task = await wired.begin("ALTextToSpeech.say", text, kind="speech")
    await wired.time.advance(45 / LETTERS_PER_S)
    assert await wired.pending(task)
    await wired.time.advance(0.2)
    await wired.done(task)
    assert await said(wired) == [(text, True)]
    assert await wired.call("ALMemory.getData", DONE) == 1


async def test_twice_the_speed_takes_half_the_time(wired: Wired) -> None:
    await wired.call("ALTextToSpeech.setParameter", "speed", 200)
    task = await wired.begin("ALAnimatedSpeech.say", "a" * 60, kind="speech")
    await wired.time.advance(2.0)
    assert await wired.pending(task)
    await wired.time.advance(0.2)
    await wired.done(task)


async def test_stop_ends_what_is_said_and_what_waits(wired: Wired) -> None:
    first = await wired.begin("ALTextToSpeech.say", "one sentence", kind="speech")
    second = asyncio.ensure_future(wired.call("ALTextToSpeech.say", "another sentence"))
    await wired.robot.called("ALTextToSpeech.say", 2)
    await wired.time.advance(0.3)
    await wired.call("ALTextToSpeech.stopAll")
    await wired.done(first)
    await wired.done(second)
    assert await said(wired) == [("one sentence", False)]
    assert await wired.call("ALMemory.getData", "ALTextToSpeech/TextInterrupted") == 1
    with pytest.raises(Said):
        await wired.call("ALMemory.getData", DONE)


async def test_after_a_stop_it_speaks_again(wired: Wired) -> None:
    await wired.call("ALTextToSpeech.stopAll")
    task = await wired.begin("ALTextToSpeech.say", "hello", kind="speech")
    await wired.time.advance(1)
    await wired.done(task)
    assert await said(wired) == [("hello", True)]


async def test_one_text_after_the_other(wired: Wired) -> None:
    first = await wired.begin("ALTextToSpeech.say", "a" * 30, kind="speech")
    second = asyncio.ensure_future(wired.call("ALAnimatedSpeech.say", "b" * 30))
    await wired.robot.called("ALAnimatedSpeech.say")
    await wired.time.advance(2.2)
    await wired.done(first)
    assert await wired.pending(second)
    await wired.time.advance(2.2)
    await wired.done(second)


async def test_settings_of_the_voice(wired: Wired) -> None:
    await wired.call("ALTextToSpeech.setVolume", 0.25)
    assert await wired.call("ALTextToSpeech.getVolume") == 0.25
    await wired.call("ALTextToSpeech.setParameter", "pitchShift", 1.5)
    assert await wired.call("ALTextToSpeech.getParameter", "pitchShift") == 1.5


@pytest.mark.parametrize(
    ("name", "value"), [("speed", 20), ("speed", 500), ("pitchShift", 0.5), ("pitchShift", 5)]
)
async def test_settings_out_of_range_are_refused(wired: Wired, name: str, value: float) -> None:
    with pytest.raises(Said, match="out of range"):
        await wired.call("ALTextToSpeech.setParameter", name, value)


async def test_tags_change_the_manner_and_pause(wired: Wired) -> None:
    text = r"\vct=120\ high \pau=1000\ \rspd=50\ slow \rst\ as ever"
    task = await wired.begin("ALAnimatedSpeech.say", text, kind="speech")
    await wired.time.advance(3)
    await wired.done(task)
    manners = [(one["text"], one["vct"], one["rspd"]) for one in await wired.robot.get("said")]
    assert manners == [("high", 120, 100), ("slow", 120, 50), ("as ever", 100, 100)]


async def test_a_pause_is_as_long_as_it_says(wired: Wired) -> None:
    task = await wired.begin("ALAnimatedSpeech.say", r"\pau=3000\ hi", kind="speech")
    await wired.time.advance(3.1)
    assert await said(wired) == []
    await wired.time.advance(0.5)
    await wired.done(task)
    assert await said(wired) == [("hi", True)]


async def test_run_in_a_text_waits_for_the_animation(wired: Wired) -> None:
    task = await wired.begin("ALAnimatedSpeech.say", f"hi ^run({HEY}) you", kind="speech")
    await wired.time.advance(GESTURE_S)
    assert await said(wired) == [("hi", True)]
    await wired.time.advance(1)
    await wired.done(task)
    assert await said(wired) == [("hi", True), ("you", True)]
    assert await wired.robot.get("animations") == [HEY]


async def test_start_in_a_text_goes_on_beside_it_until_wait(wired: Wired) -> None:
    text = f"^start({HEY}) hello ^wait({HEY})"
    task = await wired.begin("ALAnimatedSpeech.say", text, kind="speech")
    await wired.time.advance(1.5)
    assert await said(wired) == [("hello", True)]
    assert await wired.robot.get("animations") == []
    assert await wired.pending(task)
    await wired.time.advance(GESTURE_S)
    await wired.done(task)
    assert await wired.robot.get("animations") == [HEY]


async def test_stop_in_a_text_ends_the_animation(wired: Wired) -> None:
    task = await wired.begin(
        "ALAnimatedSpeech.say", f"^start({HEY}) hi ^stop({HEY})", kind="speech"
    )
    await wired.time.advance(1.0)
    await wired.done(task)
    assert await wired.robot.get("going") == []
    assert await wired.robot.get("animations") == []


async def test_an_unknown_animation_in_a_text_is_noted_and_speech_goes_on(wired: Wired) -> None:
    task = await wired.begin("ALAnimatedSpeech.say", "one ^run(nothing/here) two", kind="speech")
    await wired.time.advance(2)
    await wired.done(task)
    assert await said(wired) == [("one", True), ("two", True)]
    assert "nothing/here is not installed" in str(await wired.robot.get("notes"))


async def test_a_tag_in_a_text_stands_for_any_of_its_animations(wired: Wired) -> None:
    text = "^startTag(hey) hi ^waitTag(hey) ^runTag(nonsense) ^pCall(ALMotion.rest()) bye"
    task = await wired.begin("ALAnimatedSpeech.say", text, kind="speech")
    await wired.time.advance(4)
    await wired.done(task)
    assert await said(wired) == [("hi", True), ("bye", True)]
    (played,) = await wired.robot.get("animations")
    assert "/Hey_" in played
    unknown, not_simulated = await wired.robot.get("notes")
    assert "nonsense" in unknown
    assert "^pCall" in not_simulated


async def test_an_animation_lasts_its_length(wired: Wired) -> None:
    task = await wired.begin("ALAnimationPlayer.run", HEY, kind="animation")
    assert await wired.call("ALBehaviorManager.getRunningBehaviors") == [HEY]
    await wired.time.advance(GESTURE_S - 0.1)
    assert await wired.pending(task)
    await wired.time.advance(0.2)
    await wired.done(task)


async def test_two_animations_cannot_have_the_body_at_once(wired: Wired) -> None:
    first = await wired.begin("ALAnimationPlayer.run", HEY, kind="animation")
    second = asyncio.ensure_future(wired.call("ALAnimationPlayer.run", YES))
    await wired.robot.called("ALAnimationPlayer.run", 2)
    await wired.time.advance(1.1)
    with pytest.raises(Said, match="Hey_1 has the body"):
        await wired.done(second)
    await wired.time.advance(GESTURE_S)
    await wired.done(first)


async def test_an_animation_needs_the_motors(wired: Wired) -> None:
    rest = await wired.begin("ALMotion.rest", kind="posture")
    await wired.time.advance(3)
    await wired.done(rest)
    with pytest.raises(Said, match="not awake"):
        await wired.call("ALAnimationPlayer.run", HEY)


@pytest.mark.parametrize("path", ["nothing", "animations/Stand/Gestures/Hey_99", ""])
async def test_an_unknown_animation_is_refused(wired: Wired, path: str) -> None:
    with pytest.raises(Said, match="not installed"):
        await wired.call("ALAnimationPlayer.run", path)


async def test_patterns_in_paths_are_filled_in(wired: Wired) -> None:
    task = await wired.begin(
        "ALAnimationPlayer.run", "animations/[posture]/Gestures/Hey_1", kind="animation"
    )
    await wired.time.advance(GESTURE_S)
    await wired.done(task)
    assert await wired.robot.get("animations") == [HEY]


async def test_cancelling_the_call_ends_the_animation(wired: Wired) -> None:
    task = await wired.begin("ALAnimationPlayer.run", HEY, kind="animation")
    task.cancel()

    async def ended() -> bool:
        return not wired.pepper.world.going.of("animation")

    await wired.robot.until(ended)
    assert await wired.robot.get("animations") == []


async def test_cancelling_the_call_does_not_end_speech(wired: Wired) -> None:
    task = await wired.begin("ALTextToSpeech.say", "hello there", kind="speech")
    task.cancel()
    await wired.call("ALSystem.robotName")
    assert wired.pepper.voice.speaking
    await wired.time.advance(2)
    assert await said(wired) == [("hello there", True)]


async def test_a_behaviour_is_stopped_by_its_path(wired: Wired) -> None:
    task = await wired.begin("ALAnimationPlayer.run", HEY, kind="animation")
    await wired.call("ALBehaviorManager.stopBehavior", YES)
    assert await wired.pending(task)
    await wired.call("ALBehaviorManager.stopBehavior", HEY)
    await wired.done(task)


async def test_all_behaviours_are_listed(wired: Wired) -> None:
    there = await wired.call("ALBehaviorManager.getInstalledBehaviors")
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
