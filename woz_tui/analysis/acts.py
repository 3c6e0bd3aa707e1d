"""What was asked for and what became of it: actions, commands, how long they took."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.tally import Tally
from woz_tui.core import messages as m
from woz_tui.experiment.verbs import PERFORMERS

#: Sources that are no human at this session.
BY_MACHINE = frozenset({"engagement", "program", "replay"})
#: Runs and commands that a mistake may still name.
REMEMBERED = 4000

#: How an action can end, as a word.
ACTION_ENDS: dict[type[m.Message], str] = {
    m.ActionDone: "done",
    m.ActionFailed: "failed",
    m.ActionStopped: "stopped",
    m.ActionRefused: "refused",
}
_COMMAND_ENDS: dict[type[m.Message], str] = {
    m.Done: "done",
    m.Failed: "failed",
    m.TimedOut: "timed_out",
    m.Refused: "refused",
    m.Stopped: "stopped",
    m.Superseded: "superseded",
}


@dataclass(slots=True)
class _Run:
    tally: Tally
    action: str
    panel: str
    source: str
    t: int
    #: Its first command for a robot has been seen.
    begun: bool = False


@dataclass(slots=True)
class _Command:
    tally: Tally
    verb: str
    #: Of the first of an act by hand, where that act counts: its start is when the robot answers.
    act: Tally | None


class Acts:
    """Follows every action and command from its request to its end.

    `on_act` hears of each act by hand as it is asked for: the action's name (or the verb), and its
    id.
    """

    def __init__(self, course: Course, on_act: Callable[[str, str], None]) -> None:
        self._course = course
        self._on_act = on_act
        self._runs: dict[str, _Run] = {}
        self._commands: dict[str, _Command] = {}
        #: Where acts were counted that a mistake may name, the newest last; None: not by hand.
        self._played: dict[str, Tally | None] = {}
        #: Passing commands: they are no acts, whoever calls them a mistake.
        self._passing: dict[str, Tally | None] = {}
        self._wrong: set[str] = set()
        self._last: tuple[Tally, int] | None = None
        course.leaving.append(self._leave)

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.ActionRequested: self._requested,
            m.Command: self._command,
            m.Dispatched: self._dispatched,
            m.Mistake: self._mistake,
            m.ActionHeld: self._held,
            **dict.fromkeys(ACTION_ENDS, self._ended),
            **dict.fromkeys(_COMMAND_ENDS, self._command_ended),
        }

    def finish(self) -> None:
        """The log is over: what has no end stays open."""
        for run in self._runs.values():
            self._count(run, "open")
        for command in self._commands.values():
            command.tally.verb(command.verb).ends["open"] += 1

    def _requested(self, message: m.ActionRequested) -> None:
        course = self._course
        left = self._runs.pop(message.run, None)
        if left is not None:  # ids of a damaged log may repeat
            self._count(left, "open")
        self._runs[message.run] = _Run(
            course.tally, message.action, message.panel, message.source, course.t
        )
        if message.source not in BY_MACHINE:
            course.tally.by_hand += 1
            self._act(message.action, message.run)
        else:
            self._remember(message.run, None)

    def _act(self, name: str, run: str) -> None:
        course = self._course
        if self._last is not None and self._last[0] is course.tally:
            course.tally.gaps.add(course.t - self._last[1])
        self._last = (course.tally, course.t)
        self._remember(run, course.tally)
        self._on_act(name, run)

    def _remember(self, run: str, tally: Tally | None) -> None:
        _keep(self._played, run, tally)

    def _ended(self, message: m.ActionEnd) -> None:
        run = self._runs.pop(message.run, None)
        if run is None:
            return
        end = ACTION_ENDS[type(message)]
        self._count(run, end)
        if end == "done":
            run.tally.took.add(self._course.t - run.t)

    def _count(self, run: _Run, end: str) -> None:
        run.tally.counts[run.action, run.panel, run.source, end] += 1

    def _command(self, message: m.Command) -> None:
        if message.passing:  # apart: a knob's way is long and would push the acts out
            _keep(self._passing, message.command, None)
            return
        course = self._course
        by_hand = message.source not in BY_MACHINE
        of_robot = message.driver not in PERFORMERS
        act = None
        if message.run:
            run = self._runs.get(message.run)
            if run is not None and of_robot and not run.begun:
                run.begun = True
                act = run.tally if by_hand else None
        elif by_hand and of_robot:
            act = course.tally
            course.tally.direct += 1
            self._act(message.verb, message.command)
        else:
            self._remember(message.command, None)
        if of_robot:
            self._commands[message.command] = _Command(course.tally, message.verb, act)

    def _dispatched(self, message: m.Dispatched) -> None:
        command = self._commands.get(message.command)
        if command is None:
            return
        command.tally.verb(command.verb).dispatched.add(message.latency_us)
        if command.act is not None:
            command.act.press.add(message.latency_us)
            command.act = None

    def _command_ended(self, message: m.End) -> None:
        command = self._commands.pop(message.command, None)
        if command is None:
            return
        verb = command.tally.verb(command.verb)
        verb.ends[_COMMAND_ENDS[type(message)]] += 1
        if isinstance(message, m.Done):
            verb.done.add(message.duration_us)

    def _mistake(self, message: m.Mistake) -> None:
        if message.run in self._wrong or message.run in self._passing:
            return
        self._wrong.add(message.run)
        tally = self._played.get(message.run, self._course.tally)
        if tally is not None:
            tally.mistakes += 1

    def _held(self, message: m.ActionHeld) -> None:
        self._course.tally.held.add(message.until - self._course.t)

    def _leave(self) -> None:
        """No gap reaches over the border between two trials or conditions."""
        self._last = None


def _keep(found: dict[str, Tally | None], run: str, tally: Tally | None) -> None:
    """The newest `REMEMBERED` are kept."""
    found[run] = tally
    if len(found) > REMEMBERED:
        del found[next(iter(found))]
