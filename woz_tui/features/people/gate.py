"""Whoever says something of a participant may do so while the session ends, too."""

from __future__ import annotations

from woz_tui.features.people.kinds import AskDescribe
from woz_tui.gate.table import FeatureGate

GATE = FeatureGate(while_ending=(AskDescribe,))
