"""What a panel's map says; the folder `maps` has two for a panel like the Korg nanoKONTROL2.

In these, buttons 1-8 are the upper row (S, control changes 32-39), 9-16 the middle one (M, 48-55),
17-24 the lower one (R, 64-71); the appendix counts its buttons from above to below, then from left
to right, so its 7, 8 and 9 are S3, M3 and R3. It leaves out button 15; the mode without a button,
saccade following, lies there. Neither source uses the transport keys: the session's own things are
there.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import msgspec

from woz_drivers.midi.panel_layouts import LAYOUTS, MidiSignal, PanelModel
from woz_drivers.midi.wire import BEND, CC, NOTE, PROGRAM
from woz_drivers.panels.control_functions import (
    BUTTON,
    KINDS,
    KNOB,
    ControlFunction,
    Problems,
    function_problems,
)
from woz_tui.drivers.fields import Doc, OneOf, Range, Section

_NUMBER = Range(0, 127)


@dataclass(frozen=True, slots=True)
class ControlMapping(ControlFunction):
    """What one control of the panel does, and, where no layout knows, what it sends.

    Exactly one of `control`, `verb`, `play`, `emotion`, `mode`, `action`, `key`, `stop`, `release`,
    `mark` and `script` says what it does; without any the control is free.
    """

    cc: Annotated[int | None, _NUMBER, Doc("number of the control change it sends")] = None
    note: Annotated[int | None, _NUMBER, Doc("number of the note it sends")] = None
    program: Annotated[int | None, _NUMBER, Doc("number of the program it selects, from 0")] = None
    bend: Annotated[bool, Doc("it sends pitch bend")] = False
    channel: Annotated[int, Range(0, 16), Doc("MIDI channel; 0: any")] = 0
    kind: Annotated[str, OneOf(("", *KINDS)), Doc("what it looks like")] = ""
    column: Annotated[
        int, Range(0, 64), Doc("place on the console's picture; 0: where it fits")
    ] = 0
    row: Annotated[int, Range(0, 64), Doc("place on the console's picture; 0: where it fits")] = 0
    lamp: Annotated[bool | None, Doc("whether it has a light that can be switched")] = None

    @property
    def signals(self) -> tuple[MidiSignal, ...]:
        """What it sends, as far as the map says it."""
        numbers = ((CC, self.cc), (NOTE, self.note), (PROGRAM, self.program))
        found = [MidiSignal(kind, n, self.channel) for kind, n in numbers if n is not None]
        return (*found, *([MidiSignal(BEND, 0, self.channel)] if self.bend else []))


# -- rules ----------------------------------------------------------------------------------------
# What makes no sense in a map: each mistake with the path at which it stands.


def mapping_problems(controls: Mapping[str, ControlMapping], layout: PanelModel) -> Problems:
    """Mistakes of these controls, each by itself."""
    for name, mapped in controls.items():
        path = f"controls.{name}"
        yield from _signal(path, name, mapped, layout)
        yield from function_problems(path, mapped, kind_of(name, mapped, layout))


def duplicate_signals(panel: PanelMap, names: Collection[str]) -> Problems:
    """Two controls that send the same, as far as one of `names` is among them."""
    first: dict[MidiSignal, str] = {}
    for name, mapped in panel.controls.items():
        for signal in mapped.signals:
            other = first.setdefault(signal, name)
            if other != name and (name in names or other in names):
                wrong = name if name in names else other
                same = other if wrong == name else name
                yield f"controls.{wrong}", f"sends {signal}, and so does {same!r}"


def kind_of(name: str, mapped: ControlMapping, layout: PanelModel) -> str:
    """What it looks like: as the map says, as the layout knows, or as what it does suggests."""
    if mapped.kind:
        return mapped.kind
    known = layout.controls.get(name)
    if known is not None:
        return known.kind
    pressed = mapped.note is not None or mapped.program is not None or not mapped.continuous
    return BUTTON if pressed else KNOB


def _signal(path: str, name: str, mapped: ControlMapping, layout: PanelModel) -> Problems:
    if len(mapped.signals) > 1:
        yield path, "set only one of cc, note, program and bend"
    if not mapped.signals and name not in layout.controls:
        near = difflib.get_close_matches(name, layout.controls, n=1)
        meant = f"; did you mean {near[0]!r}?" if near else ""
        yield path, f"its signal is missing: set cc, note, program or bend{meant}"


# --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class PanelMap(Section):
    """A whole panel: a file of its own, or right in the robot file."""

    title: Annotated[str, Doc("what it is")] = ""
    layout: Annotated[
        str, OneOf(tuple(LAYOUTS)), Doc("a panel whose controls are known by name; none: see cc")
    ] = "none"
    device: Annotated[str, Doc("the sound card's name, as in /proc/asound/cards")] = ""
    controls: Annotated[dict[str, ControlMapping], Doc("control -> what it does")] = field(
        default_factory=dict
    )

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        layout = LAYOUTS[self.layout]
        return [
            *mapping_problems(self.controls, layout),
            *duplicate_signals(self, tuple(self.controls)),
        ]


#: The maps in the folder `maps`, by the names under which robot files know them.
BUILT_IN: Mapping[str, PanelMap] = {
    file.stem: msgspec.yaml.decode(file.read_bytes(), type=PanelMap)
    for file in sorted((Path(__file__).parent / "maps").glob("*.yaml"))
}
