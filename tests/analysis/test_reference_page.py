"""The page for researchers says what the code computes."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

from tools.tables_reference import TABLES
from woz_tui.analysis.cue_responses import ECHO_US, WAITING, WINDOW_US
from woz_tui.analysis.event_rows import BY_MACHINE, CUE_RESULTS, CUE_TYPES
from woz_tui.analysis.figures import PartFigures
from woz_tui.analysis.measures import MEASURES
from woz_tui.analysis.tables import CONDITIONS
from woz_tui.sensing.state_machine import ENGAGED
from woz_tui.timeline.episodes import LEFT_OUT

DOCS = Path(__file__).parents[2] / "docs" / "reference"
TEXT = (DOCS / "report.md").read_text(encoding="utf-8")
TABLES_PAGE = (DOCS / "tables.md").read_text(encoding="utf-8")
WORDS = " ".join(TEXT.split())


def test_every_figure_has_a_row_and_no_other() -> None:
    table = TABLES_PAGE.partition("## Main figures")[2].partition("##")[0]
    named = re.findall(r"^\| `(\w+)` \|", table, re.M)
    assert named == [measure.name for measure in MEASURES]


def test_columns_of_a_time_are_called_as_in_bids() -> None:
    """And none of them is called in another way in another table."""
    for table in TABLES:
        for column in table.columns:
            assert column.meaning, (table.name, column.name)
            if table is not CONDITIONS:
                assert not re.fullmatch("begin.*|t_s|end_s|length.*|.*(onset|ation)_s", column.name)


def test_units_stand_in_the_names() -> None:
    for measure in MEASURES:
        for unit in ("s", "ms"):
            named = measure.name.endswith(f"_{unit}") or (measure.name, unit) == ("duration", "s")
            assert (measure.unit == unit) == named, measure.name
        assert measure.meaning, measure.name
    assert len({measure.name for measure in MEASURES}) == len(MEASURES)


def test_every_total_of_a_part_is_a_figure() -> None:
    """What is added up and not told would be a figure that nobody sees."""
    told = {
        "us": "duration",
        "counts": "actions",
        "by_hand": "prepared_actions",
        "direct": "improvised_actions",
        "press": "press_median_ms",
        "took": "action_median_s",
        "gaps": "gap_median_s",
        "reactions": "reaction_median_s",
        "engagement": "engaged_share",
        "speech": "utterances",
        "times": "actions_held",
        "settings_us": "settings_known_s",
        "differing_us": "settings_differ_s",
        "verbs": "dispatch_median_ms",
        "wizards": "mistakes",
    }
    for field in fields(PartFigures):
        if field.name not in ("participant", "condition"):
            assert f"`{told.get(field.name, field.name)}`" in TABLES_PAGE, field.name


def test_the_rules_are_those_of_the_code() -> None:
    assert f"within the window (`--window`, {WINDOW_US // 1_000_000} s)" in WORDS
    assert ECHO_US == 1_000_000
    assert "A cue that comes within a second of another one" in WORDS
    for name in (*CUE_RESULTS, *CUE_TYPES):
        assert f"| `{name}` |" in TEXT
    for name in (*BY_MACHINE, *LEFT_OUT, *WAITING):
        assert f"`{name}`" in TEXT
    share = next(measure for measure in MEASURES if measure.name == "engaged_share")
    for state in ENGAGED:
        assert state.value in share.meaning
