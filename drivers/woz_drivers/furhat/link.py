"""The connection to a Furhat: requests, the events that answer them, and events by themselves."""

from __future__ import annotations

import asyncio
import itertools
import os
from collections.abc import Callable, Coroutine
from typing import Any, Generic, TypeVar

from woz_drivers.furhat.realtime_events import Access, RobotEvent, read_error, read_event
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.lines.web_robot_link import WebRobotLink
from woz_drivers.programs.simulated_process import SIMULATED, SimulatedProcess
from woz_tui.drivers.background import forget_outcome
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError
from woz_tui.drivers.robot_parts import RobotPart

PATH = "/v1/events"
#: An ordinary request is answered within this, in seconds.
WITHIN_S = 2.0

NO_ACCESS = (
    "switch the Realtime API on in the robot's web interface, put its key into the environment"
    " variable {key}, and start again"
)

E = TypeVar("E", bound=RobotEvent)


class RequestRefusedError(DriverError):
    """The robot says no to a request."""


class Exchange(Generic[E]):
    """A request and the events that answer it.

    Attributes:
        over: The event that ends it; an error if the robot refused it or was lost.
    """

    def __init__(self, kind: str, number: str, last: type[E], also: tuple[type[RobotEvent], ...]):
        self.kind = kind
        self.number = number
        self.over: asyncio.Future[E] = asyncio.get_running_loop().create_future()
        # Perhaps nobody waits for it any more.
        self.over.add_done_callback(forget_outcome)
        self._last = last
        self._also = also
        self._events: asyncio.Queue[RobotEvent] = asyncio.Queue()

    async def next(self, within: float, trouble: DriverError) -> RobotEvent:
        """The next event. Raises `trouble` if none comes in time, or what ended it."""
        getting = asyncio.ensure_future(self._events.get())
        try:
            either: tuple[asyncio.Future[Any], ...] = (getting, self.over)
            await asyncio.wait(either, timeout=within, return_when=asyncio.FIRST_COMPLETED)
            if getting.done():
                return getting.result()
        finally:
            getting.cancel()
        if not self.over.done():
            raise trouble
        return self.over.result()

    def takes(self, event: RobotEvent) -> bool:
        """Whether this event may belong to it."""
        return isinstance(event, (self._last, *self._also))

    def take(self, event: RobotEvent) -> bool:
        """Keep an event; returns whether it was the last one."""
        if isinstance(event, self._last):
            if not self.over.done():
                self.over.set_result(event)
            return True
        self._events.put_nowait(event)
        return False

    def fail(self, error: DriverError) -> None:
        """There will be no answer."""
        if not self.over.done():
            self.over.set_exception(error)


class FurhatLink(WebRobotLink):
    """Keeps the connection. `get_ready` makes the robot ready once it has given access, and returns
    what is shown of it; `on_lost` is called when it is gone.
    """

    def __init__(
        self,
        settings: FurhatSettings,
        context: DriverContext,
        *,
        get_ready: Callable[[], Coroutine[Any, Any, str]],
        on_lost: Callable[[], None],
    ) -> None:
        simulated = SimulatedProcess(
            "robot_simulators.furhat", ("--pace", f"{settings.pace:g}"), context.folder
        )
        shown = settings.address or SIMULATED
        super().__init__(context, shown, simulated, settings.place, PATH)
        self._settings = settings
        self._on_lost = on_lost
        self._prepare = get_ready
        self._handlers: dict[type[RobotEvent], Callable[[Any], None]] = {}
        self._exchanges: dict[str, Exchange[Any]] = {}
        self._numbers = itertools.count(1)
        self._complaints: set[str] = set()

    def on(self, kind: type[E], handler: Callable[[E], None]) -> None:
        """Have every event of this kind handled, also without a request."""
        self._handlers[kind] = handler

    # -- requests ------------------------------------------------------------------------------

    async def send(self, kind: str, **fields: Any) -> None:
        """A request without an answer. Raises `DeviceLostError`."""
        await self._line.send({"type": kind, **fields})

    async def begin(
        self, kind: str, last: type[E], *also: type[RobotEvent], **fields: Any
    ) -> Exchange[E]:
        """A request that is answered by events, the last one of the kind `last`.

        Raises `DeviceLostError`.
        """
        number = f"woz-{next(self._numbers)}"
        exchange = self._exchanges[number] = Exchange(kind, number, last, also)
        try:
            await self._line.send({"type": kind, "request_id": number, **fields})
        except BaseException as error:
            self._exchanges.pop(number, None)
            if isinstance(error, DriverError):
                exchange.fail(error)
            raise
        return exchange

    def forget(self, exchange: Exchange[Any]) -> None:
        """Nobody waits for its end any more."""
        self._exchanges.pop(exchange.number, None)
        exchange.over.cancel()

    async def ask(self, kind: str, answer: type[E], within: float = WITHIN_S, **fields: Any) -> E:
        """A request with one answer.

        Raises:
            DeviceLostError: The robot is not there.
            DriverError: It refused, or did not answer within `within` seconds.
        """
        exchange = await self.begin(kind, answer, **fields)
        try:
            async with asyncio.timeout(within):
                return await asyncio.shield(exchange.over)
        except TimeoutError:
            raise DriverError(
                f"{self.shown} did not answer {kind} within {within:g} s",
                "try again; else restart the robot",
            ) from None
        finally:
            self.forget(exchange)

    async def authenticate(self, within: float = WITHIN_S) -> Access:
        """Ask for access. The robot takes requests in order, so its answer also says that it has
        taken all that were sent before. Raises as `ask`.
        """
        key = os.environ.get(self._settings.key, "")
        return await self.ask("request.auth", Access, within, **({"key": key} if key else {}))

    # -- the line ------------------------------------------------------------------------------

    async def _get_ready(self) -> str:
        if not (await self.authenticate()).access:
            raise DeviceLostError(
                f"{self.shown} gives no access: its key is missing or wrong",
                NO_ACCESS.format(key=self._settings.key),
            )
        return await self._prepare()

    def _take(self, message: Any) -> None:
        """Raises `ValueError` for what is no event."""
        complaint = read_error(message)
        if complaint is not None:
            self._complained(*complaint)
            return
        event = read_event(message)
        if event is None:
            return
        exchange = self._exchange_of(event)
        if exchange is not None and exchange.take(event):
            self._exchanges.pop(exchange.number, None)
        handler = self._handlers.get(type(event))
        if handler is not None:
            handler(event)

    def _exchange_of(self, event: RobotEvent) -> Exchange[Any] | None:
        """The request that it answers; without an id the oldest that may be meant."""
        if event.request_id:
            exchange = self._exchanges.get(event.request_id)
            return exchange if exchange is not None and exchange.takes(event) else None
        return next((one for one in self._exchanges.values() if one.takes(event)), None)

    def _complained(self, words: str, number: str) -> None:
        exchange = self._exchanges.pop(number, None)
        if exchange is None and not number and len(self._exchanges) == 1:
            _, exchange = self._exchanges.popitem()
        if exchange is not None:
            exchange.fail(
                RequestRefusedError(
                    f"{self.shown} refused {exchange.kind}: {words}",
                    "compare the version of its software with the robot's page in docs",
                )
            )
        elif words not in self._complaints and len(self._complaints) < 20:
            self._complaints.add(words)
            self._context.notice(
                "warning", f"{self.shown} complains: {words}", "look at its web interface"
            )

    def _lost(self, error: DeviceLostError) -> None:
        exchanges, self._exchanges = self._exchanges, {}
        for exchange in exchanges.values():
            exchange.fail(DeviceLostError(error.what, error.remedy))
        self._on_lost()


class FurhatPart(RobotPart[FurhatLink, FurhatSettings]):
    """One part of a Furhat: its verbs, its settings, its share of the stop."""
