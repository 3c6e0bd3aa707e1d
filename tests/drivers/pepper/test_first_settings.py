"""The first moments with a robot: settings of the file, wishes of the wizard, robots of our own."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.faults import Entry
from naoqi_simulator.world import SimulatorOptions
from woz_drivers.naoqi_robot.address import parse
from woz_drivers.naoqi_robot.connection import simulated_naoqi
from woz_drivers.naoqi_robot.driver import NaoqiRobot
from woz_drivers.naoqi_robot.settings import AutonomySettings
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.robot_rig import PACE, QUIET, RobotRig
from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.naoqi import StandIn, stand_in, stand_in_here
from woz_tui.drivers.contract import DeviceLostError, Scope
from woz_tui.protocol.messages import DriverConnected

SIMULATED = PepperSettings(robots=("simulated",), pace=PACE)

pytestmark = pytest.mark.usefixtures("patient")


def _closed_driver(robot: StandIn, folder: Path, *, state: str, connect: bool = True) -> RobotRig:
    """A driver, not open yet, whose file wants the robot's life to be in this state."""
    settings = PepperSettings(
        robots=(robot.address,),
        senses=QUIET,
        connect=connect,
        autonomy=AutonomySettings(state=state),
    )
    published = PublishedMessages(folder)
    return RobotRig(robot, Pepper("it", settings, published.context), published)


async def test_what_the_wizard_wants_first_is_not_undone_by_the_file(tmp_path: Path) -> None:
    """`state: disabled` lets the robot sleep; a wizard who wakes it up meanwhile wants it awake."""
    async with stand_in(pace=PACE, life="solitary") as robot:
        rig = _closed_driver(robot, tmp_path, state="disabled")
        await rig.driver.open()
        woken = asyncio.create_task(_as_soon_as_possible(rig.driver))
        await rig.published.first(DriverConnected)
        await woken
        calls = await robot.trace("ALAutonomousLife.setState", "ALMotion.wakeUp")
        assert [call.method for call in calls] == ["setState", "wakeUp"]
        await rig.shows(awake=True)
        await rig.close()


async def test_a_robot_that_comes_back_while_the_stop_is_pressed_is_not_brought_to_life(
    tmp_path: Path,
) -> None:
    async with stand_in(pace=PACE, life="disabled") as robot:
        rig = _closed_driver(robot, tmp_path, state="solitary", connect=False)
        await rig.driver.open()
        await rig.driver.stop(Scope.ALL)
        await rig.driver.perform(BusJob("connect", {}))
        await rig.published.first(DriverConnected)
        await rig.shows(state="disabled")
        assert await robot.trace("ALAutonomousLife.setState") == []
        await rig.driver.resume()
        await rig.shows(state="solitary")
        await rig.driver.close()


async def test_a_stop_while_the_settings_are_applied_keeps_the_robot_from_coming_to_life(
    tmp_path: Path,
) -> None:
    pressed: list[asyncio.Task[Any]] = []
    async with stand_in_here(options=SimulatorOptions(visitors=False, life="disabled")) as robot:
        published = PublishedMessages(tmp_path)
        wanted = AutonomySettings(state="solitary")
        settings = PepperSettings(robots=(robot.address,), senses=QUIET, autonomy=wanted)
        driver = Pepper("it", settings, published.context)

        def press(call: Entry) -> None:
            if "getState" in call and not pressed:
                pressed.append(asyncio.create_task(driver.stop(Scope.ALL)))

        robot.pepper.world.desk.heard.append(press)
        await driver.open()
        await published.first(DriverConnected)
        await pressed[0]
        assert await robot.trace("ALAutonomousLife.setState") == []
        pressed.clear()
        await driver.resume()  # it is asked again, and that is stopped again
        await until(lambda: bool(pressed))
        await pressed[0]
        await driver.perform(BusJob("eyes", {"color": "red"}))
        assert await robot.trace("ALAutonomousLife.setState") == []
        await driver.resume()
        await robot.called("ALAutonomousLife.setState")
        await driver.close()


async def test_a_robot_that_was_woken_stays_awake_when_the_line_comes_back(tmp_path: Path) -> None:
    async with stand_in(pace=PACE, life="disabled") as robot:
        rig = _closed_driver(robot, tmp_path, state="disabled")
        await rig.driver.open()
        await rig.published.first(DriverConnected)
        await rig.driver.perform(BusJob("torque", {"on": True}))
        await rig.driver.perform(BusJob("disconnect", {}))
        await rig.driver.perform(BusJob("connect", {}))
        assert await robot.trace("ALAutonomousLife.setState") == []
        await rig.shows(awake=True)
        await rig.driver.close()


async def _as_soon_as_possible(driver: NaoqiRobot) -> None:
    async with asyncio.timeout(20):
        while True:
            with contextlib.suppress(DeviceLostError):
                await driver.perform(BusJob("torque", {"on": True}))
                return
            await asyncio.sleep(0)


async def test_a_simulated_robot_that_cannot_be_reached_is_started_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = simulated_naoqi(SIMULATED, tmp_path)
    first = await robot.address()
    assert await robot.address() == first, "it may come back by itself"
    monkeypatch.setattr("woz_drivers.programs.simulated_process._HOPELESS_S", 0.0)
    second = await robot.address()
    assert second != first
    await robot.close()


async def test_attempts_of_different_losses_are_not_added_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.programs.simulated_process._HOPELESS_S", 0.0)
    monkeypatch.setattr("woz_drivers.programs.simulated_process._APART_S", 0.0)
    robot = simulated_naoqi(SIMULATED, tmp_path)
    assert await robot.address() == await robot.address()
    await robot.close()


async def test_a_simulated_robot_runs_no_module_of_the_experiments_folder(tmp_path: Path) -> None:
    (tmp_path / "random.py").write_text("raise ValueError\n")
    robot = simulated_naoqi(SIMULATED, tmp_path)
    assert parse(await robot.address()).port
    await robot.close()
