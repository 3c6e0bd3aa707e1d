"""Going about in a log: what was at a moment, and what came between two moments."""

from __future__ import annotations

import os
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.log.damaged_logs import ACTIONS, LINES, SAMPLES, engagement_line, note, sample, write_log
from tests.log.recorder_rig import STEM, RecorderRig, recorder_rig
from tests.log.test_golden import VERSIONS, first
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import Damage, LogItem, messages
from woz_tui.log.sample_blocks import SampleState, in_steady_series
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m


def numbers(items: object) -> list[int]:
    assert isinstance(items, list)
    return [item.seq for item in items]


def whole_log(folder: Path) -> Path:
    """A log with nothing wrong."""
    write_log(folder, SAMPLES, f"{STEM}.samples.jsonl")
    return write_log(folder, ACTIONS)


def open_index(path: Path) -> LogIndex:
    return LogIndex.open(path, places=[], block=2_000)


def reading(seq: int, t: int, sensor: str = "distance") -> bytes:
    return codec.encode(m.Reading(seq=seq, t=t, sensor=sensor, value=1.0))


def test_a_whole_log(tmp_path: Path) -> None:
    with open_index(whole_log(tmp_path)) as log:
        assert log.damage == Damage()
        assert log.length_us == (LINES - 1) * 10
        assert numbers(log.actions) == list(range(0, LINES, 10))
        assert numbers(list(log.between(-1, log.length_us))) == list(range(LINES))


def test_a_sensor_that_spoke_last_long_ago_is_still_known(tmp_path: Path) -> None:
    with open_index(whole_log(tmp_path)) as log:
        assert log.at(109).readings.keys() == {"distance", "gaze", "presence"}
        assert log.at(110).readings["identity"].seq == 11
        state = log.at(log.length_us)
        assert state.readings["identity"] == m.Reading(
            seq=11, t=110, sensor="identity", value=11 / 8
        )
        assert state.readings["distance"].seq == 699
        assert state.shown == codec.decode_message(engagement_line(687))


def test_before_anything_was_said(tmp_path: Path) -> None:
    with open_index(whole_log(tmp_path)) as log:
        assert log.at(-1) == log.at(0) == SampleState()
        assert list(log.between(-5, -1)) == []
        assert list(log.between(10**12, 10**13)) == []


def test_after_is_without_and_until_is_with_its_moment(tmp_path: Path) -> None:
    with open_index(whole_log(tmp_path)) as log:
        assert numbers(list(log.between(50, 100))) == [6, 7, 8, 9, 10]
        assert numbers(log.actions_between(50, 100)) == [10]
        assert numbers(list(log.samples_between(50, 100))) == [6, 7, 8, 9]
        assert list(log.between(100, 100)) == []


def test_what_comes_is_read_when_it_is_asked_for(tmp_path: Path) -> None:
    path = whole_log(tmp_path)
    with open_index(path) as log:
        stream = log.between(-1, log.length_us)
        assert next(stream).seq == 0
        os.truncate(tmp_path / f"{STEM}.samples.jsonl", 0)  # another program cuts it short
        rest = [item.seq for item in stream]
        assert set(range(0, LINES, 10)) - {0} <= set(rest), "actions are in memory"
        assert len(rest) < LINES / 2
        assert log.at(10**9).readings, "what it saw when it opened the log"


def test_a_closed_log_says_no_more_of_samples(tmp_path: Path) -> None:
    log = open_index(whole_log(tmp_path))
    log.close()
    with (tmp_path / "other").open("wb+") as other:  # takes the number of the file that was closed
        other.write(SAMPLES)
        other.flush()
        assert numbers(list(log.between(3_000, 3_100))) == [310]


def test_a_log_that_is_still_written(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        rig.sample(1.5)
        with LogIndex.open(rig.recorder.path, places=[]) as log:
            assert log.at(log.length_us).readings["distance"].value == 1.5
            rig.sample(2.5)
            assert log.at(log.length_us).readings["distance"].value == 1.5
        with rig.recorder.samples_path.open("ab") as file:
            file.write(b'{"kind":"sample","seq":9')
        with LogIndex.open(rig.recorder.path, places=[]) as log:
            assert log.at(log.length_us).readings["distance"].value == 2.5
            assert log.damage == Damage(torn=1, places=log.damage.places)


def test_a_session_in_two_folders(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        _move(rig)
        with LogIndex.open(rig.recorder.path, places=[rig.home, rig.spill]) as log:
            assert log.damage.skipped == log.damage.missing == 0
            assert numbers(list(log.between(-1, log.length_us))) == list(range(8))
            assert log.at(0).readings["distance"].value == 2.0
            assert log.at(log.length_us).readings["distance"].value == 4.0


def _move(rig: RecorderRig) -> None:
    for value in (1.0, 2.0):
        rig.note()
        rig.sample(value)
    rig.synced()
    rig.disk.gate.clear()
    rig.clock.advance(1.0)
    rig.sample(3.0)
    rig.disk.faults[rig.home] = "full"
    rig.note()
    rig.sample(4.0)
    rig.disk.gate.set()
    rig.note()
    rig.recorder.close()


@pytest.mark.parametrize("version", VERSIONS, ids=lambda version: version.name)
def test_golden_logs(version: Path) -> None:
    path, places = first(version), [version / "spill"]
    with LogIndex.open(path, places=places) as log:
        every = list(messages(path, places=places, samples=True))
        assert list(log.between(-1, log.length_us)) == every
        assert log.damage == Damage()
        assert log.at(log.length_us).readings.keys() == {"distance", "identity", "loudness"}
        assert log.at(log.length_us).shown is not None


def test_a_number_that_an_action_and_a_sample_have(tmp_path: Path) -> None:
    write_log(tmp_path, sample(1) + reading(2, 10) + sample(4), f"{STEM}.samples.jsonl")
    path = write_log(tmp_path, note(0) + note(2).replace(b'"t":20', b'"t":10') + note(5))
    with open_index(path) as log:
        assert (log.damage.conflicting, log.damage.gaps) == (1, [(3, 3)])
        assert numbers(list(log.between(-1, 100))) == [0, 1, 2, 4, 5]


def test_one_wild_time_costs_its_own_place_only(tmp_path: Path) -> None:
    lines = [sample(seq) for seq in range(400)]
    lines[150] = reading(150, 10**15, "gaze")
    lines[250] = reading(250, 3, "presence")
    path = write_log(tmp_path, b"".join(lines), f"{STEM}.samples.jsonl")
    with open_index(path) as log:
        assert log.length_us == 3_990
        assert log.damage.backwards == 2
        assert log.at(3_990).readings.keys() == {"distance", "presence"}
        assert log.at(3).readings.keys() == {"distance", "presence"}
        assert log.at(10**15).readings.keys() == {"distance", "presence", "gaze"}
        assert numbers(list(log.between(2, 20))) == [1, 2, 250]
        assert numbers(list(log.between(3_900, sys.maxsize)))[0] == 150


def test_a_wild_time_of_an_action(tmp_path: Path) -> None:
    lines = [note(seq) for seq in range(50)]
    lines[20] = lines[20].replace(b'"t":200', b'"t":900000000')
    with open_index(write_log(tmp_path, b"".join(lines))) as log:
        assert log.length_us == 490
        assert numbers(log.actions_between(180, 230)) == [19, 21, 22, 23]


SPANS = st.lists(
    st.tuples(st.integers(0, 20), st.integers(0, 5)).map(lambda s: (s[0], s[0] + s[1]))
)


@given(SPANS)
def test_the_longest_series_that_never_goes_back(spans: list[tuple[int, int]]) -> None:
    chosen = [span for span, fit in zip(spans, in_steady_series(spans), strict=True) if fit]
    assert all(one[1] <= other[0] for one, other in pairwise(chosen))
    best = [1] * len(spans)
    for place, (low, _) in enumerate(spans):
        before = [best[each] for each in range(place) if spans[each][1] <= low]
        best[place] = 1 + max(before, default=0)
    assert len(chosen) == max(best, default=0)


def test_items_are_messages(tmp_path: Path) -> None:
    with open_index(whole_log(tmp_path)) as log:
        found: list[LogItem] = list(log.between(60, 80))
    assert found == [
        codec.decode_message(engagement_line(7)),
        codec.decode_message(sample(8, "presence")),
    ]
