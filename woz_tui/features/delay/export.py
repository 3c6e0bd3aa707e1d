"""The response delay in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={"action.held": ("sort", "")},
    settings=("shaping.changed",),
    of_session=("shaping.changed",),
)
