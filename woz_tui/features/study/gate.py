"""What of a study may be asked while the session ends, and what counts whoever has left."""

from __future__ import annotations

from woz_tui.features.study.kinds import AskAssign, AskProposal, AskTrial
from woz_tui.gate.table import FeatureGate

GATE = FeatureGate(while_ending=(AskProposal,), after_leaving=(AskAssign, AskTrial))
