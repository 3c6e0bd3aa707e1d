"""A feed that plays what a test tells it to and keeps what the console asks."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterable
from typing import Any

import msgspec

from woz_tui.console.link.message_feed import Incoming, Loss, LostPart, OnLost, OnMessages
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import STALE_S
from woz_tui.session.redactor import Redactor

Answer = Callable[[r.Request, int], r.Reply]


def redacted_welcome(welcome: r.Welcome, redactor: Redactor | None = None) -> r.Welcome:
    """A welcome as a robot process sends it to a wizard."""
    redactor = Redactor() if redactor is None else redactor
    redactor.adopt(welcome.settings.study)

    def lines(raw: Iterable[msgspec.Raw]) -> list[msgspec.Raw]:
        found = []
        for line in raw:
            message = codec.decode_message(bytes(line))
            redactor.apply(message)
            shown = redactor.message(message)
            if shown is not None:
                found.append(msgspec.Raw(codec.encode(shown).rstrip()))
        return found

    return msgspec.structs.replace(
        redactor.welcome(welcome), recent=lines(welcome.recent), state=lines(welcome.state)
    )


class ScriptedFeed:
    """A `Feed` without a socket. Everything goes through the wire's codec, as over a socket.

    `answers` may hold, for a kind of request, what makes the reply; all others get a plain yes.
    """

    def __init__(self) -> None:
        self.line_ok = self.attached = True
        self.stale_after_s = STALE_S
        self.round_trip_us: int | None = None
        self.asked: list[r.Request] = []
        self.closed = False
        self.answers: dict[type, Answer] = {}
        self._on_messages: OnMessages = lambda batch: None
        self._on_lost: OnLost = lambda why: None
        self._first: list[Incoming] = []
        self._redactor = Redactor()

    def begin_with(self, *messages: Incoming) -> None:
        """What is delivered as soon as the console listens."""
        self._first = list(messages)

    def start(self, on_messages: OnMessages, on_lost: OnLost) -> None:
        self._on_messages, self._on_lost = on_messages, on_lost
        if self._first:
            self.deliver(*self._first)

    def ask(self, request: r.Request) -> int:
        ref = len(self.asked) + 1
        sent = codec.decode_request(codec.encode(msgspec.structs.replace(request, ref=ref)))
        self.asked.append(sent)
        answer = self.answers.get(type(request))
        self.deliver(answer(sent, ref) if answer is not None else r.Reply(ref=ref, ok=True))
        return ref

    def close(self) -> None:
        self.closed = True

    def _seen(self, message: Incoming) -> Incoming | None:
        """What a robot process sends to a wizard."""
        redactor = self._redactor
        match message:
            case r.Welcome():
                return redacted_welcome(message, redactor)
            case r.PanelsChanged():
                if message.study is not None:
                    redactor.adopt(message.study)
                return redactor.panels(message)
            case r.Reply():
                return redactor.reply(message)
            case m.Message():
                redactor.apply(message)
                shown: Any = redactor.message(message)
                return shown  # type: ignore[no-any-return]
        return message

    def deliver(self, *messages: Incoming) -> None:
        """Hand a batch over from another thread, as a link does."""
        batch = [
            codec.decode_incoming(codec.encode(message))
            if isinstance(message, msgspec.Struct)
            else message
            for message in map(self._seen, messages)
            if message is not None
        ]
        self._elsewhere(functools.partial(self._on_messages, batch))

    def cut(self, why: str, part: LostPart = LostPart.PROCESS) -> None:
        """Lose the connection."""
        self._elsewhere(functools.partial(self._on_lost, Loss(why, part)))

    def last(self, kind: type[r.Request]) -> r.Request | None:
        """The last request of a kind."""
        return next((asked for asked in reversed(self.asked) if isinstance(asked, kind)), None)

    def _elsewhere(self, work: Callable[[], None]) -> None:
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()


def raw(messages: Iterable[m.Message]) -> list[msgspec.Raw]:
    """Messages as a welcome carries them."""
    return [msgspec.Raw(codec.encode(message).rstrip()) for message in messages]
