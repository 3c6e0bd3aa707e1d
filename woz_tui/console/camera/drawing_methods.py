"""Which of the ways to draw a picture suits a terminal."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.console.camera.picture_terminal import PictureTerminal
from woz_tui.console.camera.picture_widgets import HalfBlockView, KittyView, PictureView, SixelView

#: What `--pictures` takes.
METHODS = ("auto", "blocks", "kitty", "sixel", "off")
#: Colours of Rich's colour systems.
_DEPTHS = {"truecolor": 1 << 24, "256": 256, "standard": 16, "windows": 16}


@dataclass(frozen=True, slots=True)
class TerminalAbilities:
    """What a terminal has: `depth` colours (0: only signs of ASCII), `side` (None: no terminal),
    and `tmux`, `screen` or nothing in between.
    """

    depth: int
    side: PictureTerminal | None = None
    multiplexer: str = ""


def depth_of(system: str | None, *, plain: bool) -> int:
    """Colours of Rich's colour system; none where only ASCII or no colour may be drawn."""
    return 0 if plain else _DEPTHS.get(system or "", 0)


def view_for(wanted: str, means: TerminalAbilities) -> PictureView:
    """A widget that draws in the way that is `wanted`; `auto`: what the terminal said it can do.

    Half blocks are always right. tmux answers in its terminal's place without being one that
    draws, so behind it pictures come only to who asks for them.
    """
    side = means.side
    if side is not None and means.depth >= 256:
        direct = wanted == "auto" and not means.multiplexer
        if wanted == "kitty" or (direct and side.kitty):
            return KittyView(side, tmux=means.multiplexer == "tmux")
        if wanted == "sixel" or (direct and side.sixel and side.cell is not None):
            return SixelView(side)
    return HalfBlockView(means.depth)
