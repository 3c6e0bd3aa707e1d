"""What a panel's map says; the folder `maps` has two for a panel like the Korg nanoKONTROL2.

In these, buttons 1-8 are the upper row (S, control changes 32-39), 9-16 the middle one (M, 48-55),
17-24 the lower one (R, 64-71); the appendix counts its buttons from above to below, then from left
to right, so its 7, 8 and 9 are S3, M3 and R3. It leaves out button 15; the mode without a button,
saccade following, lies there. Neither source uses the transport keys: the session's own things are
there.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import msgspec

from woz_drivers.midi.panel_layouts import BUTTON, KINDS, KNOB, LAYOUTS, MidiSignal, PanelModel
from woz_drivers.midi.wire import BEND, CC, NOTE, PROGRAM
from woz_tui.drivers.fields import Doc, OneOf, Range, Section

# -- mapped ---------------------------------------------------------------------------------------
# What one control of a panel does, as a map file says it.

SOFT, JUMP = "soft", "jump"
#: What a button does: `start` at a press, nothing when it is let go; `momentary` as long as it is
#: held; `toggle` on and off.
START, MOMENTARY, TOGGLE = PRESSES = ("start", "momentary", "toggle")
#: The ends of a control's places.
WHOLE = (0.0, 1.0)

_NUMBER = Range(0, 127)


@dataclass(frozen=True, slots=True)
class ControlMapping:
    """What one control of the panel does, and, where no layout knows, what it sends.

    Exactly one of `control`, `verb`, `play`, `emotion`, `mode`, `action`, `stop`, `release`,
    `mark` and `script` says what it does; without any the control is free.
    """

    control: Annotated[
        str, Doc("a control of the body: pitch, zoom, tempo ...; follows the hand, 0..1")
    ] = ""
    verb: Annotated[str, Doc("any verb of any driver; its arguments stand in args")] = ""
    args: Annotated[dict[str, Any], Doc("arguments of the verb")] = field(default_factory=dict)
    argument: Annotated[
        str, Doc("the verb's argument that a knob or slider sets, between the ends of range")
    ] = ""
    back: Annotated[
        dict[str, Any], Doc("arguments of the verb when a momentary button is let go")
    ] = field(default_factory=dict)
    play: Annotated[str, Doc("a move")] = ""
    emotion: Annotated[str, Doc("an emotion; its intensity stays")] = ""
    mode: Annotated[str, Doc("a mode; normal is the puppeteer's stop")] = ""
    action: Annotated[str, Doc("an action of the experiment, by its name")] = ""
    stop: Annotated[
        str, OneOf(("", "normal", "all")), Doc("normal: end what moves; all: the emergency stop")
    ] = ""
    release: Annotated[bool, Doc("release the emergency stop")] = False
    mark: Annotated[str, Doc("put a marker with this text into the log")] = ""
    script: Annotated[bool, Doc("play the script's next line")] = False
    on: Annotated[str, Doc("driver that is meant; empty: the panel's own `on`")] = ""
    reversed: Annotated[bool, Doc("its low end is the high one")] = False
    range: Annotated[
        tuple[float, float], Doc("what its two ends stand for; a control's places go from 0 to 1")
    ] = WHOLE
    take_over: Annotated[
        str, OneOf(("", SOFT, JUMP)), Doc("soft: picked up as it passes; empty: as the panel says")
    ] = ""
    press: Annotated[
        str, OneOf(PRESSES), Doc("what a button does when it is pressed and let go")
    ] = "start"
    label: Annotated[str, Doc("what stands below it on the console; empty: what it does")] = ""
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
    def doing(self) -> tuple[str, ...]:
        """Which of the things that a control may do are said; more than one is a mistake."""
        words = {
            "control": self.control,
            "verb": self.verb,
            "play": self.play,
            "emotion": self.emotion,
            "mode": self.mode,
            "action": self.action,
            "stop": self.stop,
            "release": self.release,
            "mark": self.mark,
            "script": self.script,
        }
        return tuple(name for name, said in words.items() if said)

    @property
    def continuous(self) -> bool:
        """Whether it takes a value and not only a press."""
        return bool(self.control or self.argument)

    @property
    def signals(self) -> tuple[MidiSignal, ...]:
        """What it sends, as far as the map says it."""
        numbers = ((CC, self.cc), (NOTE, self.note), (PROGRAM, self.program))
        found = [MidiSignal(kind, n, self.channel) for kind, n in numbers if n is not None]
        return (*found, *([MidiSignal(BEND, 0, self.channel)] if self.bend else []))


# -- rules ----------------------------------------------------------------------------------------
# What makes no sense in a map: each mistake with the path at which it stands.

#: What cannot be taken back, so that a button can only start it.
_ONCE = ("action", "stop", "release", "mark", "script")

Problems = Iterator[tuple[str, str]]


def mapping_problems(controls: Mapping[str, ControlMapping], layout: PanelModel) -> Problems:
    """Mistakes of these controls, each by itself."""
    for name, mapped in controls.items():
        path = f"controls.{name}"
        yield from _signal(path, name, mapped, layout)
        yield from _purpose(path, mapped)
        yield from _range_and_press(path, mapped, kind_of(name, mapped, layout))


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


def _purpose(path: str, mapped: ControlMapping) -> Problems:
    doing = mapped.doing
    if len(doing) > 1:
        yield f"{path}.{doing[1]}", f"a control has one function: {doing[0]} is set already"
    if not mapped.verb:
        for name in ("args", "argument", "back"):
            if getattr(mapped, name):
                yield f"{path}.{name}", "needs verb"
    elif mapped.argument and mapped.argument in mapped.args:
        yield f"{path}.args.{mapped.argument}", "is what the control sets: see argument"
    if mapped.on and doing and doing[0] in _ONCE:
        yield f"{path}.on", f"{doing[0]} is for the session, not for a driver"


def _range_and_press(path: str, mapped: ControlMapping, kind: str) -> Problems:
    low, high = mapped.range
    doing = mapped.doing
    if not low < high:
        yield f"{path}.range", "the low end comes first: [low, high]; `reversed` turns it round"
    elif mapped.control and not 0 <= low < high <= 1:
        yield f"{path}.range", "places of a control go from 0 to 1"
    elif mapped.range != WHOLE and not mapped.continuous:
        yield f"{path}.range", "only what takes a value has a range: control, or verb with argument"
    if mapped.take_over and not mapped.control:
        yield f"{path}.take_over", "only a control of the body can be taken over"
    if kind != BUTTON:
        if doing and not mapped.continuous:
            yield (
                f"{path}.{doing[0]}",
                f"it turns and cannot be pressed: a {kind} takes control, or verb with argument",
            )
        if mapped.press != START:
            yield f"{path}.press", f"a {kind} is not pressed"
    elif mapped.press != START and doing and doing[0] in _ONCE:
        yield f"{path}.press", f"{doing[0]} cannot be taken back: leave press out"
    elif mapped.press == MOMENTARY and mapped.verb and not (mapped.back or mapped.argument):
        yield f"{path}.press", "say in `back` with which arguments it is taken back"


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
