"""The simulated robot as the bus sees it: verbs, time and readings."""

from __future__ import annotations

import asyncio
import math
import struct
import wave
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.simulated import SimulatedJoint, SimulatedRobot, SimulatedSettings
from woz_drivers.simulated.speech import utterance
from woz_drivers.simulated.verbs import MOVES

from tests.fakes.simulated_rig import Rig, rig
from woz_tui.console.state.driver_outlines import body_outlines, outlines_of
from woz_tui.drivers.contract import RejectedError
from woz_tui.protocol.messages import FaceShown, Json
from woz_tui.testing import PlainJob, RecordingContext


@pytest.fixture
async def robot(tmp_path: Path) -> AsyncIterator[Rig]:
    async with rig(tmp_path) as simulated_rig:
        yield simulated_rig


async def test_it_works_in_real_time(tmp_path: Path) -> None:
    context = RecordingContext(tmp_path)
    robot = SimulatedRobot("robot", SimulatedSettings(speed=100), context)
    await robot.open()
    dance: dict[str, Json] = {"move": "dance", "speed": 1.0, "amplitude": 1.0}
    sent = await asyncio.wait_for(robot.perform(PlainJob("play", dance)), 20)
    await robot.close()
    assert sent["move"] == "dance"
    assert max(abs(reading.value or 0) for reading in context.of("setpoint.pan")) <= 90


async def test_a_gaze_arrives_when_the_head_is_there(robot: Rig) -> None:
    job = PlainJob("gaze", {"yaw": 60.0})
    await robot.perform(job)
    await robot.pace.advance(0.1)
    assert job.arrivals == []
    await robot.pace.advance(3.0)
    assert job.arrivals == [""]
    assert robot.context.latest("joint.pan") == pytest.approx(60.0, abs=0.5)


async def test_a_gaze_whose_head_is_moved_otherwise_does_not_arrive(robot: Rig) -> None:
    job = PlainJob("gaze", {"yaw": 60.0})
    await robot.perform(job)
    robot.begin("nudge", yaw=-20.0)
    await robot.pace.advance(3.0)
    assert len(job.arrivals) == 1
    assert job.arrivals[0] != ""


async def test_speaking_takes_time_by_its_length_and_says_so(robot: Rig) -> None:
    job = PlainJob("say", {"text": "Good morning, Ann. Nice to see you."})
    task = asyncio.create_task(robot.perform(job))
    await robot.pace.advance(2.3)
    assert not task.done()
    assert job.expected == [pytest.approx(35 / 14)]
    await robot.pace.advance(0.3)
    assert task.result()["seconds"] == 2.5


@pytest.mark.parametrize(
    ("tagged", "text", "seconds"),
    [
        ("x" * 28, "x" * 28, 2.0),
        (r"xxxxxxxxxxxxxx\pau=500\xxxxxxxxxxxxxx", "x" * 14 + " " + "x" * 14, 2.5),
        (r"\rspd=50\xxxxxxx\rst\ xxxxxxx", "xxxxxxx xxxxxxx", 1.5),
        ('xxxxxxx<break time="1.5s"/>', "xxxxxxx", 2.0),
        ('<speak><prosody rate="200%">xxxxxxxxxxxxxx</prosody></speak>', "x" * 14, 0.5),
        ("^run(animations/Stand/Hey_1) Hi", "Hi", 0.3),
        ("2 < 3 and 4 > 1", "2 < 3 and 4 > 1", 15 / 14),
        (r"\pau=500\ ", "", 0.0),
    ],
)
def test_tags_are_not_spoken_but_count(tagged: str, text: str, seconds: float) -> None:
    heard = utterance(tagged, 14.0)
    assert heard.text == text
    assert heard.seconds == pytest.approx(seconds)


@pytest.mark.parametrize("begun", ["<prosody ", '<prosody rate="1%"', "^run(", "<break"])
def test_a_text_of_tags_that_are_never_closed_is_looked_through_quickly(begun: str) -> None:
    """With a search that begins anew at each of them this test does not end."""
    text = begun * 100_000
    assert utterance(text, 14.0).text == " ".join(text.split())


async def test_every_move_moves_and_ends_where_it_began(robot: Rig) -> None:
    for name in MOVES:
        robot.context.readings.clear()
        await robot.do("play", move=name)
        await robot.pace.advance(0.2)
        angles = [
            reading.value or 0.0
            for joint in ("pan", "tilt", "hip")
            for reading in robot.context.of(f"joint.{joint}")
        ]
        assert max(map(abs, angles)) > 3, name
        assert all(
            abs(robot.context.latest(f"joint.{joint}")) < 0.1 for joint in ("pan", "tilt", "hip")
        )


async def test_amplitude_and_speed_change_a_move(robot: Rig) -> None:
    job = PlainJob("play", {"move": "nod", "speed": 2.0, "amplitude": 0.5})
    task = asyncio.create_task(robot.perform(job))
    await robot.pace.advance(3.0)
    assert task.result()["seconds"] == 0.6
    peak = max(reading.value or 0 for reading in robot.context.of("setpoint.tilt"))
    assert 5 < peak <= 9


async def test_a_move_of_the_robot_file_takes_its_time(tmp_path: Path) -> None:
    async with rig(tmp_path, SimulatedSettings(moves={"hop": 3.0})) as simulated_rig:
        task = simulated_rig.begin("play", move="hop")
        await simulated_rig.pace.advance(2.9)
        assert not task.done()
        await simulated_rig.pace.advance(0.2)
        assert task.done()


async def test_poses_are_clamped_and_what_was_reached_comes_back(robot: Rig) -> None:
    sent = await robot.do("pose", joints={"pan": 400, "tilt": -10}, seconds=1.0)
    assert sent["joints"] == {"pan": 90.0, "tilt": -10.0}
    sent = await robot.do(
        "poses",
        poses=[{"joints": {"pan": 10}, "seconds": 0.2}, {"joints": {"pan": -20}, "seconds": 1}],
    )
    assert sent["joints"] == {"pan": pytest.approx(-20, abs=0.1)}
    sent = await robot.do("poses", poses=[{"joints": {"tilt": 12}, "seconds": 0.5}])
    assert sent["joints"] == {"tilt": pytest.approx(12, abs=0.1)}
    sent = await robot.do("home")
    assert sent["joints"] == {name: pytest.approx(0, abs=0.1) for name in ("pan", "tilt", "hip")}


async def test_gaze_ends_at_once_and_the_head_follows(robot: Rig) -> None:
    task = robot.begin("gaze", yaw=45.0, pitch=100.0)
    await robot.pace.settle()
    assert task.result() == {"yaw": 45.0, "pitch": 40.0}
    await robot.pace.advance(1.0)
    assert robot.context.latest("joint.pan") == pytest.approx(45, abs=0.1)
    assert await robot.do("gaze", pitch=5.0) == {"pitch": 5.0}
    await robot.pace.advance(1.0)
    assert robot.context.latest("joint.pan") == pytest.approx(45, abs=0.1)


async def test_nudges_add_up_from_where_the_head_is_going(robot: Rig) -> None:
    for _ in range(3):
        await robot.do("nudge", yaw=5.0)
    await robot.pace.advance(1.0)
    assert robot.context.latest("joint.pan") == pytest.approx(15, abs=0.1)
    assert await robot.do("hip", pitch=5.0) == {"pitch": 5.0}
    with pytest.raises(RejectedError, match="no joint for roll"):
        await robot.do("hip", roll=5.0)


async def test_limp_motors_refuse_to_move(robot: Rig) -> None:
    await robot.do("torque", on=False)
    with pytest.raises(RejectedError, match="motors are off") as caught:
        await robot.do("play", move="nod")
    assert "torque: on" in caught.value.remedy
    await robot.do("torque", on=True)
    await robot.do("play", move="nod")


async def test_driving_takes_time_by_the_way_and_moves_the_base(robot: Rig) -> None:
    task = robot.begin("drive", x=0.6, turn=45.0)
    await robot.pace.advance(1.0)
    assert robot.context.latest("base.x") == pytest.approx(0.3, abs=0.04)
    await robot.pace.advance(1.1)
    assert task.result()["way"] == pytest.approx(0.6)
    assert robot.context.latest("base.heading") == pytest.approx(45)


async def test_a_drive_to_nowhere_is_refused_as_by_robots(robot: Rig) -> None:
    with pytest.raises(RejectedError, match="no distance"):
        await robot.do("drive")


async def test_a_sound_of_an_emotion_takes_its_time_and_opens_the_mouth(robot: Rig) -> None:
    await robot.do("emotion", emotion="happy")
    shut = [shown for shown in robot.context.shown if isinstance(shown, FaceShown)][-1]
    sent = await robot.do("utter", emotion="happy", seconds=1.0, seed=3)
    assert (sent["seconds"], sent["seed"]) == (1.0, 3)
    assert sent["valence"] == pytest.approx(0.866, abs=1e-3)
    faces = [shown for shown in robot.context.shown if isinstance(shown, FaceShown)]
    opened = [shown for shown in faces[faces.index(shut) :] if shown.rows != shut.rows]
    assert len({shown.rows for shown in opened}) > 1
    assert {shown.emotion for shown in opened} == {"happy"}
    assert faces[-1] == shut


async def test_sound_lasts_as_long_as_its_file(robot: Rig, tmp_path: Path) -> None:
    with wave.open(str(tmp_path / "beep.wav"), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(8000)
        sound.writeframes(struct.pack("<h", 0) * 12000)
    assert (await robot.do("sound", file="beep.wav"))["seconds"] == 1.5
    (tmp_path / "map.png").write_bytes(b"not a sound")
    assert (await robot.do("sound", file="map.png"))["seconds"] == 2.0
    assert (await robot.do("screen", file="https://example.org/"))["file"] == "https://example.org/"
    assert (await robot.do("screen", file="map.png"))["file"] == "map.png"


async def test_face_volume_and_mode(robot: Rig) -> None:
    assert await robot.do("emotion", emotion="happy", intensity=0.8) == {
        "emotion": "happy",
        "intensity": 0.8,
    }
    assert await robot.do("eyes", color="Orange") == {"color": "#ff8000", "animation": "steady"}
    assert await robot.do("eyes", color="#0f0", animation="blink") == {
        "color": "#00ff00",
        "animation": "blink",
    }
    assert await robot.do("volume", level=0.2) == {"level": 0.2}
    assert (await robot.do("say", text="Hi"))["volume"] == 0.2
    assert await robot.do("mode", mode="demo") == {"mode": "demo", "was": "normal"}


@pytest.mark.parametrize(
    ("verb", "args", "what", "remedy"),
    [
        ("say", {"text": "  "}, "nothing to say", "give the utterance a text"),
        ("say", {"text": 7}, "say.text must be text, not int", ""),
        ("play", {"move": "nodd"}, "play.move must be one of ", ""),
        ("pose", {"joints": {"pna": 3}}, "there is no joint 'pna'", "did you mean 'pan'?"),
        ("pose", {"joints": {"pan": math.nan}}, "pose.joints.pan must be a finite number", ""),
        ("pose", {"joints": {"pan": "left"}}, "pose.joints.pan must be a number, not str", ""),
        ("pose", {"joints": {}}, "pose.joints must map joint names to degrees", ""),
        ("pose", {"joints": {"pan": 1}, "seconds": -1}, "pose.seconds cannot be negative", ""),
        (
            "poses",
            {"poses": []},
            "poses.poses must be a list of poses",
            "",
        ),
        ("gaze", {"yaw": 10**400}, "gaze.yaw must be a finite number", ""),
        ("torque", {"on": "yes"}, "torque.on must be true or false, not 'yes'", ""),
        ("eyes", {"color": "grene"}, "unknown colour 'grene'", "did you mean 'green'?"),
        ("eyes", {"color": "red", "animation": "blnk"}, "eyes.animation must be one of ", ""),
        ("fault", {"kind": "nan", "part": "joint.pam"}, "unknown part 'joint.pam'", "did you mean"),
        ("fault", {"kind": "slow", "part": "body"}, "unknown part 'body'", "leave it out"),
        ("jump", {}, "the simulated robot cannot jump", ""),
    ],
)
async def test_nonsense_is_refused_with_a_remedy(
    robot: Rig, verb: str, args: dict[str, Json], what: str, remedy: str
) -> None:
    with pytest.raises(RejectedError) as caught:
        await robot.do(verb, **args)
    assert caught.value.what.startswith(what)
    assert caught.value.remedy.startswith(remedy)


async def test_a_missing_file_is_refused(robot: Rig) -> None:
    with pytest.raises(RejectedError, match="there is no file"):
        await robot.do("screen", file="nowhere.png")


async def test_readings_come_fast_while_it_moves_and_slowly_while_it_stands(robot: Rig) -> None:
    await robot.pace.advance(5.0)
    robot.context.readings.clear()
    await robot.pace.advance(10.0)
    assert len(robot.context.of("joint.pan")) == 10
    robot.context.readings.clear()
    robot.begin("pose", joints={"pan": 60}, seconds=4.0)
    await robot.pace.advance(4.0)
    assert 39 <= len(robot.context.of("joint.pan")) <= 41
    assert set(SimulatedRobot.offer(SimulatedSettings()).sensors) == {
        r.sensor for r in robot.context.readings
    }


# -- shape and visitor ----------------------------------------------------------------------------


def test_a_head_joint_that_is_not_there_is_a_problem_of_the_file() -> None:
    assert SimulatedSettings().problems() == []
    assert SimulatedSettings(yaw_joint="neck").problems() == [
        ("yaw_joint", "there is no joint 'neck'")
    ]
    assert SimulatedSettings(joints={}).problems() == []


def test_a_robot_without_a_head_offers_no_gaze() -> None:
    legs = SimulatedSettings(joints={"knee": SimulatedJoint()})
    verbs = {verb.name for verb in SimulatedRobot.offer(legs).verbs}
    assert "pose" in verbs
    assert not {"gaze", "nudge", "hip"} & verbs
    assert "pose" not in {
        verb.name for verb in SimulatedRobot.offer(SimulatedSettings(joints={})).verbs
    }


async def visits(tmp_path: Path, speech: Callable[[Rig], Awaitable[Any]]) -> list[Any]:
    async with rig(tmp_path, SimulatedSettings(visitor=True, seed=11)) as simulated_rig:
        await simulated_rig.pace.advance(14.0)
        await speech(simulated_rig)
        await simulated_rig.pace.advance(5.0)
        return [(r.sensor, r.value, r.text) for r in simulated_rig.context.readings]


async def test_the_same_seed_and_the_same_wizard_give_the_same_readings(tmp_path: Path) -> None:
    async def greet(simulated_rig: Rig) -> None:
        await simulated_rig.do("say", text="Hello, who are you?")

    async def silence(simulated_rig: Rig) -> None:
        await simulated_rig.do("home")

    first = await visits(tmp_path, greet)
    assert first == await visits(tmp_path, greet)
    assert first != await visits(tmp_path, silence)
    assert {"presence", "gaze", "identity", "distance", "loudness", "direction"} <= {
        sensor for sensor, _, _ in first
    }
    assert [value for sensor, value, _ in first if sensor == "loudness.threshold"] == [0.027]


async def test_time_lapse_runs_everything_faster(tmp_path: Path) -> None:
    async with rig(tmp_path, SimulatedSettings(visitor=True, speed=20)) as simulated_rig:
        task = simulated_rig.begin("say", text="x" * 140)
        await simulated_rig.pace.advance(0.6)
        assert task.done()
        await simulated_rig.pace.advance(2.0)
        assert max(reading.value or 0 for reading in simulated_rig.context.of("presence")) == 1
        assert len(simulated_rig.context.of("distance")) <= 28


def test_a_voice_alone_leaves_the_body_to_another_driver() -> None:
    settings = SimulatedSettings(voice_only=True)
    assert [verb.name for verb in SimulatedRobot.offer(settings).verbs] == [
        "say",
        "utter",
        "sound",
        "volume",
    ]
    assert SimulatedRobot.offer(settings).sensors == ()


async def test_every_verb_that_it_offers_is_carried_out_by_something(robot: Rig) -> None:
    """`fault` is no act of the robot but one against it."""
    offered = {verb.name for verb in SimulatedRobot.offer(robot.robot.settings).verbs}
    assert offered - {"fault"} <= set(robot.robot._performers), "name it in the table of `__init__`"


async def test_a_console_draws_its_body_and_the_face_that_it_shows(robot: Rig) -> None:
    outlines = outlines_of({"robot": SimulatedRobot.offer(SimulatedSettings()).outline})
    (body,) = body_outlines(outlines)
    assert [*body.home] == ["hip", "pan", "tilt"]
    look = body.chain.ray({"pan": 90.0, "tilt": 30.0})[1]  # to its left, and down
    assert look == pytest.approx((0.0, 0.866, -0.5), abs=0.01)
    await robot.pace.advance(0.1)
    robot.begin("emotion", emotion="happy", intensity=0.8)
    await robot.pace.advance(1.0)
    neutral, happy = (one for one in robot.context.shown if isinstance(one, FaceShown))
    assert (neutral.emotion, happy.emotion, happy.intensity) == ("neutral", "happy", 0.8)
    assert (happy.width, neutral.rows) != (0, happy.rows)


def test_a_voice_alone_has_no_body() -> None:
    assert SimulatedRobot.offer(SimulatedSettings(voice_only=True)).outline == {}
