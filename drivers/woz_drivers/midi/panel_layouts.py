"""Panels as they lie on the table: which control sends what, and where it is.

The numbers of the nanoKONTROL2 are those of its factory setting and, the same, of its native mode:
Korg, "nanoKONTROL2 MIDI Implementation", revision 1.00 (2010-12-14), section 4.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from woz_drivers.midi.wire import BEND, CC, NOTE
from woz_drivers.panels.control_functions import BUTTON, KNOB, SLIDER, PanelControl

#: Native mode on and off (section 3, "Native mode In/Out request"): the lights then belong to us.
#: 0x40 is the device on its first global channel, where it is when it comes from the factory.
_KORG = bytes((0xF0, 0x42, 0x40, 0x00, 0x01, 0x13, 0x00))
_NATIVE_ON = _KORG + bytes((0x00, 0x00, 0x01, 0xF7))
_NATIVE_OFF = _KORG + bytes((0x00, 0x00, 0x00, 0xF7))


@dataclass(frozen=True, slots=True)
class MidiSignal:
    """What a control sends: a kind of message and its number; channel 0 means any."""

    kind: str
    number: int
    channel: int = 0

    def __str__(self) -> str:
        channel = f", channel {self.channel}" if self.channel else ""
        return f"{self.kind} {self.number}{channel}"


#: Sent by nobody: a control that the rules refuse has been reported already.
NOTHING = MidiSignal("", -1)


@dataclass(frozen=True, slots=True)
class MidiControl(PanelControl):
    """A control of a MIDI panel, and what it sends; nothing where no map says it."""

    signal: MidiSignal = NOTHING


@dataclass(frozen=True, slots=True)
class PanelModel:
    """A make of panel.

    Attributes:
        device: What the system's sound card is called.
        controls: By name.
        begin: Sent after it was opened, so that its lights can be switched.
        end: Sent before it is let go.
        other_modes: Kinds of message that its controls send in modes for other programs alone.
        own_mode: How it gets back into the mode that is read here.
        lamp_channel: Channel on which lights are switched; 0: each on its control's own.
    """

    device: str = ""
    controls: Mapping[str, MidiControl] = ()  # type: ignore[assignment]
    begin: bytes = b""
    end: bytes = b""
    lamp_channel: int = 0
    other_modes: tuple[str, ...] = ()
    own_mode: str = ""


def _row(
    kind: str, first_name: int, first_cc: int, row: int, lamp: bool = False
) -> dict[str, MidiControl]:
    """Eight controls of a kind beside each other, their numbers running on."""
    return {
        f"{kind}-{first_name + index}": MidiControl(
            f"{kind}-{first_name + index}",
            kind,
            signal=MidiSignal(CC, first_cc + index),
            column=4 + index,
            row=row,
            lamp=lamp,
        )
        for index in range(8)
    }


def _single(name: str, number: int, column: int, row: int, lamp: bool = False) -> MidiControl:
    return MidiControl(name, BUTTON, column, row, lamp, MidiSignal(CC, number))


#: Buttons left of the channel strips; those without a lamp have none on the device.
_LEFT = (
    _single("track-left", 58, 1, 1),
    _single("track-right", 59, 2, 1),
    _single("cycle", 46, 1, 2, lamp=True),
    _single("marker-set", 60, 1, 3),
    _single("marker-left", 61, 2, 3),
    _single("marker-right", 62, 3, 3),
    _single("rewind", 43, 1, 4, lamp=True),
    _single("forward", 44, 2, 4, lamp=True),
    _single("stop", 42, 3, 4, lamp=True),
    _single("play", 41, 1, 5, lamp=True),
    _single("record", 45, 2, 5, lamp=True),
)

NANOKONTROL2 = PanelModel(
    device="nanoKONTROL2",
    controls={
        **_row(KNOB, 1, 16, 1),
        **_row(BUTTON, 1, 32, 2, lamp=True),  # S
        **_row(BUTTON, 9, 48, 3, lamp=True),  # M
        **_row(BUTTON, 17, 64, 4, lamp=True),  # R
        **_row(SLIDER, 1, 0, 5),
        **{control.name: control for control in _LEFT},
    },
    begin=_NATIVE_ON,
    end=_NATIVE_OFF,
    lamp_channel=16,
    other_modes=(NOTE, BEND),
    own_mode="hold SET MARKER and CYCLE while you plug it in: that is its CC mode",
)

#: Panels that are known; `none` knows no control, a map then tells each one's numbers.
LAYOUTS: Mapping[str, PanelModel] = {
    "none": PanelModel(controls={}),
    "nanokontrol2": NANOKONTROL2,
}
