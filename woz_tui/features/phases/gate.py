"""Which phase has locked a panel. That it is locked is the core's affair."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from woz_tui.features.phases.kinds import AskPhase
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import PlayAction
from woz_tui.gate.table import FeatureGate, FeatureRow, Row, locked_action, locked_panel
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:  # the console needs none of it for its first paint
    from woz_tui.features.phases.section import PresentPhase


def locked_by_phase(facts: Facts, asked: PlayAction) -> Refusal | None:
    """The panel belongs to another phase, and this one locks those."""
    phase, action = cast("PresentPhase", facts.features["phases"]), asked.action
    if action is None or action.locked or action.panel not in phase.locked:
        return None
    within = Sentence("phases.within", "in the phase {phase}", phase=phase.heading)
    return locked_panel(action.panel, within)


GATE = FeatureGate(
    rows=(FeatureRow(Row("lock", (PlayAction,), locked_by_phase), before=locked_action),),
    undone={AskPhase: Sentence("phases.not_changed", "Phase not changed")},
)
