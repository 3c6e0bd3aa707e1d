"""Exporting in the tests."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tests.export.logs import Timed, write
from woz_tui.export.export_run import export
from woz_tui.export.exporter import ExportOptions, SessionSummary
from woz_tui.export.log_sources import find_sources


def export_logs(
    given: Path | list[Path], to: str, out: Path, *, force: bool = False, **options: object
) -> list[SessionSummary]:
    """Export; what was told of each session."""
    paths = given if isinstance(given, list) else [given]
    return list(export(find_sources(paths)[0], to, out, ExportOptions(**options), force=force))  # type: ignore[arg-type]


def course_to(folder: Path, to: str, course: Iterable[Timed], **options: object) -> Path:
    """A course recorded and exported; the folder of the export."""
    out = folder / f"out-{to}"
    export_logs(write(folder / "recordings", course), to, out, force=True, **options)
    return out
