"""What was proposed in sessions, and what became of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Any

from woz_tui.analysis.event_rows import ContextRow, context_fields, moments
from woz_tui.analysis.feature_figures import FeatureFigures, Instant
from woz_tui.analysis.text_format import counted, listed
from woz_tui.features.proposals.clean_text import is_question
from woz_tui.features.proposals.history import SuggestionEpisode
from woz_tui.features.proposals.kinds import SuggestRehearsed, SuggestTrial
from woz_tui.features.proposals.model_figures import (
    ModelFigures,
    about_models,
    models_of,
)
from woz_tui.features.proposals.rights import HANDS
from woz_tui.features.training.history import CueEpisode
from woz_tui.features.training.kinds import RIGHT, VOID
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.timeline.episodes import ActionEpisode, CommandEpisode, Episode
from woz_tui.timeline.timeline import Timeline

#: Ends of a set that the wizard took.
TAKEN = ("key", "edited", "own_key")
#: Ends with which it was passed over, if it could be seen.
_IGNORED = ("other_act", "expired", "superseded")
#: Ends that say nothing of the wizard.
NOT_SEEN = ("end", "moved_on", "reloaded", "withdrawn", "stop")
#: Where a sentence comes from: a person's key, the script, the robot itself, what was proposed ...
_ORIGINS = {"palette": "key", "midi": "key", "gamepad": "key", "stream-deck": "key"}


@dataclass(frozen=True, slots=True, kw_only=True)
class SetRow(ContextRow):
    """A set. `outcome`: how it ended; empty: no end is in the log. `shown_us`: from the offer until
    something of it stood on a screen; None: it never did, or the log is older than that line.
    `distance`: how much of the sentence was changed, 0 to 1; None: nothing was taken. `marked`: a
    sentence of it was marked as a repetition or one more question. `was_right`: whether the
    wizard's next act was among its actions; None: it has none.
    """

    set: str
    source: str
    who: str
    approval: bool
    cue: str
    items: int
    t: int
    outcome: str
    after_us: int | None
    shown_us: int | None
    distance: float | None
    marked: bool
    was_right: bool | None

    @property
    def is_taken(self) -> bool:
        """Whether the wizard took something of it."""
        return self.outcome in TAKEN

    @property
    def is_ignored(self) -> bool:
        """Whether it could be seen, and the wizard did something else, or nothing."""
        return self.shown_us is not None and self.outcome in _IGNORED


@dataclass(frozen=True, slots=True)
class SaidSentence:
    """Something that the robot said, and where that came from."""

    t: int
    origin: str
    words: int
    asks: bool


@dataclass(frozen=True, slots=True)
class RehearsedCue:
    """A cue of a training. `kind`: right, wrong or none, as was proposed with it. `followed`: an
    action of the list was played by its own key while it stood there; `right`: the answer was.
    """

    kind: str
    offered: bool
    followed: bool
    right: bool
    reaction_us: int | None


@dataclass(frozen=True, slots=True)
class ProposalFigures:
    """The sets of a session, its sentences, the models that were asked, and whether something was
    offered in each trial, where chance decided that: by participant and trial.
    """

    sets: tuple[SetRow, ...] = ()
    said: tuple[SaidSentence, ...] = ()
    models: tuple[ModelFigures, ...] = ()
    drawn: Mapping[tuple[str, int], bool] = field(default_factory=dict)
    rehearsed: tuple[RehearsedCue, ...] = ()

    @property
    def origins(self) -> Mapping[str, int]:
        """How many sentences came from where."""
        return Counter(each.origin for each in self.said)


class CountedProposals(FeatureFigures):
    """Sets and origins of sentences, in sessions in which something was proposed."""

    key = "proposals"
    nothing = None

    def count(self, timeline: Timeline) -> ProposalFigures | None:
        sets = tuple(_rows(timeline))
        models = tuple(models_of(timeline))
        asked = any(each.requests for each in models)
        said = tuple(_said(timeline))
        drawn = {
            (context.participant, line.trial): line.offered
            for context, line in moments(timeline, SuggestTrial)
        }
        cues = tuple(_rehearsed(timeline))
        if not (sets or asked or drawn or cues):
            return None
        return ProposalFigures(sets, said, models, drawn, cues)

    def values(self, name: str, figures: ProposalFigures | None) -> Mapping[str, Any]:
        if figures is None:
            return {self.key: None}
        told = {"sets": figures.sets, "origins": {**figures.origins}, "models": figures.models}
        return {self.key: told}

    def instant(self, episode: Episode) -> Instant | None:
        if not isinstance(episode, SuggestionEpisode) or episode.taken is None:
            return None
        return Instant(episode.end or episode.begin, episode.label, "proposal", episode.outcome)

    def methods(self, sessions: Sequence[ProposalFigures]) -> Iterator[str]:
        sets = [each for session in sessions for each in session.sets]
        sources = sorted({each.source for each in sets})
        names = {
            "logs": "a ranker of actions that had learnt earlier sessions",
            "model": "a language model",
            "program": "programs",
        }
        seen = [each for each in sets if each.outcome not in NOT_SEEN]
        taken = [each for each in seen if each.outcome in TAKEN]
        edited = sum(each.outcome == "edited" for each in taken)
        drawn = [offered for session in sessions for offered in session.drawn.values()]
        half = f" in {drawn.count(True)} of {len(drawn)} trials, drawn by chance," if drawn else ""
        share = f", {100 * len(taken) / len(seen):.0f} % of which the wizard took" if seen else ""
        changed = f" ({counted(edited, 'sentence')} changed before)" if edited else ""
        yield from about_models([each for session in sessions for each in session.models])
        if not sets:
            return
        yield (
            f"In {counted(len(sessions), 'session')}{half}"
            f" {listed([names.get(each, each) for each in sources])} offered the wizard"
            f" {counted(len(sets), 'set')} of proposals{share}{changed}; nothing of it was done"
            " without the wizard."
        )


def _rows(timeline: Timeline) -> Iterator[SetRow]:
    acts = [
        (each.begin, each.label)
        for each in timeline.of(ActionEpisode)
        if each.request.source in HANDS and not isinstance(each.ended, m.ActionRefused)
    ]
    for each in timeline.of(SuggestionEpisode):
        offered, taken = each.offered, each.taken
        actions = {item.action for item in offered.items if item.action}
        following = next((label for t, label in acts if t >= each.begin), None)
        yield SetRow(
            **context_fields(each.context) | {"counted": timeline.counts(each.context)},
            set=offered.set,
            source=offered.source,
            who=offered.who,
            approval=offered.approval,
            cue=offered.cue,
            items=len(offered.items),
            t=each.begin,
            outcome="" if each.end is None or each.cut else each.outcome,
            after_us=None if each.end is None else each.duration,
            shown_us=None if each.shown is None else each.shown.after_us,
            marked=any(item.marks for item in offered.items),
            distance=None if taken is None else _distance(each),
            was_right=following in actions if actions and following is not None else None,
        )


def _rehearsed(timeline: Timeline) -> Iterator[RehearsedCue]:
    """Cues of a training that were answered or missed, with what was proposed."""
    told = {line.cue: line for _, line in moments(timeline, SuggestRehearsed)}
    sets = {each.offered.cue: each for each in timeline.of(SuggestionEpisode)}
    for cue in timeline.of(CueEpisode):
        line, answer = told.get(cue.given.cue), cue.answered
        if line is None or answer is None or answer.judged == VOID:
            continue
        of = sets.get(f"training/{line.cue}")
        yield RehearsedCue(
            kind=("right" if line.fits else "wrong") if line.items else "none",
            offered=of is not None,
            followed=of is not None and of.taken is not None,
            right=answer.judged == RIGHT,
            reaction_us=answer.reaction_us if answer.reaction_us >= 0 else None,
        )


def _distance(each: SuggestionEpisode) -> float:
    taken = each.taken
    if taken is None or not taken.text:
        return 0.0
    text = next((item.text for item in each.offered.items if item.id == taken.item), "")
    return round(1 - SequenceMatcher(None, text, taken.text, autojunk=False).ratio(), 3)


def _said(timeline: Timeline) -> Iterator[SaidSentence]:
    """What was said, and where it came from: each speaking command belongs to one source."""
    proposed = {
        each.taken.run: each.offered.source
        for each in timeline.of(SuggestionEpisode)
        if each.taken is not None and each.taken.run
    }
    for each in timeline.of(CommandEpisode):
        request = each.request
        if request.verb not in SPEAKING_VERBS:
            continue
        source = proposed.get(request.run) or proposed.get(request.command)
        origin = f"proposed: {source}" if source else _ORIGINS.get(request.source, request.source)
        text = str(request.args.get("text", ""))
        yield SaidSentence(each.begin, origin, len(text.split()), is_question(text))


FIGURES = CountedProposals()
