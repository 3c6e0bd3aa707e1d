"""A NAO whose answers make no sense: nothing is taken for an answer, and it is told."""

from __future__ import annotations

from collections.abc import Awaitable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.nao.body import NaoBodyPart
from woz_drivers.nao.body_senses import BodySensesPart
from woz_drivers.nao.joints import LEGS
from woz_drivers.nao.posture_animations import NaoAnimationsPart
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.nao.walking import WalkingPart

from tests.drivers.pepper.scripted_robot import babbler
from tests.drivers.pepper.test_nonsense import NONSENSE
from tests.drivers.published_messages import BusJob
from woz_tui.drivers.contract import DriverError, Scope

SETTINGS = NaoSettings()


async def _fails(what: Awaitable[Any], telling: str) -> None:
    with pytest.raises(DriverError) as raised:
        await what
    assert telling in raised.value.what
    assert raised.value.remedy


async def test_nothing_is_made_of_nonsense(tmp_path: Path) -> None:
    async with babbler(tmp_path, "nao") as robot:
        made = robot.connection, SETTINGS, robot.published.context
        walking, animations = WalkingPart(*made), NaoAnimationsPart(*made)
        body = NaoBodyPart(*made)
        robot.says |= {"ALMotion.robotIsWakeUp": True, "ALMotion.getRobotVelocity": [0.0, 0.0, 0.0]}
        for nonsense in NONSENSE:
            robot.says["ALMotion.moveIsActive"] = nonsense
            await _fails(walking.halt(Scope.ALL), "does not report whether it walks")
            robot.says["ALRobotPosture.getPostureFamily"] = nonsense
            await _fails(walking.perform(BusJob("drive", {"x": 0.1})), "does not stand")
            if nonsense not in ("", "x"):  # a word is a posture that nobody knows
                await _fails(animations.perform(BusJob("play", {"move": "Hey_1"})), "its posture")
            await _fails(body.halt(Scope.ALL), "does not report whether it walks")
        assert not robot.called.get("ALMotion.moveTo")
        assert not robot.called.get("ALAnimationPlayer.run")
        killed = robot.called["ALMotion.killTasksUsingResources"]
        assert not any(set(LEGS) & set(resources) for (resources,) in killed), "it would fall"
        robot.says["ALMotion.moveIsActive"] = False
        assert await walking.halt(Scope.DRIVE) == ()


async def test_a_robot_that_babbles_has_not_fallen_and_its_sensors_say_why(tmp_path: Path) -> None:
    async with babbler(tmp_path, "nao") as robot:
        senses = BodySensesPart(robot.connection, SETTINGS, robot.published.context)
        for nonsense in NONSENSE:
            robot.says |= {"ALMemory.getListData": nonsense, "ALMemory.getData": nonsense}
            await senses.look()
            await senses._round(warmth=True)
        assert robot.published.values("fallen").count(1.0) == 0
        assert robot.connection.refused("ALMotion.moveTo") is None
        for sensor in ("touch.head.front", "button", "temperature"):
            assert robot.published.states(sensor)[-1] == "stale"
            assert set(robot.published.values(sensor)) == {None}
