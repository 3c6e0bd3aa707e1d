"""Streams of the Lab Streaming Layer in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={
        "lsl.stream": ("stream", ""),
        "lsl.found": ("stream", ""),
        "lsl.lost": ("stream", "why"),
        "lsl.clock": ("stream", ""),
    },
    points={"streams": ("lsl.stream", "lsl.found", "lsl.lost")},
    kept={
        "lsl.settings": ("prefix", "sensors", "shares"),
        **dict.fromkeys(("lsl.stream", "lsl.found"), ("stream", "type")),
        **dict.fromkeys(("lsl.lost", "lsl.clock"), ("stream",)),
    },
    of_session=("lsl.settings", "lsl.stream", "lsl.found", "lsl.lost", "lsl.clock"),
)
