"""What lasted in a session: an episode is the messages that belong together, and how it ended.

An episode is never changed: while it goes on, each message that adds to it makes a new one. Fields
of messages are not copied: `command.request.verb`, `trial.started.condition`.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from typing import ClassVar, TypeVar

import msgspec

from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.timeline.trial_context import Context

#: Things of one sort that are remembered at the same time: those whose end never comes, and names
#: that a damaged log makes up.
MOST_KEPT = 4000

K = TypeVar("K")
V = TypeVar("V")


def keep_latest(table: dict[K, V], key: K, value: V, most: int = MOST_KEPT) -> None:
    """Put a value in; the oldest one makes way where there are too many."""
    if key not in table and len(table) >= most:
        del table[next(iter(table))]
    table[key] = value


class EpisodeOutcome(enum.StrEnum):
    """How episodes end. Trials and questionnaires end with the word in their message, which need
    not be one of these in the log of another version; features may have words of their own.

    * open: no end is in the log, or so far.
    * done: action, command, trial, phase, break, questionnaire, utterance, re-run; a stop of
      driving that was confirmed, which latches nothing.
    * failed, refused, stopped, superseded: action, command. timed_out: command.
    * left_out: action of which this robot does nothing.
    * aborted, excluded: trial. declined: questionnaire.
    * left: a questionnaire that nobody finished; a state of the engagement model, or the
      engagement, which the model left: `reason` is the outcome of the model's edge.
    * off: the model was switched off, or is not there any more. on: it was off, and is on again.
    * released: stop. recovered: lost driver, faulted lane.
    * changed: profile, restricted perception, a robot's setting, a conflict of settings.
    * lost: utterance, setting or conflict whose driver was lost.
    * moment: it did not last.
    """

    OPEN = "open"
    DONE = "done"
    FAILED = "failed"
    TIMED_OUT = "timed_out"
    REFUSED = "refused"
    STOPPED = "stopped"
    SUPERSEDED = "superseded"
    LEFT_OUT = "left_out"
    ABORTED = "aborted"
    EXCLUDED = "excluded"
    DECLINED = "declined"
    LEFT = "left"
    OFF = "off"
    ON = "on"
    RELEASED = "released"
    RECOVERED = "recovered"
    CHANGED = "changed"
    LOST = "lost"
    MOMENT = "moment"


#: How an action or a command ended, by the message that says so.
OUTCOMES: Mapping[type[m.Message], EpisodeOutcome] = {
    m.ActionDone: EpisodeOutcome.DONE,
    m.ActionFailed: EpisodeOutcome.FAILED,
    m.ActionStopped: EpisodeOutcome.STOPPED,
    m.ActionSuperseded: EpisodeOutcome.SUPERSEDED,
    m.ActionRefused: EpisodeOutcome.REFUSED,
    m.Done: EpisodeOutcome.DONE,
    m.Failed: EpisodeOutcome.FAILED,
    m.TimedOut: EpisodeOutcome.TIMED_OUT,
    m.Refused: EpisodeOutcome.REFUSED,
    m.Stopped: EpisodeOutcome.STOPPED,
    m.Superseded: EpisodeOutcome.SUPERSEDED,
}

#: Outcomes of trials whose data do not count unless somebody wants all of them.
NOT_COUNTED = (EpisodeOutcome.ABORTED, EpisodeOutcome.EXCLUDED)
#: Why else a trial does not count: its number is 0; the log breaks off in it.
PRACTICE, CUT_OFF = "practice", "cut off"
LEFT_OUT = (*NOT_COUNTED, PRACTICE, CUT_OFF)


class Episode(msgspec.Struct, frozen=True, kw_only=True):
    """Something that lasted from `begin` up to `end`, in microseconds on the axis of `t`.

    `end` is None while it goes on. `seq` is that of its first message. `outcome` is one of
    `EpisodeOutcome`. `cut`: it did not end by itself, but the log did, or what followed it shows
    that it was over. `context` is the one in which it began; a `Timeline` fills it in, and has the
    episode's `parts`.
    """

    kind: ClassVar[str] = ""

    begin: int
    seq: int
    end: int | None = None
    outcome: str = EpisodeOutcome.OPEN
    cut: bool = False
    context: Context = Context()

    @property
    def duration(self) -> int:
        """How long it lasted, in microseconds; 0 while it goes on."""
        return 0 if self.end is None else self.end - self.begin

    @property
    def label(self) -> str:
        """What of its kind it is: the action's name, the state, the trial's number."""
        return ""

    @property
    def source(self) -> str:
        """Whose it is: key, script, engagement, wizard ...; empty where nobody is named."""
        return ""

    @property
    def reason(self) -> str:
        """Why it ended as it did, in words."""
        return ""

    @property
    def lines(self) -> Iterable[m.Message]:
        """The messages it consists of."""
        for name in self.__struct_fields__[_OWN:]:
            value = getattr(self, name)
            if isinstance(value, m.Message):
                yield value


#: The fields of `Episode` itself come first.
_OWN = len(Episode.__struct_fields__)


# -- what a wizard does ---------------------------------------------------------------------------


class ActionEpisode(Episode, frozen=True, kw_only=True):
    """An action from its request to its end.

    `commands` are the ids of those that came of it, without passing ones, `dispatched` is the first
    start of a driver among them.
    `waits`: something of it counts only when the robot's mode is over. `mistake`: the first line
    that calls it one.
    """

    kind = "action"
    request: m.ActionRequested
    dispatched: m.Dispatched | None = None
    ended: m.ActionEnd | None = None
    mistake: m.Mistake | None = None
    commands: tuple[str, ...] = ()
    waits: bool = False

    @property
    def label(self) -> str:
        """The action's name."""
        return self.request.action

    @property
    def source(self) -> str:
        """Who asked for it: see `source` in `messages.ActionRequested`."""
        return self.request.source

    @property
    def reason(self) -> str:
        """As its end says."""
        return self.ended.reason if self.ended else ""

    @property
    def evidence(self) -> str:
        """On what it stands that it was done, as its end says; empty: nobody says."""
        return self.ended.evidence if isinstance(self.ended, m.ActionDone) else ""

    @property
    def lines(self) -> Iterable[m.Message]:
        """Without those of its commands."""
        both = (self.request, self.ended, self.mistake)
        return (line for line in both if line is not None)

    @property
    def left_out(self) -> bool:
        """Whether nothing of it was sent, because this robot does nothing of it."""
        return bool(self.request.without) and not self.commands

    @property
    def latency_us(self) -> int | None:
        """From the request to the first start of a driver; None: none started."""
        return self.dispatched.t - self.begin if self.dispatched else None


class CommandEpisode(Episode, frozen=True, kw_only=True):
    """A command from its request to its end. `progress` is what the driver expected last, `planned`
    what a performer that composes says of its plan.
    """

    kind = "command"
    request: m.Command
    dispatched: m.Dispatched | None = None
    progress: m.Progress | None = None
    planned: m.Ack | None = None
    ended: m.End | None = None
    mistake: m.Mistake | None = None

    @property
    def label(self) -> str:
        """The verb."""
        return self.request.verb

    @property
    def source(self) -> str:
        """As its request says."""
        return self.request.source

    @property
    def reason(self) -> str:
        """As its end says."""
        return self.ended.reason if self.ended else ""

    @property
    def evidence(self) -> str:
        """On what it stands that it was done, as its end says; empty: nobody says."""
        return self.ended.evidence if isinstance(self.ended, m.Done) else ""

    @property
    def driver(self) -> str:
        """Who carried it out, as far as anybody says."""
        named = (self.ended, self.progress, self.dispatched, self.request)
        return next((each.driver for each in named if each is not None and each.driver), "")

    @property
    def latency_us(self) -> int | None:
        """From the request to the driver's start; None: it never started."""
        if self.dispatched is not None:
            return self.dispatched.latency_us
        return self.ended.latency_us if isinstance(self.ended, m.Done) else None

    @property
    def started(self) -> int | None:
        """When the driver started, on the axis of `t`; None: it never did."""
        if self.dispatched is not None:
            return self.dispatched.t
        if isinstance(self.ended, m.Done):
            return self.begin + self.ended.latency_us
        return self.progress.t if self.progress else None

    @property
    def duration_us(self) -> int | None:
        """How long it took, as its driver's lane measured it; None unless it was done."""
        return self.ended.duration_us if isinstance(self.ended, m.Done) else None

    @property
    def sent(self) -> Mapping[str, Json]:
        """What really went to the hardware; empty unless it was done."""
        return self.ended.sent if isinstance(self.ended, m.Done) else {}

    @property
    def expected_end(self) -> int | None:
        """When it should be over, on the axis of `t`; None: the driver has not estimated it."""
        return self.progress.t + max(0, self.progress.expected_us) if self.progress else None


class RestrictionEpisode(Episode, frozen=True, kw_only=True):
    """A time in which something was hidden from the wizard or blurred."""

    kind = "perception"
    changed: m.PerceptionChanged
    lifted: m.PerceptionChanged | None = None


# -- the study ------------------------------------------------------------------------------------


class TrialEpisode(Episode, frozen=True, kw_only=True):
    """A trial that was begun, breaks inside it included: those are parts of their own."""

    kind = "trial"
    started: m.TrialStarted
    ended: m.TrialEnded | None = None

    @property
    def label(self) -> str:
        """Its number."""
        return str(self.started.trial)

    @property
    def text(self) -> str:
        """What the wizard remarked at its end."""
        return self.ended.text if self.ended else ""


class StageEpisode(Episode, frozen=True, kw_only=True):
    """A part of the session or of a trial, breaks inside it included, where a feature divides them:
    the experiment's phases do. `by` whom it began; `planned_us`: how long it was to last (0: nobody
    said). `left` is what ended it: the beginning of the next one, or of another trial, or the end
    of a trial.
    """

    kind = "phase"
    name: str
    by: str = ""
    planned_us: int = 0
    began: m.Message
    left: m.Message | None = None

    @property
    def label(self) -> str:
        """Its name."""
        return self.name

    @property
    def source(self) -> str:
        """Key, palette, program, trial or session."""
        return self.by


class BreakEpisode(Episode, frozen=True, kw_only=True):
    """A break: it belongs to no trial, also inside one."""

    kind = "break"
    started: m.BreakStarted
    ended: m.BreakEnded | None = None


class RerunEpisode(Episode, frozen=True, kw_only=True):
    """A time in which the commands of another log were run again."""

    kind = "rerun"
    started: m.RerunStarted
    ended: m.RerunEnded | None = None

    @property
    def label(self) -> str:
        """The other log's name."""
        return self.started.original

    @property
    def reason(self) -> str:
        """Why it was over."""
        return self.ended.reason if self.ended else ""


# -- the visitor ----------------------------------------------------------------------------------


class ModelStateEpisode(Episode, frozen=True, kw_only=True):
    """A stay of the engagement model in one state while it was on.

    `entered` is None where no change led there: the model began with it, or was switched on in it.
    """

    kind = "state"
    state: str
    entered: m.EngagementChanged | None = None
    left: m.EngagementChanged | None = None

    @property
    def label(self) -> str:
        """The state."""
        return self.state

    @property
    def reason(self) -> str:
        """The outcome by which it was left."""
        return self.left.outcome if self.left else ""

    @property
    def visitor(self) -> str:
        """The visitor's code as it began; empty if nobody was recognised."""
        return self.entered.visitor if self.entered else ""


class EngagementEpisode(Episode, frozen=True, kw_only=True):
    """An unbroken engagement: the model was in states in which somebody talks with the robot.

    `named` is the last change during it that knew who that was.
    """

    kind = "engagement"
    entered: m.EngagementChanged | None = None
    named: m.EngagementChanged | None = None
    left: m.EngagementChanged | None = None

    @property
    def reason(self) -> str:
        """The outcome by which the model left it."""
        return self.left.outcome if self.left else ""

    @property
    def visitor(self) -> str:
        """The code of who talked with the robot; empty if nobody was recognised."""
        return self.named.visitor if self.named else ""


class ModelOffEpisode(Episode, frozen=True, kw_only=True):
    """A time in which there was an engagement model, and it was switched off."""

    kind = "model off"
    switched: m.Done | None = None


class UtteranceEpisode(Episode, frozen=True, kw_only=True):
    """Something that the visitor said, where the driver says that it was said.

    Its lines come later than it: the recognised text after its end. `own`: it is the robot's own
    voice, and no visitor spoke; `overlap`: the visitor spoke into the robot's sentence.
    """

    kind = "utterance"
    driver: str
    segment: int
    started: m.SpeechStarted | None = None
    ended: m.SpeechEnded | None = None
    text: m.SpeechText | None = None
    own: bool = False
    overlap: bool = False

    @property
    def label(self) -> str:
        """The number of the segment."""
        return str(self.segment)


# -- the robot ------------------------------------------------------------------------------------


class StopPress(msgspec.Struct, frozen=True):
    """A press of the stop, and what confirmed it."""

    pressed: m.StopPressed
    confirmations: tuple[m.StopConfirmed, ...] = ()


class StopEpisode(Episode, frozen=True, kw_only=True):
    """From the press of the stop to its release. A stop of driving alone latches nothing: it is
    over as soon as it is confirmed.

    A further press before the release is one of `presses` (the first, and the last ones), and a
    moment.
    """

    kind = "stop"
    presses: tuple[StopPress, ...]
    released: m.StopReleased | None = None

    @property
    def label(self) -> str:
        """What it stops: all or drive."""
        return self.presses[0].pressed.scope

    @property
    def source(self) -> str:
        """Who pressed it first."""
        return self.presses[0].pressed.source

    @property
    def settled(self) -> bool:
        """Whether the last press has been confirmed, by whomever."""
        return bool(self.presses[-1].confirmations)

    @property
    def late_us(self) -> int:
        """How long after its key all had confirmed the last press, if longer than promised."""
        return max(
            (each.elapsed_us for each in self.presses[-1].confirmations if each.late), default=0
        )

    @property
    def confirmed(self) -> tuple[str, ...]:
        """Drivers that confirmed the last press and are not missing."""
        missing = set(self.missing)
        return tuple(name for name in self._named("confirmed") if name not in missing)

    @property
    def missing(self) -> tuple[str, ...]:
        """Drivers that did not confirm the last press; who was missing once stays so."""
        return self._named("missing")

    @property
    def unreached(self) -> tuple[str, ...]:
        """Those of them that were not connected: no stop came to them."""
        return self._named("unreached")

    @property
    def parts_confirmed(self) -> dict[str, tuple[str, ...]]:
        """Driver -> those of its parts that confirmed and are not missing."""
        missing = self.parts_missing
        return {
            driver: tuple(part for part in parts if part not in missing.get(driver, ()))
            for driver, parts in self._parts("parts").items()
        }

    @property
    def parts_missing(self) -> dict[str, tuple[str, ...]]:
        """Driver -> those of its parts that did not confirm."""
        return self._parts("missing_parts")

    @property
    def lines(self) -> Iterable[m.Message]:
        """Presses and confirmations in their order, then the release."""
        for press in self.presses:
            yield press.pressed
            yield from press.confirmations
        if self.released is not None:
            yield self.released

    def _named(self, field: str) -> tuple[str, ...]:
        found: dict[str, None] = {}
        for each in self.presses[-1].confirmations:
            found |= dict.fromkeys(getattr(each, field))
        return tuple(found)

    def _parts(self, field: str) -> dict[str, tuple[str, ...]]:
        found: dict[str, dict[str, None]] = {}
        for each in self.presses[-1].confirmations:
            for driver, parts in getattr(each, field).items():
                found.setdefault(driver, {}).update(dict.fromkeys(parts))
        return {driver: tuple(parts) for driver, parts in found.items()}


class LostDriverEpisode(Episode, frozen=True, kw_only=True):
    """A driver was lost, or a part of it did not answer (`lost` says which), until it was ready."""

    kind = "lost driver"
    lost: m.DriverLost | m.DriverFaulted
    found: m.DriverConnected | None = None

    @property
    def label(self) -> str:
        """The driver."""
        return self.lost.driver

    @property
    def reason(self) -> str:
        """What was wrong."""
        return self.lost.detail


class FaultedLaneEpisode(Episode, frozen=True, kw_only=True):
    """A lane took nothing, since a job had outlived its limit."""

    kind = "faulted lane"
    faulted: m.LaneFaulted
    recovered: m.LaneRecovered | None = None

    @property
    def label(self) -> str:
        """Driver and lane."""
        return f"{self.faulted.driver} {self.faulted.lane}"


class SettingEpisode(Episode, frozen=True, kw_only=True):
    """A time in which a robot's setting had one value.

    `differs`: `wanted` was asked for instead. None: nothing is known of it, because the robot is
    lost or does not name it any more.
    """

    kind = "setting"
    driver: str
    name: str
    value: Json = None
    wanted: Json = None
    differs: bool | None = False

    @property
    def label(self) -> str:
        """The setting's name."""
        return self.name


class ConflictEpisode(Episode, frozen=True, kw_only=True):
    """A time in which settings of a robot worked against each other; `sentence` says which."""

    kind = "conflict"
    driver: str
    sentence: str

    @property
    def label(self) -> str:
        """The sentence."""
        return self.sentence


# -- moments --------------------------------------------------------------------------------------


class MomentEpisode(Episode, frozen=True, kw_only=True):
    """A message that stands for itself: a marker, a note, a console that came, an end that has no
    beginning in the log. It has no length.
    """

    kind = "moment"
    message: m.Message

    @property
    def label(self) -> str:
        """The message's kind, as in the log."""
        return str(self.message.__struct_config__.tag)

    @property
    def source(self) -> str:
        """As the message says, if it does."""
        return str(getattr(self.message, "source", ""))
