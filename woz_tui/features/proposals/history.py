"""Which proposals are offered, and how each set ended."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from msgspec.structs import replace

from woz_tui.features.proposals.kinds import (
    SuggestAsked,
    SuggestGone,
    SuggestModel,
    SuggestOffered,
    SuggestRanked,
    SuggestRehearsed,
    SuggestSettings,
    SuggestShown,
    SuggestState,
    SuggestTaken,
    SuggestTrial,
)
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class SuggestionEpisode(Episode, frozen=True, kw_only=True):
    """A set from its offer to its end, which is `taken` or `gone`. `shown`: the first time that
    something of it stood on a screen.
    """

    kind = "suggestion"
    offered: SuggestOffered
    taken: SuggestTaken | None = None
    gone: SuggestGone | None = None
    shown: SuggestShown | None = None

    @property
    def label(self) -> str:
        """Whose it is."""
        return self.offered.who or self.offered.source

    @property
    def source(self) -> str:
        """Who proposes."""
        return self.offered.source


class ProposalHistory(FeatureHistory):
    """The sets that are offered, by their ids, and what holds of proposals."""

    deeds = (SuggestOffered, SuggestTaken)

    def __init__(self) -> None:
        self.settings: SuggestSettings | None = None
        self.model: SuggestModel | None = None
        self.model_state: SuggestState | None = None
        self.trial: SuggestTrial | None = None
        self.sets: dict[str, SuggestionEpisode] = {}

    def _set(self, message: SuggestSettings, state: SessionState) -> Iterable[Episode]:
        self.settings = message
        if "model" not in message.sources:
            self.model = self.model_state = None
        return moment(message, state.t)

    def _choose(self, message: SuggestModel, state: SessionState) -> Iterable[Episode]:
        self.model = message
        return moment(message, state.t)

    def _stand(self, message: SuggestState, state: SessionState) -> Iterable[Episode]:
        self.model_state = message
        return moment(message, state.t)

    def _draw(self, message: SuggestTrial, state: SessionState) -> Iterable[Episode]:
        self.trial = message
        return moment(message, state.t)

    def _over(self, message: m.TrialEnded, state: SessionState) -> None:
        self.trial = None

    def is_quiet(self) -> bool:
        """Whether nothing is offered in this trial."""
        return self.trial is not None and not self.trial.offered

    def _offer(self, message: SuggestOffered, state: SessionState) -> Iterable[Episode]:
        offered = SuggestionEpisode(begin=state.t, seq=message.seq, offered=message)
        self.sets[message.set] = offered
        return (offered,)

    def _show(self, message: SuggestShown, state: SessionState) -> Iterable[Episode]:
        before = self.sets.get(message.set)
        if before is not None and before.shown is None:
            self.sets[message.set] = replace(before, shown=message)
        return moment(message, state.t)

    def _end(self, message: SuggestTaken | SuggestGone, state: SessionState) -> Iterable[Episode]:
        """One that is not open any more is a moment: each set ends once."""
        before = self.sets.pop(message.set, None)
        if before is None:
            return moment(message, state.t)
        if isinstance(message, SuggestTaken):
            return (replace(before, end=state.t, outcome=message.how, taken=message),)
        return (replace(before, end=state.t, outcome=message.how, gone=message),)

    def _rank(
        self, message: SuggestRanked | SuggestAsked | SuggestRehearsed, state: SessionState
    ) -> Iterable[Episode]:
        return moment(message, state.t)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        SuggestSettings: _set,
        SuggestModel: _choose,
        SuggestState: _stand,
        SuggestTrial: _draw,
        m.TrialEnded: _over,
        SuggestAsked: _rank,
        SuggestOffered: _offer,
        SuggestRanked: _rank,
        SuggestRehearsed: _rank,
        SuggestShown: _show,
        SuggestTaken: _end,
        SuggestGone: _end,
    }
