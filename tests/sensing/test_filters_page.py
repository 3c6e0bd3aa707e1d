"""The page about the filters lists the parameters and the picture that the program has."""

from __future__ import annotations

import re
from pathlib import Path

from benchmarks.engagement_filters import draw
from benchmarks.filters.bench_figures import measure
from woz_tui.config.engagement import EngagementSettings
from woz_tui.sensing import joint_dwell

PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "engagement-filters.md"


def test_the_pages_parameters_are_the_programs() -> None:
    rows = re.findall(r"^\| ([A-Z_]+) \| ([\d., ]+) \|", PAGE.read_text("utf-8"), re.MULTILINE)
    told = {name: tuple(float(number) for number in text.split(",")) for name, text in rows}
    held = {
        name: value if isinstance(value, tuple) else (value,)
        for name, value in vars(joint_dwell).items()
        if name.isupper() and name not in ("WORLDS", "CONDITIONS", "LONGEST")
    }
    assert told == held


def test_the_picture_is_drawn_by_the_program() -> None:
    """The figures on it take minutes; what stands around them must be what is drawn today."""
    svg = (PAGE.parents[1] / "images" / "engagement-delay.svg").read_text("utf-8")
    today = draw(measure(EngagementSettings(), runs=1))
    assert _around(svg) == _around(today)
    assert "2000 runs" in svg
    assert "--runs 2000" in PAGE.read_text("utf-8")


def _around(svg: str) -> list[str]:
    """Axes and words, without what was measured."""
    measured = re.compile("circle|polyline|runs|#0072B2|l7 7")
    return [line for line in svg.splitlines() if not measured.search(line)]
