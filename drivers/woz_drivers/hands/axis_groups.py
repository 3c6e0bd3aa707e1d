"""Axes of sticks, 6-D mice and motion sensors: what their places ask of the session."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

from woz_drivers.hands.device_models import STICKS
from woz_drivers.hands.settings import LEAST_EVERY_S, HandControl
from woz_drivers.panels.control_functions import MappedControl
from woz_drivers.panels.control_requests import RequestQueue, SendRequest
from woz_tui.drivers.contract import Ask
from woz_tui.protocol.messages import Json

#: Steps under way at once: one is replaced by the next.
_STEPS_AT_ONCE = 4
#: A rate counts at most so long after it was looked at last, in seconds: what stood still for a
#: moment makes no leap.
_LONGEST_S = 0.2


class AxisGroup(Protocol):
    """Axes that go out together.

    Attributes:
        hold: Their dead man's button; empty: none.
        active: Whether steps may be under way.
    """

    hold: str
    active: bool

    def look(self, values: Mapping[str, float], *, held: bool) -> None:
        """Ask for what `values` say, by axis, -1..1 or 0..1; `held`: the dead man's button is."""


def function_of(it: MappedControl) -> HandControl:
    """What the map says of a control."""
    assert isinstance(it.mapped, HandControl)
    return it.mapped


def panel_value(name: str, value: float) -> float:
    """What a control says on the scale of panels, 0..127, on which a stick rests at 64."""
    if name not in STICKS:
        return value * 127
    return 64 + value * (64 if value < 0 else 63)


class StickGroup:
    """Axes that set arguments of the same verb, such as both of a stick: they ask for it together.

    With `every` it asks for steps, again and again while an axis is away from its middle, and what
    is left of them is cut short when the stick comes back; else it sets a value whenever it moves.
    The newest values count: what could not be sent yet is replaced by them.

    Args:
        axes: The axes.
        asking: Asks the session.
        now_us: The session's clock.
        on_refusal: Told what moves nothing, and why.
    """

    def __init__(
        self,
        axes: list[MappedControl],
        asking: SendRequest,
        now_us: Callable[[], int],
        on_refusal: Callable[[str, str], None],
    ) -> None:
        self.axes = axes
        self._on_refusal = on_refusal
        self._function = function_of(axes[0])
        self.hold = self._function.hold
        self.every_us = round(self._function.every * 1_000_000)
        self._key = _key_of(axes)
        self._asking = asking
        self._now_us = now_us
        self._queue = RequestQueue(self._send, _STEPS_AT_ONCE if self.every_us else 1)
        self._sent: dict[str, float] = {}
        self._sent_us = 0
        #: Whether steps may be under way.
        self.active = False
        #: Set by a refusal: it counts again when the stick has been let go.
        self.refused = False

    def look(self, values: Mapping[str, float], *, held: bool) -> None:
        """Ask for what `values` say, by axis, -1..1 or 0..1; `held`: the dead man's button is."""
        moved = {axis.name: values.get(axis.name, 0.0) for axis in self.axes}
        away = any(moved.values())
        if not away:
            self.refused = False
        if self.hold and not held:
            self.refused = False
            self.end("the dead man's button was let go")
            return
        if self.refused:
            return
        if self.every_us:
            self._step(moved, away=away)
        elif moved != self._sent and (away or self._sent):
            self._sent = moved
            self._queue.send(self._request(moved))

    def _step(self, moved: dict[str, float], *, away: bool) -> None:
        if not away:
            self.end("the stick was let go")
            return
        since_us = self._now_us() - self._sent_us
        due_us = self.every_us if moved == self._sent else LEAST_EVERY_S * 1_000_000
        if self.active and since_us < due_us:
            return
        self.active = True
        self._sent, self._sent_us = moved, self._now_us()
        self._queue.send(self._request(moved, when_busy="replace"))

    def end(self, why: str) -> None:
        """Nothing more of it: what is left of its steps is cut short."""
        self._sent = {}
        if self.active:
            self.active = False
            first = self.axes[0]
            self._asking(
                Ask("cancel", why, source=first.source, key=self._key), lambda carried, why: None
            )

    def _request(self, moved: Mapping[str, float], *, when_busy: str = "") -> Ask:
        args: dict[str, Json] = dict(self._function.args)
        for axis in self.axes:
            args |= axis.turned(axis.place(panel_value(axis.name, moved[axis.name]))).args
        ask = self.axes[0].turned(0.0)
        return replace(ask, args=args, key=self._key, when_busy=when_busy)

    def _send(self, ask: Ask, done: Callable[[bool, str], None]) -> None:
        def ended(carried: bool, why: str) -> None:
            # What a newer one replaced has no reason; what was cut short is over anyway.
            if not carried and why and (self.active or not self.every_us):
                if not self.refused:
                    self._on_refusal(f"{self._key} ({ask.name})", why)
                self.refused = True
                self.active = False
            done(carried, why)

        self._asking(ask, ended)


class RateGroup:
    """Axes that move a value for as long as they are away from their middle and the dead man's
    button is held, such as a 6-D mouse's: at rest it stays where it is.

    It begins where the robot says that it stands, of a body's control; else where it was left, or
    in the middle of its range, which it never leaves.

    Args:
        axes: The axes: several that set arguments of one verb, or one of a control.
        asking: Asks the session.
        now_us: The session's clock.
        on_refusal: Told what moves nothing, and why.
        present: Where the robot stands, of a control; None: nobody knows.
    """

    #: No steps: what was asked for last is over when it is reached.
    active = False

    def __init__(
        self,
        axes: list[MappedControl],
        asking: SendRequest,
        now_us: Callable[[], int],
        on_refusal: Callable[[str, str], None],
        present: Callable[[MappedControl], float | None],
    ) -> None:
        self.axes = axes
        self.hold = function_of(axes[0]).hold
        self._key = _key_of(axes)
        self._asking = asking
        self._now_us = now_us
        self._on_refusal = on_refusal
        self._present = present
        self._queue = RequestQueue(self._send, 1)
        self._at = {axis.name: sum(axis.mapped.range) / 2 for axis in axes}
        #: When it was looked at last while it moved; None: it rests.
        self._moved_us: int | None = None
        self._refused = False

    def look(self, values: Mapping[str, float], *, held: bool) -> None:
        """Move on by the time that has passed."""
        moved = {axis.name: values.get(axis.name, 0.0) for axis in self.axes}
        if not held or not any(moved.values()):
            self._moved_us, self._refused = None, False
            return
        if self._refused:
            return
        now_us = self._now_us()
        if self._moved_us is None:
            self._moved_us = now_us
            self._begin()
            return
        seconds = min((now_us - self._moved_us) / 1_000_000, _LONGEST_S)
        self._moved_us = now_us
        before = dict(self._at)
        for axis in self.axes:
            low, high = axis.mapped.range
            way = moved[axis.name] * function_of(axis).rate * seconds
            at = self._at[axis.name] + (-way if axis.mapped.reversed else way)
            self._at[axis.name] = min(max(at, low), high)
        if self._at != before:
            self._queue.send(self._request())

    def _begin(self) -> None:
        for axis in self.axes:
            at = self._present(axis)
            if at is not None:
                low, high = axis.mapped.range
                self._at[axis.name] = min(max(at, low), high)

    def _request(self) -> Ask:
        asks = [axis.turned(self._at[axis.name]) for axis in self.axes]
        args = {name: value for ask in asks for name, value in ask.args.items()}
        return replace(asks[0], args=args, key=self._key)

    def _send(self, ask: Ask, done: Callable[[bool, str], None]) -> None:
        def ended(carried: bool, why: str) -> None:
            if not carried and why and not self._refused:
                self._refused = True
                self._on_refusal(f"{self._key} ({ask.name})", why)
            done(carried, why)

        self._asking(ask, ended)


def _key_of(axes: list[MappedControl]) -> str:
    """What the log calls them: `left-stick`, or each by its name."""
    stems = {axis.name.removesuffix("-x").removesuffix("-y") for axis in axes}
    return stems.pop() if len(stems) == 1 else "+".join(axis.name for axis in axes)
