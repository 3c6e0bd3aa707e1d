"""The file's script, as consoles are told of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.config.experiment import Experiment
from woz_tui.features.scripts.section import SCRIPT
from woz_tui.host.feature_view import FeatureView


class ScriptView(FeatureView):
    """Where it stands is said by the messages that still hold; phases tell of their own."""

    def plan(self, experiment: Experiment) -> Mapping[str, Any]:
        return {"script": [*SCRIPT.of(experiment)]}


VIEW = ScriptView()
