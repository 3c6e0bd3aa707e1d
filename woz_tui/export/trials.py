"""To which trial something belongs."""

from __future__ import annotations


class Trials:
    """The number of the trial at each moment; None: in none.

    A break belongs to no trial, also inside one. A number that is set, by hand or with the order of
    conditions, is that of the next trial; only in a session that begins no trials it holds itself.
    """

    def __init__(self) -> None:
        self.number: int | None = None
        self._interrupted: int | None = None
        self._planned = False

    def plan(self) -> None:
        """This session begins its trials, and ends them."""
        if not self._planned:
            self._planned, self.number = True, None

    def set(self, number: int) -> None:
        """Somebody said which number it is."""
        if not self._planned:
            self.number = number

    def begin(self, number: int) -> None:
        """A trial begins, from whatever was before."""
        self.plan()
        self.number, self._interrupted = number, None

    def end(self) -> None:
        """It is over, also from a break."""
        self.number = self._interrupted = None

    def pause(self) -> None:
        """A break begins."""
        if self._planned and self.number is not None:
            self.number, self._interrupted = None, self.number

    def resume(self) -> None:
        """The break is over."""
        if self._interrupted is not None:
            self.number, self._interrupted = self._interrupted, None
