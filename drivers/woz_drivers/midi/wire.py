"""MIDI 1.0 on the wire: a stream of bytes into messages, and the few messages that go back.

Source: The Complete MIDI 1.0 Detailed Specification (MIDI Manufacturers Association, 96.1),
"Data Format": running status, real-time bytes anywhere, what ends a system exclusive message.
"""

from __future__ import annotations

from dataclasses import dataclass

#: What a message is about; `kind` of `MidiMessage`, and of what a map file names.
NOTE, CC, PROGRAM, BEND, PRESSURE, KEY_PRESSURE = (
    *("note", "cc", "program", "bend", "pressure", "key-pressure"),
)

#: Status nibble -> kind and how many data bytes follow.
_CHANNEL: dict[int, tuple[str, int]] = {
    0x80: (NOTE, 2),
    0x90: (NOTE, 2),
    0xA0: (KEY_PRESSURE, 2),
    0xB0: (CC, 2),
    0xC0: (PROGRAM, 1),
    0xD0: (PRESSURE, 1),
    0xE0: (BEND, 2),
}
#: System common: how many data bytes follow; they say nothing to us, but must not be taken for
#: values of a control. 0xF4 and 0xF5 are not defined and have none.
_COMMON = {0xF1: 1, 0xF2: 2, 0xF3: 1}
_SYSEX, _SYSEX_END, _REAL_TIME = 0xF0, 0xF7, 0xF8


@dataclass(frozen=True, slots=True)
class MidiMessage:
    """A channel message.

    Attributes:
        kind: One of the kinds above.
        channel: 1..16, as panels and manuals count.
        number: Of the controller, the note or the program; 0 for those without one.
        value: 0..127. A note's velocity, 0 when it is let go; 127 for a program change; the upper
            seven bits of a pitch bend.
    """

    kind: str
    channel: int
    number: int
    value: int


class MidiDecoder:
    """Takes any bytes in pieces of any size; never raises."""

    def __init__(self) -> None:
        self._status = 0
        self._data: list[int] = []
        self._skip = 0

    def feed(self, data: bytes) -> list[MidiMessage]:
        """The messages that `data` completes, in order."""
        messages = []
        for byte in data:
            message = self._byte(byte)
            if message is not None:
                messages.append(message)
        return messages

    def _byte(self, byte: int) -> MidiMessage | None:
        if byte >= _REAL_TIME:  # may stand anywhere, even inside another message
            return None
        if byte >= 0x80:
            self._begin(byte)
            return None
        if self._skip:
            self._skip -= 1
            return None
        if self._status == 0:  # inside a system exclusive message, or before the first status
            return None
        self._data.append(byte)
        return self._whole()

    def _begin(self, status: int) -> None:
        """A status byte: ends whatever was going on, finished or not."""
        self._data.clear()
        self._skip = _COMMON.get(status, 0)
        self._status = status if status < _SYSEX else 0

    def _whole(self) -> MidiMessage | None:
        nibble, channel = self._status & 0xF0, (self._status & 0x0F) + 1
        kind, length = _CHANNEL[nibble]
        if len(self._data) < length:
            return None
        first, last = self._data[0], self._data[-1]
        self._data.clear()  # the status stays: it runs on
        match kind:
            case "note":
                return MidiMessage(kind, channel, first, 0 if nibble == 0x80 else last)
            case "program":
                return MidiMessage(kind, channel, first, 127)
            case "bend" | "pressure":
                return MidiMessage(kind, channel, 0, last)
        return MidiMessage(kind, channel, first, last)


def control_change(channel: int, number: int, value: int) -> bytes:
    """`channel` 1..16, `number` and `value` 0..127: how the light of a button is switched."""
    return bytes((0xB0 | (channel - 1) & 0x0F, number & 0x7F, value & 0x7F))


def note_on(channel: int, number: int, velocity: int) -> bytes:
    """The same for pads that send notes."""
    return bytes((0x90 | (channel - 1) & 0x0F, number & 0x7F, velocity & 0x7F))
