"""What must hold whatever was lost on the wire, and however the servos were found."""

from __future__ import annotations

import asyncio
import itertools
import time
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.dynamixel import ServoJointSettings, chain, port
from woz_drivers.dynamixel.chain import PlannedMove
from woz_drivers.dynamixel.setpoint_planning import Keyframe

from tests.drivers.published_messages import until
from tests.drivers.servo_rig import HEAD, MISSING_MS, SILENT_MS, connected_servos
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import DriverError, Scope
from woz_tui.motion.body_feeds import PRESENT, SETPOINTS, JointPositions, Setpoints
from woz_tui.protocol.messages import DriverFaulted, DriverLost, Notice

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

TORQUE, RETURN_LEVEL, WATCHDOG = 64, 68, 98


async def test_a_servo_found_turning_like_a_wheel_is_switched_off(tmp_path: Path) -> None:
    def turning(bus: ServoBus) -> None:
        bus.servo(12).put(11, 1, 1)
        bus.servo(12).put(64, 1, 1)

    async with connected_servos(tmp_path, prepare=turning) as rig:
        faulted = await rig.published.first(DriverFaulted)
        assert "operating mode 1" in faulted.detail
        assert not rig.bus.servo(12).torque
        assert [write.address for write in rig.bus.written(12)] == [TORQUE]


async def test_a_servo_found_turning_like_a_wheel_is_switched_off_when_an_answer_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chain, "PROBE_S", 3600.0)

    def turning(bus: ServoBus) -> None:
        bus.servo(12).put(11, 1, 1)
        bus.servo(12).put(64, 1, 1)
        bus.faults.unread = RETURN_LEVEL

    async with connected_servos(
        tmp_path, ids=(12,), prepare=turning, ready=False, reply_timeout=MISSING_MS
    ) as rig:
        lost = await rig.published.first(DriverLost)
        assert "no servo answers" not in lost.detail and "answers pings" not in lost.detail
        assert not rig.bus.servo(12).torque


async def test_a_pose_that_cannot_be_held_is_not_left_by_force(tmp_path: Path) -> None:
    def turned_by_hand(bus: ServoBus) -> None:
        bus.servo(11).put(52, 4, 2048)
        bus.servo(11).position = 1500.0
        bus.servo(11).put(132, 4, 1500)

    async with connected_servos(tmp_path, prepare=turned_by_hand) as rig:
        with pytest.raises(DriverError, match=r"48 degrees beyond .* by hand"):
            await rig.do("torque", on=True, joint="pan")
        await rig.ticks(3)
        assert not rig.bus.servo(11).torque
        assert rig.bus.servo(11).position == 1500.0


def a_turn_away(bus: ServoBus) -> None:
    bus.servo(11).put(11, 1, 4)
    bus.servo(11).position = 2048.0 + 4096
    bus.servo(11).put(132, 4, 2048 + 4096)


#: Every command that begins a movement, with the turned joint alone.
MOVEMENTS: list[tuple[str, dict[str, Any]]] = [
    ("pose", {"joints": {"pan": 30.0}}),
    ("poses", {"poses": [{"joints": {"pan": 30.0}}]}),
    ("play", {"move": "left"}),
    ("gaze", {"yaw": 30.0}),
    ("nudge", {"yaw": 5.0}),
]


@pytest.mark.parametrize("given", [{}, {"torque": True}])
async def test_a_joint_a_turn_away_is_not_driven_back(
    tmp_path: Path, given: dict[str, Any]
) -> None:
    poses = {"left": {"pan": 30.0}}
    changes = {"pan": "pan", "poses": poses, "rest_on_close": True, **given}
    async with connected_servos(tmp_path, prepare=a_turn_away, **changes) as rig:
        if given:
            await rig.noticed("no torque on pan: it stands at 360 degrees, 270 outside -90 to 90")
            remedies = [
                each.remedy for each in rig.published.all(Notice) if "no torque" in each.text
            ]
            assert "reboot" in remedies[0]
        with pytest.raises(DriverError, match="its count is wrong by 1 turn") as raised:
            await rig.do("torque", on=True, joint="pan")
        assert "reboot" in raised.value.remedy
        for verb, args in MOVEMENTS:
            with pytest.raises(DriverError):
                await rig.do(verb, **args)
        await rig.driver.stop(Scope.ALL)
        await rig.driver.resume()
        await rig.do("torque", on=True)
        sent = await rig.do("home", seconds=0.1)
        assert "pan" in sent["left_out"]  # type: ignore[operator]
        await rig.driver.rest()
        assert rig.bus.goals(11) == []
        assert not rig.bus.servo(11).torque
        await rig.do("reboot", joint="pan")
        await rig.do("torque", on=True, joint="pan")
        await rig.do("pose", joints={"pan": 30.0}, seconds=0.1)
        assert max(rig.bus.goals(11)) == 2048 + round(30 / (360 / 4096))


async def test_a_joint_that_is_held_far_outside_its_range_is_not_driven_back(
    tmp_path: Path,
) -> None:
    """Pushed away by force, it holds there after a stop; hands take it back."""
    async with connected_servos(tmp_path, pan="pan", torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        rig.bus.servo(11).put(112, 4, 1)  # so slow that it stays where it was pushed
        rig.bus.servo(11).position = 3500.0
        while await rig.position("pan") < 100:  # an answer may be late
            await rig.ticks(1)
        await rig.driver.stop(Scope.ALL)
        await rig.driver.resume()
        before = len(rig.bus.goals(11))
        for verb, args in MOVEMENTS:
            if verb != "play":
                with pytest.raises(DriverError, match=r"12\d degrees, 3\d outside") as raised:
                    await rig.do(verb, **args)
                assert "torque off and turn it back by hand" in raised.value.remedy
        assert set(rig.bus.goals(11)[before:]) <= {rig.bus.goals(11)[-1]}


async def test_a_joint_that_sags_a_little_out_of_its_range_comes_in_with_its_next_movement(
    tmp_path: Path,
) -> None:
    def sagging(bus: ServoBus) -> None:
        bus.servo(12).position = 2048.0 + 432  # 38 degrees; its range ends at 30
        bus.servo(12).put(132, 4, 2048 + 432)

    async with connected_servos(tmp_path, prepare=sagging) as rig:
        await rig.do("torque", on=True, joint="tilt")
        await rig.ticks(3)
        assert set(rig.bus.goals(12)) == {2048 + 432}
        await rig.do("pose", joints={"tilt": 20.0}, seconds=0.5)
        goals = rig.bus.goals(12)
        assert goals[-1] == 2048 + round(20 / (360 / 4096))
        assert max(abs(b - a) for a, b in itertools.pairwise(goals)) < 150


async def test_a_body_neither_moves_a_joint_a_turn_away_nor_hears_of_its_place(
    tmp_path: Path,
) -> None:
    async with connected_servos(tmp_path, prepare=a_turn_away, follows="body") as rig:
        setpoints = Setpoints(round((time.monotonic() + 1000) * 1e6), {"pan": 30.0})
        rig.published.context.feed(SETPOINTS, of="body").put(setpoints)
        sent = await rig.do("torque", on=True)
        assert "count is wrong" in sent["left_out"]["pan"]  # type: ignore[index,call-overload]
        await rig.ticks(3)
        told = rig.published.context.feed(PRESENT).latest().value
        assert isinstance(told, JointPositions)
        assert sorted(told.joints) == ["roll", "tilt"]
        assert rig.bus.goals(11) == []


async def test_a_servo_that_counts_another_turn_once_it_holds_is_let_go(tmp_path: Path) -> None:
    def offset(bus: ServoBus) -> None:
        bus.servo(11).put(20, 4, -512)
        bus.servo(11).position = 3700.0
        bus.servo(11).put(132, 4, 3700)

    joints = {**HEAD, "pan": ServoJointSettings(id=11, min=-90, max=90, zero=3072)}
    async with connected_servos(tmp_path, prepare=offset, joints=joints) as rig:
        with pytest.raises(DriverError, match="counts another turn as soon as it holds") as raised:
            await rig.do("torque", on=True, joint="pan")
        assert "Homing Offset (20) to 0" in raised.value.remedy
        assert not rig.bus.servo(11).torque
        assert rig.bus.servo(11).driven == 0.0


async def test_stop_is_not_confirmed_for_a_servo_that_fell_silent_holding(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, patience_ms=SILENT_MS) as rig:
        await until(lambda: rig.bus.servo(13).torque)
        running = rig.begin("pose", joints={"pan": 80.0}, seconds=20.0)
        rig.bus.servo(12).silent = True
        await rig.noticed("tilt (id 12) no longer answers")
        with pytest.raises(DriverError, match=r"unknown whether tilt \(id 12\)"):
            await rig.driver.stop(Scope.ALL)
        with pytest.raises(DriverError, match="stopped where it was"):
            await running
        rig.bus.servo(12).silent = False
        await rig.noticed("answers again")
        await rig.driver.stop(Scope.ALL)


async def test_stop_is_not_confirmed_for_a_servo_that_is_silent_while_the_computer_is_late(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with connected_servos(tmp_path, torque=True, patience_ms=SILENT_MS) as rig:
        await until(lambda: rig.bus.servo(13).torque)
        monkeypatch.setattr(chain, "LATE_S", 3600.0)
        monkeypatch.setattr(chain, "LATE_MISSES", 1000)
        monkeypatch.setattr(port, "BUSY_WITHIN_MS", 3_600_000.0)
        open_port = await rig.port()
        open_port._delays.append((open_port.getCurrentTime(), 3000.0))
        rig.bus.servo(12).silent = True
        with pytest.raises(DriverError, match=r"unknown whether tilt \(id 12\)"):
            await rig.driver.stop(Scope.ALL)
        rig.bus.servo(12).silent = False
        await rig.driver.stop(Scope.ALL)


async def test_a_stop_is_written_twice(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(13).torque)
        before = len(rig.bus.goals(11))
        await rig.driver.stop(Scope.ALL)
        await rig.ticks(3)
        assert len(rig.bus.goals(11)) >= before + 2


async def test_a_watchdog_left_off_is_set_again(tmp_path: Path) -> None:
    """Clearing it takes two packets: the second one may be lost."""
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        wanted = rig.bus.servo(11).watchdog
        assert wanted > 0
        rig.bus.servo(11).put(WATCHDOG, 1, 0)
        await until(lambda: rig.bus.servo(11).watchdog == wanted)
        assert "stopped by itself" not in rig.notices()


async def test_close_lets_go_of_a_servo_that_holds_unbeknown(tmp_path: Path) -> None:
    """The answer to `torque: on` may be lost while the order was heard."""
    async with connected_servos(tmp_path) as rig:
        rig.bus.servo(11).put(TORQUE, 1, 1)
        await rig.driver.close()
        assert not rig.bus.servo(11).torque


async def test_cancelling_a_move_that_has_ended_leaves_the_next_one_alone(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, pan="pan") as rig:
        await until(lambda: rig.bus.servo(11).torque)
        move = PlannedMove()
        loop = rig.driver.loop
        frames = [Keyframe({"pan": 10.0}, 0.1)]
        await asyncio.wrap_future(loop.ask(lambda chain, now: chain.begin(move, frames, now)))
        await until(move.done.done)
        await rig.do("gaze", yaw=60.0)
        await asyncio.wrap_future(loop.ask(lambda chain, _now: chain.drop(move)))
        await until(lambda: rig.bus.goals(11)[-1] == 2048 + round(60 / (360 / 4096)))
