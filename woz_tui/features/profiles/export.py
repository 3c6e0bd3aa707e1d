"""Changes of profile in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={"profile.changed": ("profile", "")},
    settings=("profile.changed",),
    kept={"profile.changed": ("profile",)},
    of_session=("profile.changed",),
)
