"""Whatever happens to a robot, libqi writes nothing where a screen may be; the process ends."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]

#: Every kind of end, with logs asked for from outside; a frozen robot is there at the exit.
SCENE = """
import asyncio, os
from tests.fakes.naoqi import stand_in
from woz_drivers.pepper.address import parse
from woz_drivers.pepper.link import LinkError
from woz_drivers.pepper.links import open_link
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.core.driver import Lost

async def trouble(address):
    link = await open_link(parse(address), PepperSettings(robots=(), client="qi"), within=20)
    calls = [
        link.call("ALMotion", "moveTo", "x", within=20),
        link.call("ALNothing", "say", within=20),
        link.call("ALMotion", "nothing", within=20),
        link.listen("ALMotion", "nothing", print),
    ]
    for call in calls:
        try:
            await call
        except LinkError:
            pass
    return link

async def refused(address, within):
    try:
        await open_link(parse(address), PepperSettings(robots=(), client="qi"), within=within)
    except Lost:
        return
    raise AssertionError(address)

async def main():
    async with stand_in() as robot:
        os.environ.update(QI_LOG_LEVEL="6", QI_LOG_CONTEXT="255")
        link = await trouble(robot.address)
        saying = asyncio.create_task(link.call("ALTextToSpeech", "say", "a " * 999, within=30))
        await robot.called("ALTextToSpeech.say")
        robot.kill()
        await asyncio.gather(saying, link.lost, return_exceptions=True)
        await link.close()
        await refused(robot.address, 3.0)
    await refused("no.such.host.invalid", 3.0)
    frozen = stand_in()
    robot = await frozen.__aenter__()
    link = await trouble(robot.address)
    robot.freeze()
    for _ in range(3):
        try:
            await link.call("ALMemory", "getData", "x" * 1000000, within=0.02)
        except LinkError:
            pass
    await link.close()
    await refused(robot.address, 0.2)
    return robot

robot = asyncio.run(main())
robot.kill()
"""


@pytest.mark.skipif(importlib.util.find_spec("qi") is None, reason="our own client logs nothing")
def test_libqi_is_silent_through_kill_freeze_and_errors(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", SCENE],
        cwd=ROOT,
        env={"PATH": "/usr/bin:/bin", "QI_LOG_LEVEL": "0", "HOME": str(tmp_path)},
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")
