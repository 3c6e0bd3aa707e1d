"""The driver `ros` against the simulated rosbridge: what it sends, what it makes of answers, how it
stops, loses and finds the robot.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from robot_simulators.ros_robot import SimulatedGoal
from robot_simulators.rosbridge import RosbridgeSimulator
from woz_drivers.ros import __main__ as draft_program
from woz_drivers.ros import doctor, velocity_drive
from woz_drivers.ros.driver import Ros

from tests.drivers.ros.robots import ROBOT, played, settings, simulator
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
    async with played() as it:
        task = it.begin("say", text="Hello")
        await until(lambda: it.sent("/tts") == [{"data": "Hello"}])
        assert not task.done()
        assert (await task)["message"] == {"data": "Hello"}


async def test_what_never_begins_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_drivers.ros.driver._BEGINS_S", 0.05)
    silent = ROBOT.replace("subscribe: /tts/speaking", "subscribe: /tts/other")
    async with played(settings(silent)) as it:
        it.robot.interface["speech"].clear()
        with pytest.raises(DriverError, match="begun"):
            await it.play("say", text="Hello")
        await until(lambda: it.sent("/tts") == [{"data": "Hello"}, {"data": ""}])


async def test_a_time_may_be_counted_from_the_text() -> None:
    async with played() as it:
        job = PlainJob("emotion", {"emotion": "joy!!", "intensity": 1.0})
        await it.driver.perform(job)
        assert job.expected == [pytest.approx(0.25)]


async def test_looking_stays_within_the_bounds_of_the_file() -> None:
    async with played() as it:
        await it.play("gaze", yaw=30.0, pitch=10.0)
        await it.play("nudge", yaw=50.0)
        await it.play("nudge", pitch=-90.0)
        radians = [(sent["z"], sent["y"]) for sent in it.sent("/head")]
        wanted = [(30, -10), (60, -10), (60, 20)]
        for found, (yaw, down) in zip(radians, wanted, strict=True):
            assert found == pytest.approx((math.radians(yaw), math.radians(down)), abs=1e-4)


async def test_poses_are_taken_one_after_the_other() -> None:
    async with played() as it:
        poses: Any = [{"joints": {"pan": 90.0}, "seconds": 0.1}, {"joints": {"tilt": 10.0}}]
        task = it.begin("poses", poses=poses)
        await until(lambda: len(it.sent("/joints")) == 2)
        first, second = it.sent("/joints")
        assert first["joint_names"] == ["pan"]
        assert first["points"][0]["positions"] == [pytest.approx(1.570796)]
        assert first["points"][0]["time_from_start"] == {"secs": 0, "nsecs": 100000000}
        assert second["joint_names"] == ["tilt"]
        task.cancel()
        with pytest.raises(RejectedError, match="pan"):
            await it.play("pose", joints={"pan": 91.0}, seconds=1.0)
        with pytest.raises(RejectedError, match="neck"):
            await it.play("pose", joints={"neck": 1.0}, seconds=1.0)


@BOTH
async def test_an_action_ends_with_its_result(ros: int) -> None:
    async with played(settings(ros=ros)) as it:
        sent = await it.play("play", move="wave")
        assert sent["message"] == {"name": "hello_2"}
        assert sent["result"] == {"success": True}


@BOTH
async def test_an_action_that_ends_badly_says_so(ros: int) -> None:
    async with played(settings(ros=ros)) as it:
        it.robot.goal_s = FOR_EVER_S
        task = it.begin("play", move="wave")
        await until(lambda: bool(it.robot.goals))
        for goal in it.robot.goals.values():
            goal.cancelled.set()
        with pytest.raises(DriverError, match="cancelled"):
            await task


@BOTH
async def test_a_goal_that_nobody_takes_holds_up_nothing(ros: int) -> None:
    text = ROBOT.replace("values: {move", "within: 4.0\n    values: {move")
    async with played(settings(text, ros=ros)) as it:
        it.robot.refuse_goals = True
        task = it.begin("play", move="wave")
        await it.play("gaze", yaw=1.0)
        with pytest.raises(DriverError, match=r"refused|did not end"):
            await task
        it.robot.refuse_goals = False
        await it.play("play", move="nod")


@BOTH
async def test_an_action_whose_node_is_dead_fails_soon_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, ros: int
) -> None:
    monkeypatch.setattr("woz_drivers.ros.rosbridge.ACCEPTED_S", 0.2)
    monkeypatch.setattr("woz_drivers.ros.rosbridge.SERVED_S", 0.2)
    async with played(settings(ros=ros)) as it:
        it.robot.dead.add("/gesture")
        with pytest.raises(DriverError, match="no node of the robot carries out /gesture") as dead:
            await it.play("play", move="wave")
        assert dead.value.remedy.startswith("start its node")
        it.robot.dead.clear()
        it.robot.goal_s = FOR_EVER_S
        task = it.begin("play", move="wave")
        await until(lambda: bool(it.robot.goals))
        it.robot.dead.add("/gesture")  # it ends in the middle
        with pytest.raises(DriverError, match="carries out /gesture"):
            await task


@BOTH
async def test_what_nobody_listens_to_is_not_done(ros: int) -> None:
    async with played(settings(ros=ros)) as it:
        it.robot.dead |= {"/head", "/tts"}
        for verb, args in (("gaze", {"yaw": 1.0}), ("say", {"text": "Hello"})):
            with pytest.raises(DriverError, match=f"{verb}: no node of the robot listens to /"):
                await it.play(verb, **args)


async def test_a_robot_says_how_much_it_can_know_of_each_verb() -> None:
    known = {verb.name: verb.evidence for verb in Ros.verbs(settings())}
    assert known == {
        **{"say": "reported", "play": "reported", "volume": "reported", "drive": "measured"},
        **dict.fromkeys(("gaze", "nudge", "emotion", "pose", "poses"), "timed"),
    }


async def test_a_base_that_does_not_move_has_not_driven() -> None:
    async with played() as it:
        assert await it.play("drive", x=1.0)
        it.robot.dead.add("/cmd_vel")
        with pytest.raises(DriverError, match="/odom says that the base has not moved"):
            await it.play("drive", x=1.0)


async def test_a_goal_that_is_refused_is_known_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """The server of ROS 2 never says it: its action does not count the goal among its own."""
    async with played(settings(ros=2), pace=5.0) as it:
        await it.play("play", move="wave")
        it.robot.refuse_goals = True
        with monkeypatch.context() as hurried, pytest.raises(DriverError, match="accept"):
            hurried.setattr("woz_drivers.ros.rosbridge.ACCEPTED_S", 0.4)
            await it.play("play", move="wave")
        it.robot.refuse_goals = False
        await it.play("play", move="nod")


async def test_a_goal_that_is_accepted_late_is_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    async with played(settings(ros=2), pace=5.0) as it:
        await it.play("play", move="wave")
        monkeypatch.setattr("woz_drivers.ros.rosbridge.ACCEPTED_S", 0.4)
        it.robot.goal_s = FOR_EVER_S
        it.robot.accepts_goals.clear()
        with pytest.raises(DriverError, match="accept"):
            await it.play("play", move="wave")
        assert await it.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        it.robot.accepts_goals.set()
        await until(lambda: [goal.status for goal in it.robot.ended] == ["done", "canceled"])


async def test_a_cancelled_goal_whose_end_is_never_told_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_drivers.ros.rosbridge._CANCELLED_WITHIN_S", 0.5)
    async with played(settings(ros=1)) as it:
        it.robot.goal_s = FOR_EVER_S
        it.robot.tells_results = False
        task = it.begin("play", move="wave")
        await until(lambda: bool(it.robot.goals))
        task.cancel()
        await it.driver.stop(Scope.ALL)
        await it.driver.stop(Scope.ALL)
        await until(lambda: bool(it.context.notices))
        [(_, text, _)] = it.context.notices
        assert "/gesture did not say" in text
        repeated = len([1 for sent in it.sent("/gesture/cancel") if sent["id"]])
        assert await it.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        assert len([1 for sent in it.sent("/gesture/cancel") if sent["id"]]) == repeated


async def test_the_next_command_waits_until_the_last_one_was_ended() -> None:
    bow = """
  bow:
    service: /bow
    type: robot_msgs/Bow
    stop: {service: /unbow, type: robot_msgs/Bow}
"""
    text = ROBOT.replace("\njoints:", bow + "joints:") + "\n  robot_msgs/Bow_Request: {}\n"
    async with played(settings(text)) as it:
        held = it.robot.busy["/bow"] = it.robot.busy["/unbow"] = asyncio.Event()
        first = it.begin("bow")
        await until(lambda: ("call_service", "/bow") in _services(it.robot))
        first.cancel()
        await asyncio.gather(first, return_exceptions=True)
        second = it.begin("bow")
        await until(lambda: ("call_service", "/unbow") in _services(it.robot))
        await it.play("volume", level=1.0)
        assert _services(it.robot).count(("call_service", "/bow")) == 1
        held.set()
        await second
        bows = [name for _, name in _services(it.robot) if name in ("/bow", "/unbow")]
        assert bows == ["/bow", "/unbow", "/bow"]


async def test_a_step_begins_where_the_robot_looks_not_where_it_refused_to() -> None:
    asked = "publish: /head\n    type: geometry_msgs/Vector3"
    by_service = "service: /look\n    type: robot_msgs/Look"
    look = (
        "robot_msgs/Look_Request: {y: float64, z: float64}\n"
        "  robot_msgs/Look_Response: {success: bool}\n"
    )
    text = ROBOT.replace(asked, by_service).replace("types:\n", f"types:\n  {look}")
    async with played(settings(text)) as it:
        await it.play("gaze", yaw=10.0)
        it.robot.faults.refused["/look"] = "the head is busy"
        with pytest.raises(DriverError, match="busy"):
            await it.play("gaze", yaw=50.0)
        it.robot.faults.refused.clear()
        assert (await it.play("nudge", yaw=5.0))["yaw"] == 15.0


async def test_a_service_answers_and_may_say_that_it_failed() -> None:
    async with played() as it:
        sent = await it.play("volume", level=0.256)
        assert sent["message"] == {"percent": 26}
        it.robot.faults.refused["/volume"] = "no sound card"
        with pytest.raises(DriverError, match="no sound card"):
            await it.play("volume", level=1.0)


@BOTH
async def test_a_busy_service_keeps_neither_a_key_nor_the_stop_waiting(ros: int) -> None:
    """The server of ROS 2 reads nothing of a connection on which a service is busy."""
    async with played(settings(ros=ros)) as it:
        it.robot.busy["/volume"] = asyncio.Event()
        task = it.begin("volume", level=1.0)
        await until(lambda: ("call_service", "/volume") in _services(it.robot))
        await it.play("say", text="Hello")
        drive = it.begin("drive", x=5.0)
        await until(lambda: it.robot.speed[0] > 0)
        report = await it.driver.stop(Scope.ALL)
        assert report == StopReport(("driving", "play", "say"))
        for job in (task, drive):
            job.cancel()
        await asyncio.gather(task, drive, return_exceptions=True)


def _services(robot: RosbridgeSimulator) -> list[tuple[str, Any]]:
    return [(name, message.get("service")) for name, message in robot.calls]


# -- the base --------------------------------------------------------------------------------------


async def test_a_drive_is_velocities_while_it_lasts_and_zero_at_its_end() -> None:
    async with played(pace=1.0) as it:
        sent = await it.play("drive", x=1.0, turn=-90.0)
        assert sent["seconds"] == 2.0
        told = [(x, turn) for _, x, turn in it.robot.velocities]
        [_, moving, standing] = [[*group] for _, group in itertools.groupby(told)]
        assert moving[0] == (0.5, -0.7854)
        assert 2 <= len(moving) <= 21  # a busy machine may stand still for a while
        assert standing[0] == (0.0, 0.0)
        with pytest.raises(RejectedError):
            await it.play("drive")


async def test_the_simulated_base_drives_sideways_too() -> None:
    text = ROBOT.replace("drive: {topic", "drive: {sideways: true, topic")
    async with played(settings(text), pace=1.0) as it:
        await it.play("drive", y=0.5)
        forward, left, _ = it.robot._place
        assert abs(forward) < 0.01
        assert left > 0.2


async def test_a_stamped_velocity_has_its_frame() -> None:
    text = ROBOT.replace("/cmd_vel, ", "/cmd_vel, type: geometry_msgs/TwistStamped, ")
    async with played(settings(text)) as it:
        await it.play("drive", x=0.01)
        velocities = {message["twist"]["linear"]["x"] for message in it.sent("/cmd_vel")}
        assert velocities == {0.0, 0.5}  # how often each is sent depends on the machine
        assert all(sent["header"] == {"frame_id": "base_link"} for sent in it.sent("/cmd_vel"))
        assert it.robot.velocities[-1][1:] == (0.0, 0.0)


async def test_the_first_message_on_a_connection_is_a_velocity_of_zero() -> None:
    async with played() as it:
        await it.play("gaze", yaw=1.0)
        published = [m["topic"] for name, m in it.robot.calls if name == "publish"]
        assert published[:1] == ["/cmd_vel"]
        assert it.robot.velocities[0][1:] == (0.0, 0.0)


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
    async with played() as it:
        say = it.begin("say", text="x" * 500)
        drive = it.begin("drive", x=5.0)
        await until(lambda: it.robot.speed[0] > 0 and bool(it.sent("/tts")))
        assert await it.driver.stop(Scope.DRIVE) == StopReport(("driving",))
        assert it.robot.speed == (0.0, 0.0)
        drive.cancel()
        assert {"data": ""} not in it.sent("/tts")
        assert not say.done()
        say.cancel()
        await asyncio.gather(drive, say, return_exceptions=True)


async def test_a_stop_of_driving_ends_an_action_that_drives() -> None:
    text = ROBOT.replace("values: {move", "drives: true\n    values: {move")
    async with played(settings(text)) as it:
        it.robot.goal_s = FOR_EVER_S
        assert next(one for one in Ros.verbs(it.driver.settings) if one.name == "play").drives
        task = it.begin("play", move="wave")
        await until(lambda: bool(it.robot.goals))
        assert await it.driver.stop(Scope.DRIVE) == StopReport(("driving", "play"))
        assert not it.robot.goals
        await asyncio.gather(task, return_exceptions=True)


async def test_a_base_that_rolls_on_has_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_drivers.confirmed_stop.STOP_S", 0.3)
    async with played() as it:
        it.robot.interface = {**it.robot.interface, "drive": ""}  # it hears of no velocity
        it.robot._commanded = (math.inf, 0.3, 0.0)
        report = await it.driver.stop(Scope.DRIVE)
        assert report == StopReport(missing=("driving",))


async def test_a_drive_publishes_nothing_behind_a_stop() -> None:
    """Also when the cancellation of its command comes late."""
    async with played() as it:
        task = it.begin("drive", x=5.0)
        await until(lambda: it.robot.speed[0] > 0)
        await it.driver.stop(Scope.ALL)
        with pytest.raises(DriverError, match="stopped"):
            await task
        assert it.robot.velocities[-1][1:] == (0.0, 0.0)


async def test_a_drive_that_is_cancelled_ends_with_zero() -> None:
    async with played() as it:
        task = it.begin("drive", x=5.0)
        await until(lambda: it.robot.speed[0] > 0)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await until(lambda: it.robot.velocities[-1][1:] == (0.0, 0.0))


# -- stopping --------------------------------------------------------------------------------------


@BOTH
async def test_a_stop_ends_all_of_it(ros: int) -> None:
    async with played(settings(ros=ros)) as it:
        it.robot.goal_s = FOR_EVER_S
        jobs = [
            it.begin("drive", x=5.0),
            it.begin("say", text="x" * 500),
            it.begin("play", move="wave"),
        ]
        await until(
            lambda: it.robot.speed[0] > 0 and bool(it.robot.goals) and bool(it.sent("/tts"))
        )
        report = await it.driver.stop(Scope.ALL)
        assert report == StopReport(("driving", "play", "say"))
        assert it.robot.speed == (0.0, 0.0)
        assert not it.robot.goals
        assert it.sent("/tts")[-1] == {"data": ""}
        for job in jobs:
            job.cancel()
        await asyncio.gather(*jobs, return_exceptions=True)
        await it.play("say", text="Hi")


@BOTH
async def test_a_stop_reaches_a_goal_that_somebody_else_sent(ros: int) -> None:
    async with played(settings(ros=ros)) as it:
        it.robot.goal_s = FOR_EVER_S
        other = it.robot.run(it.robot.pursue(_goal()))
        await until(lambda: bool(it.robot.goals))
        await it.driver.stop(Scope.ALL)
        assert await other == "canceled"


def _goal() -> Any:
    return SimulatedGoal("theirs", "/gesture", "")


async def test_what_cannot_be_stopped_is_named() -> None:
    text = ROBOT + "\n  robot_msgs/Bow_Request: {}\n"
    text = text.replace("\njoints:", "\n  bow: {service: /bow, type: robot_msgs/Bow}\njoints:")
    async with played(settings(text)) as it:
        assert await it.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        it.robot.busy["/bow"] = asyncio.Event()
        task = it.begin("bow")
        await until(lambda: ("call_service", "/bow") in _services(it.robot))
        report = await it.driver.stop(Scope.ALL)
        assert report == StopReport(("driving", "play", "say"), ("bow",))
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_a_voice_that_goes_on_has_not_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    async with played() as it:
        task = it.begin("say", text="x" * 500)
        await until(lambda: bool(it.sent("/tts")))
        it.robot.interface["speech"].clear()  # it ignores the empty text
        monkeypatch.setattr("woz_drivers.confirmed_stop.STOP_S", 0.5)
        report = await it.driver.stop(Scope.ALL)
        assert report is not None and "say" in report.missing
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_what_was_not_heard_to_begin_is_not_taken_for_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_drivers.confirmed_stop.STOP_S", 0.5)
    async with played() as it:
        it.robot.interface["speech"].clear()  # it begins late
        task = it.begin("say", text="Hello")
        await until(lambda: bool(it.sent("/tts")))
        report = await it.driver.stop(Scope.ALL)
        assert report is not None and "say" in report.missing
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


# -- loss and return -------------------------------------------------------------------------------


async def test_what_was_going_on_ends_first_when_the_robot_is_back() -> None:
    async with played() as it:
        it.robot.goal_s = FOR_EVER_S
        jobs = [it.begin("say", text="x" * 500), it.begin("play", move="wave")]
        await until(lambda: bool(it.sent("/tts")) and bool(it.robot.goals))
        it.robot.drop()
        for job in jobs:
            with pytest.raises(DeviceLostError):
                await job
        await until(
            lambda: [state for state, *_ in it.context.healths].count(Health.CONNECTED) == 2
        )
        assert it.sent("/tts")[-1] == {"data": ""}
        assert not it.robot.goals
        await it.play("say", text="Again")
        await until(lambda: it.context.of("distance")[-1].value is not None)


async def test_a_stop_while_it_is_gone_names_what_may_go_on() -> None:
    async with played() as it:
        task = it.begin("say", text="x" * 500)
        await until(lambda: bool(it.sent("/tts")))
        it.robot.faults.refused["/"] = "gone"
        it.robot.drop()
        await it.healthy(Health.LOST)
        await asyncio.gather(task, return_exceptions=True)
        assert await it.driver.stop(Scope.ALL) == StopReport(missing=("driving", "say"))
        with pytest.raises(DeviceLostError):
            await it.play("gaze", yaw=1.0)


async def test_what_it_said_before_a_loss_does_not_count() -> None:
    async with played() as it:
        it.robot.interface["speech"].clear()  # whoever made it speak, its end is not heard
        it.robot.publish("/tts/speaking", {"data": True})
        await it.driver.stop(Scope.DRIVE)
        it.robot.drop()
        await it.healthy(Health.LOST)
        await it.healthy()
        assert await it.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))


async def test_a_call_that_waits_for_its_connection_is_not_sent_after_a_loss() -> None:
    async with played() as it:
        # The robot was compared with its file: one connection is kept for calls, and the first
        # call takes it.
        await until(lambda: ("call_service", "/rosapi/action_servers") in _services(it.robot))
        await it.play("volume", level=0.0)
        it.robot.busy["/volume"] = asyncio.Event()
        first = it.begin("volume", level=0.1)
        await until(lambda: _percents(it.robot) == [0, 10])
        it.robot.freeze()
        second = it.begin("volume", level=1.0)
        await it.healthy(Health.LOST)
        for job in (first, second):
            with pytest.raises(DeviceLostError):
                async with asyncio.timeout(20):
                    await job
        it.robot.busy.clear()
        it.robot.thaw()
        await it.healthy()
        await it.play("volume", level=0.2)
        assert _percents(it.robot) == [0, 10, 20]


def _percents(robot: RosbridgeSimulator) -> list[int]:
    """The volumes that it was asked for."""
    return [it["args"]["percent"] for _, it in robot.calls if it.get("service") == "/volume"]


async def test_a_server_that_takes_no_further_connection_is_not_lost() -> None:
    async with played(query="?token=secret") as it:
        it.robot.busy["/volume"] = asyncio.Event()
        it.robot.faults.refused["/"] = "too many"
        # One connection is kept in reserve, and another may be on its way: the third call has none.
        calls = [it.begin("volume", level=0.1) for _ in range(3)]
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
        await it.play("gaze", yaw=1.0)


async def test_a_password_in_the_address_is_not_shown() -> None:
    async with played(query="?token=secret") as it:
        it.robot.drop()
        await it.healthy(Health.LOST)
        await it.healthy()
        findings = await doctor.examine(Probe("robot", it.driver.settings))
        assert "secret" not in repr((it.context.healths, it.context.notices, findings))


async def test_a_rosapi_that_hangs_keeps_no_stop_waiting() -> None:
    """With ROS 2 a connection waits for each service that is called on it."""
    async with played() as it:
        for service in ("get_time", "topics", "topics_and_raw_types", "services"):
            it.robot.busy[f"/rosapi/{service}"] = asyncio.Event()
        assert await it.driver.stop(Scope.ALL) == StopReport(("driving", "play", "say"))
        await it.play("drive", x=0.05)


async def test_a_frozen_robot_gets_no_more_velocities_and_a_zero_behind_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(velocity_drive, "_SILENT_S", 0.4)
    async with played(pace=1.0) as it:
        task = it.begin("drive", x=20.0)
        await until(lambda: len(it.robot.velocities) > 2)
        it.robot.freeze()
        before = len(it.robot.velocities)
        with pytest.raises(DriverError, match="answer"):
            await task
        it.robot.thaw()
        await until(lambda: it.robot.velocities[-1][1:] == (0.0, 0.0))
        late = [x for _, x, _ in it.robot.velocities[before:] if x > 0]
        assert len(late) <= 2


async def test_a_slow_sensor_is_slow_beside_a_fast_one_on_the_same_topic() -> None:
    slow = "  slow: {subscribe: /sonar, type: sensor_msgs/Range, value: range, throttle: 60 s}\n"
    both = settings(ROBOT.replace("sensors:\n", f"sensors:\n{slow}"))
    async with played(both) as it:
        await until(lambda: len(it.context.of("distance")) > 5)
        assert len(it.context.of("slow")) == 1


async def test_sensors_that_fall_silent_are_stale(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_S", 0.2)
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_READINGS", 0)
    async with played() as it:
        await until(lambda: bool(it.context.of("distance")) and bool(it.context.of("ahead")))
        assert it.context.latest("distance") == it.context.latest("ahead") == 4.5
        it.robot.interface["sensors"].pop("distance")
        await until(lambda: ("distance", "stale", "/sonar is silent") in it.context.states)

        def now() -> dict[str, str]:
            return {sensor: state for sensor, state, _ in it.context.states}

        # On a busy machine it may have been silent for a moment, too.
        await until(lambda: (now()["distance"], now()["ahead"]) == ("stale", "ok"))


async def test_a_topic_that_says_little_by_nature_is_not_stale_meanwhile(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_S", 0.2)
    monkeypatch.setattr("woz_drivers.ros.driver._STALE_READINGS", 5)
    rare = settings(ROBOT.replace("/sonar,", "/sonar, every: 3600 s,"))
    async with played(rare) as it:
        await until(lambda: bool(it.context.of("distance")) and bool(it.context.of("ahead")))
        for name in ("distance", "ahead"):
            it.robot.interface["sensors"].pop(name)
        await until(lambda: any(state[:2] == ("ahead", "stale") for state in it.context.states))
        assert not any(state[:2] == ("distance", "stale") for state in it.context.states)
        assert it.context.periods["distance"] == 3600.0


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
    async with played() as it:
        for client in tuple(it.robot._clients):
            client._outgoing.put_nowait(nonsense)
        await it.play("say", text="Hello")
        assert it.context.healths[-1][0] is Health.CONNECTED
        await it.play("drive", x=0.01)


async def test_an_error_that_the_server_tells_is_shown() -> None:
    async with played() as it:
        for client in tuple(it.robot._clients):
            for words in (*("no topic",) * 3, "no type"):
                status = {"op": "status", "level": "error", "msg": words}
                client._outgoing.put_nowait(json.dumps(status))
        await until(lambda: any("no type" in text for _, text, _ in it.context.notices))
        assert len([1 for _, text, _ in it.context.notices if "no topic" in text]) == 1


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
        it = RecordingContext(Path())
        driver = Ros("robot", replace(of, address=robot.address), it)
        await driver.open()
        await until(lambda: bool(it.notices))
        assert any("/tts is std_msgs/Int32" in text for _, text, _ in it.notices)
        assert any("no topic /face" in text for _, text, _ in it.notices)
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
    assert not [found for found in findings if found.level in ("error", "warning")]
    listed = {found.subject: found.text for found in findings}
    assert "/cmd_vel (geometry_msgs/Twist)" in listed["topics"]
    assert "/volume (robot_msgs/Volume)" in listed["services"]
    assert "/gesture" in listed["actions"]
    drafted = settings("\n".join(line[4:] for line in text.splitlines()[5:]))
    assert drafted.ros == ros
    assert drafted.drive is not None
    assert drafted.drive.topic == "/cmd_vel"
    assert drafted.verbs["say"].publish == "/tts"


async def test_a_draft_without_a_voice_can_be_read() -> None:
    of = settings(ROBOT.replace("/tts", "/x"))
    async with simulator(of) as robot:
        text = await doctor.draft(replace(of, address=robot.address))
    assert settings("\n".join(line[4:] for line in text.splitlines()[5:])).verbs == {}


async def test_the_doctor_warns_of_a_server_without_a_password() -> None:
    of = replace(settings(), address="robot.invalid")
    assert [found.level for found in doctor._protected(of)] == ["warning"]
    for safe in ("wss://robot/ros", "127.0.0.1:9090", "simulated"):
        assert not [*doctor._protected(replace(of, address=safe))]


async def test_the_doctor_says_what_is_wrong_with_an_address() -> None:
    [found] = await doctor.examine(Probe("robot", replace(settings(), address="127.0.0.1:9")))
    assert found.level == "error"


async def test_a_file_for_the_other_ros_is_told_so() -> None:
    of = settings(ros=1)
    async with simulator(of) as robot:
        there = replace(of, ros=2, address=robot.address)
        findings = await doctor.examine(Probe("robot", there))
    assert "write ros: 1" in [found.remedy for found in findings]


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
    monkeypatch.setattr("woz_drivers.simulated_process._HOPELESS_S", -1.0)
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
    async with played() as it:
        foretold = {
            verb: (await it.driver.predict(verb, args)).seconds for verb, args in commands.items()
        }
        known = {"drive": 2.0, "emotion": pytest.approx(0.25), "poses": 3.0}
        assert foretold == {**known, "say": None, "play": None}
        with pytest.raises(RejectedError):
            await it.driver.predict("drive", {"x": 0.0})
