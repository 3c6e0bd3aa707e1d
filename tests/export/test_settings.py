"""Robots' settings in all formats, read back by programs that know nothing of woz."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from tests.analysis.test_setting_differences import COURSES
from tests.export.export_runs import course_to, export_logs
from tests.export.logs import STEM, Timed, session_of, start, write
from tests.export.test_bids import table
from tests.export.test_csv import Rows, check_dictionary, plain, read_back
from tests.export.test_eaf import read_back as read_eaf
from tests.export.test_textgrid import check_cover, tier_annotations
from tests.export.test_textgrid import read_back as read_grid
from woz_tui.analysis.session_reading import read_report
from woz_tui.export.redaction import PLACEHOLDER, redacted
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

BLINKS = "blinking darkens the eyes"


def settings_shown(
    wanted: dict[str, Json] | None = None, *conflicts: str, **values: Json
) -> m.SettingsShown:
    return m.SettingsShown(
        driver="pepper", values=values, wanted=wanted or {}, conflicts=list(conflicts)
    )


def drifting() -> list[Timed]:
    """Blinking comes on in the trial; the robot is lost after it, and blinks when it is back."""
    return [
        (0, start()),
        (1, settings_shown(robot="tcp://10.0.0.7", blinking=False, volume=-0.5)),
        (2, m.TrialStarted(trial=1, condition="cold")),
        (
            3,
            settings_shown(
                {"blinking": False}, BLINKS, robot="tcp://10.0.0.7", blinking=True, volume=-0.5
            ),
        ),
        (6, m.TrialEnded(trial=1, outcome="done")),
        (7, m.DriverLost(driver="pepper")),
        (9, m.DriverConnected(driver="pepper")),
        (10, m.Note(text="over")),
    ]


def of(rows: Rows, setting: str) -> list[tuple[str, ...]]:
    columns = ("trial", "onset", "duration", "value", "wanted", "differs", "changed")
    return [tuple(row[name] for name in columns) for row in rows if row["setting"] == setting]


def test_every_change_is_a_row(tmp_path: Path) -> None:
    out = course_to(tmp_path, "csv", drifting())
    check_dictionary(out)
    rows = read_back(out / "settings.csv")
    assert of(rows, "blinking") == [
        ("", "1.000000", "1.000000", "false", "", "false", "true"),
        ("1", "2.000000", "1.000000", "false", "", "false", "false"),
        ("1", "3.000000", "3.000000", "true", "false", "true", "true"),
        ("", "6.000000", "1.000000", "true", "false", "true", "false"),
        ("", "7.000000", "2.000000", "", "", "", "true"),
        ("", "9.000000", "1.000000", "true", "false", "true", "true"),
    ]
    assert of(rows, "volume")[0][3] == "-0.5", "a number is no formula"
    (first, *_) = rows
    assert (first["log"], first["participant"], first["driver"]) == (STEM, "P07", "pepper")


def test_differences_and_conflicts_are_events(tmp_path: Path) -> None:
    rows = read_back(course_to(tmp_path, "csv", drifting()) / "events.csv")
    found = [
        (row["kind"], row["label"], row["onset"], row["duration"], row["text"], row["outcome"])
        for row in rows
        if row["kind"] in ("difference", "conflict")
    ]
    words = "true, wanted false"
    assert sorted(found) == [
        ("conflict", "", "3.000000", "3.000000", BLINKS, ""),
        ("conflict", "", "6.000000", "1.000000", BLINKS, ""),
        ("conflict", "", "9.000000", "1.000000", BLINKS, "open"),
        ("difference", "blinking", "3.000000", "3.000000", words, ""),
        ("difference", "blinking", "6.000000", "1.000000", words, "lost"),
        ("difference", "blinking", "9.000000", "1.000000", words, "open"),
    ]


def test_elan_reads_the_tiers(tmp_path: Path) -> None:
    tiers = read_eaf(course_to(tmp_path, "eaf", drifting()) / f"{STEM}.eaf")
    words = "pepper blinking true, wanted false"
    times = [(3000, 6000), (6000, 7000), (9000, 10000)]
    assert tiers["settings that differ"] == [(*time, words) for time in times]
    assert tiers["conflicts"] == [(*time, f"pepper {BLINKS}") for time in times]


def test_praat_reads_the_tiers(tmp_path: Path) -> None:
    grid = read_grid(course_to(tmp_path, "textgrid", drifting()) / f"{STEM}.TextGrid")
    check_cover(grid)
    words = "pepper blinking true, wanted false"
    assert tier_annotations(grid.getTier("settings that differ")) == [
        (3, 6, words),
        (6, 7, words),
        (9, 10, words),
    ]


def test_bids_has_the_events_and_says_what_they_are(tmp_path: Path) -> None:
    out = course_to(tmp_path, "bids", drifting())
    [path] = out.rglob("*_events.tsv")
    rows = [row for row in table(path) if row["trial_type"] == "difference"]
    assert [(row["onset"], row["label"], row["trial"]) for row in rows] == [
        ("3.000000", "blinking", "1"),
        ("6.000000", "blinking", "n/a"),
        ("9.000000", "blinking", "n/a"),
    ]
    assert "differed from the requested" in path.with_suffix(".json").read_text(encoding="utf-8")


@settings(suppress_health_check=list(HealthCheck))
@given(COURSES)
def test_rows_of_a_setting_follow_one_another_to_the_end(
    tmp_path: Path, messages: list[tuple[m.Message, int]]
) -> None:
    """And they are those of the report, and what of them differs is what the events say."""
    course: list[Timed] = [(0, start())]
    for message, after in messages:
        course.append((course[-1][0] + after, message))
    session = session_of(tmp_path, course)
    for key in {(each.driver, each.setting) for each in session.figures.settings}:
        rows = [each for each in session.figures.settings if (each.driver, each.setting) == key]
        assert [each.end for each in rows] == [*(each.begin for each in rows[1:]), session.duration]
        assert rows[0].changed
    differing = [each for each in session.figures.settings if each.differs]
    events = [each for each in session.events if each.kind == "difference"]
    assert sorted((each.begin, each.end, each.setting, each.trial) for each in differing) == sorted(
        (each.begin, each.end or 0, each.label, -1 if each.trial is None else each.trial)
        for each in events
    )
    assert read_report(tmp_path / f"{STEM}.jsonl").figures.settings == session.figures.settings


def test_a_log_that_is_torn_is_exported_up_to_its_last_line(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", drifting(), ended=False)
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[:5]) + lines[5][:30])
    export_logs(log, "csv", tmp_path / "out")
    rows = of(read_back(tmp_path / "out" / "settings.csv"), "blinking")
    assert rows[-1] == ("1", "3.000000", "3.000000", "true", "false", "true", "true")


def test_a_setting_that_is_named_no_more_is_changed_and_not_lost(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, settings_shown({"blinking": False}, blinking=True, volume=0.5)),
        (2, settings_shown(volume=0.5)),
        (3, m.Note(text="over")),
    ]
    session = session_of(tmp_path, course)
    (difference,) = [each for each in session.events if each.kind == "difference"]
    assert (difference.begin, difference.end, difference.outcome) == (1_000_000, 2_000_000, "")
    rows = [
        (each.begin, each.differs)
        for each in session.figures.settings
        if each.setting == "blinking"
    ]
    assert rows == [(1_000_000, True), (2_000_000, None)]


def test_published_settings_keep_numbers_words_and_colours_and_no_address(tmp_path: Path) -> None:
    values: dict[str, Json] = {
        "robot": "tcp://10.0.0.7",
        "state": "solitary",
        "eyes": "#00ff80",
        "volume": 0.8,
        "awareness": True,
        "tablet": "Anna",
    }
    wanted: dict[str, Json] = {"state": "disabled", "volume": 0.6, "engagement": "as Anna likes"}
    told = m.SettingsShown(
        driver="pepper", values=values, wanted=wanted, conflicts=["Anna fights Ben"]
    )
    out = tmp_path / "out"
    export_logs(write(tmp_path / "in", [(0, start()), (1, told)]), "csv", out, redact=True)
    rows = read_back(out / "settings.csv")
    assert {row["setting"]: (plain(row["value"]), row["wanted"]) for row in rows} == {
        "robot": (PLACEHOLDER, ""),
        "state": ("solitary", "disabled"),
        "eyes": ("#00ff80", ""),
        "volume": ("0.8", "0.6"),
        "awareness": ("true", ""),
        "tablet": (PLACEHOLDER, ""),
        "engagement": ("null", PLACEHOLDER),
    }
    for path in out.iterdir():
        assert "Anna" not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "value", ["Anna Smith", "a" * 21, "#00ff8", "x1", {"state": "solitary"}, ["solitary"]]
)
def test_what_is_no_lone_word_goes_wherever_it_stands(value: Json) -> None:
    line = {"kind": "settings.shown", "values": {"state": value}, "wanted": {"state": value}}
    assert "solitary" not in str(redacted(line))
    assert str(value) not in str(redacted(line))
    elsewhere = {"kind": "body.changed", "values": {"state": "solitary"}}
    assert redacted(elsewhere)["values"] == {"state": PLACEHOLDER}
