"""Servos that lose their power for a moment: what they forget must never make them leap.

A protocol 1 servo that restarted switches its torque on again with the next goal it gets, and its
speed limit is gone. An X-series servo stays limp, but has forgotten its speed limit as well.
"""

from __future__ import annotations

import asyncio
import contextlib
import tempfile
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from woz_drivers.dynamixel import ServoJointSettings
from woz_drivers.dynamixel.chain import PlannedMove, ServoChain
from woz_drivers.dynamixel.port import ServoPort
from woz_drivers.dynamixel.setpoint_planning import Keyframe
from woz_drivers.dynamixel.wire import ServoWire

from tests.drivers.published_messages import PATIENCE_S, PublishedMessages, until
from tests.drivers.servo_rig import SILENT_MS, connected_servos, head
from tests.example_counts import many
from tests.fakes.servo_motor import OVERLOAD
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import Notice

SPEED = 60.0
#: Speed limits are rounded up to one count of their register, positions to one count a tick.
ROUNDING = 1.4 + 0.3 / 0.02
TICK = 0.02
MODELS = {1: {1: "MX-28", 2: "AX-12A"}, 2: {1: "XL330-M288", 2: "XM430-W350"}}
JOINTS = {
    "pan": ServoJointSettings(id=1, min=-90, max=90, speed=SPEED),
    "tilt": ServoJointSettings(id=2, min=-90, max=90, speed=SPEED),
}


async def test_a_brownout_in_a_move_leaves_a_protocol_1_joint_limp(tmp_path: Path) -> None:
    joints = {"pan": JOINTS["pan"]}
    async with connected_servos(
        tmp_path, ids={1: "MX-28"}, protocol=1, joints=joints, torque=True
    ) as rig:
        servo = rig.bus.servo(1)
        await until(lambda: servo.torque)
        running = rig.begin("pose", joints={"pan": 80.0}, seconds=20.0)
        await until(lambda: servo.position > 2060)
        rig.bus.brownout(1, boot=0.0, fall=-650.0)
        with pytest.raises(DriverError, match="lost its torque"):
            await running
        await rig.noticed("pan (id 1) lost its torque")
        (notice,) = (one for one in rig.published.all(Notice) if "lost its torque" in one.text)
        assert "power" in notice.remedy and "cool" not in notice.remedy
        await until(lambda: not servo.torque)  # a goal may have been under way to it
        fallen = servo.position
        await rig.ticks(5)
        assert not servo.torque and servo.position == fallen
        assert servo.driven <= SPEED + ROUNDING
        with pytest.raises(RejectedError, match="torque of pan is off"):
            await rig.do("pose", joints={"pan": 0.0})

        await rig.do("torque", on=True)
        assert abs(rig.bus.goals(1)[-1] - fallen) <= 1
        await rig.do("pose", joints={"pan": 0.0}, seconds=0.0)
        await until(lambda: abs(servo.position - 2048) < 1)
        assert servo.driven <= SPEED + ROUNDING
        assert 0 < servo.get(32, 2) * 0.114 * 6 <= SPEED + ROUNDING


async def test_an_x_servo_that_restarted_gets_its_speed_limit_back(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        servo = rig.bus.servo(11)
        await until(lambda: servo.torque)
        limit = servo.get(112, 4)
        assert limit > 0
        rig.bus.brownout(11, boot=0.0)
        await rig.noticed("pan (id 11) lost its torque")
        await rig.ticks(3)
        assert not servo.torque and servo.get(112, 4) == 0
        await rig.do("torque", on=True)
        assert rig.bus.servo(11).torque
        assert servo.get(112, 4) == limit


async def test_a_protocol_1_servo_that_shut_down_is_not_said_to_hold(tmp_path: Path) -> None:
    joints = {"pan": JOINTS["pan"]}
    async with connected_servos(
        tmp_path, ids={1: "MX-28"}, protocol=1, joints=joints, torque=True
    ) as rig:
        await until(lambda: rig.bus.servo(1).torque)
        rig.bus.servo(1).raise_alarm(OVERLOAD)
        await rig.noticed("lost its torque (overload)")
        with pytest.raises(DriverError, match="torque limit"):
            await rig.do("torque", on=True)
        rig.bus.brownout(1, boot=0.0)
        await rig.do("torque", on=True)
        assert rig.bus.servo(1).torque


BROWNOUT = st.fixed_dictionaries(
    {
        "tick": st.integers(0, 24),
        "number": st.sampled_from((1, 2)),
        "after": st.integers(0, 7),
        "seconds": st.sampled_from((0.0, 0.0, 0.01, 0.05)),
        "boot": st.sampled_from((0.0, 0.0, 0.005, 0.017, 0.03, 0.15)),
        "fall": st.sampled_from((0.0, -150.0, 150.0)),
    }
)
#: Between reading where it is and writing where to go: nothing was amiss when it was looked at.
UNSEEN = {"tick": 20, "number": 2, "after": 2, "seconds": 0.0, "boot": 0.0, "fall": -150.0}
#: Back before the next look.
AT_ONCE = {"tick": 9, "number": 1, "after": 0, "seconds": 0.0, "boot": 0.0, "fall": -150.0}


class CountingPort(ServoPort):
    """Counts what it sends: the emulated time stands still until all of it has arrived."""

    packets = 0

    def writePort(self, packet: list[int]) -> int:  # noqa: N802
        self.packets += 1
        return super().writePort(packet)


@dataclass
class MovingServos:
    """Two servos in a move, in a time of their own that passes tick by tick."""

    bus: ServoBus
    port: CountingPort
    chain: ServoChain
    now: float = 0.0

    async def tick(self) -> None:
        """Let time pass, and wait until the servos have heard all that was sent."""
        self.now += TICK
        self.chain.tick(self.now)
        async with asyncio.timeout(PATIENCE_S):
            while len(self.bus.instructions) < self.port.packets:  # noqa: ASYNC110 - a thread
                await asyncio.sleep(0.0002)


@contextlib.asynccontextmanager
async def moving(folder: Path, protocol: int) -> AsyncIterator[MovingServos]:
    """Servos that are switched on and on their way to 60 and -50 degrees."""
    values = head(folder / "servos", joints=JOINTS, protocol=protocol)
    port = CountingPort(values.port, values.baud, values.reply_timeout)
    chain = ServoChain(ServoWire(port, protocol), values, PublishedMessages(folder).context)
    bus = ServoBus(MODELS[protocol], folder / "servos")
    rig = MovingServos(bus, port, chain)
    bus.clock = lambda: rig.now
    with bus:
        port.open()
        try:
            chain.connect()
            assert chain.set_torque(JOINTS, on=True) == {}
            chain.begin(PlannedMove(), [Keyframe({"pan": 60.0, "tilt": -50.0}, 1.2)], 0.0)
            yield rig
        finally:
            chain.wire.close()


@pytest.mark.toolkit("R4")
@pytest.mark.parametrize("protocol", [1, 2])
@settings(max_examples=many(15, 300))
@given(brownouts=st.lists(BROWNOUT, min_size=1, max_size=3))
@example(brownouts=[UNSEEN])
@example(brownouts=[AT_ONCE])
def test_no_joint_is_faster_than_its_limit_or_holds_unbidden_after_a_brownout(
    protocol: int, brownouts: list[dict[str, float]]
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        asyncio.run(_brown_out(Path(folder), protocol, brownouts))


async def _brown_out(folder: Path, protocol: int, brownouts: list[dict[str, float]]) -> None:
    """A move of two joints, then torque on again."""
    async with moving(folder, protocol) as rig:
        # A look that takes longer on a busy machine has no answer; that must do no harm.
        rig.port.patience_ms = 30.0
        for tick in range(36):
            for entry in (one for one in brownouts if one["tick"] == tick):
                how = {key: entry[key] for key in ("seconds", "boot", "fall")}
                rig.bus.brownout(int(entry["number"]), int(entry["after"]), **how)
            await rig.tick()
        hit = [rig.bus.servo(number) for number in {int(entry["number"]) for entry in brownouts}]
        looks = 0
        while any(servo.torque for servo in hit):
            looks += 1
            assert looks < 500, "it holds, and nobody has switched it on"
            await rig.tick()
        rig.port.patience_ms = 2 * SILENT_MS
        before = [servo.position for servo in hit]
        rig.chain.set_torque(JOINTS, on=True)
        for _ in range(5):
            await rig.tick()
        for servo, position in zip(hit, before, strict=True):
            assert abs(servo.position - position) <= 1.0, "it left the pose it was in"
        for servo in rig.bus.servos.values():
            assert servo.driven <= SPEED + ROUNDING, f"{servo.driven:.0f} degrees a second"


async def test_no_goal_goes_to_a_protocol_1_servo_that_may_just_be_starting(
    tmp_path: Path,
) -> None:
    async with moving(tmp_path, 1) as rig:
        for _ in range(20):
            await rig.tick()
        assert rig.bus.servo(1).torque
        goals = len(rig.bus.goals(1))
        rig.bus.brownout(1, boot=0.0)
        rig.bus.faults.corrupt = 1  # nobody can read that its torque is off
        rig.port.patience_ms = 30.0
        await rig.tick()
        await rig.tick()
        assert len(rig.bus.goals(1)) == goals
