"""From files to reports: damage is told, whatever is unreadable is named, sessions count once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.analysis.example_sessions import SECOND, STEM, ExampleSession
from woz_tui.analysis.report_tables import people
from woz_tui.analysis.session_reading import NoSessionError, ReportExtras, read_report
from woz_tui.export.log_sources import find_sources
from woz_tui.log.log_files import NO_END
from woz_tui.log.sessions import sessions_in
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

GOLDEN = Path(__file__).parents[1] / "log" / "golden"


def short() -> ExampleSession:
    return ExampleSession().act(1).act(3).act(5).end(10)


def test_a_whole_log_has_nothing_to_complain_of(tmp_path: Path) -> None:
    report = read_report(short().written(tmp_path), places=[])
    assert report.timeline is None
    assert report.figures.wholeness.sentences == ()
    assert report.figures.stem == STEM
    assert (report.figures.whole.actions, report.figures.ended) == (3, "enough")


def test_what_coders_set_beside_a_log_is_passed_over_in_a_pattern(tmp_path: Path) -> None:
    log = short().written(tmp_path)
    codes = log.with_name(f"{log.stem}.coding.jsonl")
    codes.write_text("{}\n")
    for named in ([str(tmp_path / "*.jsonl")], [str(log), str(codes)]):
        assert sessions_in(named) == ([log], [])
    assert [source.log for source in find_sources([codes, log])[0]] == [log]
    found, (problem,) = sessions_in([str(codes)])
    assert not found
    assert "name the log" in problem


def test_a_torn_log_tells_so_and_has_its_figures(tmp_path: Path) -> None:
    path = short().written(tmp_path)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) - 20])
    whole = read_report(path, places=[]).figures.wholeness
    assert (whole.left_out, whole.ended) == (1, False)
    assert whole.sentences[0] == "1 incomplete last line(s) removed"
    assert whole.sentences[-1] == NO_END
    assert read_report(path, places=[]).figures.whole.actions == 3


def test_a_damaged_line_costs_that_line_alone(tmp_path: Path) -> None:
    session = short()
    lines = session.lines()
    lines[1] = b"\xff" + lines[1]
    path = session.written(tmp_path)
    path.write_bytes(b"".join(lines))
    figures = read_report(path, places=[]).figures
    assert figures.whole.actions == 2
    assert figures.wholeness.left_out == 1
    assert figures.wholeness.sentences[0] == "1 damaged line(s) left out"


def test_a_second_segment_is_part_of_it_and_tells_why(tmp_path: Path) -> None:
    session = short()
    lines = session.lines()
    first = session.written(tmp_path)
    first.write_bytes(b"".join(lines[:8]))
    segment = m.Segment(
        log=STEM, session="S01", number=2, previous=first.name, reason="disk full", dropped=3,
        dropped_samples=9,
    )  # fmt: skip
    second = tmp_path / f"{STEM}.2.jsonl"
    second.write_bytes(codec.encode(segment) + b"".join(lines[6:]))
    for path in (first, second):
        figures = read_report(path, places=[]).figures
        assert figures.whole.actions == 3
        whole = figures.wholeness
        assert (whole.segments, whole.dropped, whole.dropped_samples) == (2, 3, 9)
        assert whole.sentences == (
            "3 line(s) of actions were never written",
            "9 sample(s) were never written",
            f"went on in {second.name}: disk full",
        )


def test_actions_without_an_end_are_told_of(tmp_path: Path) -> None:
    path = ExampleSession().act(1, took=None).end(5).written(tmp_path)
    assert read_report(path, places=[]).figures.wholeness.sentences == (
        "1 action(s) without an end",
    )


def test_checksums_are_checked_if_somebody_wants(tmp_path: Path) -> None:
    session = short()
    session.messages[-1] = m.SessionEnd(
        seq=len(session.messages) - 1, t=10, reason="x", sha256="00"
    )
    path = session.written(tmp_path)
    assert read_report(path, places=[]).figures.wholeness.left_out == 0
    checked = read_report(path, extras=ReportExtras(verified=True), places=[]).figures.wholeness
    assert checked.verified
    assert any("were changed or lost" in sentence for sentence in checked.sentences)


def test_what_is_no_log_is_named(tmp_path: Path) -> None:
    empty = tmp_path / f"{STEM}.jsonl"
    empty.touch()
    with pytest.raises(NoSessionError, match=f"{STEM}.jsonl: the file has no line of a session"):
        read_report(empty, places=[])
    other = tmp_path / "notes.txt"
    other.touch()
    with pytest.raises(ValueError, match=r"must end in \.jsonl"):
        read_report(other, places=[])
    with pytest.raises(FileNotFoundError, match="there is no such log"):
        read_report(tmp_path / "gone.jsonl", places=[])


def test_curves_come_from_samples(tmp_path: Path) -> None:
    path = short().written(tmp_path)
    sample = m.Reading(seq=99, t=2_000_000, sensor="loudness", value=0.5)
    (tmp_path / f"{STEM}.samples.jsonl").write_bytes(codec.encode(sample))
    timeline = read_report(path, extras=ReportExtras(curves=True), places=[]).timeline
    assert timeline is not None
    assert [(curve.sensor, curve.values[-1]) for curve in timeline.curves] == [("loudness", 0.5)]


def test_numbers_of_people_come_from_samples(tmp_path: Path) -> None:
    path = short().written(tmp_path)
    samples = [
        m.Reading(seq=99 + n, t=n * 1_000_000, sensor="people", value=float(n)) for n in range(3)
    ]
    (tmp_path / f"{STEM}.samples.jsonl").write_bytes(b"".join(map(codec.encode, samples)))
    figures = read_report(path, extras=ReportExtras(people=True), places=[]).figures
    assert [row[1:3] for row in people(figures).rows] == [("nobody", "0:01"), ("1", "0:01")]
    assert read_report(path, places=[]).figures.people == ()


def test_the_golden_log_can_be_reported(tmp_path: Path) -> None:
    for path in (GOLDEN / "v3").rglob("*.jsonl"):
        shutil.copy(path, tmp_path)
    [log], problems = sessions_in([str(tmp_path)])
    report = read_report(log, extras=ReportExtras(timeline=True, curves=True), places=[])
    assert problems == []
    assert report.figures.schema == 3
    assert report.figures.whole.actions > 0
    assert report.figures.whole.stops == 1
    assert report.timeline is not None
    assert report.timeline.lanes


# -- which sessions are meant ---------------------------------------------------------------------


def test_a_log_of_an_older_schema_is_named_and_left_out(tmp_path: Path) -> None:
    new = short().written(tmp_path, "2026-03-01T10-00-00_P01_S01")
    old = ExampleSession(session="S02").act(1).end(10)
    path = old.written(tmp_path, "2026-03-02T10-00-00_P02_S02")
    path.write_bytes(path.read_bytes().replace(b'"schema":3', b'"schema":1', 1))
    assert sessions_in([str(tmp_path)]) == (
        [new],
        [
            f"{path}: a log of schema 1, and this version reads 3 and later: woz-tui of the commit"
            " aef656da reads it"
        ],
    )


def test_folders_files_and_patterns(tmp_path: Path) -> None:
    one = short().written(tmp_path / "a", "2026-03-01T10-00-00_P01_S01")
    other = ExampleSession(session="S02").act(1).end(10)
    two = other.written(tmp_path / "a" / "b", "2026-03-02T10-00-00_P02_S02")
    (tmp_path / "a" / f"{one.stem}.samples.jsonl").touch()
    (tmp_path / "a" / f"{one.stem}.2.jsonl").touch()
    (tmp_path / "a" / "visitors.jsonl").write_text('{"name": "V01"}\n')
    assert sessions_in([str(tmp_path)]) == ([one, two], [])
    assert sessions_in([str(two), str(one), str(two)]) == ([one, two], [])
    assert sessions_in([str(tmp_path / "a" / "*S01*.jsonl")]) == ([one], [])
    samples = tmp_path / "a" / f"{one.stem}.samples.jsonl"
    assert sessions_in([str(samples)]) == ([one], [])


def test_what_leads_nowhere_is_named(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    text = tmp_path / "notes.txt"
    text.touch()
    paths, problems = sessions_in([str(empty), str(tmp_path / "gone"), str(text)])
    assert paths == []
    assert problems == [
        f"{empty}: there is no log in this folder",
        f"{tmp_path / 'gone'}: there is no such file, folder, or log of this pattern",
        f"{text}: the name of a log must end in .jsonl",
    ]


def test_a_segment_elsewhere_belongs_to_its_session(tmp_path: Path) -> None:
    one = short().written(tmp_path / "first")
    spill = tmp_path / "spill"
    spill.mkdir()
    alone = spill / f"{STEM}.2.jsonl"
    alone.write_bytes(codec.encode(m.Segment(log=STEM, session="S01", number=2)))
    assert sessions_in([str(spill), str(one)]) == ([one], [])
    assert sessions_in([str(spill)]) == ([alone], [])


def test_a_sample_behind_the_last_action_is_no_time_of_the_session(tmp_path: Path) -> None:
    path = ExampleSession().act(1).end(9).written(tmp_path)
    late = m.Reading(seq=99, t=20 * SECOND, sensor="distance", value=1.0)
    path.with_suffix(".samples.jsonl").write_bytes(codec.encode(late))
    drawn = read_report(path, extras=ReportExtras(timeline=True, curves=True))
    assert drawn.figures.duration_us == read_report(path).figures.duration_us == 9 * SECOND
    assert drawn.timeline is not None
    assert drawn.timeline.duration_us == 20 * SECOND, "the curve is within the picture"
