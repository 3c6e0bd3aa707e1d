"""What was played in a session, as far as it can be put beside another one."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from woz_tui.core import messages as m
from woz_tui.experiment.verbs import ENGAGEMENT

#: Sources of commands that the session asked for: a hand, a program, the engagement model, another
#: log. With every other one a driver has asked by itself, as a body does for the sound of a move.
ASKED = frozenset({"key", "script", "palette", "midi", "program", ENGAGEMENT, "replay"})
#: Commands of one driver and verb that follow each other within this time (microseconds), with
#: nothing between them, are one act: a joystick, a key that is held down.
STROKE_US = 500_000
#: Ends that come to the same: a re-run cuts short by itself what a stop has cut short then.
_CUT = frozenset({"stopped", "superseded"})


@dataclass(frozen=True, slots=True)
class Act:
    """Something that was done: an action by its name, or a command that belongs to none.

    Attributes:
        id: Its run or command in its own log.
        name: The action, or `driver.verb`.
        t: When it was asked for, in microseconds on the axis of its own log.
        began: When its first command began; -1: none has.
        end: How it ended: done, failed, refused, timed_out, or cut for what was stopped or made
            way; empty: the log does not say.
        args: The arguments of its commands, in order.
        sent: Those of them that were carried out, as they really went to the hardware.
        original: The command of the original, in a re-run.
        late: How much later it began than it was due, in microseconds; 0 where nothing was due.
    """

    id: str
    name: str
    t: int
    began: int = -1
    end: str = ""
    args: tuple[dict[str, m.Json], ...] = ()
    sent: tuple[dict[str, m.Json], ...] = ()
    original: str = ""
    late: int = 0

    @property
    def moment(self) -> int:
        """When it began; if it never did, when it was asked for."""
        return self.began if self.began >= 0 else self.t


@dataclass
class Played:
    """What of a log can be compared.

    Attributes:
        name: What its files are called, without their endings.
        start: Its first line.
        acts: Actions, and commands that belong to none, in the order in which they were asked for.
        commands: Each command by itself, in the order in which they began.
        original: Of which log it is a re-run; empty: of none.
        skipped: Why commands of the original were left out, by their ids.
        streams: How many setpoints there were that are no acts of their own: those of knobs, and
            all but the first of a stream.
    """

    name: str
    start: m.SessionStart | None = None
    acts: list[Act] = field(default_factory=list)
    commands: list[Act] = field(default_factory=list)
    original: str = ""
    skipped: dict[str, str] = field(default_factory=dict)
    streams: int = 0


def played(name: str, messages: Iterable[m.AnyMessage]) -> Played:
    """What was played, out of a log's messages; samples may be left out.

    What the engagement model was told is left out, and what it had the robot do is in.
    """
    reader = _Reader(Played(name))
    for message in messages:
        reader.take(message)
    return reader.finished()


@dataclass
class _Reader:
    played: Played
    runs: dict[str, Act] = field(default_factory=dict)
    commands: dict[str, m.Command] = field(default_factory=dict)
    began: dict[str, int] = field(default_factory=dict)
    ends: dict[str, m.End] = field(default_factory=dict)
    again: dict[str, m.RerunSent] = field(default_factory=dict)

    def take(self, message: m.AnyMessage) -> None:
        match message:
            case m.ActionRequested():
                self.runs[message.run] = Act(message.run, message.action, message.t)
            case m.ActionEnd() if message.run in self.runs:
                end = _end(message, "action.")
                self.runs[message.run] = replace(self.runs[message.run], end=end)
            case m.Command():
                self.commands[message.command] = message
            case m.Dispatched():
                self.began[message.command] = message.t
            case m.End():
                self.ends[message.command] = message
            case m.SessionStart() if self.played.start is None:
                self.played.start = message
            case _:
                self._take_rerun(message)

    def _take_rerun(self, message: m.AnyMessage) -> None:
        match message:
            case m.RerunStarted():
                self.played.original = message.original
            case m.RerunSent():
                self.again[message.command] = message
            case m.RerunSkipped():
                self.played.skipped[message.original_command] = message.reason

    def finished(self) -> Played:
        of_runs: dict[str, list[Act]] = {}
        for command in self.commands.values():
            if command.driver == ENGAGEMENT or command.source not in ASKED:
                continue
            act = self._act(command)
            self.played.commands.append(act)
            if command.run:
                of_runs.setdefault(command.run, []).append(act)
            elif command.passing:
                self.played.streams += 1
            else:
                self.played.acts.append(act)
        self.played.acts += (_whole(run, of_runs.get(name, ())) for name, run in self.runs.items())
        self.played.acts.sort(key=lambda act: act.t)
        whole = len(self.played.acts)
        self.played.acts = list(_strokes(self.played.acts, self.runs))
        self.played.streams += whole - len(self.played.acts)
        self.played.commands.sort(key=lambda act: act.moment)
        return self.played

    def _act(self, command: m.Command) -> Act:
        end = self.ends.get(command.command)
        again = self.again.get(command.command)
        began = self.began.get(command.command, -1)
        act = Act(
            id=command.command,
            name=f"{command.driver}.{command.verb}",
            t=command.t,
            began=began,
            end=_end(end, "command.") if end is not None else "",
            args=(command.args,),
            sent=({k: v for k, v in end.sent.items() if k in command.args},)
            if isinstance(end, m.Done)
            else (),
        )
        if again is None:
            return act
        return replace(act, original=again.original_command, late=act.moment - again.due)


def _strokes(acts: Iterable[Act], runs: Container[str]) -> Iterator[Act]:
    """The acts, of each stream of setpoints one."""
    last: Act | None = None
    begun: Act | None = None
    for act in acts:
        goes_on = (
            begun is not None
            and last is not None
            and act.id not in runs
            and act.name == last.name
            and act.t - last.t < STROKE_US
        )
        if goes_on and begun is not None:
            begun = replace(begun, end=act.end, args=(), sent=())
        else:
            if begun is not None:
                yield begun
            begun = act
        last = act
    if begun is not None:
        yield begun


def _whole(run: Act, commands: Sequence[Act]) -> Act:
    return replace(
        run,
        began=min((act.began for act in commands if act.began >= 0), default=-1),
        args=tuple(args for act in commands for args in act.args),
        sent=tuple(sent for act in commands for sent in act.sent),
    )


def _end(end: m.Message, prefix: str) -> str:
    how = str(end.__struct_config__.tag).removeprefix(prefix)
    return "cut" if how in _CUT else how
