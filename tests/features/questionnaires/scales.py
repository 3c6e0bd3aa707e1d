"""What scales of many sessions amount to."""

from __future__ import annotations

from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.features.questionnaires.scales import GatheredScales, ItemTotal


def scale_totals(grouped: GroupedSessions, experiment: str) -> list[ItemTotal]:
    """Means of all scales of an experiment."""
    gathered = grouped.gathered["questionnaires"]
    assert isinstance(gathered, GatheredScales)
    return gathered.items(experiment)
