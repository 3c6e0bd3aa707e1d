"""Fields of participants, as consoles are told of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.config.experiment import Experiment
from woz_tui.features.people.section import PEOPLE
from woz_tui.host.feature_view import FeatureView


class PeopleView(FeatureView):
    """Which there are; what is known of whom is said by messages."""

    def settings(self, experiment: Experiment, fact: Any) -> Mapping[str, Any]:
        fields = PEOPLE.of(experiment).fields
        return {"participant_fields": {name: [*words] for name, words in fields.items()}}


VIEW = PeopleView()
