"""What a control of a panel does: a MIDI knob, a stick of a gamepad, a key of a Stream Deck."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from woz_tui.drivers.contract import Ask
from woz_tui.drivers.fields import Doc, OneOf
from woz_tui.protocol.messages import Json

KNOB, SLIDER, BUTTON = "knob", "slider", "button"
KINDS = (KNOB, SLIDER, BUTTON)
SOFT, JUMP = "soft", "jump"
#: What a button does: `start` at a press, nothing when it is let go; `momentary` as long as it is
#: held; `toggle` on and off.
START, MOMENTARY, TOGGLE = PRESSES = ("start", "momentary", "toggle")
#: The ends of a control's places.
WHOLE = (0.0, 1.0)


@dataclass(frozen=True, slots=True)
class ControlFunction:
    """What one control of a panel does.

    Exactly one of `control`, `verb`, `play`, `emotion`, `mode`, `action`, `key`, `stop`,
    `release`, `mark` and `script` says what it does; without any the control is free.
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
    key: Annotated[str, Doc("a key of the experiment's panels: whatever it plays")] = ""
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
            "key": self.key,
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


# -- rules ----------------------------------------------------------------------------------------
# What makes no sense: each mistake with the path at which it stands.

#: What cannot be taken back, so that a button can only start it.
_ONCE = ("action", "key", "stop", "release", "mark", "script")

Problems = Iterator[tuple[str, str]]


def function_problems(path: str, mapped: ControlFunction, kind: str) -> Problems:
    """Mistakes of one control of this kind, whatever it sends."""
    yield from _purpose(path, mapped)
    yield from _range_and_press(path, mapped, kind)


def _purpose(path: str, mapped: ControlFunction) -> Problems:
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


def _range_and_press(path: str, mapped: ControlFunction, kind: str) -> Problems:
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
    elif mapped.press != START and mapped.verb and not (mapped.back or mapped.argument):
        yield f"{path}.press", "say in `back` with which arguments it is taken back"


# -- places ---------------------------------------------------------------------------------------


def control_place(value: float) -> float:
    """Where a control stands, 0..1, for its value 0..127; 64, the middle, is exactly 0.5."""
    value = min(max(value, 0), 127)
    return value / 128 if value <= 64 else 0.5 + (value - 64) / 126


def control_value(where: float) -> int:
    """The value that is nearest to the place `where`, 0..1: the inverse of `control_place`."""
    where = min(max(where, 0.0), 1.0)
    return round(where * 128) if where <= 0.5 else 64 + round((where - 0.5) * 126)


# -- a control with its function -------------------------------------------------------------------

#: What is said as the verb of the same name -> the verb's argument.
_VERBS = {"play": "move", "emotion": "emotion", "mode": "mode"}
_SPOKEN = {"script": "next line", "release": "release"}


@dataclass(frozen=True, slots=True)
class PanelControl:
    """One control of a panel; `column` and `row` count from 1, from the upper left."""

    name: str
    kind: str
    column: int
    row: int
    lamp: bool = False


@dataclass(frozen=True, slots=True)
class MappedControl:
    """One control: what it is, what it does, on which driver (`on`); `source`: whose hand it is in
    the log.
    """

    control: PanelControl
    mapped: ControlFunction
    on: str
    soft: bool
    source: str = "midi"

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

    def place(self, value: float) -> float:
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
        named = what in ("action", "key", "mark")
        return self._session(what, getattr(mapped, what) if named else "")

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
        return Ask("verb", verb, dict(args), self.on, self.source, self.name, when_busy)

    def _session(self, what: str, name: str = "") -> Ask:
        return Ask(what, name, source=self.source, key=self.name)
