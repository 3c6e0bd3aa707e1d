"""ALMemory, the keys that follow a visitor, the microphones and the cameras."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from naoqi_simulator.senses import FACES, FIRST_ID, PERSON, SONAR, SONAR_M, SOUND, VISIBLE
from qimessaging.hosted_objects import HostedMethod, HostedObject

from tests.drivers.naoqi.robot_callers import RobotCallError, SimulatedRobotRig

ALL = ("ALSonar", "ALPeoplePerception", "ALFaceDetection", "ALGazeAnalysis", "ALSoundLocalization")
ADA = {"number": 3, "distance": 1.2, "angle": 0.3, "looking": True, "talking": True, "name": "Ada"}


async def data(rig: SimulatedRobotRig, key: str) -> Any:
    return await rig.call("ALMemory.getData", key)


async def perceive(rig: SimulatedRobotRig) -> None:
    for name in ALL:
        await rig.call(f"{name}.subscribe", "test")


async def test_a_key_is_put_and_had(rig: SimulatedRobotRig) -> None:
    await rig.call("ALMemory.insertData", "Mine", [1, "two", 3.5])
    assert await data(rig, "Mine") == [1, "two", 3.5]
    await rig.call("ALMemory.removeData", "Mine")
    with pytest.raises(RobotCallError, match="Mine"):
        await data(rig, "Mine")


async def test_of_several_keys_those_that_are_not_there_are_none(rig: SimulatedRobotRig) -> None:
    keys = ["NotThere", "AutonomousLife/State"]
    assert await rig.call("ALMemory.getListData", keys) == [None, "solitary"]


async def test_an_event_reaches_its_subscriber(rig: SimulatedRobotRig) -> None:
    subscriber = await rig.call("ALMemory.subscriber", "Mine")
    heard: list[Any] = []
    await subscriber.listen("signal", heard.append)
    await rig.call("ALMemory.raiseEvent", "Mine", [1, 2])

    async def came() -> bool:
        return bool(heard)

    await rig.robot.until(came)
    assert heard == [[1, 2]]


async def test_nothing_is_perceived_unless_somebody_wants_it(rig: SimulatedRobotRig) -> None:
    await rig.robot.person(ADA)
    assert await data(rig, SONAR) == SONAR_M
    assert await data(rig, VISIBLE) == []
    assert await data(rig, FACES) == []


async def test_a_visitor_is_perceived(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await rig.call("ALBasicAwareness.setEnabled", False)
    await rig.robot.person(ADA)
    number = FIRST_ID + 3
    assert await data(rig, SONAR) == pytest.approx(1.2)
    assert await data(rig, VISIBLE) == [number]
    assert await data(rig, f"{PERSON}{number}/Distance") == pytest.approx(1.2)
    assert await data(rig, f"{PERSON}{number}/IsLookingAtRobot") is True
    (_stamp, (face, filtered), *_pose) = await data(rig, FACES)
    assert face[0][1] == pytest.approx(0.3)
    assert (face[1][2], filtered) == ("Ada", [2, ["Ada"]])
    (_stamp, located, *_heads) = await data(rig, SOUND)
    assert located[0] == pytest.approx(0.3)


async def test_a_face_without_a_name_is_a_face(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await rig.robot.person({**ADA, "name": ""})
    (_stamp, (face, filtered), *_pose) = await data(rig, FACES)
    assert (face[1][2], filtered) == ("", [4, []])


async def test_somebody_who_turns_away_has_no_face(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await rig.robot.person({**ADA, "looking": False})
    assert await data(rig, FACES) == []
    assert await data(rig, f"{PERSON}{FIRST_ID + 3}/IsLookingAtRobot") is False


async def test_faces_and_sounds_are_where_the_head_is_not(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await turn_head(rig, 0.5)
    await rig.robot.person(ADA)
    (_stamp, (face, _filtered), *_pose) = await data(rig, FACES)
    assert face[0][1] == pytest.approx(0.3 - 0.5)
    (_stamp, located, *_heads) = await data(rig, SOUND)
    assert located[0] == pytest.approx(0.3 - 0.5)


async def turn_head(rig: SimulatedRobotRig, angle: float) -> None:
    await rig.call("ALBasicAwareness.setEnabled", False)
    await rig.call("ALMotion.setAngles", "HeadYaw", angle, 0.5)
    await rig.time.advance(1)


async def test_nobody_has_no_distance(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await rig.robot.person(None)
    assert await data(rig, VISIBLE) == []
    with pytest.raises(RobotCallError):
        await data(rig, f"{PERSON}{FIRST_ID + 3}/Distance")


async def test_who_unsubscribes_perceives_no_more(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await rig.robot.person(ADA)
    await rig.call("ALSonar.unsubscribe", "test")
    assert await data(rig, SONAR) == SONAR_M
    with pytest.raises(RobotCallError, match="not subscribed"):
        await rig.call("ALSonar.unsubscribe", "test")


async def test_visitors_come_and_go_by_themselves(rig: SimulatedRobotRig) -> None:
    await perceive(rig)
    await rig.robot.person("auto")
    seen = set()
    for _ in range(120):
        await rig.time.advance(1)
        seen.add(tuple(await data(rig, VISIBLE)))
    assert () in seen
    assert len(seen) >= 3


async def test_energy_follows_speech(rig: SimulatedRobotRig) -> None:
    assert await rig.call("ALAudioDevice.getFrontMicEnergy") == 0
    await rig.call("ALAudioDevice.enableEnergyComputation")
    quiet = await rig.call("ALAudioDevice.getFrontMicEnergy")
    await rig.robot.person(ADA)
    loud = []
    for _ in range(10):
        await rig.time.advance(0.1)
        loud.append(await rig.call("ALAudioDevice.getFrontMicEnergy"))
    assert 0 < quiet < 500
    assert min(loud) > 500
    await rig.robot.person({**ADA, "talking": False})
    assert await rig.call("ALAudioDevice.getFrontMicEnergy") < 500
    assert max(loud) <= 10_000
    await rig.call("ALAudioDevice.disableEnergyComputation")
    assert await rig.call("ALAudioDevice.getFrontMicEnergy") == 0


@pytest.mark.parametrize(
    ("rate", "channels", "samples", "number"), [(48_000, 0, 4096, 4), (16_000, 3, 1365, 1)]
)
async def test_a_client_gets_sound_in_blocks(
    rig: SimulatedRobotRig, rate: int, channels: int, samples: int, number: int
) -> None:
    blocks: list[tuple[int, int, list[int], bytes]] = []

    def heard(many: int, each: int, stamp: list[int], sound: bytes) -> None:
        blocks.append((many, each, stamp, bytes(sound)))

    takes = "(iimm)"
    await rig.client.register(
        "Ears", HostedObject([HostedMethod("processRemote", takes, "v", heard)])
    )
    await rig.robot.person(ADA)
    await rig.call("ALAudioDevice.setClientPreferences", "Ears", rate, channels, 0)
    await rig.call("ALAudioDevice.subscribe", "Ears")
    for wanted in (1, 2, 3):
        await rig.time.advance(samples / rate)

        async def came(wanted: int = wanted) -> bool:
            return len(blocks) >= wanted

        await rig.robot.until(came)
    assert [one[:2] for one in blocks] == [(number, samples)] * 3
    assert [len(one[3]) for one in blocks] == [number * samples * 2] * 3
    loud = np.frombuffer(blocks[0][3], "<i2").astype(float)
    assert math.sqrt(np.mean(loud**2)) > 500
    assert await rig.robot.get("sound.subscribers") == ["Ears"]
    await rig.call("ALAudioDevice.unsubscribe", "Ears")
    await rig.time.advance(1)
    assert len(blocks) == 3


async def test_sound_for_nobody_is_noted(rig: SimulatedRobotRig) -> None:
    await rig.call("ALAudioDevice.subscribe", "Nobody")
    await rig.time.advance(0.2)

    async def noted() -> bool:
        return "sound for Nobody" in str(await rig.robot.get("notes"))

    await rig.robot.until(noted)
    assert await rig.robot.get("sound.subscribers") == []


async def picture(rig: SimulatedRobotRig, handle: str) -> Any:
    (width, height, layers, *_rest) = whole = await rig.call("ALVideoDevice.getImageRemote", handle)
    assert len(whole) == 12
    return np.frombuffer(bytes(whole[6]), np.uint8).reshape(height, width, layers)


@pytest.mark.parametrize(
    ("resolution", "shape"), [(0, (120, 160, 3)), (1, (240, 320, 3)), (2, (480, 640, 3))]
)
async def test_pictures_by_resolution(
    rig: SimulatedRobotRig, resolution: int, shape: tuple[int, ...]
) -> None:
    handle = await rig.call("ALVideoDevice.subscribe", "eye", resolution, 11, 10)
    assert (await picture(rig, handle)).shape == shape


async def test_the_camera_sees_the_visitor_move(rig: SimulatedRobotRig) -> None:
    await rig.call("ALBasicAwareness.setEnabled", False)
    handle = await rig.call("ALVideoDevice.subscribeCamera", "eye", 0, 0, 11, 10)
    empty = await picture(rig, handle)
    shirts = []
    for angle in (0.3, -0.3):
        await rig.robot.person({**ADA, "angle": angle})
        changed = (await picture(rig, handle) != empty).any(axis=2)
        shirts.append(float(np.nonzero(changed)[1].mean()))
    # Left of the robot is left in the picture.
    assert shirts[0] < 60
    assert shirts[1] > 100


async def test_the_picture_turns_with_the_head(rig: SimulatedRobotRig) -> None:
    await rig.robot.person({**ADA, "angle": 0.2})
    handle = await rig.call("ALVideoDevice.subscribe", "eye", 0, 11, 10)
    await turn_head(rig, 0.2)
    ahead = await picture(rig, handle)
    await turn_head(rig, 0.0)
    aside = await picture(rig, handle)
    shirt = [
        float(np.nonzero((one[:, :, 2] > 160) & (one[:, :, 0] < 60))[1].mean())
        for one in (ahead, aside)
    ]
    assert shirt[0] == pytest.approx(79.5, abs=2)
    assert shirt[1] < 60


async def test_blue_and_red_change_places(rig: SimulatedRobotRig) -> None:
    await rig.robot.person(ADA)
    rgb = await picture(rig, await rig.call("ALVideoDevice.subscribe", "a", 8, 11, 10))
    bgr = await picture(rig, await rig.call("ALVideoDevice.subscribe", "b", 8, 13, 10))
    assert (rgb[:, :, ::-1] == bgr).all()
    assert (rgb != bgr).any()


async def test_a_name_can_be_subscribed_six_times(rig: SimulatedRobotRig) -> None:
    handles = [await rig.call("ALVideoDevice.subscribe", "eye", 0, 11, 5) for _ in range(6)]
    assert len(set(handles)) == 6
    with pytest.raises(RobotCallError, match="6 times"):
        await rig.call("ALVideoDevice.subscribe", "eye", 0, 11, 5)
    assert await rig.call("ALVideoDevice.unsubscribe", handles[0]) is True
    assert await rig.call("ALVideoDevice.unsubscribe", handles[0]) is False
    assert await rig.call("ALVideoDevice.unsubscribeAllInstances", "eye") is True
    assert await rig.robot.get("camera.subscribers") == []


async def test_no_picture_without_a_subscription(rig: SimulatedRobotRig) -> None:
    with pytest.raises(RobotCallError, match="nobody_0"):
        await rig.call("ALVideoDevice.getImageRemote", "nobody_0")
