"""Dynamixel servos on one wire: from a wizard's verb to goal registers, 50 times a second.

`driver` takes verbs and speaks asyncio; `loop` is the one thread that owns the port; `chain` is
what that thread does with the servos; `motion` plans and bounds setpoints and knows no wire;
`wire` and `port` are the SDK made safe; `doctor` looks without moving.
"""

from woz_drivers.dynamixel.driver import DynamixelServos
from woz_drivers.dynamixel.settings import ServoJointSettings, ServoSettings

__all__ = ["DynamixelServos", "ServoJointSettings", "ServoSettings"]
