"""Where the console's messages come from and where its requests go: a live robot or a replay."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from woz_tui.config.screen_language import word
from woz_tui.protocol.envelope import Answer
from woz_tui.protocol.messages import Message
from woz_tui.protocol.requests import Request
from woz_tui.protocol.sentence import Sentence

#: The reason of a reply that cannot come any more, as nobody knows whether its request arrived.
GONE = Sentence("link.gone", "the connection to the robot process was lost")

#: One decoded line from the host; a kind this version does not know comes as a plain dict.
Incoming = Message | Answer | dict[str, Any]

#: Called from the feed's own thread with everything that arrived together, oldest first.
OnMessages = Callable[[list[Incoming]], None]


class LostPart(Enum):
    """What is not there any more between keys and robot: as a sentence, as a sign, how it is when
    it is back, and what the robot does meanwhile.
    """

    PROCESS = (
        Sentence("link.process_gone", "the robot process is gone"),
        Sentence("link.process_lost", "ROBOT PROCESS LOST"),
        Sentence("link.process_back", "Robot process is back"),
        Sentence(
            "link.nobody_controls",
            "Nobody controls the robot now; what is still moving ends by its own safeguards.",
        ),
    )
    ANSWER = (
        Sentence("link.silent", "the robot process does not answer"),
        Sentence("link.no_answer", "NO ANSWER"),
        Sentence("link.answers_again", "Robot process answers again"),
        Sentence("link.may_go_on", "What runs may go on. What was pressed is not played late."),
    )
    LINE = (
        Sentence("link.line_is_lost", "the line to the robot is lost"),
        Sentence("link.line_lost", "LINE LOST"),
        Sentence("link.line_back", "The line is back"),
        Sentence(
            "link.driving_stops",
            "Driving stops there by the dead man's switch, the rest goes on to its end.",
        ),
    )

    def __init__(self, *told: Sentence) -> None:
        self._told = told

    @property
    def sentence(self) -> str:
        return word(self._told[0])

    @property
    def sign(self) -> str:
        return word(self._told[1])

    @property
    def back(self) -> str:
        return word(self._told[2])

    @property
    def robot(self) -> str:
        return word(self._told[3])

    @property
    def title(self) -> str:
        """The sentence as a heading."""
        return self.sentence[0].upper() + self.sentence[1:]


@dataclass(frozen=True, slots=True)
class Loss:
    """The connection was lost: why, and what is not there any more."""

    why: str
    part: LostPart = LostPart.PROCESS


#: Called from the feed's own thread each time the connection is lost, and when more is known about
#: it: a feed that comes back by itself may lose it again.
OnLost = Callable[[Loss], None]


class MessageFeed(Protocol):
    """A connection that speaks the session's messages; the console cannot tell which kind it is.

    The first message is a `Welcome`; after a lost connection a feed that comes back by itself
    begins again with a `Welcome`.
    """

    #: Whether the line to the wizard's terminal takes what is written to it. Set by whoever
    #: measures the terminal, sent to the host with every beat.
    line_ok: bool

    #: Whether anybody is attached to what stands between console and terminal, as far as that is
    #: known.
    attached: bool

    #: Seconds after which a press is not played any more, as the last `Welcome` said.
    stale_after_s: float

    #: Last round trip to the wizard's terminal in microseconds; None while it is unknown. Set by
    #: whoever measures the terminal, shown on the status line.
    round_trip_us: int | None

    def start(self, on_messages: OnMessages, on_lost: OnLost) -> None:
        """Begin to deliver. Returns at once; both callbacks come from another thread."""
        ...

    def ask(self, request: Request) -> int:
        """Send `request` with a fresh `ref`, which is returned; the `Reply` repeats it.

        Safe from any thread, never blocks, never raises: on a lost connection the request goes
        nowhere and no reply comes.
        """
        ...

    def close(self) -> None:
        """Say goodbye and stop delivering; safe to call twice and from any thread."""
        ...
