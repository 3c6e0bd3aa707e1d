"""What must hold whatever was lost on the wire, and however the servos were found."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from woz_drivers.dynamixel.chain import PlannedMove
from woz_drivers.dynamixel.setpoint_planning import Keyframe

from tests.drivers.heard import until
from tests.drivers.servo_stand import SILENT_MS, stand
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import DriverError, Scope
from woz_tui.protocol.messages import DriverFaulted

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

TORQUE, WATCHDOG = 64, 98


async def test_a_servo_found_turning_like_a_wheel_is_switched_off(tmp_path: Path) -> None:
    def turning(bus: ServoBus) -> None:
        bus.servo(12).put(11, 1, 1)
        bus.servo(12).put(64, 1, 1)

    async with stand(tmp_path, prepare=turning) as it:
        faulted = await it.heard.first(DriverFaulted)
        assert "operating mode 1" in faulted.detail
        assert not it.bus.servo(12).torque
        assert [write.address for write in it.bus.written(12)] == [TORQUE]


async def test_a_pose_that_cannot_be_held_is_not_left_by_force(tmp_path: Path) -> None:
    def turned_by_hand(bus: ServoBus) -> None:
        bus.servo(11).put(52, 4, 2048)
        bus.servo(11).position = 1500.0
        bus.servo(11).put(132, 4, 1500)

    async with stand(tmp_path, prepare=turned_by_hand) as it:
        with pytest.raises(DriverError, match=r"48 degrees beyond .* by hand"):
            await it.do("torque", on=True, joint="pan")
        await it.ticks(3)
        assert not it.bus.servo(11).torque
        assert it.bus.servo(11).position == 1500.0


async def test_stop_is_not_confirmed_for_a_servo_that_fell_silent_holding(tmp_path: Path) -> None:
    async with stand(tmp_path, torque=True, patience_ms=SILENT_MS) as it:
        await until(lambda: it.bus.servo(13).torque)
        running = it.begin("pose", joints={"pan": 80.0}, seconds=20.0)
        it.bus.servo(12).silent = True
        await it.noticed("tilt (id 12) no longer answers")
        with pytest.raises(DriverError, match=r"unknown whether tilt \(id 12\)"):
            await it.driver.stop(Scope.ALL)
        with pytest.raises(DriverError, match="stopped where it was"):
            await running
        it.bus.servo(12).silent = False
        await it.noticed("answers again")
        await it.driver.stop(Scope.ALL)


async def test_a_stop_is_written_twice(tmp_path: Path) -> None:
    async with stand(tmp_path, torque=True) as it:
        await until(lambda: it.bus.servo(13).torque)
        before = len(it.bus.goals(11))
        await it.driver.stop(Scope.ALL)
        await it.ticks(3)
        assert len(it.bus.goals(11)) >= before + 2


async def test_a_watchdog_left_off_is_set_again(tmp_path: Path) -> None:
    """Clearing it takes two packets: the second one may be lost."""
    async with stand(tmp_path, torque=True) as it:
        await until(lambda: it.bus.servo(11).torque)
        wanted = it.bus.servo(11).watchdog
        assert wanted > 0
        it.bus.servo(11).put(WATCHDOG, 1, 0)
        await until(lambda: it.bus.servo(11).watchdog == wanted)
        assert "stopped by itself" not in it.notices()


async def test_close_lets_go_of_a_servo_that_holds_unbeknown(tmp_path: Path) -> None:
    """The answer to `torque: on` may be lost while the order was heard."""
    async with stand(tmp_path) as it:
        it.bus.servo(11).put(TORQUE, 1, 1)
        await it.driver.close()
        assert not it.bus.servo(11).torque


async def test_cancelling_a_move_that_has_ended_leaves_the_next_one_alone(tmp_path: Path) -> None:
    async with stand(tmp_path, torque=True, pan="pan") as it:
        await until(lambda: it.bus.servo(11).torque)
        move = PlannedMove()
        loop = it.driver.loop
        frames = [Keyframe({"pan": 10.0}, 0.1)]
        await asyncio.wrap_future(loop.ask(lambda chain, now: chain.begin(move, frames, now)))
        await until(move.done.done)
        await it.do("gaze", yaw=60.0)
        await asyncio.wrap_future(loop.ask(lambda chain, _now: chain.drop(move)))
        await until(lambda: it.bus.goals(11)[-1] == 2048 + round(60 / (360 / 4096)))
