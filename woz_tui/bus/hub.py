"""Stamps and records every message, then gives it to listeners and subscriptions."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

import msgspec

from woz_tui.protocol import codec
from woz_tui.protocol.messages import Message
from woz_tui.system.clock import Clock, timestamp

#: What a listener may have of a message; None: nothing of it.
MessageFilter = Callable[[Message], Message | None]
#: Called with the stamped message and its line before anybody else; must not raise, must not wait.
Record = Callable[[Message, bytes], None]

M = TypeVar("M", bound=Message)


class Subscription:
    """A bounded buffer of lines for one client. When it is full the oldest samples are dropped,
    other lines never.

    A client that falls so far behind that even without samples `capacity` lines are waiting is
    marked `overrun`; its owner closes it, and it may come back for the whole state.
    """

    def __init__(
        self,
        capacity: int,
        samples: bool,
        wake: Callable[[], None],
        redact: MessageFilter | None = None,
    ) -> None:
        self.redact = redact
        self._capacity = capacity
        self._wants_samples = samples
        self._wake = wake
        # Two queues: the oldest sample is at hand, however many other lines wait. A sample has the
        # number of lines in front of it; those are bare bytes, which the garbage collector need not
        # visit.
        self._lines: deque[bytes] = deque()
        self._samples: deque[tuple[int, bytes]] = deque()
        self.dropped = 0
        self.overrun = False

    def offer(self, sample: bool, line: bytes) -> None:
        """Take a line in; a full buffer first drops its oldest sample."""
        if sample and not self._wants_samples:
            return
        waiting = len(self._lines) + len(self._samples)
        if waiting >= self._capacity:
            if self._samples:
                self._samples.popleft()
                self.dropped += 1
            elif sample:
                self.dropped += 1
                return
            else:
                self.overrun = True
        if sample:
            self._samples.append((len(self._lines), line))
        else:
            self._lines.append(line)
        if not waiting:
            self._wake()

    def take_all(self) -> list[bytes]:
        """All waiting lines, oldest first."""
        lines, others, given = [], list(self._lines), 0
        for ahead, sample in self._samples:
            lines += others[given:ahead]
            lines.append(sample)
            given = ahead
        lines += others[given:]
        self._lines.clear()
        self._samples.clear()
        return lines


@dataclass(frozen=True, slots=True)
class _Listener:
    """Who is called, with which kinds of messages (none named: all), and with which of them not."""

    call: Callable[[Any], object]
    kinds: tuple[type[Message], ...]
    but: tuple[type[Message], ...]

    def hears(self, kind: type[Message]) -> bool:
        """Whether it is called with messages of this kind."""
        return issubclass(kind, self.kinds or Message) and not issubclass(kind, self.but)


class Hub:
    """Stamps, records and distributes. Used from one thread, the robot process's event loop."""

    def __init__(self, clock: Clock, record: Record) -> None:
        self._clock = clock
        self._record = record
        self._zero_us = clock.now_us()
        self._seq = 0
        self._listeners: list[_Listener] = []
        #: Those that are not called for the time being.
        self._passed_by: frozenset[Callable[[Any], object]] = frozenset()
        #: Whom a kind of message calls, in order; found when the first one comes.
        self._hearers: dict[type[Message], tuple[Callable[[Any], object], ...]] = {}
        self._subscriptions: list[Subscription] = []
        self._undelivered: deque[Message] = deque()
        self._delivering = False
        #: The connection whose request is carried out at the moment; empty: none is.
        self._requester = ""

    @contextmanager
    def on_behalf_of(self, console: str) -> Iterator[None]:
        """While this lasts, messages say that a request over the connection `console` was why."""
        self._requester = console
        try:
            yield
        finally:
            self._requester = ""

    @property
    def seq(self) -> int:
        """Number of the last message."""
        return self._seq - 1

    def now(self) -> int:
        """Microseconds since the session began: the `t` axis."""
        return self.t(self._clock.now_us())

    def t(self, clock_us: int) -> int:
        """A time of the clock as microseconds since the session began."""
        return clock_us - self._zero_us

    def publish(self, message: M, t: int | None = None) -> M:
        """Stamp `message`, have it recorded, hand it round; returns it as stamped. `t`: the moment
        that was just taken for it with `now`, for a message that counts from there.
        """
        sample = codec.is_sample(message)
        if self._requester and message.names_console:
            message = msgspec.structs.replace(message, console=self._requester)
        stamped = msgspec.structs.replace(
            message,
            seq=self._seq,
            t=self.now() if t is None else t,
            ts="" if sample else timestamp(self._clock.wall()),
        )
        self._seq += 1
        line = codec.encode(stamped)
        self._record(stamped, line)
        seen: dict[MessageFilter | None, bytes | None] = {None: line}
        for subscription in self._subscriptions:
            redact = subscription.redact
            if redact is not None and redact not in seen:
                shown = redact(stamped)
                if shown is None:
                    seen[redact] = None
                else:
                    seen[redact] = line if shown is stamped else codec.encode(shown)
            if (own := seen[redact]) is not None:
                subscription.offer(sample, own)
        self._undelivered.append(stamped)
        self._deliver()
        return stamped

    def _deliver(self) -> None:
        # A listener may publish in its turn; everybody still hears everything in order of `seq`.
        if self._delivering:
            return
        self._delivering = True
        try:
            while self._undelivered:
                message = self._undelivered.popleft()
                hearers = self._hearers.get(type(message))
                if hearers is None:
                    hearers = self._hearers[type(message)] = tuple(
                        each.call
                        for each in self._listeners
                        if each.hears(type(message)) and each.call not in self._passed_by
                    )
                for call in hearers:
                    call(message)
        finally:
            self._delivering = False

    def listen(
        self,
        listener: Callable[[Any], object],
        *kinds: type[Message],
        but: tuple[type[Message], ...] = (),
    ) -> None:
        """Call `listener` with every message of these kinds (none named: of all) but those of
        `but`, in the loop; it must be quick and must not raise. Who listens first hears first.
        """
        self._listeners.append(_Listener(listener, kinds, but))
        self._hearers.clear()

    def ignore(self, listener: Callable[[Any], object], *kinds: type[Message]) -> None:
        """Undo `listen` with the same kinds: it is not called with the next message."""
        self._listeners.remove(_Listener(listener, kinds, ()))
        self._hearers.clear()

    def pass_by(self, listeners: Iterable[Callable[[Any], object]]) -> None:
        """From the next message on these are not called, until others are named; each keeps its
        place among those who listen.
        """
        self._passed_by = frozenset(listeners)
        self._hearers.clear()

    def subscribe(
        self,
        capacity: int,
        samples: bool,
        wake: Callable[[], None],
        redact: MessageFilter | None = None,
    ) -> Subscription:
        """A buffer of coming lines; `wake` is called when it stops being empty. `redact` gives what
        its owner may have of each message; None: all.
        """
        subscription = Subscription(capacity, samples, wake, redact)
        self._subscriptions.append(subscription)
        return subscription

    def unsubscribe(self, subscription: Subscription) -> None:
        """No more lines for it."""
        if subscription in self._subscriptions:
            self._subscriptions.remove(subscription)
