"""A robot as a node of ROS 2, run by the Python of the wheels: it tells on standard output what it
gets, as `ros1_node.py` does.
"""

from __future__ import annotations

import json
import threading
import time
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger
from test_msgs.action import Fibonacci

_lock = threading.Lock()


def tell(what: str, **fields: Any) -> None:
    """Write a line."""
    with _lock:
        print(json.dumps({"at": time.monotonic(), "what": what, **fields}), flush=True)  # noqa: T201


class Robot(Node):  # type: ignore[misc]
    """Topics, services and an action."""

    def __init__(self) -> None:
        super().__init__("robot")
        group = ReentrantCallbackGroup()
        self.odometry = Odometry()
        self.spoken = threading.Event()
        self.speaking = self.create_publisher(Bool, "/tts/speaking", 10)
        self.places = self.create_publisher(Odometry, "/odom", 10)
        self.distances = self.create_publisher(Range, "/sonar", 10)
        every: dict[str, Any] = {"callback_group": group}
        in_order = MutuallyExclusiveCallbackGroup()
        self.create_subscription(Twist, "/cmd_vel", self.velocity, 100, callback_group=in_order)
        self.create_subscription(String, "/tts", self.say, 10, **every)
        self.create_service(SetBool, "/volume", self.volume, **every)
        self.create_service(Trigger, "/slow", self.slow, **every)
        self.create_timer(0.05, self.sense, **every)
        self.server = ActionServer(
            self,
            Fibonacci,
            "/count",
            self.pursue,
            goal_callback=self.judge,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            **every,
        )

    def velocity(self, twist: Any) -> None:
        tell("velocity", x=twist.linear.x, turn=twist.angular.z)
        self.odometry.twist.twist = twist

    def speak(self, text: str) -> None:
        self.speaking.publish(Bool(data=True))
        self.spoken.clear()
        self.spoken.wait(len(text) * 0.05)
        self.speaking.publish(Bool(data=False))

    def say(self, message: Any) -> None:
        tell("say", text=message.data)
        self.spoken.set()
        if message.data:
            threading.Thread(target=self.speak, args=(message.data,), daemon=True).start()

    def volume(self, call: Any, answer: Any) -> Any:
        answer.success, answer.message = call.data, "as you say"
        return answer

    def slow(self, _: Any, answer: Any) -> Any:
        tell("slow")
        time.sleep(3)
        answer.success, answer.message = True, "done"
        return answer

    def judge(self, goal: Any) -> Any:
        return GoalResponse.REJECT if goal.order > 1000 else GoalResponse.ACCEPT

    def pursue(self, goal: Any) -> Any:
        steps = goal.request.order
        tell("goal", steps=steps)
        for _ in range(steps):
            if goal.is_cancel_requested:
                tell("cancelled")
                goal.canceled()
                return Fibonacci.Result()
            time.sleep(0.05)
        tell("reached")
        goal.succeed()
        return Fibonacci.Result(sequence=[steps])

    def sense(self) -> None:
        self.places.publish(self.odometry)
        self.distances.publish(Range(range=1.25, min_range=0.02, max_range=4.0))


def main() -> None:
    """Run until ROS ends."""
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    executor.add_node(Robot())
    tell("ready")
    executor.spin()


if __name__ == "__main__":
    main()
