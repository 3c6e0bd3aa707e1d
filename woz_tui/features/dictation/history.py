"""What was dictated."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.dictation.kinds import Dictated, DictationListens, DictationSaid
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class DictationHistory(FeatureHistory):
    """The last text, the field that is open, and why the last one was closed."""

    deeds = (Dictated, DictationSaid)

    def __init__(self) -> None:
        self.last: Dictated | None = None
        self.listens: DictationListens | None = None
        self.closed = ""

    def _dictate(self, message: Dictated, state: SessionState) -> Iterable[Episode]:
        self.last = message
        return moment(message, state.t)

    def _say(self, message: DictationSaid, state: SessionState) -> Iterable[Episode]:
        return moment(message, state.t)

    def _listen(self, message: DictationListens, state: SessionState) -> None:
        self.listens = message if message.on else None
        self.closed = message.why

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        Dictated: _dictate,
        DictationSaid: _say,
        DictationListens: _listen,
    }
