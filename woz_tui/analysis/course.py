"""Where in a session a message stands: when, who, which condition, which trial."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from woz_tui.analysis.figures import NOT_COUNTED, Span, Trial
from woz_tui.analysis.series import LONGEST
from woz_tui.analysis.tally import Tally
from woz_tui.core import messages as m

Handlers = dict[type[m.Message], Callable[..., None]]


@dataclass(slots=True)
class _Running:
    """A trial that was begun."""

    trial: int
    participant: str
    condition: str
    begin: int
    end: int | None = None
    outcome: str = ""
    text: str = ""


@dataclass(slots=True)
class Course:
    """Time, which never goes back, and the tally in which everything of this moment counts.

    `leaving` are told before another tally takes over, so that they can settle their accounts.
    """

    t: int = 0
    #: When the log's first line was written.
    begin: int = 0
    participant: str = ""
    condition: str = ""
    trial: int = -1
    tally: Tally = field(default_factory=lambda: Tally("", ""))
    leaving: list[Callable[[], None]] = field(default_factory=list)
    breaks: list[Span] = field(default_factory=list)
    _tallies: dict[tuple[str, str, int], Tally] = field(default_factory=dict)
    _runs: list[_Running] = field(default_factory=list)
    _run: int = -1
    #: The trial that goes on after the break.
    _interrupted: int = -1
    #: Trials are begun and ended in this session: a number that is set is that of the next one.
    _planned: bool = False
    _since: int = 0
    _told: bool = False
    _began: bool = False

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.SessionStart: self._start,
            m.SessionChanged: self._changed,
            m.ConditionsAssigned: self._assigned,
            m.TrialStarted: self._trial_started,
            m.TrialEnded: self._trial_ended,
            m.BreakStarted: self._break_started,
            m.BreakEnded: self._break_ended,
        }

    def at(self, t: int) -> None:
        """It is `t` now; a time that lies back, or that no clock can say, does not count."""
        if self.t < t < LONGEST:
            self.t = t
        if not self._told:  # what the log has lost before it is no time of this session
            self._told = True
            self.begin = self._since = self.t

    def settle(self) -> None:
        """Count the time up to now."""
        for leave in self.leaving:
            leave()
        self.tally.us += self.t - self._since
        self._since = self.t

    def finish(self) -> None:
        """The log is over."""
        self.settle()
        if self.breaks and self.breaks[-1].end is None:
            self._end_break("")

    @property
    def tallies(self) -> list[Tally]:
        """All in the order in which they came; those in which nothing was are left out."""
        found = [
            tally
            for tally in self._tallies.values()
            if tally != Tally(tally.participant, tally.condition, tally.run)
        ]
        return found or [self.tally]

    def counts(self, tally: Tally) -> bool:
        """Whether what stands in it is to be analysed, as far as the trials' outcomes say."""
        return tally.run < 0 or self._runs[tally.run].outcome not in NOT_COUNTED

    def trials(self) -> list[Trial]:
        """All trials, also those that do not count."""
        return [
            Trial(
                trial=run.trial,
                participant=run.participant,
                condition=run.condition,
                begin=run.begin,
                end=run.end,
                outcome=run.outcome,
                text=run.text,
                actions=sum(
                    tally.counts.total() for tally in self._tallies.values() if tally.run == number
                ),
            )
            for number, run in enumerate(self._runs)
        ]

    # -- messages ------------------------------------------------------------------------------

    def _start(self, message: m.SessionStart) -> None:
        self.participant, self.condition = message.participant, message.condition
        self._enter()

    def _changed(self, message: m.SessionChanged) -> None:
        if message.participant is not None:
            self.participant = message.participant
        if message.condition is not None:
            self.condition = message.condition
        if message.trial is not None and not self._planned:
            self.trial = message.trial
        self._enter()

    def _assigned(self, message: m.ConditionsAssigned) -> None:
        self._plan()

    def _plan(self) -> None:
        if not self._planned:
            self._planned, self.trial = True, -1

    def _trial_started(self, message: m.TrialStarted) -> None:
        self._plan()
        self.trial, self._interrupted = message.trial, -1
        self.condition = message.condition or self.condition
        self._runs.append(_Running(message.trial, self.participant, self.condition, self.t))
        self._run = len(self._runs) - 1
        self._enter()

    def _trial_ended(self, message: m.TrialEnded) -> None:
        ended = max(self._run, self._interrupted)
        if ended >= 0:
            run = self._runs[ended]
            run.end, run.outcome, run.text = self.t, message.outcome, message.text
        self._run = self._interrupted = self.trial = -1
        self._enter()

    def _break_started(self, message: m.BreakStarted) -> None:
        if self.breaks and self.breaks[-1].end is None:
            self._end_break("")
        self.breaks.append(Span(self.t, None, "break", message.text))
        if self._run >= 0:  # what happens now belongs to no trial
            self._interrupted = self._run
            self._run = self.trial = -1
            self._enter()

    def _break_ended(self, message: m.BreakEnded) -> None:
        if self.breaks and self.breaks[-1].end is None:
            self._end_break(message.text)
        if self._interrupted >= 0:
            self._run, self._interrupted = self._interrupted, -1
            self.trial = self._runs[self._run].trial
            self._enter()

    def _end_break(self, text: str) -> None:
        last = self.breaks[-1]
        self.breaks[-1] = Span(last.begin, self.t, last.name, text or last.text)

    def _enter(self) -> None:
        """From here on another tally counts, or the same one."""
        key = (self.participant, self.condition, self._run)
        tally = self._tallies.get(key)
        if tally is not None and tally is self.tally:
            return
        if not self._began:  # what stands before the first line belongs to it
            self._began = True
            first = self.tally
            first.participant, first.condition, first.run = key
            self._tallies[key] = first
            return
        self.settle()
        if tally is None:
            tally = self._tallies[key] = Tally(*key)
        self.tally = tally
