"""Plays actions: sends the commands of each step to the bus, and publishes how the run ended."""

from __future__ import annotations

import asyncio
import functools
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import msgspec

from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Action, Call
from woz_tui.config.performers import ENGAGEMENT, SESSION, composers, performers
from woz_tui.drivers.contract import Verb
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import HANDS, SPEAKING_VERBS, is_by_hand, weakest
from woz_tui.protocol.refusal import Refusal, RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.action_texts import (
    NOTHING_GIVEN,
    ActionTexts,
    GivenValues,
    Steps,
    calls_in,
    missing_value_error,
)
from woz_tui.session.variables import MissingValueError
from woz_tui.timeline.session_state import SessionState

#: Runs of which it is known that they have begun; so many never go on beside each other.
BEGUN = 64
#: Runs and commands that can still be labelled as mistakes.
REMEMBERED = 2000
#: Lanes of the gaze and of the face: what is played there goes with what is said.
_ACCOMPANYING = frozenset({"head", "face", "eyes"})


#: Says why what was requested may not begin any more: much can have been locked since.
WhyNot = Callable[[], Refusal | None]


class Holds(Protocol):
    """Makes some of what is asked for wait."""

    def hold(
        self,
        run: str,
        name: str,
        source: str,
        verbs: Sequence[Verb],
        begin: Callable[[], object],
    ) -> bool:
        """Whether it waits; then `begin` is called when it may begin."""
        ...

    def drop(self, run: str) -> None:
        """What is held as `run`, if anything is, has been ended."""
        ...

    def filled(self, run: str, action: Action, given: GivenValues) -> None:
        """The texts of an action were filled in for this run, which is about to begin."""
        ...


@dataclass
class ActionRun:
    """One action being played; `pending` are the commands of the present step, of `together`
    in all, and `arriving` those whose motion it waits for. `left`: how it ends after this step,
    unless something of the step goes wrong. `refused`: the command because of which it never began.
    `tried`: a command of it ended otherwise than refused. `evidence`: of what was done so far.
    `again` is asked when it begins after it has waited, and `forbidden` is what that said.
    """

    id: str
    action: Action
    origin: RequestOrigin
    steps: Steps
    when_busy: str
    at: int = -1
    pending: set[str] = field(default_factory=set)
    arriving: set[str] = field(default_factory=set)
    together: int = 0
    timer: asyncio.TimerHandle | None = None
    problem: m.ActionEnd | None = None
    left: m.ActionEnd | None = None
    ended: m.ActionEnd | None = None
    refused: m.Refused | None = None
    tried: bool = False
    evidence: set[str] = field(default_factory=set)
    again: WhyNot | None = None
    forbidden: Refusal | None = None

    @property
    def still_to_come(self) -> list[Call]:
        """The calls of the steps after the present one, or after the first if none has begun."""
        return calls_in(self.steps[max(self.at, 0) + 1 :])


class ActionRunner:
    """Plays actions. Every `action.requested` it publishes gets exactly one end.

    Args:
        hub: Where everything is published.
        bus: Takes the commands.
        texts: Choose what actions say.
        deadline: Seconds a command may wait before it must have begun; 0 means for ever.
        holds: May make it wait.
    """

    def __init__(
        self,
        hub: Hub,
        bus: Bus,
        texts: ActionTexts,
        deadline: float,
        holds: Holds,
    ) -> None:
        self._hub = hub
        self._holds_back = holds
        self._bus = bus
        self._texts = texts
        self.deadline = deadline
        self._runs: dict[str, ActionRun] = {}
        self._actions = 0
        self._commands = 0
        #: Single commands that wait for their moment, and who is told of their end.
        self._held: dict[str, tuple[m.Command, Callable[[m.End], None] | None]] = {}
        #: Runs and commands that wait for the moment for which they were asked.
        self.scheduled: dict[str, asyncio.TimerHandle] = {}
        #: What was asked for, oldest first: run or command id, and the action's or verb's name.
        self.played: dict[str, str] = {}
        hub.listen(self._on_message, m.MotionArrived, m.MotionInterrupted)

    # -- asked for ---------------------------------------------------------------------------

    def refuse(self, name: str, panel: str, origin: RequestOrigin, reason: str) -> str:
        """Log a press that is not played; returns its run id."""
        run = self._request(name, panel, origin)
        self._hub.publish(m.ActionRefused(run=run, action=name, reason=reason))
        return run

    def play(
        self,
        action: Action,
        origin: RequestOrigin,
        when_busy: str = "",
        steps: Steps | None = None,
        *,
        at: int = 0,
        again: WhyNot | None = None,
        edited: bool = False,
        given: GivenValues = NOTHING_GIVEN,
    ) -> tuple[str, RequestError | None]:
        """Begin an action: run id, and why it was refused (None: it was not).

        `steps`: what it does, filled in, where that is not what stands in the file. `at`: when it
        begins, on the axis of `t`; 0: now. `again` is asked when it begins after it has waited.
        `edited`: its sentence was typed anew. `given`: values of variables that came with the
        request.
        """
        without = [each.what for each in action.left_out]
        run_id = self._request(action.name, action.panel, origin, without, edited=edited)
        fills = steps is None
        try:
            # All of them before the first: no action ends half-way because a value is missing.
            if steps is None:
                steps = self._texts.play(action, given)
                self._holds_back.filled(run_id, action, given)
        except MissingValueError as error:
            self._hub.publish(m.ActionRefused(run=run_id, action=action.name, reason=error.reason))
            return run_id, missing_value_error(error)
        busy = when_busy or action.when_busy or "queue"
        run = ActionRun(run_id, action, origin, steps, busy, again=again)
        self._runs[run_id] = run
        if at:
            self._schedule(run_id, action.name, at, functools.partial(self._begin_late, run))
            return run_id, None
        calls = calls_in(steps)
        begin = functools.partial(self._begin_allowed, run)
        if not self._holds(run_id, action.name, origin, calls, begin):
            self._advance(run)
        if run.id in self._runs or isinstance(run.ended, m.ActionDone):
            self._supersede(run.id, action.label, origin, calls)
        elif fills and isinstance(run.ended, m.ActionRefused):
            self._texts.take_back()
        return run_id, _refusal_of(run)

    def _begin_allowed(self, run: ActionRun) -> None:
        """Begin what had to wait, unless it was ended or became forbidden meanwhile."""
        if run.id not in self._runs:
            return
        if run.again is not None and (refusal := run.again()) is not None:
            name, reason = run.action.name, refusal.reason
            self._finish(run, m.ActionRefused(run=run.id, action=name, reason=reason))
        else:
            self._advance(run)

    def _begin_late(self, run: ActionRun) -> None:
        self._begin_allowed(run)
        if run.id in self._runs or isinstance(run.ended, m.ActionDone):
            self._supersede(run.id, run.action.label, run.origin, calls_in(run.steps))

    def _schedule(self, run: str, name: str, at: int, begin: Callable[[], None]) -> None:
        """Call `begin` at its moment, unless the run or command has been ended by then."""
        self._hub.publish(m.ActionScheduled(run=run, action=name, at=at))

        def due() -> None:
            wait_us = at - self._hub.now()
            if wait_us > 0:
                self.scheduled[run] = loop.call_later(wait_us / 1_000_000, due)
                return
            self.scheduled.pop(run, None)
            begin()

        loop = asyncio.get_running_loop()
        due()

    def _forget_begin(self, run: str) -> None:
        """A run or command has ended: nothing of it begins any more."""
        self._holds_back.drop(run)
        if (timer := self.scheduled.pop(run, None)) is not None:
            timer.cancel()

    def send(
        self,
        call: Call,
        origin: RequestOrigin,
        when_busy: str = "queue",
        refusal: Refusal | None = None,
        on_end: Callable[[m.End], None] | None = None,
        *,
        like: m.Command | None = None,
        at: int = 0,
        again: WhyNot | None = None,
    ) -> m.Command:
        """Send one command that belongs to no action; with a `refusal` it is only logged.

        `like`: it repeats this command, and is called after the same action in the log. `at` and
        `again` as in `play`.
        """
        command = self._command(call, origin, when_busy=when_busy)
        if like is not None:
            command = msgspec.structs.replace(
                command,
                action=like.action,
                panel=like.panel,
                tells=like.tells,
                unfilled=like.unfilled,
            )
        if not command.passing:
            self._remember(command.command, call.verb)
        if refusal is not None:
            return self._bus.refuse(command, refusal.code, refusal.reason)

        refused: list[m.End] = []

        def ended(end: m.End) -> None:
            if isinstance(end, m.Refused):
                refused.append(end)
            if on_end is not None:
                on_end(end)

        def submit() -> m.Command:
            self._held.pop(command.command, None)
            late = self._hub.now() + round(self.deadline * 1_000_000) if self.deadline else 0
            command_now = msgspec.structs.replace(command, deadline_us=late)
            return self._bus.submit(command_now, ended, again)

        def begin() -> bool:
            """What had to wait, unless it was ended or became forbidden meanwhile; says whether it
            was sent.
            """
            if command.command not in self._held:
                return False
            if again is not None and (refusal := again()) is not None:
                self._let_go(command.command, refusal.reason, refusal.code)
                return False
            submit()
            return True

        def begin_late() -> None:
            if begin() and not refused:
                self._supersede(command.command, call.verb, origin, [call])

        if at:
            self._held[command.command] = command, on_end
            self._schedule(command.command, call.verb, at, begin_late)
            return command
        if self._holds(command.command, call.verb, origin, [call], begin):
            self._held[command.command] = command, on_end
        else:
            command = submit()
        if not refused:
            self._supersede(command.command, call.verb, origin, [call])
        return command

    def send_part(
        self,
        whole: m.Command,
        call: Call,
        when_busy: str,
        refusal: Refusal | None,
        on_end: Callable[[m.End], None],
    ) -> str:
        """Send one command as a part of what the command `whole` plays; its id."""
        origin = RequestOrigin(whole.source, whole.key, whole.console)
        run = whole.run or whole.command
        command = msgspec.structs.replace(
            self._command(call, origin, run=run, when_busy=when_busy),
            action=whole.action,
            panel=whole.panel,
            console=whole.console,
            tells=whole.tells,
            unfilled=dict.fromkeys(call.args, "...") if whole.tells else {},
        )
        if refusal is not None:
            self._bus.refuse(command, refusal.code, refusal.reason, on_end)
        else:
            self._bus.submit(command, on_end)
        return command.command

    def _holds(
        self,
        run: str,
        name: str,
        origin: RequestOrigin,
        calls: list[Call],
        begin: Callable[[], object],
    ) -> bool:
        """Whether it waits, and `begin` is called when its moment has come."""
        verbs = [
            known
            for call in calls
            if call.driver not in (SESSION, ENGAGEMENT)
            and (known := self._bus.verb(call.driver, call.verb)) is not None
        ]
        return self._holds_back.hold(run, name, origin.source, verbs, begin)

    def _let_go(self, command: str, reason: str, code: str = "stopped") -> None:
        """End a single command that was held without sending it, and log that."""
        held, on_end = self._held.pop(command)
        self._forget_begin(command)
        self._bus.refuse(held, code, reason, on_end)

    def _remember(self, played: str, name: str) -> None:
        self.played[played] = name
        if len(self.played) > REMEMBERED:
            del self.played[next(iter(self.played))]

    def _request(
        self,
        name: str,
        panel: str,
        origin: RequestOrigin,
        without: Sequence[str] = (),
        *,
        edited: bool = False,
    ) -> str:
        self._actions += 1
        run = f"a{self._actions:05d}"
        self._remember(run, name)
        self._hub.publish(
            m.ActionRequested(
                run=run,
                action=name,
                panel=panel,
                source=origin.source,
                key=origin.key,
                console=origin.console,
                without=[*without],
                edited=edited,
            )
        )
        return run

    def under_way(self, name: str) -> tuple[str, bool] | None:
        """The run of an action that was not asked for a later moment, and whether it waits."""
        for run in self._runs.values():
            if run.action.name == name and run.id not in self.scheduled:
                return run.id, run.at < 0 or self._waits(run)
        return None

    def says_now(self, run: str) -> bool:
        """Whether something is said in the step at which the run of an action is."""
        found = self._runs.get(run)
        step = found.steps[found.at] if found is not None and found.at >= 0 else ()
        return not isinstance(step, float | int) and any(
            call.verb in SPEAKING_VERBS for call in step
        )

    # -- step after step ---------------------------------------------------------------------

    def _advance(self, run: ActionRun) -> None:
        run.at += 1
        if run.at >= len(run.steps):
            lacks = ", ".join(each.what for each in run.action.left_out)
            nothing_sent = bool(lacks) and not calls_in(run.steps)
            reason = (
                Sentence(
                    "session.left_out",
                    "left out: this robot has no {lacks}",
                    lacks=lacks,
                )
                if nothing_sent
                else ""
            )
            evidence = weakest(run.evidence)
            self._finish(
                run,
                m.ActionDone(run=run.id, action=run.action.name, reason=reason, evidence=evidence),
            )
            return
        step = run.steps[run.at]
        if isinstance(step, float | int):
            run.timer = asyncio.get_running_loop().call_later(step, self._advance, run)
            return
        commands = [
            self._command(call, run.origin, action=run.action, run=run.id, when_busy=run.when_busy)
            for call in step
        ]
        # All are pending before the first is submitted: a refusal ends within `submit`.
        run.pending = {command.command for command in commands}
        pairs = zip(step, commands, strict=True)
        run.arriving = {command.command for call, command in pairs if call.until}
        run.together = len(commands)
        for command in commands:
            again = None
            if run.at == 0 and run.again is not None:
                again = functools.partial(self._why_not_any_more, run, command.command)
            self._bus.submit(command, functools.partial(self._ended, run, command.verb), again)

    def _why_not_any_more(self, run: ActionRun, command: str) -> Refusal | None:
        """Why a command of a run's first step may not go out after it has waited; once something of
        the run has begun, it goes on: what an action locks does not cut it off itself.
        """
        if run.forbidden is None and run.again is not None:
            others_wait = run.pending - {command} <= {*self._bus.waiting}
            if others_wait and len(run.pending) == run.together:
                run.forbidden = run.again()
        return run.forbidden

    def _command(
        self,
        call: Call,
        origin: RequestOrigin,
        *,
        action: Action | None = None,
        run: str = "",
        when_busy: str = "queue",
    ) -> m.Command:
        self._commands += 1
        known = self._bus.verb(call.driver, call.verb)
        return m.Command(
            command=f"c{self._commands:05d}",
            run=run,
            action=action.name if action else "",
            panel=action.panel if action else "",
            verb=call.verb,
            args=dict(call.args),
            driver=call.driver,
            source=origin.source,
            key=origin.key,
            deadline_us=self._hub.now() + round(self.deadline * 1_000_000) if self.deadline else 0,
            limit_s=known.limit_s if known else 30.0,
            when_busy=when_busy,
            tells=call.tells,
            unfilled=dict(call.unfilled),
            console="" if run else origin.console,
        )

    def _ended(self, run: ActionRun, verb: str, end: m.End) -> None:
        if run.problem is None:
            run.problem = self._problem(run, verb, end)
        run.tried = run.tried or not isinstance(end, m.Refused)
        if end.command not in run.arriving or not isinstance(end, m.Done):
            if isinstance(end, m.Done):
                run.evidence.add(end.evidence)
            self._settle(run, end.command)

    def _on_message(self, message: m.MotionArrived | m.MotionInterrupted) -> None:
        """A step may wait for a motion that goes on after its command."""
        command = message.command
        run = next((run for run in self._runs.values() if command in run.arriving), None)
        if run is None or command not in run.pending:
            return
        if isinstance(message, m.MotionArrived):
            run.evidence.add(message.evidence)
        elif run.problem is None:
            run.problem = self._not_arrived(run, message)
        self._settle(run, command)

    def _not_arrived(self, run: ActionRun, message: m.MotionInterrupted) -> m.ActionEnd:
        if message.by:
            return _superseded(run, message.by, self.played.get(message.by, message.by))
        if message.stopped:
            return m.ActionStopped(run=run.id, action=run.action.name, reason=message.reason)
        reason = f"{message.driver}: {message.reason}"
        return m.ActionFailed(run=run.id, action=run.action.name, reason=reason)

    def _settle(self, run: ActionRun, command: str) -> None:
        """One command of the step is over."""
        run.pending.discard(command)
        if run.pending or run.id not in self._runs:
            return
        over = run.problem or run.left
        if isinstance(over, m.ActionRefused) and run.tried:
            # What went out together with the refused command was heard or seen.
            over = m.ActionFailed(
                run=over.run, action=over.action, reason=over.reason, tells=over.tells
            )
        if over is not None:
            self._finish(run, over)
        else:
            self._advance(run)

    def _problem(self, run: ActionRun, verb: str, end: m.End) -> m.ActionEnd | None:
        reason = _reason(verb, end)
        match end:
            case m.Done():
                return None
            case m.Stopped():
                return m.ActionStopped(run=run.id, action=run.action.name, reason=end.reason)
            case m.Superseded(by=by):
                newer = next((each for each in self._runs.values() if by in each.pending), None)
                if newer is not None:
                    return _superseded(run, newer.id, newer.action.label)
                return _superseded(run, by, self.played.get(by, by))
            case m.Refused() if run.at == 0:
                run.refused = end
                return m.ActionRefused(
                    run=run.id, action=run.action.name, reason=reason, tells=end.tells
                )
            case _:
                return m.ActionFailed(
                    run=run.id, action=run.action.name, reason=reason, tells=end.tells
                )

    def _finish(self, run: ActionRun, end: m.ActionEnd) -> None:
        if self._runs.pop(run.id, None) is None:
            return
        self._forget_begin(run.id)
        if run.timer is not None:
            run.timer.cancel()
        run.ended = end
        self._hub.publish(end)

    # -- a newer act takes the place ----------------------------------------------------------

    def _supersede(self, newer: str, label: str, origin: RequestOrigin, calls: list[Call]) -> None:
        """End older actions after their present step, if the wizard's `newer` act
        needs a lane that they would still need.

        Otherwise their next step would cut it off, or come out of its context behind it. What is
        spoken is not ended by what accompanies speech: the gaze, the face.
        """
        if origin.source not in HANDS:
            return
        needed = self._lanes(calls)
        for run in list(self._runs.values()):
            if run.id == newer or run.id in self.scheduled:
                continue
            later = run.still_to_come
            speaks = any(call.verb in SPEAKING_VERBS for call in later)
            if self._lanes(later) & (self._lanes(calls, leading=True) if speaks else needed):
                self.end_after_step(run.id, _superseded(run, newer, label))

    def _lanes(self, calls: list[Call], leading: bool = False) -> set[tuple[str, str]]:
        """Driver and lane of each call; `leading`: without those of what accompanies speech."""
        found = set()
        for call in calls:
            verb = self._bus.verb(call.driver, call.verb)
            if verb is None or call.driver in performers():
                continue
            accompanies = verb.stream or verb.brief or verb.lane in _ACCOMPANYING
            if not (leading and accompanies):
                found.add((call.driver, verb.lane))
        return found

    # -- cut short ---------------------------------------------------------------------------

    def cancel(self, run_id: str, reason: str) -> bool:
        """End one run, or one command that belongs to none; says whether it was under way."""
        run = self._runs.get(run_id)
        found = self._bus.cancel(run_id, reason)
        if run_id in self._held:
            self._let_go(run_id, reason)
            return True
        if run is not None:
            self._stop(run, reason)
        return found or run is not None

    def cut_speech(self, reason: str) -> None:
        """End what would be said later: runs that would are over after their present step. What is
        said now is a command, to be ended as one.
        """
        for run in list(self._runs.values()):
            to_come = calls_in(run.steps[max(run.at, 0) :])
            if (run.at < 0 or self._waits(run)) and any(map(may_speak, to_come)):
                self.cancel(run.id, reason)
            elif any(map(may_speak, run.still_to_come)):
                self.end_after_step(run.id, reason)
        for command, (held, _) in list(self._held.items()):
            if may_speak(held):
                self.cancel(command, reason)

    def _waits(self, run: ActionRun) -> bool:
        """Whether all commands of its present step wait in queues."""
        begun = not run.pending or len(run.pending) < run.together
        return not begun and run.pending <= {*self._bus.waiting}

    def end_after_step(self, run_id: str, end: str | m.ActionEnd) -> None:
        """Finish the step that one run has begun, and drop those after it; one whose commands all
        wait in queues has not begun. What fails in that step is a failure all the same.

        `end`: how it ends then, or why it is stopped.
        """
        run = self._runs.get(run_id)
        if run is None:
            return
        if isinstance(end, str):
            end = m.ActionStopped(run=run.id, action=run.action.name, reason=end)
        if not run.pending:
            self._finish(run, end)
        elif self._waits(run):
            run.problem = end
            self._bus.cancel(run.id, end.reason)
        elif run.at + 1 < len(run.steps):
            run.left = end

    def empty(self, reason: str) -> bool:
        """End what waits in queues or is held; whether anything did."""
        before = len(self._runs), len(self._held), len(self._bus.waiting)
        self._drop_held(reason)
        for run in [run for run in self._runs.values() if run.at < 0]:
            self._stop(run, reason)
        self._bus.empty(reason)
        return before != (len(self._runs), len(self._held), len(self._bus.waiting))

    def stop_waiting(self, reason: str) -> None:
        """End the runs that are in a pause; those with commands on the bus end through them."""
        self._drop_held(reason)
        for run in list(self._runs.values()):
            self._stop(run, reason)

    def _drop_held(self, reason: str) -> None:
        """End every single command that is held."""
        for command in list(self._held):
            self._let_go(command, reason)

    def _stop(self, run: ActionRun, reason: str) -> None:
        self._finish(run, m.ActionStopped(run=run.id, action=run.action.name, reason=reason))


#: Code of a refusal that says what helps -> the console's key for it, if it has one.
_HELPS = {"full": "queue_empty", "consent": "", "unrecorded": "unrecorded"}


def _refusal_of(run: ActionRun) -> RequestError | None:
    """Why it was refused, and what helps; None: it was not."""
    if not isinstance(run.ended, m.ActionRefused):
        return None
    if run.refused is not None and (command := _HELPS.get(run.refused.code)) is not None:
        return RequestError(run.ended.reason, run.refused.remedy, command=command)
    return RequestError(run.ended.reason)


def may_speak(call: Call | m.Command) -> bool:
    """Whether something is said with it; what is composed may say something."""
    return call.verb in SPEAKING_VERBS or call.driver in composers()


def _superseded(run: ActionRun, by: str, label: str) -> m.ActionSuperseded:
    return m.ActionSuperseded(
        run=run.id,
        action=run.action.name,
        reason=Sentence("session.replaced", 'replaced by "{label}"', label=label),
        by=by,
    )


def _reason(verb: str, end: m.End) -> str:
    """Why a command has not worked, in words that do without the verb."""
    match end:
        case m.Refused(code="late", reason=reason):
            if verb == "say":
                return Sentence("session.not_said", "not said: {reason}", reason=reason)
            return Sentence("session.not_played_since", "not played: {reason}", reason=reason)
        case m.Refused(code="full", reason=reason):
            return Sentence("session.so_not_played", "{reason}: not played", reason=reason)
        case m.Refused(code="unrecorded" | "locked" | "part" | "profile", reason=reason):
            return reason
    if not end.reason:
        return end.driver
    return Sentence("session.said_of", "{who}: {what}", who=end.driver, what=end.reason)


class LastAct:
    """What began last, of all that a hand asked for.

    What waits, or was refused, has not been heard or seen and is not meant, however late it was
    pressed; nor what a hand steers (arrow keys, knobs), or the robot does by itself. An action
    counts from its first step on, and anew with each sentence; where a step says something, when
    that is said: its gesture may be over while its sentence still waits behind another one.

    Args:
        state: What was asked for.
        bus: Knows the verbs.
        runner: Knows what an action's step has.
    """

    def __init__(self, state: SessionState, bus: Bus, runner: ActionRunner) -> None:
        self._state, self._bus, self._runner = state, bus, runner
        self._begun: deque[str] = deque(maxlen=BEGUN)
        self._last = ""
        self._last_of: dict[str, str] = {}

    def of(self, console: str) -> str:
        """The run or command; among several wizards the last one that came over `console`. Empty:
        there was none.
        """
        return self._last_of.get(console, "") if len(self._state.wizards) > 1 else self._last

    def on_dispatched(self, message: m.Dispatched) -> None:
        """Something begins."""
        command = self._state.commands.get(message.command)
        if command is None or command.request.passing:
            return
        request = command.request
        run = request.run or request.command
        requested = self._state.actions.get(run) or self._state.commands.get(run)
        if requested is None or not is_by_hand(requested.request.source, requested.request.key):
            return
        unsaid = run in self._begun or self._runner.says_now(run)
        if unsaid and request.verb not in SPEAKING_VERBS:
            return
        verb = self._bus.verb(request.driver, request.verb)
        if run == request.command and verb is not None and (verb.stream or verb.brief):
            return
        self._begun.append(run)
        self._last = self._last_of[requested.request.console] = run
