"""A take out of a script, in virtual time: the same script gives the same layer."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.modes import Mode
from woz_tui.motion.puppeteer import Puppeteer
from woz_tui.motion.rendering import BEYOND_VERBS, FREEZE, RESUME, STOP, Input

#: Ticks a second, as the driver's own by default.
RATE = 50.0


def performed(
    puppeteer: Puppeteer,
    inputs: Sequence[Input],
    start: float,
    seconds: float,
    tell: Callable[[str], None],
) -> None:
    """Go through the inputs; the take is what happens from `start` on, for `seconds`.

    Every input counts from its own moment on, also between two ticks. `tell` hears of those that
    were refused.
    """
    waiting = deque(inputs)
    end = start + seconds
    puppeteer.tick(0.0)
    began = False
    for moment in _moments(inputs, start, end):
        puppeteer.tick(moment)
        if not began and moment >= start:
            puppeteer.begin()
            began = True
        while waiting and waiting[0].t <= moment:
            _apply(puppeteer, waiting.popleft(), tell)


def _moments(inputs: Sequence[Input], start: float, end: float) -> list[float]:
    """All ticks: those of the rate, those of inputs, the take's beginning and end."""
    ticks = {index / RATE for index in range(int(end * RATE) + 1)}
    exact = {one.t for one in inputs if one.t <= end}
    return sorted(ticks | exact | {start, end})


def _apply(puppeteer: Puppeteer, one: Input, tell: Callable[[str], None]) -> None:
    try:
        if one.verb == FREEZE:
            puppeteer.engine.freeze()
        elif one.verb == RESUME:
            puppeteer.engine.resume()
        elif one.verb == STOP:
            puppeteer.apply("mode", {"mode": Mode.NORMAL.value})
        elif one.verb not in BEYOND_VERBS:
            puppeteer.apply(one.verb, one.args)
    except RejectedError as refused:
        remedy = f" ({refused.remedy})" if refused.remedy else ""
        tell(f"{one.place}: {one.verb} refused: {refused.what}{remedy}")
