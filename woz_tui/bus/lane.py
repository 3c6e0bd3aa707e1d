"""One lane of one driver: its commands run one after the other.

A lane is driven by callbacks, not by a worker coroutine of its own, so that a command for an idle
lane reaches the driver on the next turn of the loop, and so that every change of state happens in
one place at one time.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import logging
import math
from collections import deque
from collections.abc import Callable, Mapping
from contextvars import Context
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from woz_tui.bus.hub import Hub
from woz_tui.drivers.bundled_media import located, named, named_text
from woz_tui.drivers.contract import DriverError, Performer, RejectedError, Verb
from woz_tui.drivers.driver_call import DriverCall, guarded
from woz_tui.protocol import codec
from woz_tui.protocol.action_messages import EVIDENCE, Evidence
from woz_tui.protocol.messages import (
    Command,
    CommandMark,
    Dispatched,
    Done,
    End,
    Failed,
    Json,
    LaneFaulted,
    LaneRecovered,
    MotionArrived,
    MotionInterrupted,
    Progress,
    Refused,
    Stopped,
    Superseded,
    TimedOut,
)
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.tasks import STOOD_STILL_S

#: How long a cancelled job may take to end before its lane counts as faulted, in seconds.
GRACE_S = 0.25
#: A job that announced its duration may take this much longer than announced.
EXPECTED_FACTOR = 1.5
EXPECTED_MARGIN_S = 2.0
#: Commands that may wait while all of them are brief: a burst of key presses out of one read.
BRIEF_CAPACITY = 256

#: Where an error of a driver can be read.
IN_HOST_LOG = Sentence(
    "bus.host_log", "the traceback is in the *.host.log beside the session's log"
)

log = logging.getLogger(__name__)


@dataclass(eq=False)
class PendingCommand:
    """A command on its way through the bus; `end` is set once, by whoever is first."""

    command: Command
    verb: Verb
    hub: Hub
    on_end: Callable[[End], None] | None = None
    end: End | None = None
    requested_us: int = 0
    #: Asked when it goes out although it has waited: why it may not any more.
    again: Callable[[], Refusal | None] | None = None
    waited: bool = False
    timers: list[asyncio.TimerHandle] = field(default_factory=list)

    def belongs_to(self, run: str) -> bool:
        """Whether it goes on and is the command `run`, or one of the commands of that run."""
        return self.end is None and run in {self.command.run, self.command.command} - {""}

    def finish(self, end: End) -> bool:
        """Publish `end` unless the command has ended already; says whether it was first."""
        if self.end is not None:
            return False
        for timer in self.timers:
            timer.cancel()
        self.timers.clear()
        if self.command.tells and _quotes(end):
            end = msgspec.structs.replace(end, tells=self.command.tells)
        self.end = end
        self.end = self.hub.publish(end)
        if self.on_end is not None:
            self.on_end(self.end)
        return True

    def refuse(self, code: str, reason: str, remedy: str = "") -> None:
        """End it as refused: it never began."""
        self.finish(
            Refused(
                command=self.command.command,
                driver=self.command.driver,
                code=code,
                reason=reason,
                remedy=remedy,
            )
        )

    def stop(self, reason: str) -> None:
        self.finish(
            Stopped(command=self.command.command, driver=self.command.driver, reason=reason)
        )

    def supersede(self, by: str) -> None:
        """End it because command `by` takes its place."""
        self.finish(Superseded(command=self.command.command, driver=self.command.driver, by=by))


class LaneJob:
    """What the driver sees of a command (`drivers.contract.Job`)."""

    def __init__(self, pending: PendingCommand, args: Mapping[str, Json], lane: Lane) -> None:
        self._pending = pending
        self._lane = lane
        #: See `drivers.contract.Job`.
        self.command = pending.command.command
        self.verb = pending.verb.name
        self.args = args
        self.source = pending.command.source
        #: What its arguments tell (see `messages.RestrictedMessage`).
        self.tells = pending.command.tells
        self._loop = asyncio.get_running_loop()
        #: Whether its motion goes on after `perform`, and why it has ended; None: it has not.
        self.outlasts = False
        self.motion_end: str | None = None
        #: On what its end stands, or that of its motion.
        self.evidence_said: str = pending.verb.evidence

    def evidence(self, kind: Evidence) -> None:
        """See `drivers.contract.Job`; a word that is none is no evidence at all."""
        self.evidence_said = kind if kind in EVIDENCE else "timed"

    def goes_on(self) -> Callable[[str], None]:
        """See `drivers.contract.Job`."""
        self.outlasts = True
        return functools.partial(self._later, self._end_motion)

    def _end_motion(self, why: str) -> None:
        if self.motion_end is None:
            self.motion_end = why
            self._lane.job_motion_ended(self._pending, self)

    def mark(self, sort: str, text: str = "") -> None:
        """Publish a point within it; may be called from any thread."""
        self._later(self._publish_mark, sort, text)

    def _publish_mark(self, sort: str, text: str) -> None:
        if self._pending.end is None:
            self._pending.hub.publish(
                CommandMark(
                    command=self.command,
                    driver=self._pending.command.driver,
                    sort=sort,
                    text=text,
                    tells=self.tells,
                )
            )

    def _later(self, call: Callable[..., None], *args: object) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has closed: nobody listens any more
            self._loop.call_soon_threadsafe(call, *args, context=Context())  # no driver's code

    def expects(self, seconds: float) -> None:
        """Publish how long it will take; may be called from any thread."""
        if not math.isfinite(seconds):
            return
        self._later(self._publish_progress, min(max(seconds, 0.0), 86_400.0))

    def _publish_progress(self, seconds: float) -> None:
        if self._pending.end is not None:
            return
        self._pending.hub.publish(
            Progress(
                command=self.command,
                driver=self._pending.command.driver,
                expected_us=round(seconds * 1_000_000),
                tells=self.tells,
            )
        )
        self._lane.extend(self._pending, seconds)


class Lane:
    """Queue and running job of one lane; see the module's text."""

    def __init__(
        self,
        name: str,
        driver_name: str,
        driver: Performer,
        hub: Hub,
        capacity: int,
        *,
        why_not: Callable[[PendingCommand], Refusal | None],
        folder: Path,
    ) -> None:
        self.name = name
        self.driver_name = driver_name
        self._driver = driver
        self._hub = hub
        self._capacity = capacity
        self._why_not = why_not
        self._folder = folder
        self._waiting: deque[tuple[PendingCommand, Mapping[str, Json]]] = deque()
        self._current: PendingCommand | None = None
        self._task: asyncio.Task[Mapping[str, Json]] | None = None
        self._cancelled = False
        #: Commands that are done and whose motion goes on.
        self._moving: dict[str, PendingCommand] = {}
        self.faulted = False

    @property
    def busy(self) -> bool:
        """Whether a job is running, or has been cancelled and has not ended yet."""
        return self._task is not None

    @property
    def waiting(self) -> list[str]:
        return [pending.command.command for pending, _ in self._waiting]

    # -- coming in ---------------------------------------------------------------------------

    def accept(self, pending: PendingCommand, args: Mapping[str, Json], when_busy: str) -> None:
        """Accept or queue a command, or refuse it because others are before it."""
        if pending.verb.stream or when_busy == "replace":
            self._make_way(pending)
        elif (when_busy == "refuse" or not pending.verb.waits) and (self.busy or self._waiting):
            pending.refuse("busy", Sentence("bus.still_running", "something else is still running"))
            return
        elif len(self._waiting) >= self._room_for(pending):
            what = Sentence("bus.queue_full", "queue full ({count})", count=len(self._waiting))
            pending.refuse("full", what, Sentence("bus.empty_or_wait", "empty the queue, or wait"))
            return
        pending.waited = self.busy or bool(self._waiting)
        self._waiting.append((pending, args))
        if pending.command.deadline_us and self.busy:
            remaining = (pending.command.deadline_us - self._hub.now()) / 1_000_000
            pending.timers.append(
                asyncio.get_running_loop().call_later(max(0.0, remaining), self._expire, pending)
            )
        self._pump()

    def _room_for(self, pending: PendingCommand) -> int:
        """How many may wait before it; more if all is brief, since the wait is short then."""
        if pending.verb.brief and all(waiting.verb.brief for waiting, _ in self._waiting):
            return max(self._capacity, BRIEF_CAPACITY)
        return self._capacity

    def _make_way(self, pending: PendingCommand) -> None:
        ended, self._waiting = self._waiting, deque()
        for waiting, _ in ended:
            waiting.supersede(pending.command.command)
        if not pending.verb.stream and self._current is not None:
            self._current.supersede(pending.command.command)
            self._cancel()

    def _expire(self, pending: PendingCommand) -> None:
        for entry in self._waiting:
            if entry[0] is pending:
                self._waiting.remove(entry)
                waited = (self._hub.now() - pending.requested_us) / 1_000_000
                pending.refuse(
                    "late",
                    Sentence(
                        "bus.was_busy",
                        "{driver_name} was busy for {waited:.0f} s",
                        driver_name=self.driver_name,
                        waited=waited,
                    ),
                )
                return

    # -- running -----------------------------------------------------------------------------

    def _pump(self) -> None:
        while self._task is None and self._waiting:
            pending, args = self._waiting.popleft()
            deadline = pending.command.deadline_us
            if deadline and self._hub.now() > deadline:
                pending.refuse("late", Sentence("bus.queued_too_long", "it was queued too long"))
                continue
            if (refusal := self._why_not(pending)) is not None:
                pending.refuse(refusal.code, refusal.reason, refusal.remedy)
                continue
            self._start(pending, args)

    def _start(self, pending: PendingCommand, args: Mapping[str, Json]) -> None:
        loop = asyncio.get_running_loop()
        for timer in pending.timers:
            timer.cancel()
        pending.timers.clear()
        self._current = pending
        if pending.verb.arrives:
            self.end_motions(
                Sentence("bus.replaced", "replaced by a newer one"),
                pending.command.command,
            )
        started_us = self._hub.now()
        self._hub.publish(
            Dispatched(
                command=pending.command.command,
                driver=self.driver_name,
                latency_us=started_us - pending.requested_us,
            ),
            started_us,
        )
        given = pending.verb.spoken(args)
        if not self._driver.elsewhere:
            given = located(pending.verb, given, self._folder)
        job = LaneJob(pending, given, self)
        call = DriverCall(self.driver_name, f"perform {job.verb}")
        task = loop.create_task(guarded(lambda: self._driver.perform(job), call))
        self._task = task
        self._cancelled = False
        self._bound(pending, pending.command.limit_s)
        task.add_done_callback(lambda done: self._ended(pending, job, done, started_us))

    def _bound(self, pending: PendingCommand, limit_s: float) -> None:
        for timer in pending.timers:
            timer.cancel()
        timer = asyncio.get_running_loop().call_later(limit_s, self._overrun, pending, limit_s)
        pending.timers[:] = [timer]

    def extend(self, pending: PendingCommand, seconds: float) -> None:
        """A job that says how long it takes is not cut off before that, with a margin."""
        needed = seconds * EXPECTED_FACTOR + EXPECTED_MARGIN_S
        if pending.end is None and needed > pending.command.limit_s:
            self._bound(pending, needed)

    def _overrun(self, pending: PendingCommand, limit_s: float) -> None:
        pending.finish(
            TimedOut(
                command=pending.command.command,
                driver=self.driver_name,
                reason=Sentence(
                    "bus.timed_out", "it took longer than {limit_s:g} s", limit_s=limit_s
                ),
                remedy=Sentence(
                    "bus.check_device",
                    "check the device, or raise the limit if this is its normal duration",
                ),
            )
        )
        self._cancel()

    def _cancel(self) -> None:
        """Cancel the job, once: a second time would hit it while it is putting things in order."""
        task = self._task
        if task is None or (self._cancelled and not self.faulted):
            return
        self._cancelled = True
        task.cancel()
        loop = asyncio.get_running_loop()
        loop.call_later(GRACE_S, self._check_ended, task, loop.time() + GRACE_S)

    def _check_ended(self, task: asyncio.Task[Mapping[str, Json]], due: float) -> None:
        if self._task is not task or self.faulted or self._current is None:
            return
        loop = asyncio.get_running_loop()
        if loop.time() - due > STOOD_STILL_S:
            # What ended meanwhile has not been seen yet: once more, which is never too late.
            loop.call_later(GRACE_S, self._check_ended, task, math.inf)
            return
        self.faulted = True
        self._hub.publish(
            LaneFaulted(
                driver=self.driver_name, lane=self.name, command=self._current.command.command
            )
        )
        waiting = list(self._waiting)
        self._waiting.clear()
        for pending, _ in waiting:
            pending.refuse(
                "faulted",
                Sentence(
                    "bus.no_response",
                    "{driver_name} does not respond: the previous command has not ended",
                    driver_name=self.driver_name,
                ),
            )

    def _ended(
        self,
        pending: PendingCommand,
        job: LaneJob,
        task: asyncio.Task[Mapping[str, Json]],
        started_us: int,
    ) -> None:
        self._task = None
        self._current = None
        end = _outcome(pending, job, task, started_us, self._hub.now())
        if pending.finish(end) and pending.verb.arrives and isinstance(end, Done):
            self._follow_motion(pending, job)
        if self.faulted:
            self.faulted = False
            self._hub.publish(LaneRecovered(driver=self.driver_name, lane=self.name))
        self._pump()

    # -- motions -----------------------------------------------------------------------------

    def _follow_motion(self, pending: PendingCommand, job: LaneJob) -> None:
        """Tell when the motion of a command that is done has arrived."""
        self._moving[pending.command.command] = pending
        if not job.outlasts:
            self._motion_ended(pending, "", evidence=job.evidence_said)
        elif job.motion_end is not None:
            self.job_motion_ended(pending, job)

    def job_motion_ended(self, pending: PendingCommand, job: LaneJob) -> None:
        """The motion of a job is over; what is not done yet hears of it when it is."""
        why = job.motion_end or ""
        self._motion_ended(pending, why, tells=job.tells, evidence=job.evidence_said)

    def _motion_ended(
        self,
        pending: PendingCommand,
        why: str,
        by: str = "",
        *,
        tells: tuple[str, ...] = (),
        stopped: bool = False,
        evidence: str = "",
    ) -> None:
        """It has arrived, or not: `tells` is what a driver's words for `why` may quote."""
        command = pending.command.command
        if self._moving.pop(command, None) is None:
            return
        if why:
            self._hub.publish(
                MotionInterrupted(
                    command=command,
                    driver=self.driver_name,
                    reason=why,
                    by=by,
                    stopped=stopped,
                    tells=tells,
                )
            )
        else:
            self._hub.publish(
                MotionArrived(command=command, driver=self.driver_name, evidence=evidence)
            )

    def end_motions(self, why: str, by: str = "", stopped: bool = False) -> None:
        """Tell that the motions of commands that are done will not arrive."""
        for pending in [*self._moving.values()]:
            self._motion_ended(pending, why, by, stopped=stopped)

    # -- stopping ----------------------------------------------------------------------------

    def stop(self, reason: str, only_driving: bool = False) -> None:
        """End everything waiting and running, or only what drives; the job is cancelled."""
        if not only_driving:
            self.end_motions(reason, stopped=True)
        kept = deque(entry for entry in self._waiting if only_driving and not entry[0].verb.drives)
        ended = [pending for pending, _ in self._waiting if all(pending is not k[0] for k in kept)]
        self._waiting = kept
        current = self._current
        if current is not None and (current.verb.drives or not only_driving):
            current.stop(reason)
            self._cancel()
        for pending in ended:
            pending.stop(reason)

    def cancel(self, run: str, reason: str) -> bool:
        """End what belongs to the run `run`, or is the command `run`; says whether anything did."""
        mine = [pending for pending, _ in self._waiting if pending.belongs_to(run)]
        self._waiting = deque(entry for entry in self._waiting if entry[0] not in mine)
        current = self._current
        if current is not None and current.belongs_to(run):
            mine.insert(0, current)
            self._cancel()
        for pending in mine:
            pending.stop(reason)
        return bool(mine)

    def empty(self, reason: str) -> None:
        """End what waits; the job goes on."""
        waiting, self._waiting = self._waiting, deque()
        for pending, _ in waiting:
            pending.stop(reason)

    async def ended(self) -> None:
        """Return when no job is running."""
        while self._task is not None:
            await asyncio.wait([self._task])
            await asyncio.sleep(0)


def _outcome(
    pending: PendingCommand,
    job: LaneJob,
    task: asyncio.Task[Mapping[str, Json]],
    started_us: int,
    now_us: int,
) -> End:
    command, driver = pending.command.command, pending.command.driver
    if task.cancelled():
        return Failed(
            command=command,
            driver=driver,
            reason=Sentence("bus.driver_cancelled", "the driver cancelled the command"),
        )
    error = task.exception()
    if error is None:
        plain = codec.plain(task.result())  # what cannot be said in JSON becomes text
        sent = plain if isinstance(plain, dict) else {} if plain is None else {"returned": plain}
        return Done(
            command=command,
            driver=driver,
            sent={name: named(value) for name, value in sent.items()},
            latency_us=started_us - pending.requested_us,
            duration_us=now_us - started_us,
            evidence=job.evidence_said,
        )
    if isinstance(error, DriverError):
        reason, remedy = named_text(error.what), named_text(error.remedy)
        if isinstance(error, RejectedError):
            return Refused(
                command=command, driver=driver, code="args", reason=reason, remedy=remedy
            )
        return Failed(command=command, driver=driver, reason=reason, remedy=remedy)
    log.error("%s failed in %s", driver, pending.verb.name, exc_info=error)
    return Failed(
        command=command,
        driver=driver,
        reason=f"{type(error).__name__}: {error}",
        remedy=Sentence(
            "bus.driver_error",
            "this is an error in the driver; {in_host_log}",
            in_host_log=IN_HOST_LOG,
        ),
    )


def _quotes(end: End) -> bool:
    """Whether it may repeat what was asked for, in words that are not the bus's own."""
    return isinstance(end, Done | Failed) or (isinstance(end, Refused) and end.code == "args")
