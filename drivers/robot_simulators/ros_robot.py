"""A simulated robot behind ROS: a base that moves, sensors, a voice, actions that take their time.

What it offers is an `interface`: topics, services and actions with their types.
"""

from __future__ import annotations

import abc
import asyncio
import math
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass, field
from typing import Any

from naoqi_simulator.robot_time import SimulatorTime
from naoqi_simulator.visitor import SimulatedPerson, SimulatedVisitors

from robot_simulators.ros_messages import Message, SimulatedTypes, plain
from robot_simulators.web_robot import WebRobot

_VECTOR = {"x": "float64", "y": "float64", "z": "float64"}
#: A small mobile robot that speaks.
MOBILE_ROBOT: Mapping[str, Any] = {
    "types": {
        "std_msgs/String": {"data": "string"},
        "std_msgs/Bool": {"data": "bool"},
        "std_msgs/Header": {"stamp": "time", "frame_id": "string"},
        "geometry_msgs/Vector3": _VECTOR,
        "geometry_msgs/Point": _VECTOR,
        "geometry_msgs/Quaternion": {**_VECTOR, "w": "float64"},
        "geometry_msgs/Twist": {
            "linear": "geometry_msgs/Vector3",
            "angular": "geometry_msgs/Vector3",
        },
        "geometry_msgs/Pose": {
            "position": "geometry_msgs/Point",
            "orientation": "geometry_msgs/Quaternion",
        },
        "geometry_msgs/PoseWithCovariance": {
            "pose": "geometry_msgs/Pose",
            "covariance": "float64[36]",
        },
        "geometry_msgs/TwistWithCovariance": {
            "twist": "geometry_msgs/Twist",
            "covariance": "float64[36]",
        },
        "nav_msgs/Odometry": {
            "header": "std_msgs/Header",
            "child_frame_id": "string",
            "pose": "geometry_msgs/PoseWithCovariance",
            "twist": "geometry_msgs/TwistWithCovariance",
        },
        "sensor_msgs/Range": {
            "header": "std_msgs/Header",
            "radiation_type": "uint8",
            "field_of_view": "float32",
            "min_range": "float32",
            "max_range": "float32",
            "range": "float32",
        },
        "sensor_msgs/LaserScan": {
            "header": "std_msgs/Header",
            **dict.fromkeys(("angle_min", "angle_max", "angle_increment"), "float32"),
            **dict.fromkeys(("time_increment", "scan_time"), "float32"),
            **dict.fromkeys(("range_min", "range_max"), "float32"),
            "ranges": "float32[]",
            "intensities": "float32[]",
        },
        "robot_msgs/Gesture_Goal": {"name": "string"},
        "robot_msgs/Gesture_Result": {"success": "bool"},
    },
    "topics": {
        "/cmd_vel": "geometry_msgs/Twist",
        "/odom": "nav_msgs/Odometry",
        "/tts": "std_msgs/String",
        "/tts/speaking": "std_msgs/Bool",
    },
    "services": {},
    "actions": {"/gesture": "robot_msgs/Gesture"},
    "drive": "/cmd_vel",
    "odometry": "/odom",
    "sensors": {
        "distance": {"topic": "/sonar", "type": "sensor_msgs/Range"},
        "scan": {"topic": "/scan", "type": "sensor_msgs/LaserScan"},
    },
    "speech": [{"topic": "/tts", "says": "/tts/speaking", "begun": True, "ended": False}],
}

#: The base stands when no velocity came for so long, as those of real robots do, in seconds.
WATCHDOG_S = 0.6
#: From one reading of a sensor, and one odometry, to the next, in seconds.
_TICK_S = 0.05
#: Seconds for each character that is spoken, and for a gesture or any other goal.
PER_CHARACTER_S, GOAL_S = 0.06, 2.0
#: What a range sensor sees when nobody is there, in metres.
_FAR_M = 4.5
#: States of a goal: `actionlib_msgs/GoalStatus` and `action_msgs/GoalStatus`.
STATUS = {1: {"active": 1, "done": 3, "canceled": 2, "aborted": 4, "refused": 5}}
STATUS[2] = {"active": 2, "done": 4, "canceled": 5, "aborted": 6, "refused": 0}


@dataclass(eq=False)
class SimulatedGoal:
    """Something that an action does."""

    ident: str
    action: str
    text: str
    cancelled: asyncio.Event = field(default_factory=asyncio.Event)
    accepted: bool = False
    status: str = "active"


class SimulatedRosRobot(WebRobot):
    """The robot, without the server that carries its messages.

    Attributes:
        velocities: The velocities that the base was given: seconds, metres and radians a second.
        speed: What the base does now: metres and radians a second.
        refuse_goals: Goals are not accepted.
        accepts_goals: While it is not set, goals wait to be accepted (ROS 2).
        tells_results: Whether it says how goals ended (ROS 1).
        goal_s: How long a goal takes, in its seconds.
        dead: Topics and actions whose node has ended; of the drive's topic the base does not move.
        ended: The goals that have ended, the oldest first.
    """

    def __init__(
        self,
        ros: int = 2,
        interface: Mapping[str, Any] = MOBILE_ROBOT,
        time: SimulatorTime | None = None,
        visitors: SimulatedVisitors | None = None,
    ) -> None:
        super().__init__(time, visitors)
        self.ros = ros
        self.velocities: list[tuple[float, float, float]] = []
        self.speed = (0.0, 0.0)
        self.refuse_goals = False
        self.accepts_goals = asyncio.Event()
        self.accepts_goals.set()
        self.tells_results = True
        self.interface = interface
        self.dead: set[str] = set()
        self.goal_s = GOAL_S
        self.goals: dict[str, SimulatedGoal] = {}
        self.ended: list[SimulatedGoal] = []
        self.accepted: dict[str, list[str]] = {}
        self.types = SimulatedTypes(interface["types"], ros)
        self.topics: dict[str, str] = {
            **interface["topics"],
            **{each["topic"]: each["type"] for each in interface["sensors"].values()},
        }
        self._running: set[asyncio.Task[Any]] = set()
        self._speech: asyncio.Task[Any] | None = None
        self._commanded = (float("-inf"), 0.0, 0.0)
        self._sideways = self._left = 0.0  # asked for, driven: metres a second to the left
        self._place = [0.0, 0.0, 0.0]

    @abc.abstractmethod
    def publish(self, topic: str, message: Message) -> None:
        """To everybody who has subscribed."""

    @abc.abstractmethod
    def listened_to(self, topic: str) -> bool:
        """Whether anybody has."""

    async def close(self) -> None:
        """End what is going on, and hang up."""
        for task in tuple(self._running):
            task.cancel()
        await asyncio.gather(*self._running, return_exceptions=True)
        await super().close()

    def run(self, work: Coroutine[Any, Any, Any]) -> asyncio.Task[Any]:
        """Do something beside."""
        task = asyncio.ensure_future(work)
        self._running.add(task)
        task.add_done_callback(self._running.discard)
        return task

    async def sleep(self, seconds: float) -> None:
        """Pause for seconds of the robot; longer while it is frozen."""
        await self.time.sleep(seconds)
        await self.awake()

    async def awake(self) -> None:
        """Return when it is not frozen."""
        await self._awake.wait()

    # -- the base, the visitor, the voice --------------------------------------------------------

    async def live(self) -> None:
        """Move and sense."""
        before = self.time.now()
        while True:
            await self.sleep(_TICK_S)
            now = self.time.now()
            self._move(now - before)
            before = now
            self._sense(self.visitors.at(now) if self.visitors is not None else None)

    def _move(self, seconds: float) -> None:
        at, forward, turn = self._commanded
        moves = self.time.now() - at < WATCHDOG_S
        self.speed = (forward, turn) if moves else (0.0, 0.0)
        self._left = left = self._sideways if moves else 0.0
        ahead, across = math.cos(self._place[2]), math.sin(self._place[2])
        self._place[0] += (self.speed[0] * ahead - left * across) * seconds
        self._place[1] += (self.speed[0] * across + left * ahead) * seconds
        self._place[2] += self.speed[1] * seconds

    def _sense(self, person: SimulatedPerson | None) -> None:
        if self.interface.get("odometry"):
            topic = self.interface["odometry"]
            message = self.types.empty(self.topics[topic])
            x, y, angle = self._place
            message["pose"]["pose"]["position"] |= {"x": x, "y": y}
            message["pose"]["pose"]["orientation"] |= {
                "z": math.sin(angle / 2),
                "w": math.cos(angle / 2),
            }
            message["twist"]["twist"]["linear"] |= {"x": self.speed[0], "y": self._left}
            message["twist"]["twist"]["angular"]["z"] = self.speed[1]
            self.publish(topic, message)
        for name, sensor in self.interface["sensors"].items():
            if self.listened_to(sensor["topic"]):
                self.publish(sensor["topic"], self._reading(name, sensor, person))

    def _reading(
        self, name: str, sensor: Mapping[str, Any], person: SimulatedPerson | None
    ) -> Message:
        """A message that is plausible for its type and its name."""
        message = self.types.empty(sensor["type"])
        metres = _FAR_M if person is None else round(person.distance, 2)
        match plain(sensor["type"]):
            case "sensor_msgs/Range":
                message |= {"range": metres, "min_range": 0.02, "max_range": 8.0}
            case "sensor_msgs/LaserScan":
                count, ahead = 360, -round(sensor.get("mounted", 0.0))
                message |= {
                    "angle_increment": math.tau / count,
                    "angle_max": math.tau,
                    "range_min": 0.12,
                    "range_max": 8.0,
                    # 0 where nothing came back, as the scanner of a TurtleBot says it
                    "ranges": [
                        metres if (at - ahead + 12) % count < 24 else 0.0 for at in range(count)
                    ],
                }
            case "sensor_msgs/BatteryState":
                message |= {"percentage": 0.8, "voltage": 12.1, "present": True}
            case "sensor_msgs/JointState":
                joints = sensor.get("joints", [])
                message |= {"name": joints, "position": [0.0] * len(joints)}
            case "std_msgs/Bool":
                message["data"] = person is not None and (name != "gaze" or person.looking)
            case "std_msgs/Float32" | "std_msgs/Float64":
                message["data"] = (
                    metres if name == "distance" else 0.1 if person and person.talking else 0.01
                )
            case "std_msgs/Int32" | "std_msgs/UInt8":
                message["data"] = int(person is not None)
        return message

    async def _speak(self, voice: Mapping[str, Any], text: str) -> None:
        """Say on a topic that it speaks, and when it has ended; an empty text ends it."""

        def says(what: str) -> None:
            kind = self.topics[voice["says"]]
            name = voice.get("field") or next(iter(self.types.fields(kind)))
            self.publish(voice["says"], {**self.types.empty(kind), name: voice[what]})

        if text:
            says("begun")
            await self.sleep(len(text) * PER_CHARACTER_S)
        says("ended")

    def act(self, topic: str, message: Message) -> None:
        """Do what a message from outside asks for."""
        if topic == self.interface.get("drive") and topic not in self.dead:
            twist = message.get("twist", message)
            forward = twist.get("linear", {}).get("x", 0.0)
            turn = twist.get("angular", {}).get("z", 0.0)
            self._commanded = (self.time.now(), forward, turn)
            self._sideways = twist.get("linear", {}).get("y", 0.0)
            self.velocities.append(self._commanded)
        for voice in self.interface.get("speech", ()):
            if topic == voice["topic"] and topic not in self.dead:
                self.fall_silent()
                text = next((str(each) for each in message.values() if isinstance(each, str)), "")
                self._speech = self.run(self._speak(voice, text))
        if self.ros == 1:
            self._actionlib(topic, message)

    def fall_silent(self) -> None:
        """End what it says; no topic tells of that."""
        if self._speech is not None:
            self._speech.cancel()

    # -- actions -------------------------------------------------------------------------------

    def goal_of(self, ident: str) -> SimulatedGoal | None:
        """A goal that is under way; any connection may cancel it."""
        return self.goals.get(ident)

    async def pursue(self, goal: SimulatedGoal, feedback: Callable[[], None] = lambda: None) -> str:
        """Carry a goal out; returns how it ended: done or canceled."""
        self.goals[goal.ident] = goal
        goal.accepted = True
        if self.ros == 2:
            self.accepted.setdefault(goal.action, []).append(goal.ident)
            self.tell_accepted(goal.action)
        feedback()
        ending = asyncio.ensure_future(goal.cancelled.wait())
        try:
            sleeping = asyncio.ensure_future(self.sleep(self.goal_s))
            await asyncio.wait({ending, sleeping}, return_when=asyncio.FIRST_COMPLETED)
            sleeping.cancel()
        finally:
            ending.cancel()
            del self.goals[goal.ident]
        goal.status = "canceled" if goal.cancelled.is_set() else "done"
        self.ended.append(goal)
        return goal.status

    def tell_accepted(self, action: str) -> None:
        """The goals that an action of ROS 2 has accepted, if there are any; a late subscriber hears
        of them, too.
        """
        if action in self.accepted:
            goals = [{"goal_info": {"goal_id": {"uuid": one}}} for one in self.accepted[action]]
            self.publish(f"{action}/_action/status", {"status_list": goals})

    def result_of(self, goal: SimulatedGoal) -> Message:
        """Its result: every flag in it says whether it was done."""
        kind = f"{self.interface['actions'][goal.action]}_Result"
        return {
            name: goal.status == "done" if isinstance(value, bool) else value
            for name, value in self.types.empty(kind).items()
        }

    def _actionlib(self, topic: str, message: Message) -> None:
        """Actions of ROS 1 are topics: goal, cancel, status, result."""
        action, _, word = topic.rpartition("/")
        if action not in self.interface["actions"] or action in self.dead:
            return
        if word == "goal":
            ident = message.get("goal_id", {}).get("id") or f"goal {len(self.calls)}"
            self.run(
                self._actionlib_goal(SimulatedGoal(ident, action, str(message.get("goal", ""))))
            )
        elif word == "cancel":
            wanted = message.get("id", "")
            for goal in tuple(self.goals.values()):
                if goal.action == action and wanted in ("", goal.ident):
                    goal.cancelled.set()

    async def _actionlib_goal(self, goal: SimulatedGoal) -> None:
        codes = STATUS[1]

        def status(code: int) -> Message:
            goal_id = {"stamp": {"secs": 0, "nsecs": 0}, "id": goal.ident}
            return {"goal_id": goal_id, "status": code, "text": ""}

        def tell(code: int) -> None:
            self.publish(f"{goal.action}/status", {"header": {}, "status_list": [status(code)]})

        if self.refuse_goals:
            goal.status = "refused"
        else:
            await self.pursue(goal, lambda: tell(codes["active"]))
        if not self.tells_results:
            return
        tell(codes[goal.status])
        result = {
            "header": {},
            "status": status(codes[goal.status]),
            "result": self.result_of(goal),
        }
        self.publish(f"{goal.action}/result", result)

    def cancel_all(self, action: str) -> Message:
        """The service of ROS 2 that cancels every goal."""
        for goal in self.goals.values():
            if goal.action == action:
                goal.cancelled.set()
        return {"return_code": 0, "goals_canceling": []}
