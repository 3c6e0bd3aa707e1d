"""Who may ask what about questionnaires."""

from __future__ import annotations

from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.gate.table import FeatureGate

_ALL = (AskQuestionnaire, AskAnswer)

GATE = FeatureGate(participant_may=_ALL, after_leaving=_ALL)
