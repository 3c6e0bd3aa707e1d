"""The console's end of the socket: a reader, a writer and a beat, none of which the screen drives.

A request goes out from the thread that asks, at once, if the kernel takes it; otherwise it waits
in a bounded queue. The stop does not wait behind anything: if the queue is not empty it also takes
a fresh connection of its own, for which the host asks no hello.
"""

from __future__ import annotations

import contextlib
import select
import socket
import threading
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.config.screen_language import say
from woz_tui.console.link.message_feed import Incoming, Loss, LostPart, OnLost, OnMessages
from woz_tui.machine.hidden_line import HiddenLine
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Notice, SessionEnd
from woz_tui.protocol.requests import PROTOCOL, AskStop, Beat, Hello, Reply, Request, Welcome
from woz_tui.protocol.welcome import STALE_S
from woz_tui.system.clock import Clock, RealClock, boot_id

BEAT_S = 0.5
#: How often it is asked who is attached to what stands between console and terminal.
LOOK_S = 1.0
#: The host pulses every second; after so long without a byte from it something is wrong.
SILENCE_S = 3.0
#: How often a lost host is looked for.
RETRY_S = 1.0
#: How long the goodbye may take: what is queued goes out, the host closes its side.
GOODBYE_S = 0.3
#: Requests that may wait for a host that does not read; then the connection is given up.
WAITING_LIMIT = 1000
#: A line from the host may be longer than one to it: the welcome holds the whole state.
LINE_LIMIT = 16 * codec.MAX_LINE
_READ = 256 * 1024
#: Bytes within which a refusal of the hello has its end.
_FIRST = 4096


class HostConnection:
    """A `MessageFeed` from a live robot process.

    When the host closes, dies or goes silent, `on_lost` is told why and it looks for the host
    again, until the session has ended or `close` is called; a host that is found again begins
    with a new `Welcome`, and if it is lost again `on_lost` is called again. Between the two only a
    stop is sent: a host that stood still would carry out the rest when it wakes.

    Args:
        path: The host's socket.
        role: wizard, watcher, program or participant.
        name: What the host may call this console.
        take_over: Whether a wizard who is there already has to watch from now on.
        part: Which part of the experiment's panels this wizard plays; empty: none in particular.
        explain: What is known of a loss besides, for a session on another machine; None: it is on
            this one.
        clock: For the host's silence and the stamps of requests.
        silence_s: Seconds without a byte from the host after which it counts as lost.
        line: What stands between this console and its terminal; None: nothing.
        unattended: Nobody sits here, so that it does not keep the session up.
    """

    def __init__(
        self,
        path: Path,
        *,
        role: str = "wizard",
        name: str = "",
        take_over: bool = False,
        part: str = "",
        explain: Callable[[Loss], Loss] | None = None,
        clock: Clock | None = None,
        silence_s: float = SILENCE_S,
        line: HiddenLine | None = None,
        unattended: bool = False,
    ) -> None:
        #: What the terminal says of its line, by what it answers itself.
        self.line_ok = True
        #: Whether anybody is attached to what stands between, as far as that is known.
        self.attached = True
        self._line = line or HiddenLine()
        self.stale_after_s = STALE_S
        self.round_trip_us: int | None = None
        self._path = path
        self._hello = Hello(
            role=role,
            name=name,
            protocol=PROTOCOL,
            take_over=take_over,
            part=part,
            line=self._line.name,
            unattended=unattended,
        )
        self._clock = clock or RealClock()
        self._silence_us = round(silence_s * 1_000_000)
        self._on_messages: OnMessages = _ignore
        self._on_lost: OnLost = _ignore
        self._explain = explain
        self._lock = threading.Lock()
        self._socket: socket.socket | None = None
        self._waiting: deque[bytes] = deque()
        self._more = threading.Event()
        self._closed = threading.Event()
        self._ended = False
        self._left_us = 0
        self._ref = 0
        self._lost = False
        #: Whether host and console share a clock, so that it can tell how old a request is.
        self._stamps = False
        self._robot_at = ""
        self._opened: socket.socket | None = None

    # -- the feed ----------------------------------------------------------------------------

    def connect(self) -> None:
        """Connect before a screen is opened. Raises `ConnectionError`, in a sentence, if nobody
        listens at the path, the experiment has no such part, or the other machine refuses this
        role.
        """
        try:
            self._opened = self._connect(self._hello)
        except OSError as error:
            raise ConnectionError(
                f"no robot process answers at {self._path} ({error.strerror or error}): it has"
                " ended. `woz run FILE` starts one; its last words are in the *.host.log beside"
                " the session's log"
            ) from error
        if self._hello.part or self._explain is not None:
            # Wait for the beginning of the first answer, which stays unread.
            select.select((self._opened,), (), (), SILENCE_S)
            with contextlib.suppress(BlockingIOError):
                line, end, _ = self._opened.recv(_FIRST, socket.MSG_PEEK).partition(b"\n")
                answer = _decode(line) if end else None
                if isinstance(answer, Reply) and not answer.ok:
                    self._opened.close()
                    raise ConnectionError(_refused(answer))

    def start(self, on_messages: OnMessages, on_lost: OnLost) -> None:
        """Begin, and connect unless that is done. Raises as `connect`."""
        self._on_messages, self._on_lost = on_messages, on_lost
        if self._opened is None:
            self.connect()
        connection, self._opened = self._opened, None
        work: list[tuple[Callable[..., None], tuple[Any, ...]]]
        work = [(self._run, (connection,)), (self._write, ()), (self._beat, ())]
        if self._line.ask:
            work.append((self._watch_line, ()))
        for target, argument in work:
            threading.Thread(
                target=target, args=argument, name=f"link{target.__name__}", daemon=True
            ).start()

    def ask(self, request: Request) -> int:
        """Send `request` with a fresh `ref`, which is returned."""
        with self._lock:
            self._ref += 1
            ref = self._ref
            if self._lost and not isinstance(request, AskStop | Beat):
                return ref
            sent_us = (request.sent_us or self._clock.boot_us()) if self._stamps else 0
            stamped = msgspec.structs.replace(request, ref=ref, sent_us=sent_us)
            line = codec.encode(stamped)
            behind = bool(self._waiting) or self._socket is None
            self._send(line)
        if behind and isinstance(stamped, AskStop):
            sent_aside(self._path, stamped)
        return ref

    def close(self) -> None:
        """Let the host know that this console leaves; what was asked before still arrives."""
        if self._closed.is_set():
            return
        self._closed.set()
        self._more.set()
        with self._lock:
            connection = self._socket
            if connection is not None and not self._waiting:
                _end_writing(connection)

    # -- out ---------------------------------------------------------------------------------

    def _send(self, line: bytes) -> None:
        """With the lock held: as much as the kernel takes, the rest to the writer."""
        connection = self._socket
        if connection is None or self._closed.is_set():
            return
        if not self._waiting:
            line = line[_send_now(connection, line) :]
        if not line:
            return
        if len(self._waiting) < WAITING_LIMIT:
            self._waiting.append(line)
            self._more.set()
        else:
            with contextlib.suppress(OSError):  # the reader notices, and says that it is lost
                connection.shutdown(socket.SHUT_RDWR)

    def _write(self) -> None:
        """Thread: hand the kernel what it did not take at once."""
        while True:
            self._more.wait()
            self._more.clear()
            while (connection := self._pending()) is not None:
                with contextlib.suppress(OSError, ValueError):
                    select.select((), (connection,), (), 0.1)
                self._flush()
            if self._closed.is_set():
                with self._lock:
                    if self._socket is not None:
                        _end_writing(self._socket)
                return

    def _pending(self) -> socket.socket | None:
        with self._lock:
            return self._socket if self._waiting else None

    def _flush(self) -> None:
        with self._lock:
            while self._waiting and self._socket is not None:
                line = self._waiting[0]
                rest = line[_send_now(self._socket, line) :]
                if rest:
                    self._waiting[0] = rest
                    return
                self._waiting.popleft()

    def _beat(self) -> None:
        """Thread: say that the console lives, and whether the line to its terminal does."""
        while not self._closed.wait(BEAT_S):
            if self._pending() is None:  # to a host that does not read it would say nothing
                self.ask(Beat(line_ok=self.line_ok and self.attached))

    def _watch_line(self) -> None:
        """Thread: whoever leaves the multiplexer may have been the wizard, so that driving ends;
        where nobody is left the line is lost.
        """
        before: frozenset[str] = frozenset()
        while not self._closed.is_set():
            clients = self._line.clients()
            if clients is not None:
                left, before = before - clients, clients
                self.attached = bool(clients)
                if left:
                    self.ask(Beat(line_ok=False))
            self._closed.wait(LOOK_S)

    # -- in ----------------------------------------------------------------------------------

    def _connect(self, hello: Hello) -> socket.socket:
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            connection.settimeout(1.0)
            connection.connect(str(self._path))
        except OSError:
            connection.close()
            raise
        connection.setblocking(False)
        with self._lock:
            self._waiting.clear()
            self._socket = connection
            self._ref += 1
            self._send(codec.encode(msgspec.structs.replace(hello, ref=self._ref)))
        return connection

    def _run(self, connection: socket.socket) -> None:
        """Thread: read until the host is lost, then look for it again."""
        again = msgspec.structs.replace(self._hello, take_over=False)
        while True:
            loss = self._read(connection)
            with self._lock:
                self._socket = None
                self._lost = True
                self._waiting.clear()
                connection.close()
            if self._closed.is_set():
                return
            if self._ended:
                loss = Loss(say("link.ended", "the session has ended"))
            found = self._find(again, loss)
            if found is None:
                return
            connection = found

    def _find(self, hello: Hello, loss: Loss) -> socket.socket | None:
        """Tell of the loss, and again when more is known, until the host is there."""
        told = None
        while True:
            known = loss if self._ended or self._explain is None else self._explain(loss)
            if known != told:
                told = known
                self._on_lost(known)
            if self._ended or self._closed.wait(RETRY_S):
                return None
            with contextlib.suppress(OSError):
                return self._connect(hello)

    def _read(self, connection: socket.socket) -> Loss:
        """Deliver batches until the connection ends; returns why it did."""
        rest = b""
        heard_us: int | None = None  # a host found again may take its time for the first word
        while not self._said_goodbye():
            ready, _, _ = select.select((connection,), (), (), 0.1)
            now = self._clock.now_us()
            if not ready:
                if heard_us is not None and now - heard_us > self._silence_us:
                    silent_s = (now - heard_us) / 1e6
                    why = say(
                        "link.nothing_came",
                        "nothing has come from it for {seconds:.0f} s",
                        seconds=silent_s,
                    )
                    return Loss(why, LostPart.ANSWER)
                continue
            try:
                data = connection.recv(_READ)
            except BlockingIOError:
                continue
            except OSError as error:
                why = say("link.broke", "the connection broke: {why}", why=error.strerror)
                return Loss(why)
            if not data:
                if not self._robot_at:
                    return Loss(say("link.closed_by_it", "it closed the connection"))
                why = say("link.cut", "the network is cut, or the robot's computer is off")
                return Loss(why, LostPart.LINE)
            first, heard_us = heard_us is None, now
            lines = (rest + data).split(b"\n")
            rest = lines.pop()
            if len(rest) > LINE_LIMIT:
                endless = say("link.endless", "it sent a line without end")
                return Loss(endless, LostPart.ANSWER)
            batch = [_decode(line) for line in lines if line.strip()]
            if first and batch and isinstance(batch[0], Reply) and not batch[0].ok:
                why = say("link.refuses", "it refuses this console: {why}", why=_refused(batch[0]))
                return Loss(why, LostPart.ANSWER)
            self._deliver(batch)
        return Loss(say("link.closed", "closed"))

    def _said_goodbye(self) -> bool:
        """Whether this side has left and the host had its time to notice."""
        if not self._closed.is_set():
            return False
        self._left_us = self._left_us or self._clock.now_us()
        return self._clock.now_us() - self._left_us > GOODBYE_S * 1_000_000

    def _deliver(self, batch: list[Incoming]) -> None:
        if not batch or self._closed.is_set():
            return
        for message in batch:
            if isinstance(message, SessionEnd):
                self._ended = True
            elif isinstance(message, Welcome):
                self._stamps = bool(message.boot_id) and message.boot_id == boot_id()
                self._robot_at = message.robot_at
                self.stale_after_s = message.settings.stale_after or STALE_S
                self._lost = False
        self._on_messages(batch)


def sent_aside(path: Path, stop: AskStop) -> bool:
    """Whether a connection of its own has taken the stop, for which the host asks no hello; nothing
    is waited for.
    """
    with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX) as aside:
        aside.setblocking(False)
        aside.connect(str(path))
        line = codec.encode(stop)
        return aside.send(line) == len(line)
    return False


def _refused(reply: Reply) -> str:
    return f"{reply.reason}: {reply.hint}" if reply.hint else reply.reason


def _decode(line: bytes) -> Incoming:
    try:
        return codec.decode_incoming(line)
    except codec.WireError as error:
        return Notice(
            level="error",
            text=say(
                "link.no_message",
                "the robot process sent a line that is no message: {error}",
                error=error,
            ),
        )


def _send_now(connection: socket.socket, line: bytes) -> int:
    """How many bytes the kernel took; a broken connection is the reader's to notice."""
    try:
        return connection.send(line, socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL)
    except BlockingIOError:
        return 0
    except OSError:
        return len(line)


def _end_writing(connection: socket.socket) -> None:
    """The host reads to the end, then sees that we left."""
    with contextlib.suppress(OSError):
        connection.shutdown(socket.SHUT_WR)


def _ignore(told: object) -> None:
    """Nobody listens yet."""
