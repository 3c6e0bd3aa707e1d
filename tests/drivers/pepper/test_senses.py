"""The robot's own sensors over the wire: readings, states with reasons, whatever the robot has."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.naoqi_robot.memory import BATTERY, SOUND
from woz_drivers.naoqi_robot.senses import FACES, VISIBLE, SensesPart, distance_key, looking_key
from woz_drivers.naoqi_robot.settings import SensesSettings
from woz_drivers.pepper.model import PEPPER
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.part_rig import PartRig, connected_part
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import DriverError, RejectedError, Scope
from woz_tui.protocol.messages import Reading, SensorChanged

SONAR = PEPPER.sonars["distance"]
FAST = SensesSettings(rate=20)
ALL = (
    *("distance", "presence", "people", "nearest", "gaze", "identity"),
    *("direction", "loudness", "battery"),
)
#: Somebody to the left who looks, talks and is known.
ADA = {"distance": 1.25, "angle": 0.25, "looking": True, "talking": True, "name": "Ada"}

Sense = Callable[..., AbstractAsyncContextManager[PartRig[SensesPart]]]


@pytest.fixture
def sense(tmp_path: Path, robot: StandIn) -> Sense:
    def begin(senses: SensesSettings = FAST) -> Any:
        return connected_part(SensesPart, tmp_path, robot, senses=senses)

    return begin


async def _round(rig: PartRig[SensesPart]) -> None:
    """Return when the robot has been read once more, from beginning to end."""
    asked = len(await rig.robot.trace("ALMemory.getListData"))
    await rig.robot.called("ALMemory.getListData", asked + 3)


async def _set_memory(rig: PartRig[SensesPart], key: str, value: Any) -> None:
    """What the robot's memory holds from now on."""
    await rig.connection.call("ALMemory", "insertData", key, value)


def _why(rig: PartRig[SensesPart], sensor: str) -> str:
    moved = [one for one in rig.published.all(SensorChanged) if one.sensor == sensor]
    return moved[-1].why


@pytest.mark.naoqi(
    "Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value",
    "PeoplePerception/VisiblePeopleList",
    "PeoplePerception/Person/<id>/Distance",
    "PeoplePerception/Person/<id>/IsLookingAtRobot",
    "FaceDetected",
    "ALSoundLocalization/SoundLocated",
    "ALAudioDevice.enableEnergyComputation",
    "ALAudioDevice.getFrontMicEnergy",
)
async def test_somebody_is_read_by_all_senses(sense: Sense, robot: StandIn) -> None:
    async with sense() as rig:
        await _round(rig)
        await robot.person(ADA)
        await rig.reads("distance", 1.25)
        await rig.reads("nearest", 1.25)
        await rig.reads("presence", 1.0)
        await rig.reads("people", 1.0)
        await rig.reads("gaze", 1.0)
        assert (await rig.reads("identity", 0.7, "Ada")).driver == "it"
        assert (await rig.reads("direction", round(math.degrees(0.25), 1))).unit == "deg"
        await rig.published.until(lambda: (rig.published.values("loudness")[-1] or 0.0) > 0.04)
        await robot.set("battery", 50)
        await rig.reads("battery", 0.5)
        assert await rig.part.read() == {"battery": pytest.approx(0.5, abs=0.01)}
        assert {sensor: rig.published.states(sensor)[-1] for sensor in ALL} == dict.fromkeys(
            ALL, "ok"
        )
        assert rig.notices == []
    assert SensesPart.offer(PepperSettings(robots=())).sensors == (
        *("distance", "presence", "people", "nearest", "gaze", "identity"),
        *("direction", "loudness", "battery"),
    )


@pytest.mark.naoqi("ALFaceDetection.learnFace")
async def test_a_face_gets_a_name(sense: Sense, robot: StandIn) -> None:
    async with sense() as rig:
        with pytest.raises(DriverError, match="has not learnt the face of V7"):
            await rig.do("learn_face", name="V7")
        await robot.person({"number": 7, "looking": True})
        await rig.reads("identity", 0.0)
        assert await rig.do("learn_face", name=" V7 ") == {"name": "V7"}
        await rig.reads("identity", 0.7, "V7")
        await robot.person({"number": 8, "looking": True})
        await rig.reads("identity", 0.0)
        with pytest.raises(RejectedError):
            await rig.do("learn_face", name=" ")
    blind = PepperSettings(robots=(), senses=SensesSettings(people=False))
    assert SensesPart.offer(blind).verbs == ()


@pytest.mark.naoqi("ALFaceDetection.forgetPerson", "ALFaceDetection.getLearnedFacesList")
async def test_a_face_is_forgotten_with_the_consent(sense: Sense, robot: StandIn) -> None:
    async with sense() as rig:
        await robot.person({"number": 7, "looking": True})
        await rig.reads("identity", 0.0)
        assert await rig.do("face_consent", name="V7", given=True) == {"name": "V7", "given": True}
        await rig.do("learn_face", name="V7")
        await rig.reads("identity", 0.7, "V7")
        told = [await rig.do("face_consent", name=" v7", given=False) for _ in range(2)]
        assert [each["deleted"] for each in told] == [True, False]
        await rig.reads("identity", 0.0)


async def test_nobody_is_said_to_be_nobody(sense: Sense, robot: StandIn) -> None:
    await robot.person(ADA)
    async with sense() as rig:
        await rig.reads("gaze", 1.0)
        await robot.person({**ADA, "looking": False})
        await rig.reads("gaze", 0.0)
        await rig.reads("identity", 0.0)
        await robot.person(None)
        await rig.reads("presence", 0.0)
        await rig.reads("people", 0.0)
        await rig.reads("nearest", None)
        await rig.reads("distance", 5.0)
        assert rig.published.states("nearest") == ["ok"]
        assert rig.published.states("gaze") == ["ok"]


async def test_the_nearest_of_several_counts(sense: Sense) -> None:
    async with sense() as rig:
        for person, metres, looking in ((4, 2.5, True), (5, 0.75, False), (6, 1.5, True)):
            await _set_memory(rig, distance_key(person), metres)
            await _set_memory(rig, looking_key(person), looking)
        await _set_memory(rig, VISIBLE, [4, 5, 6])
        await rig.reads("nearest", 0.75)
        assert (await rig.reads("people", 3.0)).value == 3
        assert (await rig.reads("gaze", 0.0)).value == 0
        await _set_memory(rig, VISIBLE, [4, 6])
        await rig.reads("nearest", 1.5)
        await rig.reads("gaze", 1.0)


async def test_one_question_a_round_for_all_keys(sense: Sense, robot: StandIn) -> None:
    async with sense() as rig:

        def rounds() -> int:
            return len(rig.published.values("distance"))

        await _round(rig)
        earliest = rounds()
        before = len(await robot.trace("ALMemory.getListData"))
        begun = rounds()
        await rig.published.until(lambda: rounds() >= begun + 12)
        ended = rounds()
        asked = await robot.trace("ALMemory.getListData")
        # The answer to one question may be under way at each look.
        assert ended - begun - 1 <= len(asked) - before <= rounds() - earliest + 1
        assert await robot.trace("ALMemory.getData") == []
        assert set(asked[0].args[0]) == {BATTERY, SONAR, SOUND, FACES, VISIBLE}


NONSENSE: tuple[tuple[str, Any, tuple[str, ...]], ...] = (
    (SONAR, float("nan"), ("distance",)),
    (SONAR, [1.0], ("distance",)),
    (SONAR, -2.0, ("distance",)),
    (BATTERY, "full", ("battery",)),
    (VISIBLE, "nobody", ("presence", "people", "nearest", "gaze")),
    (VISIBLE, [[1], 2], ("presence", "people", "nearest", "gaze")),
    (FACES, [[1, 2], "Ada"], ("identity",)),
    (SOUND, [[1, 2], "left"], ("direction",)),
)


async def test_what_makes_no_sense_is_null_with_a_reason_and_the_others_go_on(
    sense: Sense, robot: StandIn
) -> None:
    await robot.person(ADA)
    async with sense() as rig:
        await rig.reads("gaze", 1.0)
        for key, value, sensors in NONSENSE:
            before = {sensor: rig.published.states(sensor) for sensor in ALL}
            await _set_memory(rig, key, value)
            for sensor in sensors:
                await rig.published.state(sensor, "stale")
                assert "not a valid value" in _why(rig, sensor)
                await rig.reads(sensor, None)
            await _round(rig)
            for sensor in set(ALL) - set(sensors):
                assert rig.published.states(sensor) == before[sensor], (key, value)
            await rig.connection.call("ALMemory", "removeData", key)
            for sensor in sensors:
                await rig.published.state(sensor, "ok")


MODULES = {
    "ALSonar": {"distance"},
    "ALGazeAnalysis": {"gaze"},
    "ALPeoplePerception": {"presence", "people", "nearest", "gaze"},
    "ALFaceDetection": {"identity"},
    "ALSoundLocalization": {"direction"},
}


async def test_without_one_of_its_modules_the_other_senses_work(
    sense: Sense, robot: StandIn
) -> None:
    await robot.person(ADA)
    for service, sensors in MODULES.items():
        await robot.clear()
        await robot.fault(f"refuse:{service}.subscribe=not installed")
        async with sense() as rig:
            await _round(rig)
            for sensor in sensors:
                assert rig.published.states(sensor) == ["stale"]
                assert _why(rig, sensor).startswith(f"{service} does not run: ")
                assert "not installed" in _why(rig, sensor)
                assert rig.published.values(sensor) == []
            for sensor in set(ALL) - sensors:
                assert rig.published.states(sensor) == ["ok"], sensor


async def test_a_robot_that_refuses_lists_is_asked_key_by_key(sense: Sense, robot: StandIn) -> None:
    await robot.person(ADA)
    await robot.fault("refuse:ALMemory.getListData=a key is missing")
    async with sense() as rig:
        await rig.reads("distance", 1.25)
        await rig.reads("nearest", 1.25)
        await rig.reads("identity", 0.7, "Ada")
        await rig.reads("gaze", 1.0)
        assert len(await robot.trace("ALMemory.getListData")) == 1


async def test_a_module_that_comes_later_is_begun_then(
    sense: Sense, robot: StandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.naoqi_robot.senses._AGAIN_US", 0)
    await robot.fault("refuse:ALSonar.subscribe=not yet")
    async with sense() as rig:
        await rig.published.state("distance", "stale")
        await _round(rig)
        assert rig.published.values("distance") == []
        await robot.clear()
        await rig.published.state("distance", "ok")
        assert rig.published.states("gaze") == ["ok"]


async def test_energy_that_is_refused_is_told_for_loudness_alone(
    sense: Sense, robot: StandIn
) -> None:
    async with sense() as rig:
        await rig.published.state("loudness", "ok")
        await robot.fault("refuse:ALAudioDevice.getFrontMicEnergy=no microphone")
        await rig.published.state("loudness", "stale")
        assert "no microphone" in _why(rig, "loudness")
        await robot.clear()
        await rig.published.state("loudness", "ok")
        assert rig.published.states("distance") == ["ok"]


async def test_each_sound_is_told_once_and_the_old_one_of_before_not_at_all(sense: Sense) -> None:
    async with sense() as rig:
        await _round(rig)
        assert rig.published.values("direction") == []
        await _set_memory(rig, SOUND, [[7, 0], [0.5, 0.0, 0.9, 0.5]])
        await rig.reads("direction", 28.6)
        await _round(rig)
        assert rig.published.values("direction") == [28.6]
        await _set_memory(rig, SOUND, [[7, 1], [0.5, 0.0, 0.9, 0.5]])
        await rig.published.until(lambda: rig.published.values("direction") == [28.6, 28.6])
        await rig.part.connected()
        await _round(rig)
        assert rig.published.values("direction") == [28.6, 28.6]


async def test_a_lost_robot_makes_every_sense_stale_and_the_next_one_lives(
    tmp_path: Path, port: int
) -> None:
    async with (
        stand_in(port=port) as robot,
        connected_part(SensesPart, tmp_path, robot, senses=FAST) as rig,
    ):
        await _round(rig)
        robot.kill()
        for sensor in ALL:
            await rig.published.state(sensor, "stale")
            assert _why(rig, sensor) != ""
        assert await rig.part.read() == {}
        async with stand_in(port=port):
            await rig.wait_connected(2)
            for sensor in ALL:
                await rig.published.state(sensor, "ok")


async def test_only_what_the_file_wants_is_read(sense: Sense, robot: StandIn) -> None:
    few = SensesSettings(rate=20, people=False, loudness=False)
    async with sense(senses=few) as rig:
        await _round(rig)
        assert {one.sensor for one in rig.published.all(Reading)} == {"distance", "battery"}
        called = {call.name for call in await robot.trace()}
        assert "ALAudioDevice.enableEnergyComputation" not in called
        assert "ALPeoplePerception.subscribe" not in called
    assert SensesPart.offer(PepperSettings(robots=(), senses=few)).sensors == (
        "distance",
        "battery",
    )


async def test_at_the_end_the_robot_need_not_measure_any_more(sense: Sense, robot: StandIn) -> None:
    async with sense() as rig:
        await _round(rig)
        assert await rig.part.halt(Scope.ALL) is None
    ended = {call.service for call in await robot.trace() if call.method.startswith("unsub")}
    assert ended == {
        *("ALSonar", "ALPeoplePerception", "ALGazeAnalysis", "ALFaceDetection"),
        "ALSoundLocalization",
    }
    assert len(await robot.trace("ALAudioDevice.disableEnergyComputation")) == 1
