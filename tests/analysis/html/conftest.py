"""One browser for all of these tests, one page for each kind of session."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.analysis.html.browser import Page, browser
from tests.analysis.html.sessions import hostile, ordinary
from woz_tui.analysis.html.report_page import write


@pytest.fixture(scope="session")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture(scope="module")
def single(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of one session."""
    folder = tmp_path_factory.mktemp("single")
    write([ordinary().report(folder)], folder / "report.html")
    return folder / "report.html"


@pytest.fixture(scope="module")
def several(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of three sessions in two conditions."""
    folder = tmp_path_factory.mktemp("several")
    stories = (
        ordinary("P01", "warm", "S01", 1.5),
        ordinary("P02", "cold", "S02", 0.2),
        ordinary("P03", "warm", "S03", 0.9),
    )
    write([story.report(folder) for story in stories], folder / "report.html")
    return folder / "report.html"


@pytest.fixture(scope="module")
def attack(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of two sessions in which every text is hostile."""
    folder = tmp_path_factory.mktemp("attack")
    report = hostile().report(folder)
    write([report, report], folder / "report.html")
    return folder / "report.html"
