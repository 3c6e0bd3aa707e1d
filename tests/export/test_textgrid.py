"""Praat's files, read back with praatio, which knows nothing of woz."""

from __future__ import annotations

import wave
from itertools import pairwise
from pathlib import Path

import pympi
from hypothesis import HealthCheck, given, settings
from praatio import textgrid
from praatio.data_classes.interval_tier import IntervalTier
from praatio.data_classes.point_tier import PointTier
from praatio.data_classes.textgrid import Textgrid

from tests.export.export_runs import course_to, export_logs
from tests.export.logs import STEM, Timed, courses, session_of, speak, start, visit, write
from woz_tui.export.textgrid import for_praat
from woz_tui.protocol import messages as m
from woz_tui.system.text_cleaning import one_line


def read_back(path: Path) -> Textgrid:
    return textgrid.openTextgrid(str(path), includeEmptyIntervals=True, reportingMode="error")


def tier_annotations(tier: IntervalTier | PointTier) -> list[tuple[float, float, str]]:
    """What was annotated: beginning, end, text."""
    if isinstance(tier, PointTier):
        # praatio leaves quotes of points doubled, as Praat writes them; those of intervals not.
        marks = [(point.time, point.label.replace('""', '"')) for point in tier.entries]
        return [(time, time, mark) for time, mark in marks]
    return [(i.start, i.end, i.label) for i in tier.entries if i.label]


def test_a_visit_comes_back(tmp_path: Path) -> None:
    grid = read_back(course_to(tmp_path, "textgrid", visit()) / f"{STEM}.TextGrid")
    tiers = {name: tier_annotations(grid.getTier(name)) for name in grid.tierNames}
    assert tiers["engagement"] == [(0, 1, "Idle"), (1, 11, "Engaged")]
    assert tiers["panel Gestures"] == [(6, 6.001, "Nod [refused]"), (11, 11.001, "Dance [open]")]
    assert tiers["robot speech"] == [(2.011, 3.5, 'Hello, "dear"␉visitor!␊Ça va? <&>')]
    assert tiers["markers"] == [(6.2, 6.2, "=1+1")]
    assert tiers["markers-2"] == [(6.2, 6.2, "smile")]
    assert tiers["notes"] == [(6.3, 6.3, "a child␊has joined")]
    assert isinstance(grid.getTier("notes"), PointTier)


def check_cover(grid: Textgrid) -> None:
    """Every interval tier goes from beginning to end without a gap or an overlap."""
    for name in grid.tierNames:
        tier = grid.getTier(name)
        assert (tier.minTimestamp, tier.maxTimestamp) == (grid.minTimestamp, grid.maxTimestamp)
        if isinstance(tier, IntervalTier):
            assert tier.entries[0].start == grid.minTimestamp == 0
            assert tier.entries[-1].end == grid.maxTimestamp
            assert all(one.end == other.start for one, other in pairwise(tier.entries))
            assert all(interval.start < interval.end for interval in tier.entries)
        else:
            assert all(one.time < other.time for one, other in pairwise(tier.entries))


@settings(suppress_health_check=list(HealthCheck))
@given(courses())
def test_any_course_covers_its_time_and_comes_back(tmp_path: Path, course: list[Timed]) -> None:
    grid = read_back(course_to(tmp_path, "textgrid", course) / f"{STEM}.TextGrid")
    check_cover(grid)
    expected = for_praat(session_of(tmp_path, course))
    assert list(grid.tierNames) == [one_line(tier.name) for tier in expected]
    for tier in expected:
        # praatio takes blanks around a text away
        spans = [
            (s.begin / 1e6, s.begin / 1e6 if tier.points else s.end / 1e6, one_line(s.text).strip())
            for s in tier.spans
        ]
        assert tier_annotations(grid.getTier(one_line(tier.name))) == spans


def test_pympi_reads_the_same(tmp_path: Path) -> None:
    path = course_to(tmp_path, "textgrid", visit()) / f"{STEM}.TextGrid"
    grid, other = read_back(path), pympi.Praat.TextGrid(str(path), codec="utf-8")
    assert [tier.name for tier in other.get_tiers()] == list(grid.tierNames)
    for tier in other.get_tiers():
        spans = [(*row[:-1], row[-1].replace('""', '"')) for row in tier.get_all_intervals()]
        ours = grid.getTier(tier.name)
        if isinstance(ours, PointTier):
            assert spans == [(time, text) for time, _, text in tier_annotations(ours)]
        else:
            assert [span for span in spans if span[2]] == tier_annotations(ours)


def test_sound_and_grid_last_equally_long(tmp_path: Path) -> None:
    recordings = tmp_path / "recordings"
    speak(recordings / f"{STEM}.media", "speech-1.wav", 2)
    speech_ended = m.SpeechEnded(
        driver="ears",
        segment=1,
        began=1_000_000,
        ended=3_000_000,
        file=f"{STEM}.media/speech-1.wav",
    )
    export_logs(write(recordings, [(0, start()), (3, speech_ended)]), "textgrid", tmp_path / "out")
    with wave.open(str(tmp_path / "out" / f"{STEM}.wav")) as file:
        seconds = file.getnframes() / file.getframerate()
    assert read_back(tmp_path / "out" / f"{STEM}.TextGrid").maxTimestamp == seconds == 3
