"""A session as a program sees it, for asyncio: verbs and actions to await, messages to follow."""

from __future__ import annotations

import asyncio
import contextlib
import time
import weakref
from collections import OrderedDict, deque
from collections.abc import AsyncIterator, Callable, Coroutine, Generator, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar, overload

import msgspec

from woz_tui.client.woz_errors import (
    WozConnectionError,
    WozError,
    WozRefusedError,
    WozUnknownVerbError,
    code_of,
    error_of,
    error_of_motion,
)
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.description import Description, Prediction, VerbDescription
from woz_tui.protocol.kinds import prediction_kinds
from woz_tui.protocol.panels import PanelView
from woz_tui.system import session_sockets
from woz_tui.system.clock import boot_id
from woz_tui.system.tasks import end_tasks

#: Bytes that a line from the robot process may have: a welcome grows with its experiment.
MOST_BYTES = 16 << 20
#: Messages that a stream keeps for whoever does not read it; then samples are left out.
MOST_KEPT = 4096
#: Ends that are remembered until their request's reply is here.
_ENDS_KEPT = 256

#: What happens while the lane is occupied; empty: what the experiment says.
Busy = Literal["", "queue", "replace", "refuse"]
RunEnd = m.ActionEnd | m.End
Motion = m.MotionArrived | m.MotionInterrupted
#: A message of the session, or one of a newer version as it came.
Incoming = m.Message | dict[str, Any]

T = TypeVar("T")
M = TypeVar("M", bound=m.Message)


class WozRun:
    """An action or a command that was begun; awaiting it waits for its end.

    Attributes:
        id: As `run` or `command` in messages.
        end: How it ended; None: it goes on.
        recorded: Whether it is in the log. It is not where the wizard goes on without a record.
    """

    def __init__(self, client: WozClient, run: str, arrives: bool, recorded: bool = True) -> None:
        self.id = run
        self.recorded = recorded
        self.end: RunEnd | None = None
        self._client = client
        self._arrives = arrives
        self._over: asyncio.Future[RunEnd] = asyncio.get_running_loop().create_future()
        # Nobody has to wait for it: what went wrong is no news then.
        self._over.add_done_callback(lambda over: over.cancelled() or over.exception())

    def __await__(self) -> Generator[Any, None, RunEnd]:
        """Wait until it has ended, and its motion has arrived if it has one.

        Raises:
            WozFailedError: It did not work.
            WozStoppedError: The stop or somebody else cut it short.
            WozSupersededError: Something newer took its place.
            WozConnectionError: The connection is lost; nobody knows how it goes on.
        """
        try:
            return (yield from asyncio.shield(self._over).__await__())
        except WozError as error:
            raise error.again() from None

    async def cancel(self) -> None:
        """Cut it short. Raises `WozRefusedError` if it is over already."""
        await self._client.request(r.AskCancel(run=self.id))

    # -- what the connection tells it ------------------------------------------------------------

    def on_end(self, end: RunEnd) -> bool:
        """How it ended; says whether nothing more is to be heard of it."""
        self.end = end
        if self._over.done():
            return True
        error = error_of(end)
        if error is None and self._arrives:
            return False
        self._finish(error)
        return True

    def on_motion(self, motion: Motion) -> None:
        """How its motion ended."""
        if not self._over.done():
            interrupted = isinstance(motion, m.MotionInterrupted)
            self._finish(error_of_motion(motion) if interrupted else None)  # type: ignore[arg-type]

    def lose(self, error: WozConnectionError) -> None:
        """The connection is lost."""
        if not self._over.done():
            self._over.set_exception(error)

    def _finish(self, error: Exception | None) -> None:
        if error is not None:
            self._over.set_exception(error)
        elif self.end is not None:
            self._over.set_result(self.end)


class MessageStream(Generic[T]):
    """The session's messages from the moment it was made: `async for message in stream`.

    It ends with the session. A connection that is lost raises `WozConnectionError`.
    """

    def __init__(self, kinds: tuple[type[m.Message], ...], before: Iterable[m.Message]) -> None:
        self._kinds = kinds
        self._waiting: deque[Any] = deque(filter(self._wants, before))
        self._more = asyncio.Event()
        self._over: WozConnectionError | None = None
        self._ended = False
        #: Samples that were left out because nobody read.
        self.dropped = 0

    def __aiter__(self) -> MessageStream[T]:
        return self

    async def __anext__(self) -> T:
        while not self._waiting:
            if self._ended:
                raise StopAsyncIteration
            if self._over is not None:
                raise self._over.again()
            self._more.clear()
            await self._more.wait()
        message: T = self._waiting.popleft()
        return message

    # -- what the connection tells it ------------------------------------------------------------

    def add(self, message: Incoming) -> None:
        """A message came."""
        if self._wants(message):
            sample = isinstance(message, m.Message) and codec.is_sample(message)
            if sample and len(self._waiting) >= MOST_KEPT:
                self.dropped += 1
                return
            self._waiting.append(message)
        self._ended = self._ended or isinstance(message, m.SessionEnd)
        self._more.set()

    def close(self, error: WozConnectionError) -> None:
        """Nothing more will come."""
        self._over = error
        self._more.set()

    def _wants(self, message: Incoming) -> bool:
        return not self._kinds or isinstance(message, self._kinds)


@dataclass
class AwaitedReply:
    """A request that was sent. `arrives`: whether what it begins has a motion; None: it begins
    nothing. `run`: what it has begun.
    """

    reply: asyncio.Future[r.Reply]
    arrives: bool | None = None
    run: WozRun | None = None


class WozClient:
    """One connection to a session; `connect` makes it.

    Each verb of the robot is a method, with its main argument first: `await woz.say("Hello")`,
    `await woz.gaze(yaw=20, seconds=2)`. It returns when the robot has done it and the motion has
    arrived. Cancelling the wait (`asyncio.timeout`) cuts the verb short.

    Attributes:
        welcome: What the session was when this connected.
        description: Its verbs and sensors.
        panels: Panels and their actions as they are now.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer
        self._refs = 0
        self._replies: dict[int, AwaitedReply] = {}
        #: What goes on, and what has ended before its reply came, by run or command.
        self._runs: dict[str, WozRun] = {}
        self._ends: OrderedDict[str, RunEnd] = OrderedDict()
        self._streams: weakref.WeakSet[MessageStream[Any]] = weakref.WeakSet()
        self._lost: WozConnectionError | None = None
        self._ended = False
        self._task: asyncio.Task[None] | None = None
        self._zero_us = 0
        #: How far `now` may be from the session's own clock, in seconds; 0 on the same machine.
        self.clock_uncertainty = 0.0
        self._stamps = False
        self.welcome: r.Welcome
        self.description = Description()
        self.panels: list[PanelView] = []

    # -- verbs and actions -----------------------------------------------------------------------

    async def say(
        self,
        text: str,
        /,
        *,
        driver: str = "",
        when_busy: Busy = "",
        at: float = 0.0,
        **args: m.Json,
    ) -> m.Done:
        """Speak; returns when it has been said. `driver`, `when_busy` and `at` as for `perform`;
        further arguments: those of the robot's `say`.
        """
        said = {"text": text, **args}
        return await self.perform("say", said, driver=driver, when_busy=when_busy, at=at)

    async def perform(
        self,
        verb: str,
        args: Mapping[str, m.Json] | None = None,
        /,
        *,
        driver: str = "",
        when_busy: Busy = "",
        at: float = 0.0,
        **more: m.Json,
    ) -> m.Done:
        """Carry out any verb; returns when it is done and its motion has arrived.

        `driver`: who, where several offer it. `when_busy`: what to do while its lane is occupied.
        `at`: when it is to begin, in seconds as `now` counts them (0: now).

        Raises:
            WozRefusedError: It was not begun; the reason says why.
            WozError: As awaiting a `WozRun`.
        """
        run = await self.begin(verb, args, driver=driver, when_busy=when_busy, at=at, **more)
        end = await self._to_its_end(run)
        assert isinstance(end, m.Done)
        return end

    async def begin(
        self,
        verb: str,
        args: Mapping[str, m.Json] | None = None,
        /,
        *,
        driver: str = "",
        when_busy: Busy = "",
        at: float = 0.0,
        **more: m.Json,
    ) -> WozRun:
        """As `perform`, but returns as soon as it is accepted."""
        call = {**(args or {}), **more}
        moment = round(at * 1e6)
        request = r.AskVerb(verb=verb, args=call, on=driver, when_busy=when_busy, at=moment)
        return await self._begin(request, any(view.arrives for view in self._views(verb, driver)))

    async def press(
        self,
        action: str,
        *,
        when_busy: Busy = "",
        at: float = 0.0,
        slots: Mapping[str, str] | None = None,
    ) -> m.ActionDone:
        """Play an action of the experiment, by its name, its label or its key, to its end.

        `when_busy` and `at` as for `perform`, which raises the same errors. `slots`: what stands in
        the slots of its sentences.
        """
        run = await self.begin_action(action, when_busy=when_busy, at=at, slots=slots)
        end = await self._to_its_end(run)
        assert isinstance(end, m.ActionDone)
        return end

    async def begin_action(
        self,
        action: str,
        *,
        when_busy: Busy = "",
        at: float = 0.0,
        slots: Mapping[str, str] | None = None,
    ) -> WozRun:
        """As `press`, but returns as soon as it is accepted."""
        name, moment = self._action(action), round(at * 1e6)
        given = dict(slots or {})
        request = r.AskAction(action=name, when_busy=when_busy, at=moment, slots=given)
        return await self._begin(request, arrives=False)

    def __getattr__(self, verb: str) -> Callable[..., Coroutine[Any, Any, m.Done]]:
        """Each verb of the robot is a method; a first value without a name is its main argument."""
        views = self._views(verb) if not verb.startswith("_") else []
        if not views:
            known = ", ".join(dict.fromkeys(view.name for view in self._all_views()))
            raise WozUnknownVerbError(f"this session has no verb {verb!r}", f"it has {known}")

        async def perform(*main: m.Json, **args: Any) -> m.Done:
            names = [argument.name for argument in views[0].arguments]
            if len(main) > min(1, len(names)):
                one = f"one value without a name: {names[0]}" if names else "no values"
                raise WozRefusedError(f"{verb} takes {one}")
            return await self.perform(verb, dict(zip(names, main, strict=False)), **args)

        return perform

    async def predict(
        self, verb: str, args: Mapping[str, m.Json] | None = None, /, **more: m.Json
    ) -> Prediction:
        """How a verb would go if it began now: how long, and when its words and strokes would come.
        Nothing moves; null is what the robot does not know.

        Raises `WozRefusedError` if it would be refused.
        """
        call = {**(args or {}), **more}
        return await self._predicted(r.AskPredict(verb=verb, args=call))

    async def predict_action(self, action: str) -> Prediction:
        """The same for an action of the experiment."""
        return await self._predicted(r.AskPredict(action=self._action(action)))

    async def _predicted(self, request: r.AskPredict) -> Prediction:
        kind = prediction_kinds().get(request.verb, Prediction)
        return msgspec.convert((await self.request(request)).data, kind)

    # -- the rest of a session -------------------------------------------------------------------

    @property
    def path(self) -> Path:
        """The session's socket."""
        return Path(self._writer.get_extra_info("peername"))

    async def mark(self, text: str = "") -> None:
        """Put a marker into the log."""
        await self.request(self.marker(text))

    def mark_soon(self, text: str = "") -> None:
        """Put a marker into the log without waiting; its moment (`at`) is that of this call."""
        self.send_soon(self.marker(text))

    def marker(self, text: str = "") -> r.AskMarker:
        """The request for a marker of this moment, to be sent later."""
        return r.AskMarker(text=text, at=round(self.now() * 1e6))

    def send_soon(self, request: r.Request) -> None:
        """Send a request and do not wait for its reply. Raises `WozConnectionError`."""
        self._write(request)

    async def note(self, text: str) -> None:
        """Put a note into the log."""
        await self.request(r.AskNote(text=text))

    async def stop(self) -> m.StopConfirmed:
        """Stop everything; returns when it is known which drivers confirmed."""
        stream = self.messages(m.StopConfirmed)
        await self.request(r.AskStop())
        async for message in stream:
            if message.scope != "drive":
                return message
        raise WozConnectionError("the session ended before the stop was confirmed")

    async def release(self, missing: Iterable[str] = ()) -> None:
        """Release the stop. `missing`: drivers of which you know that they have not confirmed it.

        Raises `WozRefusedError` if it is not pressed, or others have not confirmed it.
        """
        await self.request(r.AskRelease(missing=[*missing]))

    async def request(self, request: r.Request) -> r.Reply:
        """Send any request of the protocol; `ref` and stamp are filled in.

        Raises:
            WozRefusedError: The answer is no.
            WozConnectionError: No answer will come.
        """
        return (await self._ask(request))[0]

    @overload
    def messages(self, *, held: bool = False) -> MessageStream[Incoming]: ...
    @overload
    def messages(self, *kinds: type[M], held: bool = False) -> MessageStream[M]: ...
    def messages(self, *kinds: type[m.Message], held: bool = False) -> MessageStream[Any]:
        """The session's messages from now on, of these kinds (none: of all).

        `held`: begin with those that still held when this connected: how each driver is, the
        engagement state, the stop if it is pressed. Samples come only with `connect(samples=True)`.
        """
        before = (codec.decode_message(line) for line in self.welcome.state) if held else ()
        stream: MessageStream[Any] = MessageStream(kinds, before)
        if self._lost is not None:
            stream.close(self._lost)
        self._streams.add(stream)
        return stream

    # -- time --------------------------------------------------------------------------------------

    def now(self) -> float:
        """Seconds since the session began: the axis of the messages' `t`."""
        return self.session_time(time.monotonic())

    def session_time(self, monotonic: float) -> float:
        """A time of `time.monotonic()` in seconds since the session began; times of PsychoPy count
        from its own import.
        """
        return monotonic - self._zero_us / 1e6

    def monotonic(self, t: int) -> float:
        """A message's `t` as `time.monotonic()` of this computer, in seconds."""
        return (self._zero_us + t) / 1e6

    # -- beginning and ending ----------------------------------------------------------------------

    async def open(self, hello: r.Hello) -> None:
        """Say hello; `connect` does it. Raises `WozError`."""
        began = time.monotonic_ns() // 1000
        self._writer.write(codec.encode(hello))
        try:
            line = await self._reader.readline()
        except (OSError, ValueError) as error:
            raise WozConnectionError(f"the session did not answer: {error}") from error
        ended = time.monotonic_ns() // 1000
        answer = codec.decode_incoming(line) if line else None
        if isinstance(answer, r.Reply):
            raise WozRefusedError(answer.reason, answer.hint, code_of(answer))
        if not isinstance(answer, r.Welcome):
            raise WozConnectionError("the session closed the connection")
        self.welcome, self.panels = answer, answer.panels
        self._stamps = bool(answer.boot_id) and answer.boot_id == boot_id()
        exact = answer.clock_us
        if self._stamps and began <= exact + answer.t <= ended:
            self._zero_us = exact
        else:
            self._zero_us = (began + ended) // 2 - answer.t
            self.clock_uncertainty = (ended - began) / 2e6
        self._task = asyncio.create_task(self._read(), name="woz client")
        reply = await self.request(r.AskDescribe())
        self.description = msgspec.convert(reply.data, Description)

    async def close(self) -> None:
        """Leave; what was begun goes on."""
        self._writer.close()
        self._lose(WozConnectionError("the connection was closed"))
        await end_tasks(self._task)
        with contextlib.suppress(OSError):
            await self._writer.wait_closed()

    # -- the wire ----------------------------------------------------------------------------------

    async def _begin(self, request: r.Request, arrives: bool) -> WozRun:
        _, run = await self._ask(request, arrives)
        assert run is not None
        return run

    async def _ask(
        self, request: r.Request, arrives: bool | None = None
    ) -> tuple[r.Reply, WozRun | None]:
        ref = self._write(request)
        asked = AwaitedReply(asyncio.get_running_loop().create_future(), arrives)
        self._replies[ref] = asked
        try:
            reply = await asked.reply
        except asyncio.CancelledError:
            if asked.run is not None:  # cancelled in the moment in which the reply came
                self._cancel(asked.run.id)
            elif asked.arrives is not None:  # it may wait for somebody who approves it
                with contextlib.suppress(WozConnectionError):
                    self._write(r.AskCancel(asked=ref))
            raise
        if not reply.ok:
            raise WozRefusedError(reply.reason, reply.hint, code_of(reply))
        return reply, asked.run

    def check(self) -> None:
        """Raises `WozConnectionError` if the connection is lost. From any thread."""
        if self._lost is not None:
            raise self._lost.again()

    def _write(self, request: r.Request) -> int:
        self.check()
        self._refs += 1
        stamp = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000 if self._stamps else 0
        request = msgspec.structs.replace(request, ref=self._refs, sent_us=stamp)
        self._writer.write(codec.encode(request))
        return self._refs

    async def _to_its_end(self, run: WozRun) -> RunEnd:
        try:
            return await run
        except asyncio.CancelledError:
            self._cancel(run.id)
            raise

    def _cancel(self, run: str) -> None:
        """Cut it short, and do not wait: whoever waited has been cancelled."""
        with contextlib.suppress(WozConnectionError):
            self._write(r.AskCancel(run=run))

    async def _read(self) -> None:
        why = "the session closed the connection"
        try:
            while line := await self._reader.readline():
                self._take(codec.decode_incoming(line))
        except (OSError, ValueError) as error:
            why = f"the connection is lost: {error}"
        finally:
            hint = "" if self._ended else "`woz attach` shows whether it still runs"
            self._lose(WozConnectionError(why, hint))

    def _take(self, line: Any) -> None:
        match line:
            case r.Reply():
                self._replied(line)
            case r.PanelsChanged():
                self.panels = line.panels
            case m.Message() | dict():
                self._follow(line)
                for stream in [*self._streams]:
                    stream.add(line)

    def _replied(self, reply: r.Reply) -> None:
        asked = self._replies.pop(reply.ref, None)
        if asked is None:
            return
        if asked.arrives is not None and reply.ok:
            if asked.reply.cancelled():  # nobody waits for it any more
                self._cancel(reply.run)
                return
            asked.run = run = WozRun(self, reply.run, asked.arrives, reply.recorded)
            early = self._ends.get(run.id)
            if early is None or not run.on_end(early):
                self._runs[run.id] = run
        if not asked.reply.done():
            asked.reply.set_result(reply)

    def _follow(self, message: Incoming) -> None:
        match message:
            case m.ActionEnd(run=run):
                self._over(run, message)
            case m.End(command=command):
                self._over(command, message)
            case m.MotionArrived(command=command) | m.MotionInterrupted(command=command):
                moved = self._runs.pop(command, None)
                if moved is not None:
                    moved.on_motion(message)
            case m.SessionEnd():
                self._ended = True

    def _over(self, run: str, end: RunEnd) -> None:
        """A run has ended; the reply that names it may come later."""
        begun = self._runs.get(run)
        if begun is not None:
            if begun.on_end(end):
                del self._runs[run]
            return
        self._ends[run] = end
        if len(self._ends) > _ENDS_KEPT:
            self._ends.popitem(last=False)

    def _lose(self, error: WozConnectionError) -> None:
        if self._lost is not None:
            return
        self._lost = error
        for asked in self._replies.values():
            if not asked.reply.done():
                asked.reply.set_exception(error)
        for run in self._runs.values():
            run.lose(error)
        for stream in [*self._streams]:
            stream.close(error)

    # -- what is known -----------------------------------------------------------------------------

    def _all_views(self) -> list[VerbDescription]:
        """All verbs; none before they were told."""
        description: Description = self.__dict__.get("description", Description())
        return description.verbs

    def _views(self, verb: str, driver: str = "") -> list[VerbDescription]:
        return [
            view
            for view in self._all_views()
            if view.name == verb and driver in ("", view.driver, view.driver.partition(".")[0])
        ]

    def _action(self, wanted: str) -> str:
        actions = [action for panel in self.panels for action in panel.actions]
        for field in ("name", "label", "key"):
            for action in actions:
                if getattr(action, field) == wanted:
                    return action.name
        return wanted


@contextlib.asynccontextmanager
async def connect(
    session: str | Path = "",
    *,
    name: str = "program",
    samples: bool = False,
    sees: Literal["", "all", "wizard"] = "",
    part: str = "",
    unattended: bool = False,
) -> AsyncIterator[WozClient]:
    """Connect to a session of this user until the block ends.

    Args:
        session: Its code (`S01`) or its socket's path; empty: `$WOZ_SOCKET`, or the only one there.
        name: What the wizard's screen and the log call this program.
        samples: Whether `messages` has the sensors' readings, too.
        sees: `wizard`: no more than the wizard sees, for a screen that the wizard can read.
        part: Plays only what the wizard of this part plays (`for` in the experiment); empty: all.
        unattended: It keeps no session up that everybody else has left.

    Raises:
        WozConnectionError: Nobody answers there, or it is not clear which session is meant.
        WozRefusedError: The session does not take this program.
    """
    path = _socket_of(session)
    try:
        reader, writer = await asyncio.open_unix_connection(str(path), limit=MOST_BYTES)
    except OSError as error:
        raise WozConnectionError(
            f"no session answers at {path}: {error.strerror or error}", "`woz run FILE` starts one"
        ) from error
    client = WozClient(reader, writer)
    stream = "everything" if samples else "actions"
    try:
        hello = r.Hello(role="program", name=name, protocol=r.PROTOCOL, stream=stream, sees=sees)
        hello = msgspec.structs.replace(hello, part=part, unattended=unattended)
        await client.open(hello)
        yield client
    finally:
        await client.close()


def _socket_of(session: str | Path) -> Path:
    try:
        if session:
            return (
                Path(session) if "/" in str(session) else session_sockets.socket_path(str(session))
            )
        running = session_sockets.running()
    except session_sockets.SessionSocketError as error:
        raise WozConnectionError(str(error)) from error
    if not running:
        raise WozConnectionError("no session is running", "`woz run FILE` starts one")
    if len(running) > 1:
        names = ", ".join(path.stem for path in running)
        raise WozConnectionError(f"several sessions are running: {names}", "name one of them")
    return running[0]
