"""What a robot guesses of people: off unless asked for, smoothed, never in what is published."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio
from woz_drivers.naoqi_robot.looks import EXPRESSIONS, GENDERS
from woz_drivers.naoqi_robot.settings import SensesSettings

from tests.drivers.pepper.robot_rig import QUIET, RobotRig, connected_robot
from woz_tui.export.redaction import redacted
from woz_tui.protocol.messages import Reading, SensorChanged

pytestmark = pytest.mark.asyncio(loop_scope="module")

LOOKS = SensesSettings(
    rate=1, sonar=False, people=False, loudness=False, touch=False, face=True, mood=True
)


@pytest_asyncio.fixture(scope="module", loop_scope="module", params=["pepper", "nao"])
async def looking(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> AsyncIterator[RobotRig]:
    folder = tmp_path_factory.mktemp(request.param)
    async with connected_robot(folder, kind=request.param, senses=LOOKS) as rig:
        yield rig


def readings(rig: RobotRig, sensor: str) -> list[Reading]:
    return [one for one in rig.published.all(Reading) if one.sensor == sensor]


async def reads(rig: RobotRig, sensor: str) -> Reading:
    """A value of it."""
    await rig.published.until(lambda: any(one.value is not None for one in readings(rig, sensor)))
    return [one for one in readings(rig, sensor) if one.value is not None][-1]


@pytest.mark.naoqi("ALFaceCharacteristics.subscribe")
async def test_the_nearest_persons_looks_are_readings(looking: RobotRig) -> None:
    await looking.robot.person({"distance": 1.2, "looking": True})
    age = await reads(looking, "looks.age")
    assert age.unit == "years"
    assert 18 <= (age.value or 0) <= 70
    assert (await reads(looking, "looks.gender")).text in GENDERS
    assert (await reads(looking, "looks.expression")).text in EXPRESSIONS
    assert 0 <= ((await reads(looking, "looks.smile")).value or 0) <= 1


@pytest.mark.naoqi("ALMood.subscribe", "ALMood.currentPersonState")
async def test_mood_and_attention_are_readings(looking: RobotRig) -> None:
    await looking.robot.person({"distance": 1.2, "looking": True})
    assert -1 <= ((await reads(looking, "looks.valence")).value or 0) <= 1
    assert (await reads(looking, "looks.attention")).value == 0.9


async def test_of_nobody_there_is_no_value(looking: RobotRig) -> None:
    await looking.robot.person({"distance": 1.2})
    await reads(looking, "looks.age")
    await looking.robot.person(None)
    seen = len(readings(looking, "looks.age"))
    await looking.published.until(
        lambda: any(one.value is None for one in readings(looking, "looks.age")[seen:])
    )
    assert not [
        one
        for one in looking.published.all(SensorChanged)
        if one.sensor.startswith("looks.") and one.state == "stale"
    ]


async def test_nothing_of_it_is_read_unless_the_file_asks(tmp_path: Path) -> None:
    assert (SensesSettings().face, SensesSettings().mood) == (False, False)
    async with connected_robot(tmp_path, senses=QUIET) as rig:
        await rig.robot.person({"distance": 1.2})
        await rig.robot.called("ALBasicAwareness.isEnabled", 3)
        called = {call.name for call in await rig.robot.trace()}
        assert not [name for name in called if "ALMood" in name or "Characteristics" in name]
        assert not [one for one in rig.driver.offer(rig.driver.settings).sensors if "looks" in one]


@pytest.mark.parametrize("sensor", ["looks.age", "left.looks.valence"])
async def test_no_value_of_it_is_in_what_is_redacted(sensor: str) -> None:
    line = {"kind": "sample", "sensor": sensor, "value": 34.0, "raw": 36.0, "text": "male"}
    assert redacted(line) == line | {"value": None, "raw": None, "text": ""}
