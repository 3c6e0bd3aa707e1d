"""Plans from a session's log how its robot does the same again.

A command is repeated if it was dispatched then: at the moment at which it began, with the arguments
as they were asked for, and it is cut short at the moment at which it was cut short. `fitted` skips
what the present robot cannot do, before anything moves. Nothing is decided anew: who waited for
whom, and what took whose place, is in the log (see decision 021).
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import msgspec

from woz_tui.analysis.played_actions import SESSION_SOURCES
from woz_tui.config.experiment import Experiment
from woz_tui.config.performers import ENGAGEMENT, SESSION, composers, performers
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import FACE_CONSENT, LEARN_FACE, Verb
from woz_tui.log.log_reader import Damage, files_of, read
from woz_tui.protocol import messages as m
from woz_tui.replay.bookmarks import monotonic
from woz_tui.replay.experiment_origin import ExperimentOrigin, origin_of
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_driver import VERBS
from woz_tui.timeline.episodes import CommandEpisode, MomentEpisode
from woz_tui.timeline.timeline import Timeline

#: Whose commands they are, in the log of the re-run.
REPLAY = "replay"
#: These concern who is in the room, and in a re-run another one stands there.
LEARNING = frozenset({LEARN_FACE, FACE_CONSENT, "listen_room"})
#: What of the session's own verbs has a meaning without a participant and a wizard's panels.
SESSION_VERBS = frozenset({"mark", "note"})
#: Markers that the session itself puts: the preflight's, and those of the verb `mark`.
_OWN_MARKS = frozenset({"preflight", "action", "lsl"})


@dataclass(frozen=True, slots=True)
class RerunStep:
    """One command of the original.

    Attributes:
        command: As it was asked for; its `t` is when.
        at: When it began, on the original's axis, in microseconds; of a command that never began,
            when it was asked for.
        cut: When it was cut short; -1: it was not.
        why_cut: By what.
        end: How it ended, as the end of the message's kind: done, stopped ...; empty: never.
        skip: Why it is not sent again; empty: it is.
        drives: Whether it moves the robot through the room; known once the plan has been fitted.
    """

    command: m.Command
    at: int
    cut: int = -1
    why_cut: str = ""
    end: str = ""
    skip: str = ""
    drives: bool = False


@dataclass(frozen=True)
class RerunPlan:
    """All that is to be done again, in order of `at`.

    Attributes:
        name: What the original's files are called, without their endings.
        origin: Its experiment.
        session: Its session code; empty if the log does not say.
        seed: Its seed.
        sha256: Of all lines of actions of the log.
        steps: The commands.
        marks: The wizard's markers, which are put again.
        stops: How often the stop was pressed.
        ended: Whether the log has an end.
        damage: What of the log could not be read, in words.
    """

    name: str
    origin: ExperimentOrigin
    session: str = ""
    seed: int = 0
    sha256: str = ""
    steps: tuple[RerunStep, ...] = ()
    marks: tuple[m.Marker, ...] = ()
    stops: int = 0
    ended: bool = False
    damage: tuple[str, ...] = ()

    @cached_property
    def sent(self) -> tuple[RerunStep, ...]:
        return tuple(step for step in self.steps if not step.skip)

    @cached_property
    def skipped(self) -> tuple[RerunStep, ...]:
        return tuple(step for step in self.steps if step.skip)

    @cached_property
    def start(self) -> int:
        """The first moment at which anything is done, on the original's axis in microseconds."""
        moments = [step.at for step in self.sent] or [mark.t for mark in self.marks] or [0]
        return min(moments)

    @cached_property
    def duration(self) -> int:
        """From there to the last moment that is known, in microseconds."""
        moments = [moment for step in self.sent for moment in (step.at, step.cut)]
        return max([self.start, *moments]) - self.start

    @cached_property
    def drivers(self) -> tuple[str, ...]:
        """The drivers that it needs, in the order in which it needs them."""
        names = dict.fromkeys(step.command.driver for step in self.sent)
        return tuple(name for name in names if name not in performers())

    @cached_property
    def counts(self) -> dict[tuple[str, str], int]:
        """How many commands are sent, by driver and verb."""
        return dict(Counter((step.command.driver, step.command.verb) for step in self.sent))


def plan_of(path: Path) -> RerunPlan:
    """The plan of the session to which the log file `path` belongs.

    Samples are never read. Raises what `log.log_reader.files_of` raises; nothing damaged raises.
    """
    digest, damage = hashlib.sha256(), Damage()
    times: list[int] = []
    lines: list[tuple[int, m.Message]] = []
    for line in read(path, damage, samples=False):
        digest.update(line.raw + b"\n")
        if line.message is not None:
            lines.append((len(times), line.message))
        times.append(line.t)
    # A flipped bit in a time must neither hold the robot up for hours nor hurry it.
    times = monotonic(times)
    messages = [msgspec.structs.replace(message, t=times[place]) for place, message in lines]
    timeline = Timeline(passing=True)
    for message in messages:
        timeline.apply(message)
    timeline.finish()
    start = timeline.state.start
    presses = [
        press.t for press in messages if isinstance(press, m.StopPressed) and press.scope == "all"
    ]
    commands = timeline.of(CommandEpisode)
    steps = [*_lost(timeline, {command.request.command for command in commands})]
    for command in commands:
        step = _step(command)
        if command.ended is None and not step.skip:
            step = _left_open(step, presses, times[-1] if times else 0)
        steps.append(step)
    return RerunPlan(
        name=files_of(path).stem,
        origin=origin_of(messages),
        session=start.session if start else "",
        seed=start.seed if start else 0,
        sha256=digest.hexdigest(),
        steps=tuple(sorted(steps, key=lambda step: (step.at, step.command.seq))),
        marks=tuple(
            message
            for message in messages
            if isinstance(message, m.Marker) and message.source not in _OWN_MARKS
        ),
        stops=len(presses),
        ended=timeline.state.end is not None,
        damage=tuple(damage.sentences()),
    )


def _left_open(step: RerunStep, presses: Sequence[int], last: int) -> RerunStep:
    """Its end is not in the log: it may not go on for longer than anybody knows that it did.

    A damaged line may be just the one that says that a stop cut it short.
    """
    press = next((press for press in presses if press >= step.at), None)
    if press is None:
        return replace(step, cut=max(last, step.at), why_cut="the log ends")
    why = "the stop was pressed; the end of the command is missing"
    return replace(step, cut=press, why_cut=why)


def _lost(timeline: Timeline, known: Container[str]) -> Iterator[RerunStep]:
    """Commands whose request is damaged or missing, so that nobody knows what they were."""
    lost: dict[str, m.Command] = {}
    for moment in timeline.of(MomentEpisode):
        ack = moment.message
        if isinstance(ack, m.Dispatched | m.End) and ack.command not in known:
            before = lost.get(ack.command)
            lost[ack.command] = m.Command(
                command=ack.command,
                verb="?",
                args={},
                driver=ack.driver if isinstance(ack, m.End) else "",
                source="?",
                t=before.t if before is not None else ack.t,
            )
    for command in lost.values():
        why = "its request is not in the log, so the command is unknown"
        yield RerunStep(command, command.t, skip=why)


def _step(command: CommandEpisode) -> RerunStep:
    request, ended, began = command.request, command.ended, command.started
    if began is not None and ended is not None:  # an estimate of the end may be wrong
        began = min(began, ended.t)
    cut, why = -1, ""
    if isinstance(ended, m.Superseded):
        cut, why = ended.t, f"replaced by {ended.by}"
    elif isinstance(ended, m.Stopped):
        cut, why = ended.t, ended.reason
    kind = str(command.outcome) if ended is not None else ""
    at = command.begin if began is None else max(began, command.begin)
    if isinstance(ended, m.Refused):
        return RerunStep(
            request, at, end=kind, skip=f"refused in the log: {ended.reason or ended.code}"
        )
    if began is None:
        reason = "the log ends before" if ended is None else ended.reason
        if isinstance(ended, m.Superseded):
            reason = "it was replaced"
        return RerunStep(request, at, end=kind, skip=f"it never began: {reason}".removesuffix(": "))
    return RerunStep(request, at, cut, why, kind, skip=_senseless(request))


def _senseless(command: m.Command) -> str:
    """Why a command makes no sense a second time; empty: it does."""
    if command.driver == ENGAGEMENT:
        return "the engagement model does not act in a re-run"
    if command.driver == SESSION and command.verb not in SESSION_VERBS:
        return "it belongs to the recorded session and does not move the robot"
    if command.driver in composers():
        return "what it consists of is repeated command by command"
    if command.verb in LEARNING:
        return "it would concern the person who is there now"
    if command.source not in SESSION_SOURCES:
        return f"{command.source} requests it by itself, also in the re-run"
    return ""


#: Begins every reason that lies in the present robot, and not in what happened then.
UNFIT = "not possible now: "


def fitted(plan: RerunPlan, experiment: Experiment) -> RerunPlan:
    """The plan for this experiment: what its robot does not offer is skipped, with the reason."""
    offered = {
        spec.name: {verb.name: verb for verb in spec.offer.verbs} for spec in experiment.drivers
    }
    offered[SESSION] = {verb.name: verb for verb in VERBS}
    return replace(plan, steps=tuple(_fitted(step, offered) for step in plan.steps))


def redacted_plan(plan: RerunPlan, redactor: Redactor) -> RerunPlan:
    """The plan as the wizard may see it."""
    steps = []
    for step in plan.steps:
        command = redactor.message(step.command)
        if command is step.command or not isinstance(command, m.Command):
            steps.append(step)
            continue
        why = "reason is hidden: it could reveal what this study hides from you"
        steps.append(replace(step, command=command, skip=why if step.skip else ""))
    return replace(plan, steps=tuple(steps))


def unfit_steps(plan: RerunPlan) -> tuple[RerunStep, ...]:
    """What a fitted plan does not send because the present robot cannot do it."""
    return tuple(step for step in plan.steps if step.skip.startswith(UNFIT))


def _fitted(step: RerunStep, offered: dict[str, dict[str, Verb]]) -> RerunStep:
    if step.skip:
        return step
    driver, name = step.command.driver, step.command.verb
    verbs = offered.get(driver)
    if verbs is None:
        there = ", ".join(one for one in offered if one != SESSION) or "none"
        return replace(step, skip=f"{UNFIT}there is no driver {driver!r} (there is {there})")
    verb = verbs.get(name)
    if verb is None:
        return replace(step, skip=f"{UNFIT}{driver} does not offer {name!r}")
    try:
        checked(verb, step.command.args)
    except ArgumentError as error:
        return replace(step, skip=f"{UNFIT}{error}")
    return replace(step, drives=verb.drives)
