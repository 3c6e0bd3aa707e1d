"""Packets of a face of lights on a serial port: the same that `firmware/led_face/protocol.h` reads.

A packet is type, sequence number, payload and CRC-16, stuffed by COBS (Cheshire and Baker, 1999)
so that it holds no zero byte, and ended by a zero byte. A reader that lost its place finds it
again at the next zero.
"""

from __future__ import annotations

import binascii
from dataclasses import dataclass

from woz_tui.motion.light_frames import LightFrame

VERSION = 1

HELLO, FRAME = 0x01, 0x02
HERE, SHOWN, WRONG = 0x81, 0x82, 0x8F

#: Reasons in a packet `WRONG`.
REASONS = {1: "it does not know this type of packet", 2: "the frame has another size"}

#: Type, sequence number, CRC.
_LEAST = 4
#: A stuffed packet that is longer is noise.
_LONGEST = 4096


class DamagedPacketError(ValueError):
    """Bytes that are no packet; says why."""


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet; `number` (0..255) is repeated in the answer to it."""

    type: int
    number: int
    payload: bytes = b""

    def encoded(self) -> bytes:
        """What goes over the wire, with the zero byte at its end."""
        plain = bytes((self.type, self.number)) + self.payload
        return stuff(plain + crc16(plain).to_bytes(2, "big")) + b"\0"

    @classmethod
    def decoded(cls, stuffed: bytes) -> Packet:
        """The packet of these bytes, without the zero byte. Raises `DamagedPacketError`."""
        plain = unstuff(stuffed)
        if len(plain) < _LEAST:
            raise DamagedPacketError(f"{len(plain)} bytes are too few for a packet")
        body, sum_ = plain[:-2], int.from_bytes(plain[-2:], "big")
        if crc16(body) != sum_:
            raise DamagedPacketError(f"its CRC is {sum_:04x} and should be {crc16(body):04x}")
        return cls(body[0], body[1], body[2:])


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE: polynomial 0x1021, begins with 0xFFFF; `123456789` gives 0x29B1."""
    return binascii.crc_hqx(data, 0xFFFF)


def stuff(data: bytes) -> bytes:
    """COBS: no zero bytes, at most one byte more for each 254."""
    stuffed = bytearray()
    for stretch in data.split(b"\0"):
        rest = stretch
        while len(rest) >= 254:
            stuffed += b"\xff" + rest[:254]
            rest = rest[254:]
        stuffed += bytes((len(rest) + 1,)) + rest
    return bytes(stuffed)


def unstuff(stuffed: bytes) -> bytes:
    """Undoes `stuff`. Raises `DamagedPacketError` for what it never wrote."""
    data = bytearray()
    place = 0
    while place < len(stuffed):
        code = stuffed[place]
        stretch = stuffed[place + 1 : place + code]
        if code == 0 or len(stretch) != code - 1 or 0 in stretch:
            raise DamagedPacketError("it is not stuffed by COBS")
        data += stretch
        place += code
        if code != 0xFF and place < len(stuffed):
            data.append(0)
    return bytes(data)


class PacketReader:
    """Gathers bytes into packets; `damaged` counts what was none."""

    def __init__(self) -> None:
        self.damaged = 0
        self._begun = bytearray()

    def feed(self, data: bytes) -> list[Packet]:
        """The packets that these bytes complete."""
        *whole, rest = (bytes(self._begun) + data).split(b"\0")
        self._begun = bytearray(rest[: _LONGEST + 1])  # too long already, and so it stays
        return [packet for stuffed in whole if stuffed and (packet := self._packet(stuffed))]

    def _packet(self, stuffed: bytes) -> Packet | None:
        try:
            if len(stuffed) > _LONGEST:
                raise DamagedPacketError("it does not end")
            return Packet.decoded(stuffed)
        except DamagedPacketError:
            self.damaged += 1
            return None


def frame_payload(frame: LightFrame, brightness: float) -> bytes:
    """Payload of `FRAME`: brightness 0..255, then the rows in whole bytes. `brightness` is 0..1;
    anything above 0 is at least the darkest step that can be seen.
    """
    level = round(255 * min(1.0, max(0.0, brightness)))
    return bytes((max(level, 1) if brightness > 0 else 0,)) + frame.packed()


@dataclass(frozen=True, slots=True)
class FaceDevice:
    """What a face says of itself; size in lights, as it is wired."""

    version: int
    width: int
    height: int
    name: str

    @classmethod
    def of_payload(cls, payload: bytes) -> FaceDevice:
        """From the payload of `HERE`. Raises `DamagedPacketError`."""
        if len(payload) < 3:
            raise DamagedPacketError("it says neither version nor size")
        version, width, height = payload[:3]
        return cls(version, width, height, payload[3:].decode("ascii", "replace"))
