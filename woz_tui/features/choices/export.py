"""Choices in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={
        "choice.offered": ("choice", "question"),
        "choice.made": ("choice", "option"),
        "choice.gone": ("choice", "how"),
    },
    points={"choices": ("choice.offered", "choice.made", "choice.gone")},
    kept={
        "choice.offered": ("choice", "options"),
        "choice.made": ("choice", "option"),
        "choice.gone": ("choice", "how"),
    },
)
