"""A robot behind rosbridge, without ROS: one WebSocket that plays both versions of the server.

What it offers is an `interface`: topics, services and actions with their types. Without one it is a
small mobile robot. It behaves as the servers do also where that is awkward: a message that does not
fit its type is logged and dropped, and nobody hears of it; that of ROS 2 carries out services and
goals one after the other, so that nothing else of the same connection is read meanwhile, and a goal
that is refused is never answered; its rosapi ends when it is asked for the details of a message.

    python -m robot_simulators.rosbridge --port 9090 --ros 1
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import math
import sys
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from aiohttp import web
from naoqi_simulator.robot_time import SimulatorTime
from naoqi_simulator.visitor import SimulatedPerson, SimulatedVisitors

from robot_simulators.web_robot import WebRobot, run_as_program

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
_STATUS = {1: {"active": 1, "done": 3, "canceled": 2, "aborted": 4, "refused": 5}}
_STATUS[2] = {"active": 2, "done": 4, "canceled": 5, "aborted": 6, "refused": 0}

Message = dict[str, Any]


def plain(name: str) -> str:
    """A type's name without `msg`, `srv` or `action` in its middle."""
    parts = name.split("/")
    return "/".join((parts[0], parts[-1]))


class MisfitError(Exception):
    """A message does not fit its type."""


@dataclass(eq=False)
class SimulatedGoal:
    """Something that an action does."""

    ident: str
    action: str
    text: str
    cancelled: asyncio.Event = field(default_factory=asyncio.Event)
    accepted: bool = False
    status: str = "active"


class RosbridgeSimulator(WebRobot):
    """The server and its robot.

    Attributes:
        calls: Every operation that was carried out: its name, and the message.
        logged: What a real server would only write into its log.
        velocities: The velocities that the base was given: seconds, metres and radians a second.
        speed: What the base does now: metres and radians a second.
        refuse_goals: Goals are not accepted.
        accepts_goals: While it is not set, goals wait to be accepted (ROS 2).
        tells_results: Whether it says how goals ended (ROS 1).
        nonsense: What comes instead of the next answers, as text.
        busy: Services that answer only when their event is set.
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
        self.logged: list[str] = []
        self.velocities: list[tuple[float, float, float]] = []
        self.speed = (0.0, 0.0)
        self.refuse_goals = False
        self.accepts_goals = asyncio.Event()
        self.accepts_goals.set()
        self.tells_results = True
        self.nonsense: list[str] = []
        self.busy: dict[str, asyncio.Event] = {}
        self.interface = interface
        self.goals: dict[str, SimulatedGoal] = {}
        self.accepted: dict[str, list[str]] = {}
        self._types: Mapping[str, Mapping[str, str]] = interface["types"]
        self.topics: dict[str, str] = {
            **interface["topics"],
            **{each["topic"]: each["type"] for each in interface["sensors"].values()},
        }
        self._clients: set[_Client] = set()
        self._running: set[asyncio.Task[Any]] = set()
        self._speech: asyncio.Task[Any] | None = None
        self._rosapi = True
        self._commanded = (float("-inf"), 0.0, 0.0)
        self._place = [0.0, 0.0, 0.0]

    def routes(self) -> Sequence[web.AbstractRouteDef]:
        """One WebSocket."""
        return (web.get("/", self._connected),)

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
        self.speed = (forward, turn) if self.time.now() - at < WATCHDOG_S else (0.0, 0.0)
        self._place[0] += self.speed[0] * math.cos(self._place[2]) * seconds
        self._place[1] += self.speed[0] * math.sin(self._place[2]) * seconds
        self._place[2] += self.speed[1] * seconds

    def _sense(self, person: SimulatedPerson | None) -> None:
        if self.interface.get("odometry"):
            topic = self.interface["odometry"]
            message = self.empty(self.topics[topic])
            x, y, angle = self._place
            message["pose"]["pose"]["position"] |= {"x": x, "y": y}
            message["pose"]["pose"]["orientation"] |= {
                "z": math.sin(angle / 2),
                "w": math.cos(angle / 2),
            }
            message["twist"]["twist"]["linear"]["x"] = self.speed[0]
            message["twist"]["twist"]["angular"]["z"] = self.speed[1]
            self.publish(topic, message)
        for name, sensor in self.interface["sensors"].items():
            if any(client.listens(sensor["topic"]) for client in self._clients):
                self.publish(sensor["topic"], self._reading(name, sensor, person))

    def _reading(
        self, name: str, sensor: Mapping[str, Any], person: SimulatedPerson | None
    ) -> Message:
        """A message that is plausible for its type and its name."""
        message = self.empty(sensor["type"])
        metres = _FAR_M if person is None else round(person.distance, 2)
        match plain(sensor["type"]):
            case "sensor_msgs/Range":
                message |= {"range": metres, "min_range": 0.02, "max_range": 8.0}
            case "sensor_msgs/LaserScan":
                count = 360
                message |= {
                    "angle_increment": math.tau / count,
                    "angle_max": math.tau,
                    "range_min": 0.12,
                    "range_max": 8.0,
                    # 0 where nothing came back, as the scanner of a TurtleBot says it
                    "ranges": [
                        metres if at < 12 or at >= count - 12 else 0.0 for at in range(count)
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
            name = voice.get("field") or next(iter(self._types[plain(kind)]))
            self.publish(voice["says"], {**self.empty(kind), name: voice[what]})

        if text:
            says("begun")
            await self.sleep(len(text) * PER_CHARACTER_S)
        says("ended")

    # -- types ---------------------------------------------------------------------------------

    def empty(self, kind: str) -> Message:
        """A message of this type with nothing in it."""
        fields = self._types.get(plain(kind), {})
        return {name: self._default(type_) for name, type_ in fields.items()}

    def _default(self, kind: str) -> Any:
        base, listed, length = kind.partition("[")
        if listed:
            count = int(length[:-1] or 0)
            return [self._default(base) for _ in range(count)]
        if base in ("time", "duration"):
            return {"secs": 0, "nsecs": 0} if self.ros == 1 else {"sec": 0, "nanosec": 0}
        if "/" in base:
            return self.empty(base)
        return "" if base == "string" else False if base in ("bool", "boolean") else 0

    def fit(self, message: Any, kind: str, path: str = "") -> None:
        """Raise MisfitError if a message does not fit its type."""
        base, listed, _ = kind.partition("[")
        if listed:
            if not isinstance(message, list):
                raise MisfitError(f"requires a {kind} for field {path}")
            for item in message:
                self.fit(item, base, path)
        elif base in ("time", "duration"):
            return
        elif "/" in base:
            fields = self._types.get(plain(base))
            if fields is None:
                raise MisfitError(f"Unable to import {base}")
            if not isinstance(message, dict):
                raise MisfitError(f"Expected a JSON object for type {base}")
            for name, value in message.items():
                if name not in fields:
                    raise MisfitError(f"Message type {base} does not have a field {path}{name}")
                self.fit(value, fields[name], f"{path}{name}.")
        elif not _is(message, base):
            raise MisfitError(f"requires a {base} for field {path}, but got a {type(message)}")

    # -- connections -----------------------------------------------------------------------------

    async def _connected(self, request: web.Request) -> web.StreamResponse:
        client: _Client | None = None
        opened = web.WebSocketResponse()
        try:
            async for opened, message in self.messages(request):
                if client is None:
                    client = _Client(self, opened)
                    self._clients.add(client)
                else:
                    client.operations.put_nowait(message)
        finally:
            if client is not None:
                self._clients.discard(client)
                client.end()
        return opened

    def publish(self, topic: str, message: Message) -> None:
        """To everybody who has subscribed."""
        for client in self._clients:
            client.deliver(topic, message)

    def incoming(self, topic: str, message: Message) -> None:
        """A message from outside, which fits: the robot acts, subscribers get it."""
        self.publish(topic, message)
        if topic == self.interface.get("drive"):
            twist = message.get("twist", message)
            forward = twist.get("linear", {}).get("x", 0.0)
            turn = twist.get("angular", {}).get("z", 0.0)
            self._commanded = (self.time.now(), forward, turn)
            self.velocities.append(self._commanded)
        for voice in self.interface.get("speech", ()):
            if topic == voice["topic"]:
                if self._speech is not None:
                    self._speech.cancel()
                text = next((str(each) for each in message.values() if isinstance(each, str)), "")
                self._speech = self.run(self._speak(voice, text))
        if self.ros == 1:
            self._actionlib(topic, message)

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
            sleeping = asyncio.ensure_future(self.sleep(GOAL_S))
            await asyncio.wait({ending, sleeping}, return_when=asyncio.FIRST_COMPLETED)
            sleeping.cancel()
        finally:
            ending.cancel()
            del self.goals[goal.ident]
        goal.status = "canceled" if goal.cancelled.is_set() else "done"
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
            for name, value in self.empty(kind).items()
        }

    def _actionlib(self, topic: str, message: Message) -> None:
        """Actions of ROS 1 are topics: goal, cancel, status, result."""
        action, _, word = topic.rpartition("/")
        if action not in self.interface["actions"]:
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
        codes = _STATUS[1]

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

    # -- services --------------------------------------------------------------------------------

    async def call(self, service: str, args: Message) -> Any:
        """The answer of a service. Raises MisfitError with the server's own words."""
        if service in self.busy:
            await self.busy[service].wait()
        refusal = self.faults.refused.get(service)
        if refusal is not None:
            raise MisfitError(refusal)
        if service.startswith("/rosapi/") and self._rosapi:
            return await self._rosapi_answer(service.removeprefix("/rosapi/"), args)
        if service.endswith("/_action/cancel_goal") and self.ros == 2:
            return self._cancel_all(service.removesuffix("/_action/cancel_goal"))
        kind = self.interface["services"].get(service)
        if kind is None:
            raise MisfitError(f"Service {service} does not exist")
        self.fit(args, f"{plain(kind)}_Request")
        if self._speech is not None and service.endswith("stop"):
            self._speech.cancel()
        answer = self.empty(f"{plain(kind)}_Response")
        return answer | {name: True for name, value in answer.items() if isinstance(value, bool)}

    def _cancel_all(self, action: str) -> Message:
        for goal in self.goals.values():
            if goal.action == action:
                goal.cancelled.set()
        return {"return_code": 0, "goals_canceling": []}

    async def _rosapi_answer(self, question: str, args: Message) -> Message:
        topics, services = self.all_topics(), self.interface["services"]
        if question.endswith("_details") and self.ros == 2:
            # The real one fails over a field that Python adds to every message.
            self._rosapi = False
            await asyncio.Event().wait()
        suffix = {"service_request_details": "_Request", "service_response_details": "_Response"}
        answers: dict[str, Callable[[], Message]] = {
            "topics": lambda: {"topics": [*topics], "types": self._named(topics.values(), "msg")},
            "topics_and_raw_types": lambda: {
                "topics": [*topics],
                "types": self._named(topics.values(), "msg"),
                "typedefs_full_text": [self._definition(kind) for kind in topics.values()],
            },
            "topic_type": lambda: {"type": self._named([topics.get(args["topic"], "")], "msg")[0]},
            "services": lambda: {"services": [*services, "/rosapi/topics"]},
            "service_type": lambda: {
                "type": self._named([services.get(args["service"], "")], "srv")[0]
            },
            "action_servers": lambda: {"action_servers": [*self.interface["actions"]]},
            "get_time": lambda: {"time": self._default("time")},
        }
        if self.ros == 2:
            answers["get_ros_version"] = lambda: {"version": 2, "distro": "simulated"}
        if question.endswith("_details"):
            answers[question] = lambda: {
                "typedefs": self._typedefs(args["type"] + suffix.get(question, ""))
            }
        if question not in answers:
            raise MisfitError(f"Service /rosapi/{question} does not exist")
        return answers[question]()

    def all_topics(self) -> dict[str, str]:
        """Topics with their types; with ROS 1 actions are topics."""
        found = dict(self.topics)
        if self.ros == 1:
            for action, kind in self.interface["actions"].items():
                found |= {
                    f"{action}/goal": f"{kind}ActionGoal",
                    f"{action}/cancel": "actionlib_msgs/GoalID",
                    f"{action}/status": "actionlib_msgs/GoalStatusArray",
                    f"{action}/result": f"{kind}ActionResult",
                }
        return found

    def _named(self, kinds: Any, middle: str) -> list[str]:
        return [
            kind and (kind if self.ros == 1 else f"/{middle}/".join(plain(kind).split("/")))
            for kind in kinds
        ]

    def _definition(self, kind: str) -> str:
        """The text of a type and of all within it."""
        text, seen, left = "", set[str](), [plain(kind)]
        while left:
            name = left.pop(0)
            fields = self._types.get(name)
            if fields is None or name in seen:
                continue
            text += f"\n{'=' * 80}\nMSG: {name}\n" if seen else ""
            seen.add(name)
            text += "".join(f"{type_} {field_}  # a field\n" for field_, type_ in fields.items())
            left += [type_.partition("[")[0] for type_ in fields.values() if "/" in type_]
        return text

    def _typedefs(self, kind: str) -> list[Message]:
        found: list[Message] = []
        left = [plain(kind)]
        while left:
            name = left.pop(0)
            fields = self._types.get(name)
            if fields is None or any(each["type"] == name for each in found):
                continue
            types = [type_.partition("[")[0] for type_ in fields.values()]
            lengths = [
                -1 if "[" not in type_ else int(type_.partition("[")[2][:-1] or 0)
                for type_ in fields.values()
            ]
            found.append(
                {
                    "type": name,
                    "fieldnames": [*fields],
                    "fieldtypes": types,
                    "fieldarraylen": lengths,
                }
            )
            left += [type_ for type_ in types if "/" in type_]
        return found


def _is(value: Any, kind: str) -> bool:
    if kind in ("bool", "boolean"):
        return isinstance(value, bool)
    if kind in ("string", "wstring"):
        return isinstance(value, str)
    if isinstance(value, bool):
        return False
    return (
        isinstance(value, int | float)
        if kind.startswith(("float", "double"))
        else isinstance(value, int)
    )


class _Client:
    """One connection: operations are carried out in order."""

    def __init__(self, robot: RosbridgeSimulator, opened: web.WebSocketResponse) -> None:
        self._robot = robot
        self._opened = opened
        self._advertised: dict[str, str] = {}
        self._throttles: dict[str, float] = {}
        self._sent_at: dict[str, float] = {}
        self._outgoing: asyncio.Queue[str] = asyncio.Queue()
        self.operations: asyncio.Queue[Message] = asyncio.Queue()
        self._tasks = [robot.run(self._work()), robot.run(self._write())]

    def end(self) -> None:
        """It was closed."""
        for task in self._tasks:
            task.cancel()

    def listens(self, topic: str) -> bool:
        """Whether it has subscribed."""
        return topic in self._throttles

    def deliver(self, topic: str, message: Message) -> None:
        """A message of a topic, if it was asked for, and not more often than was asked for."""
        throttle = self._throttles.get(topic)
        now = asyncio.get_running_loop().time()
        if throttle is None or now - self._sent_at.get(topic, float("-inf")) < throttle:
            return
        self._sent_at[topic] = now
        self._send({"op": "publish", "topic": topic, "msg": message})

    def _send(self, message: Message) -> None:
        nonsense = self._robot.nonsense
        answers = message["op"] != "publish"
        self._outgoing.put_nowait(nonsense.pop(0) if nonsense and answers else json.dumps(message))

    async def _write(self) -> None:
        while True:
            text = await self._outgoing.get()
            await self._robot.awake()
            with contextlib.suppress(ConnectionError):
                await self._opened.send_str(text)

    async def _work(self) -> None:
        robot = self._robot
        while True:
            message = await self.operations.get()
            await robot.awake()
            try:
                robot.calls.append((message["op"], message))
                work = self._operation(message)
            except (ValueError, TypeError, KeyError, MisfitError) as error:
                robot.logged.append(str(error))
                continue
            if work is None:
                continue
            if robot.ros == 1 or message["op"] == "cancel_action_goal":
                robot.run(work)
            else:
                await work

    def _operation(self, message: Message) -> Coroutine[Any, Any, None] | None:
        robot = self._robot
        match message["op"]:
            case "advertise":
                topic, wanted = str(message["topic"]), str(message["type"])
                there = robot.all_topics().get(topic, wanted)
                if plain(there) != plain(wanted):
                    raise MisfitError(f"{topic} is {there}, not {wanted}")
                self._advertised[topic] = wanted
            case "unadvertise":
                self._advertised.pop(message["topic"], None)
            case "publish":
                topic = message["topic"]
                kind = self._advertised.get(topic) or robot.all_topics().get(topic)
                if kind is None:
                    raise MisfitError(f"Cannot infer topic type for topic {topic}")
                if not plain(kind).endswith(("ActionGoal", "GoalID")):
                    robot.fit(message.get("msg", {}), plain(kind))
                robot.incoming(topic, message.get("msg", {}))
            case "subscribe":
                self._throttles[message["topic"]] = message.get("throttle_rate", 0) / 1000
                robot.tell_accepted(message["topic"].removesuffix("/_action/status"))
            case "unsubscribe":
                self._throttles.pop(message["topic"], None)
            case "call_service":
                return self._call(message)
            case "send_action_goal" if robot.ros == 2:
                return self._goal(message)
            case "cancel_action_goal" if robot.ros == 2:
                return self._cancel(message)
            case "set_level":
                pass
            case operation:
                raise MisfitError(f"Unknown operation: {operation}")
        return None

    async def _call(self, message: Message) -> None:
        answer = {"op": "service_response", "service": message["service"]}
        if "id" in message:
            answer["id"] = message["id"]
        try:
            values = await self._robot.call(message["service"], message.get("args") or {})
            self._send({**answer, "values": values, "result": True})
        except (MisfitError, KeyError, TypeError) as error:
            self._robot.logged.append(str(error))
            self._send({**answer, "values": str(error), "result": False})

    async def _goal(self, message: Message) -> None:
        robot, action = self._robot, message["action"]
        answer: Message = {"op": "action_result", "action": action, "id": message.get("id")}
        kind = robot.interface["actions"].get(action, "")
        if not kind or plain(kind) != plain(message["action_type"]) or robot.refuse_goals:
            await asyncio.Event().wait()  # as the real one: nobody ever hears of it
        try:
            robot.fit(message.get("args") or {}, f"{plain(kind)}_Goal")
        except MisfitError as error:
            robot.logged.append(str(error))
            self._send({**answer, "values": str(error), "status": 0, "result": False})
            return
        await robot.accepts_goals.wait()
        goal = SimulatedGoal(message.get("id", ""), action, str(message.get("args")))

        def feedback() -> None:
            if message.get("feedback"):
                self._send(
                    {"op": "action_feedback", "action": action, "id": goal.ident, "values": {}}
                )

        await robot.pursue(goal, feedback)
        values = {"result": robot.result_of(goal), "status": _STATUS[2][goal.status]}
        self._send(
            {**answer, "values": values["result"], "status": values["status"], "result": True}
        )

    async def _cancel(self, message: Message) -> None:
        goal = self._robot.goal_of(message.get("id", ""))
        if goal is not None and goal.accepted:
            goal.cancelled.set()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run until SIGTERM or SIGINT."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--ros", type=int, choices=(1, 2), default=2)
    parser.add_argument("--interface", type=json.loads, default=MOBILE_ROBOT)
    own, others = parser.parse_known_args(arguments)
    return run_as_program(
        "rosbridge",
        lambda time, visitors: RosbridgeSimulator(own.ros, own.interface, time, visitors),
        others,
    )


if __name__ == "__main__":
    sys.exit(main())
