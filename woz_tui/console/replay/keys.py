"""Keys of a replay: they move through the log, none of them plays anything."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.console.feed import Feed
from woz_tui.console.keyboard import Keyboard
from woz_tui.core.clock import Clock
from woz_tui.core.requests import AnyRequest, AskReplay
from woz_tui.experiment.builtins import BUILTIN, Builtin

#: Seconds that one press of an arrow goes, and one with shift or alt.
NEAR_S, FAR_S = 5.0, 60.0
#: Keys of a session that only look, and do the same here.
_KEPT = frozenset(
    {
        *("failures", "panel_next", "panel_back", "drivers"),
        *("body", "knobs", "robot", "redraw"),
    }
)

KEYS: tuple[Builtin, ...] = (
    Builtin("pause", "space", "stand still, go on"),
    Builtin("step", ".", "to the next line of the log"),
    Builtin("slower", "[", "half the speed, down to 0.25x"),
    Builtin("slower_too", "<", "half the speed"),
    Builtin("faster", "]", "twice the speed, up to 16x"),
    Builtin("faster_too", ">", "twice the speed"),
    Builtin("back", "left", "5 s back"),
    Builtin("on", "right", "5 s on"),
    Builtin("far_back", "shift+left", "60 s back"),
    Builtin("far_back_too", "alt+left", "60 s back"),
    Builtin("far_on", "shift+right", "60 s on"),
    Builtin("far_on_too", "alt+right", "60 s on"),
    Builtin("mark_back", "pageup", "to the marker, stop, trial ... before"),
    Builtin("mark_on", "pagedown", "to the next marker, stop, trial ..."),
    Builtin("begin", "home", "to the beginning"),
    Builtin("end", "end", "to the end"),
    Builtin("go", "g", "go to a time, or to a marker, stop, trial ..."),
    Builtin("about", "i", "what this log is, and what is missing in it"),
    *(item for item in BUILTIN if item.id in _KEPT),
    Builtin("engagement", "=", "who was there and were they with the robot: the whole model"),
    Builtin("suspend", "ctrl+z", "leave the console for a moment"),
    Builtin("help", "?", "these keys"),
    Builtin("leave", "ctrl+q", "leave; nothing is changed by a replay"),
    Builtin("stop", "escape", "closes a dialog; nothing moves in a replay", movable=False),
    Builtin("stop_too", "ctrl+c", "the same", movable=False),
)

_REQUESTS: Mapping[str, AskReplay] = {
    "pause": AskReplay(what="pause"),
    "step": AskReplay(what="step"),
    "slower": AskReplay(what="slower"),
    "faster": AskReplay(what="faster"),
    "back": AskReplay(what="seek", by_s=-NEAR_S),
    "on": AskReplay(what="seek", by_s=NEAR_S),
    "far_back": AskReplay(what="seek", by_s=-FAR_S),
    "far_on": AskReplay(what="seek", by_s=FAR_S),
    "mark_back": AskReplay(what="go", to="before"),
    "mark_on": AskReplay(what="go", to="next"),
    "begin": AskReplay(what="go", to="start"),
    "end": AskReplay(what="go", to="end"),
}


class ReplayKeyboard(Keyboard):
    """A keyboard whose experiment keys are dead, and whose own keys are those of a replay."""

    def __init__(self, feed: Feed, clock: Clock | None = None) -> None:
        super().__init__(feed, clock)
        self.bind({}, {item.chord: item.id for item in KEYS})

    def bind(self, table: Mapping[str, str], builtins: Mapping[str, str] | None = None) -> None:
        """Only the console's own keys: what the experiment's would play is over."""
        super().bind({}, builtins)

    def arrive(self, chord: str, *, age_us: int = 0, stale: bool = False) -> bool:
        """A key from the terminal; an old one does no harm here."""
        return super().arrive(chord)

    def press(self, chord: str, *, age_us: int = 0, stale: bool = False) -> bool:
        """A key that came by way of the screen."""
        return super().press(chord)

    def _request(self, name: str, chord: str, age_us: int, stale: bool) -> AnyRequest | None:
        return _REQUESTS.get(name.removesuffix("_too"))
