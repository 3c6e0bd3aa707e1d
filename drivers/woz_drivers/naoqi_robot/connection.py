"""The connection to the robot that is being played: kept, watched, found again.

What is promised about calls, and what cannot be:

- Every call ends exactly once: with its value, with the robot's refusal, or with `DeviceLostError`.
  A robot that was killed is known at once; one that is frozen or cut off after at most 2 s, and all
  calls under way end in that moment.
- A call is sent only while the robot is known to be alive: it was heard within the last 0.02 s
  (`line.FRESH_S`), or it has just answered a question that was asked for this call. If
  it is silent, the call is refused and never sent. Only calls that end something (`HALTS`) are sent
  in any case, because late they do no harm.
- What was sent into a cut cable is forgotten by this machine within 1.5 s and on closing: it does
  not arrive when the cable is plugged in again.
- What cannot be promised: a call that was sent to a robot that froze less than 0.02 s ago (or while
  its question was being answered) lies in the robot's own memory, and NAOqi carries it out when it
  wakes, although it was reported as lost. So does a call that it had begun before it froze.
  Therefore the first thing after every reconnection, before any other call is let through, is to
  end all speech, sound and motion. Nothing has a way to take back what has no end of its own: the
  colour of an eye may change late.
- A call that was not answered in time (`within`) while the robot is alive may still be carried out;
  the robot is asked to cancel it.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Coroutine, Iterator
from pathlib import Path
from typing import Any, TypeVar

from woz_drivers.naoqi_robot.address import Address, parse
from woz_drivers.naoqi_robot.line import HALTS, RobotLine, silence, until_services
from woz_drivers.naoqi_robot.link import (
    ConnectionRefusedByRobotError,
    LinkClosedError,
    Methods,
    RobotRefusedError,
    ServiceMissingError,
    UnansweredError,
    Unsubscribe,
    open_link,
)
from woz_drivers.naoqi_robot.parts import LOOK_S, WITHIN_S, Refusal, ServiceAbsentError
from woz_drivers.naoqi_robot.served_files import ServedFiles
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.programs.simulated_process import SimulatedProcess
from woz_tui.drivers.background import BackgroundTasks, forget_outcome
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Health,
    RejectedError,
)
from woz_tui.system.retry_pauses import RetryPauses
from woz_tui.system.tasks import end_tasks

#: How long the parts may take to apply what the settings say, in seconds.
_APPLIED_WITHIN_S = 10.0
#: From one question about a setting to the next: twenty at once would keep the robot, and this
#: machine, from a command for several milliseconds.
SPACING_S = 0.004
_T = TypeVar("_T")


def simulated_naoqi(settings: NaoqiSettings, folder: Path) -> SimulatedProcess:
    """The robot of the address `simulated`."""
    options = (
        *("--robot", settings.model.simulator),
        *("--pace", f"{settings.pace:g}", "--echo", f"{settings.echo:g}"),
    )
    return SimulatedProcess("naoqi_simulator", options, folder)


class RobotConnection:
    """Implements `RobotCalls`. Made in the event loop; begins with `start`, ends with `close`.

    `on_connected` is awaited after each connection, once the robot is silent and its services are
    there; `on_lost` is called when such a connection is gone.
    """

    def __init__(
        self,
        settings: NaoqiSettings,
        context: DriverContext,
        *,
        on_connected: Callable[[], Awaitable[None]],
        on_lost: Callable[[], None],
    ) -> None:
        self._settings = settings
        self._context = context
        self._on_connected = on_connected
        self._on_lost = on_lost
        self._simulated = simulated_naoqi(settings, context.folder)
        self.files = ServedFiles(self, settings, context)
        self._address: Address | None = None
        self._line: RobotLine | None = None
        self._keeper: asyncio.Task[None] | None = None
        self._changing = asyncio.Lock()
        self._changes = BackgroundTasks("a change of robot")
        self._closed = False
        self._met: set[Address] = set()
        self._absent: dict[Address, frozenset[str]] = {}
        self._why = DeviceLostError("no robot is connected", "take one with `connect`")
        self._refused: Refusal = lambda what, args: None
        #: What of the robot is not well, and what to do.
        self._trouble = ("", "")
        self._well = ""
        #: When a question about a setting was asked last, or is going to be.
        self._turn = float("-inf")

    # -- for the driver ------------------------------------------------------------------------

    def start(self) -> None:
        """Begin with the first robot, if the settings say so; return at once."""
        if not self._settings.connect or not self._settings.addresses:
            self._report(Health.LOST, self._why)
            return
        try:
            self._keep(self.named(""))
        except RejectedError as error:
            self._report(
                Health.FAULTED,
                DeviceLostError(
                    f"{next(iter(self._settings.addresses))}: {error.what}", error.remedy
                ),
            )

    async def connect(self, robot: str = "") -> None:
        """Take another robot (empty: the first of the settings); return when it is there.

        Raises `RejectedError` for what is no address, `DeviceLostError` if the first attempt fails;
        it is tried again even so.
        """
        first = await self._to_the_end(self._change_to(self.named(robot)))
        await asyncio.shield(first)

    async def disconnect(self, by: str) -> None:
        """Let the robot go, and do not look for it until `connect`. `by`: who wants it."""
        await self._to_the_end(self._release(by))

    def leaving(self, leaves: bool) -> None:
        """Whether this robot is about to be let go: then only what ends something is sent to it."""
        if self._line is not None:
            self._line.leaving = leaves

    async def close(self) -> None:
        """End everything; never waits for the robot."""
        self._closed = True
        async with self._changing:
            await self._let_go(DeviceLostError("the session is over"))
        await self.files.close()
        await self._simulated.close()

    def named(self, robot: str) -> Address:
        """Which robot `connect` would take. Raises `RejectedError` for what is no address."""
        return parse(robot or next(iter(self._settings.addresses.values()), ""))

    @property
    def robot(self) -> str:
        """Which robot is being played, as shown; empty: none."""
        return self._address.shown if self._address is not None else ""

    # -- for the parts: `RobotCalls` -----------------------------------------------------------

    @property
    def ready(self) -> bool:
        """Whether it is connected and answers."""
        return self._line is not None and not self._line.pulse.silent

    def alert(self) -> None:
        """The wizard plays: what comes next shall not have to wait for a sign of life."""
        if self._line is not None:
            self._line.pulse.alert()

    @property
    def local_host(self) -> str:
        """This machine's address as the robot reaches it; empty while not connected."""
        return self._line.link.local_host if self._line is not None else ""

    async def call(self, service: str, method: str, *args: Any, within: float = WITHIN_S) -> Any:
        """Call a method; raises `DeviceLostError`, or `DriverError` with the robot's own words."""
        line = self.need()
        what = f"{service}.{method}"
        if (refusal := self.refused(what, *args)) is not None:
            raise refusal
        with self._in_words(line, what):
            if what not in HALTS:
                await line.pulse.fresh()
            line.refuse_if_leaving(what)
            value = await line.link.call(service, method, *args, within=within)
        line.pulse.sign_of_life()
        return value

    def guard(self, refused: Refusal) -> None:
        """See `RobotCalls.guard`."""
        self._refused = refused

    def refused(self, what: str, *args: Any) -> DriverError | None:
        """See `RobotCalls.refused`."""
        return self._refused(what, args)

    def unwell(self, what: str, remedy: str = "") -> None:
        """See `RobotCalls.unwell`."""
        self._trouble = (what, remedy)
        if self._well:
            self._report_well()

    async def ask(self, service: str, method: str, *args: Any) -> Any:
        """A question about a setting, in its turn: `SPACING_S` after the one before."""
        now = asyncio.get_running_loop().time()
        self._turn = max(now, self._turn + SPACING_S)
        if self._turn > now:
            await asyncio.sleep(self._turn - now)
        return await self.call(service, method, *args, within=LOOK_S)

    async def probe(self) -> None:
        """Return when the robot has answered a question asked now. Raises `DeviceLostError`."""
        line = self.need()
        with self._in_words(line, "a question"):
            await line.pulse.ask()

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        """Hear a signal until the connection is lost. Raises as `call`."""
        line = self.need()

        def come(*values: Any) -> None:
            line.pulse.sign_of_life()
            heard(*values)

        with self._in_words(line, f"{service}.{signal}"):
            await line.pulse.fresh()
            return await line.link.listen(service, signal, come)

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer the robot a service of ours until the connection is lost. Raises as `call`."""
        line = self.need()
        with self._in_words(line, f"the service {name} of ours"):
            await line.pulse.fresh()
            return await line.link.serve(name, methods)

    def need(self) -> RobotLine:
        """What is connected. Raises `DeviceLostError`."""
        if self._line is None:
            raise DeviceLostError(self._why.what, self._why.remedy)
        return self._line

    @contextlib.contextmanager
    def _in_words(self, line: RobotLine, what: str) -> Iterator[None]:
        """What a link raises, as sentences for the wizard."""
        try:
            yield
        except ServiceMissingError as missing:
            raise ServiceAbsentError(
                str(missing), "after its start they come one by one; else it is without"
            ) from None
        except RobotRefusedError as refusal:
            raise DriverError(f"the robot refused {refusal}") from None
        except UnansweredError:
            raise DeviceLostError(
                f"the robot did not answer {what} in time; it may still do it",
                "stop it if it moves unexpectedly",
            ) from None
        except LinkClosedError as closed:
            raise line.lost(str(closed)) from None

    # -- keeping it ----------------------------------------------------------------------------

    async def _to_the_end(self, change: Coroutine[Any, Any, _T]) -> _T:
        """Carry a change of robot to its end, even if a stop comes while one is let go: else none
        would be looked for, and the last that was told would be that the old one is there.
        """
        return await asyncio.shield(self._changes.start(change))

    async def _change_to(self, address: Address) -> asyncio.Future[None]:
        async with self._changing:
            if self._closed:
                raise DeviceLostError("the session is over")
            await self._let_go(
                DeviceLostError(f"{address.shown} is being connected", "wait until it is there")
            )
            return self._keep(address)

    async def _release(self, by: str) -> None:
        shown = self.robot or "no robot"
        async with self._changing:
            why = DeviceLostError(
                f"{shown}: disconnected by {by}", "connect to a robot with `connect`"
            )
            await self._let_go(why)
            self._address = None
            self._report(Health.LOST, why)

    def _keep(self, address: Address) -> asyncio.Future[None]:
        """Look after this robot from now on; the result is that of the first attempt."""
        first: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        first.add_done_callback(forget_outcome)
        self._address = address
        self._keeper = asyncio.create_task(self._keeping(address, first))
        self._keeper.add_done_callback(lambda keeper: self._keeper_ended(keeper, first))
        return first

    def _keeper_ended(self, keeper: asyncio.Task[None], first: asyncio.Future[None]) -> None:
        """Nobody waits for it any more, and a mistake of ours does not end it in silence."""
        error = None if keeper.cancelled() else keeper.exception()
        if error is not None:
            what = f"the connection ended because of an error in this program: {error!r}"
            self._report(
                Health.FAULTED, DeviceLostError(what, "take the robot again; please report it")
            )
        self._failed(first, self._why)

    async def _let_go(self, why: DeviceLostError) -> None:
        """Close what there is; calls under way end with `why`."""
        self._why = why
        if self._line is not None:
            self._line.why = why
        keeper, self._keeper = self._keeper, None
        await end_tasks(keeper)
        if self._address is not None and self._address.simulated:
            await self._simulated.close()

    async def _keeping(self, address: Address, first: asyncio.Future[None]) -> None:
        """Connect, watch, connect again; ends when there is no use in trying."""
        pauses = RetryPauses()
        self._why = DeviceLostError(f"{address.shown} is not found yet", "wait until it is there")
        self._context.health(Health.CONNECTING, f"connecting to {address.shown}")
        while True:
            was_ready = False
            try:
                line = await self._opened(address)
            except ConnectionRefusedByRobotError as refused:
                self._failed(first, refused)
                self._report(Health.FAULTED, refused)
                return
            except DriverError as error:
                self._failed(first, error)
                self._report(Health.LOST, error)
            else:
                was_ready = await self._served(line, first)
            await asyncio.sleep(pauses.after(was_ready))

    async def _opened(self, address: Address) -> RobotLine:
        real = parse(await self._simulated.address()) if address.simulated else address
        link = await open_link(real, self._settings)
        return RobotLine(link, address, self._settings.heartbeat)

    async def _served(self, line: RobotLine, first: asyncio.Future[None]) -> bool:
        """Watch this connection until it is lost; return whether it had been ready."""
        getting_ready = asyncio.create_task(self._get_ready(line, first))
        try:
            line.why = await line.until_lost(getting_ready)
            self._failed(first, line.why)
            self._report(Health.LOST, line.why)
        finally:
            was_ready = self._line is line
            self._line = None
            self._well, self._trouble = "", ("", "")
            getting_ready.cancel()
            await line.link.close()
            await end_tasks(getting_ready)
            if was_ready:
                self._on_lost()
        return was_ready

    async def _get_ready(self, line: RobotLine, first: asyncio.Future[None]) -> None:
        """Wait for its services, silence it, let calls through, have the settings applied."""
        address = line.address
        missing_before = self._absent.get(address, frozenset())
        self._absent[address] = await until_services(
            line, self._settings.model.services, missing_before, self._starting
        )
        if address in self._met:
            await silence(line, self._settings.model.silence)
        else:
            self._report_certificate(line)
        self._met.add(address)
        self._line = line
        await self.files.connected()
        try:
            async with asyncio.timeout(_APPLIED_WITHIN_S):
                await self._on_connected()
        except TimeoutError:
            self._context.notice(
                "warning",
                f"{line.shown} did not take all settings within {_APPLIED_WITHIN_S:g} s",
                "compare what is shown, and set again what is missing",
            )
        except DriverError as error:
            if not line.leaving:  # else the wizard has just said so
                self._context.notice("warning", f"{line.shown}: {error.what}", error.remedy)
        absent = ", ".join(sorted(self._absent[address]))
        self._well = f"{line.shown}; without {absent}" if absent else line.shown
        self._report_well()
        if not first.done():
            first.set_result(None)

    def _report_well(self) -> None:
        """It is connected; a part of it may not be well."""
        what, remedy = self._trouble
        if what:
            self._context.health(Health.FAULTED, f"{self._well}: {what}", remedy)
        else:
            self._context.health(Health.CONNECTED, self._well)

    def _report_certificate(self, line: RobotLine) -> None:
        """Report a certificate once where the file does not say which one to trust."""
        found = line.link.certificate
        if found and not self._settings.trusted:
            self._context.notice(
                "info",
                f"{line.shown} shows the certificate {found}; any is accepted",
                f"set `trusted: {found}` to be sure which robot it is",
            )

    def _starting(self, line: RobotLine, missing: frozenset[str]) -> None:
        """It has just been started: services come up one after the other."""
        names = ", ".join(sorted(missing))
        self._why = DeviceLostError(f"{line.shown} is starting: waiting for {names}", "wait")
        self._context.health(Health.CONNECTING, self._why.what, "it takes a minute or two")

    def _failed(self, first: asyncio.Future[None], error: DriverError) -> None:
        if not first.done():
            first.set_exception(error)

    def _report(self, health: Health, error: DriverError) -> None:
        self._why = DeviceLostError(error.what, error.remedy)
        self._context.health(health, error.what, error.remedy)
