"""The controls of a panel: what each sends, where it is, and what it does."""

from __future__ import annotations

from dataclasses import replace

from woz_drivers.midi.panel_layouts import LAYOUTS, MidiControl, MidiSignal
from woz_drivers.midi.panel_maps import ControlMapping, PanelMap, kind_of
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.midi.wire import BEND, NOTE, MidiMessage
from woz_drivers.panels.control_functions import BUTTON, MappedControl

#: Columns of the picture for controls that no layout gives a place.
COLUMNS = 8


def mapped_controls(settings: MidiSettings) -> tuple[MappedControl, ...]:
    """The panel's controls: those of its layout first, free ones too, then the map's own."""
    panel = settings.panel
    return tuple(
        MappedControl(
            control,
            mapped,
            mapped.on or settings.on,
            soft=bool(mapped.control) and (mapped.take_over or settings.take_over) == "soft",
        )
        for control, mapped in _controls(panel)
    )


def _controls(panel: PanelMap) -> list[tuple[MidiControl, ControlMapping]]:
    layout = LAYOUTS[panel.layout]
    below = max((control.row for control in layout.controls.values()), default=0) + 1
    unplaced = 0
    result = []
    for name in dict.fromkeys((*layout.controls, *panel.controls)):
        mapped = panel.controls.get(name, ControlMapping())
        control = layout.controls.get(name)
        if control is None:
            row, column = divmod(unplaced, COLUMNS)
            unplaced += not mapped.column
            kind = kind_of(name, mapped, layout)
            control = MidiControl(name, kind, column + 1, below + row, lamp=kind == BUTTON)
        result.append((_changed(control, mapped), mapped))
    return result


def _changed(control: MidiControl, mapped: ControlMapping) -> MidiControl:
    """A control as its layout knows it, with what the map says of it."""
    return replace(
        control,
        kind=mapped.kind or control.kind,
        signal=mapped.signals[0] if mapped.signals else control.signal,
        column=mapped.column or control.column,
        row=mapped.row or control.row,
        lamp=control.lamp if mapped.lamp is None else mapped.lamp,
    )


def signal_of(it: MappedControl) -> MidiSignal:
    """What a control of a MIDI panel sends."""
    assert isinstance(it.control, MidiControl)
    return it.control.signal


def controls_by_signal(controls: tuple[MappedControl, ...]) -> dict[MidiSignal, MappedControl]:
    """Controls by what they send."""
    return {signal_of(it): it for it in controls}


class PanelSignals:
    """What the controls of a panel send: for session and `woz doctor` alike.

    Attributes:
        other_mode: That the panel sends what it sends in a mode for other programs; empty: not so
            far.
        own_mode: How it gets back.
    """

    def __init__(self, settings: MidiSettings, controls: tuple[MappedControl, ...]) -> None:
        layout = LAYOUTS[settings.panel.layout]
        self._name, self._other_modes = settings.panel.layout, layout.other_modes
        self._by_signal = controls_by_signal(controls)
        self.own_mode = layout.own_mode
        self.other_mode = ""

    def control_of(self, message: MidiMessage) -> MappedControl | None:
        """The control that sent this; None if no control sends it."""
        signal = MidiSignal(message.kind, message.number, message.channel)
        found = self._by_signal.get(signal) or self._by_signal.get(replace(signal, channel=0))
        if found is None and message.kind in self._other_modes:
            sent = {NOTE: "notes", BEND: "pitch bends"}.get(message.kind, message.kind)
            self.other_mode = (
                f"it sends {sent}, as a {self._name} does in a mode for a music program (DAW):"
                " its controls do nothing here"
            )
        return found
