"""The study around a session: participant, condition, trials, stages, breaks."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from msgspec.structs import replace

from woz_tui.config.study_words import OVER
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings
from woz_tui.timeline.episodes import (
    BreakEpisode,
    Episode,
    EpisodeOutcome,
    StageEpisode,
    TrialEpisode,
    keep_latest,
)
from woz_tui.timeline.trial_context import Context


@dataclass(slots=True)
class StudyState:
    """How a study stands. Each method takes a message and returns the episodes that ended with it
    or began.

    Times: `t` in microseconds, never earlier than before.

    Attributes:
        settings: `settings.study` of the last `session.plan`, or what the robot process has put
            here: what the experiment file says.
        participant, condition: Codes; empty while nobody has set one.
        context: To whom and what this moment belongs.
        next_trial: The number of the next trial, or of the present one.
        assigned: The order of conditions that was given last, perhaps to somebody else (`order`).
        trial, stage, in_break: What is under way; a stage as a feature says it.
        last_started: Of trials.
        last_ended: How the participant's last trial ended; None: there was none.
        checks: Lines of the preflight list, by what was checked.
        begins_trials: Trials are begun and ended in this session, or an order of conditions was
            given: a number that is set is that of the next trial.
    """

    settings: StudySettings = field(default_factory=StudySettings)
    participant: str = ""
    condition: str = ""
    context: Context = field(default_factory=Context)
    next_trial: int = 1
    assigned: m.ConditionsAssigned | None = None
    trial: TrialEpisode | None = None
    stage: StageEpisode | None = None
    in_break: BreakEpisode | None = None
    last_started: m.TrialStarted | None = None
    last_ended: m.TrialEnded | None = None
    checks: dict[str, m.PreflightChecked] = field(default_factory=dict)
    begins_trials: bool = False
    #: The participant's trials that are over since the order was given, by number: the last end of
    #: each.
    _ended: dict[int, m.TrialEnded] = field(default_factory=dict)
    #: Whether any line has set the context.
    begun: bool = False
    #: A number that was set by hand, where no trials are begun.
    _number: int | None = None
    #: The lines from which participant, condition, the next number and the number by hand come, the
    #: one that set or began a number last, and the last end of a trial.
    _sources: dict[str, m.Message] = field(default_factory=dict)

    def copy(self) -> StudyState:
        """An independent copy."""
        other = copy.copy(self)
        for name in ("checks", "_sources", "_ended"):
            setattr(other, name, dict(getattr(self, name)))
        return other

    # -- figures ----------------------------------------------------------------------------------

    @property
    def order(self) -> Sequence[str]:
        """The conditions of the present participant in their order; empty if none was given."""
        if self.assigned is None or self.assigned.participant != self.participant:
            return ()
        return self.assigned.order

    @property
    def trials(self) -> int:
        """Trials in each condition, for a participant with an order as it was given; 0: not
        specified.
        """
        return self._trials(self.assigned)

    @property
    def planned(self) -> int:
        """Trials of the participant in all; 0: not specified, or no order was given yet."""
        return self._planned(self.assigned)

    @property
    def over(self) -> set[int]:
        """Numbers of the participant's trials that were done or excluded, as far as is known."""
        return {*self._ended, *(self._over_before or ())}

    @property
    def trials_left(self) -> int:
        """Trials of the participant that are planned and not over; 0: not specified."""
        if self._over_before is None:
            return max(0, self.planned - self.next_trial + 1)
        return self.planned - sum(1 <= number <= self.planned for number in self.over)

    @property
    def all_over(self) -> bool:
        """Whether the participant has had all trials that were planned."""
        return self.trial is None and self.next_trial > self.planned > 0

    @property
    def again(self) -> bool:
        """Whether the next trial has run before: it was aborted, or is run once more."""
        last = self.last_ended.trial if self.last_ended is not None else -1
        if self._over_before is None:
            return self.next_trial <= last
        return self.next_trial in {*self.over, last}

    @property
    def _over_before(self) -> list[int] | None:
        """Trials that the participant had had when the order was given; None: nobody said."""
        return self.assigned.over if self.assigned is not None and self.planned else None

    @property
    def _first_open(self) -> int:
        """The first trial that is not over. A line of a log may plan any number of them."""
        over = self.over
        return next(n for n in range(1, self.planned + 2) if n not in over or n > self.planned)

    def condition_of(self, trial: int) -> str:
        """The condition that the order has for this trial; empty if it has none."""
        place = (trial - 1) // self.trials if self.trials and trial > 0 else -1
        return self.order[place] if 0 <= place < len(self.order) else ""

    def label(self, condition: str) -> str:
        """What a blind wizard reads instead of it; `?` if the file no longer names it."""
        blind = self.settings.blind
        return blind.get(condition, "?") if blind else condition

    def ticked(self, check: str) -> bool:
        """Whether this line of the preflight list is in order."""
        return check in self.checks and self.checks[check].level == "ok"

    @property
    def designed(self) -> bool:
        """Whether the file has a design: then the robot process proposes orders and counts
        trials.
        """
        return self.settings.design is not None

    @property
    def between_trials(self) -> bool:
        """Whether the study has trials and none is under way: then no stage can begin."""
        return self.designed and self.trial is None

    @property
    def number(self) -> int | None:
        """The number of the trial that began last, or that was set since; None: none was."""
        line = self._sources.get("trial")
        sets = m.SessionChanged | m.ParticipantWithdrawn | m.TrialStarted
        return line.trial if isinstance(line, sets) else None

    def _planned(self, assigned: m.ConditionsAssigned | None) -> int:
        if assigned is None or assigned.participant != self.participant:
            return 0
        return self._trials(assigned) * max(len(assigned.order), 1)

    def _trials(self, assigned: m.ConditionsAssigned | None) -> int:
        if assigned is not None and assigned.participant == self.participant and assigned.trials:
            return assigned.trials
        design = self.settings.design
        return design.trials if design is not None else 0

    @property
    def lines(self) -> Iterator[m.Message]:
        """The messages from which a copy can be rebuilt; they may repeat, in no order."""
        yield from self._sources.values()
        yield from self.checks.values()
        yield from self._ended.values()
        study = (self.assigned, self.last_started)
        for line in study:
            if line is not None:
                yield line
        for episode in self.open():
            yield from episode.lines

    def open(self) -> Iterator[Episode]:
        """Episodes that have not ended."""
        for episode in (self.trial, self.stage, self.in_break):
            if episode is not None:
                yield episode

    # -- who and where ----------------------------------------------------------------------------

    def start(self, message: m.SessionStart) -> None:
        """The session begins."""
        self._somebody(message.participant, message)
        self._sources["condition"] = message
        self.condition = message.condition
        self._enter()

    def change(self, message: m.SessionChanged | m.ParticipantWithdrawn) -> None:
        """Participant, condition or number were set, or those of lines that were taken out hold."""
        if message.participant is not None:
            self._somebody(message.participant, message)
        if message.condition is not None:
            self.condition = message.condition
            self._sources["condition"] = message
        if message.trial is not None:
            self._sources["trial"] = message
            self._follow(message.trial, message)
            if not self.begins_trials:
                self._number = message.trial
                self._sources["number"] = message
        self._enter()

    def assign(self, message: m.ConditionsAssigned) -> None:
        """A participant got an order of conditions."""
        self._somebody(message.participant, message)
        self.assigned = message
        self._ended.clear()
        if message.over is not None:
            self._follow(self._first_open, message)
        self._begin_trials()
        self._enter()

    def _somebody(self, participant: str, message: m.Message) -> None:
        """Sets the participant; another one begins anew."""
        if "participant" in self._sources and participant == self.participant:
            return
        self.participant = participant
        if "participant" in self._sources:  # so that one who comes back begins anew
            self._sources["before"] = self._sources["participant"]
        self._sources["participant"] = message
        self._follow(1, message)
        self._ended.clear()
        self.last_ended = None

    def _follow(self, number: int, message: m.Message) -> None:
        self.next_trial = number
        self._sources["next"] = message

    def _begin_trials(self) -> None:
        if not self.begins_trials:
            self.begins_trials, self._number = True, None
            self._sources.pop("number", None)

    def _enter(self) -> None:
        """Work out the context anew; the same one stays the same object."""
        self.begun = True
        trial, in_break = self.trial, self.in_break is not None
        number = self._number if trial is None else trial.started.trial
        context = Context(
            participant=self.participant,
            condition=self.condition,
            trial=None if in_break else number,
            run=None if in_break or trial is None else trial.seq,
            in_break=in_break,
            stage="" if in_break or self.stage is None else self.stage.label,
        )
        if context != self.context:
            self.context = context

    # -- trials and breaks ------------------------------------------------------------------------

    def begin_trial(self, message: m.TrialStarted, t: int) -> Iterator[Episode]:
        """A trial begins, whatever was before: of what has no end in the log this is the end."""
        yield from self._cut("in_break", t)
        yield from self._end_stage(message, t)
        yield from self._cut("trial", t)
        self._begin_trials()
        self.trial = TrialEpisode(begin=t, seq=message.seq, started=message)
        self.last_started = self._sources["trial"] = message
        self._follow(message.trial, message)
        if message.condition:
            self.condition = message.condition
            self._sources["condition"] = message
        self._enter()
        yield self.trial

    def end_trial(self, message: m.TrialEnded, t: int) -> Iterator[Episode]:
        """A trial is over, and with it the stage and the break inside it."""
        yield from self._cut("in_break", t)
        yield from self._end_stage(message, t)
        if self.trial is not None:
            yield replace(self.trial, end=t, outcome=message.outcome, ended=message)
        self.trial = None
        self.last_ended = self._sources["ended"] = message
        self._number = None
        self._sources.pop("number", None)
        if message.outcome in OVER:
            keep_latest(self._ended, message.trial, message)
            known = self._over_before is not None
            self._follow(self._first_open if known else message.trial + 1, message)
        self._enter()

    def change_stage(
        self, stage: StageEpisode | None, message: m.Message, t: int
    ) -> Iterator[Episode]:
        """With this message another stage begins; None: there is none any more."""
        yield from self._end_stage(message, t)
        self.stage = stage
        if stage is not None:
            yield stage
        self._enter()

    def _end_stage(self, message: m.Message, t: int) -> Iterator[Episode]:
        if self.stage is not None:
            yield replace(self.stage, end=t, outcome=EpisodeOutcome.DONE, left=message)
        self.stage = None

    def begin_break(self, message: m.BreakStarted, t: int) -> Iterator[Episode]:
        """A break begins: what happens now belongs to no trial."""
        yield from self._cut("in_break", t)
        self.in_break = BreakEpisode(begin=t, seq=message.seq, started=message)
        self._enter()
        yield self.in_break

    def end_break(self, message: m.BreakEnded, t: int) -> Iterator[Episode]:
        """The trial that was interrupted goes on, if one was."""
        if self.in_break is None:
            return
        ended = replace(self.in_break, end=t, outcome=EpisodeOutcome.DONE, ended=message)
        self.in_break = None
        self._enter()
        yield ended

    def _cut(self, name: str, t: int) -> Iterator[Episode]:
        """Ends the episode that this attribute holds without a line in the log."""
        episode = getattr(self, name)
        setattr(self, name, None)
        if episode is not None:
            yield replace(episode, end=t, cut=True)
