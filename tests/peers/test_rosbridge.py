"""The driver `ros` and the simulated rosbridge, held against both real servers.

ROS 1 and ROS 2 run with a node that plays a robot (`ros1_node.py`, `ros2_node.py`); what that node
gets is what a robot would have got.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import signal
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import aiohttp
import pytest
import pytest_asyncio
from robot_simulators.rosbridge import RosbridgeSimulator
from woz_drivers.ros import doctor
from woz_drivers.ros.driver import Ros

from tests.drivers.ros.robots import settings
from tests.peers.rosbridge_servers import RealRobot, real_robot
from woz_tui.drivers.contract import DriverError, Health, Probe, Scope, StopReport
from woz_tui.testing import PlainJob, RecordingContext, until

ACTIONS = {1: ("actionlib/Test", "goal"), 2: ("test_msgs/Fibonacci", "order")}
ROBOT = """
ros: {ros}
address: {address}
drive: {{topic: /cmd_vel, speed: 0.5, turn_speed: 90, odometry: /odom}}
verbs:
  say:
    publish: /tts
    type: std_msgs/String
    message: {{data: "{{text}}"}}
    ends: {{subscribe: /tts/speaking, begun: true, ended: false}}
    stop: {{publish: /tts, type: std_msgs/String, message: {{data: ""}}}}
  count:
    action: /count
    type: {action}
    message: {{{field}: "{{steps}}"}}
    arguments: {{steps: {{kind: whole}}}}
  loud:
    service: /volume
    type: std_srvs/SetBool
    message: {{data: "{{on}}"}}
    arguments: {{on: {{kind: flag}}}}
  slow: {{service: /slow, type: std_srvs/Trigger}}
sensors:
  distance: {{subscribe: /sonar, type: sensor_msgs/Range, value: range, unit: m}}
"""

pytestmark = pytest.mark.timeout(180)


class Session:
    """A driver in a session, connected to a real robot."""

    def __init__(self, robot: RealRobot, text: str) -> None:
        self.robot = robot
        self.context = RecordingContext(Path())
        action, field = ACTIONS[robot.ros]
        of = {"ros": robot.ros, "address": robot.address, "action": action, "field": field}
        self.settings = settings(text.format(**of))
        self.driver = Ros("robot", self.settings, self.context)

    def begin(self, verb: str, **args: Any) -> asyncio.Task[Any]:
        """A command that is under way."""
        return asyncio.ensure_future(self.driver.perform(PlainJob(verb, args)))

    async def healthy(self, wanted: Health) -> None:
        """Until the driver's health is this."""
        healths = self.context.healths
        await until(lambda: bool(healths) and healths[-1][0] is wanted, 30)


@contextlib.asynccontextmanager
async def session(robot: RealRobot, text: str = ROBOT) -> AsyncIterator[Session]:
    robot_session = Session(robot, text)
    await robot_session.driver.open()
    try:
        await robot_session.healthy(Health.CONNECTED)
        yield robot_session
    finally:
        await robot_session.driver.close()


@pytest_asyncio.fixture(params=[1, 2], ids=["ros1", "ros2"])
async def robot(request: pytest.FixtureRequest) -> AsyncIterator[RealRobot]:
    async with real_robot(request.param) as real:
        yield real


async def test_it_plays_all_that_a_file_declares(robot: RealRobot) -> None:
    async with session(robot) as robot_session:
        await robot_session.begin("say", text="Hello there")
        assert [line["text"] for line in robot.of("say")] == ["Hello there"]
        assert (await robot_session.begin("loud", on=True))["result"]["success"] is True
        with pytest.raises(DriverError, match="as you say"):
            await robot_session.begin("loud", on=False)
        await robot_session.begin("count", steps=4)
        assert robot.of("reached")
        await robot_session.begin("drive", x=0.25, turn=0.0)
        await until(lambda: len(robot.of("velocity")) > 5)
        speeds = [line["x"] for line in robot.of("velocity")]
        assert speeds[0] == 0.0, "what went on before ends when it connects"
        assert speeds[-1] == 0.0
        assert 4 <= speeds.count(0.5) <= 7, "ten times a second for half a second"
        await until(lambda: bool(robot_session.context.of("distance")))
        assert robot_session.context.latest("distance") == 1.25
        assert robot_session.context.notices == []


async def test_a_stop_ends_everything_and_says_what_it_could_not_end(robot: RealRobot) -> None:
    async with session(robot) as robot_session:
        jobs = [
            robot_session.begin("drive", x=5.0, turn=0.0),
            robot_session.begin("say", text="x" * 400),
            robot_session.begin("count", steps=400),
            robot_session.begin("slow"),
        ]
        await until(lambda: {"velocity", "say", "goal", "slow"} <= {t["what"] for t in robot.told})
        await until(lambda: any(line["x"] > 0 for line in robot.of("velocity")))
        before = len(robot.of("velocity"))
        report = await robot_session.driver.stop(Scope.ALL)
        for job in jobs:
            job.cancel()
        await asyncio.gather(*jobs, return_exceptions=True)
        assert report == StopReport(("count", "driving", "say"), ("slow",))
        await until(lambda: bool(robot.of("cancelled")))
        assert not robot.of("reached")
        assert robot.of("velocity")[-1]["x"] == 0.0
        assert robot.of("say")[-1]["text"] == ""
        await asyncio.sleep(0.3)  # nothing comes behind the stop
        speeds = [line["x"] for line in robot.of("velocity")[before:]]
        behind = [*itertools.dropwhile(lambda speed: speed != 0.0, speeds)]
        assert set(behind) == {0.0}


async def test_a_goal_that_was_just_sent_is_ended_by_a_stop(robot: RealRobot) -> None:
    async with session(robot) as robot_session:
        for _ in range(3):
            job = robot_session.begin("count", steps=400)
            await asyncio.sleep(0)
            report = await robot_session.driver.stop(Scope.ALL)
            job.cancel()
            await asyncio.gather(job, return_exceptions=True)
            assert report is not None
            if "count" in report.confirmed:
                sent, ended = len(robot.of("goal")), len(robot.of("cancelled"))
                await until(lambda: len(robot.of("cancelled")) >= len(robot.of("goal")))
                assert (sent, ended) <= (len(robot.of("goal")), len(robot.of("cancelled")))
        assert not robot.of("reached")


async def test_a_goal_that_an_action_of_ros_2_refuses_is_known_soon() -> None:
    async with real_robot(2) as robot, session(robot) as robot_session:
        await robot_session.begin("count", steps=60)
        with pytest.raises(DriverError, match="accept"):
            await robot_session.begin("count", steps=2000)
        await robot_session.begin("count", steps=2)


async def test_what_does_not_fit_the_robot_is_told_before_it_is_used(robot: RealRobot) -> None:
    text = ROBOT.replace("/cmd_vel, speed", "/cmd_vel, type: geometry_msgs/TwistStamped, speed")
    text = text.replace("type: std_srvs/SetBool", "type: std_srvs/Trigger")
    text = text.replace('message: {{data: "{{on}}"}}', "message: {{}}")
    async with session(robot, text) as robot_session:
        await until(lambda: len(robot_session.context.notices) >= 2, 30)
        told = " ".join(f"{what} {remedy}" for _, what, remedy in robot_session.context.notices)
        assert "drive.topic" in told
        assert "verbs.loud.service" in told
        with pytest.raises(DriverError, match="geometry_msgs/Twist on the robot"):
            await robot_session.begin("drive", x=0.2, turn=0.0)
    findings = await doctor.examine(Probe("robot", robot_session.settings))
    errors = {each.subject: each.remedy for each in findings if each.level == "error"}
    assert errors == {
        "drive.topic": "write type: geometry_msgs/Twist",
        "verbs.loud.service": "write type: std_srvs/SetBool",
    }


async def test_a_draft_of_the_robot_file_can_be_read(robot: RealRobot) -> None:
    async with session(robot) as robot_session:
        text = await doctor.draft(robot_session.settings)
    inner = "\n".join(line.removeprefix("    ") for line in text.splitlines()[4:])
    drafted = settings(inner.replace("type: ros\n", ""))
    assert drafted.drive is not None
    assert (drafted.drive.topic, drafted.drive.odometry) == ("/cmd_vel", "/odom")
    assert drafted.verbs["say"].publish == "/tts"
    assert "# /count" in text


async def test_a_server_that_ends_is_lost_and_found_again(robot: RealRobot) -> None:
    async with session(robot) as robot_session:
        job = robot_session.begin("drive", x=5.0, turn=0.0)
        await until(lambda: any(line["x"] > 0 for line in robot.of("velocity")))
        await robot.end("rosbridge")
        with pytest.raises(DriverError):
            await job
        await robot_session.healthy(Health.LOST)
        await robot.start_rosbridge()
        await robot_session.healthy(Health.CONNECTED)
        await until(lambda: robot.of("velocity")[-1]["x"] == 0.0, 30)
        await robot_session.begin("count", steps=2)
        assert robot.of("reached")


async def test_a_server_that_froze_in_a_drive_ends_it_when_it_wakes(robot: RealRobot) -> None:
    async with session(robot) as robot_session:
        job = robot_session.begin("drive", x=5.0, turn=0.0)
        await until(lambda: any(line["x"] > 0 for line in robot.of("velocity")))
        robot.send_signal("rosbridge", signal.SIGSTOP)
        with pytest.raises(DriverError):
            await job
        await robot_session.healthy(Health.LOST)
        late = len(robot.of("velocity"))
        robot.send_signal("rosbridge", signal.SIGCONT)
        await robot_session.healthy(Health.CONNECTED)
        await until(lambda: robot.of("velocity")[-1]["x"] == 0.0, 30)
        moving = [line for line in robot.of("velocity")[late:] if line["x"] != 0.0]
        assert len(moving) <= 2, "at most what was sent before it was known to be silent"


# -- what a client must know of the servers: the simulated one is no better ------------------------


@contextlib.asynccontextmanager
async def servers(ros: int, simulated: bool) -> AsyncIterator[str]:
    """The address of a real or a simulated server."""
    if simulated:
        async with RosbridgeSimulator(ros) as robot:
            robot.busy["/slow"] = asyncio.Event()
            yield robot.address
    else:
        async with real_robot(ros) as real:
            yield real.address


async def answers(
    opened: aiohttp.ClientWebSocketResponse[bool],
    *messages: dict[str, Any],
    most: int = 99,
    within: float = 1.0,
) -> list[dict[str, Any]]:
    """What comes after these operations, as soon as that is the most there can be."""
    for message in messages:
        await opened.send_str(json.dumps(message))
    found: list[dict[str, Any]] = []
    end = time.monotonic() + within
    while len(found) < most and (left := end - time.monotonic()) > 0:
        try:
            found.append(json.loads(await opened.receive_str(timeout=left)))
        except (TimeoutError, TypeError):
            break
    return found


@pytest.mark.parametrize("simulated", [False, True], ids=["real", "simulated"])
@pytest.mark.parametrize("ros", [1, 2], ids=["ros1", "ros2"])
async def test_the_simulated_server_is_no_better_than_the_real_one(
    ros: int, simulated: bool
) -> None:
    name = "std_msgs/String" if ros == 1 else "std_msgs/msg/String"
    advertise = {"op": "advertise", "topic": "/tts", "type": name}
    right = {"op": "publish", "topic": "/tts", "msg": {"data": "a"}}
    wrong = {"op": "publish", "topic": "/tts", "msg": {"text": "a"}}
    subscribe = {"op": "subscribe", "topic": "/tts", "type": name}
    unknown = {"op": "call_service", "id": "u", "service": "/nothing"}
    slow = {"op": "call_service", "id": "s", "service": "/slow"}
    async with servers(ros, simulated) as address, aiohttp.ClientSession() as client:
        opened = await client.ws_connect(f"ws://{address}")
        known = 0.2 if simulated else 2.0  # nodes of ROS have to find each other
        assert await answers(opened, advertise, subscribe, within=known) == []
        assert await answers(opened, wrong, {"op": "nonsense"}) == [], "nobody hears of it"
        [echo] = await answers(opened, right, most=1, within=20.0)
        assert (echo["op"], echo["topic"], echo["msg"]) == ("publish", "/tts", {"data": "a"})
        [failed] = await answers(opened, unknown, most=1, within=20.0)
        assert (failed["op"], failed["id"], failed["result"]) == ("service_response", "u", False)
        assert "does not exist" in failed["values"]
        if ros == 1:
            assert await answers(opened, slow, right, most=1, within=20.0)
        else:
            came = await answers(opened, slow, right, within=0.7)
            assert came == [], "ROS 2 reads nothing while a service is busy"
        await opened.close()
