"""The driver `ros` against the simulated rosbridge: what it sends, what it makes of answers, how it
stops, loses and finds the robot.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from robot_simulators.ros_robot import SimulatedGoal
from robot_simulators.rosbridge import RosbridgeSimulator
from woz_drivers.ros import __main__ as draft_program
from woz_drivers.ros import doctor, velocity_drive
from woz_drivers.ros.driver import Ros
from woz_drivers.ros.settings import RosSettings

from tests.drivers.ros.robots import ROBOT, connected_ros, settings, simulator
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverError,
    Health,
    Probe,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.testing import PlainJob, RecordingContext, until

#: How long a goal takes that a test ends, in seconds.
FOR_EVER_S = 1e6
BOTH = pytest.mark.parametrize("ros", [1, 2], ids=["ros1", "ros2"])


# -- what it plays ---------------------------------------------------------------------------------


async def test_a_text_is_said_until_the_robot_says_that_it_has_ended() -> None:
    async with connected_ros() as rig:
        task = rig.begin("say", text="Hello")
        await until(lambda: rig.published_on("/tts") == [{"data": "Hello"}])
        assert not task.done()
        assert (await task)["message"] == {"data": "Hello"}


async def test_what_never_begins_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_drivers.ros.driver._BEGINS_S", 0.05)
    silent = ROBOT.replace("subscribe: /tts/speaking", "subscribe: /tts/other")
    async with connected_ros(settings(silent)) as rig:
        rig.robot.interface["speech"].clear()
        with pytest.raises(DriverError, match="begun"):
            await rig.play("say", text="Hello")
        await until(lambda: rig.published_on("/tts") == [{"data": "Hello"}, {"data": ""}])


async def test_a_time_may_be_counted_from_the_text() -> None:
    async with connected_ros() as rig:
        job = PlainJob("emotion", {"emotion": "joy!!", "intensity": 1.0})
        await rig.driver.perform(job)
        assert job.expected == [pytest.approx(0.25)]


async def test_looking_stays_within_the_bounds_of_the_file() -> None:
    async with connected_ros() as rig:
        await rig.play("gaze", yaw=30.0, pitch=10.0)
        await rig.play("nudge", yaw=50.0)
        await rig.play("nudge", pitch=-90.0)
        radians = [(sent["z"], sent["y"]) for sent in rig.published_on("/head")]
        wanted = [(30, -10), (60, -10), (60, 20)]
        for found, (yaw, down) in zip(radians, wanted, strict=True):
            assert found == pytest.approx((math.radians(yaw), math.radians(down)), abs=1e-4)


async def test_poses_are_taken_one_after_the_other() -> None:
    async with connected_ros() as rig:
        poses: Any = [{"joints": {"pan": 90.0}, "seconds": 0.1}, {"joints": {"tilt": 10.0}}]
        task = rig.begin("poses", poses=poses)
        await until(lambda: len(rig.published_on("/joints")) == 2)
        first, second = rig.published_on("/joints")
        assert first["joint_names"] == ["pan"]
        assert first["points"][0]["positions"] == [pytest.approx(1.570796)]
        assert first["points"][0]["time_from_start"] == {"secs": 0, "nsecs": 100000000}
        assert second["joint_names"] == ["tilt"]
        task.cancel()
        with pytest.raises(RejectedError, match="pan"):
            await rig.play("pose", joints={"pan": 91.0}, seconds=1.0)
        with pytest.raises(RejectedError, match="neck"):
            await rig.play("pose", joints={"neck": 1.0}, seconds=1.0)


@BOTH
async def test_an_action_ends_with_its_result(ros: int) -> None:
    async with connected_ros(settings(ros=ros)) as rig:
        sent = await rig.play("play", move="wave")
        assert sent["message"] == {"name": "hello_2"}
        assert sent["result"] == {"success": True}


@BOTH
async def test_an_action_that_ends_badly_says_so(ros: int) -> None:
    async with connected_ros(settings(ros=ros)) as rig:
        rig.robot.goal_s = FOR_EVER_S
        task = rig.begin("play", move="wave")
        await until(lambda: bool(rig.robot.goals))
        for goal in rig.robot.goals.values():
            goal.cancelled.set()
        with pytest.raises(DriverError, match="cancelled"):
            await task


@BOTH
async def test_a_goal_that_nobody_takes_holds_up_nothing(ros: int) -> None:
    text = ROBOT.replace("values: {move", "within: 4.0\n    values: {move")
    async with connected_ros(settings(text, ros=ros)) as rig:
        rig.robot.refuse_goals = True
        task = rig.begin("play", move="wave")
        await rig.play("gaze", yaw=1.0)
        with pytest.raises(DriverError, match=r"refused|did not end"):
            await task
        rig.robot.refuse_goals = False
        await rig.play("play", move="nod")


@BOTH
async def test_an_action_whose_node_is_dead_fails_soon_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, ros: int
) -> None:
    monkeypatch.setattr("woz_drivers.ros.rosbridge.ACCEPTED_S", 0.2)
    monkeypatch.setattr("woz_drivers.ros.rosbridge.SERVED_S", 0.2)
    async with connected_ros(settings(ros=ros)) as rig:
        rig.robot.dead.add("/gesture")
        with pytest.raises(DriverError, match="no node of the robot carries out /gesture") as dead:
            await rig.play("play", move="wave")
        assert dead.value.remedy.startswith("start its node")
        rig.robot.dead.clear()
        rig.robot.goal_s = FOR_EVER_S
        task = rig.begin("play", move="wave")
        await until(lambda: bool(rig.robot.goals))
        rig.robot.dead.add("/gesture")  # it ends in the middle
        with pytest.raises(DriverError, match="carries out /gesture"):
            await task


@BOTH
async def test_what_nobody_listens_to_is_not_done(ros: int) -> None:
    async with connected_ros(settings(ros=ros)) as rig:
        rig.robot.dead |= {"/head", "/tts"}
        for verb, args in (("gaze", {"yaw": 1.0}), ("say", {"text": "Hello"})):
            with pytest.raises(DriverError, match=f"{verb}: no node of the robot listens to /"):
                await rig.play(verb, **args)


async def test_a_robot_says_how_much_it_can_know_of_each_verb() -> None:
    known = {verb.name: verb.evidence for verb in Ros.offer(settings()).verbs}
    assert known == {
        **{"say": "reported", "play": "reported", "volume": "reported", "drive": "measured"},
        **dict.fromkeys(("gaze", "nudge", "emotion", "pose", "poses"), "timed"),
    }


async def test_a_base_that_does_not_move_has_not_driven() -> None:
    async with connected_ros() as rig:
        assert await rig.play("drive", x=1.0)
        rig.robot.dead.add("/cmd_vel")
        with pytest.raises(DriverError, match="/odom says that the base has not moved"):
            await rig.play("drive", x=1.0)


async def test_a_goal_that_is_refused_is_known_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """The server of ROS 2 never says it: its action does not count the goal among its own."""
    async with connected_ros(settings(ros=2), pace=5.0) as rig:
        await rig.play("play", move="wave")
        rig.robot.refuse_goals = True
        with monkeypatch.context() as hurried, pytest.raises(DriverError, match="accept"):
            hurried.setattr("woz_drivers.ros.rosbridge.ACCEPTED_S", 0.4)
            await rig.play("play", move="wave")
        rig.robot.refuse_goals = False
        await rig.play("play", move="nod")


async def test_a_goal_that_is_accepted_late_is_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    async with connected_ros(settings(ros=2), pace=5.0) as rig:
        await rig.play("play", move="wave")
        monkeypatch.setattr("woz_drivers.ros.rosbridge.ACCEPTED_S", 0.4)
        rig.robot.goal_s = FOR_EVER_S
        rig.robot.accepts_goals.clear()
        with pytest.raises(DriverError, match="accept"):
            await rig.play("play", move="wave")
        assert await rig.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        rig.robot.accepts_goals.set()
        await until(lambda: [goal.status for goal in rig.robot.ended] == ["done", "canceled"])


async def test_a_cancelled_goal_whose_end_is_never_told_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_drivers.ros.rosbridge._CANCELLED_WITHIN_S", 0.5)
    async with connected_ros(settings(ros=1)) as rig:
        rig.robot.goal_s = FOR_EVER_S
        rig.robot.tells_results = False
        task = rig.begin("play", move="wave")
        await until(lambda: bool(rig.robot.goals))
        task.cancel()
        await rig.driver.stop(Scope.ALL)
        await rig.driver.stop(Scope.ALL)
        await until(lambda: bool(rig.context.notices))
        [(_, text, _)] = rig.context.notices
        assert "/gesture did not say" in text
        repeated = len([1 for sent in rig.published_on("/gesture/cancel") if sent["id"]])
        assert await rig.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        assert len([1 for sent in rig.published_on("/gesture/cancel") if sent["id"]]) == repeated


async def test_the_next_command_waits_until_the_last_one_was_ended() -> None:
    bow = """
  bow:
    service: /bow
    type: robot_msgs/Bow
    stop: {service: /unbow, type: robot_msgs/Bow}
"""
    text = ROBOT.replace("\njoints:", bow + "joints:") + "\n  robot_msgs/Bow_Request: {}\n"
    async with connected_ros(settings(text)) as rig:
        held = rig.robot.busy["/bow"] = rig.robot.busy["/unbow"] = asyncio.Event()
        first = rig.begin("bow")
        await until(lambda: ("call_service", "/bow") in _services(rig.robot))
        first.cancel()
        await asyncio.gather(first, return_exceptions=True)
        second = rig.begin("bow")
        await until(lambda: ("call_service", "/unbow") in _services(rig.robot))
        await rig.play("volume", level=1.0)
        assert _services(rig.robot).count(("call_service", "/bow")) == 1
        held.set()
        await second
        bows = [name for _, name in _services(rig.robot) if name in ("/bow", "/unbow")]
        assert bows == ["/bow", "/unbow", "/bow"]


async def test_a_step_begins_where_the_robot_looks_not_where_it_refused_to() -> None:
    asked = "publish: /head\n    type: geometry_msgs/Vector3"
    by_service = "service: /look\n    type: robot_msgs/Look"
    look = (
        "robot_msgs/Look_Request: {y: float64, z: float64}\n"
        "  robot_msgs/Look_Response: {success: bool}\n"
    )
    text = ROBOT.replace(asked, by_service).replace("types:\n", f"types:\n  {look}")
    async with connected_ros(settings(text)) as rig:
        await rig.play("gaze", yaw=10.0)
        rig.robot.faults.refused["/look"] = "the head is busy"
        with pytest.raises(DriverError, match="busy"):
            await rig.play("gaze", yaw=50.0)
        rig.robot.faults.refused.clear()
        assert (await rig.play("nudge", yaw=5.0))["yaw"] == 15.0


async def test_a_service_answers_and_may_say_that_it_failed() -> None:
    async with connected_ros() as rig:
        sent = await rig.play("volume", level=0.256)
        assert sent["message"] == {"percent": 26}
        rig.robot.faults.refused["/volume"] = "no sound card"
        with pytest.raises(DriverError, match="no sound card"):
            await rig.play("volume", level=1.0)


@BOTH
async def test_a_busy_service_keeps_neither_a_key_nor_the_stop_waiting(ros: int) -> None:
    """The server of ROS 2 reads nothing of a connection on which a service is busy."""
    async with connected_ros(settings(ros=ros)) as rig:
        rig.robot.busy["/volume"] = asyncio.Event()
        task = rig.begin("volume", level=1.0)
        await until(lambda: ("call_service", "/volume") in _services(rig.robot))
        await rig.play("say", text="Hello")
        drive = rig.begin("drive", x=5.0)
        await until(lambda: rig.robot.speed[0] > 0)
        report = await rig.driver.stop(Scope.ALL)
        assert report == StopReport(("driving", "play", "say"))
        for job in (task, drive):
            job.cancel()
        await asyncio.gather(task, drive, return_exceptions=True)


def _services(robot: RosbridgeSimulator) -> list[tuple[str, Any]]:
    return [(name, message.get("service")) for name, message in robot.calls]


# -- the base --------------------------------------------------------------------------------------


async def test_a_drive_is_velocities_while_it_lasts_and_zero_at_its_end() -> None:
    async with connected_ros(pace=1.0) as rig:
        sent = await rig.play("drive", x=1.0, turn=-90.0)
        assert sent["seconds"] == 2.0
        told = [(x, turn) for _, x, turn in rig.robot.velocities]
        [_, moving, standing] = [[*group] for _, group in itertools.groupby(told)]
        assert moving[0] == (0.5, -0.7854)
        assert 2 <= len(moving) <= 21  # a busy machine may stand still for a while
        assert standing[0] == (0.0, 0.0)
        with pytest.raises(RejectedError):
            await rig.play("drive")


async def test_the_simulated_base_drives_sideways_too() -> None:
    text = ROBOT.replace("drive: {topic", "drive: {sideways: true, topic")
    async with connected_ros(settings(text), pace=1.0) as rig:
        await rig.play("drive", y=0.5)
        forward, left, _ = rig.robot._place
        assert abs(forward) < 0.01
        assert left > 0.2


async def test_a_stamped_velocity_has_its_frame() -> None:
    text = ROBOT.replace("/cmd_vel, ", "/cmd_vel, type: geometry_msgs/TwistStamped, ")
    async with connected_ros(settings(text)) as rig:
        await rig.play("drive", x=0.01)
        velocities = {message["twist"]["linear"]["x"] for message in rig.published_on("/cmd_vel")}
        assert velocities == {0.0, 0.5}  # how often each is sent depends on the machine
        assert all(
            sent["header"] == {"frame_id": "base_link"} for sent in rig.published_on("/cmd_vel")
        )
        assert rig.robot.velocities[-1][1:] == (0.0, 0.0)


async def test_the_first_message_on_a_connection_is_a_velocity_of_zero() -> None:
    async with connected_ros() as rig:
        await rig.play("gaze", yaw=1.0)
        published = [m["topic"] for name, m in rig.robot.calls if name == "publish"]
        assert published[:1] == ["/cmd_vel"]
        assert rig.robot.velocities[0][1:] == (0.0, 0.0)


async def test_a_base_that_rolls_on_is_told_zero_until_it_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With ROS 2 nobody hears the first messages of a new publisher."""
    monkeypatch.setattr("woz_drivers.ros.driver._FOUND_EACH_OTHER", 1)
    of = settings()
    async with simulator(of) as robot:
        heard, robot.interface = robot.interface, {**robot.interface, "drive": ""}
        robot._commanded = (math.inf, 0.3, 0.0)
        driver = Ros("robot", replace(of, address=robot.address), RecordingContext(Path()))
        await driver.open()
        await until(lambda: _published(robot, "/cmd_vel") > 3)
        robot.interface = heard
        await until(lambda: robot.speed == (0.0, 0.0))
        await driver.close()


def _published(robot: RosbridgeSimulator, topic: str) -> int:
    return len([1 for name, it in robot.calls if name == "publish" and it["topic"] == topic])


async def test_a_stop_of_driving_leaves_the_rest() -> None:
    async with connected_ros() as rig:
        say = rig.begin("say", text="x" * 500)
        drive = rig.begin("drive", x=5.0)
        await until(lambda: rig.robot.speed[0] > 0 and bool(rig.published_on("/tts")))
        assert await rig.driver.stop(Scope.DRIVE) == StopReport(("driving",))
        assert rig.robot.speed == (0.0, 0.0)
        drive.cancel()
        assert {"data": ""} not in rig.published_on("/tts")
        assert not say.done()
        say.cancel()
        await asyncio.gather(drive, say, return_exceptions=True)


async def test_a_stop_of_driving_ends_an_action_that_drives() -> None:
    text = ROBOT.replace("values: {move", "drives: true\n    values: {move")
    async with connected_ros(settings(text)) as rig:
        rig.robot.goal_s = FOR_EVER_S
        assert next(
            one for one in Ros.offer(rig.driver.settings).verbs if one.name == "play"
        ).drives
        task = rig.begin("play", move="wave")
        await until(lambda: bool(rig.robot.goals))
        assert await rig.driver.stop(Scope.DRIVE) == StopReport(("driving", "play"))
        assert not rig.robot.goals
        await asyncio.gather(task, return_exceptions=True)


@pytest.mark.parametrize(
    ("sends", "drives"),
    [
        ("{publish: /cmd_vel, type: geometry_msgs/msg/Twist}", True),
        ("{action: /go, type: nav2_msgs/NavigateToPose}", True),
        ("{publish: /words, type: std_msgs/String}", False),
    ],
)
def test_what_sends_a_velocity_or_a_goal_drives_whatever_it_is_called(
    sends: str, drives: bool
) -> None:
    [verb] = Ros.offer(settings(f"address: 'ws://127.0.0.1:9090'\nverbs:\n  hop: {sends}\n")).verbs
    assert verb.drives is drives


async def test_a_base_that_rolls_on_has_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", 0.3)
    async with connected_ros() as rig:
        rig.robot.interface = {**rig.robot.interface, "drive": ""}  # it hears of no velocity
        rig.robot._commanded = (math.inf, 0.3, 0.0)
        report = await rig.driver.stop(Scope.DRIVE)
        assert report == StopReport(missing=("driving",))


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "nan", "-inf"])
async def test_a_stop_is_confirmed_by_odometry_with_a_number_that_json_has_not(number: str) -> None:
    async with connected_ros() as rig:
        rig.robot.replaced = ('"covariance": [0', f'"covariance": [{number}')
        assert await rig.driver.stop(Scope.DRIVE) == StopReport(("driving",))
        assert not rig.context.notices


async def test_a_base_that_does_not_know_how_fast_it_is_has_not_confirmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", 0.3)
    async with connected_ros() as rig:
        rig.robot.replaced = ('"x": 0.0', '"x": NaN')
        assert await rig.driver.stop(Scope.DRIVE) == StopReport(missing=("driving",))


async def test_a_service_may_answer_with_a_number_that_json_has_not() -> None:
    async with connected_ros() as rig:
        rig.robot.replaced = ('"success": true', '"success": true, "level": NaN')
        await rig.play("volume", level=0.4)


async def test_a_drive_publishes_nothing_behind_a_stop() -> None:
    """Also when the cancellation of its command comes late."""
    async with connected_ros() as rig:
        task = rig.begin("drive", x=5.0)
        await until(lambda: rig.robot.speed[0] > 0)
        await rig.driver.stop(Scope.ALL)
        with pytest.raises(DriverError, match="stopped"):
            await task
        assert rig.robot.velocities[-1][1:] == (0.0, 0.0)


async def test_a_drive_that_is_cancelled_ends_with_zero() -> None:
    async with connected_ros() as rig:
        task = rig.begin("drive", x=5.0)
        await until(lambda: rig.robot.speed[0] > 0)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await until(lambda: rig.robot.velocities[-1][1:] == (0.0, 0.0))


# -- stopping --------------------------------------------------------------------------------------


@BOTH
async def test_a_stop_ends_all_of_it(ros: int) -> None:
    async with connected_ros(settings(ros=ros)) as rig:
        rig.robot.goal_s = FOR_EVER_S
        jobs = [
            rig.begin("drive", x=5.0),
            rig.begin("say", text="x" * 500),
            rig.begin("play", move="wave"),
        ]
        await until(
            lambda: (
                rig.robot.speed[0] > 0 and bool(rig.robot.goals) and bool(rig.published_on("/tts"))
            )
        )
        report = await rig.driver.stop(Scope.ALL)
        assert report == StopReport(("driving", "play", "say"))
        assert rig.robot.speed == (0.0, 0.0)
        assert not rig.robot.goals
        assert rig.published_on("/tts")[-1] == {"data": ""}
        for job in jobs:
            job.cancel()
        await asyncio.gather(*jobs, return_exceptions=True)
        await rig.play("say", text="Hi")


@BOTH
async def test_a_stop_reaches_a_goal_that_somebody_else_sent(ros: int) -> None:
    async with connected_ros(settings(ros=ros)) as rig:
        rig.robot.goal_s = FOR_EVER_S
        other = rig.robot.run(rig.robot.pursue(_goal()))
        await until(lambda: bool(rig.robot.goals))
        await rig.driver.stop(Scope.ALL)
        assert await other == "canceled"


def _goal() -> Any:
    return SimulatedGoal("theirs", "/gesture", "")


async def test_what_cannot_be_stopped_is_named() -> None:
    text = ROBOT + "\n  robot_msgs/Bow_Request: {}\n"
    text = text.replace("\njoints:", "\n  bow: {service: /bow, type: robot_msgs/Bow}\njoints:")
    async with connected_ros(settings(text)) as rig:
        assert await rig.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        rig.robot.busy["/bow"] = asyncio.Event()
        task = rig.begin("bow")
        await until(lambda: ("call_service", "/bow") in _services(rig.robot))
        report = await rig.driver.stop(Scope.ALL)
        assert report == StopReport(("driving", "play", "say"), ("bow",))
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_a_voice_that_goes_on_has_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    async with connected_ros() as rig:
        task = rig.begin("say", text="x" * 500)
        await until(lambda: bool(rig.published_on("/tts")))
        rig.robot.interface["speech"].clear()  # it ignores the empty text
        monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", 0.5)
        report = await rig.driver.stop(Scope.ALL)
        assert report is not None and "say" in report.missing
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_what_was_not_heard_to_begin_is_not_taken_for_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", 0.5)
    async with connected_ros() as rig:
        rig.robot.interface["speech"].clear()  # it begins late
        task = rig.begin("say", text="Hello")
        await until(lambda: bool(rig.published_on("/tts")))
        report = await rig.driver.stop(Scope.ALL)
        assert report is not None and "say" in report.missing
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


# -- loss and return -------------------------------------------------------------------------------


async def test_what_was_going_on_ends_first_when_the_robot_is_back() -> None:
    async with connected_ros() as rig:
        rig.robot.goal_s = FOR_EVER_S
        jobs = [rig.begin("say", text="x" * 500), rig.begin("play", move="wave")]
        await until(lambda: bool(rig.published_on("/tts")) and bool(rig.robot.goals))
        rig.robot.drop()
        for job in jobs:
            with pytest.raises(DeviceLostError):
                await job
        await until(
            lambda: [state for state, *_ in rig.context.healths].count(Health.CONNECTED) == 2
        )
        assert rig.published_on("/tts")[-1] == {"data": ""}
        assert not rig.robot.goals
        await rig.play("say", text="Again")
        await until(lambda: rig.context.of("distance")[-1].value is not None)


async def test_a_stop_while_it_is_gone_names_what_may_go_on() -> None:
    async with connected_ros() as rig:
        task = rig.begin("say", text="x" * 500)
        await until(lambda: bool(rig.published_on("/tts")))
        rig.robot.faults.refused["/"] = "gone"
        rig.robot.drop()
        await rig.healthy(Health.LOST)
        await asyncio.gather(task, return_exceptions=True)
        assert await rig.driver.stop(Scope.ALL) == StopReport(missing=("driving", "say"))
        with pytest.raises(DeviceLostError):
            await rig.play("gaze", yaw=1.0)


async def test_what_it_said_before_a_loss_does_not_count() -> None:
    async with connected_ros() as rig:
        rig.robot.interface["speech"].clear()  # whoever made it speak, its end is not heard
        rig.robot.publish("/tts/speaking", {"data": True})
        await rig.driver.stop(Scope.DRIVE)
        rig.robot.drop()
        await rig.healthy(Health.LOST)
        await rig.healthy()
        assert await rig.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))


async def test_a_call_that_waits_for_its_connection_is_not_sent_after_a_loss() -> None:
    async with connected_ros() as rig:
        # The robot was compared with its file: one connection is kept for calls, and the first
        # call takes it.
        await until(lambda: ("call_service", "/rosapi/action_servers") in _services(rig.robot))
        await rig.play("volume", level=0.0)
        rig.robot.busy["/volume"] = asyncio.Event()
        first = rig.begin("volume", level=0.1)
        await until(lambda: _percents(rig.robot) == [0, 10])
        rig.robot.freeze()
        second = rig.begin("volume", level=1.0)
        await rig.healthy(Health.LOST)
        for job in (first, second):
            with pytest.raises(DeviceLostError):
                async with asyncio.timeout(20):
                    await job
        rig.robot.busy.clear()
        rig.robot.thaw()
        await rig.healthy()
        await rig.play("volume", level=0.2)
        assert _percents(rig.robot) == [0, 10, 20]


def _percents(robot: RosbridgeSimulator) -> list[int]:
    """The volumes that it was asked for."""
    return [it["args"]["percent"] for _, it in robot.calls if it.get("service") == "/volume"]


async def test_a_server_that_takes_no_further_connection_is_not_lost() -> None:
    async with connected_ros(query="?token=secret") as rig:
        rig.robot.busy["/volume"] = asyncio.Event()
        rig.robot.faults.refused["/"] = "too many"
        # One connection is kept in reserve, and another may be on its way: the third call has none.
        calls = [rig.begin("volume", level=0.1) for _ in range(3)]
        ended, held = await asyncio.wait(calls, timeout=20, return_when=asyncio.FIRST_COMPLETED)
        refused = [call.exception() for call in ended]
        assert refused
        for error in refused:
            assert isinstance(error, DriverError) and not isinstance(error, DeviceLostError)
            assert "no further connection: 500" in str(error)
            assert "secret" not in str(error)
        for call in held:
            call.cancel()
        await asyncio.gather(*held, return_exceptions=True)
        await rig.play("gaze", yaw=1.0)


async def test_a_password_in_the_address_is_not_shown() -> None:
    async with connected_ros(query="?token=secret") as rig:
        rig.robot.drop()
        await rig.healthy(Health.LOST)
        await rig.healthy()
        findings = await doctor.examine(Probe("robot", rig.driver.settings))
        assert "secret" not in repr((rig.context.healths, rig.context.notices, findings))


async def test_a_rosapi_that_hangs_keeps_no_stop_waiting() -> None:
    """With ROS 2 a connection waits for each service that is called on it."""
    async with connected_ros() as rig:
        for service in ("get_time", "topics", "topics_and_raw_types", "services"):
            rig.robot.busy[f"/rosapi/{service}"] = asyncio.Event()
        assert await rig.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        await rig.play("drive", x=0.05)


async def test_a_frozen_robot_gets_no_more_velocities_and_a_zero_behind_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(velocity_drive, "_SILENT_S", 0.4)
    async with connected_ros(pace=1.0) as rig:
        task = rig.begin("drive", x=20.0)
        await until(lambda: len(rig.robot.velocities) > 2)
        rig.robot.freeze()
        before = len(rig.robot.velocities)
        with pytest.raises(DriverError, match="answer"):
            await task
        rig.robot.thaw()
        await until(lambda: rig.robot.velocities[-1][1:] == (0.0, 0.0))
        late = [x for _, x, _ in rig.robot.velocities[before:] if x > 0]
        assert len(late) <= 2


async def test_a_slow_sensor_is_slow_beside_a_fast_one_on_the_same_topic() -> None:
    slow = "  slow: {subscribe: /sonar, type: sensor_msgs/Range, value: range, throttle: 60 s}\n"
    both = settings(ROBOT.replace("sensors:\n", f"sensors:\n{slow}"))
    async with connected_ros(both) as rig:
        await until(lambda: len(rig.context.of("distance")) > 5)
        assert len(rig.context.of("slow")) == 1


async def test_sensors_that_fall_silent_are_stale(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_S", 0.2)
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_READINGS", 0)
    async with connected_ros() as rig:
        await until(lambda: bool(rig.context.of("distance")) and bool(rig.context.of("ahead")))
        assert rig.context.latest("distance") == rig.context.latest("ahead") == 4.5
        rig.robot.interface["sensors"].pop("distance")
        await until(lambda: ("distance", "stale", "/sonar is silent") in rig.context.states)

        def now() -> dict[str, str]:
            return {sensor: state for sensor, state, _ in rig.context.states}

        # On a busy machine it may have been silent for a moment, too.
        await until(lambda: (now()["distance"], now()["ahead"]) == ("stale", "ok"))


async def test_a_topic_that_says_little_by_nature_is_not_stale_meanwhile(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_S", 0.2)
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_READINGS", 5)
    rare = settings(ROBOT.replace("/sonar,", "/sonar, every: 3600 s,"))
    async with connected_ros(rare) as rig:
        await until(lambda: bool(rig.context.of("distance")) and bool(rig.context.of("ahead")))
        for name in ("distance", "ahead"):
            rig.robot.interface["sensors"].pop(name)
        await until(lambda: any(state[:2] == ("ahead", "stale") for state in rig.context.states))
        assert not any(state[:2] == ("distance", "stale") for state in rig.context.states)
        assert rig.context.periods["distance"] == 3600.0


# -- wrong answers ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "nonsense",
    [
        "no JSON",
        "[" * 5000,
        "[1, 2]",
        '{"op": "service_response"}',
        '{"op": "service_response", "id": 7, "values": null}',
        '{"op": "publish", "topic": "/odom", "msg": {"twist": 3}}',
        '{"op": "publish", "topic": "/sonar", "msg": {"range": "far"}}',
        '{"op": "publish"}',
        '{"op": "png", "data": "x"}',
    ],
)
async def test_nonsense_does_no_harm(nonsense: str) -> None:
    async with connected_ros() as rig:
        for client in tuple(rig.robot._clients):
            client._outgoing.put_nowait(nonsense)
        await rig.play("say", text="Hello")
        assert rig.context.healths[-1][0] is Health.CONNECTED
        await rig.play("drive", x=0.01)


async def test_an_error_that_the_server_tells_is_shown() -> None:
    async with connected_ros() as rig:
        for client in tuple(rig.robot._clients):
            for words in (*("no topic",) * 3, "no type"):
                status = {"op": "status", "level": "error", "msg": words}
                client._outgoing.put_nowait(json.dumps(status))
        await until(lambda: any("no type" in text for _, text, _ in rig.context.notices))
        assert len([1 for _, text, _ in rig.context.notices if "no topic" in text]) == 1


async def test_something_else_that_listens_there_is_not_taken_for_the_robot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_drivers.ros.rosbridge._KNOWN_WITHIN_S", 0.1)
    of = settings()
    async with simulator(of) as robot:
        robot.busy["/rosapi/read_so_far"] = (
            asyncio.Event()
        )  # it takes what is sent, and says nothing
        context = RecordingContext(Path())
        driver = Ros("robot", replace(of, address=robot.address), context)
        await driver.open()
        await until(lambda: any("rosbridge" in what for _, what, _ in context.healths))
        assert Health.CONNECTED not in [state for state, *_ in context.healths]
        await driver.close()


# -- comparing with the robot ----------------------------------------------------------------------


@BOTH
async def test_what_does_not_fit_the_robot_is_told_and_refused(ros: int) -> None:
    of = settings(ros=ros)
    async with simulator(of) as robot:
        robot.topics["/tts"] = "std_msgs/Int32"
        del robot.topics["/face"]
        context = RecordingContext(Path())
        driver = Ros("robot", replace(of, address=robot.address), context)
        await driver.open()
        await until(lambda: bool(context.notices))
        assert any("/tts is std_msgs/Int32" in text for _, text, _ in context.notices)
        assert any("no topic /face" in text for _, text, _ in context.notices)
        with pytest.raises(DriverError, match="Int32"):
            await driver.perform(PlainJob("say", {"text": "Hello"}))
        await driver.perform(PlainJob("gaze", {"yaw": 1.0, "pitch": None}))
        await driver.close()


@BOTH
async def test_the_doctor_lists_what_there_is_and_drafts_a_file(ros: int) -> None:
    of = settings(ros=ros)
    async with simulator(of) as robot:
        there = replace(of, address=robot.address)
        findings = await doctor.examine(Probe("robot", there))
        text = await doctor.draft(there)
    assert not [finding for finding in findings if finding.level in ("error", "warning")]
    listed = {finding.subject: finding.text for finding in findings}
    assert "/cmd_vel (geometry_msgs/Twist)" in listed["topics"]
    assert "/volume (robot_msgs/Volume)" in listed["services"]
    assert "/gesture" in listed["actions"]
    drafted = settings("\n".join(line[4:] for line in text.splitlines()[5:]))
    assert drafted.ros == ros
    assert drafted.drive is not None
    assert drafted.drive.topic == "/cmd_vel"
    assert drafted.verbs["say"].publish == "/tts"


def _scanner(value: str, mounted: float = 0.0) -> RosSettings:
    kind = "type: sensor_msgs/LaserScan"
    line = f"{{subscribe: /scan, {kind}, value: '{value}', mounted: {mounted}}}"
    return settings(f"sensors: {{ahead: {line}}}")


@pytest.mark.parametrize(
    ("of", "where", "reads"),
    [
        (_scanner("min(ranges[-15deg:15deg])", 90.0), "front", r"15deg\]\) reads \d"),
        (_scanner("min(ranges[-15deg:15deg])"), "right", r"15deg\]\) reads nothing"),
        (_scanner("min(ranges[0:20])"), "right", "looks at 0 to 19 deg, and reads nothing"),
        (_scanner("min(ranges[-95:-85])"), "right", r"looks at -95 to -86 deg, and reads \d"),
    ],
)
async def test_the_doctor_says_where_a_scanner_sees_what(
    of: RosSettings, where: str, reads: str
) -> None:
    """Its zero points to the left, and it sees something in front of the robot alone."""
    async with simulator(_scanner("min(ranges)", 90.0)) as robot:
        findings = await doctor.examine(Probe("robot", replace(of, address=robot.address)))
    about = [finding.text for finding in findings if finding.subject == "sensors.ahead"]
    assert re.search(rf"{where} \d\.\d\d m at -?\d+ deg", about[0])
    assert about[0].count("nothing") == 3
    assert re.search(reads, about[1])


@pytest.mark.parametrize(
    ("value", "reads"),
    [
        ("range_max", r"range_max reads \d"),
        ("intensities[0]", r"intensities\[0\] reads"),
        ("header.frame_id", "header.frame_id reads"),
    ],
)
async def test_the_doctor_reads_what_a_scanner_says_beside_its_ranges(
    value: str, reads: str
) -> None:
    of = _scanner(value)
    async with simulator(of) as robot:
        findings = await doctor.examine(Probe("robot", replace(of, address=robot.address)))
    about = [one for one in findings if one.subject == "sensors.ahead"]
    assert [one.level for one in about] == ["info", "ok"]
    assert re.search(reads, about[1].text)


async def test_the_doctor_names_a_scanner_that_is_silent_or_looks_elsewhere() -> None:
    of = _scanner("min(ranges[80deg:100deg])")
    async with simulator(of) as robot:
        there = replace(of, address=robot.address)
        robot.replaced = ('"angle_increment": 0.017', '"angle_increment": 0.000')
        findings = await doctor.examine(Probe("robot", there))
        assert any("/scan does not look there" in finding.text for finding in findings)
        assert any("left not looked at" in finding.text for finding in findings)
        robot.replaced = ('"topic": "/scan"', '"topic": "/elsewhere"')
        findings = await doctor.examine(Probe("robot", there))
    assert any("/scan is silent" in finding.text for finding in findings)


async def test_a_draft_without_a_voice_can_be_read() -> None:
    of = settings(ROBOT.replace("/tts", "/x"))
    async with simulator(of) as robot:
        text = await doctor.draft(replace(of, address=robot.address))
    assert settings("\n".join(line[4:] for line in text.splitlines()[5:])).verbs == {}


async def test_the_doctor_warns_of_a_server_without_a_password() -> None:
    of = replace(settings(), address="robot.invalid")
    assert [finding.level for finding in doctor._protected(of)] == ["warning"]
    for safe in ("wss://robot/ros", "127.0.0.1:9090", "simulated"):
        assert not [*doctor._protected(replace(of, address=safe))]


async def test_the_doctor_says_what_is_wrong_with_an_address() -> None:
    [finding] = await doctor.examine(Probe("robot", replace(settings(), address="127.0.0.1:9")))
    assert finding.level == "error"


async def test_a_file_for_the_other_ros_is_told_so() -> None:
    of = settings(ros=1)
    async with simulator(of) as robot:
        there = replace(of, ros=2, address=robot.address)
        findings = await doctor.examine(Probe("robot", there))
    assert "write ros: 1" in [finding.remedy for finding in findings]


async def test_the_simulated_robot_of_a_file_is_started_and_ended(tmp_path: Path) -> None:
    context = RecordingContext(tmp_path)
    driver = Ros("robot", settings(), context)
    await driver.open()
    await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
    await driver.perform(PlainJob("play", {"move": "wave", "speed": 1.0, "amplitude": 1.0}))
    await driver.close()


async def test_further_connections_do_not_start_the_simulated_robot_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    context = RecordingContext(tmp_path)
    driver = Ros("robot", settings(), context)
    await driver.open()
    await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
    monkeypatch.setattr("woz_drivers.programs.simulated_process._HOPELESS_S", -1.0)
    calls = [driver.perform(PlainJob("volume", {"level": level / 10})) for level in range(4)]
    await asyncio.gather(*calls)
    assert Health.LOST not in [health for health, *_ in context.healths]
    await driver.close()


def test_a_draft_of_a_robot_that_nobody_knows_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["ros", "robot.invalid:9090"])  # RFC 2606: no such host
    assert draft_program.main() == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("no host is called robot.invalid; ")


async def test_how_long_a_command_takes_is_foretold_as_far_as_the_file_says() -> None:
    commands: dict[str, dict[str, Any]] = {
        "drive": {"x": 1.0, "turn": 90.0},
        "emotion": {"emotion": "happy"},
        "poses": {"poses": [{"joints": {"pan": 5}, "seconds": 2}, {"joints": {"pan": 0}}]},
        "say": {"text": "Hello"},
        "play": {"move": "wave"},
    }
    async with connected_ros() as rig:
        foretold = {
            verb: (await rig.driver.predict(verb, args)).seconds for verb, args in commands.items()
        }
        known = {"drive": 2.0, "emotion": pytest.approx(0.25), "poses": 3.0}
        assert foretold == {**known, "say": None, "play": None}
        with pytest.raises(RejectedError):
            await rig.driver.predict("drive", {"x": 0.0})
