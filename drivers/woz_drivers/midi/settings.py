"""What a robot file and a map file may say about a MIDI panel."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Annotated

from woz_drivers.midi.panel_layouts import LAYOUTS
from woz_drivers.midi.panel_maps import (
    BUILT_IN,
    ControlMapping,
    PanelMap,
    duplicate_signals,
    mapping_problems,
)
from woz_drivers.panels.control_functions import JUMP, SOFT
from woz_tui.drivers.fields import Doc, Included, OneOf, Section, Sibling


@dataclass(frozen=True, slots=True)
class MidiSettings(Section):
    """What a robot file may say about a MIDI panel."""

    map: Annotated[
        PanelMap | str,
        Included(("nanokontrol2", "thesis")),
        Doc("nanokontrol2, thesis, a map file, or the map right here"),
    ] = "nanokontrol2"
    device: Annotated[
        str, Doc("sound card's name (nanoKONTROL2), or a path; empty: what the map says")
    ] = ""
    controls: Annotated[
        dict[str, ControlMapping], Doc("controls that do something else than the map says")
    ] = field(default_factory=dict)
    on: Annotated[str, Sibling(), Doc("the driver whose controls these are")] = "body"
    take_over: Annotated[
        str,
        OneOf((SOFT, JUMP)),
        Doc("soft: a control counts once it has passed the robot's value; jump: at once"),
    ] = SOFT
    lights: Annotated[bool, Doc("switch the lights of buttons")] = True
    part: Annotated[
        str, Doc("plays only what the wizard of this part plays (`for` of panels); empty: all")
    ] = ""

    @property
    def panel(self) -> PanelMap:
        """The map with this robot's own changes."""
        base = self.map if isinstance(self.map, PanelMap) else BUILT_IN[self.map]
        changed = {name: _over(base.controls.get(name), it) for name, it in self.controls.items()}
        return replace(base, controls={**base.controls, **changed})

    def said_at(self, control: str) -> str:
        """The path of the setting that says what `control` does."""
        if control in self.controls:
            return f"controls.{control}"
        return f"map.controls.{control}" if isinstance(self.map, PanelMap) else "map"

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        panel = self.panel
        own = {name: panel.controls[name] for name in self.controls}
        return [
            *mapping_problems(own, LAYOUTS[panel.layout]),
            *duplicate_signals(panel, tuple(own)),
        ]


def _over(base: ControlMapping | None, change: ControlMapping) -> ControlMapping:
    """`change`, with what the control sends and looks like taken over where it says nothing."""
    if base is None or change.signals:
        return change
    looks = {
        name: getattr(change, name) or getattr(base, name) for name in ("kind", "column", "row")
    }
    return replace(
        change,
        cc=base.cc,
        note=base.note,
        program=base.program,
        bend=base.bend,
        channel=base.channel,
        lamp=base.lamp if change.lamp is None else change.lamp,
        **looks,
    )
