"""Offers drivers of this computer to a session on another one, which uses them as its own.

Each driver has one conversation at a time (`driver_messages`). When the session has been silent for
a second, or something was lost on the way, everything that it began is stopped here, without being
asked; the hardware stays held until that session is back, another one comes, or this process ends.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
from collections.abc import Awaitable, Callable, Coroutine, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, TypeVarTuple

import msgspec

from woz_tui import __version__
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.bundled_media import located, named
from woz_tui.drivers.contract import (
    Driver,
    DriverError,
    HandInput,
    Health,
    NoticeStatement,
    RejectedError,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.drivers.driver_call import DriverCall, guarded
from woz_tui.drivers.feeds import Feeds
from woz_tui.network import driver_messages as dm
from woz_tui.network.clock_offset import ClockComparison, ClockOffset
from woz_tui.network.driver_line import (
    SILENCE_S,
    DriverLine,
    from_key,
    place_key,
    session_key,
    to_key,
)
from woz_tui.network.driver_messages import LINK
from woz_tui.network.remote_driver import offer_hash, setting_hashes
from woz_tui.network.served_context import ServedContext, ServedJob
from woz_tui.network.shared_feeds import LOOK_S, ServedFeeds, is_bulky, may_be_lost
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Json
from woz_tui.system.clock import Clock, RealClock
from woz_tui.system.thread_calls import ThreadCalls

#: How often the session's clock is asked, and how often it is said that the driver is here, in
#: seconds.
PING_S, HERE_S = 0.15, 0.5
#: A driver is opened at the latest so long after its stop was called, in seconds.
_FIRST_STOP_S = 0.5

#: What the name of a folder beside the robot file cannot have.
_UNSAFE = "/\\\0"

log = logging.getLogger(__name__)

T = TypeVar("T")
Ts = TypeVarTuple("Ts")

#: Is given a sentence for whoever looks at this computer.
Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class OfferedDriver:
    """A driver of the robot file: its name and type (`kind`) there, its class, its settings."""

    name: str
    kind: str
    driver: type[Driver]
    settings: Any


class ServedDriver:
    """One driver and its conversation with a session.

    Args:
        offer: The driver.
        place: What this computer is called.
        folder: The robot file's.
        feeds: Of all drivers of this computer.
        clock: This computer's.
        tell: For sentences about what happens.
        silence_s: After so long without an answer the session is gone.
        beside_session: The session is on this computer: files are written where its own are, and
            hands reach the driver.
        made: Gets the driver under its name while there is one.
    """

    def __init__(
        self,
        offer: OfferedDriver,
        place: str,
        *,
        folder: Path,
        feeds: Feeds,
        clock: Clock,
        tell: Tell,
        silence_s: float = SILENCE_S,
        beside_session: bool = False,
        made: dict[str, Driver],
    ) -> None:
        self.name = offer.name
        self._made = made
        self.clock = clock
        self._offer = offer
        self._place = place
        self._folder = folder
        self._feeds = feeds
        self._tell = tell
        self._silence_s = silence_s
        self._beside_session = beside_session
        #: Clients whose hands it has felt.
        self._hands: set[str] = set()
        self._verbs: dict[str, Verb] = {v.name: v for v in offer.driver.offer(offer.settings).verbs}
        self._keys = to_key(place, offer.name), from_key(place, offer.name)
        self._instance = secrets.token_hex(8)
        self._line: DriverLine | None = None
        self._loop = asyncio.get_running_loop()
        self._calls = ThreadCalls(offer.name)
        self._driver: Driver | None = None
        self._context: ServedContext | None = None
        #: Which session made the driver, and the driver's name there.
        self._session = self._user = self._media = ""
        #: The stop is pressed.
        self._stopped = False
        self._epoch = 0
        self._ready = False
        self._sent = self._received = 0
        self._alive_us = 0
        self._round_trip_us = 0
        self._clocks = ClockComparison()
        self._t_us = 0
        self._shared = ServedFeeds(feeds, offer.name, clock)
        self._stopped_up_to: dict[Scope, int] = dict.fromkeys(Scope, 0)
        self._running: dict[int, tuple[asyncio.Task[None], Verb | None, str]] = {}
        self._lanes: dict[str, asyncio.Lock] = {}
        self._tasks: set[asyncio.Task[Any]] = set()
        #: Sessions that greet: they wait until the hardware is let go of, which waits for `_tasks`.
        self._greetings: set[asyncio.Task[Any]] = set()
        #: The hardware is being let go of.
        self._leaving: asyncio.Task[None] | None = None
        #: The newest session that wants the driver.
        self._greeting = 0

    # -- its life --------------------------------------------------------------------------------

    async def serve(self) -> None:
        """Until cancelled: say that it is here, ask the session's clock, notice its silence, share
        feeds.
        """
        await asyncio.gather(self._keep(), self._share())

    async def _share(self) -> None:
        while True:
            if self._ready:
                for body in self._shared.news(self._ahead_us):
                    if is_bulky(body):
                        self._send_raw(self._epoch, body, bulky=True)
                    else:
                        self._send(body, kept=not may_be_lost(body))
            await asyncio.sleep(LOOK_S)

    async def _keep(self) -> None:
        here_us = 0
        while True:
            now = self.clock.boot_us()
            if self._epoch and now - self._alive_us > self._silence_s * 1e6:
                self.lose("the session does not answer")
            if now - here_us >= HERE_S * 1e6:
                here_us = now
                self._say_here()
            if self._epoch:
                self._ping()
            await asyncio.sleep(PING_S)

    def _say_here(self) -> None:
        self._send_raw(0, dm.Here(LINK, __version__, self._epoch, self._user))

    def attach(self, line: DriverLine) -> None:
        self._line = line
        line.receive(self._keys[0], self._receive)
        line.watch_presence(self._keys[1], self._on_hearer)

    def _on_hearer(self, there: bool) -> None:
        """A session beside it begins to hear it, and would wait for the next round."""
        if there:
            self._say_here()

    async def end_stopped(self) -> None:
        """Stop, and leave the hardware as it is then: nobody is there to see what it does."""
        if self._epoch:
            self.lose("the session is gone")
        self._line = None
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=self._silence_s)

    async def close(self) -> None:
        """Stop and let go of the hardware."""
        if self._epoch:
            self.lose("this program ends")
        self._line = None  # a session that greets now gets no answer, and opens nothing again
        await self._let_go()

    def lose(self, why: str) -> None:
        """The session cannot be trusted to be there: what it began ends now."""
        if not self._epoch:
            return
        self._epoch, self._ready = 0, False
        self._tell(f"{self.name}: {why}; {self._user} is stopped")
        self._user = ""
        self._say_here()
        for task, _, _ in self._running.values():
            task.cancel()
        if self._context is not None:
            self._context.session_lost()
        if self._driver is not None:
            self._spawn(self._stop_alone(self._driver))
            for client in self._hands:
                self._driver.lose_hand(client)
        self._hands.clear()

    async def _stop_alone(self, driver: Driver) -> None:
        try:
            await self._call("stop", driver.stop, Scope.ALL)
        except Exception as error:  # whatever a driver raises
            log.exception("%s did not stop", self.name)
            self._tell(f"{self.name}: it may not have stopped: {error}")

    async def _call(self, what: str, call: Callable[[*Ts], Awaitable[T]], *args: *Ts) -> T:
        """Call the driver; what that begins beside itself is known as this driver's."""
        return await guarded(lambda: call(*args), DriverCall(self.name, what))

    async def _let_go(self) -> None:
        """Once for all who ask; of them each may be cancelled, and cuts nothing short."""
        if self._leaving is None:
            self._leaving = self._loop.create_task(self._leave(asyncio.current_task()))
            self._leaving.add_done_callback(self._on_left)
        await asyncio.shield(self._leaving)

    def _on_left(self, _: asyncio.Task[None]) -> None:
        self._leaving = None

    async def _leave(self, asker: asyncio.Task[Any] | None) -> None:
        driver, self._driver, self._context = self._driver, None, None
        self._made.pop(self.name, None)
        self._session = ""
        jobs = [task for task, _, _ in self._running.values() if task is not asker]
        for task in jobs:
            task.cancel()
        # A stop under way goes on to its end.
        ending = {*jobs, *self._tasks}
        if ending:
            _, hanging = await asyncio.wait(ending, timeout=self._silence_s)
            for task in hanging:
                task.cancel()
        if driver is not None:
            try:
                await self._call("close", driver.close)
            except Exception as error:  # whatever a driver raises
                log.exception("%s did not close", self.name)
                self._tell(f"{self.name}: it did not close: {error}")

    def _spawn(
        self, coroutine: Any, among: set[asyncio.Task[Any]] | None = None
    ) -> asyncio.Task[Any]:
        tasks = self._tasks if among is None else among
        task = self._loop.create_task(coroutine)
        tasks.add(task)
        task.add_done_callback(tasks.discard)
        return task

    def in_loop(self, call: Callable[[*Ts], object], *args: *Ts) -> None:
        """Soon, from any thread."""
        with contextlib.suppress(RuntimeError):  # closed: the program ends
            self._loop.call_soon_threadsafe(call, *args)

    # -- sending ---------------------------------------------------------------------------------

    def send(self, body: dm.FromDriver, *, kept: bool = True) -> bool:
        """To the session, if there is one; from any thread. Whether there is."""
        if not self._ready:
            return False
        needed = kept and not isinstance(body, NoticeStatement)
        self._calls.make(lambda: self._send(body, kept=kept), keep=needed)
        return True

    def _send(self, body: dm.FromDriver, *, kept: bool = True) -> None:
        if not self._epoch:
            return
        self._sent += kept
        self._send_raw(self._epoch, body, self._sent if kept else 0)

    def _send_soon(self, body: dm.FromDriver) -> None:
        self.in_loop(self._send, body)

    def _send_raw(
        self,
        epoch: int,
        body: dm.FromDriver,
        number: int = 0,
        *,
        urgent: bool = False,
        bulky: bool = False,
    ) -> None:
        if self._line is None:
            return
        frame = dm.encode(dm.FrameFromDriver(self._instance, epoch, number, body))
        if bulky:
            self._line.send_bulky(self._keys[1], frame)
        else:
            self._line.send(self._keys[1], frame, urgent=urgent)

    def _ping(self) -> None:
        self._send_raw(self._epoch, dm.Ping(self.clock.boot_us(), self._sent, self._round_trip_us))

    # -- receiving -------------------------------------------------------------------------------

    def _receive(self, data: bytes) -> None:
        try:
            frame = dm.to_driver.decode(data)
        except dm.UNREADABLE as error:
            log.debug("%s: what came cannot be read: %s", self.name, error)
            return
        if frame.instance != self._instance or not frame.epoch:
            return
        if isinstance(frame.body, dm.DriverHello):
            self._spawn(self._on_hello(frame.epoch, frame.body), self._greetings)
        elif frame.epoch == self._epoch:
            if frame.number:
                if frame.number != self._received + 1:
                    self.lose("something that the session sent was lost")
                    return
                self._received = frame.number
            self._on_body(frame.body)

    async def _on_hello(self, epoch: int, hello: dm.DriverHello) -> None:
        refusal = self._refusal(hello)
        if refusal is not None:
            self._send_raw(epoch, refusal)
            return
        self._greeting = epoch
        if self._leaving or (self._driver is not None and self._session != hello.session):
            await self._let_go()
        if self._greeting != epoch:  # it has greeted again meanwhile, or another one has
            return
        self._session, self._user = hello.session, hello.name
        self._sent = self._received = 0
        self._stopped_up_to = dict.fromkeys(Scope, 0)
        self._clocks.forget()
        self._alive_us = self.clock.boot_us()
        self._epoch, self._media, self._stopped = epoch, hello.media, False
        self._ping()

    def _refusal(self, hello: dm.DriverHello) -> dm.NotTaken | None:
        mine = setting_hashes(self._offer.settings)
        if self._epoch:
            return dm.NotTaken(f"{self.name} at {self._place} is used by {self._user}")
        copy = f"the same robot file belongs on both: copy it to {self._place} and start it anew"
        if hello.link != LINK or hello.type != self._offer.kind:
            return dm.NotTaken(
                f"{self.name} at {self._place} is of type {self._offer.kind} (woz-tui"
                f" {__version__}), here of type {hello.type} (woz-tui {hello.version})",
                copy,
            )
        differ = [
            name
            for name in sorted(mine.keys() | hello.settings.keys())
            if mine.get(name) != hello.settings.get(name)
        ]
        if differ:
            return dm.NotTaken(
                f"{self.name} at {self._place} has other settings: {', '.join(differ)}", copy
            )
        if hello.offer != offer_hash(self._offer.driver, self._offer.settings):
            return dm.NotTaken(
                f"the driver {self._offer.kind} at {self._place} is another version, with other"
                f" verbs or sensors (woz-tui {__version__} there, {hello.version} here)",
                "install the same version on both computers",
            )
        return None

    def _on_body(self, body: dm.ToDriver) -> None:
        match body:
            case dm.Pong():
                self._on_pong(body)
            case dm.Perform() if self._ready:
                self._on_perform(body)
            case dm.Cancel(id=number):
                if number in self._running:
                    self._running[number][0].cancel()
            case dm.Stop():
                self._on_stop(body)
            case dm.Invoke() if self._ready:
                self._enter(body.id, None, body.what, self._call(body.what, self._invoke, body))
            case dm.Left(why=why):
                self.lose(f"the session has ended it ({why})")
            case dm.AskEnded(id=number, ok=ok, why=why) if self._context is not None:
                self._context.ask_ended(number, ok, why)
            case dm.CameraWanted() | dm.SoundWanted() | dm.SoundSent() | dm.RobotsSpoke() if (
                self._ready
            ):
                self._shared.take(body, self._ahead_us)

    def _on_pong(self, pong: dm.Pong) -> None:
        now = self.clock.boot_us()
        if pong.last > self._received:
            self.lose("something that the session sent was lost")
            return
        offset = ClockOffset.measured(pong.sent_us, pong.boot_us, now)
        self._clocks.add(offset)
        self._t_us = pong.t_us - pong.boot_us
        self._round_trip_us = now - pong.sent_us
        # It was alive when it got the question at the earliest, not now: an answer may have waited.
        self._alive_us = max(self._alive_us, pong.sent_us)
        if not self._ready:
            self._ready = True
            self._stopped |= pong.stopped  # a stop pressed since then may have overtaken this
            self._begin()

    def _begin(self) -> None:
        """The session is there and its clock is known."""
        self._shared.begin()
        self._tell(f"{self.name}: {self._user} uses it")
        if self._driver is not None and self._context is not None:
            self._context.tell_again()
            if not self._stopped:  # we stopped it when the session was lost
                self._spawn(self._aside("resume", self._driver.resume))
            return
        # A name that comes over a network is none of another folder.
        plain = self._beside_session or not set(self._media) & set(_UNSAFE)
        media = self._folder / (self._media if plain else "session.media")
        context = ServedContext(self.name, self, self._folder, media, self._feeds)
        try:
            driver = self._offer.driver(self._user, self._offer.settings, context)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever a driver raises
            context.health(Health.FAULTED, f"it cannot be created: {type(error).__name__}: {error}")
            return
        self._driver, self._context = driver, context
        self._made[self.name] = driver
        self._spawn(self._open(driver))

    async def _open(self, driver: Driver) -> None:
        """One that is made while the stop is pressed begins stopped. It hears that twice: before it
        can find its hardware, and for drivers that take no stop before `open`.
        """
        if self._stopped:
            stop = self._spawn(self._stop_alone(driver))
            await asyncio.wait([stop], timeout=_FIRST_STOP_S)
        await self._aside("open", driver.open)
        if self._stopped:
            await self._stop_alone(driver)

    async def _aside(self, what: str, call: Callable[[], Awaitable[None]]) -> None:
        try:
            await self._call(what, call)
        except Exception as error:
            log.exception("%s failed to %s", self.name, what)
            if self._context is not None:
                self._context.notice("error", f"{what} failed: {type(error).__name__}: {error}")

    def session_t(self, clock_us: int) -> int:
        """A time of this computer's clock on the axis of the session's messages."""
        if not self._clocks:
            return 0
        return clock_us + self._ahead_us + self._t_us

    @property
    def _ahead_us(self) -> int:
        """What is added to this clock's times for CLOCK_BOOTTIME of the session's computer."""
        ahead = self.clock.boot_us() - self.clock.now_us()
        return ahead + (self._clocks.best.offset_us if self._clocks else 0)

    # -- commands --------------------------------------------------------------------------------

    def _enter(
        self, number: int, verb: Verb | None, what: str, call: Coroutine[Any, Any, Any]
    ) -> None:
        """Begin something whose end is sent to the session, however it ends."""
        task, epoch = self._loop.create_task(call), self._epoch
        self._running[number] = task, verb, what
        task.add_done_callback(lambda task: self._on_end(number, epoch, what, task))

    def _on_end(self, number: int, epoch: int, what: str, task: asyncio.Task[Any]) -> None:
        if self._running.get(number, (None,))[0] is task:
            del self._running[number]
        failure, result = None, None
        if task.cancelled():
            failure = dm.CallFailure("DriverError", "it was cancelled")
        elif (error := task.exception()) is None:
            result = task.result()
        elif isinstance(error, DriverError):
            failure = _failure(error)
        else:
            log.error("%s failed", self.name, exc_info=error)
            failure = dm.CallFailure(
                "DriverError",
                f"{type(error).__name__}: {error}",
                f"this is an error in the driver; the traceback is at {self._place}",
            )
        if self._epoch != epoch:
            return
        self._send(dm.Ended(number, failure, result))
        if what == "close":
            self._tell(f"{self.name}: {self._user} has ended")
            self._epoch, self._ready, self._user = 0, False, ""

    def _late(self, deadline_us: int) -> bool:
        """By the session's clock, as far as it is known; what is unknown counts as time."""
        return self._clocks.best.latest_there(self.clock.boot_us()) > deadline_us

    def _on_perform(self, command: dm.Perform) -> None:
        verb = self._verbs.get(command.verb)
        driver = self._driver
        why = ""
        if verb is None or driver is None:
            why = f"{self.name} at {self._place} cannot {command.verb}"
        elif command.id <= self._stopped_up_to[Scope.ALL] or (
            verb.drives and command.id <= self._stopped_up_to[Scope.DRIVE]
        ):
            why = "the stop was faster"
        elif self._late(command.deadline_us):
            why = f"it came to {self._place} too late and was not carried out"
        if why or verb is None or driver is None:
            remedy = "the network is too slow, or was interrupted" if "late" in why else ""
            self._send(dm.Ended(command.id, dm.CallFailure("DriverError", why, remedy)))
            return
        self._enter(
            *(command.id, verb, "perform"),
            self._call(f"perform {verb.name}", self._perform, driver, verb, command),
        )

    async def _perform(self, driver: Driver, verb: Verb, command: dm.Perform) -> Json:
        lane = f"{verb.lane}~{verb.name}" if verb.stream else verb.lane
        async with self._lanes.setdefault(lane, asyncio.Lock()):
            if self._late(command.deadline_us):
                raise DriverError("the command before it has not ended", f"see {self._place}")
            try:
                args = checked(verb, command.args)
            except ArgumentError as error:
                raise RejectedError(str(error)) from None
            given = located(verb, args, self._folder)
            job = ServedJob(
                *(command.command, verb.name, given, command.source),
                *(command.id, self._send_soon),
            )
            return named(codec.plain(await driver.perform(job)))

    async def _invoke(self, call: dm.Invoke) -> Any:
        driver = self._driver
        if driver is None:
            return None
        overtaken = call.id <= self._stopped_up_to[Scope.ALL]
        match call.what, call.args:
            case "resume", [] if not overtaken:
                self._stopped = False
                await driver.resume()
            case "rest", [] if not overtaken:
                await driver.rest()
            case "prepare_say", [list() as utterances]:
                await driver.prepare_say(utterances)
            case "predict", [str() as verb, dict() as args]:
                return await driver.predict(verb, args)
            case "reread", [bool() as dry_run]:
                settings = self._offer.settings
                return await asyncio.to_thread(driver.reread, settings, dry_run=dry_run)
            case "close", []:
                await self._let_go()
            case "take_hand", [dict() as told] if self._beside_session:
                hand = msgspec.convert(told, HandInput)
                self._hands.add(hand.client)
                driver.take_hand(hand)
            case "lose_hand", [str() as client] if self._beside_session:
                self._hands.discard(client)
                driver.lose_hand(client)
            case "move_media", [str() as media] if self._beside_session:
                if self._context is not None:
                    self._context.move_media(Path(media))
        return None

    # -- the stop --------------------------------------------------------------------------------

    def _on_stop(self, stop: dm.Stop) -> None:
        self._send_raw(self._epoch, dm.StopTaken(stop.id), urgent=True)
        scope = Scope.DRIVE if stop.scope == Scope.DRIVE.value else Scope.ALL
        self._stopped_up_to[scope] = max(self._stopped_up_to[scope], stop.id)
        self._stopped |= scope is Scope.ALL
        driver = self._driver
        if driver is None:
            self._send_raw(self._epoch, dm.StopEnded(stop.id), urgent=True)
            return
        self._spawn(self._stop(driver, scope, stop.id))
        for task, verb, what in self._running.values():
            every = scope is Scope.ALL and what in ("perform", "rest")
            if every or (verb is not None and verb.drives):
                task.cancel()

    async def _stop(self, driver: Driver, scope: Scope, number: int) -> None:
        epoch, failure, report = self._epoch, None, None
        try:
            report = await self._call("stop", driver.stop, scope)
        except DriverError as error:
            failure = _failure(error)
        except Exception as error:  # whatever a driver raises
            log.exception("stop of %s failed", self.name)
            failure = dm.CallFailure("DriverError", f"{type(error).__name__}: {error}")
        told = report if isinstance(report, StopReport) else None
        stopped = dm.StopEnded(
            number,
            failure,
            None if told is None else tuple(told.confirmed),
            () if told is None else tuple(told.missing),
        )
        if self._epoch == epoch:
            self._send_raw(epoch, stopped, urgent=True)


def _failure(error: DriverError) -> dm.CallFailure:
    kinds = [kind.__name__ for kind in type(error).__mro__]
    known = ("RejectedError", "DeviceLostError", "DriverError")
    return dm.CallFailure(next(kind for kind in kinds if kind in known), error.what, error.remedy)


class DriverServer:
    """All drivers of this computer, over one line.

    Args:
        place: What this computer is called.
        offers: The drivers.
        folder: The robot file's.
        tell: For sentences about what happens.
        clock: This computer's.
        silence_s: After so long without an answer a session is gone.
        beside_session: See `ServedDriver`.
    """

    def __init__(
        self,
        place: str,
        offers: Sequence[OfferedDriver],
        *,
        folder: Path,
        tell: Tell,
        clock: Clock | None = None,
        silence_s: float = SILENCE_S,
        beside_session: bool = False,
    ) -> None:
        self._place = place
        self._beside_session = beside_session
        #: Those that there are now, by name.
        self.made: dict[str, Driver] = {}
        self._loop = asyncio.get_running_loop()
        feeds, clock = Feeds(), clock or RealClock()
        self._drivers = [
            ServedDriver(
                offer,
                place,
                folder=folder,
                feeds=feeds,
                clock=clock,
                tell=tell,
                silence_s=silence_s,
                beside_session=beside_session,
                made=self.made,
            )
            for offer in offers
        ]

    async def run(self, line: DriverLine) -> None:
        """Serve over this line until cancelled; then everything is stopped and, unless a session on
        this computer is gone without a word, let go.
        """
        line.watch_presence(session_key(self._place), self._on_presence)
        for driver in self._drivers:
            driver.attach(line)
        line.show_presence(place_key(self._place))
        try:
            await asyncio.gather(*(driver.serve() for driver in self._drivers))
        finally:
            ends = (d.end_stopped() if self._beside_session else d.close() for d in self._drivers)
            await asyncio.gather(*ends)

    def _on_presence(self, there: bool) -> None:
        if not there:
            with contextlib.suppress(RuntimeError):  # closed: the program ends
                self._loop.call_soon_threadsafe(self._lose)

    def _lose(self) -> None:
        for driver in self._drivers:
            driver.lose("the session is gone")
