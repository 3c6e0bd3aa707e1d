"""The controls of a panel: what each sends, where it is, and what it does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from woz_drivers.midi.panel_layouts import BUTTON, LAYOUTS, MidiSignal, PanelControl
from woz_drivers.midi.panel_maps import START, ControlMapping, PanelMap, kind_of
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.midi.wire import control_place, control_value
from woz_tui.drivers.contract import Ask
from woz_tui.protocol.messages import Json

#: Columns of the picture for controls that no layout gives a place.
COLUMNS = 8
#: What is said as the verb of the same name -> the verb's argument.
_VERBS = {"play": "move", "emotion": "emotion", "mode": "mode"}
#: Sent by nobody: a control that the rules refuse has been reported already.
_NOTHING = MidiSignal("", -1)
_SPOKEN = {"script": "next line", "release": "release"}


@dataclass(frozen=True, slots=True)
class MappedControl:
    """One control: what it is, what it does, and on which driver (`on`)."""

    control: PanelControl
    mapped: ControlMapping
    on: str
    soft: bool

    @property
    def name(self) -> str:
        """What it is called on this panel."""
        return self.control.name

    @property
    def pressed(self) -> bool:
        """Whether it is a button; anything else turns or slides."""
        return self.control.kind == BUTTON

    @property
    def free(self) -> bool:
        """Whether it does nothing."""
        return not self.mapped.doing

    def place(self, value: int) -> float:
        """What its value 0..127 stands for: a place of the control, or the verb's number."""
        low, high = self.mapped.range
        share = control_place(value)
        return low + (high - low) * (1 - share if self.mapped.reversed else share)

    def value(self, where: float) -> int:
        """The value 0..127 at which it stands for `where`: the inverse of `control_place`."""
        low, high = self.mapped.range
        share = (where - low) / (high - low)
        return control_value(1 - share if self.mapped.reversed else share)

    def turned(self, to: float) -> Ask:
        """What is asked for when it stands for `to`."""
        mapped = self.mapped
        number = round(to, 4)
        if mapped.control:
            return self._verb("control", {"control": mapped.control, "value": number})
        return self._verb(mapped.verb, {**mapped.args, mapped.argument: number})

    def press(self) -> Ask:
        """What is asked for when it is pressed."""
        mapped, what = self.mapped, self.mapped.doing[0]
        if mapped.continuous:
            return self.turned(self._end(high=True))
        if what == "verb":
            return self._verb(mapped.verb, mapped.args)
        if what in _VERBS:
            busy = "replace" if what == "play" else ""
            return self._verb(what, {_VERBS[what]: getattr(mapped, what)}, when_busy=busy)
        if mapped.stop == "normal":
            return self._verb("mode", {"mode": "normal"})
        return self._session(what, getattr(mapped, what) if what in ("action", "mark") else "")

    def back(self) -> Ask | None:
        """What is asked for when a momentary or toggling button is taken back."""
        mapped, what = self.mapped, self.mapped.doing[0]
        if mapped.press == START:
            return None
        if mapped.continuous:
            return self.turned(self._end(high=False))
        if what == "verb":
            return self._verb(mapped.verb, mapped.back)
        if what == "emotion":
            return self._verb("emotion", {"emotion": "neutral"})
        return self._verb("mode", {"mode": "normal"})

    def _end(self, *, high: bool) -> float:
        """One end of its range, as a button reaches it."""
        return self.mapped.range[high is not self.mapped.reversed]

    def asks(self) -> tuple[Ask, ...]:
        """Everything it may ask for, at one end of its range."""
        if self.free:
            return ()
        first = self.press() if self.pressed else self.turned(self.mapped.range[1])
        back = self.back() if self.pressed else self.turned(self.mapped.range[0])
        return (first,) if back is None else (first, back)

    @property
    def label(self) -> str:
        """What it does, in few words."""
        mapped = self.mapped
        if mapped.label or self.free:
            return mapped.label
        what = mapped.doing[0]
        if what == "verb":
            return " ".join([mapped.verb, *map(str, mapped.args.values()), mapped.argument]).strip()
        if what in _SPOKEN:
            return _SPOKEN[what]
        if what == "stop":
            return "STOP" if mapped.stop == "all" else "stop"
        return str(getattr(mapped, what))

    def _verb(self, verb: str, args: Mapping[str, Json], *, when_busy: str = "") -> Ask:
        return Ask("verb", verb, dict(args), self.on, "midi", self.name, when_busy)

    def _session(self, what: str, name: str = "") -> Ask:
        return Ask(what, name, source="midi", key=self.name)


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


def _controls(panel: PanelMap) -> list[tuple[PanelControl, ControlMapping]]:
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
            control = PanelControl(
                name, kind, _NOTHING, column + 1, below + row, lamp=kind == BUTTON
            )
        result.append((_changed(control, mapped), mapped))
    return result


def _changed(control: PanelControl, mapped: ControlMapping) -> PanelControl:
    """A control as its layout knows it, with what the map says of it."""
    return replace(
        control,
        kind=mapped.kind or control.kind,
        signal=mapped.signals[0] if mapped.signals else control.signal,
        column=mapped.column or control.column,
        row=mapped.row or control.row,
        lamp=control.lamp if mapped.lamp is None else mapped.lamp,
    )


def controls_by_signal(controls: tuple[MappedControl, ...]) -> dict[MidiSignal, MappedControl]:
    """Controls by what they send."""
    return {it.control.signal: it for it in controls}
