"""What the robot understands of what is said to it, over the wire."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.naoqi_robot.recognition import DETECTED, RECOGNIZED, RecognitionPart, recognised
from woz_drivers.naoqi_robot.settings import RecognitionSettings as Settings
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.part_rig import PartRig, connected_part
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import SPEECH, SPEECH_TEXT
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText

HEARS = Settings(phrases=("yes", "no", "Ada"), language="English")
SOMEBODY = {"distance": 1.0, "looking": True}

Listens = Callable[..., AbstractAsyncContextManager[PartRig[RecognitionPart]]]


@pytest.fixture
def listens(tmp_path: Path, robot: StandIn) -> Listens:
    def begin(settings: Settings = HEARS) -> Any:
        return connected_part(RecognitionPart, tmp_path, robot, recognition=settings)

    return begin


async def _looks(rig: PartRig[RecognitionPart]) -> None:
    """Return when the robot has been asked once more, from beginning to end."""
    asked = len(await rig.robot.trace("ALMemory.getListData"))
    await rig.robot.called("ALMemory.getListData", asked + 3)


def _speech_texts(rig: PartRig[RecognitionPart]) -> list[tuple[int, str]]:
    return [(one.segment, one.text) for one in rig.published.all(SpeechText)]


def _segments(rig: PartRig[RecognitionPart]) -> list[int]:
    begun, ended = rig.published.all(SpeechStarted), rig.published.all(SpeechEnded)
    assert all(one.began <= one.ended for one in ended)
    assert [one.segment for one in begun[: len(ended)]] == [one.segment for one in ended]
    return [one.segment for one in ended]


@pytest.mark.naoqi(
    "ALSpeechRecognition.setVocabulary",
    "ALSpeechRecognition.setLanguage",
    "ALSpeechRecognition.pause",
    "ALSpeechRecognition.subscribe",
    "ALSpeechRecognition.unsubscribe",
    "WordRecognized",
    "SpeechDetected",
)
async def test_phrases_of_the_list_come_as_text(listens: Listens, robot: StandIn) -> None:
    await robot.person(SOMEBODY)
    async with listens() as rig:
        for spoken, understood in (("Yes.", "yes"), ("My name is Ada!", "Ada"), ("yes", "yes")):
            before = len(_speech_texts(rig))
            await robot.set("says", spoken)
            await rig.published.until(lambda before=before: len(_speech_texts(rig)) > before)  # type: ignore[misc]
            assert _speech_texts(rig)[-1][1] == understood
            await _looks(rig)
        assert _speech_texts(rig) == [(1, "yes"), (2, "Ada"), (3, "yes")]
        assert _segments(rig) == [1, 2, 3]
        (vocabulary,) = await robot.trace("ALSpeechRecognition.setVocabulary")
        assert vocabulary.args == [["yes", "no", "Ada"], True]
    assert len(await robot.trace("ALSpeechRecognition.unsubscribe")) == 2


async def test_what_is_not_in_the_list_is_speech_without_a_text(tmp_path: Path) -> None:
    # At its own pace: a sentence lasts longer than the driver takes to ask again.
    async with (
        stand_in(pace=1.0) as robot,
        connected_part(RecognitionPart, tmp_path, robot, recognition=HEARS) as rig,
    ):
        await robot.person(SOMEBODY)
        await robot.set("says", "Where are the toilets?")
        await rig.published.first(SpeechEnded)
        await _looks(rig)
        assert _speech_texts(rig) == []
        await robot.set("says", "no")
        await rig.published.first(SpeechText)
        assert _speech_texts(rig) == [(2, "no")]


async def test_words_without_a_beginning_are_a_segment_of_their_own(
    listens: Listens, robot: StandIn
) -> None:
    async with listens() as rig:
        await robot.set(f"memory:{RECOGNIZED}", ["no", 0.9, "yes", 0.2])
        await rig.published.first(SpeechText)
        assert (_segments(rig), _speech_texts(rig)) == ([1], [(1, "no")])
        await robot.set(f"memory:{DETECTED}", True)
        await rig.published.first(SpeechStarted, after=1)
        await robot.set(f"memory:{RECOGNIZED}", ["yes", 0.9])
        await rig.published.first(SpeechText, after=1)
        await _looks(rig)
        assert _speech_texts(rig)[1:] == [(2, "yes")]
        assert len(rig.published.all(SpeechStarted)) == 2, "the robot lingers; nobody begins anew"


async def test_a_memory_that_takes_nothing_costs_no_more_than_its_moment(
    listens: Listens, robot: StandIn
) -> None:
    async with listens() as rig:
        await robot.fault("refuse:ALMemory.insertData=busy")
        await robot.set(f"memory:{RECOGNIZED}", ["yes", 0.9])
        stale = await rig.published.state(SPEECH, "stale")
        assert "busy" in stale.why
        await robot.fault("none")
        await rig.published.first(SpeechText)
        await rig.published.state(SPEECH, "ready")
        assert _speech_texts(rig) == [(1, "yes")]


async def test_old_words_and_sessions_do_not_count(listens: Listens, robot: StandIn) -> None:
    await robot.set(f"memory:{RECOGNIZED}", ["yes", 0.9])
    async with listens() as rig:
        await _looks(rig)
        assert rig.published.all(SpeechStarted) == []
        # What a session that was killed has left behind is in nobody's way.
        async with listens(settings=Settings(phrases=("blue",))) as other:
            assert other.troubles == []


async def test_a_language_that_is_not_there_is_told(listens: Listens, robot: StandIn) -> None:
    async with listens(settings=Settings(phrases=("si",), language="Klingon")) as rig:
        (trouble,) = rig.troubles
        assert "Klingon is not installed" in trouble.what
        assert rig.published.states(SPEECH) == ["stale"]


async def test_a_lost_robot_ends_what_somebody_says(listens: Listens, robot: StandIn) -> None:
    async with listens() as rig:
        await robot.set(f"memory:{DETECTED}", True)
        await rig.published.first(SpeechStarted)
        robot.kill()
        speech_ended = await rig.published.first(SpeechEnded)
        assert speech_ended.detail


def test_it_listens_only_where_there_is_something_to_understand() -> None:
    assert RecognitionPart.offer(PepperSettings(robots=())).sensors == ()
    hears = PepperSettings(robots=(), recognition=HEARS)
    assert RecognitionPart.offer(hears).sensors == (SPEECH, SPEECH_TEXT)


@pytest.mark.parametrize(
    ("value", "found"),
    [
        (["yes", 0.5, "no", 0.1], ("yes", 0.5)),
        (["<...> yes <...>", 0.5], ("yes", 0.5)),
        *((value, ("", 0.0)) for value in (None, [], ["", -3.0], ["a"], [1, 2], "yes", ["a", "b"])),
        (["a" * 10_000, 0.5], ("", 0.0)),
        (["yes", float("nan")], ("", 0.0)),
    ],
)
def test_whatever_the_robot_says_is_read(value: Any, found: tuple[str, float]) -> None:
    assert recognised(value) == found
