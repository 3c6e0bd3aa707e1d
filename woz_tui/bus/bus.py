"""Gives commands to the drivers that carry them out, and stops all of them at once.

Each driver has its lanes (`lane.py`); a slow or dead driver delays only them. The bus promises:
every command submitted is recorded first and ends exactly once; after a stop nothing reaches a
driver until the stop is released.
"""

from __future__ import annotations

import asyncio
import functools
import logging
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Protocol

import msgspec

from woz_tui.bus.consents import Consents, person_of
from woz_tui.bus.hub import Hub
from woz_tui.bus.lane import Lane, PendingCommand
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverError,
    Performer,
    Scope,
    StopReport,
    Verb,
    gives_consent,
)
from woz_tui.drivers.driver_call import DriverCall, guarded
from woz_tui.drivers.secret_arguments import hidden
from woz_tui.gate.facts import Driving, Facts
from woz_tui.gate.questions import DispatchCommand, SubmitCommand
from woz_tui.gate.table import why_not
from woz_tui.protocol.action_messages import STOP_PROMISE_S
from woz_tui.protocol.messages import (
    Command,
    DriverConnected,
    DriverConnecting,
    DriverFaulted,
    DriverHealth,
    DriverLost,
    End,
    Json,
    Message,
    StopConfirmed,
    StopPressed,
    StopReleased,
)
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.tasks import TaskSet, wait_at_most

#: Commands that may wait in one lane.
CAPACITY = 16
#: Commands of a verb that do not wait for each other, at the most; further ones wait.
MOST_TOGETHER = 64
#: How long drivers have to confirm a stop, in seconds.
STOP_WAIT_S = STOP_PROMISE_S

log = logging.getLogger(__name__)

#: A driver's stop under way.
StopTask = asyncio.Task[StopReport | None]


def as_given(command: Command) -> Command:
    """The command itself, where nobody fills anything in."""
    return command


class DrivingWatch(Protocol):
    """Knows who watches over what drives."""

    def facts(self, command: Command) -> Driving:
        """Who watches over this command."""

    def begins(self, command: Command) -> None:
        """It may drive, and does."""


class FeatureFacts(Protocol):
    """What features say of the moment, for their rows of the gate."""

    @property
    def failed(self) -> Mapping[str, object]:
        """Those that have failed, with what they said last."""

    def facts(self) -> Mapping[str, object]:
        """By name."""


class Bus:
    """Queues, deadlines and the stop for all drivers of a session.

    Args:
        hub: Everything that happens is published here.
        drivers: By name.
        verbs: What each driver offers, by the driver's name.
        capacity: Commands that may wait in one lane.
        motionless: Names of those of which nothing moves or sounds: they hear of a stop, and need
            not confirm it.
        unstopped: Names of those that nothing can come of while the stop is pressed, so that they
            take commands then too.
        unrecorded: Says why a command that is published now is not recorded, so that it may not
            begin; empty: it is.
        folder: Where relative paths of commands start.
        completed: A command of a verb `by_mood` with what the session fills in of its arguments.
    """

    def __init__(
        self,
        hub: Hub,
        drivers: Mapping[str, Performer],
        verbs: Mapping[str, tuple[Verb, ...]],
        capacity: int = CAPACITY,
        *,
        motionless: frozenset[str] = frozenset(),
        unstopped: frozenset[str] = frozenset(),
        unrecorded: Callable[[], str] = str,
        folder: Path = Path(),
        completed: Callable[[Command], Command] = as_given,
    ) -> None:
        self._hub = hub
        self._drivers = dict(drivers)
        #: What each driver offers, by driver and name.
        self.verbs = {
            name: {verb.name: verb for verb in offered} for name, offered in verbs.items()
        }
        self._capacity = capacity
        self._motionless = motionless
        self._unstopped = unstopped
        self._unrecorded = unrecorded
        self._folder = folder
        self._completed = completed
        self._lanes: dict[tuple[str, str], Lane] = {}
        self._stopping: asyncio.Task[None] | None = None
        #: Drivers that did not confirm the last stop of everything.
        self._unconfirmed: set[str] = set()
        self._confirming = TaskSet("confirming a stop")
        self._telling = TaskSet("telling of a stop")
        self._connected: set[str] = set()
        #: Those of which a part may be connected: they say which.
        self._faulted: set[str] = set()
        #: Since the last stop of everything: who was lost, and who is back or there at last.
        self._lost: set[str] = set()
        self._back: set[str] = set()
        hub.listen(self._on_message, DriverHealth)
        #: Whose faces may be learnt.
        self.consents = Consents(hub)
        self.latched = False
        #: Why the robot may not drive at this moment; empty while a wizard watches.
        self.unwatched = ""
        #: Who watches over what drives.
        self.watch: DrivingWatch | None = None
        #: What features say of the moment, where they have rows about commands.
        self.features: FeatureFacts | None = None

    def add(self, name: str, performer: Performer, verbs: Iterable[Verb]) -> None:
        """One more who carries out verbs."""
        self._drivers[name] = performer
        self.offer(name, verbs)

    def offer(self, driver: str, verbs: Iterable[Verb]) -> None:
        """`driver` offers these verbs from now on: the same, perhaps with other choices."""
        self.verbs[driver] = {verb.name: verb for verb in verbs}

    def verb(self, driver: str, name: str) -> Verb | None:
        """The verb `name` of `driver`; None if it offers none."""
        return self.verbs.get(driver, {}).get(name)

    # -- commands ----------------------------------------------------------------------------

    def submit(
        self,
        command: Command,
        on_end: Callable[[End], None] | None = None,
        again: Callable[[], Refusal | None] | None = None,
    ) -> Command:
        """Record `command`, then queue or refuse it; returns it as recorded.

        `on_end` is called once, in the loop, with how it ended; possibly before this returns.
        `again` is asked when it goes to its driver after it has waited: whoever requested it may
        not be allowed to any more.
        """
        verb = self.verb(command.driver, command.verb)
        if verb is not None and verb.by_mood:
            command = self._completed(command)
        command = _shown(verb, command)
        recorded = self._hub.publish(command)
        pending = PendingCommand(
            recorded,
            verb or Verb(command.verb, ""),
            self._hub,
            on_end,
            requested_us=recorded.t,
            again=again,
        )
        args: Mapping[str, Json] = {}
        wrong = ""
        try:
            args = checked(verb, command.args) if verb is not None else args
        except ArgumentError as error:
            wrong = str(error)
        lane, known, unknown = "", None, ""
        if verb is not None:
            lane = f"{verb.lane}~{verb.name}" if verb.stream else verb.lane
            if verb.together:
                lane = self._idle_lane(command.driver, lane)
            known = self._lanes.get((command.driver, lane))
        elif command.driver in self._drivers:
            unknown = Sentence(
                "bus.not_offered",
                "{driver} does not offer {verb!r}",
                driver=command.driver,
                verb=command.verb,
            )
        else:
            unknown = Sentence(
                "bus.no_driver", "there is no driver {driver!r}", driver=command.driver
            )
        question = SubmitCommand(
            recorded,
            verb,
            unknown,
            wrong,
            stoppable=command.driver not in self._unstopped,
            faulted=known is not None and known.faulted,
        )
        if (refusal := why_not(self._facts(recorded, verb), question)) is not None:
            pending.refuse(refusal.code, refusal.reason, refusal.remedy)
        elif verb is not None:
            if verb.drives and self.watch is not None:
                self.watch.begins(recorded)
            self._lane(command.driver, lane).accept(pending, args, command.when_busy)
        return recorded

    def _facts(self, command: Command, verb: Verb | None) -> Facts:
        """What holds now for a command, for the gate."""
        driving = None
        if verb is not None and verb.drives:
            driving = Driving(self.unwatched)
            if self.watch is not None and not self.unwatched:
                driving = self.watch.facts(command)
        features = self.features
        return Facts(
            stopped=self.latched,
            unrecorded=self._unrecorded(),
            driving=driving,
            features={} if features is None else features.facts(),
            failed=() if features is None else features.failed,
            consents=self.consents.people,
        )

    def _why_not_dispatched(self, pending: PendingCommand) -> Refusal | None:
        """Why a command may not go to its driver now; None: it may, and does."""
        command, verb = pending.command, pending.verb
        person = person_of(command, verb)
        stoppable = command.driver not in self._unstopped
        gives = person is not None and gives_consent(command.verb, command.args)
        question = DispatchCommand(command, verb, stoppable, person, gives)
        refusal = why_not(self._facts(command, verb), question)
        if refusal is None and pending.waited and pending.again is not None:
            refusal = pending.again()
        if refusal is None and verb.needs_consent and person is not None:
            self.consents.use(command, person)
        return refusal

    def refuse(
        self,
        command: Command,
        code: str,
        reason: str,
        on_end: Callable[[End], None] | None = None,
    ) -> Command:
        """Record `command` and that it is refused, without looking at it any further."""
        verb = self.verb(command.driver, command.verb)
        recorded = self._hub.publish(_shown(verb, command))
        PendingCommand(recorded, Verb(command.verb, ""), self._hub, on_end).refuse(code, reason)
        return recorded

    def hidden(self, verb: str, args: Mapping[str, Json]) -> dict[str, Json]:
        """`args` without what any driver's `verb` hides, for whoever looks at them earlier."""
        for offered in self.verbs.values():
            args = hidden(offered.get(verb), args)
        return dict(args)

    def _lane(self, driver: str, name: str) -> Lane:
        lane = self._lanes.get((driver, name))
        if lane is None:
            performer, hub = self._drivers[driver], self._hub
            lane = Lane(
                name,
                driver,
                performer,
                hub,
                self._capacity,
                why_not=self._why_not_dispatched,
                folder=self._folder,
            )
            self._lanes[driver, name] = lane
        return lane

    def _idle_lane(self, driver: str, name: str) -> str:
        """The first of a verb's lanes that is free; where all are busy, the last one."""
        for number in range(1, MOST_TOGETHER):
            lane = self._lanes.get((driver, f"{name}~{number}"))
            if lane is None or not lane.busy:
                return f"{name}~{number}"
        return f"{name}~{MOST_TOGETHER}"

    def cancel(self, run: str, reason: str) -> bool:
        """End every command of the run `run`, or the command of that id; says whether any was."""
        found = [lane.cancel(run, reason) for lane in self._lanes.values()]
        return any(found)

    @property
    def waiting(self) -> list[str]:
        """The commands that wait in queues."""
        return [command for lane in self._lanes.values() for command in lane.waiting]

    def empty(self, reason: str) -> None:
        """End every command that waits in a queue."""
        for lane in list(self._lanes.values()):
            lane.empty(reason)

    # -- who is connected --------------------------------------------------------------------

    def _on_message(self, message: Message) -> None:
        """A driver with a fault is as connected as it was before."""
        match message:
            case DriverConnected(driver=driver):
                if driver not in self._connected or driver in self._faulted:
                    self._on_return(driver)
                self._connected.add(driver)
                self._faulted.discard(driver)
            case DriverFaulted(driver=driver):
                if driver not in self._connected | self._faulted:
                    self._on_return(driver)
                self._faulted.add(driver)
            case DriverLost(driver=driver) | DriverConnecting(driver=driver):
                self.disconnected(driver)

    def _on_return(self, driver: str) -> None:
        if self.latched:
            self._back.add(driver)
            asyncio.get_running_loop().call_soon(self._stop_again)

    def _stop_again(self) -> None:
        """Stop drivers that are back and have not confirmed the stop, or were lost since: what is
        switched on anew may know of no stop. Not before it is known who confirmed.
        """
        again = sorted(self._back & (self._unconfirmed | self._lost))
        if again and self.latched and not self._awaits_confirmation:
            self.stop(f"return of {again[0]}")

    def disconnected(self, driver: str) -> None:
        """From here on no stop reaches it, whatever its `stop` returns."""
        self._connected.discard(driver)
        self._faulted.discard(driver)
        self._lost.add(driver)
        self._back.discard(driver)
        for (name, _), lane in list(self._lanes.items()):
            if name == driver:
                lane.end_motions(
                    Sentence("bus.not_connected", "{driver} is not connected", driver=driver)
                )

    # -- the stop ----------------------------------------------------------------------------

    def stop(self, source: str, pressed: int | None = None) -> asyncio.Task[None]:
        """Latch, end everything, call every driver's `stop` at once.

        `pressed`: when the key was pressed, on the axis of `t`; 0: nobody knows; None: now.

        Returns the task that ends when all have confirmed or `STOP_WAIT_S` has passed. A press
        while one is under way joins it: drivers are not called twice for a held-down key. Unless
        it was released in the meantime: then commands may have begun, and it is a new stop.
        """
        joins = self.latched and self._awaits_confirmation
        self.latched = True
        if joins and self._stopping is not None:
            return self._stopping
        self._lost.clear()
        self._back.clear()
        now = self._hub.now()
        pressed = now if pressed is None else pressed
        stops = self._call_stops(Scope.ALL, self._moving)
        for name in self._motionless & self._drivers.keys():
            self._telling.start(self._stop_of(name, Scope.ALL))
        self._hub.publish(StopPressed(source=source, pressed=pressed))
        for lane in list(self._lanes.values()):
            lane.stop(Sentence("session.stop_pressed", "stop pressed"))
        self._stopping = self._confirming.start(self._confirm(stops, pressed or now, Scope.ALL))
        return self._stopping

    @property
    def unconfirmed(self) -> list[str]:
        """Drivers that may still move although the stop is pressed: all, until it is known."""
        if not self.latched:
            return []
        return self._moving if self._awaits_confirmation else sorted(self._unconfirmed)

    @property
    def _awaits_confirmation(self) -> bool:
        """It is not known yet who confirmed the stop."""
        return self._stopping is not None and not self._stopping.done()

    @property
    def _moving(self) -> list[str]:
        return [name for name in self._drivers if name not in self._motionless]

    def release(self, source: str) -> bool:
        """Take commands again; says whether the stop was pressed at all."""
        if not self.latched:
            return False
        self.latched = False
        self._hub.publish(StopReleased(source=source))
        return True

    def halt_driving(self, source: str) -> None:
        """End only what moves the robot through the room; nothing latches."""
        driving = [
            name
            for name in self._drivers
            if any(verb.drives for verb in self.verbs.get(name, {}).values())
        ]
        if not driving:
            return
        pressed = self._hub.now()
        stops = self._call_stops(Scope.DRIVE, driving)
        self._hub.publish(StopPressed(source=source, scope=Scope.DRIVE.value, pressed=pressed))
        for lane in list(self._lanes.values()):
            lane.stop(source, only_driving=True)
        self._confirming.start(self._confirm(stops, pressed, Scope.DRIVE))

    def _call_stops(self, scope: Scope, names: list[str]) -> dict[str, StopTask]:
        loop = asyncio.get_running_loop()
        return {
            name: loop.create_task(self._stop_of(name, scope), name=f"stop {name}")
            for name in names
        }

    async def _stop_of(self, name: str, scope: Scope) -> StopReport | None:
        """Call its `stop`. Raises `DriverError` if that blocked: afterwards all looks as if it had
        ended at once.
        """
        call = DriverCall(name, "stop")
        report = await guarded(functools.partial(self._drivers[name].stop, scope), call)
        if call.longest_s > STOP_WAIT_S:
            raise DriverError(f"its stop held up the robot process for {call.longest_s:.1f} s")
        return report

    async def _confirm(self, stops: Mapping[str, StopTask], pressed: int, scope: Scope) -> None:
        """Wait until each driver's `stop` has returned, and of a stop of everything its jobs have
        ended; then report.
        """
        jobs = scope is Scope.ALL
        loop = asyncio.get_running_loop()
        absent = {name for name in stops if name not in self._connected | self._faulted}
        waits = {
            name: loop.create_task(self._has_stopped(name, stop, jobs))
            for name, stop in stops.items()
        }
        await wait_at_most(waits.values(), STOP_WAIT_S)
        reports = {name: report for name, stop in stops.items() if (report := _stop_report(stop))}
        confirmed, missing, unreached = [], [], []
        for name, wait in waits.items():
            report = reports.get(name)
            in_part = name in self._faulted and report is not None and bool(report.confirmed)
            reached = name in self._connected or in_part
            if name in absent or _lost(stops[name]) or not reached:
                unreached.append(name)
                reports.pop(name, None)
            if wait.done() and wait.result() and name not in unreached:
                confirmed.append(name)
            else:
                missing.append(name)
                wait.cancel()
        if jobs:
            self._unconfirmed = set(missing)
        self._hub.publish(
            StopConfirmed(
                confirmed=confirmed,
                missing=missing,
                elapsed_us=self._hub.now() - pressed,
                parts={name: [*each.confirmed] for name, each in reports.items() if each.confirmed},
                missing_parts={
                    name: [*each.missing] for name, each in reports.items() if each.missing
                },
                unreached=unreached,
                scope=scope.value,
            )
        )
        if jobs:
            loop.call_soon(self._stop_again)  # when this one is over

    async def _has_stopped(self, name: str, stop: StopTask, jobs: bool) -> bool:
        await asyncio.wait([stop])
        if stop.cancelled():
            return False
        error = stop.exception()
        if error is not None:
            log.error("stop of %s failed", name, exc_info=error)
            return False
        report = _stop_report(stop)
        if report is not None and report.missing:
            return False
        if jobs:
            for (driver, _), lane in list(self._lanes.items()):
                if driver == name:
                    await lane.ended()
        return True

    # -- ending ------------------------------------------------------------------------------

    async def settled(self) -> None:
        """Every stop that was pressed has been confirmed, or has not; `STOP_WAIT_S` at most for
        each.
        """
        await self._confirming.settled()

    async def drain(self, seconds: float) -> None:
        """End every command and wait up to `seconds` for the jobs to be gone."""
        for lane in list(self._lanes.values()):
            lane.stop(Sentence("session.ends", "the session ends"))
        waits = [asyncio.ensure_future(lane.ended()) for lane in self._lanes.values()]
        if waits:
            _, pending = await asyncio.wait(waits, timeout=seconds)
            for wait in pending:
                wait.cancel()


def _shown(verb: Verb | None, command: Command) -> Command:
    """The command as it may be recorded, and no other is carried out."""
    args = hidden(verb, command.args)
    return command if args == command.args else msgspec.structs.replace(command, args=args)


def _lost(stop: StopTask) -> bool:
    """Whether the driver found its hardware gone."""
    return stop.done() and not stop.cancelled() and isinstance(stop.exception(), DeviceLostError)


def _stop_report(stop: StopTask) -> StopReport | None:
    """What a driver of several parts says of its stop, if it has ended well."""
    if not stop.done() or stop.cancelled() or stop.exception() is not None:
        return None
    report = stop.result()
    return report if isinstance(report, StopReport) else None
