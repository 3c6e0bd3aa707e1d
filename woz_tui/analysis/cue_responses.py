"""Matches each cue with the wizard's act that answered it."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

from woz_tui.analysis.event_rows import CueRow, WizardAct, context_fields, id_of, moments
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.timeline import episodes as e
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context

#: An answer within this time is one (microseconds), unless somebody says otherwise.
WINDOW_US = 10_000_000
#: Two cues within this time stand for one event: the end of speech leads the engagement model into
#: its next state.
ECHO_US = 1_000_000
#: An act within this time before a cue, while the visitor was still speaking or the model still
#: waiting for the end of it, is the answer: whoever listens hears the end of a sentence coming, and
#: a microphone reports it late, after a second of silence.
EARLY_US = 1_000_000
#: Nobody reacts within this time (microseconds): whoever acts so soon had begun before the cue.
SOONEST_US = 150_000
#: States of the engagement model in which the visitor waits for an answer.
WAITING = ("RobotThinks",)
#: Acts that may come before the line of the cue they answer.
_KEPT = 16
#: A cue, and the context of its line.
Placed = tuple[Context, CueRow]


class _Answers:
    """Decides which acts answer which cues: as the experiment file says, else speech."""

    def __init__(self, timeline: Timeline) -> None:
        self._verbs = timeline.state.study.settings.answers
        #: What was sent, by the command's id, and what was to be sent, by the action's name.
        self._sent = {each.request.command: each.label for each in timeline.of(e.CommandEpisode)}
        self._planned = {
            action.name: action.verbs
            for _, plan in moments(timeline, m.SessionPlan)
            for panel in plan.panels
            for action in panel.actions
        }

    def by(self, act: WizardAct, cue_type: str) -> bool:
        """Whether this act is an answer to such a cue. One of which nothing is known is one: an
        action that was refused in a log that does not say what it would have done.
        """
        answers = frozenset(self._verbs.get(cue_type, SPEAKING_VERBS))
        if act.request.panel in answers:
            return True
        if isinstance(act, e.CommandEpisode):
            return act.label in answers
        verbs = [self._sent[command] for command in act.commands if command in self._sent]
        verbs += (*self._planned.get(act.label, ()), *act.request.without)
        return not verbs or not answers.isdisjoint(verbs)


@dataclass(slots=True)
class _Open:
    cue_type: str
    t: int
    what: str
    context: Context
    echo: bool = False


class _Cues:
    """Matches cues with acts, line by line. A cue is open until the next act that answers it, the
    end of the window, the end of the trial, or until it is superseded: by another one of its type,
    by the visitor going on to speak, or by the engagement model leaving the state. One that is not
    a marker may be answered before it comes.
    """

    def __init__(self, timeline: Timeline, window_us: int) -> None:
        self._at = timeline.contexts.at
        self._answers = _Answers(timeline)
        self._window = window_us
        #: Where the present line is.
        self.t = self.seq = 0
        self._open: dict[str, _Open] = {}
        self._early: _Open | None = None
        self._acts: deque[WizardAct] = deque(maxlen=_KEPT)
        self.placed: list[Placed] = []

    def act(self, act: WizardAct) -> None:
        """The wizard does something: it may answer open cues."""
        self._acts.append(act)
        for cue_type in [*self._open]:
            if self._answers.by(act, cue_type):
                self._answer(self._open.pop(cue_type), act)

    def border(self, _: object) -> None:
        """Closes all cues: another trial, condition or participant begins, or a break."""
        while self._open:
            cue = self._open.pop(next(iter(self._open)))
            self._close(cue, "missed" if self._late(cue) else "cut")

    def finish(self) -> None:
        """The log has ended."""
        self.border(None)

    def speaks(self, spoken: e.UtteranceEpisode) -> None:
        """The visitor begins to speak."""
        self._supersede("speech")

    def spoke(self, spoken: e.UtteranceEpisode) -> None:
        """The visitor has spoken: the line that says so comes later than the end of the speech."""
        end = self.t if spoken.end is None else spoken.end
        self._give("speech", end, f"utterance {spoken.segment}", spoken.begin)

    def waits(self, state: e.ModelStateEpisode) -> None:
        """The engagement model enters a state in which the visitor waits."""
        self._give("engagement", self.t, state.state, 0)

    def waited(self, state: e.ModelStateEpisode) -> None:
        """The engagement model leaves that state, or is switched off."""
        self._supersede("engagement")

    def marker(self, marker: m.Marker) -> None:
        """Somebody sets a marker."""
        self._give("marker", marker.moment, marker.text)

    def _give(self, cue_type: str, t: int, what: str, since: int | None = None) -> None:
        """A cue at `t`. An act after `since` may have answered it early; None: nothing can."""
        self._supersede(cue_type)
        cue = _Open(cue_type, t, what, self._at(self.t, self.seq))
        others = [each for each in self._open.values() if not each.echo]
        if self._early is not None:
            others.append(self._early)
        cue.echo = any(abs(t - each.t) <= ECHO_US for each in others)
        early = None if since is None else self._act(cue_type, max(since, t - EARLY_US), t)
        if early is not None:
            if not cue.echo:
                self._early = cue
            self._close(cue, "answered_early", action=early.label, run=id_of(early))
        elif (already := self._act(cue_type, t + 1, self.t)) is not None:
            self._answer(cue, already)
        else:
            self._open[cue_type] = cue

    def _act(self, cue_type: str, begin: int, end: int) -> WizardAct | None:
        """The first act in this time, both ends included, that answers such a cue."""
        first = None
        for act in reversed(self._acts):
            if act.begin < begin:
                break
            if act.begin <= end and self._answers.by(act, cue_type):
                first = act
        return first

    def _supersede(self, cue_type: str) -> None:
        cue = self._open.pop(cue_type, None)
        if cue is not None:
            self._close(cue, "missed" if self._late(cue) else "superseded")

    def _late(self, cue: _Open) -> bool:
        return self.t - cue.t > self._window

    def _answer(self, cue: _Open, act: WizardAct) -> None:
        reaction = act.begin - cue.t
        if reaction < SOONEST_US:
            if not cue.echo:
                self._early = cue
            self._close(cue, "answered_early", action=act.label, run=id_of(act))
        elif reaction > self._window:
            self._close(cue, "missed")
        else:
            self._close(cue, "answered", reaction_us=reaction, action=act.label, run=id_of(act))

    def _close(self, cue: _Open, result: str, **answer: Any) -> None:
        row = CueRow(
            **context_fields(cue.context),
            **answer,
            cue_type=cue.cue_type,
            t=cue.t,
            what=cue.what,
            result=result,
            echo=cue.echo,
        )
        self.placed.append((cue.context, row))


def cues_of(
    timeline: Timeline, acts: Sequence[WizardAct], window_us: int, waiting: Collection[str]
) -> list[Placed]:
    """Finds all cues but those that features give, in the order in which they were over."""
    cues = _Cues(timeline, window_us)
    lines: list[tuple[int, int, Callable[[Any], None], Any]] = [
        (act.begin, act.seq, cues.act, act) for act in acts
    ]
    for spoken in timeline.of(e.UtteranceEpisode):
        if spoken.own:
            continue
        if spoken.started is not None:
            lines.append((spoken.started.t, spoken.started.seq, cues.speaks, spoken))
        if spoken.ended is not None:
            lines.append((spoken.ended.t, spoken.ended.seq, cues.spoke, spoken))
    for state in timeline.of(e.ModelStateEpisode):
        if state.entered is not None and state.state in waiting:
            lines.append((state.begin, state.seq, cues.waits, state))
            if state.outcome != e.EpisodeOutcome.OPEN:
                last = state.left.seq if state.left is not None else sys.maxsize
                lines.append((state.begin + state.duration, last, cues.waited, state))
    for _, marker in moments(timeline, m.Marker):
        if marker.source not in m.AUTOMATIC_MARKERS:
            lines.append((marker.t, marker.seq, cues.marker, marker))
    lines += [(piece.begin, piece.seq, cues.border, None) for piece in timeline.pieces[1:]]
    for t, seq, case, what in sorted(lines, key=itemgetter(0, 1)):
        cues.t, cues.seq = t, seq
        case(what)
    cues.t = timeline.end
    cues.finish()
    return cues.placed
