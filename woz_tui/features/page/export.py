"""Pages in exports."""

from __future__ import annotations

from woz_tui.export.feature_export import FeatureExport

EXPORT = FeatureExport(
    label_and_text={
        "page.opened": ("address", ""),
        "page.failed": ("", "why"),
        "page.closed": ("address", ""),
    },
    points={"pages": ("page.opened", "page.failed", "page.closed")},
    kept={"page.opened": ("roles",)},
    of_session=("page.opened", "page.failed", "page.closed"),
)
