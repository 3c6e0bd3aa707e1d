"""Settings of a robot with every kind of declaration, and the simulated robot that has it."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from naoqi_simulator.robot_time import PacedTime
from robot_simulators.rosbridge import RosbridgeSimulator
from woz_drivers.ros import simulated_interface
from woz_drivers.ros.driver import Ros
from woz_drivers.ros.settings import RosSettings

from woz_tui.config.annotated_decoder import read_settings
from woz_tui.config.file_text import read_source
from woz_tui.config.problems import ProblemReport
from woz_tui.config.yaml_cursor import document
from woz_tui.drivers.contract import Health
from woz_tui.protocol.messages import Json
from woz_tui.testing import PlainJob, RecordingContext, until

ROBOT = """
drive: {topic: /cmd_vel, speed: 0.5, turn_speed: 90, odometry: /odom}
verbs:
  say:
    publish: /tts
    type: std_msgs/String
    message: {data: "{text}"}
    ends: {subscribe: /tts/speaking, begun: true, ended: false}
    stop: {publish: /tts, type: std_msgs/String, message: {data: ""}}
  gaze:
    publish: /head
    type: geometry_msgs/Vector3
    message: {z: "{yaw:rad}", y: "{-pitch:rad}"}
    arguments: {yaw: {low: -60, high: 60}, pitch: {low: -20, high: 30}}
  play:
    action: /gesture
    type: robot_msgs/Gesture
    message: {name: "{move}"}
    values: {move: {wave: hello_2, nod: yes_1}}
  volume:
    service: /volume
    type: robot_msgs/Volume
    message: {percent: "{level*100:whole}"}
  emotion:
    publish: /face
    type: std_msgs/String
    message: {data: "{emotion}"}
    ends: {seconds: 0.2, per_character: 10 ms}
  pose:
    publish: /joints
    type: trajectory_msgs/JointTrajectory
    message:
      joint_names: "{joints:names}"
      points: [{positions: "{joints:rad}", time_from_start: "{seconds:duration}"}]
joints: {pan: [-90, 90], tilt: [-20, 40]}
sensors:
  distance: {subscribe: /sonar, type: sensor_msgs/Range, value: range, unit: m}
  ahead: {subscribe: /scan, type: sensor_msgs/LaserScan, value: "min(ranges[-9deg:9deg])"}
  pan: {subscribe: /joint_states, type: sensor_msgs/JointState, value: "position[name=pan]"}
types:
  robot_msgs/Gesture_Goal: {name: string}
  robot_msgs/Gesture_Result: {success: bool}
  robot_msgs/Volume_Request: {percent: uint8}
  robot_msgs/Volume_Response: {success: bool, message: string}
"""


def read_robot_settings(text: str) -> tuple[RosSettings | None, dict[str, str]]:
    """Settings of a robot file, and what is wrong with it: sentences by path."""
    report = ProblemReport()
    cursor = document(
        read_source(Path("robot.yaml"), "robot.yaml", text.encode()), report, "settings"
    )
    assert cursor is not None
    made = read_settings(cursor, RosSettings)
    wrong = {problem.path: problem.message for problem in report.errors}
    return (made if isinstance(made, RosSettings) else None), wrong


def settings(text: str = ROBOT, **changed: Any) -> RosSettings:
    """Settings that are right."""
    made, wrong = read_robot_settings(text)
    assert made is not None, wrong
    return replace(made, **changed)


def simulator(of: RosSettings, pace: float = 10.0) -> RosbridgeSimulator:
    """A robot that has what these settings name."""
    options = simulated_interface.options(of)
    interface: Mapping[str, Any] = json.loads(options[options.index("--interface") + 1])
    return RosbridgeSimulator(of.ros, interface, PacedTime(pace))


@dataclass
class RosRig:
    """A driver with its robot."""

    robot: RosbridgeSimulator
    driver: Ros
    context: RecordingContext

    def begin(self, verb: str, **args: Json) -> asyncio.Task[Mapping[str, Json]]:
        """A command that is under way."""
        defaults = {
            one.name: one.default
            for offered in Ros.offer(self.driver.settings).verbs
            if offered.name == verb
            for one in offered.arguments
        }
        return asyncio.ensure_future(self.driver.perform(PlainJob(verb, {**defaults, **args})))

    async def play(self, verb: str, **args: Json) -> Mapping[str, Json]:
        """A command, to its end."""
        async with asyncio.timeout(20):
            return await self.begin(verb, **args)

    def published_on(self, topic: str) -> list[Any]:
        """Messages that were published on a topic."""
        return [
            message.get("msg")
            for operation, message in self.robot.calls
            if operation == "publish" and message["topic"] == topic
        ]

    async def healthy(self, wanted: Health = Health.CONNECTED) -> None:
        """Until the driver's health is this."""
        await until(lambda: bool(self.context.healths) and self.context.healths[-1][0] is wanted)


@contextlib.asynccontextmanager
async def connected_ros(
    of: RosSettings | None = None, pace: float = 10.0, query: str = ""
) -> AsyncIterator[RosRig]:
    """A driver that is connected to a simulated robot; `query`: what its address ends with."""
    wanted = of or settings()
    async with simulator(wanted, pace) as robot:
        context = RecordingContext(Path())
        address = f"{robot.address}/{query}"
        driver = Ros("robot", replace(wanted, address=address), context)
        rig = RosRig(robot, driver, context)
        await driver.open()
        try:
            await rig.healthy()
            yield rig
        finally:
            robot.thaw()
            await driver.close()
