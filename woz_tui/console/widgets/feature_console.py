"""What features have on the wizard's screen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState


@dataclass(frozen=True, slots=True)
class FeatureCommand:
    """A command of the console: it plays the action of its key, if that has one, and then opens the
    dialog `opens`, if one is named (`module:Class`).

    `key`: the id of its key (`Feature.keys`). `watchers`: whether it is for those who only watch,
    too. `also`: words that find it in the palette, beside its own.
    """

    key: str
    opens: str = ""
    watchers: bool = False
    also: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DialogOffer:
    """The dialog `module:Class` opens by itself, once for each thing that it is `about`; empty: not
    at this console.
    """

    about: object
    opens: str


@dataclass(frozen=True, slots=True)
class Board:
    """Lines of its own above the panels.

    `lines`: how many, on a screen of so many lines; 0: none. `rows`: what stands there.
    """

    lines: Callable[[ConsoleState, int], int]
    rows: Callable[[ConsoleState, PaintFrame], Sequence[Row]]


@dataclass(frozen=True, slots=True)
class FeatureConsole:
    """What a feature has on the screen. Nothing in it may import Textual: dialogs are named.

    `commands`: what can be done with it. `status`: what stands at the right of the first status
    row, and is never left out. `under_way`: what stands before the failures in the second one; it
    is given the key that cuts what began last, and the cells that are left. `board`: lines above
    the panels. `offers`: the dialog that opens by itself now. `instead`: the dialog `module:Class`
    that opens now for a command of the console, by the id of its key, instead of what it does
    otherwise; empty: nothing, None: as otherwise.
    """

    commands: tuple[FeatureCommand, ...] = ()
    status: Callable[[ConsoleState, PaintFrame], Row] | None = None
    under_way: Callable[[ConsoleState, PaintFrame, str, int], Row] | None = None
    board: Board | None = None
    offers: Callable[[ConsoleState], DialogOffer | None] | None = None
    instead: Mapping[str, Callable[[ConsoleState], str | None]] = field(default_factory=dict)
