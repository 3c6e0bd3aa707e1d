"""Soft take-over: a hand on a knob gets hold of the robot's value only where it passes it.

A knob without a motor stays where it was left while keys, moves and personalities change the value
behind it. If its next small turn counted, the robot would leap to wherever the knob happens to be.
"""

from __future__ import annotations

from dataclasses import dataclass

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
