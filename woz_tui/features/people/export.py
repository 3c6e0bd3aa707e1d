"""What is known of participants, in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(label_and_text={"participant.described": ("participant", "")})
