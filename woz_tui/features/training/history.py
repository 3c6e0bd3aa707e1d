"""How far a training is, and its cues."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar

from msgspec.structs import replace

from woz_tui.features.training.kinds import CueAnswered, CueGiven, TrainingChanged
from woz_tui.protocol.envelope import Message
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment, succeed


class CueEpisode(Episode, frozen=True, kw_only=True):
    """A cue of a training, and what the wizard made of it."""

    kind = "cue"
    given: CueGiven
    answered: CueAnswered | None = None

    @property
    def label(self) -> str:
        """Its sort."""
        return self.given.sort


class TrainingHistory(FeatureHistory):
    """The training, and its cue that nobody has answered."""

    def __init__(self) -> None:
        self.training: TrainingChanged | None = None
        self.cue: CueEpisode | None = None

    @property
    def apart(self) -> bool:
        return self.training is not None

    def _change(self, message: TrainingChanged, state: SessionState) -> Iterable[Episode]:
        self.training = message
        return moment(message, state.t)

    def _give(self, message: CueGiven, state: SessionState) -> Iterator[Episode]:
        before = self.cue
        self.cue = CueEpisode(begin=state.t, seq=message.seq, given=message)
        return succeed(before, self.cue, message, state.t, cut=True)

    def _judge(self, message: CueAnswered, state: SessionState) -> Iterable[Episode]:
        cue = self.cue
        if cue is None or cue.given.cue != message.cue:
            return moment(message, state.t)
        self.cue = None
        return (replace(cue, end=state.t, outcome=message.judged, answered=message),)

    cases: ClassVar[Mapping[type[Message], HistoryCase]] = {
        TrainingChanged: _change,
        CueGiven: _give,
        CueAnswered: _judge,
    }
    deeds = (CueGiven, CueAnswered)
