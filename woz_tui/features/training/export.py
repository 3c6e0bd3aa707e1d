"""Trainings in exports and publications of a log."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={"cue.given": ("sort", "text"), "cue.answered": ("judged", "")},
    points={"cues": ("cue.given", "cue.answered")},
    kept={"cue.given": ("cue", "expects"), "cue.answered": ("cue", "judged")},
    ids=("cue",),
    of_session=("training.changed",),
)
