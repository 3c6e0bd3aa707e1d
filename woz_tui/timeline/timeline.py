"""A whole log: its episodes, and whose time it was at each moment."""

from __future__ import annotations

from collections.abc import Iterable
from operator import attrgetter
from typing import TypeVar, cast

from msgspec.structs import force_setattr, replace

from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import (
    CUT_OFF,
    NOT_COUNTED,
    PRACTICE,
    ActionEpisode,
    CommandEpisode,
    Episode,
    MomentEpisode,
    TrialEpisode,
    UtteranceEpisode,
    keep_latest,
)
from woz_tui.timeline.session_state import SessionState
from woz_tui.timeline.trial_context import Context, Contexts, ContextSpan

E = TypeVar("E", bound=Episode)


class Timeline:
    """Takes the messages of a log in their order; after `finish` its episodes can be read.

    Args:
        passing: Passing commands (a knob on its way) are episodes, too.

    Attributes:
        state: What holds now.
        contexts: Whose time it was; a number that was set counts as a trial until `finish` knows.
        passed: Ids of the last passing commands, where they are no episodes.
        episodes: After `finish`: all of them by beginning and `seq`, each with its context.
    """

    def __init__(self, *, passing: bool = False) -> None:
        self.state = SessionState(all_commands=passing)
        self.contexts = Contexts()
        self.passed: dict[str, None] = {}
        self.episodes: tuple[Episode, ...] = ()
        self._ended: list[Episode] = []
        #: Where among those an utterance is: its text comes later.
        self._spoken: dict[tuple[str, int], int] = {}
        self._by_kind: dict[type[Episode], list[Episode]] = {}
        self._trials: dict[int | None, TrialEpisode] = {}
        #: The trial that ran when the log broke off.
        self._broken_off: TrialEpisode | None = None
        self._begun = self._has_trials = False

    @property
    def begin(self) -> int:
        """When the first line was written, in microseconds."""
        return self.state.begin or 0

    @property
    def end(self) -> int:
        """When the last line was written, in microseconds."""
        return self.state.t

    @property
    def spans(self) -> tuple[ContextSpan, ...]:
        """The contexts from the first line to the last, without a gap."""
        return self.contexts.spans(self.end)

    @property
    def pieces(self) -> tuple[ContextSpan, ...]:
        """The session by participant, condition, trial and break; whatever else of the context
        changes, divides nothing.
        """
        found: list[ContextSpan] = []
        for span in self.spans:
            if found and _whose(found[-1].context) == _whose(span.context):
                found[-1] = replace(found[-1], end=span.end)
            else:
                found.append(span)
        return tuple(found)

    def of(self, kind: type[E]) -> list[E]:
        """All episodes of one kind, in their order."""
        return cast("list[E]", self._by_kind.get(kind, []))

    def parts(self, episode: Episode) -> tuple[ContextSpan, ...]:
        """Its pieces by context: in order, gapless, together exactly as long as the episode."""
        return self.contexts.parts(episode.begin, episode.begin + episode.duration, episode.seq)

    @property
    def has_trials(self) -> bool:
        """Whether time outside of trials is apart: some belongs to a trial, or trials were begun,
        or an order of conditions was given for them.
        """
        return self._has_trials

    def inside(self, context: Context) -> bool:
        """Whether what happened in this context was in a trial; in a session without any trial
        (`has_trials`) everything is.
        """
        return context.trial is not None or not self._has_trials

    def counts(self, context: Context) -> bool:
        """Whether what happened in this context is to be analysed: not in a trial that is left
        out.
        """
        trial = self._trials.get(context.run)
        return trial is None or not self.left_out(trial)

    def left_out(self, trial: TrialEpisode) -> str:
        """Why a trial is not to be analysed: aborted, excluded, `PRACTICE` or `CUT_OFF`; empty: it
        is.
        """
        if trial.outcome in NOT_COUNTED:
            return trial.outcome
        if trial.started.trial == 0:
            return PRACTICE
        return CUT_OFF if trial is self._broken_off else ""

    def apply(self, message: m.Message) -> None:
        """Add the next message; `finish` must not have been called."""
        state, study = self.state, self.state.study
        before, first = study.context, state.begin is None
        changes = state.apply(message)
        if first and state.begin is not None:
            self.contexts.enter(state.begin, message.seq, before)
        if study.context is not before or (study.begun and not self._begun):
            self._enter(message)
        for episode in changes:
            if type(episode) is UtteranceEpisode:
                self._keep_utterance(episode)
            elif episode.end is not None:
                self._ended.append(episode)
        if not changes and type(message) is m.Command:
            keep_latest(self.passed, message.command, None)

    def _enter(self, message: m.Message) -> None:
        """Another context holds. Whose the time was before the first line that says so is lost: it
        counts as the same participant's, in the same condition.
        """
        context = self.state.context
        if not self._begun:
            self._begun = True
            early = replace(context, trial=None, run=None, in_break=False, stage="")
            self.contexts.rename_first(early)
            if early == context:
                return
        self.contexts.enter(self.state.t, message.seq, context)

    def _keep_utterance(self, spoken: UtteranceEpisode) -> None:
        if spoken.end is None:
            return
        key = (spoken.driver, spoken.segment)
        place = self._spoken.get(key)
        if place is not None and self._ended[place].seq == spoken.seq:
            self._ended[place] = spoken
            return
        self._spoken[key] = len(self._ended)
        self._ended.append(spoken)

    def finish(self) -> None:
        """The log has ended: makes `episodes` complete."""
        if self.state.study.begins_trials:
            self.contexts = self.contexts.without_numbers()
        running = self.state.study.trial if self.state.end is None else None
        found = [*self._ended, *self.state.finish()]
        found.sort(key=attrgetter("begin", "seq"))
        _add_mistakes(found)
        at = self.contexts.at
        for episode in found:  # nobody else has them: no need to copy each
            force_setattr(episode, "context", at(episode.begin, episode.seq))
            self._by_kind.setdefault(type(episode), []).append(episode)
        self.episodes = tuple(found)
        self._trials = {trial.seq: trial for trial in self.of(TrialEpisode)}
        self._broken_off = self._trials.get(running.seq) if running is not None else None
        self._has_trials = self.state.study.begins_trials or any(
            span.context.trial is not None for span in self.spans
        )


def _whose(context: Context) -> tuple[object, ...]:
    return context.participant, context.condition, context.trial, context.run, context.in_break


def _add_mistakes(episodes: list[Episode]) -> None:
    """Adds to actions and commands the line that calls them a mistake, also after their end."""
    mistakes = [
        each.message
        for each in episodes
        if type(each) is MomentEpisode and type(each.message) is m.Mistake
    ]
    places: dict[str, list[int]] = {mistake.run: [] for mistake in mistakes}
    for at, episode in enumerate(episodes) if mistakes else ():
        if type(episode) is ActionEpisode:
            places.get(episode.request.run, []).append(at)
        elif type(episode) is CommandEpisode:
            places.get(episode.request.command, []).append(at)
    for mistake in mistakes:
        for at in reversed(places[mistake.run]):
            episode = episodes[at]
            if episode.seq < mistake.seq and isinstance(episode, ActionEpisode | CommandEpisode):
                if episode.mistake is None:
                    episodes[at] = replace(episode, mistake=mistake)
                break


def timeline_of(messages: Iterable[m.Message]) -> Timeline:
    """Builds the finished timeline of messages."""
    timeline = Timeline()
    for message in messages:
        timeline.apply(message)
    timeline.finish()
    return timeline
