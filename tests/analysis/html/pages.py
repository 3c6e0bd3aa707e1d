"""A page as a text."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from woz_tui.analysis.html.report_page import write
from woz_tui.analysis.session_reading import SessionReport


def render(reports: Sequence[SessionReport]) -> str:
    """The page of these sessions."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        write(reports, path)
        return path.read_text(encoding="utf-8")
