"""A robot behind rosbridge, without ROS: one WebSocket that plays both versions of the server.

The robot is that of `ros_robot.py`. It behaves as the servers do also where that is awkward: a
message that does not fit its type is logged and dropped, and nobody hears of it; that of ROS 2
carries out services and goals one after the other, so that nothing else of the same connection is
read meanwhile, and a goal that is refused is never answered; its rosapi ends when it is asked for
the details of a message.

    python -m robot_simulators.rosbridge --port 9090 --ros 1
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import sys
from collections.abc import Coroutine, Mapping, Sequence
from typing import Any

from aiohttp import web
from naoqi_simulator.robot_time import SimulatorTime
from naoqi_simulator.visitor import SimulatedVisitors

from robot_simulators.ros_messages import Message, MisfitError, plain
from robot_simulators.ros_robot import MOBILE_ROBOT, STATUS, SimulatedGoal, SimulatedRosRobot
from robot_simulators.web_robot import run_as_program


class RosbridgeSimulator(SimulatedRosRobot):
    """The server and its robot.

    Attributes:
        calls: Every operation that was carried out: its name, and the message.
        logged: What a real server would only write into its log.
        nonsense: What comes instead of the next answers, as text.
        replaced: A piece of the text of all that it sends, and what stands there instead.
        busy: Services that answer only when their event is set.
    """

    def __init__(
        self,
        ros: int = 2,
        interface: Mapping[str, Any] = MOBILE_ROBOT,
        time: SimulatorTime | None = None,
        visitors: SimulatedVisitors | None = None,
    ) -> None:
        super().__init__(ros, interface, time, visitors)
        self.logged: list[str] = []
        self.nonsense: list[str] = []
        self.replaced = ("", "")
        self.busy: dict[str, asyncio.Event] = {}
        self._clients: set[_Client] = set()
        self._rosapi = True

    def routes(self) -> Sequence[web.AbstractRouteDef]:
        return (web.get("/", self._connected),)

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

    def listened_to(self, topic: str) -> bool:
        return any(client.listens(topic) for client in self._clients)

    def incoming(self, topic: str, message: Message) -> None:
        """A message from outside, which fits: subscribers get it, the robot acts."""
        self.publish(topic, message)
        self.act(topic, message)

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
            return self.cancel_all(service.removesuffix("/_action/cancel_goal"))
        kind = self.interface["services"].get(service)
        if kind is None:
            raise MisfitError(f"Service {service} does not exist")
        self.types.fit(args, f"{plain(kind)}_Request")
        if service.endswith("stop"):
            self.fall_silent()
        answer = self.types.empty(f"{plain(kind)}_Response")
        return answer | {name: True for name, value in answer.items() if isinstance(value, bool)}

    async def _rosapi_answer(self, question: str, args: Message) -> Message:
        topics, services = self.all_topics(), self.interface["services"]
        if question.endswith("_details") and self.ros == 2:
            # The real one fails over a field that Python adds to every message.
            self._rosapi = False
            await asyncio.Event().wait()
        match question:
            case "topics":
                return {"topics": [*topics], "types": self._named(topics.values(), "msg")}
            case "topics_and_raw_types":
                return {
                    "topics": [*topics],
                    "types": self._named(topics.values(), "msg"),
                    "typedefs_full_text": [self.types.definition(kind) for kind in topics.values()],
                }
            case "topic_type":
                return {"type": self._named([topics.get(args["topic"], "")], "msg")[0]}
            case "services":
                return {"services": [*services, "/rosapi/topics"]}
            case "service_type":
                return {"type": self._named([services.get(args["service"], "")], "srv")[0]}
            case "action_servers":
                return {"action_servers": [*self.interface["actions"]]}
            case "publishers" | "subscribers":
                return {question: self._nodes(args["topic"])}
            case "get_time":
                return {"time": self.types.default("time")}
            case "get_ros_version" if self.ros == 2:
                return {"version": 2, "distro": "simulated"}
            case "service_request_details":
                return {"typedefs": self.types.typedefs(f"{args['type']}_Request")}
            case "service_response_details":
                return {"typedefs": self.types.typedefs(f"{args['type']}_Response")}
            case _ if question.endswith("_details"):
                return {"typedefs": self.types.typedefs(args["type"])}
        raise MisfitError(f"Service /rosapi/{question} does not exist")

    def _nodes(self, topic: str) -> list[str]:
        """Those that publish a topic, or listen to it: rosbridge itself is always among them."""
        dead = any(topic == one or topic.startswith(f"{one}/") for one in self.dead)
        return ["/rosbridge_websocket", *([] if dead else ["/robot"])]

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
        for task in self._tasks:
            task.cancel()

    def listens(self, topic: str) -> bool:
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
        text = nonsense.pop(0) if nonsense and answers else json.dumps(message)
        here, instead = self._robot.replaced
        self._outgoing.put_nowait(text.replace(here, instead) if here else text)

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
                    robot.types.fit(message.get("msg", {}), plain(kind))
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
        if action in robot.dead:
            return  # rosbridge waits for its server
        kind = robot.interface["actions"].get(action, "")
        if not kind or plain(kind) != plain(message["action_type"]) or robot.refuse_goals:
            await asyncio.Event().wait()  # as the real one: nobody ever hears of it
        try:
            robot.types.fit(message.get("args") or {}, f"{plain(kind)}_Goal")
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
        values = {"result": robot.result_of(goal), "status": STATUS[2][goal.status]}
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
