"""What is known of participants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from woz_tui.features.people.kinds import ParticipantDescribed
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState


class PeopleHistory(FeatureHistory):
    """The last that was said of each, by code."""

    def __init__(self) -> None:
        self.described: dict[str, ParticipantDescribed] = {}

    def _describe(self, message: ParticipantDescribed, state: SessionState) -> None:
        keep_latest(self.described, message.participant, message)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {ParticipantDescribed: _describe}


def known_fields(state: SessionState) -> Mapping[str, str]:
    """What is known of who takes part."""
    line = state.history(PeopleHistory).described.get(state.study.participant)
    return line.fields if line is not None else {}
