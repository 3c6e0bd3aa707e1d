"""Phases in exports: each is an interval."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport
from woz_tui.features.phases.kinds import PhaseChanged

EXPORT = FeatureExport(parts=(PhaseChanged,))
