"""What a log says of blocks: their plan belongs to their command."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.blocks.kinds import BlockPlanned, BlockTrouble
from woz_tui.protocol.messages import Message
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState


class BlockHistory(FeatureHistory):
    """Keeps nothing of its own."""

    def _planned(self, message: BlockPlanned, state: SessionState) -> Iterable[Episode]:
        return state.planned(message)

    def _trouble(self, message: BlockTrouble, state: SessionState) -> Iterable[Episode]:
        return state.stray(message)

    cases: ClassVar[Mapping[type[Message], HistoryCase]] = {
        BlockPlanned: _planned,
        BlockTrouble: _trouble,
    }
