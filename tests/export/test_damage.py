"""Torn, empty and flipped logs: nothing raises, and what is wrong is told in each format."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.example_counts import many
from tests.export.export_runs import export_logs
from tests.export.logs import SHA, STEM, Timed, start, visit, write
from tests.export.test_bids import validated
from tests.export.test_csv import check_dictionary, read_back
from tests.export.test_eaf import checked, properties
from tests.export.test_textgrid import check_cover
from tests.export.test_textgrid import read_back as read_grid
from tests.log.story import GOLDEN
from woz_tui.export.export_run import FORMATS
from woz_tui.export.log_sources import ExportError, find_sources, read_session
from woz_tui.protocol import messages as m

TOLD = "1 damaged line(s) left out"


def damaged(folder: Path) -> Path:
    """A log with a flipped bit in its fourth line."""
    log = write(folder, visit())
    lines = log.read_bytes().splitlines(keepends=True)
    lines[3] = b"\xff" + lines[3][1:]
    log.write_bytes(b"".join(lines))
    return log


@pytest.mark.parametrize("to", FORMATS)
def test_damage_is_told_wherever_somebody_looks(tmp_path: Path, to: str) -> None:
    out = tmp_path / "out"
    (session_summary,) = export_logs(damaged(tmp_path / "recordings"), to, out)
    assert TOLD in session_summary.session.damage
    assert f"damage: {TOLD}" in (out / "README.md").read_text(encoding="utf-8")


def test_damage_is_in_the_tables(tmp_path: Path) -> None:
    export_logs(damaged(tmp_path / "recordings"), "csv", tmp_path / "out")
    (session,) = read_back(tmp_path / "out" / "sessions.csv")
    assert TOLD in session["damage"]
    package = json.loads((tmp_path / "out" / "datapackage.json").read_text(encoding="utf-8"))
    assert TOLD in package["damage"][STEM]


def test_damage_is_in_the_sidecars(tmp_path: Path) -> None:
    export_logs(damaged(tmp_path / "recordings"), "bids", tmp_path / "out")
    validated(tmp_path / "out")
    (path,) = (tmp_path / "out").rglob("*_events.json")
    assert TOLD in json.loads(path.read_text(encoding="utf-8"))["Log"]["Damage"]


def test_damage_is_in_the_properties(tmp_path: Path) -> None:
    export_logs(damaged(tmp_path / "recordings"), "eaf", tmp_path / "out")
    assert ("damage", TOLD) in properties(tmp_path / "out" / f"{STEM}.eaf")


def test_a_line_that_is_gone_is_found_by_the_sums(tmp_path: Path) -> None:
    log = write(tmp_path, visit())
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[:5] + lines[6:]))
    (sentence,) = read_session(find_sources([log])[0][0]).damage
    assert sentence == "lines before the first checkpoint were changed or lost"


def test_a_good_checkpoint_says_up_to_where_all_is_well(tmp_path: Path) -> None:
    course: list[Timed] = [(0, start()), (1, m.Checkpoint(sha256=SHA, lines=1))]
    log = write(tmp_path, course)
    assert read_session(find_sources([log])[0][0]).damage == [
        "lines before the first checkpoint were changed or lost"
    ]
    assert read_session(find_sources([write(tmp_path, visit())])[0][0]).damage == []


@pytest.mark.parametrize("to", FORMATS)
@pytest.mark.parametrize(
    "content", [b"", b"\0" * 4096, b"{", b"\n\n", b'{"seq":0,"t":0,"kind":"note"}']
)
def test_a_log_with_nothing_in_it_is_exported_and_told(
    tmp_path: Path, content: bytes, to: str
) -> None:
    log = tmp_path / f"{STEM}.jsonl"
    log.write_bytes(content)
    (session_summary,) = export_logs(log, to, tmp_path / "out", samples=True)
    assert session_summary.session.damage


def test_an_empty_log_is_valid_everywhere(tmp_path: Path) -> None:
    log = tmp_path / f"{STEM}.jsonl"
    log.touch()
    for to in FORMATS:
        export_logs(log, to, tmp_path / to)
    check_dictionary(tmp_path / "csv")
    checked(tmp_path / "eaf" / f"{STEM}.eaf")
    validated(tmp_path / "bids")
    check_cover(read_grid(tmp_path / "textgrid" / f"{STEM}.TextGrid"))


@pytest.mark.parametrize("to", FORMATS)
def test_times_far_off_harm_nobody(tmp_path: Path, to: str) -> None:
    course: list[Timed] = [(0, start()), (1, m.StopPressed(source="key"))]
    log = write(tmp_path / "recordings", [*course, (9e12, m.Note(text="in 285,000 years"))])
    export_logs(log, to, tmp_path / "out", samples=True)
    if to == "eaf":
        checked(tmp_path / "out" / f"{STEM}.eaf")
    if to == "textgrid":
        check_cover(read_grid(tmp_path / "out" / f"{STEM}.TextGrid"))


@settings(max_examples=many(15), suppress_health_check=list(HealthCheck))
@given(st.data())
def test_whatever_happens_to_its_bytes_a_log_is_exported(
    tmp_path: Path, data: st.DataObject
) -> None:
    log = write(tmp_path / "recordings", visit())
    content = bytearray(log.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(content) - 1))
        match data.draw(st.sampled_from(["flip", "nul", "cut", "double"])):
            case "flip":
                content[place] ^= 1 << data.draw(st.integers(0, 7))
            case "nul":
                content[place : place + 40] = bytes(40)
            case "cut":
                del content[place : place + data.draw(st.integers(1, 400))]
            case "double":
                content[place:place] = content[place : place + 200]
        content = content or bytearray(b"\n")
    log.write_bytes(content)
    for to in FORMATS:
        export_logs(log, to, tmp_path / to, force=True, redact=data.draw(st.booleans()))
    (path,) = (tmp_path / "eaf").glob("*.eaf")
    checked(path)
    check_dictionary(tmp_path / "csv")
    (path,) = (tmp_path / "textgrid").glob("*.TextGrid")
    check_cover(read_grid(path))


def test_segments_are_one_session(tmp_path: Path) -> None:
    log = write(tmp_path, visit())
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[:10]))
    segment = m.Segment(log=STEM, session="S01", number=2, previous=log.name, reason="full")
    head = json.dumps({"kind": "segment", "log": segment.log, "session": "S01", "number": 2})
    (tmp_path / f"{STEM}.2.jsonl").write_bytes(head.encode() + b"\n" + b"".join(lines[8:]))
    sources, _ = find_sources([tmp_path])
    assert len(sources) == 1
    session = read_session(sources[0])
    assert (session.damage, session.lines) == ([], len(lines))


def test_a_segment_in_another_folder_is_no_session_of_its_own() -> None:
    sources, _ = find_sources([GOLDEN / "recordings", GOLDEN / "spill"])
    assert len(sources) == 1
    session = read_session(sources[0])
    assert (session.code, session.end_reason, session.damage) == ("S01", "wizard", [])


def test_what_is_no_log_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").touch()
    (tmp_path / "empty").mkdir()
    for given_path in (tmp_path / "notes.txt", tmp_path / "empty", tmp_path / "nowhere.jsonl"):
        with pytest.raises(ExportError, match=given_path.name):
            find_sources([given_path])
    with pytest.raises(ExportError, match="nothing to export"):
        find_sources([])
