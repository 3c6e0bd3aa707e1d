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
from woz_drivers.naoqi_robot.link import readable
from woz_drivers.naoqi_robot.memory import flag, word
from woz_drivers.naoqi_robot.service_call import ServiceCallPart
from woz_drivers.naoqi_robot.sounds import SoundsPart
from woz_drivers.naoqi_robot.voice import VoicePart

from tests.drivers.pepper.scripted_robot import SETTINGS, ScriptedRobot, babbler
from tests.drivers.published_messages import BusJob
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
    with pytest.raises(DriverError) as raised:
        await what
    assert telling in raised.value.what
    assert raised.value.remedy


async def test_nothing_is_made_of_nonsense(tmp_path: Path) -> None:
    async with babbler(tmp_path) as robot:
        await _settings(robot)
        await _stops(robot)
        await _verbs(robot)


async def test_a_long_result_is_cut_short(tmp_path: Path) -> None:
    async with babbler(tmp_path) as robot:
        call = ServiceCallPart(robot.connection, SETTINGS, robot.published.context)
        for said, length in (("a" * 900, 900), ("L" * 3_000_000, 60_000), (["a"] * 40_000, 60_000)):
            robot.says["ALTextToSpeech.getVolume"] = said
            told = await call.perform(BusJob("naoqi", {"call": "ALTextToSpeech.getVolume"}))
            assert isinstance(told["result"], str)
            assert len(told["result"]) <= length
            assert told["result"] == said or told["result"].endswith(" characters)")


async def _settings(robot: ScriptedRobot) -> None:
    """Read back: what makes no sense is left out, what does is kept."""
    made = [
        kind(robot.connection, SETTINGS, robot.published.context)
        for kind in (VoicePart, AutonomyPart, BodyPart, EyesPart)
    ]
    asked = (
        *("ALTextToSpeech.getParameter", "ALAutonomousLife.getState", "ALLeds.getIntensity"),
        *("ALBasicAwareness.isEnabled", "ALMotion.getTangentialSecurityDistance"),
        *("ALRobotPosture.getPosture", "ALMotion.robotIsWakeUp"),
    )
    robot.says["ALTextToSpeech.getVolume"] = 0.25
    for nonsense in NONSENSE[3:]:
        robot.says |= dict.fromkeys(asked, nonsense)
        read: dict[str, Any] = {}
        for part in made:
            read |= await part.read()
        assert read == {"volume": 0.25}, repr(nonsense)[:60]
    robot.says |= {"ALBasicAwareness.isEnabled": 1, "ALLeds.getIntensity": [1.0, 0.0, 0.0]}
    assert (await made[1].read())["awareness"] is True
    assert (await made[3].read())["eyes"] == "#0000ff"


async def _stops(robot: ScriptedRobot) -> None:
    """A stop is confirmed only by a robot that says that it stands."""
    base = BasePart(robot.connection, SETTINGS, robot.published.context)
    for nonsense in NONSENSE:
        robot.says["ALMotion.getRobotVelocity"] = nonsense
        await _fails(base.halt(Scope.ALL), "does not report its speed")
    robot.says["ALMotion.getRobotVelocity"] = [0.0, 0, 0.001]
    assert await base.halt(Scope.DRIVE) == ()

    animations = AnimationsPart(robot.connection, SETTINGS, robot.published.context)
    animations._playing = "animations/x"
    robot.says["ALBehaviorManager.stopBehavior"] = ValueError("it is not running")
    for nonsense in NONSENSE:
        robot.says["ALBehaviorManager.isBehaviorRunning"] = nonsense
        await _fails(animations.halt(Scope.ALL), "does not report whether animations/x has ended")
    robot.says["ALBehaviorManager.isBehaviorRunning"] = False
    assert await animations.halt(Scope.ALL) == ()


async def _verbs(robot: ScriptedRobot) -> None:
    """No angle that is none is sent to a joint, no file is played under a number that is none."""
    head = HeadPart(robot.connection, SETTINGS, robot.published.context)
    sounds = SoundsPart(robot.connection, SETTINGS, robot.published.context)
    drive = BasePart(robot.connection, SETTINGS, robot.published.context)
    robot.says |= {"ALMotion.robotIsWakeUp": True, "ALMotion.moveTo": False}
    for nonsense in NONSENSE:
        robot.says["ALMotion.getStiffnesses"] = [1.0, 1.0]
        robot.says["ALMotion.getAngles"] = nonsense
        await _fails(head.perform(BusJob("nudge", {"yaw": 5})), "does not report where")
        robot.says["ALMotion.getStiffnesses"] = nonsense
        await _fails(head.perform(BusJob("gaze", {"yaw": 5})), "does not report whether")
        robot.says["ALAudioPlayer.loadFile"] = nonsense
        await _fails(sounds.perform(BusJob("sound", {"file": "/a.wav"})), "under which number")
        robot.says["ALMotion.getTangentialSecurityDistance"] = nonsense
        await _fails(drive.perform(BusJob("drive", {"x": 0.1})), "did not arrive")
    assert not robot.called.get("ALMotion.setAngles")
    assert not robot.called.get("ALAudioPlayer.play")

    robot.says["ALAudioPlayer.loadFile"] = 7
    job = BusJob("sound", {"file": "/a.wav"})
    for nonsense in (*NONSENSE, -1, 1e300):
        robot.says["ALAudioPlayer.getFileLength"] = nonsense
        await sounds.perform(job)
    assert job.announced == []
    assert robot.called["ALAudioPlayer.play"][-1] == (7,)
