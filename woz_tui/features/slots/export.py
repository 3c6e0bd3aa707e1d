"""Slots in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={"slot.filled": ("slot", "text")},
    points={"slots": ("slot.filled",)},
    kept={"slot.filled": ("slot", "source", "keep")},
)
