"""What a feature keeps of a session's messages."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, ClassVar

from woz_tui.protocol.envelope import Message
from woz_tui.timeline.episodes import Episode

#: What a kind of message does: called with the history, the message and the `SessionState`; returns
#: the episodes that end or begin with it.
HistoryCase = Callable[[Any, Any, Any], Iterable[Episode] | None]


class FeatureHistory:
    """What a feature keeps of a session's messages, in attributes of its own: messages that still
    hold, episodes that go on, tables of both. Made without arguments.
    """

    #: What each kind of message does. Kinds of the core reach the session's state first.
    cases: ClassVar[Mapping[type[Message], HistoryCase]] = {}
    #: Kinds that tell of something that happened: a replay leaves no such moment out.
    deeds: ClassVar[tuple[type[Message], ...]] = ()
    #: Kinds of which the lines of earlier sessions are read, for `owed`.
    earlier: ClassVar[tuple[type[Message], ...]] = ()

    @property
    def apart(self) -> bool:
        """Whether nobody takes part in the session, because of the feature."""
        return False

    def restart(self) -> str | None:
        """The value of the feature's start option with which a session that broke off goes on;
        None: with that of the command line.
        """
        return None

    def study(self, state: Any) -> Mapping[str, Any]:
        """Fields of `welcome.StudySettings` that say how it stands now, in the `SessionState`."""
        return {}

    def owed(self, message: Message, state: Any, before: tuple[str, ...]) -> tuple[str, ...]:
        """What a participant has yet to do, once a line of an earlier session was worked in.
        `before`: as of the line before, which may be another session's.
        """
        return before

    def put_off(self, run: str) -> tuple[int, int] | None:
        """Since when and until when it puts the beginning of a run off; None: it does not."""
        return None

    def _values(self) -> Iterator[object]:
        for value in vars(self).values():
            yield from value.values() if type(value) is dict else (value,)

    @property
    def lines(self) -> Iterator[Message]:
        """The messages from which a fresh history becomes the same."""
        for value in self._values():
            if isinstance(value, Message):
                yield value
            elif isinstance(value, Episode):
                yield from value.lines

    def open(self) -> Iterator[Episode]:
        """Episodes that have not ended."""
        return (value for value in self._values() if isinstance(value, Episode))

    def copy(self) -> FeatureHistory:
        """An independent copy."""
        other = copy.copy(self)
        for name, value in vars(self).items():
            if type(value) is dict:
                setattr(other, name, value.copy())
        return other


#: What a participant has yet to do, by the class that says so.
Owed = Mapping[type[FeatureHistory], tuple[str, ...]]
