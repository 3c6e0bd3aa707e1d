"""Which repairs consoles show."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.config.experiment import Experiment
from woz_tui.features.repairs.section import LABELS
from woz_tui.host.experiment_view import action_view
from woz_tui.host.feature_view import FeatureView


class RepairView(FeatureView):
    """All that the experiment has."""

    def settings(self, experiment: Experiment, fact: object) -> Mapping[str, Any]:
        repairs = (action for action in experiment.beside_panels if action.name in LABELS)
        return {"repairs": [action_view(action) for action in repairs]}


VIEW = RepairView()
