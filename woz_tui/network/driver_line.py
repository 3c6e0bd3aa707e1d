"""The line between a session and a driver that runs in another process: what both sides use of it.

Over a network it is Eclipse Zenoh (`zenoh_line`), on one computer a socket (`stream_line`).
Nothing here waits: what a full line cannot take is dropped, and the frames' numbers show it.
"""

from __future__ import annotations

import abc
from collections.abc import Callable

#: Who has said nothing for so long is gone, in seconds.
SILENCE_S = 1.0
#: Frames that may wait to be sent; one more is dropped.
CAPACITY = 2000
#: Frames that are taken in one turn of the event loop: others have their turns, too.
A_TURN = 50

#: Is given what came.
Receive = Callable[[bytes], None]
#: Hears whether the other side is there; over a network in a thread of the line.
Presence = Callable[[bool], None]
#: Ends what `receive` or `watch_presence` began.
EndSubscription = Callable[[], None]


class LineError(Exception):
    """The line cannot be opened; what is wrong, and what helps."""

    def __init__(self, what: str, remedy: str = "") -> None:
        super().__init__(what)
        self.remedy = remedy


class DriverLine(abc.ABC):
    """Carries frames under keys to the other side, and says whether it is there."""

    @abc.abstractmethod
    def send(self, key: str, payload: bytes, *, urgent: bool = False) -> bool:
        """Have it sent and return at once; whether there was room, which there always is for what
        is urgent.
        """

    @abc.abstractmethod
    def send_bulky(self, key: str, payload: bytes) -> None:
        """The same for what may be lost and is long. The next one under its key replaces it."""

    @abc.abstractmethod
    def receive(self, key: str, receive: Receive) -> EndSubscription:
        """Hand over in the running event loop what comes under this key."""

    @abc.abstractmethod
    def show_presence(self, key: str) -> None:
        """Let the other side notice when this process goes."""

    @abc.abstractmethod
    def watch_presence(self, key: str, presence: Presence) -> EndSubscription:
        """Hear of everybody who comes and goes."""


# -- keys ------------------------------------------------------------------------------------------


def to_key(place: str, driver: str) -> str:
    """What goes to a driver."""
    return f"woz/{place}/{driver}/to"


def from_key(place: str, driver: str) -> str:
    """What a driver sends."""
    return f"woz/{place}/{driver}/from"


def place_key(place: str) -> str:
    """Shows that the computer of the drivers is there."""
    return f"woz/{place}/here"


def session_key(place: str) -> str:
    """Shows that the session is there."""
    return f"woz/{place}/session"


def place_of(key: str) -> str:
    """Whose key that is."""
    return key.removeprefix("woz/").partition("/")[0]
