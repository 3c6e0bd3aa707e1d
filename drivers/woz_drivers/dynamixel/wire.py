"""Registers of servos, read and written through the SDK with its traps closed.

Every method may raise `DeviceLostError`; a servo that does not answer, or answers nonsense, is
None.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from dynamixel_sdk import GroupSyncRead, GroupSyncWrite, PacketHandler

from woz_drivers.dynamixel.control_tables import Register
from woz_drivers.dynamixel.port import AMPLE_MS, ServoPort, answer_timeout_ms

#: `dynamixel_sdk.robotis_def.COMM_SUCCESS`.
SUCCESS = 0
#: Any other result: no answer that can be understood.
GARBLED = -1
#: Bit of a protocol 2 error byte: look at Hardware Error Status.
ALERT = 0x80
#: What a protocol 2 servo says to a write it refuses.
REFUSALS = {
    1: "it failed",
    2: "unknown instruction",
    3: "garbled packet",
    4: "value out of range",
    5: "wrong length",
    6: "value beyond its limit",
    7: "not writable now",
}
#: A servo is asked so often when the time of its answers is measured: an adapter's timer runs on,
#: so one answer may by chance come at once.
MEASURED = 5
#: Ids tried one by one where the protocol has no broadcast ping.
USUAL_IDS = tuple(range(31))


@dataclass(frozen=True, slots=True)
class ServoAnswer:
    """A servo's answer: the bytes asked for, and its error byte as it came."""

    data: bytes
    error: int = 0


class ServoWire:
    """One open port and its protocol. Belongs to one thread."""

    def __init__(self, port: ServoPort, protocol: int) -> None:
        self.port = port
        self.protocol = protocol
        self._packets = PacketHandler(float(protocol))
        self._readers: dict[tuple[Register, tuple[int, ...]], GroupSyncRead] = {}

    def close(self) -> None:
        """Close the port; never raises."""
        self.port.closePort()

    def ping(self, servo: int) -> int | None:
        """The model number of servo `servo`, or None."""
        number, result, _ = self._call(self._packets.ping, servo, failed=(0, GARBLED, 0))
        return int(number) if result == SUCCESS else None

    def measure(self, servos: Iterable[int]) -> float | None:
        """Wait for answers as long as they take, from now on; blocks for half a second or so.

        Returns the longest time in milliseconds if it is more than was waited for before, else
        None, also if nobody answers.
        """
        port = self.port
        before = port.patience_ms
        if before >= AMPLE_MS:
            return None
        time.sleep(AMPLE_MS / 1000.0)  # what is still to come answers older questions
        port.patience_ms, port.longest_ms = AMPLE_MS, 0.0
        found = [servo for servo in servos if self.ping(servo) is not None]
        for _ in range(MEASURED - 1):
            for servo in found:
                self.ping(servo)
        port.patience_ms = before
        if not found or port.longest_ms <= before:
            return None
        port.patience_ms = answer_timeout_ms(port.longest_ms)
        return port.longest_ms

    def scan(self, also: Iterable[int] = ()) -> dict[int, int]:
        """Model numbers by id of everything that answers.

        Protocol 2 asks all 253 ids at once (0.8 s). Protocol 1 can only ask one by one: ids 0 to
        30 and those in `also`.
        """
        if self.protocol == 1:
            wanted = sorted({*USUAL_IDS, *also})
            answers = ((servo, self.ping(servo)) for servo in wanted)
            return {servo: number for servo, number in answers if number is not None}
        found, _ = self._call(self._packets.broadcastPing, failed=({}, GARBLED))
        return {int(servo): int(answer[0]) for servo, answer in found.items()}

    def read(self, servo: int, register: Register) -> ServoAnswer | None:
        """A register or a whole stretch of them."""
        data, result, error = self._call(
            self._packets.readTxRx, servo, register.address, register.size, failed=(b"", GARBLED, 0)
        )
        if result != SUCCESS or len(data) != register.size:
            return None
        return ServoAnswer(bytes(data), int(error))

    def number(self, servo: int, register: Register) -> int | None:
        """A register as a number."""
        answer = self.read(servo, register)
        return register.decode(answer.data) if answer is not None else None

    def read_group(self, servos: Iterable[int], register: Register) -> dict[int, int]:
        """The same register of several servos; those that did not answer are missing.

        Protocol 2 only. One servo that stays silent spoils a whole sync read, so the others are
        then asked one by one.
        """
        wanted = tuple(servos)
        if not wanted:
            return {}
        found = self._sync_read(wanted, register)
        for servo in wanted:
            if servo not in found:
                value = self.number(servo, register)
                if value is not None:
                    found[servo] = value
        return found

    def _sync_read(self, servos: tuple[int, ...], register: Register) -> dict[int, int]:
        reader = self._readers.get((register, servos))
        if reader is None:
            reader = GroupSyncRead(self.port, self._packets, register.address, register.size)
            for servo in servos:
                reader.addParam(servo)
            self._readers[register, servos] = reader
        try:
            reader.txRxPacket()
        except IndexError:
            self.port.is_using = False
            return {}
        found = {}
        for servo in servos:
            # Without this question the SDK answers 0 for everybody: a plausible position.
            if reader.isAvailable(servo, register.address, register.size):
                data = bytes(reader.data_dict[servo])
                if len(data) == register.size:
                    found[servo] = register.decode(data)
        return found

    def write(self, servo: int, register: Register, value: int) -> int | None:
        """Write and wait for the answer: its error byte (0 is well), None without an answer."""
        data = list(register.encode(value))
        result, error = self._call(
            self._packets.writeTxRx,
            *(servo, register.address, register.size, data),
            failed=(GARBLED, 0),
        )
        return int(error) if result == SUCCESS else None

    def write_group(self, register: Register, values: Mapping[int, int]) -> None:
        """Write one register of several servos in one packet, which nobody answers."""
        if not values:
            return
        writer = GroupSyncWrite(self.port, self._packets, register.address, register.size)
        for servo, value in values.items():
            writer.addParam(servo, list(register.encode(value)))
        writer.txPacket()

    def reboot(self, servo: int) -> bool:
        """Restart a servo (protocol 2 only); says whether it acknowledged."""
        result, _ = self._call(self._packets.reboot, servo, failed=(GARBLED, 0))
        return bool(result == SUCCESS)

    def _call(self, sdk: Callable[..., Any], *args: object, failed: Any) -> Any:
        """What a function of the SDK answers; `failed` if a garbled packet makes it stumble, after
        which it still believes the port to be in use.
        """
        try:
            return sdk(self.port, *args)
        except IndexError:
            self.port.is_using = False
            return failed


def refusal(error: int) -> str:
    """A protocol 2 error byte in words; empty if nothing was refused."""
    code = error & ~ALERT
    return REFUSALS.get(code, f"error {code}") if code else ""
