"""The report of a session that is over, for those who watched it."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

#: What the report's page may do is in the page itself; nobody may show it in a frame.
HEADERS = {"Content-Security-Policy": "frame-ancestors 'none'; form-action 'none'"}


class DebriefError(Exception):
    """There is no report; the text says why."""


async def report_of(log: Path) -> str:
    """The page that `woz report` makes of a log. Raises `DebriefError`."""
    with TemporaryDirectory() as folder:
        page = Path(folder) / "report.html"
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", "report", str(log), "--html", str(page)),
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        _, said = await process.communicate()
        if not page.exists():
            raise DebriefError(said.decode(errors="replace").strip() or f"no report of {log}")
        return page.read_text(encoding="utf-8")
