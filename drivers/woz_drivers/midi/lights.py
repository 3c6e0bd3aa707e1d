"""The lights of buttons: which shall be on, and the bytes that make it so."""

from __future__ import annotations

from collections.abc import Iterable

from woz_drivers.midi.layouts import Control, Layout
from woz_drivers.midi.wire import CC, NOTE, control_change, note_on

_ON, _OFF = 127, 0


class Lights:
    """What the panel's lights show, as far as it was told; only changes are sent."""

    def __init__(self, layout: Layout, controls: Iterable[Control]) -> None:
        self._layout = layout
        self._lamps = {
            control.name: control
            for control in controls
            if control.lamp and control.signal.kind in (CC, NOTE)
        }
        self._shown: dict[str, bool] = {}

    def forget(self) -> None:
        """A panel that was just plugged in: nobody knows what it shows."""
        self._shown.clear()

    def wanted(self, lit: Iterable[str]) -> bytes:
        """The bytes after which exactly the lamps `lit` are on; they count as sent."""
        names = set(lit)
        out = bytearray()
        for name, control in self._lamps.items():
            on = name in names
            if self._shown.get(name) is not on:
                self._shown[name] = on
                out += self._switch(control, on)
        return bytes(out)

    def _switch(self, control: Control, on: bool) -> bytes:
        signal = control.signal
        channel = self._layout.lamp_channel or signal.channel or 1
        make = note_on if signal.kind == NOTE else control_change
        return make(channel, signal.number, _ON if on else _OFF)
