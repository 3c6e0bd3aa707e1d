"""How long the engagement model was in which state, and how long somebody was engaged."""

from __future__ import annotations

from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.figures import Visit
from woz_tui.analysis.tally import Tally
from woz_tui.core import messages as m
from woz_tui.experiment.engagement import RUNS, STATES
from woz_tui.experiment.verbs import ENGAGEMENT
from woz_tui.sensing.machine import ENGAGED

#: The name under which an unbroken engagement stands among the visits.
ENGAGED_VISIT = "engaged"
_OFF = "off"


class Engaged:
    """Follows the states. A model that is switched off, or not there, is in none.

    It is there from its first settings (in logs of schema 1 without them: from the beginning, if it
    ever moved), and on unless it starts, or is switched, `off`.
    """

    def __init__(self, course: Course) -> None:
        self._course = course
        self._there = False
        self._on = False
        #: The log has told of settings: without them, no model was there.
        self._told = False
        #: Time before anything was told of a model, and where it would count.
        self._before: list[tuple[Tally, int]] = []
        self._state = STATES[0]
        self._outcome = ""
        self._visitor = ""
        self._entered = 0
        self._settled = 0
        #: Since when somebody is engaged without a break.
        self._engaged_since: int | None = None
        self.visits: list[Visit] = []
        course.leaving.append(self._settle)

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.EngagementAdopted: self._adopted,
            m.EngagementChanged: self._changed,
            m.Done: self._done,
        }

    def finish(self) -> None:
        """The log is over; the state lasts until its last moment."""
        self._settle()
        if self._on:
            self._leave("", cut=True)
            self._disengage("", cut=True)

    def _adopted(self, message: m.EngagementAdopted) -> None:
        self._settle()
        self._told = True
        if not message.settings:
            self._switch(on=False)
            self._there = False
        elif not self._there:
            self._there = True
            self._state = STATES[0]
            self._switch(on=message.settings.get("start", "run") != _OFF)

    def _done(self, message: m.Done) -> None:
        if message.driver != ENGAGEMENT or not self._there:
            return
        run = message.sent.get("run")
        if isinstance(run, str) and run in RUNS:
            self._switch(on=run != _OFF)

    def _changed(self, message: m.EngagementChanged) -> None:
        course = self._course
        self._settle()
        if not self._there:
            self._appear(message.was)
        course.tally.transitions[message.was, message.now] += 1
        course.tally.forced += message.forced
        if self._on:
            self._leave(message.outcome, cut=False)
        self._state, self._outcome = message.now, message.outcome
        self._visitor = message.visitor
        if self._on:
            self._enter()

    def _appear(self, state: str) -> None:
        """A log that tells no settings has a model all the same: from the beginning on."""
        self._there = self._on = True
        self._state = state
        self._enter()
        if self._told:
            return
        self._entered = self._course.begin
        if self._engaged_since is not None:
            self._engaged_since = self._course.begin
        for tally, us in self._before:
            self._spend(tally, us)
        self._before.clear()

    def _switch(self, *, on: bool) -> None:
        if on == self._on:
            return
        self._settle()
        if on:
            self._on = True
            self._enter()
        else:
            self._leave("", cut=True)
            self._disengage("", cut=True)
            self._on = False

    # -- time ---------------------------------------------------------------------------------

    def _settle(self) -> None:
        """Count the time up to now where it belongs."""
        course = self._course
        tally, us = course.tally, course.t - max(self._settled, course.begin)
        self._settled = course.t
        if us <= 0:
            return
        if not self._there:
            if not self._told:
                self._before.append((tally, us))
        elif self._on:
            self._spend(tally, us)
        else:
            tally.off_us += us

    def _spend(self, tally: Tally, us: int) -> None:
        """So long the model was on, in this state."""
        tally.on_us += us
        tally.state_us[self._state] += us
        if self._engaged_since is not None:
            tally.engaged_us += us

    def _enter(self) -> None:
        self._entered = self._course.t
        self._engage()

    def _engage(self) -> None:
        if self._state in ENGAGED:
            if self._engaged_since is None:
                self._engaged_since = self._entered
        else:
            self._disengage(self._outcome, cut=False)

    def _leave(self, outcome: str, *, cut: bool) -> None:
        """A visit has ended."""
        self._course.tally.length(self._state, self._course.t - self._entered)
        self._visit(self._state, self._entered, outcome, cut=cut)

    def _disengage(self, outcome: str, *, cut: bool) -> None:
        if self._engaged_since is not None:
            self._course.tally.episodes.add(self._course.t - self._engaged_since)
            self._visit(ENGAGED_VISIT, self._engaged_since, outcome, cut=cut)
            self._engaged_since = None

    def _visit(self, state: str, begin: int, outcome: str, *, cut: bool) -> None:
        course = self._course
        self.visits.append(
            Visit(
                state=state,
                begin=begin,
                end=course.t,
                outcome=outcome,
                visitor=self._visitor,
                cut=cut,
                participant=course.participant,
                condition=course.condition,
                trial=course.trial,
            )
        )
