"""Messages on the wire: a header of 28 bytes and a payload.

All numbers are little-endian. The magic number is 0x42adde42, so `42 de ad 42` on the wire.
"""

from __future__ import annotations

import enum
import struct
from dataclasses import dataclass
from typing import Final

from qimessaging.errors import ProtocolError

MAGIC: Final = 0x42ADDE42
#: The longest payload that is read, in bytes; four times the largest camera picture.
LONGEST: Final = 64 << 20

_HEADER: Final = struct.Struct("<IIIHBBIII")
HEADER_SIZE: Final = _HEADER.size
_MAGIC: Final = struct.pack("<I", MAGIC)


class MessageKind(enum.IntEnum):
    CALL = 1
    REPLY = 2
    ERROR = 3
    POST = 4
    EVENT = 5
    CAPABILITY = 6
    CANCEL = 7
    CANCELED = 8


#: The payload is one dynamic value instead of what the signature says.
DYNAMIC_PAYLOAD: Final = 1
#: A call's arguments are followed by the signature which the caller wants for the result.
RETURN_TYPE: Final = 2


@dataclass(frozen=True, slots=True)
class QiMessage:
    """One message.

    Attributes:
        kind: What it is; a number without a name is kept as it came.
        id: The call's number, chosen by the caller; replies repeat it.
        service: 0 is the connection itself, 1 the service directory.
        object: 1 is the service itself, others are objects it has handed out.
        action: The number of the method, signal or property.
        flags: `DYNAMIC_PAYLOAD` and `RETURN_TYPE`.
        payload: The values.
    """

    kind: int
    id: int
    service: int
    object: int
    action: int
    payload: bytes = b""
    flags: int = 0

    def encoded(self) -> bytes:
        """Return the message as it goes over the wire."""
        header = _HEADER.pack(
            MAGIC,
            self.id,
            len(self.payload),
            0,
            self.kind,
            self.flags,
            self.service,
            self.object,
            self.action,
        )
        return header + self.payload

    def answer(self, kind: MessageKind, payload: bytes = b"", flags: int = 0) -> QiMessage:
        """Return the message that answers this call."""
        return QiMessage(kind, self.id, self.service, self.object, self.action, payload, flags)


class QiMessageReader:
    """Puts messages together from the pieces in which they arrive."""

    def __init__(self, longest: int = LONGEST) -> None:
        """Begin; `longest` is the longest payload accepted, in bytes."""
        self._longest = longest
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[QiMessage]:
        """Take a piece; return the messages that are complete now.

        Raises `ProtocolError` at the first byte that cannot be a message's; nothing can be read
        after that.
        """
        self._buffer += data
        frames: list[QiMessage] = []
        at = 0
        while len(self._buffer) - at >= HEADER_SIZE:
            frame, end = self._frame(at)
            if frame is None:
                break
            frames.append(frame)
            at = end
        del self._buffer[:at]
        if not _MAGIC.startswith(self._buffer[: len(_MAGIC)]):  # before it is as long as a header
            raise _no_messaging()
        return frames

    def _frame(self, at: int) -> tuple[QiMessage | None, int]:
        magic, number, size, version, kind, flags, service, obj, action = _HEADER.unpack_from(
            self._buffer, at
        )
        if magic != MAGIC:
            raise _no_messaging()
        if version != 0:
            raise ProtocolError(f"qi messaging of version {version}; version 0 is understood")
        if size > self._longest:
            raise ProtocolError(f"a message of {size} bytes; at most {self._longest} are read")
        start = at + HEADER_SIZE
        end = start + size
        if len(self._buffer) < end:
            return None, at
        with memoryview(self._buffer) as view:
            payload = bytes(view[start:end])
        return QiMessage(kind, number, service, obj, action, payload, flags), end


def _no_messaging() -> ProtocolError:
    return ProtocolError("what came is no qi messaging; is this the port of NAOqi?")
