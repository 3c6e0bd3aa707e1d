"""The engagement model of a session: whether it is there and on, its state, who is engaged."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import dataclass

from msgspec.structs import replace

from woz_tui.config.engagement_words import RUNS, STATES
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.protocol import messages as m
from woz_tui.sensing.state_machine import ENGAGED
from woz_tui.timeline.episodes import (
    EngagementEpisode,
    Episode,
    EpisodeOutcome,
    ModelOffEpisode,
    ModelStateEpisode,
)

_OFF = "off"


@dataclass(slots=True)
class ModelStatus:
    """How the engagement model stands. Each method takes a message and returns the episodes that
    ended with it or began.

    The model is there from its first settings to its last, and on unless it starts, or is switched,
    off. A log that has lost its settings has one if it ever moved: from its beginning on.

    Attributes:
        present: Whether there is a model.
        state: Its state, also while it is off.
        settings: The last message with the settings it goes by.
        changed, shown: The last change, and the last look at all of it.
        stay: The state while it is on.
        engaged: The unbroken engagement while there is one.
        off: The time for which it is off.
    """

    present: bool = False
    state: str = STATES[0]
    settings: m.EngagementAdopted | None = None
    changed: m.EngagementChanged | None = None
    shown: m.EngagementShown | None = None
    stay: ModelStateEpisode | None = None
    engaged: EngagementEpisode | None = None
    off: ModelOffEpisode | None = None
    #: With this line it appeared, or the one before it went.
    _appeared: m.Message | None = None
    #: And with this one the model before it went.
    _removal: m.EngagementAdopted | None = None
    #: The last line that switched it off, the last one that switched it on, and the last change
    #: before that one.
    _switched_off: m.Done | None = None
    _switched_on: m.Done | None = None
    _before: m.EngagementChanged | None = None
    #: The last change that ended an engagement.
    _disengaged: m.EngagementChanged | None = None

    def copy(self) -> ModelStatus:
        """An independent copy."""
        return copy.copy(self)

    @property
    def on(self) -> bool:
        """Whether it is there, and runs or is held."""
        return self.stay is not None

    @property
    def removed(self) -> bool:
        """Whether it is known that there is none any more."""
        return not self.present and self._appeared is not None

    @property
    def since(self) -> int | None:
        """When it came to its state, as far as it was on then; None: it is off."""
        return self.stay.begin if self.stay else None

    @property
    def visitor(self) -> str:
        """The visitor's code; empty while it is not recognised."""
        return self.changed.visitor if self.changed else ""

    @property
    def lines(self) -> Iterator[m.Message]:
        """The messages from which a copy can be rebuilt; they may repeat, in no order."""
        lines: tuple[m.Message | None, ...] = (
            *(self._removal, self._appeared, self.settings),
            *(self._before, self._switched_off, self._switched_on, self._disengaged),
            *(self.changed, self.shown),
        )
        yield from (line for line in lines if line is not None)
        if self.engaged is not None:
            yield from self.engaged.lines

    def open(self) -> Iterator[Episode]:
        """Episodes that have not ended."""
        for episode in (self.stay, self.engaged, self.off):
            if episode is not None:
                yield episode

    # -- messages ---------------------------------------------------------------------------------

    def adopt(self, message: m.EngagementAdopted, t: int) -> Iterator[Episode]:
        """Other settings hold; none at all: the model is gone."""
        self.settings = message
        if not message.settings:
            self._removal = message
            yield from self.vanish(t, message)
        elif not self.present:
            self.present, self.state, self._appeared = True, STATES[0], message
            if message.settings.get("start") == _OFF:
                yield self._rest(t, message.seq, None)
            else:
                yield from self._enter(t, message.seq, None)

    def vanish(self, t: int, message: m.Message) -> Iterator[Episode]:
        """There is no model any more."""
        yield from self._leave(t, EpisodeOutcome.OFF)
        if self.off is not None:
            yield replace(self.off, end=t, outcome=EpisodeOutcome.OFF)
        self.present, self.state = False, STATES[0]
        self.off, self._appeared = None, message
        self.changed = self.shown = self._before = self._disengaged = None
        self._switched_off = self._switched_on = None

    def switch(self, message: m.Done, t: int) -> Iterator[Episode]:
        """A command of the model is done: some switch it off or on."""
        run = message.sent.get("run")
        if message.driver != ENGAGEMENT or not self.present or run not in RUNS:
            return
        if run == _OFF and self.on:
            self._switched_off = message
            yield from self._leave(t, EpisodeOutcome.OFF)
            yield self._rest(t, message.seq, message)
        elif run != _OFF and self.off is not None:
            yield replace(self.off, end=t, outcome=EpisodeOutcome.ON)
            self.off, self._switched_on, self._before = None, message, self.changed
            yield from self._enter(t, message.seq, None)

    def change(self, message: m.EngagementChanged, t: int, begin: int) -> Iterator[Episode]:
        """The model went from one state to another; `begin` is when the log began."""
        if not self.present:
            since = begin if self._appeared is None else t
            self.present, self.state, self._appeared = True, message.was, message
            yield from self._enter(since, message.seq, None)
        stay = self.stay
        self.state, self.changed = message.now, message
        if stay is None:
            return
        yield replace(stay, end=t, outcome=EpisodeOutcome.LEFT, left=message)
        if message.now not in ENGAGED and self.engaged is not None:
            yield replace(self.engaged, end=t, outcome=EpisodeOutcome.LEFT, left=message)
            self.engaged, self._disengaged = None, message
        yield from self._enter(t, message.seq, message)

    def _enter(self, t: int, seq: int, change: m.EngagementChanged | None) -> Iterator[Episode]:
        """It is on, in its state, from `t` on."""
        self.stay = ModelStateEpisode(begin=t, seq=seq, state=self.state, entered=change)
        yield self.stay
        if self.state not in ENGAGED:
            return
        named = change if change is not None and change.visitor else None
        if self.engaged is None:
            self.engaged = EngagementEpisode(begin=t, seq=seq, entered=change, named=named)
            yield self.engaged
        elif named is not None:
            self.engaged = replace(self.engaged, named=named)

    def _leave(self, t: int, outcome: str) -> Iterator[Episode]:
        for episode in (self.stay, self.engaged):
            if episode is not None:
                yield replace(episode, end=t, outcome=outcome, cut=True)
        self.stay = self.engaged = None

    def _rest(self, t: int, seq: int, message: m.Done | None) -> ModelOffEpisode:
        self.off = ModelOffEpisode(begin=t, seq=seq, switched=message)
        return self.off
