"""Where scripts stand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.scripts.kinds import ScriptMoved
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode, keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class ScriptHistory(FeatureHistory):
    """Where each script stands, by the phase whose it is (empty: the file's)."""

    def __init__(self) -> None:
        self.moved: dict[str, ScriptMoved] = {}

    def _move(self, message: ScriptMoved, state: SessionState) -> Iterable[Episode]:
        keep_latest(self.moved, message.phase, message)
        return moment(message, state.t)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {ScriptMoved: _move}
