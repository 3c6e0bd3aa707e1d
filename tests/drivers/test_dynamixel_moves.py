"""The driver moves emulated servos: start-up, verbs, stop, rest; all over the wire."""

from __future__ import annotations

import asyncio
import itertools
import math
import time
from pathlib import Path

import pytest
from woz_drivers.dynamixel import ServoJointSettings

from tests.drivers.published_messages import BusJob, until
from tests.drivers.servo_rig import connected_servos
from tests.fakes.servos import ServoBus
from woz_tui.drivers.argument_check import ArgumentError
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope
from woz_tui.protocol.messages import Json

GOAL, TORQUE, WATCHDOG, PROFILE_VELOCITY = 116, 64, 98, 112
#: Counts in a tick of 20 ms at 300 deg/s, and one for rounding, times the two ticks a late one may
#: catch up.
STEP = 300 * 0.02 / (360 / 4096) * 2 + 2


def placed(bus: ServoBus) -> None:
    """Put the servos where no default would put them."""
    for number, position in ((11, 1700.0), (12, 2100.0), (13, 2300.0)):
        motor = bus.servo(number)
        motor.position = position
        motor.put(132, 4, round(position))
        motor.put(116, 4, 0)  # the last goal of some other program


async def test_start_touches_no_torque_and_no_goal(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed, watchdog=500) as rig:
        await rig.ticks(5)
        for number in (11, 12, 13):
            assert rig.bus.goals(number) == []
            assert not rig.bus.servo(number).torque
            assert rig.bus.servo(number).watchdog == 500 // 20
        assert rig.bus.servo(11).position == 1700.0


async def test_torque_left_on_by_another_program_goes_off(tmp_path: Path) -> None:
    def held(bus: ServoBus) -> None:
        placed(bus)
        bus.servo(11).put(TORQUE, 1, 1)
        bus.servo(11).put(GOAL, 4, 1700)

    async with connected_servos(tmp_path, prepare=held) as rig:
        assert not rig.bus.servo(11).torque
        assert rig.bus.servo(11).position == 1700.0


async def test_first_setpoint_is_the_present_pose(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed) as rig:
        sent = await rig.do("torque", on=True)
        assert sent == {"on": True, "joints": ["pan", "tilt", "roll"]}
        await rig.ticks(40)
        for number, position in ((11, 1700), (12, 2100), (13, 2300)):
            assert set(rig.bus.goals(number)) == {position}
            assert rig.bus.servo(number).position == position
            writes = [write.address for write in rig.bus.written(number)]
            assert writes.index(GOAL) < max(
                i for i, address in enumerate(writes) if address == TORQUE
            )


async def test_torque_setting_holds_from_the_start(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed, torque=True) as rig:
        await until(lambda: all(rig.bus.servo(number).torque for number in (11, 12, 13)))
        assert set(rig.bus.goals(11)) == {1700}


async def test_pose_arrives_and_no_register_jumps(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed) as rig:
        await rig.do("torque", on=True)
        job = BusJob("pose", {"joints": {"pan": 30.0, "roll": -10.0}, "seconds": 0.5})
        sent = await rig.driver.perform(job)
        await rig.ticks(1)
        assert sent["joints"] == {"pan": 30.0, "roll": -10.0}
        assert job.announced == [pytest.approx(0.5)]
        assert "clamped" not in sent and "late_s" not in sent
        assert rig.bus.goals(11)[-1] == 2048 + round(30 / (360 / 4096))
        assert rig.bus.goals(13)[-1] == 2048 + round(10 / (360 / 4096))  # direction -1
        for number in (11, 13):
            goals = rig.bus.goals(number)
            assert max(abs(b - a) for a, b in itertools.pairwise(goals)) <= STEP
        assert set(rig.bus.goals(12)) == {2100}


async def test_the_servo_itself_is_fenced_to_the_speed_limit(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        assert rig.bus.servo(11).get(PROFILE_VELOCITY, 4) == math.ceil(300 / (0.229 * 6))


async def test_clamped_and_late_are_reported(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        await rig.do("torque", on=True)
        sent = await rig.do("pose", joints={"tilt": 500.0}, seconds=0.01)
        assert sent["joints"] == {"tilt": 30.0}
        assert sent["clamped"] == {"tilt": 500.0}
        assert sent["seconds"] == pytest.approx(0.1)
        assert sent["late_s"] == pytest.approx(0.09)


NONSENSE: list[tuple[str, dict[str, Json]]] = [
    ("pose", {"joints": {"pan": math.nan}, "seconds": 1.0}),
    ("pose", {"joints": {"pan": math.inf}, "seconds": 1.0}),
    ("pose", {"joints": {"pan": "left"}, "seconds": 1.0}),
    ("pose", {"joints": {"pan": True}, "seconds": 1.0}),
    ("pose", {"joints": {"nose": 3.0}, "seconds": 1.0}),
    ("pose", {"joints": {}, "seconds": 1.0}),
    ("pose", {"joints": {"pan": 10**400}, "seconds": 1.0}),
    ("pose", {"joints": {"pan": 1.0}, "seconds": -1.0}),
    ("pose", {"joints": {"pan": 1.0}, "seconds": math.nan}),
    ("poses", {"poses": []}),
    ("poses", {"poses": [{"seconds": 1.0}]}),
    ("poses", {"poses": [7]}),
    ("play", {"move": "salto"}),
    ("gaze", {"yaw": math.nan}),
    ("gaze", {}),
    ("torque", {"on": "yes"}),
    ("torque", {"on": True, "joint": "nose"}),
    ("sing", {}),
]


async def test_nonsense_is_rejected_and_moves_nothing(tmp_path: Path) -> None:
    poses = {"left": {"pan": 9.0}}
    async with connected_servos(tmp_path, pan="pan", tilt="tilt", torque=True, poses=poses) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        for verb, args in NONSENSE:
            with pytest.raises((RejectedError, ArgumentError)):
                await rig.driver.perform(rig.ordered(verb, args))
            await rig.ticks(3)
            assert set(rig.bus.goals(11)) == {2048}, (verb, args)


async def test_a_limp_joint_is_refused_with_a_remedy(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        with pytest.raises(RejectedError, match="torque of pan is off") as raised:
            await rig.do("pose", joints={"pan": 10.0})
        assert "torque: on" in raised.value.remedy


async def test_poses_play_home(tmp_path: Path) -> None:
    moves = {"nod": [{"tilt": 25.0, "seconds": 0.2}, {"tilt": 5.0, "seconds": 0.2}]}
    async with connected_servos(tmp_path, moves=moves, poses={"left": {"pan": 20.0}}) as rig:
        await rig.do("torque", on=True)
        sent = await rig.do(
            "poses",
            poses=[
                {"joints": {"pan": 5.0}, "seconds": 0.1},
                {"joints": {"pan": -5.0, "tilt": 1.0}, "seconds": 0.1},
            ],
        )
        assert sent["joints"] == {"pan": -5.0, "tilt": 1.0}
        sent = await rig.do("play", move="nod", speed=2.0, amplitude=0.5)
        assert sent["joints"] == {"tilt": 5.0}
        assert sent["seconds"] == pytest.approx(0.2)
        # Half the way from home (5) to 25 degrees, and back; a late tick may miss the very top.
        assert 2048 < max(rig.bus.goals(12)) <= 2048 + round(15 / (360 / 4096))
        sent = await rig.do("play", move="left", speed=5.0)
        assert sent["joints"] == {"pan": 20.0}
        sent = await rig.do("home", seconds=0.2)
        assert sent["joints"] == {"pan": 0.0, "tilt": 5.0, "roll": 0.0}


async def test_gaze_follows_the_latest_target_and_nudge_adds_up(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, pan="pan", tilt="tilt", torque=True) as rig:
        await until(lambda: rig.bus.servo(12).torque)
        await rig.do("gaze", yaw=40.0, pitch=0.0)
        sent = await rig.do("gaze", yaw=-20.0, pitch=99.0)
        assert sent["joints"] == {"pan": -20.0, "tilt": 30.0}
        assert sent["clamped"] == {"tilt": 99.0}
        await until(lambda: rig.bus.servo(11).goal == 2048 + round(-20 / (360 / 4096)))
        await rig.do("nudge", yaw=2.0)
        assert (await rig.do("nudge", yaw=2.0))["joints"] == {"pan": -16.0}
        await until(lambda: rig.bus.servo(11).goal == 2048 + round(-16 / (360 / 4096)))
        goals = rig.bus.goals(11)
        assert max(abs(b - a) for a, b in itertools.pairwise(goals)) <= STEP


async def test_a_gaze_takes_its_joint_out_of_a_running_pose(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, pan="pan", torque=True) as rig:
        await until(lambda: rig.bus.servo(13).torque)
        running = rig.begin("pose", joints={"pan": 80.0, "roll": 20.0}, seconds=5.0)
        await until(lambda: rig.bus.goals(11)[-1] > 2060)
        await rig.do("gaze", yaw=0.0)
        sent = await running
        assert sent["taken_over"] == ["pan"]
        assert rig.bus.servo(13).goal == 2048 - round(20 / (360 / 4096))
        await until(lambda: rig.bus.servo(11).goal == 2048)


async def test_stop_holds_where_the_servo_is(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed) as rig:
        await rig.do("torque", on=True)
        running = rig.begin("pose", joints={"pan": 80.0}, seconds=20.0)
        await until(lambda: rig.bus.servo(11).position > 1710)
        await rig.driver.stop(Scope.ALL)
        await rig.ticks(1)
        held = rig.bus.goals(11)[-1]
        with pytest.raises(DriverError, match="stopped"):
            await running
        await rig.ticks(10)
        assert rig.bus.goals(11)[-1] == held
        assert abs(rig.bus.servo(11).position - held) < 1
        assert held < 2000
        assert rig.bus.servo(11).torque


async def test_stop_of_driving_leaves_gestures_alone(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        running = rig.begin("pose", joints={"pan": 20.0}, seconds=0.3)
        await rig.driver.stop(Scope.DRIVE)
        assert (await running)["joints"] == {"pan": 20.0}


async def test_a_cancelled_move_stands_still(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        running = rig.begin("pose", joints={"pan": 80.0}, seconds=5.0)
        await until(lambda: rig.bus.goals(11)[-1] > 2050)
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
        await rig.ticks(2)
        here = rig.bus.goals(11)[-1]
        await rig.ticks(10)
        assert rig.bus.goals(11)[-1] == here


async def test_rest_moves_slowly_and_then_goes_limp(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, rest_on_close=True, rest_speed=100.0) as rig:
        await until(lambda: rig.bus.servo(12).torque)
        await rig.driver.rest()
        # A motor that got its last goals late, on a busy machine, is limp a little before it.
        assert rig.bus.servo(12).position == pytest.approx(2048 + 20 / (360 / 4096), abs=60)
        assert not any(rig.bus.servo(number).torque for number in (11, 12, 13))


async def test_who_wants_no_rest_pose_gets_none(tmp_path: Path) -> None:
    async with connected_servos(
        tmp_path, torque=True, rest_on_close=False, rest_speed=100.0
    ) as rig:
        await until(lambda: rig.bus.servo(12).torque)
        before = rig.bus.servo(12).position
        await rig.driver.rest()
        assert rig.bus.servo(12).position == pytest.approx(before, abs=2)
        assert not any(rig.bus.servo(number).torque for number in (11, 12, 13))


async def test_close_rests_unless_the_robot_was_stopped(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    for folder, stopped in (("a", False), ("b", True)):
        async with connected_servos(
            tmp_path / folder, torque=True, rest_on_close=True, rest_speed=200.0
        ) as rig:
            await until(lambda bus=rig.bus: bus.servo(12).torque)  # type: ignore[misc]
            if stopped:
                await rig.driver.stop(Scope.ALL)
            await rig.driver.close()
            moved = rig.bus.servo(12).position > 2100
            assert moved is not stopped
            assert not rig.bus.servo(12).torque
            with pytest.raises(DeviceLostError):
                await rig.do("home")


async def test_readings_come_at_a_tenth_of_a_second(tmp_path: Path) -> None:
    began = time.monotonic()
    async with connected_servos(tmp_path) as rig:
        await rig.published.until(lambda: len(rig.published.values("joint.pan")) >= 20)
        assert rig.published.values("joint.pan")[:20] == [0.0] * 20
        # One for every tick would be 50 a second.
        most = (time.monotonic() - began) / 0.1 + 1
        assert len(rig.published.values("setpoint.pan")) <= most
        await rig.published.until(lambda: bool(rig.published.values("load.roll")))
        assert rig.published.values("voltage.pan")[0] == pytest.approx(5.0)
        assert rig.published.values("temperature.tilt")[0] == 32.0
        for sensor in ("joint.pan", "load.roll"):
            assert sensor in type(rig.driver).offer(rig.driver.settings).sensors


async def test_protocol_1_moves_and_never_writes_a_goal_while_limp(tmp_path: Path) -> None:
    joints = {
        "pan": ServoJointSettings(id=1, min=-90, max=90, speed=200, model="MX-28"),
        "tilt": ServoJointSettings(id=2, min=-40, max=30, speed=200, model="RX-64"),
    }
    async with connected_servos(
        tmp_path, ids={1: "MX-28", 2: "RX-64"}, protocol=1, joints=joints
    ) as rig:
        await rig.ticks(5)
        # Writing a goal would switch the torque on by itself in this family.
        assert rig.bus.goals(1) == [] and not rig.bus.servo(1).torque
        await rig.do("torque", on=True)
        sent = await rig.do("pose", joints={"pan": 20.0, "tilt": -10.0}, seconds=0.3)
        assert sent["joints"] == {"pan": 20.0, "tilt": -10.0}
        assert rig.bus.goals(1)[-1] == 2048 + round(20 / (360 / 4096))
        assert rig.bus.goals(2)[-1] == 512 - round(10 / (300 / 1024))
        await rig.published.until(lambda: bool(rig.published.values("temperature.tilt")))
        assert rig.published.values("voltage.pan")[0] == pytest.approx(12.0)
        with pytest.raises(RejectedError, match="cannot be restarted"):
            await rig.do("reboot")
