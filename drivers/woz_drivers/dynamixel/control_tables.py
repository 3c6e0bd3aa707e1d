"""Control tables of the servos, as data.

A table says at which address a servo keeps what; a model says how its numbers are meant. Addresses,
sizes, model numbers and units are those of the control tables that ROBOTIS publishes for each
model (emanual.robotis.com, sections "Control Table" and "Specifications").
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

#: Degrees a second in one revolution a minute.
DEG_S_PER_RPM = 6.0


@dataclass(frozen=True, slots=True)
class Register:
    """A place in a control table: first address and size in bytes, little-endian."""

    address: int
    size: int
    signed: bool = False

    @property
    def end(self) -> int:
        """The address after its last byte."""
        return self.address + self.size

    def decode(self, data: bytes) -> int:
        """The number in `data`, which holds exactly `size` bytes."""
        if len(data) != self.size:
            raise ValueError(f"{len(data)} bytes for a register of {self.size}")
        return int.from_bytes(data, "little", signed=self.signed)

    def within(self, block: Register, data: bytes) -> int:
        """The number at this place in `data`, which was read from the longer stretch `block`."""
        first = self.address - block.address
        return self.decode(data[first : first + self.size])

    def encode(self, value: int) -> bytes:
        """The bytes of `value`; `OverflowError` if it does not fit."""
        return value.to_bytes(self.size, "little", signed=self.signed)


@dataclass(frozen=True, slots=True)
class ControlTable:
    """The registers this driver uses; None where a family has no such register.

    `speed_limit` bounds the servo's own speed on its way to a goal: Profile Velocity in the X
    series, Moving Speed in protocol 1.

    `torque_limit` gets the value of `max_torque`, which is stored, whenever the power comes on.
    """

    name: str
    protocol: int
    firmware: Register
    return_delay: Register
    return_level: Register
    low_limit: Register
    high_limit: Register
    torque: Register
    goal: Register
    speed_limit: Register
    present: Register
    load: Register
    voltage: Register
    temperature: Register
    operating_mode: Register | None = None
    homing_offset: Register | None = None
    drive_mode: Register | None = None
    alarm: Register | None = None
    watchdog: Register | None = None
    startup: Register | None = None
    max_torque: Register | None = None
    torque_limit: Register | None = None
    #: Protocol 1 keeps the sign of the load in bit 10 instead of two's complement.
    load_sign_bit: int | None = None

    def status_block(self) -> Register:
        """Torque to watchdog (X series) or to present position (protocol 1), read in one go."""
        return _stretch(self.torque, self.watchdog or self.present)

    def sensor_block(self) -> Register:
        """The stretch from load to temperature, read in one go."""
        return _stretch(self.load, self.temperature)

    def goal_block(self) -> Register:
        """What a setpoint is written to. In protocol 1 a goal switches the torque on, also of a
        servo that lost its power a moment ago: there its speed limit goes into the same packet.
        """
        return self.goal if self.protocol == 2 else _stretch(self.goal, self.speed_limit)


def _stretch(first: Register, last: Register) -> Register:
    return Register(first.address, last.end - first.address)


@dataclass(frozen=True, slots=True)
class ServoModel:
    """One servo model.

    Attributes:
        name: As printed on it, without the connector letter.
        number: What it answers to a ping.
        table: Where it keeps what.
        steps: Positions in `travel` degrees; the highest goal is `steps - 1`.
        travel: Degrees that the position sensor covers.
        speed_unit: Degrees a second in one count of the speed limit.
        full_load: Counts of the load register that are 100 %: the highest Current Limit (38) where
            the servo measures a current, the whole torque where it estimates a load.
    """

    name: str
    number: int
    table: ControlTable
    steps: int
    travel: float
    speed_unit: float
    full_load: float

    @property
    def degrees_per_step(self) -> float:
        """Degrees in one position count."""
        return self.travel / self.steps

    @property
    def centre(self) -> int:
        """The position count in the middle."""
        return self.steps // 2


X_SERIES = ControlTable(
    name="X",
    protocol=2,
    firmware=Register(6, 1),
    return_delay=Register(9, 1),
    return_level=Register(68, 1),
    drive_mode=Register(10, 1),
    operating_mode=Register(11, 1),
    homing_offset=Register(20, 4, signed=True),
    high_limit=Register(48, 4, signed=True),
    low_limit=Register(52, 4, signed=True),
    startup=Register(60, 1),
    torque=Register(64, 1),
    alarm=Register(70, 1),
    watchdog=Register(98, 1, signed=True),
    speed_limit=Register(112, 4),
    goal=Register(116, 4, signed=True),
    load=Register(126, 2, signed=True),
    present=Register(132, 4, signed=True),
    voltage=Register(144, 2),
    temperature=Register(146, 1),
)

PROTOCOL_1 = ControlTable(
    name="MX/RX/AX, protocol 1",
    protocol=1,
    firmware=Register(2, 1),
    return_delay=Register(5, 1),
    return_level=Register(16, 1),
    low_limit=Register(6, 2),
    high_limit=Register(8, 2),
    max_torque=Register(14, 2),
    torque=Register(24, 1),
    goal=Register(30, 2),
    speed_limit=Register(32, 2),
    torque_limit=Register(34, 2),
    present=Register(36, 2),
    load=Register(40, 2),
    voltage=Register(42, 1),
    temperature=Register(43, 1),
    load_sign_bit=10,
)

#: Operating Mode (11) of the X series: position, extended position, current-based position.
POSITION_MODES = (3, 4, 5)
EXTENDED_MODES = (4, 5)
#: Status Return Level: a servo answers pings alone, reads as well, everything.
ANSWERS_PINGS, ANSWERS_READS, ANSWERS_ALL = 0, 1, 2
#: Drive Mode (10), bit 2: Profile Velocity counts milliseconds instead of a speed.
TIME_PROFILE_BIT = 0x04
#: Startup Configuration (60), bit 0: torque on with the power; bit 1: what was saved of the rest,
#: such as the goal, comes back. From firmware 45 on, 46 in the 330 size; without it nothing is set.
TORQUE_AT_START_BIT, RESTORE_BIT = 0x01, 0x02
#: Bus Watchdog (98): milliseconds a count, highest count, and what it reads once it has bitten.
WATCHDOG_UNIT_MS = 20
WATCHDOG_MAX = 127
WATCHDOG_BITTEN = -1
#: Voltage registers of all families count tenths of a volt.
VOLT = 0.1

#: Hardware Error Status (70) of the X series.
X_ALARMS: Mapping[int, str] = MappingProxyType(
    {
        0x01: "input voltage out of range",
        0x04: "overheated",
        0x08: "encoder fault",
        0x10: "electrical shock or too little power",
        0x20: "overload",
    }
)
#: Error byte of every protocol 1 status packet; only the bits that speak of the hardware.
PROTOCOL_1_ALARMS: Mapping[int, str] = MappingProxyType(
    {0x01: "input voltage out of range", 0x04: "overheated", 0x20: "overload"}
)


def _x(name: str, number: int, full_load: float) -> ServoModel:
    return ServoModel(name, number, X_SERIES, 4096, 360.0, 0.229 * DEG_S_PER_RPM, full_load)


def _mx(name: str, number: int) -> ServoModel:
    return ServoModel(name, number, PROTOCOL_1, 4096, 360.0, 0.114 * DEG_S_PER_RPM, 1023)


def _ax(name: str, number: int) -> ServoModel:
    return ServoModel(name, number, PROTOCOL_1, 1024, 300.0, 0.111 * DEG_S_PER_RPM, 1023)


MODELS: tuple[ServoModel, ...] = (
    _x("XL330-M077", 1190, 1750),
    _x("XL330-M288", 1200, 1750),
    _x("XC330-T181", 1210, 910),
    _x("XC330-T288", 1220, 910),
    _x("XC330-M181", 1230, 2352),
    _x("XC330-M288", 1240, 2352),
    _x("XL430-W250", 1060, 1000),
    _x("2XL430-W250", 1090, 1000),
    _x("XC430-W150", 1070, 1000),
    _x("XC430-W240", 1080, 1000),
    _x("XM430-W350", 1020, 1193),
    _x("XM430-W210", 1030, 1193),
    _x("XM540-W270", 1120, 2047),
    _x("XM540-W150", 1130, 2047),
    _mx("MX-28", 29),
    _mx("MX-64", 310),
    _mx("MX-106", 320),
    _ax("AX-12A", 12),
    _ax("AX-18A", 18),
    _ax("RX-24F", 24),
    _ax("RX-28", 28),
    _ax("RX-64", 64),
)

_BY_NUMBER = {(model.table.protocol, model.number): model for model in MODELS}
_BY_NAME = {model.name.lower(): model for model in MODELS}


def by_number(protocol: int, number: int) -> ServoModel | None:
    """The model that answers a ping with `number`, or None."""
    return _BY_NUMBER.get((protocol, number))


def by_name(name: str) -> ServoModel | None:
    """The model called `name`, whatever its case and its connector letter (`-T`, `-R`)."""
    wanted = name.strip().lower()
    found = _BY_NAME.get(wanted)
    if found is None and wanted.endswith(("-t", "-r")):
        found = _BY_NAME.get(wanted[:-2])
    return found


def alarms(table: ControlTable, bits: int) -> list[str]:
    """The names of the alarms set in `bits`."""
    names = X_ALARMS if table.protocol == 2 else PROTOCOL_1_ALARMS
    return [name for bit, name in names.items() if bits & bit]
