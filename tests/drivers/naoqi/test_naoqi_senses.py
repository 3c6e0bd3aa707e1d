"""ALMemory, the keys that follow a visitor, the microphones and the cameras."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from naoqi_simulator.senses import FACES, FIRST_ID, PERSON, SONAR, SONAR_M, SOUND, VISIBLE
from qimessaging.hosted_objects import HostedMethod, HostedObject

from tests.drivers.naoqi.hands import Said, Wired

ALL = ("ALSonar", "ALPeoplePerception", "ALFaceDetection", "ALGazeAnalysis", "ALSoundLocalization")
ADA = {"number": 3, "distance": 1.2, "angle": 0.3, "looking": True, "talking": True, "name": "Ada"}


async def data(wired: Wired, key: str) -> Any:
    return await wired.call("ALMemory.getData", key)


async def perceive(wired: Wired) -> None:
    for name in ALL:
        await wired.call(f"{name}.subscribe", "test")


async def test_a_key_is_put_and_had(wired: Wired) -> None:
    await wired.call("ALMemory.insertData", "Mine", [1, "two", 3.5])
    assert await data(wired, "Mine") == [1, "two", 3.5]
    await wired.call("ALMemory.removeData", "Mine")
    with pytest.raises(Said, match="Mine"):
        await data(wired, "Mine")


async def test_of_several_keys_those_that_are_not_there_are_none(wired: Wired) -> None:
    keys = ["NotThere", "AutonomousLife/State"]
    assert await wired.call("ALMemory.getListData", keys) == [None, "solitary"]


async def test_an_event_reaches_its_subscriber(wired: Wired) -> None:
    subscriber = await wired.call("ALMemory.subscriber", "Mine")
    heard: list[Any] = []
    await subscriber.listen("signal", heard.append)
    await wired.call("ALMemory.raiseEvent", "Mine", [1, 2])

    async def came() -> bool:
        return bool(heard)

    await wired.robot.until(came)
    assert heard == [[1, 2]]


async def test_nothing_is_perceived_unless_somebody_wants_it(wired: Wired) -> None:
    await wired.robot.person(ADA)
    assert await data(wired, SONAR) == SONAR_M
    assert await data(wired, VISIBLE) == []
    assert await data(wired, FACES) == []


async def test_a_visitor_is_perceived(wired: Wired) -> None:
    await perceive(wired)
    await wired.call("ALBasicAwareness.setEnabled", False)
    await wired.robot.person(ADA)
    number = FIRST_ID + 3
    assert await data(wired, SONAR) == pytest.approx(1.2)
    assert await data(wired, VISIBLE) == [number]
    assert await data(wired, f"{PERSON}{number}/Distance") == pytest.approx(1.2)
    assert await data(wired, f"{PERSON}{number}/IsLookingAtRobot") is True
    (_stamp, (face, filtered), *_pose) = await data(wired, FACES)
    assert face[0][1] == pytest.approx(0.3)
    assert (face[1][2], filtered) == ("Ada", [2, ["Ada"]])
    (_stamp, located, *_heads) = await data(wired, SOUND)
    assert located[0] == pytest.approx(0.3)


async def test_a_face_without_a_name_is_a_face(wired: Wired) -> None:
    await perceive(wired)
    await wired.robot.person({**ADA, "name": ""})
    (_stamp, (face, filtered), *_pose) = await data(wired, FACES)
    assert (face[1][2], filtered) == ("", [4, []])


async def test_somebody_who_turns_away_has_no_face(wired: Wired) -> None:
    await perceive(wired)
    await wired.robot.person({**ADA, "looking": False})
    assert await data(wired, FACES) == []
    assert await data(wired, f"{PERSON}{FIRST_ID + 3}/IsLookingAtRobot") is False


async def test_faces_and_sounds_are_where_the_head_is_not(wired: Wired) -> None:
    await perceive(wired)
    await turn_head(wired, 0.5)
    await wired.robot.person(ADA)
    (_stamp, (face, _filtered), *_pose) = await data(wired, FACES)
    assert face[0][1] == pytest.approx(0.3 - 0.5)
    (_stamp, located, *_heads) = await data(wired, SOUND)
    assert located[0] == pytest.approx(0.3 - 0.5)


async def turn_head(wired: Wired, angle: float) -> None:
    await wired.call("ALBasicAwareness.setEnabled", False)
    await wired.call("ALMotion.setAngles", "HeadYaw", angle, 0.5)
    await wired.time.advance(1)


async def test_nobody_has_no_distance(wired: Wired) -> None:
    await perceive(wired)
    await wired.robot.person(None)
    assert await data(wired, VISIBLE) == []
    with pytest.raises(Said):
        await data(wired, f"{PERSON}{FIRST_ID + 3}/Distance")


async def test_who_unsubscribes_perceives_no_more(wired: Wired) -> None:
    await perceive(wired)
    await wired.robot.person(ADA)
    await wired.call("ALSonar.unsubscribe", "test")
    assert await data(wired, SONAR) == SONAR_M
    with pytest.raises(Said, match="not subscribed"):
        await wired.call("ALSonar.unsubscribe", "test")


async def test_visitors_come_and_go_by_themselves(wired: Wired) -> None:
    await perceive(wired)
    await wired.robot.person("auto")
    seen = set()
    for _ in range(120):
        await wired.time.advance(1)
        seen.add(tuple(await data(wired, VISIBLE)))
    assert () in seen
    assert len(seen) >= 3


async def test_energy_follows_speech(wired: Wired) -> None:
    assert await wired.call("ALAudioDevice.getFrontMicEnergy") == 0
    await wired.call("ALAudioDevice.enableEnergyComputation")
    quiet = await wired.call("ALAudioDevice.getFrontMicEnergy")
    await wired.robot.person(ADA)
    loud = []
    for _ in range(10):
        await wired.time.advance(0.1)
        loud.append(await wired.call("ALAudioDevice.getFrontMicEnergy"))
    assert 0 < quiet < 500
    assert min(loud) > 500
    await wired.robot.person({**ADA, "talking": False})
    assert await wired.call("ALAudioDevice.getFrontMicEnergy") < 500
    assert max(loud) <= 10_000
    await wired.call("ALAudioDevice.disableEnergyComputation")
    assert await wired.call("ALAudioDevice.getFrontMicEnergy") == 0


@pytest.mark.parametrize(
    ("rate", "channels", "samples", "number"), [(48_000, 0, 4096, 4), (16_000, 3, 1365, 1)]
)
async def test_a_client_gets_sound_in_blocks(
    wired: Wired, rate: int, channels: int, samples: int, number: int
) -> None:
    blocks: list[tuple[int, int, list[int], bytes]] = []

    def heard(many: int, each: int, stamp: list[int], sound: bytes) -> None:
        blocks.append((many, each, stamp, bytes(sound)))

    takes = "(iimm)"
    await wired.client.register(
        "Ears", HostedObject([HostedMethod("processRemote", takes, "v", heard)])
    )
    await wired.robot.person(ADA)
    await wired.call("ALAudioDevice.setClientPreferences", "Ears", rate, channels, 0)
    await wired.call("ALAudioDevice.subscribe", "Ears")
    for wanted in (1, 2, 3):
        await wired.time.advance(samples / rate)

        async def came(wanted: int = wanted) -> bool:
            return len(blocks) >= wanted

        await wired.robot.until(came)
    assert [one[:2] for one in blocks] == [(number, samples)] * 3
    assert [len(one[3]) for one in blocks] == [number * samples * 2] * 3
    loud = np.frombuffer(blocks[0][3], "<i2").astype(float)
    assert math.sqrt(np.mean(loud**2)) > 500
    assert await wired.robot.get("sound.subscribers") == ["Ears"]
    await wired.call("ALAudioDevice.unsubscribe", "Ears")
    await wired.time.advance(1)
    assert len(blocks) == 3


async def test_sound_for_nobody_is_noted(wired: Wired) -> None:
    await wired.call("ALAudioDevice.subscribe", "Nobody")
    await wired.time.advance(0.2)

    async def noted() -> bool:
        return "sound for Nobody" in str(await wired.robot.get("notes"))

    await wired.robot.until(noted)
    assert await wired.robot.get("sound.subscribers") == []


async def picture(wired: Wired, handle: str) -> Any:
    (width, height, layers, *_rest) = whole = await wired.call(
        "ALVideoDevice.getImageRemote", handle
    )
    assert len(whole) == 12
    return np.frombuffer(bytes(whole[6]), np.uint8).reshape(height, width, layers)


@pytest.mark.parametrize(
    ("resolution", "shape"), [(0, (120, 160, 3)), (1, (240, 320, 3)), (2, (480, 640, 3))]
)
async def test_pictures_by_resolution(
    wired: Wired, resolution: int, shape: tuple[int, ...]
) -> None:
    handle = await wired.call("ALVideoDevice.subscribe", "eye", resolution, 11, 10)
    assert (await picture(wired, handle)).shape == shape


async def test_the_camera_sees_the_visitor_move(wired: Wired) -> None:
    await wired.call("ALBasicAwareness.setEnabled", False)
    handle = await wired.call("ALVideoDevice.subscribeCamera", "eye", 0, 0, 11, 10)
    empty = await picture(wired, handle)
    shirts = []
    for angle in (0.3, -0.3):
        await wired.robot.person({**ADA, "angle": angle})
        changed = (await picture(wired, handle) != empty).any(axis=2)
        shirts.append(float(np.nonzero(changed)[1].mean()))
    # Left of the robot is left in the picture.
    assert shirts[0] < 60
    assert shirts[1] > 100


async def test_the_picture_turns_with_the_head(wired: Wired) -> None:
    await wired.robot.person({**ADA, "angle": 0.2})
    handle = await wired.call("ALVideoDevice.subscribe", "eye", 0, 11, 10)
    await turn_head(wired, 0.2)
    ahead = await picture(wired, handle)
    await turn_head(wired, 0.0)
    aside = await picture(wired, handle)
    shirt = [
        float(np.nonzero((one[:, :, 2] > 160) & (one[:, :, 0] < 60))[1].mean())
        for one in (ahead, aside)
    ]
    assert shirt[0] == pytest.approx(79.5, abs=2)
    assert shirt[1] < 60


async def test_blue_and_red_change_places(wired: Wired) -> None:
    await wired.robot.person(ADA)
    rgb = await picture(wired, await wired.call("ALVideoDevice.subscribe", "a", 8, 11, 10))
    bgr = await picture(wired, await wired.call("ALVideoDevice.subscribe", "b", 8, 13, 10))
    assert (rgb[:, :, ::-1] == bgr).all()
    assert (rgb != bgr).any()


async def test_a_name_can_be_subscribed_six_times(wired: Wired) -> None:
    handles = [await wired.call("ALVideoDevice.subscribe", "eye", 0, 11, 5) for _ in range(6)]
    assert len(set(handles)) == 6
    with pytest.raises(Said, match="6 times"):
        await wired.call("ALVideoDevice.subscribe", "eye", 0, 11, 5)
    assert await wired.call("ALVideoDevice.unsubscribe", handles[0]) is True
    assert await wired.call("ALVideoDevice.unsubscribe", handles[0]) is False
    assert await wired.call("ALVideoDevice.unsubscribeAllInstances", "eye") is True
    assert await wired.robot.get("camera.subscribers") == []


async def test_no_picture_without_a_subscription(wired: Wired) -> None:
    with pytest.raises(Said, match="nobody_0"):
        await wired.call("ALVideoDevice.getImageRemote", "nobody_0")
