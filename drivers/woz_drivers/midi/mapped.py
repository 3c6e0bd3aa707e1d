"""What one control of a panel does, as a map file says it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any

from woz_drivers.midi.layouts import KINDS, Signal
from woz_drivers.midi.wire import BEND, CC, NOTE, PROGRAM
from woz_tui.core.fields import Doc, OneOf, Range

SOFT, JUMP = "soft", "jump"
#: What a button does: `start` at a press, nothing when it is let go; `momentary` as long as it is
#: held; `toggle` on and off.
START, MOMENTARY, TOGGLE = PRESSES = ("start", "momentary", "toggle")
#: The ends of a control's places.
WHOLE = (0.0, 1.0)

_NUMBER = Range(0, 127)


@dataclass(frozen=True, slots=True)
class Mapped:
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
    def signals(self) -> tuple[Signal, ...]:
        """What it sends, as far as the map says it."""
        numbers = ((CC, self.cc), (NOTE, self.note), (PROGRAM, self.program))
        found = [Signal(kind, n, self.channel) for kind, n in numbers if n is not None]
        return (*found, *([Signal(BEND, 0, self.channel)] if self.bend else []))
