"""The page for researchers says what the code computes."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

from woz_tui.analysis.acts import BY_MACHINE
from woz_tui.analysis.cues import ECHO_US, WAITING, WINDOW_US
from woz_tui.analysis.figures import Part
from woz_tui.analysis.measures import MEASURES
from woz_tui.analysis.reference import refreshed
from woz_tui.analysis.rows import CUE_FATES, CUE_SORTS
from woz_tui.analysis.tidy import dictionary
from woz_tui.sensing.machine import ENGAGED
from woz_tui.timeline.episodes import NOT_COUNTED

PAGE = Path(__file__).parents[2] / "docs" / "report.md"
TEXT = PAGE.read_text(encoding="utf-8")
WORDS = " ".join(TEXT.split())


def test_the_tables_are_fresh() -> None:
    assert refreshed(TEXT) == TEXT, "run `python -m woz_tui.analysis.reference docs/report.md`"


def test_every_figure_has_a_row_and_no_other() -> None:
    table = TEXT.partition("### Main figures")[2].partition("###")[0]
    named = re.findall(r"^\| `(\w+)` \|", table, re.M)
    assert named == [measure.name for measure in MEASURES]


def test_every_column_has_a_row() -> None:
    for _, column, _, _ in dictionary():
        assert f"`{column}`" in TEXT or column == "(item)", column


def test_units_stand_in_the_names() -> None:
    for measure in MEASURES:
        for unit in ("s", "ms"):
            assert (measure.unit == unit) == measure.name.endswith(f"_{unit}"), measure.name
        assert measure.meaning, measure.name
    assert len({measure.name for measure in MEASURES}) == len(MEASURES)


def test_every_total_of_a_part_is_a_figure() -> None:
    """What is added up and not told would be a figure that nobody sees."""
    told = {
        "us": "duration_s",
        "counts": "actions",
        "by_hand": "actions_by_hand",
        "direct": "direct_commands",
        "press": "press_median_ms",
        "took": "action_median_s",
        "gaps": "gap_median_s",
        "reactions": "reaction_median_s",
        "engagement": "engaged_share",
        "speech": "utterances",
        "held": "actions_held",
        "settings_us": "settings_known_s",
        "differing_us": "settings_differ_s",
        "verbs": "dispatch_median_ms",
    }
    for field in fields(Part):
        if field.name not in ("participant", "condition"):
            assert f"`{told.get(field.name, field.name)}`" in TEXT, field.name


def test_the_rules_are_those_of_the_code() -> None:
    assert f"within this time ({WINDOW_US // 1_000_000})" in WORDS
    assert ECHO_US == 1_000_000
    assert "A cue that comes within a second of another one" in WORDS
    for name in (*CUE_FATES, *CUE_SORTS):
        assert f"| `{name}` |" in TEXT
    for name in (*BY_MACHINE, *NOT_COUNTED, *WAITING):
        assert f"`{name}`" in TEXT
    share = next(measure for measure in MEASURES if measure.name == "engaged_share")
    for state in ENGAGED:
        assert state.value in share.meaning


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="marks"):
        refreshed("no tables here")
