"""The simulated visitor talks: segments, words, names, and a course that no clock can disturb."""

from __future__ import annotations

import random
from collections.abc import AsyncIterator
from itertools import groupby
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from woz_drivers.simulated import SimulatedSettings
from woz_drivers.simulated import visitor as words
from woz_drivers.simulated.microphone import (
    HANG_OVER,
    PRE_ROLL,
    UNDERSTOOD_AFTER,
    SpeechInProgress,
    SpeechSegmenter,
)
from woz_drivers.simulated.senses import THRESHOLD, TICK
from woz_drivers.simulated.verbs import offered, sensors
from woz_drivers.simulated.visitor import PEOPLE, STRANGERS, SimulatedVisitor, VisitPhase

from tests.example_counts import many
from tests.fakes.simulated_rig import Rig, rig
from woz_tui.drivers.contract import SPEECH, DriverError, RejectedError
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText

VISITED = SimulatedSettings(visitor=True, seed=7)
LOUD, QUIET = 0.1, 0.01


# -- the microphone -------------------------------------------------------------------------------


def test_a_segment_has_pre_roll_hang_over_and_words() -> None:
    hearing = SpeechSegmenter(THRESHOLD, TICK)
    told: list[SpeechInProgress] = []
    for tick in range(60):
        if tick == 20:
            hearing.words("How old is it?")
        told += hearing.add(LOUD if 20 <= tick < 35 else QUIET)
    started, speech_in_progress, text = told
    assert (started.what, speech_in_progress.what, text.what) == ("started", "ended", "text")
    assert started.began == speech_in_progress.began == pytest.approx((20 - PRE_ROLL) * TICK)
    assert speech_in_progress.ended == pytest.approx((35 + HANG_OVER) * TICK)
    assert speech_in_progress.t == pytest.approx(speech_in_progress.ended), (
        "told with the chunk that completes it"
    )
    assert speech_in_progress.loudest == LOUD
    assert text.text == "How old is it?"
    assert text.t == pytest.approx(speech_in_progress.ended + UNDERSTOOD_AFTER * TICK)


def test_what_a_visitor_says_is_heard_segment_by_segment() -> None:
    visitor = SimulatedVisitor(7)
    visitor.step(600.0)
    speech = visitor.speech()
    assert visitor.speech() == [], "told once"
    numbers = [one.segment for one in speech if one.what == "started"]
    assert numbers == list(range(1, len(numbers) + 1))
    assert len(numbers) >= 10
    texts = {one.text for one in speech if one.what == "text"}
    assert len(texts) >= 4
    assert texts <= set(words.REMARKS)


# -- words ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "answer"),
    [
        ("I do not think we have met. What is your name?", "Kim."),
        ("What may I call you?", "Kim."),
        ("Who are you?", "Kim."),
        ("kim, is that right?", "Yes."),
        ("I know Kim already. Is that you?", "Yes."),
        ("Tim, is that right?", "No."),
    ],
)
def test_strangers_answer_what_is_asked_about_their_name(said: str, answer: str) -> None:
    assert words.reply("Kim", said, random.Random(1)) == answer
    assert words.is_about_the_name("Kim", said)


def test_other_questions_and_sentences_get_other_answers() -> None:
    chance = random.Random(1)
    assert words.reply("Kim", "Shall I tell you how old it is?", chance) in words.ANSWERS
    assert words.reply("Kim", "Nice to meet you, Kim!", chance) not in ("Yes.", "Kim.")
    assert not words.is_about_the_name("Kim", "Nice to meet you, Kim!")


# -- faces ----------------------------------------------------------------------------------------


def standing(visitor: SimulatedVisitor, person: str, now: float = 0.0) -> float:
    """Let time pass until this person stands there and is silent; returns the time."""
    while not (
        visitor.phase is VisitPhase.STAYING and visitor.person == person and not visitor.talking
    ):
        now += 0.1
        visitor.step(now)
        assert now < 3000, f"{person} never came"
    return now


def names(visitor: SimulatedVisitor, until: float) -> set[str]:
    return {sample.text for sample in visitor.step(until) if sample.sensor == "identity"}


@pytest.mark.parametrize("person", STRANGERS)
def test_a_stranger_is_recognised_once_introduced(person: str) -> None:
    visitor = SimulatedVisitor(7)
    now = standing(visitor, person)
    assert names(visitor, now + 5) == {""}
    assert visitor.learn_face("V9")
    assert "V9" in names(visitor, now + 15)
    gone = now + 15
    while visitor.present:
        gone += 1
        visitor.step(gone)
    assert not visitor.learn_face("V10"), "nobody is there"
    again = standing(visitor, person, gone)
    assert "V9" in names(visitor, again + 8), "and when they come again"


def test_those_whom_the_robot_knows_are_called_by_their_name() -> None:
    visitor = SimulatedVisitor(7)
    for person in PEOPLE:
        now = standing(visitor, person, 0.0)
        assert person in names(visitor, now + 10)
        visitor = SimulatedVisitor(7)


# -- answers and the clock ------------------------------------------------------------------------


def talked(seed: int, lateness: random.Random | None) -> list[tuple[str, int, str]]:
    """Ten minutes with a robot that answers everything; `lateness` shakes its clock as a busy
    machine does, and cuts the steps anew.
    """
    visitor = SimulatedVisitor(seed)
    course: list[tuple[str, int, str]] = []
    for tick in range(1, 6000):
        late = lateness.uniform(0.0, 0.07) if lateness else 0.0
        if lateness and lateness.random() < 0.1:
            continue
        visitor.step(tick * TICK + late)
        for one in visitor.speech():
            course.append((one.what, one.segment, one.text))
            if one.what == "ended":
                visitor.hear(one.t + late, 2.345, "Is that so?")
    return course


@settings(max_examples=many(5, 200))
@given(st.integers(0, 2**31 - 1))
def test_a_clock_that_is_not_quite_on_time_changes_nothing(seed: int) -> None:
    exact = talked(seed, None)
    shaken = talked(seed, random.Random(seed))
    common = min(len(exact), len(shaken))
    assert abs(len(exact) - len(shaken)) <= 2, "at the end one of them may be a step behind"
    assert shaken[:common] == exact[:common]


def test_whoever_has_answered_enough_thanks_and_goes() -> None:
    visitor = SimulatedVisitor(7)
    now = standing(visitor, "V1")
    visitor.speech()  # whatever others have said
    said: list[str] = []
    while visitor.present:
        if not visitor.hearing.ends.speaks:
            visitor.hear(now, 1.0, "And that is the whale.")
        now += 6.0
        visitor.step(now)
        said += [one.text for one in visitor.speech() if one.what == "text"]
        assert now < 400
    assert said[-1] == words.GOODBYE
    assert 2 <= len(said) <= 6


def test_whoever_says_goodbye_goes_though_the_robot_talks_on() -> None:
    visitor = SimulatedVisitor(7)
    now = standing(visitor, "V1")
    said: list[str] = []
    while visitor.present:
        if visitor.hearing.ends.speaks or not said:  # it never lets them finish
            visitor.hear(now, 0.5, "And that is the whale.")
        now += 0.1
        visitor.step(now)
        said += [one.text for one in visitor.speech() if one.what == "text"]
        assert now < 400
    assert said.count(words.GOODBYE) == 1


def test_being_asked_for_a_name_is_not_too_much() -> None:
    visitor = SimulatedVisitor(7)
    now = standing(visitor, "Kim")
    for _ in range(8):
        visitor.hear(now, 1.0, "What is your name?")
        now += 6.0
        visitor.step(now)
        assert "Kim." in {one.text for one in visitor.speech()}


# -- as a driver ----------------------------------------------------------------------------------


@pytest.fixture
async def robot(tmp_path: Path) -> AsyncIterator[Rig]:
    async with rig(tmp_path, VISITED) as simulated_rig:
        yield simulated_rig


def test_speech_and_faces_are_there_with_a_visitor_only() -> None:
    alone = SimulatedSettings()
    voice = SimulatedSettings(visitor=True, voice_only=True)
    assert SPEECH in sensors(VISITED)
    assert SPEECH in sensors(voice)
    assert SPEECH not in sensors(alone)
    assert [verb.name for verb in offered(voice)][-2:] == ["face_consent", "learn_face"]
    assert "learn_face" not in {verb.name for verb in offered(alone)}


async def test_speech_goes_out_as_messages_with_times_of_the_log(robot: Rig) -> None:
    for _ in range(40):
        await robot.pace.advance(1.0)
    told = robot.context.told
    assert [type(one) for one in told[:3]] == [SpeechStarted, SpeechEnded, SpeechText]
    started, ended, text = told[:3]
    assert isinstance(started, SpeechStarted)
    assert isinstance(ended, SpeechEnded)
    assert isinstance(text, SpeechText)
    assert ended.began == started.began
    assert 1_800_000 < ended.ended - ended.began < 6_000_000
    assert (ended.file, ended.detail) == ("", "")
    assert text.took_us == UNDERSTOOD_AFTER * 100_000
    states = [state for sensor, state, _ in robot.context.states if sensor == "loudness"]
    assert [state for state, _ in groupby(states)][:3] == ["quiet", "speaking", "quiet"]


async def test_an_unplugged_microphone_ends_the_segment_and_says_why(robot: Rig) -> None:
    while not robot.context.told:
        await robot.pace.advance(0.1)
    await robot.do("fault", kind="disconnect", seconds=3.0)
    await robot.pace.advance(8.0)
    started, ended, *rest = robot.context.told
    assert isinstance(started, SpeechStarted)
    assert isinstance(ended, SpeechEnded)
    assert ended.detail == "the sound stopped: unplugged (simulated fault)"
    assert ended.ended > ended.began
    assert all(one.segment > 1 for one in rest), "nothing more of that segment"


async def test_a_face_is_learnt_by_a_verb(robot: Rig) -> None:
    with pytest.raises(DriverError, match="nobody shows a face"):
        await robot.do("learn_face", name="V9")
    for _ in range(20):
        await robot.pace.advance(0.5)
    assert (await robot.do("learn_face", name=" V9 ")) == {"name": "V9"}
    await robot.pace.advance(4.0)
    assert "V9" in {reading.text for reading in robot.context.of("identity")}


async def test_a_face_is_forgotten_with_the_consent(robot: Rig) -> None:
    for _ in range(20):
        await robot.pace.advance(0.5)
    await robot.do("learn_face", name="V9")
    assert (await robot.do("face_consent", name="V9", given=True)) == {"name": "V9", "given": True}
    told = [await robot.do("face_consent", name=" v9 ", given=False) for _ in range(2)]
    assert [each["deleted"] for each in told] == [True, False]
    before = len(robot.context.of("identity"))
    await robot.pace.advance(4.0)
    assert "V9" not in {reading.text for reading in robot.context.of("identity")[before:]}
    with pytest.raises(RejectedError, match="needs a name"):
        await robot.do("face_consent", name=" ", given=False)


async def test_a_face_without_a_name_or_with_somebody_elses_is_refused(robot: Rig) -> None:
    for _ in range(20):
        await robot.pace.advance(0.5)
    with pytest.raises(RejectedError, match="needs a name"):
        await robot.do("learn_face", name="  ")
    with pytest.raises(RejectedError, match="somebody else"):
        await robot.do("learn_face", name="V1")  # V2 stands there
    with pytest.raises(RejectedError, match="cannot learn_face"):
        async with rig(robot.context.folder) as alone:
            await alone.do("learn_face", name="V9")
