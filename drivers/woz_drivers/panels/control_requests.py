"""Turns the values of a panel's controls into requests to the session, one at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from woz_drivers.panels.control_functions import MOMENTARY, START, TOGGLE, MappedControl
from woz_tui.drivers.contract import Ask
from woz_tui.motion.body_feeds import BodyState

# -- pickup ---------------------------------------------------------------------------------------
# Soft take-over: a hand on a knob gets hold of the robot's value only where it passes it.
#
# A knob without a motor stays where it was left while keys, moves and personalities change the
# value behind it. If its next small turn counted, the robot would leap to where the knob happens to
# be.

#: Places this near to each other are the same: two steps of 127.
NEAR = 2 / 127


@dataclass(slots=True)
class Pickup:
    """One control's hold on one value of the robot; all places in the robot's terms, 0..1.

    Attributes:
        low: Lowest place that the hand can reach.
        high: Highest place that the hand can reach.
        jump: Whether every turn counts, wherever the robot's value is.
        hand: Where the hand left the control; None until it was touched.
        held: Whether the hand has hold of the value.
        sent: What the robot was last told by this hand.
    """

    low: float = 0.0
    high: float = 1.0
    jump: bool = False
    hand: float | None = None
    held: bool = False
    sent: float | None = None

    def turn(self, to: float, present: float | None) -> bool:
        """The hand moved the control to `to`; `present` is the robot's value, None if nobody
        knows it. Whether this counts.
        """
        before, self.hand = self.hand, to
        if self.jump:
            self.held = True
        elif not self.held and present is not None:
            self.held = self._passes(before, to, min(max(present, self.low), self.high))
        if self.held:
            self.sent = to
        return self.held

    def compare(self, present: float | None) -> None:
        """The robot's value, read when it must have heard of what was sent: if it is another one,
        somebody else has changed it and the hand must pick it up again.
        """
        if self.jump or not self.held or self.sent is None or present is None:
            return
        if abs(present - self.sent) > NEAR:
            self.held = False

    def drop(self) -> None:
        """What was sent has been refused: the robot's value is not the hand's."""
        self.held = self.held and self.jump

    def forget(self) -> None:
        """The panel is gone; who knows what happens to its controls meanwhile."""
        self.hand = self.sent = None
        self.held = False

    @staticmethod
    def _passes(before: float | None, to: float, value: float) -> bool:
        if abs(to - value) <= NEAR:
            return True
        return before is not None and (before - value) * (to - value) <= 0


# --------------------------------------------------------------------------------------------------

#: Asks the session; the function is told how it ended.
SendRequest = Callable[[Ask, Callable[[bool, str], None]], None]
#: Presses of one button that may be under way at once: a move lasts, and is started anew by the
#: next press. More are presses of nobody's finger; of those the last one counts.
PRESSES_AT_ONCE = 8
#: After an answer it takes so long, in microseconds, until the robot's state surely shows it.
SETTLED_US = 250_000


class RequestQueue:
    """Requests under way to the session; of those that come meanwhile the latest waits.

    Order is kept: what waits is sent when the one before has been answered.
    """

    def __init__(self, asking: SendRequest, at_once: int) -> None:
        self._asking = asking
        self._at_once = at_once
        #: How many have not been answered.
        self.under_way = 0
        self._waiting: Ask | None = None
        self.on_answer: Callable[[Ask, bool], None] = lambda ask, carried: None

    def send(self, ask: Ask) -> None:
        """Ask, now or as soon as there is room."""
        if self.under_way >= self._at_once:
            self._waiting = ask
            return
        self.under_way += 1
        answers = iter((self._answered,))  # one ask, one answer, whoever gives it

        def done(carried: bool, why: str) -> None:
            for answered in answers:
                answered(ask, carried)

        self._asking(ask, done)

    def _answered(self, ask: Ask, carried: bool) -> None:
        self.under_way -= 1
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            self.send(waiting)
        else:
            self.on_answer(ask, carried)


class PanelKnob:
    """A knob or slider: follows the hand, if it has hold of the value.

    Args:
        fitted: Which one.
        asking: Asks the session.
        now_us: The session's clock.
    """

    def __init__(
        self, fitted: MappedControl, asking: SendRequest, now_us: Callable[[], int]
    ) -> None:
        self.fitted = fitted
        low, high = fitted.mapped.range
        self.pickup = Pickup(low, high, jump=not fitted.soft)
        self._now_us = now_us
        self._line = RequestQueue(asking, 1)
        self._line.on_answer = self._answered
        self._answered_us = 0

    @property
    def waiting(self) -> bool:
        """Whether the hand has moved it without getting hold of the value."""
        return self.pickup.hand is not None and not self.pickup.held

    def target(self, state: BodyState | None) -> int | None:
        """The value 0..127 at which a waiting knob begins to count; None if nobody knows."""
        present = self._present(state)
        return None if present is None else self.fitted.value(present)

    def moved(self, value: float, state: BodyState | None) -> None:
        """The hand moved it to `value`, 0..127."""
        self.compare(state)
        to = self.fitted.place(value)
        if self.pickup.turn(to, self._present(state)):
            self._line.send(self.fitted.turned(to))

    def compare(self, state: BodyState | None) -> None:
        """Compare with the robot's state, unless something is under way that it cannot show yet."""
        if not self._line.under_way and self._now_us() - self._answered_us >= SETTLED_US:
            self.pickup.compare(self._present(state))

    def jump(self) -> None:
        """Take over where the hand is."""
        if self.waiting and self.pickup.hand is not None:
            self.pickup.held = True
            self.pickup.sent = self.pickup.hand
            self._line.send(self.fitted.turned(self.pickup.hand))

    def _present(self, state: BodyState | None) -> float | None:
        return None if state is None else state.controls.get(self.fitted.mapped.control)

    def _answered(self, _ask: Ask, carried: bool) -> None:
        self._answered_us = self._now_us()
        if not carried:
            self.pickup.drop()


class PanelButton:
    """A button or a pad: asks when it is pressed; when it is let go only if it is momentary."""

    def __init__(self, fitted: MappedControl, asking: SendRequest) -> None:
        self.fitted = fitted
        self._line = RequestQueue(asking, PRESSES_AT_ONCE)
        self._line.on_answer = self._answered
        self._down = False
        #: What was asked for last, on or off; and what of it was done. Nobody else knows of a verb,
        #: and of nothing where the driver tells no state.
        self._on = self._done = False

    def pressed(self, value: float, state: BodyState | None) -> None:
        """It sent `value`: 0 when it is let go."""
        down = value > 0
        was, self._down = self._down, down
        mapped = self.fitted.mapped
        if down and not was:
            taken_back = mapped.press == TOGGLE and self.on(state)
            self._on = not taken_back
            ask = self.fitted.back() if taken_back else self.fitted.press()
            if ask is not None:
                self._line.send(ask)
        elif was and not down and mapped.press == MOMENTARY:
            self._on = False
            ask = self.fitted.back()
            if ask is not None:
                self._line.send(ask)

    def let_go(self) -> None:
        """The panel is gone, and with it the finger."""
        self.pressed(0, None)

    def on(self, state: BodyState | None) -> bool:
        """Whether what it does is so now, as its light shows."""
        mapped = self.fitted.mapped
        if self.fitted.free:
            return False
        what = mapped.doing[0]
        personality = what == "verb" and mapped.verb == "personality" and "name" in mapped.args
        if state is None or (what == "verb" and not personality):
            lasts = what != "play" or self._line.under_way > 0  # a move ends by itself
            return self._on and lasts and mapped.press != START
        if personality:
            return bool(state.personality == mapped.args["name"])
        if what == "control":
            low, high = mapped.range
            at = state.controls.get(mapped.control)
            return at is not None and (at >= (low + high) / 2) is not mapped.reversed
        shown = {"play": state.move, "emotion": state.emotion, "mode": state.mode}
        return what in shown and shown[what] == getattr(mapped, what)

    def _answered(self, ask: Ask, carried: bool) -> None:
        if carried:
            self._done = ask == self.fitted.press()
        elif not self._line.under_way and self.fitted.mapped.press == TOGGLE:
            self._on = self._done
