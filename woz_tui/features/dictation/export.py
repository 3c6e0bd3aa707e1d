"""Dictation in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={"dictated": ("dictation", "text"), "dictated.said": ("command", "")},
    points={"dictation": ("dictated", "dictated.said")},
    kept={"dictated.said": ("command",)},
    ids=("dictation",),
)
