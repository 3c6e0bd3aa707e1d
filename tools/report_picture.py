"""Draws the picture of the HTML report: `python -m tools.report_picture [file]`.

A browser without a window opens the report of the sample session in recordings/. Needs the programs
chromium and chromedriver.
"""

from __future__ import annotations

import base64
import io
import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image

from tests.analysis.html.browser import Page, browser
from tools import IMAGES
from tools.sample_session import SAMPLE
from woz_tui.analysis.html.report_page import write
from woz_tui.analysis.html.timeline_items import rows
from woz_tui.analysis.session_reading import ReportExtras, SessionReport, read_report

FILE = IMAGES / "report.png"
WIDTH, HEIGHT = 1280, 960
#: The action that is pointed at.
SHOWN = "Welcome"


def shot(page: Page, report: SessionReport, folder: Path) -> bytes:
    """The report's upper part, with the details of one action, as PNG."""
    write([report], folder / "report.html")
    assert report.timeline is not None
    items = [item for row in rows(report.timeline) for item in row.items]
    number = next(item.number for item in items if item.label == SHOWN)
    page.size(WIDTH, HEIGHT)
    page.driver.execute_cdp_cmd("Emulation.setScrollbarsHidden", {"hidden": True})
    page.open(folder / "report.html", f"#t=0-{report.timeline.duration_us / 1e6}&n={number}")
    page.run("scrollTo(0, 0)")
    page.view()
    taken = page.driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})
    return base64.b64decode(taken["data"])


def main() -> None:
    """Draw it."""
    missing = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    if missing:
        sys.exit(f"Needs {' and '.join(missing)}: sudo apt-get install chromium chromium-driver")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "profile").mkdir()
        report = read_report(SAMPLE, extras=ReportExtras(timeline=True, curves=True))
        with browser(folder / "profile") as page:
            picture = Image.open(io.BytesIO(shot(page, report, folder)))
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    picture.convert("RGB").save(file, optimize=True)


if __name__ == "__main__":
    main()
