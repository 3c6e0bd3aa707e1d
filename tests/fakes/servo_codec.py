"""Dynamixel packets, protocols 1 and 2, written from the published protocol descriptions.

Independent of the SDK that the driver uses, so that the two check each other: the CRC here is
computed bit by bit, the SDK's comes from a table.
"""

from __future__ import annotations

from dataclasses import dataclass

BROADCAST = 0xFE

PING, READ, WRITE, REG_WRITE, ACTION, REBOOT = 0x01, 0x02, 0x03, 0x04, 0x05, 0x08
STATUS, SYNC_READ, SYNC_WRITE = 0x55, 0x82, 0x83

HEADER_1 = b"\xff\xff"
HEADER_2 = b"\xff\xff\xfd\x00"


@dataclass(frozen=True, slots=True)
class Instruction:
    """One packet from the master. `intact`: checksum or CRC was right."""

    servo: int
    code: int
    params: bytes
    intact: bool = True


def crc16(data: bytes) -> int:
    """CRC-16 with polynomial 0x8005, start 0, nothing reflected (CRC-16/UMTS)."""
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x8005 if crc & 0x8000 else crc << 1
            crc &= 0xFFFF
    return crc


def stuff(data: bytes) -> bytes:
    """Put an FD after each FF FF FD, so that no header can appear inside a packet."""
    return data.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")


def unstuff(data: bytes) -> bytes:
    """Undo `stuff`."""
    return data.replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")


def packet_2(servo: int, code: int, params: bytes) -> bytes:
    """A protocol 2 packet, instruction or status."""
    body = stuff(bytes([code]) + params)
    head = HEADER_2 + bytes([servo]) + (len(body) + 2).to_bytes(2, "little")
    return head + body + crc16(head + body).to_bytes(2, "little")


def status_2(servo: int, error: int, params: bytes = b"") -> bytes:
    """A protocol 2 status packet."""
    return packet_2(servo, STATUS, bytes([error]) + params)


def packet_1(servo: int, code: int, params: bytes) -> bytes:
    """A protocol 1 packet; in a status packet `code` is the error byte."""
    body = bytes([servo, len(params) + 2, code]) + params
    return HEADER_1 + body + bytes([~sum(body) & 0xFF])


class Reader:
    """Finds instructions in a stream of bytes; noise between them is skipped."""

    def __init__(self, protocol: int) -> None:
        self._protocol = protocol
        self._buffer = b""

    def feed(self, data: bytes) -> list[Instruction]:
        """Every packet that `data` completes."""
        self._buffer += data
        found = []
        while (packet := self._next()) is not None:
            found.append(packet)
        return found

    def _next(self) -> Instruction | None:
        header = HEADER_1 if self._protocol == 1 else HEADER_2
        start = self._buffer.find(header)
        if start < 0:
            self._buffer = self._buffer[-3:]
            return None
        self._buffer = self._buffer[start:]
        return self._next_1() if self._protocol == 1 else self._next_2()

    def _next_1(self) -> Instruction | None:
        if len(self._buffer) < 4 or len(self._buffer) < self._buffer[3] + 4:
            return None
        whole = self._buffer[: self._buffer[3] + 4]
        self._buffer = self._buffer[len(whole) :]
        intact = len(whole) >= 6 and (~sum(whole[2:-1]) & 0xFF) == whole[-1]
        return Instruction(whole[2], whole[4] if len(whole) > 4 else 0, whole[5:-1], intact)

    def _next_2(self) -> Instruction | None:
        if len(self._buffer) < 7:
            return None
        length = int.from_bytes(self._buffer[5:7], "little") + 7
        if len(self._buffer) < length:
            return None
        whole, self._buffer = self._buffer[:length], self._buffer[length:]
        intact = len(whole) >= 10 and crc16(whole[:-2]) == int.from_bytes(whole[-2:], "little")
        body = unstuff(whole[7:-2])
        return Instruction(whole[4], body[0] if body else 0, body[1:], intact)
