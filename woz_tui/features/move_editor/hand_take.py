"""A take by hand within the editor: the keys of `woz record-move`, while the other layers play."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.keyboard_take import PuppetKeys
from woz_tui.motion.keyframes import KeyframeMove, MoveLayer
from woz_tui.motion.move_recording import LONGEST_S
from woz_tui.motion.puppeteer import Puppeteer

#: Seconds before a take begins, samples a second.
COUNT_IN_S, SAMPLES = 3.0, 25.0
#: Keys as the editor's terminal names them -> as a plain one sends them.
_BYTES = {
    "left": b"\x1b[D",
    "right": b"\x1b[C",
    "up": b"\x1b[A",
    "down": b"\x1b[B",
    "pageup": b"\x1b[5~",
    "pagedown": b"\x1b[6~",
}


class HandTake:
    """One take, from the counting in until it is taken or given up.

    Args:
        shape: The body.
        move: What plays meanwhile, but for the layer of the take.
        layer: The layer that is taken, or acted again.
        seconds: The time now, in seconds.
    """

    def __init__(
        self, shape: BodyShape, move: KeyframeMove, layer: str, seconds: Callable[[], float]
    ) -> None:
        beside = replace(move, layers=tuple(one for one in move.layers if one.length > 0))
        self._puppeteer = Puppeteer(shape, beside, layer, SAMPLES)
        self._keys = PuppetKeys(self._puppeteer, shape)
        self._layer = layer
        self._seconds = seconds
        self._origin = seconds()
        self._began: float | None = None
        #: The body as it is now.
        self.tick: Tick = self._puppeteer.tick(0.0)

    @property
    def place(self) -> float:
        """How long it has been taken; 0 while it is counted in."""
        return 0.0 if self._began is None else self._now - self._began

    @property
    def said(self) -> str:
        """What is shown of it."""
        if self._began is None:
            return f"take begins in {max(0.0, COUNT_IN_S - self._now):.1f} s"
        return f"REC {self.place:.1f} s"

    @property
    def _now(self) -> float:
        return self._seconds() - self._origin

    def go_on(self) -> bool:
        """Until now; whether its time is over. Raises `RejectedError` where it cannot begin."""
        now = self._now
        if self._began is None and now >= COUNT_IN_S:
            # It begins at its moment, however late this is looked at.
            self.tick = self._puppeteer.tick(COUNT_IN_S)
            self._puppeteer.begin()
            self._began = COUNT_IN_S
        self.tick = self._puppeteer.tick(now)
        return self.place >= LONGEST_S

    def press(self, key: str) -> None:
        """A key of the hand."""
        self._keys.press(_BYTES.get(key) or key.encode())

    def help(self, width: int) -> list[str]:
        """What the keys do."""
        return self._keys.help(width)

    def taken(self, *, trim: bool = True) -> MoveLayer | None:
        """The layer, or None where nothing has moved. `trim`: without rest at its ends, but as far
        as it would fall out of step with others.
        """
        if self._began is None:
            return None
        move = self._puppeteer.recorded(trim=trim)
        layer = next(one for one in move.layers if one.name == self._layer)
        return layer if layer.length > 0 else None


def take_name(move: KeyframeMove) -> str:
    """A name for the next take."""
    names = {layer.name for layer in move.layers}
    return next(name for name in (f"take-{i}" for i in range(1, 1000)) if name not in names)
