"""One emulated servo: its control table, its motor, its alarms, its bus watchdog.

Addresses are written out here a second time on purpose: a wrong one in the driver's tables must
not be wrong in the emulator as well.
"""

from __future__ import annotations

from dataclasses import dataclass, field

#: Error numbers of protocol 2 status packets.
ACCESS, RANGE, LIMIT, LENGTH = 7, 4, 6, 5
ALERT = 0x80
#: Error bits of protocol 1.
P1_VOLTAGE, P1_ANGLE, P1_HEAT, P1_RANGE, P1_OVERLOAD = 0x01, 0x02, 0x04, 0x08, 0x20
#: Hardware error bits of the X series.
OVERLOAD, OVERHEAT, VOLTAGE = 0x20, 0x04, 0x01

#: model name -> (protocol, model number, position counts, degrees of travel)
KINDS = {
    "XL330-M288": (2, 1200, 4096, 360.0),
    "XL330-M077": (2, 1190, 4096, 360.0),
    "XC330-T288": (2, 1220, 4096, 360.0),
    "XL430-W250": (2, 1060, 4096, 360.0),
    "XM430-W350": (2, 1020, 4096, 360.0),
    "XM540-W270": (2, 1120, 4096, 360.0),
    "MX-28": (1, 29, 4096, 360.0),
    "MX-64": (1, 310, 4096, 360.0),
    "RX-64": (1, 64, 1024, 300.0),
    "AX-12A": (1, 12, 1024, 300.0),
}
#: The fastest an unlimited motor turns, in degrees a second (XL330-M288: 103 rev/min).
FASTEST = 618.0
#: From power on until it answers, in seconds.
BOOT_S = 0.15
#: Revolutions a minute in one count of a speed register.
X_RPM, MX_RPM, AX_RPM = 0.229, 0.114, 0.111


@dataclass(slots=True)
class Motor:
    """A servo on the wire. `position` is its angle in counts, a fraction between ticks."""

    number: int
    kind: str = "XL330-M288"
    position: float = -1.0
    memory: bytearray = field(default_factory=lambda: bytearray(256))
    silent: bool = False
    alarm: int = 0
    registered: tuple[int, bytes] | None = None
    #: Heard an instruction last at this time; None: never yet.
    heard: float | None = None
    booting_until: float = 0.0
    bites: int = 0
    #: The fastest it has turned by its own force, in degrees a second.
    driven: float = 0.0
    #: Its bus watchdog waits so many times as long as it is told to.
    patience: float = 1.0
    #: Something holds it: it stays where it is.
    stuck: bool = False
    #: Under an alarm it says that it takes the torque, and stays limp.
    pretends: bool = False

    def __post_init__(self) -> None:
        if self.position < 0:
            self.position = self.counts / 2
        self._factory()

    # -- what it is ------------------------------------------------------------------------------

    @property
    def protocol(self) -> int:
        """1 or 2."""
        return KINDS[self.kind][0]

    @property
    def model(self) -> int:
        """What it answers to a ping."""
        return KINDS[self.kind][1]

    @property
    def counts(self) -> int:
        """Positions in its travel."""
        return KINDS[self.kind][2]

    @property
    def degrees_per_count(self) -> float:
        """Degrees in one position count."""
        return KINDS[self.kind][3] / self.counts

    @property
    def torque(self) -> bool:
        """Whether it holds."""
        if self.protocol == 2:
            return self.memory[64] == 1
        return self.memory[24] == 1 and self.get(34, 2) > 0

    @property
    def return_level(self) -> int:
        """Its Status Return Level: 0 it answers pings, 1 reads too, 2 everything."""
        return self.memory[68 if self.protocol == 2 else 16]

    @property
    def goal(self) -> int:
        """Goal position in counts."""
        return self.get(116, 4) if self.protocol == 2 else self.get(30, 2)

    @property
    def watchdog(self) -> int:
        """Bus watchdog, -1 after it bit."""
        value = self.memory[98]
        return value - 256 if value > 127 else value

    def get(self, address: int, size: int) -> int:
        """A number in its memory; four bytes are signed."""
        data = bytes(self.memory[address : address + size])
        return int.from_bytes(data, "little", signed=size == 4)

    def put(self, address: int, size: int, value: int) -> None:
        """Set a number in its memory, past all checks."""
        self.memory[address : address + size] = value.to_bytes(size, "little", signed=value < 0)

    def _factory(self) -> None:
        if self.protocol == 2:
            self.put(0, 2, self.model)
            self.put(6, 1, 52)
            self.put(7, 1, self.number)
            self.put(9, 1, 250)
            self.put(11, 1, 3)
            self.put(48, 4, self.counts - 1)
            self.put(68, 1, 2)
            self.put(144, 2, 50)
            self.put(146, 1, 32)
        else:
            self.put(0, 2, self.model)
            self.put(3, 1, self.number)
            self.put(5, 1, 250)
            self.put(8, 2, self.counts - 1)
            self.put(16, 1, 2)
            self.put(14, 2, 1023)
            self.put(42, 1, 120)
            self.put(43, 1, 34)
        self._forget()

    def _forget(self) -> None:
        """What a power cycle does to the volatile part."""
        if self.protocol == 2:
            for address, size in ((64, 1), (70, 1), (98, 1), (108, 4), (112, 4)):
                self.put(address, size, 0)
            self.put(116, 4, round(self.position))
        else:
            for address, size in ((24, 1), (25, 1), (32, 2), (44, 1), (47, 1)):
                self.put(address, size, 0)
            self.put(30, 2, round(self.position))
            self.put(34, 2, self.get(14, 2))
        self.registered = None
        self._show()

    def _show(self) -> None:
        if self.protocol == 2:
            self.put(132, 4, round(self.position))
        else:
            self.put(36, 2, round(self.position))

    # -- time ------------------------------------------------------------------------------------

    def advance(self, now: float, elapsed: float) -> bool:
        """Move for `elapsed` seconds; says whether the watchdog bit just now."""
        bitten = self._watch(now)
        if self.torque and not self.stuck:
            way = self.goal - self.position
            step = self._speed() / self.degrees_per_count * elapsed
            moved = min(max(way, -step), step)
            self.position += moved
            if elapsed > 0:
                self.driven = max(self.driven, abs(moved) * self.degrees_per_count / elapsed)
            self._show()
        return bitten

    def _speed(self) -> float:
        if self.protocol == 2:
            limit, unit = self.get(112, 4), X_RPM * 6
        else:
            limit, unit = self.get(32, 2), (MX_RPM if self.kind.startswith("MX") else AX_RPM) * 6
        return min(limit * unit, FASTEST) if limit else FASTEST

    def _watch(self, now: float) -> bool:
        if self.protocol == 1 or self.watchdog <= 0 or not self.torque or self.heard is None:
            return False
        if now - self.heard <= self.watchdog * 0.020 * self.patience:
            return False
        # It stops where it is; from now on goals cannot be written until 98 is set to 0.
        self.put(98, 1, 255)
        self.put(116, 4, round(self.position))
        self.bites += 1
        return True

    # -- alarms ----------------------------------------------------------------------------------

    def raise_alarm(self, bits: int) -> None:
        """Shut down: no torque until a restart. Protocol 1 does it by a torque limit of 0."""
        self.alarm = bits
        if self.protocol == 2:
            self.put(70, 1, bits)
            self.put(64, 1, 0)
        else:
            self.put(34, 2, 0)

    def reboot(
        self, now: float, *, seconds: float = 0.0, boot: float = BOOT_S, fall: float = 0.0
    ) -> None:
        """Restart after `seconds` without power; it answers again `boot` seconds after that.

        Limp meanwhile, it sags by `fall` counts. One that counts turns has forgotten them.
        """
        self.alarm = 0
        self.booting_until = now + seconds + boot
        self.position += fall
        if self.protocol == 2 and self.memory[11] in (4, 5):
            self.position %= self.counts
        self.position = min(max(self.position, 0.0), self.counts - 1.0)
        self._forget()

    def error_byte(self, code: int = 0) -> int:
        """What its status packets say: an error number and the alert bit, or the alarm bits."""
        if self.protocol == 2:
            return code | (ALERT if self.alarm else 0)
        return code | self.alarm

    # -- registers -------------------------------------------------------------------------------

    def write(self, address: int, data: bytes) -> int:
        """Write as an instruction would; returns the error it answers with (0: taken)."""
        if self.pretends and self.alarm and address == 64:
            return 0
        refused = self._refusal(address, data)
        if refused:
            return refused
        if self.protocol == 2 and address == 64 and data[:1] == b"\x01" and not self.torque:
            if self.memory[11] == 3 and (offset := self.get(20, 4)):
                # As seen by its owner (ROBOTIS forum, thread 7814): it counts from its sensor anew.
                self.position = (self.position - offset) % self.counts + offset
                self._show()
            self.put(116, 4, round(self.position))  # torque on never jumps: goal = present
        self.memory[address : address + len(data)] = data
        if self.protocol == 1 and address <= 30 < address + len(data):
            self.put(24, 1, 1)  # a goal switches the torque on
        return 0

    def _refusal(self, address: int, data: bytes) -> int:
        touched = range(address, address + len(data))
        return (
            self._refusal_1(touched, data) if self.protocol == 1 else self._refusal_2(touched, data)
        )

    def _refusal_1(self, touched: range, data: bytes) -> int:
        if 24 in touched and self.alarm and data[24 - touched.start]:
            return P1_OVERLOAD
        goal = int.from_bytes(data[:2], "little") if touched.start == 30 else self.get(6, 2)
        return 0 if self.get(6, 2) <= goal <= self.get(8, 2) else P1_ANGLE

    def _refusal_2(self, touched: range, data: bytes) -> int:
        if any(place < 64 for place in touched) and (self.torque or 0 in touched):
            return ACCESS
        if any(place in (70, *range(120, 148)) for place in touched):
            return ACCESS
        if 64 in touched and data[64 - touched.start] and self.alarm:
            return ACCESS
        return self._goal_refusal(touched, data)

    def _goal_refusal(self, touched: range, data: bytes) -> int:
        goals = (*range(100, 108), *range(116, 120))
        if not any(place in goals for place in touched):
            return 0
        if self.watchdog < 0:
            return RANGE
        if touched.start == 116 and self.memory[11] == 3:
            goal = int.from_bytes(data[:4], "little", signed=True)
            return 0 if self.get(52, 4) <= goal <= self.get(48, 4) else LIMIT
        return 0
