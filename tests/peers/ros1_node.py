"""A robot as a node of ROS 1, run by Debian's Python: it tells on standard output what it gets.

Each line is JSON with `at`, the monotonic time of the machine in seconds, and what came.
"""

from __future__ import annotations

import json
import threading
import time
from typing import Any

import actionlib
import rospy
from actionlib.msg import TestAction, TestResult
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

_lock = threading.Lock()


def tell(what: str, **fields: Any) -> None:
    """Write a line."""
    with _lock:
        print(json.dumps({"at": time.monotonic(), "what": what, **fields}), flush=True)  # noqa: T201


def main() -> None:
    """Run until ROS ends."""
    rospy.init_node("robot", disable_signals=False)
    odometry = Odometry()

    def velocity(twist: Any) -> None:
        tell("velocity", x=twist.linear.x, turn=twist.angular.z)
        odometry.twist.twist = twist

    spoken = threading.Event()
    speaking = rospy.Publisher("/tts/speaking", Bool, queue_size=10)

    def speak(text: str) -> None:
        speaking.publish(True)
        spoken.clear()
        spoken.wait(len(text) * 0.05)
        speaking.publish(False)

    def say(message: Any) -> None:
        tell("say", text=message.data)
        spoken.set()
        if message.data:
            threading.Thread(target=speak, args=(message.data,), daemon=True).start()

    def pursue(goal: Any) -> None:
        tell("goal", steps=goal.goal)
        for _ in range(goal.goal):
            if server.is_preempt_requested():
                tell("cancelled")
                server.set_preempted()
                return
            time.sleep(0.05)
        tell("reached")
        server.set_succeeded(TestResult(result=goal.goal))

    def slow(_: Any) -> Any:
        tell("slow")
        time.sleep(3)
        return TriggerResponse(success=True, message="done")

    server = actionlib.SimpleActionServer("/count", TestAction, pursue, False)
    server.start()
    rospy.Subscriber("/cmd_vel", Twist, velocity, queue_size=100, tcp_nodelay=True)
    rospy.Subscriber("/tts", String, say)
    rospy.Service("/volume", SetBool, lambda call: SetBoolResponse(call.data, "as you say"))
    rospy.Service("/slow", Trigger, slow)
    places = rospy.Publisher("/odom", Odometry, queue_size=1)
    distances = rospy.Publisher("/sonar", Range, queue_size=1)
    tell("ready")
    while not rospy.is_shutdown():
        places.publish(odometry)
        distances.publish(Range(range=1.25, min_range=0.02, max_range=4.0))
        time.sleep(0.05)


if __name__ == "__main__":
    main()
