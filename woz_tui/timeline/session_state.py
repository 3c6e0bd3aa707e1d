"""The state of a session, kept up to date by its messages: what a screen or a late console must
know.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from typing import Any, TypeVar, cast

import msgspec
from msgspec.structs import replace

from woz_tui.config.performers import ENGAGEMENT, SESSION, composers, performers
from woz_tui.drivers.own_voice import GOES_ON_US, RobotSpeech, is_robots, visitors_words
from woz_tui.feature import pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.protocol.messages import DriverHealth
from woz_tui.timeline.engagement_history import ModelStatus
from woz_tui.timeline.episodes import (
    MOST_KEPT,
    OUTCOMES,
    ActionEpisode,
    CommandEpisode,
    Episode,
    EpisodeOutcome,
    FaultedLaneEpisode,
    LostDriverEpisode,
    MomentEpisode,
    RerunEpisode,
    RestrictionEpisode,
    StopEpisode,
    StopPress,
    UtteranceEpisode,
    keep_latest,
)
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.setting_history import RobotSettings
from woz_tui.timeline.study_history import StudyState
from woz_tui.timeline.trial_context import Context

#: Times beyond this (73,000 years, in microseconds) come from damaged lines only.
LATEST_TIME = 1 << 61
#: How long silence has to last before a microphone says that speech has ended, unless its settings
#: say otherwise, in microseconds.
USUAL_HANG_OVER_US = 1_000_000
#: Utterances that are over and may still get a text; presses of a stop that is not released.
UTTERANCES_KEPT, PRESSES_KEPT = 40, 16
#: The verb of a microphone.
LISTEN_ROOM = "listen_room"

K = TypeVar("K")
E = TypeVar("E", bound=Episode)
H = TypeVar("H", bound=FeatureHistory)

log = logging.getLogger(__name__)

#: What a kind of message does, and the episodes that end or begin with it.
_Case = Callable[["SessionState", Any], Iterable[Episode] | None]


@cache
def _history_kinds() -> tuple[type[FeatureHistory], ...]:
    return tuple(pieces("history", type).values())


def _fresh_histories() -> dict[type[FeatureHistory], FeatureHistory]:
    return {kind: kind() for kind in _history_kinds()}


class DriverState(msgspec.Struct, frozen=True):
    """A driver's health: its last message, the first one like it, the last one of another kind."""

    health: DriverHealth
    since: DriverHealth
    before: DriverHealth | None = None

    @property
    def state(self) -> str:
        """connecting, connected, lost or faulted."""
        return str(self.health.__struct_config__.tag).removeprefix("driver.")


#: Commands by which robots have spoken, that are kept.
MOST_SPOKEN = 32


@dataclass(frozen=True, slots=True)
class SpokenCommand:
    """A command by which a robot has begun to speak, to whom, and the `seq` of that."""

    request: m.Command
    context: Context
    seq: int


@dataclass(slots=True)
class SessionState:
    """The state of a session, kept up to date by its messages in the order of the log.

    `apply` returns the episodes that a message ends or begins, in this order, and keeps only those
    that go on: memory is bounded. It never raises, whatever is missing, doubled or out of order.
    Time never goes back: a message that is late, or whose time is impossible, counts as of
    now.

    Attributes:
        t: Now, in microseconds.
        begin: When the first line was written; None before it.
        start, end: The session's first and last line.
        plan: What consoles were shown last.
        study: Who takes part, conditions, trials.
        model: The engagement model.
        robots: Robots' settings as they were read back.
        actions, commands: Under way, by id; passing ones (a knob) only with `all_commands`.
        stops: Not over, by scope.
        drivers, lost, faulted_lanes: Health by driver (and lane).
        readings, sensors: The last value and the last state of each sensor.
        modes, unable, faces, bodies, controls: The last of each, by driver; of controls all
            positions, what moved last at the end.
        filled: What each action would do if it were played now.
        speaking: Utterances that go on, by driver and segment.
        said: What the robots say, and have said of late.
        spoken: The last commands that robots have begun to speak by.
        restriction: What restricts the wizard's view, if anything does.
        locks: What locked or unlocked panels since they were shown last.
        consoles: Those that are there.
        rerun: The re-run under way.
        histories: What features keep, by its class.
    """

    t: int = 0
    begin: int | None = None
    start: m.SessionStart | None = None
    end: m.SessionEnd | None = None
    plan: m.SessionPlan | None = None
    recorder: m.RecorderState | None = None
    study: StudyState = field(default_factory=StudyState)
    model: ModelStatus = field(default_factory=ModelStatus)
    robots: RobotSettings = field(default_factory=RobotSettings)
    actions: dict[str, ActionEpisode] = field(default_factory=dict)
    commands: dict[str, CommandEpisode] = field(default_factory=dict)
    stops: dict[str, StopEpisode] = field(default_factory=dict)
    drivers: dict[str, DriverState] = field(default_factory=dict)
    lost: dict[str, LostDriverEpisode] = field(default_factory=dict)
    faulted_lanes: dict[tuple[str, str], FaultedLaneEpisode] = field(default_factory=dict)
    readings: dict[str, m.Reading] = field(default_factory=dict)
    sensors: dict[str, m.SensorChanged] = field(default_factory=dict)
    modes: dict[str, m.ModeChanged] = field(default_factory=dict)
    unable: dict[str, m.VerbsUnable] = field(default_factory=dict)
    faces: dict[str, m.FaceShown] = field(default_factory=dict)
    bodies: dict[str, m.BodyChanged] = field(default_factory=dict)
    controls: dict[str, m.ControlsMoved] = field(default_factory=dict)
    addressed: dict[str, m.AddressedChanged] = field(default_factory=dict)
    speaking: dict[tuple[str, int], UtteranceEpisode] = field(default_factory=dict)
    said: RobotSpeech = field(default_factory=RobotSpeech)
    spoken: tuple[SpokenCommand, ...] = ()
    filled: m.ActionsFilled | None = None
    locks: dict[str, m.PanelLocked] = field(default_factory=dict)
    perception: m.PerceptionChanged | None = None
    restriction: RestrictionEpisode | None = None
    consoles: dict[str, m.ConsoleAttached] = field(default_factory=dict)
    rerun: RerunEpisode | None = None
    all_commands: bool = False
    histories: dict[type[FeatureHistory], FeatureHistory] = field(default_factory=_fresh_histories)
    #: Passing commands so far, and those under way.
    passing: int = 0
    _passing: dict[str, None] = field(default_factory=dict)
    _finished: dict[tuple[str, int], UtteranceEpisode] = field(default_factory=dict)

    # -- reading ----------------------------------------------------------------------------------

    @property
    def context(self) -> Context:
        """The participant, condition and trial of this moment."""
        return self.study.context

    @property
    def stop(self) -> StopEpisode | None:
        """The stop, while it is latched."""
        return self.stops.get("all")

    @property
    def apart(self) -> bool:
        """Whether nobody takes part: a re-run, or what a feature says."""
        return self.rerun is not None or any(each.apart for each in self.histories.values())

    def sensor_state(self, sensor: str) -> str:
        """The last state of a sensor; a value after it says that it is not stale any more."""
        changed, reading = self.sensors.get(sensor), self.readings.get(sensor)
        if changed is None:
            return ""
        fresh = reading is not None and reading.seq > changed.seq
        return "" if fresh and changed.state == "stale" else changed.state

    def copy(self) -> SessionState:
        """An independent copy."""
        other = object.__new__(SessionState)
        for name in _FIELDS:
            value = getattr(self, name)
            setattr(other, name, value.copy() if type(value) in _COPIED else value)
        other.histories = {kind: each.copy() for kind, each in self.histories.items()}
        return other

    def become(self, other: SessionState) -> None:
        """Take over what `other` holds, which is given up; whoever keeps this one goes by it."""
        for name in _FIELDS:
            setattr(self, name, getattr(other, name))

    def messages(self, *, plan: bool = True) -> list[m.Message]:
        """The few messages from which a fresh `SessionState` becomes the same, in order of `seq`.

        `plan`: with the last `session.plan`; whoever sends its content otherwise leaves it out.
        They do not carry: when each setting of a robot, and what is only counted, began; which
        commands of an action are over; passing commands; what was spoken before.
        """
        lines = {id(line): line for line in self._lines()}
        if not plan:
            lines.pop(id(self.plan), None)
        return sorted(lines.values(), key=lambda line: line.seq)

    def _lines(self) -> Iterator[m.Message]:
        for part in (self.study, self.model, self.robots):
            yield from part.lines
        for history in self.histories.values():
            yield from history.lines
        for value in self._values():
            match value:
                case m.Message():
                    yield value
                case DriverState():
                    yield from filter(None, (value.before, value.since, value.health))
                case Episode():
                    yield from value.lines

    def _values(self) -> Iterator[object]:
        """The values of its public attributes and tables."""
        for name in _PUBLIC:
            value = getattr(self, name)
            yield from value.values() if type(value) is dict else (value,)

    @property
    def wizards(self) -> dict[str, str]:
        """Consoles that play the robot, each with its part; empty: no part in particular."""
        there = self.consoles.values()
        return {each.console: each.part for each in there if each.role == "wizard"}

    def other_wizards(self, console: str) -> dict[str, str]:
        """`wizards` without this console, where several play; empty: one plays, or nobody."""
        wizards = self.wizards
        several = wizards if len(wizards) > 1 else {}
        return {name: part for name, part in several.items() if name != console}

    def open(self) -> Iterator[Episode]:
        """All episodes that have not ended."""
        for part in (self.study, self.model, self.robots):
            yield from part.open()
        for history in self.histories.values():
            yield from history.open()
        yield from (value for value in self._values() if isinstance(value, Episode))

    # -- messages ---------------------------------------------------------------------------------

    def apply(self, message: m.Message) -> Iterable[Episode]:
        """Apply a message; returns the episodes that it ends (those have an `end`) or begins."""
        case = all_cases().get(type(message))
        if case is None:  # of another version
            return ()
        t = message.t
        if self.t <= t < LATEST_TIME:
            self.t = t
        else:
            message = replace(message, t=self.t)
        if self.begin is None:
            self.begin = self.t
        changes = case(self, message)
        if changes is None or type(changes) is tuple:
            return changes or ()
        return [*changes]  # a case that makes several may be a generator: it does its work here

    def finish(self) -> list[Episode]:
        """The log has ended: open episodes are cut at its last moment."""
        return [replace(each, end=max(each.begin, self.t), cut=True) for each in self.open()]

    def history(self, kind: type[H]) -> H:
        """What a feature keeps of this session."""
        return cast("H", self.histories[kind])

    def put_off(self, run: str) -> tuple[int, int] | None:
        """Since when and until when the beginning of a run is put off; None: it is not."""
        found = (history.put_off(run) for history in self.histories.values())
        return next((each for each in found if each is not None), None)

    def _moment(self, message: m.Message) -> tuple[Episode]:
        return moment(message, self.t)

    def _begin(self, table: dict[K, E], key: K, episode: E) -> tuple[Episode, ...]:
        """Stores a new episode; an older one of the same id, or one too many, has ended without a
        line.
        """
        before = table.pop(key, None)
        if before is None and len(table) >= MOST_KEPT:
            before = table.pop(next(iter(table)))
        table[key] = episode
        if before is None:
            return (episode,)
        return replace(before, end=max(before.begin, self.t), cut=True), episode

    # -- the session ------------------------------------------------------------------------------

    def _start(self, message: m.SessionStart) -> None:
        self.start = self.start or message
        self.study.start(message)

    def _plan(self, message: m.SessionPlan) -> Iterator[Episode]:
        before, self.plan = self.plan, message
        self.study.settings = message.settings.study
        self.locks.clear()  # the panels say it themselves
        had_model = before is not None and bool(before.settings.engagement)
        if had_model and not message.settings.engagement:
            yield from self.model.vanish(self.t, message)
        yield from self._moment(message)

    def _changed(self, message: m.SessionChanged | m.ParticipantWithdrawn) -> Iterable[Episode]:
        self.study.change(message)
        return self._moment(message)

    def _assigned(self, message: m.ConditionsAssigned) -> Iterable[Episode]:
        self.study.assign(message)
        return self._moment(message)

    def _reloaded(self, message: m.ExperimentReloaded) -> Iterable[Episode]:
        self.filled = None
        return self._moment(message)

    # -- actions and commands ---------------------------------------------------------------------

    def _filled(self, message: m.ActionsFilled) -> None:
        self.filled = message.after(self.filled)

    def _requested(self, message: m.ActionRequested) -> Iterable[Episode]:
        action = ActionEpisode(begin=self.t, seq=message.seq, request=message)
        return self._begin(self.actions, message.run, action)

    def _action_ended(self, message: m.ActionEnd) -> Iterable[Episode]:
        action = self.actions.pop(message.run, None)
        if action is None:
            return self._moment(message)
        outcome = OUTCOMES[type(message)]
        if outcome == EpisodeOutcome.DONE and action.left_out:
            outcome = EpisodeOutcome.LEFT_OUT
        return (replace(action, end=self.t, outcome=outcome, ended=message),)

    def _command(self, message: m.Command) -> Iterable[Episode]:
        self.said = self.said.after(message)
        self.passing += message.passing
        if message.passing and not self.all_commands:
            keep_latest(self._passing, message.command, None)
            return ()
        action = self.actions.get(message.run)
        if action is not None and len(action.commands) < MOST_KEPT:
            commands = (*action.commands, message.command)
            self.actions[message.run] = replace(action, commands=commands)
        command = CommandEpisode(begin=self.t, seq=message.seq, request=message)
        return self._begin(self.commands, message.command, command)

    def _dispatched(self, message: m.Dispatched) -> Iterable[Episode]:
        self.said = self.said.after(message)
        command = self.commands.get(message.command)
        if command is None:
            return self.stray(message)
        if command.dispatched is None:
            self.commands[message.command] = replace(command, dispatched=message)
        request = command.request
        if request.verb in SPEAKING_VERBS:
            spoken = SpokenCommand(request, self.context, message.seq)
            self.spoken = (*self.spoken[1 - MOST_SPOKEN :], spoken)
        action = self.actions.get(request.run)
        if action is not None and self._is_first(message.driver or request.driver, action):
            self.actions[request.run] = replace(action, dispatched=message)
        return ()

    def _is_first(self, driver: str, action: ActionEpisode) -> bool:
        """Whether a driver is the first that is called for an action: a robot's rather than that
        that composes, and has a robot called later.
        """
        if action.dispatched is None:
            return driver not in (SESSION, ENGAGEMENT)
        return action.dispatched.driver in composers() and driver not in performers()

    def _progress(self, message: m.Progress) -> Iterable[Episode]:
        command = self.commands.get(message.command)
        if command is None:
            return self.stray(message)
        self.commands[message.command] = replace(command, progress=message)
        return ()

    def planned(self, message: m.Ack) -> Iterable[Episode]:
        """A command is planned, as its performer says."""
        command = self.commands.get(message.command)
        if command is None:
            return self.stray(message)
        self.commands[message.command] = replace(command, planned=message)
        return ()

    def _command_ended(self, message: m.End) -> Iterable[Episode]:
        self.said = self.said.after(message)
        command = self.commands.pop(message.command, None)
        if command is None:
            ended = self.stray(message)
        else:
            outcome = OUTCOMES[type(message)]
            ended = (replace(command, end=self.t, outcome=outcome, ended=message),)
        self._passing.pop(message.command, None)
        if not isinstance(message, m.Done):
            return ended
        action = self.actions.get(command.request.run) if command is not None else None
        if action is not None and message.sent.get("waits"):
            self.actions[action.request.run] = replace(action, waits=True)
        return (*ended, *self.model.switch(message, self.t))

    def stray(self, message: m.Ack) -> tuple[Episode, ...]:
        """Handles an ack of a passing command, or of one whose request is not in the log."""
        return () if message.command in self._passing else self._moment(message)

    def _mistake(self, message: m.Mistake) -> Iterable[Episode]:
        action, command = self.actions.get(message.run), self.commands.get(message.run)
        if action is not None and action.mistake is None:
            self.actions[message.run] = replace(action, mistake=message)
        elif command is not None and command.mistake is None:
            self.commands[message.run] = replace(command, mistake=message)
        return self._moment(message)

    # -- the stop ---------------------------------------------------------------------------------

    def _pressed(self, message: m.StopPressed) -> Iterable[Episode]:
        press, stop = StopPress(message), self.stops.get(message.scope)
        if stop is None:
            begun = StopEpisode(begin=self.t, seq=message.seq, presses=(press,))
            return self._begin(self.stops, message.scope, begun)
        first, *later = stop.presses
        presses = (first, *later[-(PRESSES_KEPT - 2) :], press)
        self.stops[message.scope] = replace(stop, presses=presses)
        return self._moment(message)

    def _confirmed(self, message: m.StopConfirmed) -> Iterable[Episode]:
        """A confirmation belongs to the earliest press of its scope that has none; in older logs,
        which do not have its scope, to the earliest of all.
        """
        waiting = [
            (press.pressed.seq, scope, at)
            for scope, stop in self.stops.items()
            for at, press in enumerate(stop.presses)
            if not press.confirmations and message.scope in ("", scope)
        ]
        stop = self.stop if message.scope != "drive" else None
        if waiting:
            _, scope, at = min(waiting)
            stop = self.stops[scope]
        elif stop is not None:
            scope, at = "all", len(stop.presses) - 1
        if stop is None:
            return self._moment(message)
        press = stop.presses[at]
        press = replace(press, confirmations=(*press.confirmations[-PRESSES_KEPT:], message))
        presses = (*stop.presses[:at], press, *stop.presses[at + 1 :])
        stop = self.stops[scope] = replace(stop, presses=presses)
        if scope == "all" or not all(press.confirmations for press in presses):
            return ()
        del self.stops[scope]
        return (replace(stop, end=self.t, outcome=EpisodeOutcome.DONE),)

    def _released(self, message: m.StopReleased) -> Iterable[Episode]:
        ended = [
            replace(stop, end=self.t, outcome=EpisodeOutcome.RELEASED, released=message)
            for stop in self.stops.values()
        ]
        self.stops.clear()
        return ended or self._moment(message)

    # -- drivers ----------------------------------------------------------------------------------

    def _driver(self, message: DriverHealth) -> Iterator[Episode]:
        name = message.driver
        last = self.drivers.get(name)
        if last is not None and type(last.health) is type(message):
            driver = replace(last, health=message)
        else:
            driver = DriverState(message, message, last.health if last else None)
        keep_latest(self.drivers, name, driver)
        if isinstance(message, m.DriverLost | m.DriverFaulted):
            if name not in self.lost:
                lost = LostDriverEpisode(begin=self.t, seq=message.seq, lost=message)
                yield from self._begin(self.lost, name, lost)
            else:
                yield from self._moment(message)
            yield from self.robots.lose(message, self.t)
            if isinstance(message, m.DriverLost):  # nobody hears where the speech ends
                yield from self._cut_speech(name, EpisodeOutcome.LOST)
            return
        ended = self.lost.pop(name, None) if isinstance(message, m.DriverConnected) else None
        if ended is None:
            yield from self._moment(message)
        else:
            yield replace(ended, end=self.t, outcome=EpisodeOutcome.RECOVERED, found=message)
        if isinstance(message, m.DriverConnected):
            yield from self.robots.find(message, self.t)

    def _lane_faulted(self, message: m.LaneFaulted) -> Iterable[Episode]:
        faulted = FaultedLaneEpisode(begin=self.t, seq=message.seq, faulted=message)
        return self._begin(self.faulted_lanes, (message.driver, message.lane), faulted)

    def _lane_recovered(self, message: m.LaneRecovered) -> Iterable[Episode]:
        faulted = self.faulted_lanes.pop((message.driver, message.lane), None)
        if faulted is None:
            return self._moment(message)
        return (replace(faulted, end=self.t, outcome=EpisodeOutcome.RECOVERED, recovered=message),)

    def _controls(self, message: m.ControlsMoved) -> None:
        before = self.controls.get(message.driver)
        if before is not None:
            resting = {name: at for name, at in before.values.items() if name not in message.values}
            message = replace(message, values={**resting, **message.values})
        keep_latest(self.controls, message.driver, message)

    # -- the visitor ------------------------------------------------------------------------------

    def _engagement(self, message: m.EngagementChanged) -> Iterable[Episode]:
        off = self.model.off is not None
        changes = self.model.change(message, self.t, self.begin or 0)
        return (*changes, *self._moment(message)) if off else changes

    def _speech_started(self, message: m.SpeechStarted) -> Iterator[Episode]:
        key = (message.driver, message.segment)
        began = self._past(message.began)
        driver, segment = key
        own = self.said.heard_at(self.t) if self._is_unjudged(message) else bool(message.own)
        spoken = UtteranceEpisode(
            begin=began,
            seq=message.seq,
            driver=driver,
            segment=segment,
            started=message,
            own=own,
            overlap=message.overlap,
        )
        yield from self._cut_speech(driver, EpisodeOutcome.OPEN)
        self._finished.pop(key, None)
        yield from self._begin(self.speaking, key, spoken)

    def _speech_ended(self, message: m.SpeechEnded) -> Iterator[Episode]:
        """Ends an utterance; of one that was cut this is the true end: it is returned once more."""
        key = (message.driver, message.segment)
        earlier = self._finished.pop(key, None)
        spoken = self.speaking.pop(key, None) or earlier
        if spoken is None or spoken.ended is not None:  # numbers may begin anew
            spoken = self._lone_utterance(message)
        end = self._past(message.ended)
        begin = min(self._past(message.began), end)
        if self._is_unjudged(message):
            silent = self.said.silent_since(end) if spoken.own else None
            if silent is not None and end - silent > GOES_ON_US + USUAL_HANG_OVER_US:
                spoken = replace(spoken, own=False, overlap=True)
                begin = max(begin, min(silent, end))
        elif message.own is not None:
            spoken = replace(spoken, own=message.own, overlap=message.overlap)
        spoken = replace(
            spoken, begin=begin, end=end, outcome=EpisodeOutcome.DONE, cut=False, ended=message
        )
        yield self._keep_finished(spoken)

    def _speech_text(self, message: m.SpeechText) -> Iterator[Episode]:
        """The text usually comes after the utterance's end, which is then returned once more."""
        key = (message.driver, message.segment)
        if key in self.speaking:
            self.speaking[key] = replace(self.speaking[key], text=message)
            return
        spoken = self._finished.pop(key, None) or self._lone_utterance(message)
        yield self._keep_finished(self._understood(replace(spoken, text=message), message))

    def _understood(self, spoken: UtteranceEpisode, message: m.SpeechText) -> UtteranceEpisode:
        """Words that are not the robot's make its own voice a visitor's."""
        if not spoken.own:
            return spoken
        said = self.said.said_within(spoken.begin, spoken.end or self.t)
        if message.own or (message.own is None and is_robots(message.text, said)):
            return spoken
        spoken = replace(spoken, own=False, overlap=True)
        words = visitors_words(message.words, said)
        if not words:
            return spoken
        end = self._past(words[-1].ended)
        return replace(spoken, begin=min(self._past(words[0].began), end), end=end)

    def _is_unjudged(self, message: m.SpeechStarted | m.SpeechEnded) -> bool:
        """Whether a microphone heard it that could not tell the robot's voice from a visitor's: it
        is known by its only verb. Robots that tell by themselves when somebody speaks hear nothing
        while they speak.
        """
        verbs = self.plan.verbs.get(message.driver) if self.plan is not None else None
        return message.own is None and verbs == [LISTEN_ROOM]

    def _lone_utterance(self, message: m.SpeechEnded | m.SpeechText) -> UtteranceEpisode:
        """An utterance of which the log has only this line."""
        return UtteranceEpisode(
            begin=self.t,
            end=self.t,
            outcome=EpisodeOutcome.DONE,
            seq=message.seq,
            driver=message.driver,
            segment=message.segment,
        )

    def _keep_finished(self, spoken: UtteranceEpisode) -> UtteranceEpisode:
        keep_latest(self._finished, (spoken.driver, spoken.segment), spoken, UTTERANCES_KEPT)
        return spoken

    def _cut_speech(self, driver: str, outcome: str) -> Iterator[Episode]:
        for key in [key for key in self.speaking if key[0] == driver]:
            spoken = self.speaking.pop(key)
            end = max(spoken.begin, self.t)
            yield self._keep_finished(replace(spoken, end=end, outcome=outcome, cut=True))

    def _past(self, t: int) -> int:
        """A time in the past that a message names: not before the log began, and not after now."""
        return min(max(t, self.begin or 0), self.t)

    # -- what restricts the wizard ----------------------------------------------------------------

    def _succeed(
        self, name: str, following: Episode | None, message: m.Message, **end: Any
    ) -> Iterator[Episode]:
        """Of an attribute that holds one episode, another one begins, or none; neither ending nor
        beginning one, the message is a moment.
        """
        before = getattr(self, name)
        setattr(self, name, following)
        return succeed(before, following, message, self.t, **end)

    def _perception(self, message: m.PerceptionChanged) -> Iterator[Episode]:
        self.perception = message
        restricted = bool(message.hidden or message.blurred)
        restriction = RestrictionEpisode(begin=self.t, seq=message.seq, changed=message)
        end = {"outcome": EpisodeOutcome.CHANGED, "lifted": message}
        return self._succeed("restriction", restriction if restricted else None, message, **end)

    def _detached(self, message: m.ConsoleLost) -> Iterable[Episode]:
        self.consoles.pop(message.console, None)
        return self._moment(message)

    # -- the study --------------------------------------------------------------------------------

    def _trial_ended(self, message: m.TrialEnded) -> Iterable[Episode]:
        stray = self.study.trial is None
        ended = self.study.end_trial(message, self.t)
        return (*ended, *self._moment(message)) if stray else ended

    def _break_ended(self, message: m.BreakEnded) -> Iterable[Episode]:
        if self.study.in_break is None:
            return self._moment(message)
        return self.study.end_break(message, self.t)

    def _checked(self, message: m.PreflightChecked) -> Iterable[Episode]:
        keep_latest(self.study.checks, message.check, message)
        return self._moment(message)

    # -- re-run -----------------------------------------------------------------------------------

    def _rerun_started(self, message: m.RerunStarted) -> Iterator[Episode]:
        rerun = RerunEpisode(begin=self.t, seq=message.seq, started=message)
        return self._succeed("rerun", rerun, message, cut=True)

    def _rerun_ended(self, message: m.RerunEnded) -> Iterator[Episode]:
        return self._succeed("rerun", None, message, outcome=EpisodeOutcome.DONE, ended=message)


def moment(message: m.Message, t: int) -> tuple[Episode]:
    """A message at `t` that is an episode by itself."""
    outcome = EpisodeOutcome.MOMENT
    return (MomentEpisode(begin=t, end=t, seq=message.seq, outcome=outcome, message=message),)


def succeed(
    before: Episode | None, following: Episode | None, message: m.Message, t: int, **end: Any
) -> Iterator[Episode]:
    """At `t` one episode ends, if there is one, and another begins, if there is one; of neither the
    message is a moment.
    """
    if before is not None:
        yield replace(before, end=t, **end)
    if following is not None:
        yield following
    elif before is None:
        yield from moment(message, t)


def _last(name: str) -> _Case:
    """The last message of its kind is kept as this attribute."""

    def case(state: SessionState, message: m.Message) -> None:
        setattr(state, name, message)

    return case


def _last_of(name: str, key: str) -> _Case:
    """The last message for each value of its field `key` is kept in this table."""

    def case(state: SessionState, message: m.Message) -> None:
        keep_latest(getattr(state, name), getattr(message, key), message)

    return case


def _as_moment(case: _Case) -> _Case:
    """As `case`, and the message is a moment."""

    def both(state: SessionState, message: m.Message) -> Iterable[Episode]:
        case(state, message)
        return state._moment(message)

    return both


def _pass_over(state: SessionState, message: m.Message) -> None:
    """Ignores a message about the log, not about the session."""


_FIELDS = tuple(each.name for each in fields(SessionState))
_PUBLIC = tuple(name for name in _FIELDS if not name.startswith("_"))
#: What changes in place.
_COPIED = frozenset({dict, StudyState, ModelStatus, RobotSettings})

S = SessionState
#: What each kind of message does; a test says which kind is missing.
CASES: dict[type[m.Message], _Case] = {
    m.SessionStart: S._start,
    m.SessionChanged: S._changed,
    m.ParticipantWithdrawn: S._changed,
    m.SessionEnd: _last("end"),
    m.SessionPlan: S._plan,
    m.RecorderState: _last("recorder"),
    m.ActionRequested: S._requested,
    m.Command: S._command,
    m.Dispatched: S._dispatched,
    m.Progress: S._progress,
    m.Mistake: S._mistake,
    m.StopPressed: S._pressed,
    m.StopConfirmed: S._confirmed,
    m.StopReleased: S._released,
    m.LaneFaulted: S._lane_faulted,
    m.LaneRecovered: S._lane_recovered,
    m.Reading: _last_of("readings", "sensor"),
    m.SensorChanged: _as_moment(_last_of("sensors", "sensor")),
    m.EngagementAdopted: lambda state, message: state.model.adopt(message, state.t),
    m.EngagementChanged: S._engagement,
    m.EngagementShown: lambda state, message: setattr(state.model, "shown", message),
    m.SpeechStarted: S._speech_started,
    m.SpeechEnded: S._speech_ended,
    m.SpeechText: S._speech_text,
    m.ModeChanged: _as_moment(_last_of("modes", "driver")),
    m.VerbsUnable: _as_moment(_last_of("unable", "driver")),
    m.FaceShown: _last_of("faces", "driver"),
    m.BodyChanged: _last_of("bodies", "driver"),
    m.ControlsMoved: S._controls,
    m.AddressedChanged: _as_moment(_last_of("addressed", "driver")),
    m.SettingsShown: lambda state, message: state.robots.show(message, state.t),
    m.PanelLocked: _as_moment(_last_of("locks", "panel")),
    m.ConsoleAttached: _as_moment(_last_of("consoles", "console")),
    m.ConsoleLost: S._detached,
    m.ConditionsAssigned: S._assigned,
    m.TrialStarted: lambda state, message: state.study.begin_trial(message, state.t),
    m.TrialEnded: S._trial_ended,
    m.BreakStarted: lambda state, message: state.study.begin_break(message, state.t),
    m.BreakEnded: S._break_ended,
    m.PreflightChecked: S._checked,
    m.PerceptionChanged: S._perception,
    m.RerunStarted: S._rerun_started,
    m.RerunEnded: S._rerun_ended,
    **dict.fromkeys(
        (m.ActionDone, m.ActionFailed, m.ActionStopped, m.ActionSuperseded, m.ActionRefused),
        S._action_ended,
    ),
    **dict.fromkeys(
        (m.Done, m.Failed, m.TimedOut, m.Refused, m.Stopped, m.Superseded), S._command_ended
    ),
    **dict.fromkeys(
        (m.DriverConnecting, m.DriverConnected, m.DriverLost, m.DriverFaulted), S._driver
    ),
    **dict.fromkeys((m.MotionArrived, m.MotionInterrupted, m.CommandMark), S.stray),
    # Moments, and nothing but moments.
    **dict.fromkeys((m.Marker, m.Note, m.Notice, m.VisitorChanged), S._moment),
    **dict.fromkeys((m.ActionScheduled, m.RerunSent, m.RerunSkipped), S._moment),
    **dict.fromkeys((m.ListenerJoined, m.ListenerLeft, m.RecordWaived), S._moment),
    m.ProcessStalled: S._moment,
    m.ExperimentReloaded: S._reloaded,
    m.ActionsFilled: S._filled,
    **dict.fromkeys((m.ClockTie, m.Checkpoint, m.Segment, m.ExperimentFiles), _pass_over),
}


@cache
def all_cases() -> Mapping[type[m.Message], _Case]:
    """What each kind of message does, those of features included."""
    cases = dict(CASES)
    for history in _history_kinds():
        for kind, case in history.cases.items():
            cases[kind] = _FeatureCase(history, case, cases.get(kind))
    return cases


@dataclass(frozen=True, slots=True)
class _FeatureCase:
    """What a kind of message does to a feature's history, after what it does otherwise."""

    history: type[FeatureHistory]
    case: HistoryCase
    first: _Case | None

    def __call__(self, state: SessionState, message: m.Message) -> Iterable[Episode]:
        changes = [] if self.first is None else [*(self.first(state, message) or ())]
        history = state.histories.get(self.history)
        if history is None:  # it has failed
            return changes if self.first is not None else moment(message, state.t)
        try:
            return [*changes, *(self.case(history, message, state) or ())]
        except Exception:
            log.exception("%s failed at %s", self.history.__name__, type(message).__name__)
            del state.histories[self.history]
            return changes if self.first is not None else moment(message, state.t)
