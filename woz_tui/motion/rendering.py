"""Renders a script of inputs: the ticks of an engine in virtual time.

The same engine, score and rate give the same ticks. An input takes effect at its very moment, also
between two ticks of the rate, so that what follows does not depend on the rate.
"""

from __future__ import annotations

import abc
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from woz_tui.drivers.contract import Driver, RejectedError
from woz_tui.motion.body_feeds import Sighting
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import InputResult, Tick
from woz_tui.motion.modes import Mode, Operator
from woz_tui.motion.safety import finite_number
from woz_tui.protocol.messages import Json

#: Nothing takes longer than this, in seconds, unless it is asked for.
LONGEST_S = 600.0
CUT_OFF = f"cut off after {LONGEST_S:g} s; --seconds allows more"
#: Joints count as held when they are this near to where they are wanted, in degrees; after so many
#: seconds a rendering ends even if one of them never is.
HELD, PATIENCE_S = 0.01, 5.0
#: Inputs that are no verb of a body.
SEEN, FREEZE, RESUME, STOP = "seen", "freeze", "resume", "stop"
BEYOND_VERBS = (SEEN, FREEZE, RESUME, STOP)


class RenderedDriver(Driver):
    """A driver whose engine alone decides how a body moves, so that `woz render` can show it."""

    @classmethod
    @abc.abstractmethod
    def engine(cls, settings: Any, *, seed: int | None = None) -> Engine:
        """The body in a time of its own; `seed` instead of the file's."""

    @classmethod
    def translated(
        cls, settings: Any, verb: str, args: Mapping[str, Json]
    ) -> tuple[str, Mapping[str, Json]]:
        """A command as the engine knows it. Raises `RejectedError`."""
        return verb, args


@dataclass(frozen=True, slots=True)
class Input:
    """An input at `t` seconds: a verb of the body, or one of `BEYOND_VERBS`.

    `place` says where it was written, for whoever has to mend it.
    """

    t: float
    verb: str
    args: Mapping[str, Json] = field(default_factory=dict)
    hand: Operator = Operator.WIZARD
    place: str = ""


#: Inputs that begin together, or a pause in seconds.
Step = Sequence[Input] | float


@dataclass(frozen=True, slots=True)
class RenderScript:
    """What happens in a rendering.

    `steps` are taken one after the other, each when all that the one before began has ended;
    `inputs` come at their own times, sorted. `awaited`: verbs whose end the next step waits for.
    """

    steps: Sequence[Step] = ()
    inputs: Sequence[Input] = ()
    awaited: frozenset[str] = frozenset()


#: Told of what the body says: its time in seconds, and a sentence.
Tell = Callable[[float, str], None]


class Rendering:
    """One performance in virtual time.

    Args:
        engine: A fresh one.
        score: What happens.
        rate: Ticks a second.
        tell: Hears of inputs that were refused and of the body's own notices.
    """

    def __init__(self, engine: Engine, score: RenderScript, rate: float, tell: Tell) -> None:
        self._engine = engine
        self._rate = rate
        self._tell = tell
        self._awaited = score.awaited
        self._steps = list(score.steps)
        self._inputs = deque(score.inputs)
        self._running: set[int] = set()
        self._pending: set[int] = set()
        self._blinks = False  # on demand; those by itself keep nobody waiting
        self._pause_until = 0.0
        self._frames = 0
        self._last: Tick | None = None

    def ticks(self, seconds: float | None, settle: float = 0.0) -> Iterator[Tick]:
        """All ticks from 0 to `seconds`; without it, until everything has ended and the pose has
        been held for `settle` seconds.
        """
        count = 0
        quiet_since: float | None = None
        while True:
            t = count / self._rate
            if seconds is not None and t > seconds + 1e-9:
                return
            tick = self._advance(t)
            yield tick
            if seconds is None:
                busy = self._busy(tick)
                quiet_since = None if busy else (t if quiet_since is None else quiet_since)
                if quiet_since is not None and self._held(tick, t - quiet_since, settle):
                    return
                if t > LONGEST_S:
                    self._tell(t, CUT_OFF)
                    return
            count += 1

    def _advance(self, t: float) -> Tick:
        """The tick at `t`, with every input up to `t` taken at its own moment."""
        while (moment := self._due(t)) is not None:
            if self._last is None or moment > self._last.t:
                self._tick(moment)
            self._carry_out(moment)
        tick = self._last
        if tick is None or tick.t < t:
            tick = self._tick(t)
        self._carry_out(t)
        return tick

    def _due(self, t: float) -> float | None:
        """The first moment before `t` at which something is to be done."""
        moments = [self._inputs[0].t] if self._inputs else []
        if self._steps and not self._pending:
            moments.append(self._pause_until)
        due = [moment for moment in moments if moment < t]
        if not due:
            return None
        return max(min(due), self._last.t if self._last is not None else 0.0)

    def _carry_out(self, now: float) -> None:
        """Everything that is to be done by `now`."""
        while self._inputs and self._inputs[0].t <= now:
            self._apply(self._inputs.popleft(), now)
        while self._steps and not self._pending and self._pause_until <= now:
            step = self._steps.pop(0)
            if isinstance(step, float | int):
                self._pause_until = now + step
                continue
            for one in step:
                token = self._apply(one, now)
                if token and one.verb in self._awaited:
                    self._pending.add(token)

    def _apply(self, one: Input, now: float) -> int:
        """Its token, if it takes time."""
        try:
            if one.verb == SEEN:
                self._see(one, now)
                return 0
            result = apply_input(one, self._engine, self._engine.apply)
        except RejectedError as refused:
            self._say(one, now, f" {refusal(refused)}")
            return 0
        self._blinks = self._blinks or one.verb == "blink"
        for shortfall in _shortfalls(result.sent):
            self._say(one, now, f": {shortfall}")
        if result.token:
            self._running.add(result.token)
        return result.token

    def _say(self, one: Input, now: float, text: str) -> None:
        where = f"{one.place}: " if one.place else ""
        self._tell(now, f"{where}{one.verb}{text}")

    def _see(self, one: Input, now: float) -> None:
        self._frames += 1
        x, y = _place(one.args, "x"), _place(one.args, "y")
        size = _place(one.args, "size")
        there = x is not None and y is not None
        self._engine.see(
            Sighting(
                t_us=round(now * 1_000_000),
                frame=self._frames,
                x=x if there else None,
                y=y if there else None,
                size=size if there and size is not None else 0.0,
            )
        )

    def _tick(self, t: float) -> Tick:
        tick = self._last = self._engine.tick(t)
        over = {one.token for one in tick.ended}
        self._running -= over
        self._pending -= over
        for notice in tick.notices:
            self._tell(t, notice)
        return tick

    def _busy(self, tick: Tick) -> bool:
        self._blinks = self._blinks and self._engine.blinking
        return bool(
            self._steps
            or self._inputs
            or self._running
            or self._blinks
            or tick.move
            or tick.mode is Mode.DEMO
            or tick.t < self._pause_until
        )

    @staticmethod
    def _held(tick: Tick, quiet: float, settle: float) -> bool:
        if quiet < settle:
            return False
        there = all(abs(tick.joints[name] - tick.wanted[name]) <= HELD for name in tick.joints)
        return there or quiet > settle + PATIENCE_S


def apply_input(one: Input, engine: Engine, apply: Callable[..., InputResult]) -> InputResult:
    """Carry an input out, verbs by `apply`; what the camera sees is left out. Raises
    `RejectedError`.
    """
    if one.verb == FREEZE:
        engine.freeze()
    elif one.verb == RESUME:
        engine.resume()
    elif one.verb == STOP:
        return apply("mode", {"mode": Mode.NORMAL.value}, one.hand)
    elif one.verb != SEEN:
        return apply(one.verb, one.args, one.hand)
    return InputResult()


def refusal(refused: RejectedError) -> str:
    """Why an input was refused and what to do, as the end of a sentence."""
    remedy = f" ({refused.remedy})" if refused.remedy else ""
    return f"refused: {refused.what}{remedy}"


def _place(seen: Mapping[str, Json], name: str) -> float | None:
    """A number of what was seen; None if there is none. Raises `RejectedError` for
    anything else.
    """
    value = seen.get(name)
    if value is None:
        return None
    place = finite_number(value)
    if place is None or abs(place) > 1.0:
        low = "0" if name == "size" else "-1"
        raise RejectedError(f"{name} must be {low} to 1, or null, not {value!r}")
    return place


def _shortfalls(sent: Mapping[str, Json]) -> Iterator[str]:
    """What an answer says about an input that was taken, but not as it was meant."""
    if sent.get("reachable") is False:
        yield f"out of reach, it looks {sent.get('error_deg')} degrees beside it"
    if "late_s" in sent:
        yield f"too soon, it arrives {sent['late_s']} s later"
    left_out = sent.get("left_out")
    if isinstance(left_out, Mapping):
        for name, why in left_out.items():
            yield f"left out {name}: {why}"
