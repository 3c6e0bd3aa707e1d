"""What consoles are told of a feature with the panels and settings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.config.experiment import Experiment, Panel
from woz_tui.protocol.panels import PanelView


class FeatureView:
    """How a feature changes what consoles are shown. `fact`: what holds of it in a session
    (`session.session_features.SessionFeature.fact`); None: nothing, or there is no session.
    """

    def settings(self, experiment: Experiment, fact: Any) -> Mapping[str, Any]:
        """Fields of `welcome.WelcomeSettings` that it fills."""
        return {}

    def plan(self, experiment: Experiment) -> Mapping[str, Any]:
        """Fields of `SessionPlan` that it fills, beside its settings."""
        return {}

    def panel(self, panel: Panel, view: PanelView, fact: Any) -> PanelView | None:
        """How a panel is shown; None: not at all."""
        return view
