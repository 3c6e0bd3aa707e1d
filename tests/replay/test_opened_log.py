from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.replay.logs import SECOND, Viewer, distance, story
from woz_tui.log.log_index import LogIndex
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.replay.experiment_origin import origin_of
from woz_tui.replay.opened_log import (
    IndexedSamples,
    LogError,
    has_beginning,
    log_in,
    notes_of,
    open_log,
)
from woz_tui.replay.recording import Recording

STEM = "2026-03-01T10-00-00_P07_S01"
GOLDEN = Path(__file__).parent.parent / "log" / "golden"


def write_log(folder: Path, messages: list[m.Message] | None = None) -> Path:
    """A log in `folder`: its file of actions; the samples lie beside it."""
    path = folder / f"{STEM}.jsonl"
    lines, samples = b"", b""
    for message in story() if messages is None else messages:
        if codec.is_sample(message):
            samples += codec.encode(message)
        else:
            lines += codec.encode(message)
    path.write_bytes(lines)
    path.with_name(f"{STEM}.samples.jsonl").write_bytes(samples)
    return path


def viewer_and_notes(index: LogIndex) -> tuple[Viewer, tuple[str, ...]]:
    recording = Recording(index.actions, IndexedSamples(index))
    notes = notes_of(index, recording)
    return Viewer(recording, notes=notes), notes


def test_a_whole_log_is_played_with_its_samples(tmp_path: Path) -> None:
    with open_log(write_log(tmp_path)) as index:
        viewer, notes = viewer_and_notes(index)
        assert notes == ()
        viewer.wait(6, ticks=60)
        assert distance(viewer).t == 6 * SECOND
        viewer.go(42.2)
        assert distance(viewer).t == 42 * SECOND
        viewer.wait(30, ticks=30)
        assert viewer.player.ended


def test_any_file_of_the_session_will_do(tmp_path: Path) -> None:
    path = write_log(tmp_path)
    with open_log(path.with_name(f"{STEM}.samples.jsonl")) as index:
        assert has_beginning(index)


def test_of_a_folder_the_newest_session_is_taken(tmp_path: Path) -> None:
    older = write_log(tmp_path)
    newer = tmp_path / "2026-03-02T10-00-00_P08_S02.jsonl"
    newer.write_bytes(older.read_bytes())
    os.utime(older, (1, 1))
    assert log_in(tmp_path) == newer
    assert log_in(older) == older
    (tmp_path / "empty").mkdir()
    with pytest.raises(LogError, match="no log in this folder"):
        log_in(tmp_path / "empty")


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        (f"{STEM}.jsonl", b"", "is empty"),
        (f"{STEM}.jsonl", b"\0" * 300, "has no line of a session"),
        (f"{STEM}.jsonl", b"title: Museum guide\nrobot: simulated\n", "has no line of a session"),
        ("guide.yaml", b"title: Museum guide\n", "name of a log must end in .jsonl"),
    ],
)
def test_what_is_no_log_is_said(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(LogError, match=words):
        open_log(path)
    with pytest.raises(LogError, match="there is no such log"):
        open_log(tmp_path / "other.jsonl")


def _torn(data: bytes) -> bytes:
    return data[:-40]


def _nul(data: bytes) -> bytes:
    return data + b"\0" * 500


def _flipped(data: bytes) -> bytes:
    at = data.index(b'"marker"')
    return data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1 :]


def _wild(data: bytes) -> bytes:
    return data.replace(b'"t":6000000,', b'"t":6000000000000,')


def _swapped(data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    return b"".join([*lines[:6], lines[7], lines[6], *lines[8:]])


def _twice(data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    return b"".join([*lines[:9], *lines[5:]])


def _strange(data: bytes) -> bytes:
    line = (
        b'{"kind":"weather","seq":9999,"t":60000000,"ts":"2027-01-01T00:00:00Z","sky":["blue"]}\n'
    )
    return data + line


def _headless(data: bytes) -> bytes:
    return data[data.index(b"\n") + 1 :]


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (_torn, "incomplete last line"),
        (_nul, "NUL byte"),
        (_flipped, "damaged line"),
        (_swapped, ""),
        (_twice, ""),
        (_wild, ""),
        (_strange, "weather"),
        (_headless, "its beginning is missing"),
    ],
)
def test_no_damage_keeps_the_rest_from_being_seen(
    tmp_path: Path, harm: Callable[[bytes], bytes], words: str
) -> None:
    path = write_log(tmp_path)
    path.write_bytes(harm(path.read_bytes()))
    with open_log(path) as index:
        viewer, notes = viewer_and_notes(index)
        assert words in "; ".join(notes)
        viewer.wait(61, ticks=61)
        assert viewer.player.ended
        told = [event.text for event in viewer.state.events]
        assert [text for text in told if text in ("Hello", "Go")] == ["Hello", "Go"]
        assert "comes back" in told
        viewer.go(16)
        assert viewer.state.session.stop is not None


def test_a_log_without_samples_is_played(tmp_path: Path) -> None:
    path = write_log(tmp_path)
    path.with_name(f"{STEM}.samples.jsonl").unlink()
    with open_log(path) as index:
        viewer, _ = viewer_and_notes(index)
        viewer.go(30)
        assert viewer.state.sensors == []


def test_a_session_that_was_killed_says_that_it_has_no_end(tmp_path: Path) -> None:
    with open_log(write_log(tmp_path, story()[:-1])) as index:
        _, notes = viewer_and_notes(index)
        assert any("has no end" in note for note in notes)


def test_an_old_log_is_refused_with_its_schema(tmp_path: Path) -> None:
    log = write_log(tmp_path, story())
    log.write_bytes(log.read_bytes().replace(b'"schema":3', b'"schema":2', 1))
    with pytest.raises(LogError, match=r"a log of schema 2, .* commit aef656da reads it$"):
        open_log(log)


def test_the_golden_log_is_played() -> None:
    path = next((GOLDEN / "v3" / "spill").glob("*.jsonl"))
    with open_log(path) as index:
        viewer, _ = viewer_and_notes(index)
        viewer.wait(index.length_us / SECOND + 1, ticks=40)
        assert viewer.player.ended
        assert viewer.state.ended == "wizard"
        assert viewer.state.panels
        viewer.go(2)
        assert viewer.state.session.study.participant == "P07"


def test_what_a_log_says_of_its_experiment() -> None:
    path = next((GOLDEN / "v3" / "spill").glob("*.jsonl"))
    with open_log(path) as index:
        origin = origin_of(index.actions)
    assert origin.name == "museum.yaml"
    assert len(origin.hashes) == 3
    assert origin.files is not None
    assert "museum.yaml" in origin.files.files
