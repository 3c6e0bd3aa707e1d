"""A driver whose hardware is at another computer, used by the session as if it were here.

What it offers and which settings it takes is known here, from the driver's own class: experiment
files are checked without the other computer. Everything else is done there (`driver_server`).
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import itertools
import logging
import secrets
import uuid
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Protocol, cast

import msgspec

from woz_tui import __version__
from woz_tui.drivers.contract import (
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverStatement,
    Forecast,
    HandInput,
    Health,
    Job,
    NoticeStatement,
    RejectedError,
    Scope,
    SensorStatement,
    StopReport,
)
from woz_tui.network import driver_messages as dm
from woz_tui.network.driver_line import DriverLine, LineError, from_key, place_key, to_key
from woz_tui.network.driver_router import no_access_remedy
from woz_tui.network.shared_feeds import LOOK_S, SessionFeeds, may_be_lost
from woz_tui.protocol import codec
from woz_tui.protocol.action_messages import Evidence
from woz_tui.protocol.messages import Json, Shown, Speech

#: Which robot process this is, for the other computers.
SESSION = uuid.uuid4().hex
#: A command that arrives later than this is not carried out, in seconds.
LATE_S = 0.5
#: A stop that the other computer has not even received by then has not reached it, in seconds.
STOP_S = 0.4
#: How long `rest`, `close` and `reread` may take there, in seconds.
REST_S, CLOSE_S, REREAD_S = 9.0, 7.0, 3.0
#: A cancelled command is waited for so long; longer only if the other computer speaks and the
#: round trip is shorter than `SLOW_S`: else its lane would count as faulted, and it is the network.
#: The other computer keeps the order. In seconds.
SLOW_S = 0.1
_CANCEL_S = 0.2
#: Pings of about a minute, in which two clocks drift apart by no more than some milliseconds.
_LEADS = 400
#: How often it is seen whether the other side is silent, and a line tried that cannot be opened, in
#: seconds.
_WATCH_S, _RETRY_S = 0.1, 2.0

_ERRORS: Mapping[str, type[DriverError]] = {
    each.__name__: each for each in (DriverError, RejectedError, DeviceLostError)
}

log = logging.getLogger(__name__)


def setting_hashes(settings: Any) -> dict[str, str]:
    """Each setting's name and a hash of its value: two sides compare without telling passwords."""
    fields = getattr(settings, "__dataclass_fields__", {})
    return {name: _hash(repr(getattr(settings, name))) for name in fields}


def offer_hash(driver: type[Driver], settings: Any) -> str:
    """A hash of verbs and sensors: another version of a driver has another one."""
    offered = driver.offer(settings)
    verbs = [
        (
            *(verb.name, verb.lane, verb.stream, verb.drives, verb.waits, verb.arrives),
            verb.evidence,
            *(
                (each.name, each.kind, each.required, each.range, each.choices)
                for each in verb.arguments
            ),
        )
        for verb in offered.verbs
    ]
    return _hash(repr((verbs, offered.sensors)))


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:16]


class LineSource(Protocol):
    """Where the other side of drivers comes in."""

    silence_s: float

    async def join(self, place: str) -> DriverLine:
        """The open line, for one more user. Raises `LineError`."""

    async def leave(self) -> None:
        """One user less."""

    def revoked(self, place: str) -> str:
        """That this place may not come in any more; empty: it may."""

    def gone(self, place: str) -> str:
        """That it is not there any more, and why if that is known."""


class RemoteDriver(Driver):
    """A driver of this session that is served by another computer.

    Args:
        name: In full, as for every driver.
        settings: Decoded here; those that are served must be the same.
        context: The session.
        local: The driver's class.
        kind: Its type in robot files.
        router: Where the other computer comes in.
        place: What that computer is called.
    """

    summary = "A driver at another computer of the robot"
    elsewhere = True
    #: What is said until it comes, and of what runs there when it is lost; with what helps.
    awaited: ClassVar[tuple[str, str]] = (
        "{place} has not come yet",
        "there: woz drivers --serve ROBOT_FILE",
    )
    lost: ClassVar[tuple[str, str]] = (
        "what runs there ends by itself",
        "it is found again by itself; see the network, and `woz drivers` there",
    )
    unreachable: ClassVar[str] = "see the network, and `woz drivers` there"
    unfinished: ClassVar[str] = "it goes on; see `woz drivers` there"

    def __init__(
        self,
        name: str,
        settings: Any,
        context: DriverContext,
        *,
        local: type[Driver],
        kind: str,
        router: LineSource,
        place: str,
    ) -> None:
        super().__init__(name, settings, context)
        self._kind = kind
        self._router = router
        self._place = place
        self._served = name.rpartition(".")[2]
        self._verbs = {verb.name for verb in local.offer(settings).verbs}
        self._has_controls = local.take_hand is not Driver.take_hand
        self._offer = offer_hash(local, settings)
        self._keys = to_key(place, self._served), from_key(place, self._served)
        self._line: DriverLine | None = None
        self._tasks: set[asyncio.Task[Any]] = set()
        self._ids = itertools.count(1)
        self._epoch = 0
        #: The served life that we talk to, and the one that was greeted last.
        self._bound = ""
        self._greeted, self._greeted_us = "", 0
        self._sent = self._received = 0
        self._heard_us = 0
        #: When the last ping was sent, by the other clock; and how much later by that clock than
        #: they were heard by ours pings were sent: at most, so much is that clock ahead.
        self._pinged_us = 0
        self._leads_us: deque[int] = deque(maxlen=_LEADS)
        self._round_trip_s = 0.0
        self._twice = ""
        #: Why the other computer may not come in any more.
        self._barred = ""
        self._jobs: dict[int, Job] = {}
        #: Of commands that have ended: their motion goes on.
        self._motions: dict[int, tuple[Job, Callable[[str], None]]] = {}
        self._ends: dict[int, asyncio.Future[Any]] = {}
        self._stops: dict[int, tuple[asyncio.Future[None], asyncio.Future[Any]]] = {}
        self._sensors: dict[str, str] = {}
        self._utterances: list[Mapping[str, Json]] = []
        self._feeds = SessionFeeds(context.feed, context.clock)
        self._closed = asyncio.Event()
        self._stopped = False

    # -- what the session calls ------------------------------------------------------------------

    async def open(self) -> None:
        """Wait for the other computer."""
        what, remedy = self.awaited
        self.context.health(Health.CONNECTING, what.format(place=self._place), remedy)
        self._spawn(self._keep())

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Have it carried out there."""
        if job.verb not in self._verbs:
            raise RejectedError(f"{self.name} cannot {job.verb}")
        number = next(self._ids)
        deadline = self.context.clock.boot_us() + round(LATE_S * 1e6)
        self._jobs[number] = job
        try:
            sent: Mapping[str, Json] = await self._ended(
                number,
                dm.Perform(*(number, job.command, job.verb, dict(job.args), job.source, deadline)),
            )
            return sent
        finally:
            self._jobs.pop(number, None)

    async def stop(self, scope: Scope) -> StopReport | None:
        """Beside everything that waits; confirmed by the driver itself."""
        self._stopped |= scope is Scope.ALL
        if not self._bound:
            return None  # it stops there by itself, and counts as unreached
        number = next(self._ids)
        loop = asyncio.get_running_loop()
        taken, ended = loop.create_future(), loop.create_future()
        self._stops[number] = taken, ended
        try:
            self._send(dm.Stop(number, scope.value), urgent=True)
            try:
                await asyncio.wait_for(asyncio.shield(taken), STOP_S)
            except TimeoutError:
                raise DeviceLostError(f"{self._place} did not confirm the stop in time") from None
            report: StopReport | None = await ended
            return report
        finally:
            del self._stops[number]
            for future in (taken, ended):
                _abandon(future)

    async def resume(self) -> None:
        """The stop was released."""
        self._stopped = False
        await self._call("resume", [], CLOSE_S)

    async def prepare_say(self, utterances: list[Mapping[str, Json]]) -> None:
        """Told again when the other computer comes back."""
        self._utterances = utterances
        await self._prepare()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """What the driver there says; nothing is known without a line."""
        found = await self._call("predict", [verb, dict(args)], REST_S)
        return Forecast() if found is None else msgspec.convert(found, Forecast)

    def take_hand(self, hand: HandInput) -> None:
        """What a hand at a laptop does reaches this computer only. Raises `RejectedError`."""
        if not self._has_controls:
            super().take_hand(hand)
        raise RejectedError(
            f"{self.name} is at {self._place}, which `woz hands` does not reach",
            f"take `at: {self._place}` away from it in the robot file",
        )

    def reread(self, settings: Any, *, dry_run: bool) -> list[str]:
        """The files that its settings name are those of the other computer."""
        loop = next((task.get_loop() for task in self._tasks), None)
        if not self._bound or loop is None:
            return []
        asked = asyncio.run_coroutine_threadsafe(self._call("reread", [dry_run], REREAD_S), loop)
        try:
            found = asked.result(REREAD_S + 1)
        except (TimeoutError, DriverError):
            return []
        return [str(each) for each in found] if isinstance(found, list) else []

    async def rest(self) -> None:
        """Take the rest pose there."""
        await self._call("rest", [], REST_S)

    async def close(self) -> None:
        """Let the driver go, and the line if nobody else uses it."""
        if self._closed.is_set():
            return
        self._closed.set()
        try:
            with contextlib.suppress(DriverError):
                await self._call("close", [], CLOSE_S)
        except TimeoutError:
            raise DriverError(
                f"{self._place} has not let go of the hardware after {CLOSE_S:g} s",
                self.unfinished,
            ) from None
        finally:
            self._unbind("the session has ended")
            await asyncio.gather(*self._tasks, return_exceptions=True)
            if self._line is not None:
                self._line = None
                await self._router.leave()

    # -- the line --------------------------------------------------------------------------------

    def _spawn(self, coroutine: Any) -> None:
        task = asyncio.get_running_loop().create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._on_task_end)

    def _on_task_end(self, task: asyncio.Task[Any]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            log.error("%s at %s", self.name, self._place, exc_info=error)

    async def _keep(self) -> None:
        """Open the line, then watch that the other side is not silent."""
        while self._line is None:
            try:
                self._line = await self._joined()
            except LineError as error:
                if await self._closed_within(0):
                    return
                self.context.health(Health.FAULTED, str(error), error.remedy)
                if await self._closed_within(_RETRY_S):
                    return
            else:
                if self._line is None:
                    return
        subscriptions = [
            self._line.receive(self._keys[1], self._receive),
            self._line.watch_presence(place_key(self._place), self._on_presence),
        ]
        self._spawn(self._share())
        while not await self._closed_within(_WATCH_S):
            if why := self._router.revoked(self._place):
                for end in subscriptions:
                    end()
                await self._bar(why)
                return
            self._look()
            silent_us = self.context.clock.boot_us() - self._heard_us
            if self._bound and silent_us > self._router.silence_s * 1e6:
                self._lose(f"{self._place} does not answer")

    async def _joined(self) -> DriverLine | None:
        """The line; None: nobody needs it any more. Raises `LineError`."""
        joining = asyncio.ensure_future(self._router.join(self._place))
        closed = asyncio.ensure_future(self._closed.wait())
        try:
            await asyncio.wait({joining, closed}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            closed.cancel()
            if not joining.done():
                joining.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            return await joining
        return None

    async def _share(self) -> None:
        while not self._closed.is_set() and not self._barred:
            if self._bound:
                for body in self._feeds.news():
                    self._send(body)
            await asyncio.sleep(LOOK_S)

    async def _bar(self, why: str) -> None:
        """The other computer may not come in any more; it is told, and stops what it has begun.

        The rules of an open line cannot be changed: if this was not its last user the other
        computer stays connected, to nobody who hears it.
        """
        self._barred = why
        self._lose(why)
        self.context.health(Health.FAULTED, why, no_access_remedy(self._place))
        self._line = None
        await self._router.leave()

    async def _closed_within(self, seconds: float) -> bool:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._closed.wait(), seconds)
        return self._closed.is_set()

    def _on_presence(self, there: bool) -> None:
        if not there and self._bound:
            self._lose(self._router.gone(self._place))

    def _send(self, body: dm.ToDriver, *, urgent: bool = False, instance: str = "") -> None:
        """Numbered, unless it is urgent, an answer to a ping, or may be lost."""
        number = 0
        alone = isinstance(body, dm.Pong | dm.DriverHello | dm.Left) or may_be_lost(body)
        if not urgent and not alone:
            self._sent += 1
            number = self._sent
        frame = dm.FrameToDriver(instance or self._bound, self._epoch, number, body)
        if self._line is not None:
            self._line.send(self._keys[0], dm.encode(frame), urgent=urgent)

    def _receive(self, data: bytes) -> None:
        if self._barred or (self._closed.is_set() and not self._ends):
            return
        try:
            frame = dm.from_driver.decode(data)
        except dm.UNREADABLE as error:
            log.debug("%s: %s sent what cannot be read: %s", self.name, self._place, error)
            return
        if isinstance(frame.body, dm.Here):
            self._on_here(frame.instance, frame.body)
        elif frame.epoch == self._epoch and frame.instance == (self._bound or self._greeted):
            if frame.number:
                if frame.number != self._received + 1:
                    self._lose(f"something that {self._place} sent was lost")
                    return
                self._received = frame.number
            self._on_body(frame.instance, frame.body)

    def _on_here(self, instance: str, here: dm.Here) -> None:
        """It waits for a session."""
        now = self.context.clock.boot_us()
        if self._closed.is_set():
            if instance == self._bound and here.epoch != self._epoch:
                self._unbind(f"{self._place} had lost the line")  # nobody hears the end of it
            return
        if self._bound and instance != self._bound:
            if self._twice != instance:
                self._twice = instance
                self.context.notice(
                    "warning",
                    f"two computers call themselves {self._place}; the second one is not used",
                    "give each an access file of its own (woz access new NAME), and its name"
                    " behind `at:`",
                )
            return
        if self._bound and here.epoch == self._epoch:
            return
        if self._bound:
            self._lose(f"{self._place} had lost the line")
        waits = self._greeted == instance and now - self._greeted_us < self._router.silence_s * 1e6
        # It may still have our own conversation, or that of the session before us, for a moment.
        if waits or (here.epoch and here.user == self.name):
            return
        if here.link != dm.LINK:
            self.context.health(
                Health.FAULTED,
                f"{self._place} has woz-tui {here.version}, this computer {__version__}:"
                " they do not understand each other",
                "install the same version on both",
            )
            return
        if here.epoch:
            self.context.health(
                Health.FAULTED,
                f"{self._served} at {self._place} is used by {here.user}",
                "one driver of one session can use it: give each its own",
            )
            return
        self._epoch = secrets.randbits(62)
        self._sent = self._received = 0
        self._greeted, self._greeted_us = instance, now
        self._send(
            dm.DriverHello(
                link=dm.LINK,
                version=__version__,
                session=SESSION,
                name=self.name,
                type=self._kind,
                settings=setting_hashes(self.settings),
                offer=self._offer,
                media=self._media(),
            ),
            instance=instance,
        )

    def _media(self) -> str:
        """What the folder for files of this session is called there."""
        return self.context.media.name

    def _look(self) -> None:
        """Called some times a second while there is a line."""

    def _on_body(self, instance: str, body: dm.FromDriver) -> None:
        self._heard_us = self.context.clock.boot_us()
        if not self._bound and not isinstance(body, dm.Ping | dm.NotTaken):
            return
        match body:
            case dm.Ping(sent_us=sent_us, last=last, round_trip_us=round_trip_us):
                if last > self._received:
                    self._lose(f"something that {self._place} sent was lost")
                    return
                self._round_trip_s = round_trip_us / 1e6
                clock = self.context.clock
                boot_us, t_us = clock.boot_us(), self.context.t(clock.now_us())
                new, self._bound, self._greeted = not self._bound, instance, ""
                if new:
                    self._leads_us.clear()  # the other clock may have begun anew
                self._pinged_us = sent_us
                self._leads_us.append(sent_us - self._heard_us)
                self._send(dm.Pong(sent_us, boot_us, t_us, self._sent, self._stopped))
                if new and self._utterances:
                    self._spawn(self._prepare())
            case dm.NotTaken(why=why, remedy=remedy):
                self._greeted = ""
                self.context.health(Health.FAULTED, why, remedy)
            case dm.Ended(id=number, failure=failure, result=result):
                _settle(self._ends.get(number), failure, result)
            case dm.StopTaken(id=number):
                if number in self._stops:
                    _settle(self._stops[number][0], None, None)
            case dm.StopEnded(id=number, failure=failure, confirmed=confirmed, missing=missing):
                if number in self._stops:
                    report = None if confirmed is None else StopReport(confirmed, missing)
                    _settle(self._stops[number][0], None, None)
                    _settle(self._stops[number][1], failure, report)
            case (
                dm.Expects()
                | dm.MarkSent()
                | dm.EvidenceSaid()
                | dm.MotionGoesOn()
                | dm.MotionEnded()
            ):
                self._tell_of_command(body)
            case NoticeStatement():  # also its last words, while it lets go
                self.context.publish(body)
            case _ if not self._closed.is_set():
                self._tell(body)

    def _tell_of_command(
        self,
        body: dm.Expects | dm.MarkSent | dm.EvidenceSaid | dm.MotionGoesOn | dm.MotionEnded,
    ) -> None:
        match body:
            case dm.Expects(id=number, seconds=seconds):
                if number in self._jobs:
                    self._jobs[number].expects(seconds)
            case dm.MarkSent(id=number, sort=sort, text=text):
                if number in self._jobs:
                    self._jobs[number].mark(sort, text)
            case dm.EvidenceSaid(id=number, kind=kind):
                moving, _ = self._motions.get(number, (None, None))
                if (job := self._jobs.get(number) or moving) is not None:
                    job.evidence(cast(Evidence, kind))
            case dm.MotionGoesOn(id=number):
                if number in self._jobs:
                    job = self._jobs[number]
                    self._motions[number] = job, job.goes_on()
            case dm.MotionEnded(id=number, why=why):
                if number in self._motions:
                    self._motions.pop(number)[1](why)

    def _tell(self, body: dm.FromDriver) -> None:
        """What the driver says to its session."""
        context = self.context
        match body:
            case SensorStatement(sensor=sensor, state=state):
                self._sensors[sensor] = state
                context.publish(body)
            case DriverStatement():
                context.publish(body)
            case dm.MessageSent(line=line):
                with contextlib.suppress(codec.WireError):
                    message = codec.decode_message(line)
                    if isinstance(message, Shown | Speech):
                        context.publish(message)
            case dm.FeedsNamed() | dm.PictureSent() | dm.SoundSent() | dm.VoiceTaken():
                self._feeds.take(body)
            case dm.AskSent(id=number, ask=ask, answered=answered):
                context.ask(
                    ask, (lambda ok, why: self._answer(number, ok, why)) if answered else None
                )

    def _answer(self, number: int, ok: bool, why: str) -> None:
        if self._bound:
            self._send(dm.AskEnded(number, ok, why))

    # -- the end of a line -----------------------------------------------------------------------

    def _lose(self, why: str) -> None:
        """Nothing more comes of what is under way; the other side stops by itself."""
        if self._bound:
            self._send(dm.Left(why))
        self._unbind(why)
        if self._closed.is_set():
            return
        runs, remedy = self.lost
        self.context.health(Health.LOST, f"{why}; {runs}", remedy)
        for sensor, state in self._sensors.items():
            if state not in ("", "stale", "silent"):
                self.context.sensor(sensor, "stale", why)
        self._sensors.clear()

    def _unbind(self, why: str) -> None:
        self._bound = self._greeted = ""
        self._epoch = 0
        self._feeds.lose()
        self._motions.clear()
        lost = dm.CallFailure(DeviceLostError.__name__, why)
        for future in [*self._ends.values(), *(f for both in self._stops.values() for f in both)]:
            _settle(future, lost, None)

    # -- calls ------------------------------------------------------------------------------------

    async def _prepare(self) -> None:
        with contextlib.suppress(DeviceLostError):
            await self._call("prepare_say", [self._utterances], None)

    async def _call(self, what: str, args: list[Any], seconds: float | None) -> Any:
        """A method of the driver there; without a line nothing. Raises `DriverError`."""
        if not self._bound:
            return None
        number = next(self._ids)
        async with asyncio.timeout(seconds):
            return await self._ended(number, dm.Invoke(number, what, args))

    async def _ended(self, number: int, body: dm.Perform | dm.Invoke) -> Any:
        """Send it and wait until it has ended there. Cancelled, it is cancelled there, too."""
        if not self._bound:
            raise DeviceLostError(
                self._barred or f"{self._place} cannot be reached",
                no_access_remedy(self._place) if self._barred else self.unreachable,
            )
        epoch, future = self._epoch, asyncio.get_running_loop().create_future()
        self._ends[number] = future
        self._send(body)
        try:
            return await asyncio.shield(future)
        except asyncio.CancelledError:
            if self._epoch == epoch and not future.done():
                self._send(dm.Cancel(number))
                cancelled_us = self.context.clock.boot_us()
                await asyncio.wait([future], timeout=_CANCEL_S)
                # Not when it was heard: what a process that stood still reads now may be old.
                spoke_us = self._pinged_us - max(self._leads_us, default=0)
                if self._round_trip_s < SLOW_S and spoke_us > cancelled_us:
                    await asyncio.wait([future])  # it answers, and its job does not end
            raise
        finally:
            del self._ends[number]
            _abandon(future)


def _settle(
    future: asyncio.Future[Any] | None, failure: dm.CallFailure | None, result: Any
) -> None:
    if future is None or future.done():
        return
    if failure is None:
        future.set_result(result)
    else:
        future.set_exception(_ERRORS.get(failure.kind, DriverError)(failure.what, failure.remedy))


def _abandon(future: asyncio.Future[Any]) -> None:
    """Nobody waits for it any more: an exception in it is no news."""
    if future.done() and not future.cancelled():
        future.exception()
    future.cancel()
