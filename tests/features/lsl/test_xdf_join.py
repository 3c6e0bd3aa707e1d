"""Log and recording meet line by line, and what they do not have alike is said."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.export.export_runs import export_logs
from tests.export.logs import start, write
from tests.features.lsl.xdf_file import WrittenStream, write_xdf
from woz_tui.export.log_sources import ExportError
from woz_tui.export.other_recording import OtherRecording
from woz_tui.protocol import messages as m

#: CLOCK_MONOTONIC of the robot at the session's beginning, in seconds.
ZERO = 5000.0
CLOCK: dict[str, str | int] = {"source": "CLOCK_MONOTONIC", "monotonic_us": int(ZERO * 1e6)}
EEG = WrittenStream("amp", "EEG", [(5010.0 + n / 10, 0.0) for n in range(50)], rate=10)

Line = dict[str, object]


def a_log(folder: Path) -> Path:
    """A log with a marker a second."""
    markers = ((float(at), m.Marker(text=f"m{at}")) for at in range(10, 20))
    return write(folder / "recordings", [(0, start(clock=CLOCK)), *markers])


def sent(
    log: Path, keep: Callable[[Line], bool] = lambda line: True, late: float = 0.0
) -> WrittenStream:
    """What was recorded of it, `late` behind its times."""
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    samples = [(ZERO + late + line["t"] / 1e6, json.dumps(line)) for line in lines if keep(line)]
    return WrittenStream("woz-events", "Events", samples, woz={"session": "S01"})


def joined(log: Path, *streams: WrittenStream, stream: str = "") -> tuple[list[str], list[float]]:
    """What is said of the join, and the onsets of the markers."""
    file = write_xdf(log.parent.parent / "lab.xdf", *streams)
    out = log.parent.parent / "out"
    (summary,) = export_logs(log, "bids", out, force=True, recording=OtherRecording(file, stream))
    (events,) = out.rglob("*_events.tsv")
    rows = [row.split("\t") for row in events.read_text().splitlines()]
    kind, onset = rows[0].index("trial_type"), rows[0].index("onset")
    return summary.notes, [float(row[onset]) for row in rows if row[kind] == "marker"]


def test_what_is_whole_is_said_so(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    notes, onsets = joined(log, sent(log), EEG)
    assert notes == [
        "lab.xdf: of numbers 0 to 11, 12 of 12 lines that were sent are recorded; their times"
        " differ from the log by 0.0 µs at the most",
        "onset 0 is the first value of the stream amp (EEG); the session began 10.000 s before it",
    ]
    assert onsets == pytest.approx([*map(float, range(10))], abs=1e-6)


def test_what_is_missing_is_named_and_moves_nothing(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    notes, onsets = joined(log, sent(log, lambda line: line["seq"] not in (4, 5)), EEG)
    assert "10 of 12 lines" in notes[0]
    assert notes[1] == "lab.xdf lacks 2 marker; the first is number 4"
    assert onsets == pytest.approx([*map(float, range(10))], abs=1e-6)


def test_a_recording_that_began_late_lacks_nothing(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    notes, _ = joined(log, sent(log, lambda line: line["t"] > 12_000_000), EEG)  # type: ignore[operator]
    assert notes[0].startswith("lab.xdf: of numbers 4 to 11, 8 of 8 lines")


def test_clocks_of_two_computers_are_brought_together(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    ours = sent(log)
    away = WrittenStream(
        "amp",
        "EEG",
        [(10.0 + n / 10, 0.0) for n in range(50)],
        rate=10,
        host="amplifier",
        offsets=(5000.0, 5000.0005, 5000.003),
    )
    near = WrittenStream("woz-events", "Events", ours.samples, woz=ours.woz, offsets=(0.0, 0.0))
    notes, onsets = joined(log, near, away)
    assert onsets == pytest.approx([at - 0.0005 for at in range(10)], abs=1e-6)
    assert "the clock of amplifier is -5000000.500 ms from that of lab" in notes
    assert any("changed by 3.0 ms" in note for note in notes)


def test_without_lines_the_zero_of_the_clock_joins(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    about = {"session": "S01", "monotonic_us": str(CLOCK["monotonic_us"])}
    markers = WrittenStream("woz-markers", "Markers", [(5011.0, "mark")], woz=about)
    notes, onsets = joined(log, markers, EEG)
    assert notes[0] == "lab.xdf has no line of the log: joined by the zero of its clock"
    assert onsets[0] == pytest.approx(0.0, abs=1e-6)


def test_the_stream_can_be_chosen(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    pulse = WrittenStream("pulse", "HR", [(5012.0, 70.0), (5013.0, 71.0)], host="lab")
    _, onsets = joined(log, sent(log), EEG, pulse, stream="pulse")
    assert onsets[0] == pytest.approx(-2.0, abs=1e-6)


def test_another_session_of_the_same_code_is_not_taken_for_this_one(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    other = write(
        tmp_path / "others",
        [(0, start(clock={"monotonic_us": 1})), *((n + 0.5, m.Marker(text="x")) for n in range(9))],
    )
    lines = sent(other, lambda line: line["seq"] != 0)
    with pytest.raises(ExportError, match="has no line of the session S01"):
        joined(log, lines, EEG)


def test_a_recording_without_others_or_without_us_is_refused(tmp_path: Path) -> None:
    log = a_log(tmp_path)
    with pytest.raises(ExportError, match="no values of another program"):
        joined(log, sent(log))
    with pytest.raises(ExportError, match="no stream of a session"):
        joined(log, EEG)
