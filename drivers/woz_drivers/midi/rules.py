"""What makes no sense in a map: each mistake with the path at which it stands."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterator, Mapping
from typing import Protocol

from woz_drivers.midi.layouts import BUTTON, KNOB, Layout, Signal
from woz_drivers.midi.mapped import MOMENTARY, START, WHOLE, Mapped

#: What cannot be taken back, so that a button can only start it.
_ONCE = ("action", "stop", "release", "mark", "script")

Found = Iterator[tuple[str, str]]


class _Panel(Protocol):
    @property
    def layout(self) -> str: ...

    @property
    def controls(self) -> Mapping[str, Mapped]: ...


def found_in(controls: Mapping[str, Mapped], layout: Layout) -> Found:
    """Mistakes of these controls, each by itself."""
    for name, mapped in controls.items():
        path = f"controls.{name}"
        yield from _signal(path, name, mapped, layout)
        yield from _purpose(path, mapped)
        yield from _fitting(path, mapped, kind_of(name, mapped, layout))


def claimed_twice(panel: _Panel, names: Collection[str]) -> Found:
    """Two controls that send the same, as far as one of `names` is among them."""
    first: dict[Signal, str] = {}
    for name, mapped in panel.controls.items():
        for signal in mapped.signals:
            other = first.setdefault(signal, name)
            if other != name and (name in names or other in names):
                wrong = name if name in names else other
                same = other if wrong == name else name
                yield f"controls.{wrong}", f"sends {signal}, and so does {same!r}"


def kind_of(name: str, mapped: Mapped, layout: Layout) -> str:
    """What it looks like: as the map says, as the layout knows, or as what it does suggests."""
    if mapped.kind:
        return mapped.kind
    known = layout.controls.get(name)
    if known is not None:
        return known.kind
    pressed = mapped.note is not None or mapped.program is not None or not mapped.continuous
    return BUTTON if pressed else KNOB


def _signal(path: str, name: str, mapped: Mapped, layout: Layout) -> Found:
    if len(mapped.signals) > 1:
        yield path, "say one of cc, note, program and bend: it sends one thing"
    if not mapped.signals and name not in layout.controls:
        near = difflib.get_close_matches(name, layout.controls, n=1)
        meant = f"; did you mean {near[0]!r}?" if near else ""
        yield path, f"nobody knows what it sends: say cc, note, program or bend{meant}"


def _purpose(path: str, mapped: Mapped) -> Found:
    doing = mapped.doing
    if len(doing) > 1:
        yield f"{path}.{doing[1]}", f"it does one thing: {doing[0]} stands here already"
    if not mapped.verb:
        for name in ("args", "argument", "back"):
            if getattr(mapped, name):
                yield f"{path}.{name}", "belongs to verb, which is not here"
    elif mapped.argument and mapped.argument in mapped.args:
        yield f"{path}.args.{mapped.argument}", "is what the control sets: see argument"
    if mapped.on and doing and doing[0] in _ONCE:
        yield f"{path}.on", f"{doing[0]} is for the session, not for a driver"


def _fitting(path: str, mapped: Mapped, kind: str) -> Found:
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
