"""How warm the motors are, and which of them get weaker because of it.

A motor that is hot is given less current, until it is switched off: status 1, 2 and 3 of its
temperature (family/nao_technical/dcm of NAOqi 2.8). Standing and crouching heat the legs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from woz_drivers.nao.joints import LEGS, UPPER
from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.joint_table import HANDS
from woz_tui.drivers.contract import DriverContext

SENSOR = "temperature"
#: It is asked for so seldom, in seconds: nothing gets warm faster.
EVERY_S = 2.0
#: What a status means; 0 is well.
STATES = ("", "hot", "very hot", "critically hot")
#: What no motor's sensor says while it works, in degrees Celsius.
_SANE_C = (-20.0, 150.0)
_KEY = "Device/SubDeviceList/{}/Temperature/Sensor/{}"
#: RHipYawPitch has the motor of LHipYawPitch.
MOTORS = tuple(one for one in (*UPPER, *LEGS) if one not in (*HANDS, "RHipYawPitch"))
REMEDY = "let it sit, or rest with `torque: off`, until the motors are cooler"
#: Charge below which the wizard is told, once for each.
LOW = (0.2, 0.1)


def keys() -> list[str]:
    """What is asked for: temperature and status of each motor, and the battery."""
    motors = [_KEY.format(joint, what) for what in ("Value", "Status") for joint in MOTORS]
    return [*motors, memory.BATTERY]


class MotorWatch:
    """Tells the temperature of the hottest motor, and warns of hot ones and of a low battery."""

    def __init__(self, context: DriverContext) -> None:
        self._context = context
        self._status: dict[str, int] = {}
        self._charge = 1.0

    def forget(self) -> None:
        """It may be another robot."""
        self._status, self._charge = {}, 1.0

    def conflicts(self) -> Iterator[str]:
        """One sentence while motors are hot."""
        hot = [joint for joint, status in self._status.items() if status]
        if hot:
            yield f"motors are hot: {', '.join(hot)} get weaker; {REMEDY}"

    def take(self, values: Mapping[str, Any]) -> None:
        """What ALMemory says now."""
        self._take_charge(memory.battery(values.get(memory.BATTERY)))
        celsius = {
            joint: found
            for joint in MOTORS
            if (found := memory.within(values.get(_KEY.format(joint, "Value")), *_SANE_C))
            is not None
        }
        if not celsius:
            self._context.sensor(SENSOR, "stale", "the robot does not say how warm its motors are")
            self._context.reading(SENSOR, None)
        else:
            self._context.sensor(SENSOR, "ok", every=EVERY_S)
            self._context.reading(SENSOR, round(max(celsius.values()), 1), unit="C")
        status = {
            joint: int(memory.within(values.get(_KEY.format(joint, "Status")), 0, 3) or 0)
            for joint in MOTORS
        }
        hotter = {one: now for one, now in status.items() if now > self._status.get(one, 0)}
        self._warn(hotter, celsius)
        self._status = status

    def _warn(self, hotter: Mapping[str, int], celsius: Mapping[str, float]) -> None:
        """One sentence for all motors that are hotter now than they were."""
        if not hotter:
            return
        named = ", ".join(
            f"{joint} is {STATES[status]}"
            + (f" ({celsius[joint]:.0f} degrees)" if joint in celsius else "")
            for joint, status in hotter.items()
        )
        off = "; it is switched off now" if max(hotter.values()) == 3 else ""
        text = f"{named}: the motor gets weaker{off}"
        self._context.notice("warning", text, REMEDY, tells=(SENSOR,))

    def _take_charge(self, charge: float | None) -> None:
        if charge is None:
            return
        if any(charge < limit <= self._charge for limit in LOW):
            text = f"NAO's battery is at {charge * 100:.0f} %"
            self._context.notice("warning", text, "plug its charger in", tells=("battery",))
        self._charge = charge
