"""Slots, as consoles are told of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msgspec.structs import replace

from woz_tui.config.experiment import Experiment, Panel
from woz_tui.features.slots.gate import SlotFact
from woz_tui.features.slots.section import SLOTS
from woz_tui.host.feature_view import FeatureView
from woz_tui.protocol.panels import PanelView
from woz_tui.protocol.welcome import SlotView


class SlotsView(FeatureView):
    """What they are, and which actions have which."""

    def settings(self, experiment: Experiment, fact: SlotFact | None) -> Mapping[str, Any]:
        return {
            "slots": {
                name: SlotView([*slot.offer], slot.heard, slot.keep if slot.is_kept else "")
                for name, slot in SLOTS.of(experiment).items()
            }
        }

    def panel(self, panel: Panel, view: PanelView, fact: SlotFact | None) -> PanelView | None:
        if fact is None:
            return view
        actions = [replace(each, slots=[*fact.of.get(each.name, ())]) for each in view.actions]
        return replace(view, actions=actions)


VIEW = SlotsView()
