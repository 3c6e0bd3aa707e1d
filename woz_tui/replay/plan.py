"""What a session's log says that its robot did, as a plan for doing it again.

A command is repeated if it was dispatched then: at the moment at which it began, with the arguments
as they were asked for, and it is cut short at the moment at which it was cut short. Nothing is
decided anew: who waited for whom, and what took whose place, is in the log (see decision 021).
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import msgspec

from woz_tui.analysis.played import ASKED
from woz_tui.core import messages as m
from woz_tui.core.messages import SCHEMA
from woz_tui.core.settings import StudySettings
from woz_tui.experiment.verbs import ENGAGEMENT, SESSION
from woz_tui.record.log import Damage, files_of, read
from woz_tui.replay.marks import steady
from woz_tui.replay.origin import Origin
from woz_tui.replay.studied import last_blind
from woz_tui.session.redactor import marked

#: Whose commands they are, in the log of the re-run.
REPLAY = "replay"
#: These take something in from the room, and in a re-run another one stands there.
LEARNING = frozenset({"learn_face", "listen_room"})
#: What of the session's own verbs has a meaning without a participant and a wizard's panels.
SESSION_VERBS = frozenset({"mark", "note"})
#: Lines of a log that a plan is made of.
_TELLING = (
    m.SessionStart
    | m.SessionEnd
    | m.ExperimentReloaded
    | m.ExperimentFiles
    | m.Command
    | m.Dispatched
    | m.End
    | m.Marker
    | m.StopPressed
    | m.SessionPlan
)
#: Markers that the session itself puts: the preflight's, and those of the verb `mark`.
_OWN_MARKS = frozenset({"preflight", "action"})


@dataclass(frozen=True, slots=True)
class Step:
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
class Plan:
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
    origin: Origin
    session: str = ""
    seed: int = 0
    sha256: str = ""
    steps: tuple[Step, ...] = ()
    marks: tuple[m.Marker, ...] = ()
    stops: int = 0
    ended: bool = False
    damage: tuple[str, ...] = ()

    @cached_property
    def sent(self) -> tuple[Step, ...]:
        """What is sent again."""
        return tuple(step for step in self.steps if not step.skip)

    @cached_property
    def skipped(self) -> tuple[Step, ...]:
        """What is not."""
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
        return tuple(name for name in names if name not in (SESSION, ENGAGEMENT))

    @cached_property
    def counts(self) -> dict[tuple[str, str], int]:
        """How many commands are sent, by driver and verb."""
        return dict(Counter((step.command.driver, step.command.verb) for step in self.sent))


@dataclass(slots=True)
class _Life:
    """What is known of one command while the log is read."""

    command: m.Command | None = None
    began: int = -1
    end: m.End | None = None


@dataclass(slots=True)
class _Reader:
    start: m.SessionStart | None = None
    hashes: list[str] = field(default_factory=list)
    files: m.ExperimentFiles | None = None
    study: StudySettings | None = None
    lives: dict[str, _Life] = field(default_factory=dict)
    marks: list[m.Marker] = field(default_factory=list)
    stops: list[int] = field(default_factory=list)
    ended: bool = False
    last: int = 0

    def take(self, message: m.AnyMessage) -> None:
        match message:
            case m.Command():
                self._life(message.command).command = message
            case m.Dispatched():
                self._life(message.command).began = message.t
            case m.End():
                self._life(message.command).end = message
            case m.Marker() if message.source not in _OWN_MARKS:
                self.marks.append(message)
            case m.StopPressed(scope="all"):
                self.stops.append(message.t)
            case m.SessionEnd():
                self.ended = True
            case _:
                self._identify(message)

    def _identify(self, message: m.AnyMessage) -> None:
        match message:
            case m.SessionStart() if self.start is None:
                self.start = message
                self.hashes.insert(0, message.experiment_sha256)
            case m.ExperimentReloaded():
                self.hashes.append(message.experiment_sha256)
            case m.ExperimentFiles():
                self.files = message
            case m.SessionPlan():
                self.study = last_blind(self.study, message)

    def _life(self, command: str) -> _Life:
        return self.lives.setdefault(command, _Life())


def plan_of(path: Path) -> Plan:
    """The plan of the session to which the log file `path` belongs.

    Samples are never read. Raises what `record.log.files_of` raises; nothing damaged raises.
    """
    reader, digest, damage = _Reader(), hashlib.sha256(), Damage()
    times: list[int] = []
    schema = SCHEMA
    told: list[tuple[int, m.AnyMessage]] = []
    for line in read(path, damage, samples=False):
        digest.update(line.raw + b"\n")
        message = line.message
        if isinstance(message, _TELLING):
            if isinstance(message, m.SessionStart):
                schema = message.schema
            told.append((len(times), marked(message, schema)))
        times.append(line.t)
    # A flipped bit in a time must neither hold the robot up for hours nor hurry it.
    times = steady(times)
    for place, message in told:
        reader.take(msgspec.structs.replace(message, t=times[place]))
    reader.last = times[-1] if times else 0
    start = reader.start
    return Plan(
        name=files_of(path).stem,
        origin=Origin(
            start.experiment if start else "", tuple(reader.hashes), reader.files, reader.study
        ),
        session=start.session if start else "",
        seed=start.seed if start else 0,
        sha256=digest.hexdigest(),
        steps=tuple(sorted(_steps(reader), key=lambda step: (step.at, step.command.seq))),
        marks=tuple(reader.marks),
        stops=len(reader.stops),
        ended=reader.ended,
        damage=tuple(damage.sentences()),
    )


def _steps(reader: _Reader) -> Iterator[Step]:
    for name, life in reader.lives.items():
        if life.command is None:
            yield _lost(name, life)
            continue
        step = _step(life.command, life)
        yield step if life.end is not None or step.skip else _left_open(step, reader)


def _left_open(step: Step, reader: _Reader) -> Step:
    """Its end is not in the log: it may not go on for longer than anybody knows that it did.

    A damaged line may be just the one that says that a stop cut it short.
    """
    for stop in reader.stops:
        if stop >= step.at:
            return replace(step, cut=stop, why_cut="the stop was pressed; its own end is lost")
    return replace(step, cut=max(reader.last, step.at), why_cut="the log ends")


def _lost(name: str, life: _Life) -> Step:
    """Its request is damaged or missing, so nobody knows what it was."""
    driver = life.end.driver if life.end is not None else ""
    at = life.began if life.began >= 0 else life.end.t if life.end is not None else 0
    command = m.Command(command=name, verb="?", args={}, driver=driver, source="?", t=at)
    return Step(command, at, skip="its request is not in the log: what it was is not known")


def _step(command: m.Command, life: _Life) -> Step:
    end = life.end
    began = life.began
    if began < 0 and isinstance(end, m.Done):  # the line that said so is damaged
        began = min(command.t + max(0, end.latency_us), end.t)
    cut, why = (end.t, _why_cut(end)) if isinstance(end, m.Stopped | m.Superseded) else (-1, "")
    kind = "" if end is None else str(end.__struct_config__.tag).removeprefix("command.")
    step = Step(command, max(began, command.t), cut, why, kind)
    if isinstance(end, m.Refused):
        return replace(step, skip=f"refused then: {end.reason or end.code}", cut=-1)
    if began < 0:
        return replace(step, skip=_never(end), cut=-1)
    return replace(step, skip=_senseless(command))


def _why_cut(end: m.Stopped | m.Superseded) -> str:
    return f"{end.by} took its place" if isinstance(end, m.Superseded) else end.reason


def _never(end: m.End | None) -> str:
    match end:
        case None:
            return "it never began: the log ends before"
        case m.Superseded():
            return "it never began: another one took its place"
        case m.Stopped(reason=reason):
            return f"it never began: {reason}"
        case _:
            return f"it never began: {end.reason}" if end.reason else "it never began"


def _senseless(command: m.Command) -> str:
    """Why a command makes no sense a second time; empty: it does."""
    if command.driver == ENGAGEMENT:
        return "the engagement model does not act in a re-run"
    if command.driver == SESSION and command.verb not in SESSION_VERBS:
        return "it belongs to the session of then, and moves nothing"
    if command.verb in LEARNING:
        return "it would learn from whoever is there now"
    if command.source not in ASKED:
        return f"{command.source} asks for it by itself, and will again"
    return ""
