"""What was played in a session, as far as it can be put beside another one."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from woz_tui.analysis.event_rows import first_plan, moments
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import BY_ITSELF, HANDS
from woz_tui.timeline.episodes import (
    ActionEpisode,
    CommandEpisode,
    Episode,
    EpisodeOutcome,
    RerunEpisode,
)
from woz_tui.timeline.timeline import Timeline

#: Sources of commands that the session asked for: a hand, a program, the engagement model, another
#: log. With every other one a driver has asked by itself, as a body does for the sound of a move.
SESSION_SOURCES = HANDS | BY_ITSELF
#: Commands of one driver and verb that follow each other within this time (microseconds), with
#: nothing between them, are one act: a joystick, a key that is held down.
STROKE_US = 500_000
#: Ends that come to the same: a re-run cuts short by itself what a stop has cut short then.
_CUT = frozenset({EpisodeOutcome.STOPPED, EpisodeOutcome.SUPERSEDED})


@dataclass(frozen=True, slots=True)
class PlayedAct:
    """An action by its name, or a command that belongs to none.

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
class PlayedSession:
    """The acts of a log, to be compared with those of another one.

    Attributes:
        name: What its files are called, without their endings.
        start: Its first line.
        title: The experiment's title; empty: the log tells none.
        acts: Actions, and commands that belong to none, in the order in which they were asked for.
        commands: Each command by itself, in the order in which they began.
        original: Of which log it is a re-run; empty: of none.
        original_sha256: The hash of that log's lines; empty: unknown.
        skipped: Why commands of the original were left out, by their ids.
        streams: How many setpoints there were that are no acts of their own: those of knobs, and
            all but the first of a stream.
    """

    name: str
    start: m.SessionStart | None = None
    title: str = ""
    acts: list[PlayedAct] = field(default_factory=list)
    commands: list[PlayedAct] = field(default_factory=list)
    original: str = ""
    original_sha256: str = ""
    skipped: dict[str, str] = field(default_factory=dict)
    streams: int = 0

    @property
    def redacted(self) -> bool:
        """Whether texts were taken out of the log, the name of its original included."""
        return self.start is not None and self.start.redacted


def played_session(name: str, messages: Iterable[m.Message]) -> PlayedSession:
    """Reads the acts out of a log's messages; samples may be left out.

    What the engagement model was told is left out, and what it had the robot do is in.
    """
    timeline = Timeline(passing=True)
    for message in messages:
        timeline.apply(message)
    timeline.finish()
    return _played(name, timeline)


def _played(name: str, timeline: Timeline) -> PlayedSession:
    again = {line.command: line for _, line in moments(timeline, m.RerunSent)}
    of_runs: dict[str, list[PlayedAct]] = {}
    plan = first_plan(timeline)
    found = PlayedSession(name, timeline.state.start)
    found.title = plan.title if plan is not None and not found.redacted else ""
    for command in timeline.of(CommandEpisode):
        request = command.request
        if request.driver == ENGAGEMENT or request.source not in SESSION_SOURCES:
            continue
        act = _act(command, again.get(request.command))
        found.commands.append(act)
        if request.run:
            of_runs.setdefault(request.run, []).append(act)
        elif request.passing:
            found.streams += 1
        else:
            found.acts.append(act)
    runs = {each.request.run: each for each in timeline.of(ActionEpisode)}
    found.acts += (_act_of_action(each, of_runs.get(run, ())) for run, each in runs.items())
    found.acts.sort(key=lambda act: act.t)
    count = len(found.acts)
    found.acts = list(_strokes(found.acts, runs))
    found.streams += count - len(found.acts)
    found.commands.sort(key=lambda act: act.moment)
    for rerun in timeline.of(RerunEpisode):
        found.original = rerun.label
        found.original_sha256 = rerun.started.original_sha256
    for _, line in moments(timeline, m.RerunSkipped):
        found.skipped[line.original_command] = line.reason
    return found


def _act(command: CommandEpisode, again: m.RerunSent | None) -> PlayedAct:
    request = command.request
    act = PlayedAct(
        id=request.command,
        name=f"{request.driver}.{request.verb}",
        t=command.begin,
        began=-1 if command.started is None else command.started,
        end=_end(command),
        args=(request.args,),
        sent=({k: v for k, v in command.sent.items() if k in request.args},)
        if command.outcome == EpisodeOutcome.DONE
        else (),
    )
    if again is None:
        return act
    return replace(act, original=again.original_command, late=act.moment - again.due)


def _act_of_action(action: ActionEpisode, commands: Sequence[PlayedAct]) -> PlayedAct:
    return PlayedAct(
        id=action.request.run,
        name=action.label,
        t=action.begin,
        began=min((act.began for act in commands if act.began >= 0), default=-1),
        end=_end(action),
        args=tuple(args for act in commands for args in act.args),
        sent=tuple(sent for act in commands for sent in act.sent),
    )


def _end(episode: Episode) -> str:
    return "" if episode.cut else "cut" if episode.outcome in _CUT else episode.outcome


def _strokes(acts: Iterable[PlayedAct], runs: Container[str]) -> Iterator[PlayedAct]:
    """The acts, with one for each stream of setpoints."""
    last: PlayedAct | None = None
    begun: PlayedAct | None = None
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
