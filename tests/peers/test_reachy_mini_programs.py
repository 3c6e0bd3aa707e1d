"""Programs that play a Reachy Mini: the vendor's client a simulated one, a benchmark both."""

from __future__ import annotations

import asyncio
import math
import sys
from pathlib import Path

import pytest
from robot_simulators.reachy_mini import ReachyMiniSimulator

from tests.peers.places import place
from tests.peers.vendors_daemon import STARTS_S

VENDORS_CLIENT = """
import sys
from reachy_mini import ReachyMini
from reachy_mini.utils import create_head_pose

host, port = sys.argv[1].split(":")
with ReachyMini(
    host=host, port=int(port), connection_mode="network", media_backend="no_media"
) as robot:
    robot.goto_target(create_head_pose(yaw=20, degrees=True), antennas=[-0.5, 0.5], duration=0.5)
    robot.set_target(antennas=[-0.2, 0.2])
    print(robot.get_current_head_pose()[1][0], robot.client.get_status().version)
"""


async def test_the_vendors_client_takes_the_simulated_robot_for_one() -> None:
    python = place("reachy-mini") / "bin" / "python"
    async with ReachyMiniSimulator() as robot:
        program = await asyncio.create_subprocess_exec(
            *(str(python), "-c", VENDORS_CLIENT, robot.address),
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        output, errors = await asyncio.wait_for(program.communicate(), STARTS_S)
    assert program.returncode == 0, errors.decode()
    turned, version = output.decode().split()[-2:]
    assert float(turned) == pytest.approx(math.sin(math.radians(20)), abs=0.02)
    assert version == "1.12.0"


async def test_the_benchmark_prints_its_tables() -> None:
    place("reachy-mini")
    program = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "benchmarks.reachy_daemon", "--quick"),
        cwd=Path(__file__).parents[2],
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
    )
    output, errors = await asyncio.wait_for(program.communicate(), 3 * STARTS_S)
    assert program.returncode == 0, errors.decode()
    for line in ("goto: driver", "stands still", "killed", "frozen", "cut"):
        assert line in output.decode()
