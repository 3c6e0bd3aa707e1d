"""Who may ask what about questionnaires."""

from __future__ import annotations

from woz_tui.gate.table import FeatureGate
from woz_tui.protocol.requests import AskAnswer, AskQuestionnaire

_ALL = (AskQuestionnaire, AskAnswer)

GATE = FeatureGate(participant_may=_ALL, after_leaving=_ALL)
