"""What the robot understands of what is said to it, over the wire."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.naoqi_robot.naoqi_settings import RecognitionSettings as Settings
from woz_drivers.naoqi_robot.recognition import DETECTED, RECOGNIZED, RecognitionPart, recognised
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.wired import Wired, wired
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import SPEECH, SPEECH_TEXT
from woz_tui.protocol.messages import SpeechEnded, SpeechStarted, SpeechText

HEARS = Settings(phrases=("yes", "no", "Ada"), language="English")
SOMEBODY = {"distance": 1.0, "looking": True}

Listens = Callable[..., AbstractAsyncContextManager[Wired[RecognitionPart]]]


@pytest.fixture
def listens(tmp_path: Path, robot: StandIn) -> Listens:
    def begin(settings: Settings = HEARS) -> Any:
        return wired(RecognitionPart, tmp_path, robot, recognition=settings)

    return begin


async def _looks(it: Wired[RecognitionPart]) -> None:
    """Return when the robot has been asked once more, from beginning to end."""
    asked = len(await it.robot.trace("ALMemory.getListData"))
    await it.robot.called("ALMemory.getListData", asked + 3)


def _said(it: Wired[RecognitionPart]) -> list[tuple[int, str]]:
    return [(one.segment, one.text) for one in it.heard.all(SpeechText)]


def _segments(it: Wired[RecognitionPart]) -> list[int]:
    begun, ended = it.heard.all(SpeechStarted), it.heard.all(SpeechEnded)
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
    async with listens() as it:
        for spoken, understood in (("Yes.", "yes"), ("My name is Ada!", "Ada"), ("yes", "yes")):
            before = len(_said(it))
            await robot.set("says", spoken)
            await it.heard.until(lambda before=before: len(_said(it)) > before)  # type: ignore[misc]
            assert _said(it)[-1][1] == understood
            await _looks(it)
        assert _said(it) == [(1, "yes"), (2, "Ada"), (3, "yes")]
        assert _segments(it) == [1, 2, 3]
        (vocabulary,) = await robot.trace("ALSpeechRecognition.setVocabulary")
        assert vocabulary.args == [["yes", "no", "Ada"], True]
    assert len(await robot.trace("ALSpeechRecognition.unsubscribe")) == 2


async def test_what_is_not_in_the_list_is_speech_without_a_text(tmp_path: Path) -> None:
    # At its own pace: a sentence lasts longer than the driver takes to ask again.
    async with (
        stand_in(pace=1.0) as robot,
        wired(RecognitionPart, tmp_path, robot, recognition=HEARS) as it,
    ):
        await robot.person(SOMEBODY)
        await robot.set("says", "Where are the toilets?")
        await it.heard.first(SpeechEnded)
        await _looks(it)
        assert _said(it) == []
        await robot.set("says", "no")
        await it.heard.first(SpeechText)
        assert _said(it) == [(2, "no")]


async def test_words_without_a_beginning_are_a_segment_of_their_own(
    listens: Listens, robot: StandIn
) -> None:
    async with listens() as it:
        await robot.set(f"memory:{RECOGNIZED}", ["no", 0.9, "yes", 0.2])
        await it.heard.first(SpeechText)
        assert (_segments(it), _said(it)) == ([1], [(1, "no")])
        await robot.set(f"memory:{DETECTED}", True)
        await it.heard.first(SpeechStarted, after=1)
        await robot.set(f"memory:{RECOGNIZED}", ["yes", 0.9])
        await it.heard.first(SpeechText, after=1)
        await _looks(it)
        assert _said(it)[1:] == [(2, "yes")]
        assert len(it.heard.all(SpeechStarted)) == 2, "the robot lingers; nobody begins anew"


async def test_a_memory_that_takes_nothing_costs_no_more_than_its_moment(
    listens: Listens, robot: StandIn
) -> None:
    async with listens() as it:
        await robot.fault("refuse:ALMemory.insertData=busy")
        await robot.set(f"memory:{RECOGNIZED}", ["yes", 0.9])
        stale = await it.heard.state(SPEECH, "stale")
        assert "busy" in stale.why
        await robot.fault("none")
        await it.heard.first(SpeechText)
        await it.heard.state(SPEECH, "ready")
        assert _said(it) == [(1, "yes")]


async def test_old_words_and_sessions_do_not_count(listens: Listens, robot: StandIn) -> None:
    await robot.set(f"memory:{RECOGNIZED}", ["yes", 0.9])
    async with listens() as it:
        await _looks(it)
        assert it.heard.all(SpeechStarted) == []
        # What a session that was killed has left behind is in nobody's way.
        async with listens(settings=Settings(phrases=("blue",))) as other:
            assert other.troubles == []


async def test_a_language_that_is_not_there_is_told(listens: Listens, robot: StandIn) -> None:
    async with listens(settings=Settings(phrases=("si",), language="Klingon")) as it:
        (trouble,) = it.troubles
        assert "Klingon is not installed" in trouble.what
        assert it.heard.states(SPEECH) == ["stale"]


async def test_a_lost_robot_ends_what_somebody_says(listens: Listens, robot: StandIn) -> None:
    async with listens() as it:
        await robot.set(f"memory:{DETECTED}", True)
        await it.heard.first(SpeechStarted)
        robot.kill()
        ended = await it.heard.first(SpeechEnded)
        assert ended.detail


def test_it_listens_only_where_there_is_something_to_understand() -> None:
    assert RecognitionPart.sensors(PepperSettings(robots=())) == ()
    hears = PepperSettings(robots=(), recognition=HEARS)
    assert RecognitionPart.sensors(hears) == (SPEECH, SPEECH_TEXT)


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
