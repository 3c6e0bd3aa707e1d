"""Which profiles there are, and what the one in use leaves of the panels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msgspec.structs import replace

from woz_tui.config.experiment import Experiment, Panel
from woz_tui.features.profiles.section import FIELDS, PROFILES, Profile
from woz_tui.host.feature_view import FeatureView
from woz_tui.protocol.panels import PanelView
from woz_tui.protocol.welcome import Allowance


class ProfileView(FeatureView):
    """What the profile does not allow is locked, or left out where it says `hide`."""

    def settings(self, experiment: Experiment, fact: Profile | None) -> Mapping[str, Any]:
        known = PROFILES.of(experiment)
        allows = {}
        for name, profile in known.items():
            named = {field: sorted(getattr(profile, field)) for field in FIELDS if field != "hide"}
            allows[name] = Allowance(**named, hide=profile.hide)
        return {
            "profiles": [*known],
            "profile": fact.name if fact is not None else "",
            "allows": allows,
        }

    def panel(self, panel: Panel, view: PanelView, fact: Profile | None) -> PanelView | None:
        if fact is None:
            return view
        allowed = {action.name for action in panel.actions if fact.plays(action)}
        actions = [
            replace(action, locked=action.locked or action.name not in allowed)
            for action in view.actions
            if action.name in allowed or not fact.hide
        ]
        if fact.hide and not actions:
            return None
        return replace(view, actions=actions, locked=view.locked or not allowed)


VIEW = ProfileView()
