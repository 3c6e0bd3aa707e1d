"""Which actions are under way, how the last ones ended, and which failures nobody has seen yet."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace

from woz_tui.console.wording import words
from woz_tui.core import messages as m

#: More runs than this are never under way; the oldest are forgotten if ends never come.
ACTIVE = 500
FAILURES = 200
#: What is said of a command that was taken, but moves nothing before the robot's mode is over.
LATER = "counts after the mode"

_HOW: dict[type[m.Message], str] = {
    m.ActionDone: "done",
    m.ActionFailed: "failed",
    m.ActionStopped: "stopped",
    m.ActionRefused: "refused",
    m.Done: "done",
    m.Failed: "failed",
    m.TimedOut: "failed",
    m.Refused: "refused",
    m.Stopped: "stopped",
    m.Superseded: "stopped",
}


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended; `how` is done, waits (done, but it counts later), failed, refused or
    stopped.
    """

    run: str
    how: str
    t: int
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Failure:
    """Something that did not work. `action` may be empty: then `what` says what was tried."""

    run: str
    action: str
    what: str
    reason: str
    remedy: str
    t: int


@dataclass(frozen=True, slots=True)
class Refusal:
    """What a driver would not do, and why. `action` is empty where `what` says what was tried."""

    action: str
    what: str
    reason: str
    remedy: str

    def sentence(self, label: str) -> str:
        """It in a line; `label` is the action's."""
        remedy = f" ({self.remedy})" if self.remedy else ""
        return f"{label or self.what}: {self.reason}{remedy}"


@dataclass(slots=True)
class Doing:
    """One command of a run: since when it is at work, and when it should be over."""

    begun: int | None = None
    until: int | None = None


@dataclass(slots=True)
class Run:
    """One press under way. `what` says it in words where no action has a name for it."""

    run: str
    action: str
    what: str
    t: int
    began: int | None = None
    commands: dict[str, Doing] = field(default_factory=dict)
    remedy: str = ""
    #: From when until when it is held back, so as not to answer a cue too soon.
    held: tuple[int, int] | None = None
    #: Something of it counts only after the mode.
    waits: bool = False

    @property
    def running(self) -> bool:
        """Whether a driver has begun; until then it is queued."""
        return self.began is not None

    def held_for(self, now: int) -> tuple[int, float] | None:
        """Microseconds for which it is still held back, and the share (0..1) gone by."""
        if self.held is None or self.running or now >= self.held[1]:
            return None
        begun, until = self.held
        return until - now, min(1.0, max(0.0, (now - begun) / max(1, until - begun)))

    def timing(self, now: int) -> tuple[int | None, float | None]:
        """Microseconds still to go and the share (0..1) gone by; None where nobody has said."""
        known = [
            (doing.until, doing.begun if doing.begun is not None else self.t)
            for doing in self.commands.values()
            if doing.until is not None
        ]
        if not known:
            return None, None
        until, begun = max(known)
        left = max(0, until - now)
        whole = max(1, until - begun)
        return left, min(1.0, max(0.0, 1 - left / whole))


def outcome_of(message: m.Message) -> Outcome | None:
    """The end that `message` tells, of an action or of a command sent on its own."""
    how = _HOW.get(type(message))
    if how is None:
        return None
    if isinstance(message, m.ActionEnd):
        return Outcome(message.run, how, message.t, message.reason)
    if isinstance(message, m.Done) and message.sent.get("waits"):
        return Outcome(message.command, "waits", message.t, LATER)
    if isinstance(message, m.End):
        return Outcome(message.command, how, message.t, message.reason)
    return None


@dataclass(slots=True)
class Runs:
    """All runs under way by id, the last outcome of each action, failures until seen."""

    active: dict[str, Run] = field(default_factory=dict)
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    failures: deque[Failure] = field(default_factory=lambda: deque(maxlen=FAILURES))
    seen: set[str] = field(default_factory=set)
    _refusal: Refusal | None = None
    _home: dict[str, str] = field(default_factory=dict)

    def of(self, action: str) -> Run | None:
        """The run of `action` to show: one at work before one that waits."""
        waiting = None
        for run in self.active.values():
            if run.action == action:
                if run.running:
                    return run
                waiting = waiting or run
        return waiting

    def failure_of(self, action: str) -> Failure | None:
        """The last failure of `action` if nobody has seen it and it has not worked since."""
        last = self.outcomes.get(action)
        for failure in reversed(self.failures):
            if failure.action == action:
                worked = last is not None and last.how in ("done", "waits") and last.t > failure.t
                return None if failure.run in self.seen or worked else failure
        return None

    def told(self, message: m.Message) -> Outcome | None:
        """The end that `message` tells, with what its commands said before; after `take`."""
        outcome = outcome_of(message)
        if outcome is None or not isinstance(message, m.ActionEnd):
            return outcome
        known = self.outcomes.get(message.action)
        return known if known is not None and known.run == outcome.run else outcome

    def unseen(self) -> list[Failure]:
        """Failures not yet acknowledged, oldest first."""
        return [failure for failure in self.failures if failure.run not in self.seen]

    def see_all(self) -> None:
        """Acknowledge every failure."""
        self.seen.update(failure.run for failure in self.failures)

    def read_refusal(self) -> Refusal | None:
        """The last refusal that nobody has read: the list of events is too narrow to say why."""
        refusal, self._refusal = self._refusal, None
        return refusal

    def take(self, message: m.Message) -> Failure | None:
        """Work a message in; the failure it tells, if it tells one."""
        match message:
            case m.ActionRequested():
                self._open(Run(message.run, message.action, message.action, message.t))
            case m.Command() if not message.passing:
                self._command(message)
            case m.Dispatched() | m.Progress():
                self._advance(message)
            case m.ActionHeld():
                if (run := self.active.get(message.run)) is not None:
                    run.held = (message.t, message.until)
            case m.ActionEnd():
                return self._end(message)
            case m.End():
                return self._command_end(message)
        return None

    def _open(self, run: Run) -> None:
        if run.run in self.active:
            return
        if len(self.active) >= ACTIVE:
            self._forget(next(iter(self.active)))
        self.active[run.run] = run

    def _forget(self, run: str) -> Run | None:
        gone = self.active.pop(run, None)
        if gone is not None:
            for command in gone.commands:
                self._home.pop(command, None)
        return gone

    def _command(self, message: m.Command) -> None:
        home = message.run or message.command
        if home not in self.active:
            self._open(Run(home, message.action, words(message), message.t))
        run = self.active[home]
        if message.args.get("text"):
            run.what = words(message)
        run.commands[message.command] = Doing()
        self._home[message.command] = home

    def _advance(self, message: m.Dispatched | m.Progress) -> None:
        run = self.active.get(self._home.get(message.command, ""))
        if run is None:
            return
        doing = run.commands.setdefault(message.command, Doing())
        if run.began is None:
            run.began = message.t
        if doing.begun is None:
            doing.begun = message.t
        if isinstance(message, m.Progress):
            doing.until = message.t + max(0, message.expected_us)

    def _end(self, message: m.ActionEnd) -> Failure | None:
        run = self._forget(message.run)
        outcome = outcome_of(message)
        if outcome is None:
            return None
        if outcome.how == "done" and run is not None and run.waits:
            outcome = replace(outcome, how="waits", reason=LATER)
        self.outcomes[message.action] = outcome
        if outcome.how != "failed" or message.run in self.seen:
            return None
        what = run.what if run is not None else message.action
        remedy = run.remedy if run is not None else ""
        return Failure(message.run, message.action, what, message.reason, remedy, message.t)

    def _command_end(self, message: m.End) -> Failure | None:
        home = self._home.pop(message.command, None)
        run = self.active.get(home) if home is not None else None
        if run is None:
            return None
        run.commands.pop(message.command, None)
        if message.remedy:
            run.remedy = message.remedy
        if isinstance(message, m.Done) and message.sent.get("waits"):
            run.waits = True
        if isinstance(message, m.Refused):
            self._refusal = Refusal(run.action, run.what, message.reason, message.remedy)
        if run.run != message.command:
            return None  # its action's end is still to come
        self.active.pop(run.run, None)
        if isinstance(message, m.Failed | m.TimedOut) and message.command not in self.seen:
            reason = f"{message.driver}: {message.reason}".strip(": ")
            return Failure(message.command, "", run.what, reason, message.remedy, message.t)
        return None
