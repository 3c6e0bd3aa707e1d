"""The client for programs without asyncio: `with connect() as woz: woz.say("Hello")`.

The connection lives in a thread of its own, so that messages are taken while the program does
other things. Every method waits as long as its twin of `WozClient`, and raises the same errors.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import threading
from collections.abc import Callable, Coroutine, Iterator
from pathlib import Path
from typing import Any, Concatenate, Literal, ParamSpec, TypeVar, overload

from woz_tui.client import woz_client
from woz_tui.client.woz_client import Incoming, RunEnd, WozClient, WozRun
from woz_tui.client.woz_errors import WozConnectionError
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.description import Description
from woz_tui.protocol.panels import PanelView

P = ParamSpec("P")
T = TypeVar("T")
M = TypeVar("M", bound=m.Message)


def _waits(
    method: Callable[Concatenate[WozClient, P], Coroutine[Any, Any, T]],
) -> Callable[Concatenate[BlockingWozClient, P], T]:
    """The method of `BlockingWozClient` that waits for this one."""

    def waiting(self: BlockingWozClient, /, *args: P.args, **kwargs: P.kwargs) -> T:
        return self.wait_for(method(self.client, *args, **kwargs))

    functools.update_wrapper(waiting, method)
    return waiting


def _begins(
    method: Callable[Concatenate[WozClient, P], Coroutine[Any, Any, WozRun]],
) -> Callable[Concatenate[BlockingWozClient, P], BlockingWozRun]:
    """The method of `BlockingWozClient` that returns as soon as this one has begun something."""

    def beginning(self: BlockingWozClient, /, *args: P.args, **kwargs: P.kwargs) -> BlockingWozRun:
        return BlockingWozRun(self, self.wait_for(method(self.client, *args, **kwargs)))

    functools.update_wrapper(beginning, method)
    return beginning


class BlockingWozRun:
    """An action or a command that was begun; see `WozRun`."""

    def __init__(self, owner: BlockingWozClient, run: WozRun) -> None:
        self._owner, self._run = owner, run
        self.id = run.id

    @property
    def end(self) -> RunEnd | None:
        """How it ended; None: it goes on."""
        return self._run.end

    def wait(self) -> RunEnd:
        """Wait until it has ended. Raises as awaiting a `WozRun`."""

        async def ended() -> RunEnd:
            return await self._run

        return self._owner.wait_for(ended())

    def cancel(self) -> None:
        """Cut it short. Raises `WozRefusedError` if it is over already."""
        self._owner.wait_for(self._run.cancel())


class BlockingWozClient:
    """A `WozClient` whose methods wait. It may be used from any thread, also from several."""

    say = _waits(WozClient.say)
    perform = _waits(WozClient.perform)
    press = _waits(WozClient.press)
    begin = _begins(WozClient.begin)
    begin_action = _begins(WozClient.begin_action)
    predict = _waits(WozClient.predict)
    predict_action = _waits(WozClient.predict_action)
    mark = _waits(WozClient.mark)
    note = _waits(WozClient.note)
    stop = _waits(WozClient.stop)
    release = _waits(WozClient.release)
    request = _waits(WozClient.request)

    def __init__(self, client: WozClient, loop: asyncio.AbstractEventLoop) -> None:
        self.client = client
        self._loop = loop

    def __getattr__(self, verb: str) -> Callable[..., m.Done]:
        """Each verb of the robot is a method."""
        performs = getattr(self.client, verb)
        return lambda *main, **args: self.wait_for(performs(*main, **args))

    @property
    def welcome(self) -> r.Welcome:
        """See `WozClient`."""
        return self.client.welcome

    @property
    def description(self) -> Description:
        """See `WozClient`."""
        return self.client.description

    @property
    def panels(self) -> list[PanelView]:
        """See `WozClient`."""
        return self.client.panels

    @property
    def clock_uncertainty(self) -> float:
        """See `WozClient`."""
        return self.client.clock_uncertainty

    def now(self) -> float:
        """See `WozClient.now`."""
        return self.client.now()

    def session_time(self, monotonic: float) -> float:
        """See `WozClient.session_time`."""
        return self.client.session_time(monotonic)

    def mark_soon(self, text: str = "") -> None:
        """Put a marker into the log and return at once, for `callOnFlip` of PsychoPy; its moment
        (`at`) is that of this call. Raises `WozConnectionError` once the connection is lost.
        """
        self.client.check()
        self._loop.call_soon_threadsafe(self._send_soon, self.client.marker(text))

    def _send_soon(self, marker: r.AskMarker) -> None:
        with contextlib.suppress(WozConnectionError):  # the next call raises it
            self.client.send_soon(marker)

    @overload
    def messages(self, *, held: bool = False) -> Iterator[Incoming]: ...
    @overload
    def messages(self, *kinds: type[M], held: bool = False) -> Iterator[M]: ...
    def messages(self, *kinds: type[m.Message], held: bool = False) -> Iterator[Any]:
        """See `WozClient.messages`; they are collected from this call on."""

        async def begin() -> woz_client.MessageStream[Any]:
            return self.client.messages(*kinds, held=held)

        stream = self.wait_for(begin())
        return self._follow(stream)

    def _follow(self, stream: woz_client.MessageStream[Any]) -> Iterator[Any]:
        async def following() -> Any:
            return await anext(stream, None)

        while (message := self.wait_for(following())) is not None:
            yield message

    def wait_for(self, coroutine: Coroutine[Any, Any, T]) -> T:
        """Run `coroutine` in the connection's thread; an interrupt (ctrl+c) cancels it."""
        if self._loop.is_closed():  # after the `with` block
            coroutine.close()
            self.client.check()
        future = asyncio.run_coroutine_threadsafe(coroutine, self._loop)
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise


@contextlib.contextmanager
def connect(
    session: str | Path = "",
    *,
    name: str = "program",
    samples: bool = False,
    sees: Literal["", "all", "wizard"] = "",
    part: str = "",
) -> Iterator[BlockingWozClient]:
    """As `woz_client.connect`, for `with`."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, name="woz client", daemon=True)
    thread.start()

    def wait_for(coroutine: Coroutine[Any, Any, T]) -> T:
        return asyncio.run_coroutine_threadsafe(coroutine, loop).result()

    opened = woz_client.connect(session, name=name, samples=samples, sees=sees, part=part)
    try:
        client = wait_for(opened.__aenter__())
        try:
            yield BlockingWozClient(client, loop)
        finally:
            wait_for(opened.__aexit__(None, None, None))
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()
