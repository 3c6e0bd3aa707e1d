"""Who may choose: whoever sits before a page, or a program in their place."""

from __future__ import annotations

from woz_tui.features.choices.kinds import AskChoicePicture, AskChoose
from woz_tui.gate.table import FeatureGate

GATE = FeatureGate(participant_may=(AskChoose, AskChoicePicture))
