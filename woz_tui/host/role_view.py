"""A session as one role sees it while it goes on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from woz_tui.protocol import messages as m
from woz_tui.session.recent_messages import RecentMessages
from woz_tui.session.redactor import Redactor


class RoleView:
    """What a role sees of a session, as it goes on.

    Args:
        redactor: Decides it.
        before: The messages from which it knows what holds, and the last ones of the log.
    """

    def __init__(
        self, redactor: Redactor, before: Iterable[m.Message], recent: Iterable[m.Message]
    ) -> None:
        self.redactor = redactor
        self._recent = RecentMessages()
        self._last: tuple[m.Message | None, m.Message | None] = None, None
        for message in before:
            redactor.take(message)
        for message in recent:
            self._list(redactor.message(message))

    def see(self, message: m.Message) -> m.Message | None:
        """What may be had of `message`."""
        if self._last[0] is not message:
            self._last = message, self.redactor.message(message)
        return self._last[1]

    def hear(self, message: m.AnyMessage) -> None:
        """`message` has been published."""
        self._list(self.see(message))
        self.redactor.take(message)

    @property
    def recent(self) -> list[m.AnyMessage]:
        """The last lines as they were seen."""
        return self._recent.lines

    def _list(self, message: Any) -> None:
        if message is not None:
            self._recent.take(message)
