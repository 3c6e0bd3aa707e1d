"""What features have on the wizard's screen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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
class FeatureConsole:
    """What a feature has on the screen. Nothing in it may import Textual: dialogs are named.

    `commands`: what can be done with it. `status`: what stands at the right of the first status
    row, and is never left out.
    """

    commands: tuple[FeatureCommand, ...] = ()
    status: Callable[[ConsoleState, PaintFrame], Row] | None = None
