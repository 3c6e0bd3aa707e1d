"""Proposals in exports: each set is an interval."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={
        "suggest.asked": ("model", "answer"),
        "suggest.offered": ("source", "who"),
        "suggest.taken": ("how", "text"),
        "suggest.gone": ("how", ""),
    },
    points={
        "proposals": (
            "suggest.offered",
            "suggest.taken",
            "suggest.gone",
            "suggest.ranked",
            "suggest.asked",
            "suggest.state",
            "suggest.shown",
            "suggest.trial",
            "suggest.rehearsed",
        )
    },
    settings=("suggest.settings", "suggest.model"),
    kept={
        "suggest.settings": ("sources", "programs"),
        "suggest.offered": ("set", "source", "who", "cue"),
        "suggest.asked": ("cue", "model", "fingerprint", "prompt_sha256"),
        "suggest.state": ("how", "model"),
        "suggest.ranked": ("set", "reasons"),
        "suggest.taken": ("set", "item", "how", "run", "console"),
        "suggest.gone": ("set", "how"),
        "suggest.shown": ("set", "items", "console"),
        "suggest.rehearsed": ("cue", "items"),
    },
    ids=("set",),
    of_session=("suggest.settings", "suggest.model"),
)
