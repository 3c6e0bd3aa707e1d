"""Answers that make no sense: nothing breaks, nothing is taken for an answer, and it is told."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.naoqi_robot.animations import AnimationsPart
from woz_drivers.naoqi_robot.autonomy import AutonomyPart
from woz_drivers.naoqi_robot.base import BasePart
from woz_drivers.naoqi_robot.body import BodyPart
from woz_drivers.naoqi_robot.camera import frame
from woz_drivers.naoqi_robot.eyes import EyesPart
from woz_drivers.naoqi_robot.head import HeadPart
from woz_drivers.naoqi_robot.memory import flag, word
from woz_drivers.naoqi_robot.naoqi_link import readable
from woz_drivers.naoqi_robot.service_call import ServiceCallPart
from woz_drivers.naoqi_robot.sounds import SoundsPart
from woz_drivers.naoqi_robot.voice import VoicePart

from tests.drivers.heard import Ordered
from tests.drivers.pepper.babbler import SETTINGS, Babbler, babbler
from woz_tui.drivers.contract import DriverError, Scope

NAN, INF = math.nan, math.inf
#: Answers of every kind, none of which is what was asked for.
NONSENSE: tuple[Any, ...] = (
    *(None, "", "x", "L" * 100_000, b"\xff\0", [], [[]], {"a": 1}, ()),
    *(NAN, INF, -INF, [NAN, NAN], ["a", "b", "c"], [None, None], [[1.0], [2.0]]),
)


def test_flags_and_words_are_what_they_are() -> None:
    assert [flag(one) for one in (True, False, 1, 0, 1.0)] == [True, False, True, False, True]
    assert [flag(one) for one in (*NONSENSE, 2, -1)] == [None] * (len(NONSENSE) + 2)
    assert word("SitRelax") == "SitRelax"
    assert [word(one) for one in (7, b"x", "a\nb", "\x1b[2J", "L" * 101, None)] == [None] * 6


def test_what_a_robot_says_of_an_error_is_one_short_line() -> None:
    assert readable("no  joint\n called X\n\nAt: a.cpp") == "no joint called X"
    assert readable("\x1b[2Jgone") == "\ufffd[2Jgone"
    assert len(readable("L" * 3_000_000)) < 400


def test_a_kind_of_picture_is_told_in_few_words() -> None:
    told = frame([1, 1, 3, "L" * 3_000_000, 0, 0, b"\0\0\0"])
    assert isinstance(told, str)
    assert len(told) < 100


async def _fails(what: Any, telling: str) -> None:
    with pytest.raises(DriverError) as told:
        await what
    assert telling in told.value.what
    assert told.value.remedy


async def test_nothing_is_made_of_nonsense(tmp_path: Path) -> None:
    async with babbler(tmp_path) as it:
        await _settings(it)
        await _stops(it)
        await _verbs(it)


async def test_a_long_result_is_cut_short(tmp_path: Path) -> None:
    async with babbler(tmp_path) as it:
        call = ServiceCallPart(it.connection, SETTINGS, it.heard.context)
        for said, length in (("a" * 900, 900), ("L" * 3_000_000, 60_000), (["a"] * 40_000, 60_000)):
            it.says["ALTextToSpeech.getVolume"] = said
            told = await call.perform(Ordered("naoqi", {"call": "ALTextToSpeech.getVolume"}))
            assert isinstance(told["result"], str)
            assert len(told["result"]) <= length
            assert told["result"] == said or told["result"].endswith(" characters)")


async def _settings(it: Babbler) -> None:
    """Read back: what makes no sense is left out, what does is kept."""
    made = [
        kind(it.connection, SETTINGS, it.heard.context)
        for kind in (VoicePart, AutonomyPart, BodyPart, EyesPart)
    ]
    asked = (
        *("ALTextToSpeech.getParameter", "ALAutonomousLife.getState", "ALLeds.getIntensity"),
        *("ALBasicAwareness.isEnabled", "ALMotion.getTangentialSecurityDistance"),
        *("ALRobotPosture.getPosture", "ALMotion.robotIsWakeUp"),
    )
    it.says["ALTextToSpeech.getVolume"] = 0.25
    for nonsense in NONSENSE[3:]:
        it.says |= dict.fromkeys(asked, nonsense)
        read: dict[str, Any] = {}
        for part in made:
            read |= await part.read()
        assert read == {"volume": 0.25}, repr(nonsense)[:60]
    it.says |= {"ALBasicAwareness.isEnabled": 1, "ALLeds.getIntensity": [1.0, 0.0, 0.0]}
    assert (await made[1].read())["awareness"] is True
    assert (await made[3].read())["eyes"] == "#0000ff"


async def _stops(it: Babbler) -> None:
    """A stop is confirmed only by a robot that says that it stands."""
    base = BasePart(it.connection, SETTINGS, it.heard.context)
    for nonsense in NONSENSE:
        it.says["ALMotion.getRobotVelocity"] = nonsense
        await _fails(base.stop(Scope.ALL), "does not report its speed")
    it.says["ALMotion.getRobotVelocity"] = [0.0, 0, 0.001]
    assert await base.stop(Scope.DRIVE) == ("driving",)

    animations = AnimationsPart(it.connection, SETTINGS, it.heard.context)
    animations._playing = "animations/x"
    it.says["ALBehaviorManager.stopBehavior"] = ValueError("it is not running")
    for nonsense in NONSENSE:
        it.says["ALBehaviorManager.isBehaviorRunning"] = nonsense
        await _fails(animations.stop(Scope.ALL), "does not report whether animations/x has ended")
    it.says["ALBehaviorManager.isBehaviorRunning"] = False
    assert await animations.stop(Scope.ALL) == ("animations",)


async def _verbs(it: Babbler) -> None:
    """No angle that is none is sent to a joint, no file is played under a number that is none."""
    head = HeadPart(it.connection, SETTINGS, it.heard.context)
    sounds = SoundsPart(it.connection, SETTINGS, it.heard.context)
    drive = BasePart(it.connection, SETTINGS, it.heard.context)
    it.says |= {"ALMotion.robotIsWakeUp": True, "ALMotion.moveTo": False}
    for nonsense in NONSENSE:
        it.says["ALMotion.getStiffnesses"] = [1.0, 1.0]
        it.says["ALMotion.getAngles"] = nonsense
        await _fails(head.perform(Ordered("nudge", {"yaw": 5})), "does not report where")
        it.says["ALMotion.getStiffnesses"] = nonsense
        await _fails(head.perform(Ordered("gaze", {"yaw": 5})), "does not report whether")
        it.says["ALAudioPlayer.loadFile"] = nonsense
        await _fails(sounds.perform(Ordered("sound", {"file": "/a.wav"})), "under which number")
        it.says["ALMotion.getTangentialSecurityDistance"] = nonsense
        await _fails(drive.perform(Ordered("drive", {"x": 0.1})), "did not arrive")
    assert not it.called.get("ALMotion.setAngles")
    assert not it.called.get("ALAudioPlayer.play")

    it.says["ALAudioPlayer.loadFile"] = 7
    job = Ordered("sound", {"file": "/a.wav"})
    for nonsense in (*NONSENSE, -1, 1e300):
        it.says["ALAudioPlayer.getFileLength"] = nonsense
        await sounds.perform(job)
    assert job.announced == []
    assert it.called["ALAudioPlayer.play"][-1] == (7,)
