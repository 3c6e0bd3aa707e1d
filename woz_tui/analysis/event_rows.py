"""Rows of the event tables (cues, trials, stops, answers ...), made from a session's timeline.
Times are microseconds on the axis of `t`.
"""

from __future__ import annotations

import bisect
import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, TypeVar

from woz_tui.config.performers import performers
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import is_by_hand
from woz_tui.timeline import episodes as e
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context

M = TypeVar("M", bound=m.Message)
L = TypeVar("L", bound="LastingRow")
#: Whether what happened in a context counts.
Counted = Callable[[Context], bool]

#: What can be a cue, beside those that features give.
CUE_TYPES = ("speech", "engagement", "marker")
#: What can become of a cue.
CUE_RESULTS = ("answered", "answered_early", "missed", "superseded", "cut")
#: The name under which an unbroken engagement stands among the visits.
ENGAGED_VISIT = "engaged"
#: The source of markers that the preflight list sets.
PREFLIGHT = "preflight"


@dataclass(frozen=True, slots=True, kw_only=True)
class ContextRow:
    """Something in a context. `trial` is the trial's number, -1 outside. `counted`: means over
    participants include it.
    """

    participant: str = ""
    condition: str = ""
    trial: int = -1
    phase: str = ""
    counted: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class LastingRow(ContextRow):
    """Something that lasted, or the piece of it within one context.

    Attributes:
        changed: It began then; else it is a further piece of what went on.
        cut: It was not over when the log, or the model, ended.
    """

    begin: int
    end: int
    changed: bool = True
    cut: bool = False

    @property
    def duration(self) -> int:
        return self.end - self.begin


@dataclass(frozen=True, slots=True, kw_only=True)
class CueRow(ContextRow):
    """An event that needs an answer, and how the wizard answered it.

    Attributes:
        cue_type: One of `CUE_TYPES`, or of a feature.
        t: Its moment.
        what: The state, the number of the utterance, the marker's text, the trained cue's type.
        result: One of `CUE_RESULTS`.
        reaction_us: To the act that answered it; None: nothing did.
        action: Name of that action, or the verb of a command that belonged to none.
        run: Id of that run, or of the command.
        echo: It followed within a second of another open cue and stands for the same event, so
            the figures over all types leave it out.
        judged: Of trained cues: right, wrong or missed.
    """

    cue_type: str
    t: int
    what: str
    result: str
    reaction_us: int | None = None
    action: str = ""
    run: str = ""
    echo: bool = False
    judged: str = ""


@dataclass(frozen=True, slots=True)
class TrialRow:
    """A trial; `end` is None if it never ended, then `outcome` is empty. `left_out`: why it is not
    to be analysed (aborted, excluded, practice, cut off); empty: it is.
    """

    trial: int
    participant: str
    condition: str
    begin: int
    end: int | None
    outcome: str
    text: str
    actions: int
    left_out: str = ""

    @property
    def duration(self) -> int | None:
        """How long it lasted; None: it has no end in the log."""
        return None if self.end is None else self.end - self.begin

    @property
    def counted(self) -> bool:
        """Whether its data are to be analysed."""
        return not self.left_out


@dataclass(frozen=True, slots=True, kw_only=True)
class PhaseRow(ContextRow):
    """A phase, breaks inside it included.

    Attributes:
        end: None if its end is not in the log.
        planned: How long it was to last; None: nobody said.
        source: Who began it: key, palette, program; trial or session where it began with that.
        actions: How many actions were asked for in it.
    """

    begin: int
    end: int | None
    planned: int | None
    source: str
    actions: int

    @property
    def duration(self) -> int | None:
        """How long it lasted; None: it has no end in the log."""
        return None if self.end is None else self.end - self.begin


@dataclass(frozen=True, slots=True)
class SpanRow:
    """Something that lasted: a break, a lost driver.

    `end`: of a lost driver None if it never came back; of a break without an end in the log, when
    the next trial began or the log ended.
    """

    begin: int
    end: int | None
    name: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class StopRow:
    """A stop. `elapsed_us` and the drivers are None and empty if no confirmation is in the log;
    a driver of several parts is followed by those in brackets. `unreached`: those of `missing`
    that were not connected. `late`: all confirmed, later than was promised. `released`: when it was
    over, one of driving alone as soon as it was confirmed; None: it lasted to the end.
    """

    t: int
    source: str
    scope: str
    confirmed: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    unreached: tuple[str, ...] = ()
    elapsed_us: int | None = None
    late: bool = False
    released: int | None = None


@dataclass(frozen=True, slots=True)
class MarkRow:
    """A marker, note or mistake (`sort`); of a mistake also which run of which action."""

    t: int
    sort: str
    text: str = ""
    action: str = ""
    run: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class VisitRow(LastingRow):
    """A stay in a state of the engagement model, or (`state` is `engaged`) an unbroken engagement;
    or the piece of it within one context.

    Attributes:
        entered_by: The transition that led to it, and `left_by` the one that ended it.
        visitor: Who was known as it began; of an engagement who was recognised last.
        forced: The wizard led to it, or decided a verdict on which it rests.
        why: Why it was entered, in words.
    """

    state: str
    entered_by: str = ""
    left_by: str = ""
    visitor: str = ""
    forced: bool = False
    why: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingRow(LastingRow):
    """A robot's setting had one value, within one trial, condition or break.

    Attributes:
        setting: Its name.
        value: What the robot had.
        wanted: What was asked for, where it differs.
        differs: The robot had something else than what was asked for; None: unknown, since the
            robot was lost or does not tell it any more.
        begin: When it was read so.
        end: When it was read otherwise, the robot was lost, or trial, condition or break changed.
    """

    seq: int
    driver: str
    setting: str
    value: m.Json
    wanted: m.Json
    differs: bool | None


@dataclass(frozen=True, slots=True)
class RestrictionRow:
    """From `t` on the wizard did not see what is `hidden`, nor legibly what is `blurred`."""

    t: int
    hidden: tuple[str, ...]
    blurred: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PanelRow:
    """A panel that the wizard had, as it was at the beginning."""

    title: str
    actions: tuple[str, ...]
    locked: bool


@dataclass(frozen=True, slots=True)
class ConsoleRow:
    """A console came (`why` is empty) or went."""

    t: int
    console: str
    role: str
    lost: bool
    why: str = ""


# -- from the timeline ----------------------------------------------------------------------------


def context_fields(context: Context) -> dict[str, Any]:
    """The fields of a context, as `ContextRow` has them."""
    return {
        "participant": context.participant,
        "condition": context.condition,
        "trial": -1 if context.trial is None else context.trial,
        "phase": context.stage,
    }


def value_text(value: m.Json) -> str:
    """The value of a setting or an argument: a text as it is, anything else as JSON."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def moments(timeline: Timeline, kind: type[M]) -> Iterator[tuple[Context, M]]:
    """All single messages of a kind, each with its context."""
    for each in timeline.of(e.MomentEpisode):
        if isinstance(each.message, kind):
            yield each.context, each.message


def first_plan(timeline: Timeline) -> m.SessionPlan | None:
    """What consoles were shown at the beginning; None if they never were."""
    plans = [plan for _, plan in moments(timeline, m.SessionPlan)]
    return next((plan for plan in plans if plan.title), plans[-1] if plans else None)


def trials(timeline: Timeline) -> Iterator[TrialRow]:
    """All trials, also those that do not count."""
    actions = Counter(each.context.run for each in timeline.of(e.ActionEpisode))
    for each in timeline.of(e.TrialEpisode):
        yield TrialRow(
            trial=each.started.trial,
            participant=each.context.participant,
            condition=each.context.condition,
            begin=each.begin,
            end=None if each.cut else each.end,
            outcome="" if each.cut else each.outcome,
            text=each.text,
            actions=actions[each.seq],
            left_out=timeline.left_out(each),
        )


def phases(timeline: Timeline, counted: Counted) -> Iterator[PhaseRow]:
    """All phases, also those in trials that do not count."""
    found = timeline.of(e.StageEpisode)
    begins = [(each.begin, each.seq) for each in found]
    actions: Counter[int] = Counter()
    for act in timeline.of(e.ActionEpisode) if found else ():
        if act.context.stage:
            actions[bisect.bisect_right(begins, (act.begin, act.seq)) - 1] += 1
    for place, each in enumerate(found):
        yield PhaseRow(
            **context_fields(each.context) | {"phase": each.label},
            begin=each.begin,
            end=None if each.cut else each.end,
            planned=each.planned_us or None,
            source=each.source,
            actions=actions[place],
            counted=counted(each.context),
        )


def breaks(timeline: Timeline) -> Iterator[SpanRow]:
    """All breaks, inside trials and outside."""
    for each in timeline.of(e.BreakEpisode):
        text = each.ended.text if each.ended is not None else ""
        yield SpanRow(each.begin, each.end, "break", text or each.started.text)


def lost_drivers(timeline: Timeline) -> Iterator[SpanRow]:
    """Each time a driver was lost or faulted."""
    for each in timeline.of(e.LostDriverEpisode):
        yield SpanRow(each.begin, None if each.cut else each.end, each.label, each.reason)


def drivers(timeline: Timeline) -> dict[str, None]:
    """Names of all drivers that were ever ready or lost, in the order of the first time."""
    kinds = m.DriverConnected | m.DriverFaulted | m.DriverLost
    lines = [
        each.message for each in timeline.of(e.MomentEpisode) if isinstance(each.message, kinds)
    ]
    lines += [each.lost for each in timeline.of(e.LostDriverEpisode)]
    return dict.fromkeys(line.driver for line in sorted(lines, key=attrgetter("t", "seq")))


def stops(timeline: Timeline) -> Iterator[StopRow]:
    """Every press of the stop, who confirmed it, and when it was released."""
    for each in timeline.of(e.StopEpisode):
        for press in each.presses:
            pressed = press.pressed
            row = StopRow(
                pressed.t, pressed.source, pressed.scope, released=None if each.cut else each.end
            )
            for message in press.confirmations[:1]:
                unreached = {name: ["not reached"] for name in message.unreached}
                row = replace(
                    row,
                    confirmed=_with_parts(message.confirmed, message.parts),
                    missing=_with_parts(message.missing, {**message.missing_parts, **unreached}),
                    unreached=tuple(message.unreached),
                    elapsed_us=message.elapsed_us,
                    late=message.late,
                )
            yield row


def _with_parts(names: list[str], parts: Mapping[str, list[str]]) -> tuple[str, ...]:
    """`pepper (motion, speech)`: names of drivers, with the parts that were named of some."""
    return tuple(
        f"{name} ({', '.join(parts[name])})" if parts.get(name) else name for name in names
    )


def marks(timeline: Timeline) -> Iterator[MarkRow]:
    """Markers except those of the preflight list, notes and mistakes."""
    for each in timeline.of(e.MomentEpisode):
        match each.message:
            case m.Marker() as marker if marker.source != PREFLIGHT:
                yield MarkRow(marker.moment, "marker", marker.text, source=marker.source)
            case m.Note() as note:
                yield MarkRow(each.begin, "note", note.text)
            case m.Mistake() as wrong:
                yield MarkRow(each.begin, "mistake", wrong.text, wrong.action, wrong.run)


def visits(timeline: Timeline) -> list[VisitRow]:
    """Unclipped stays in states and engagements, by when they ended."""
    found = [_visit(each, each.state) for each in timeline.of(e.ModelStateEpisode)]
    found += [_visit(each, ENGAGED_VISIT) for each in timeline.of(e.EngagementEpisode)]
    return sorted(found, key=lambda visit: visit.end)


def stays(timeline: Timeline, counted: Counted) -> Iterator[VisitRow]:
    """Stays in states, clipped to contexts."""
    for each in timeline.of(e.ModelStateEpisode):
        yield from _pieces(_visit(each, each.state), each, timeline, counted)


def _pieces(row: L, episode: e.Episode, timeline: Timeline, counted: Counted) -> Iterator[L]:
    """The row of an episode, once for each context."""
    parts = timeline.parts(episode)
    for part in parts:
        yield replace(
            row,
            **context_fields(part.context),
            begin=part.begin,
            end=part.end,
            changed=part is parts[0],
            cut=episode.cut and part is parts[-1],
            counted=counted(part.context),
        )


def _visit(each: e.ModelStateEpisode | e.EngagementEpisode, state: str) -> VisitRow:
    entered = each.entered
    return VisitRow(
        **context_fields(each.context),
        state=state,
        begin=each.begin,
        end=each.begin + each.duration,
        entered_by=entered.outcome if entered is not None else "",
        left_by=each.reason,
        visitor=each.visitor,
        forced=entered is not None and entered.forced,
        why=entered.why if entered is not None else "",
        cut=each.cut,
    )


def settings(timeline: Timeline, counted: Counted) -> list[SettingRow]:
    """What robots had set, by context and time; of one moment as the driver lists them."""
    shown = timeline.state.robots.shown.values()
    places = {(line.driver, name): at for line in shown for at, name in enumerate(line.values)}

    def order(row: SettingRow) -> tuple[int, ...]:
        return row.begin, row.seq, row.end, places.get((row.driver, row.setting), len(places))

    rows = [
        piece
        for each in timeline.of(e.SettingEpisode)
        for piece in _pieces(_setting(each), each, timeline, counted)
    ]
    return sorted(rows, key=order)


def _setting(each: e.SettingEpisode) -> SettingRow:
    return SettingRow(
        seq=each.seq,
        driver=each.driver,
        setting=each.name,
        value=each.value,
        wanted=each.wanted,
        differs=each.differs,
        begin=each.begin,
        end=each.begin,
    )


def restrictions(timeline: Timeline) -> Iterator[RestrictionRow]:
    """Each change of what the wizard could see."""
    lines = [line for _, line in moments(timeline, m.PerceptionChanged)]
    for each in timeline.of(e.RestrictionEpisode):
        lines.append(each.changed)
        if each.lifted is not None and not (each.lifted.hidden or each.lifted.blurred):
            lines.append(each.lifted)
    for line in sorted(lines, key=attrgetter("t", "seq")):
        yield RestrictionRow(line.t, tuple(line.hidden), tuple(line.blurred))


def consoles(timeline: Timeline) -> Iterator[ConsoleRow]:
    """Each console that came or went."""
    for each in timeline.of(e.MomentEpisode):
        match each.message:
            case m.ConsoleAttached(console=console, role=role):
                yield ConsoleRow(each.begin, console, role, lost=False)
            case m.ConsoleLost(console=console, role=role, why=why):
                yield ConsoleRow(each.begin, console, role, lost=True, why=why)


def parts_played(timeline: Timeline) -> dict[str, str]:
    """Console -> which part its wizard played, if it was one in particular."""
    attached = (line for _, line in moments(timeline, m.ConsoleAttached))
    return {line.console: line.part for line in attached if line.role == "wizard"}


# -- what a wizard did by hand: actions, and commands that belong to none ------------------------

#: Sources that are no human at this session.
BY_MACHINE = frozenset({"engagement", "program", "replay"})
WizardAct = e.ActionEpisode | e.CommandEpisode


def of_robot(command: e.CommandEpisode) -> bool:
    """Whether a command went to a robot, not to the session itself or the engagement model."""
    return command.request.driver not in performers()


def is_direct(command: e.CommandEpisode) -> bool:
    """Whether a command went to a robot and belonged to no action."""
    return not command.request.run and of_robot(command)


def acts_of(timeline: Timeline) -> list[WizardAct]:
    """All wizard actions in the order in which they were asked for."""
    return [
        each
        for each in timeline.episodes
        if (type(each) is e.ActionEpisode or (type(each) is e.CommandEpisode and is_direct(each)))
        and each.request.source not in BY_MACHINE
        and is_by_hand(each.request.source, each.request.key)
    ]


def id_of(act: WizardAct) -> str:
    """The id of an action's run, or of a command."""
    return act.request.run if isinstance(act, e.ActionEpisode) else act.request.command
