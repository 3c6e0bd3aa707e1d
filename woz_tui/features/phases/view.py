"""Which phases there are, as consoles are told of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

from woz_tui.config.experiment import Experiment
from woz_tui.features.phases.section import PHASES, PresentPhase
from woz_tui.host.feature_view import FeatureView
from woz_tui.protocol.panels import PhaseView


class PhasesView(FeatureView):
    """All of the file; which one holds is said by the messages that still hold."""

    def settings(self, experiment: Experiment, fact: PresentPhase | None) -> Mapping[str, Any]:
        phases = msgspec.convert(PHASES.of(experiment), list[PhaseView], from_attributes=True)
        return {"phases": phases}


VIEW = PhasesView()
