"""How long a velocity and a stop take through the real rosbridge servers, beside a bare client.

Needs the peers (`make peers`, with PEERS_DIR). A node of ROS says when each velocity reached it, by
the machine's monotonic clock. Milliseconds:

* bare: a client that only publishes on an open WebSocket, to the node
* drive: from the driver's `perform` to the first velocity at the node
* zero: from the driver's `stop` in a drive to a velocity of zero at the node
* stop: from there to the confirmed end of `stop`; the robot's odometry comes 20 times a second

    python benchmarks/ros_latency.py [--runs 100] [--quick]
"""

from __future__ import annotations

import argparse
import asyncio
import json
import time
from collections.abc import Awaitable, Callable
from pathlib import Path

import aiohttp
import pytest
from woz_drivers.ros.declarations import DriveDeclaration
from woz_drivers.ros.driver import Ros
from woz_drivers.ros.settings import RosSettings

from benchmarks.figures import Spread, machine
from tests.peers.rosbridge_servers import RealRobot, real_robot
from woz_tui.drivers.contract import Health, Scope
from woz_tui.testing import PlainJob, RecordingContext, until

#: From one measurement to the next, in seconds.
PAUSE_S = 0.05


async def main(runs: int) -> None:
    """Measure both."""
    print(machine())
    print(f"\n{runs} runs, milliseconds        p50      p99    worst")
    for ros in (1, 2):
        try:
            async with real_robot(ros) as robot:
                await measure(robot, runs)
        except pytest.skip.Exception as missing:
            print(f"ROS {ros}: {missing}")


async def measure(robot: RealRobot, runs: int) -> None:
    """One version of ROS."""
    of = RosSettings(
        address=robot.address,
        ros=robot.ros,
        drive=DriveDeclaration(speed=0.5, odometry="/odom"),
    )
    context = RecordingContext(Path())
    driver = Ros("robot", of, context)
    await driver.open()
    await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
    await asyncio.sleep(1)
    figures: dict[str, list[float]] = {"bare": [], "drive": [], "zero": [], "stop": []}
    async with aiohttp.ClientSession() as client:
        opened = await client.ws_connect(f"ws://{robot.address}")
        kind = "geometry_msgs/Twist" if robot.ros == 1 else "geometry_msgs/msg/Twist"
        await opened.send_str(json.dumps({"op": "advertise", "topic": "/cmd_vel", "type": kind}))
        await asyncio.sleep(1)
        for _ in range(runs):
            figures["bare"].append(await until_felt(robot, 0.25, lambda: bare(opened, 0.25)))
            await bare(opened, 0.0)
            await asyncio.sleep(PAUSE_S)
    for _ in range(runs):
        task: asyncio.Task[object] | None = None

        async def begin() -> None:
            nonlocal task
            task = asyncio.ensure_future(driver.perform(PlainJob("drive", {"x": 5.0, "turn": 0.0})))

        figures["drive"].append(await until_felt(robot, 0.5, begin))
        await asyncio.sleep(3 * PAUSE_S)
        ended: list[float] = []

        async def stop(
            task: asyncio.Task[object] | None = task, ended: list[float] = ended
        ) -> None:
            begun = time.monotonic()
            stopping = asyncio.ensure_future(driver.stop(Scope.ALL))
            if task is not None:
                task.cancel()
            report = await stopping
            assert report is not None and not report.missing
            ended.append((time.monotonic() - begun) * 1000)

        figures["zero"].append(await until_felt(robot, 0.0, stop))
        figures["stop"] += ended
        await asyncio.sleep(PAUSE_S)
    await driver.close()
    for name, times in figures.items():
        spread = Spread.of(times)
        print(f"ROS {robot.ros} {name:22}{spread.p50:8.2f} {spread.p99:8.2f} {spread.worst:8.2f}")


async def until_felt(robot: RealRobot, x: float, act: Callable[[], Awaitable[None]]) -> float:
    """Milliseconds from `act` to the first velocity `x` at the node."""
    known = len(robot.told)
    begun = time.monotonic()
    await act()
    found: list[float] = []

    def came() -> bool:
        found[:] = [
            line["at"]
            for line in robot.told[known:]
            if line["what"] == "velocity" and line["x"] == x and line["at"] >= begun
        ]
        return bool(found)

    await until(came)
    return (found[0] - begun) * 1000


async def bare(opened: aiohttp.ClientWebSocketResponse[bool], x: float) -> None:
    """What a client does that only publishes."""
    await opened.send_str(
        json.dumps({"op": "publish", "topic": "/cmd_vel", "msg": {"linear": {"x": x}}})
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--quick", action="store_true", help="a few runs")
    given = parser.parse_args()
    asyncio.run(main(3 if given.quick else given.runs))
