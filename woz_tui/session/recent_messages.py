"""Keeps the last messages for the event list of a console that attaches late."""

from __future__ import annotations

from collections import deque
from functools import cache

from woz_tui.protocol import messages as m
from woz_tui.protocol.kinds import unlisted_kinds

#: How many of them there are.
MOST = 200
#: What no list of events has a line for: samples, what is shown, what a log says of itself.
UNLISTED = (
    *(m.Reading, m.Shown, m.EngagementShown, m.ExperimentFiles, m.SessionPlan, m.RerunSent),
    *(m.ActionScheduled, m.MotionArrived, m.MotionInterrupted, m.VerbsUnable, m.CommandMark),
)


@cache
def unlisted() -> tuple[type[m.Message], ...]:
    """The same, of features too."""
    return (*UNLISTED, *unlisted_kinds())


class RecentMessages:
    """The last messages of a session."""

    def __init__(self) -> None:
        self._lines: deque[m.Message] = deque(maxlen=MOST)
        #: Commands of knobs that are under way: nothing of them is listed.
        self._passing: set[str] = set()

    @property
    def lines(self) -> list[m.Message]:
        """The last messages, oldest first."""
        return [*self._lines]

    def add(self, message: m.Message) -> None:
        """Take in the next message, if an event list shows it."""
        if self.lists(message):
            self._lines.append(message)

    def lists(self, message: m.Message) -> bool:
        """Whether the next message is one for a list of events."""
        if isinstance(message, unlisted()):
            return False
        if isinstance(message, m.Command) and message.passing:
            self._passing.add(message.command)
            return False
        if not self._passing or not isinstance(message, m.Ack):
            return True
        passing = message.command in self._passing
        if isinstance(message, m.End):
            self._passing.discard(message.command)
        return not passing
