"""Figures of logs that were read before are kept, and never believed over the log."""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
from pathlib import Path
from typing import Any

import msgspec
import pytest

from tests.analysis.example_sessions import study
from woz_tui.analysis import kept_figures
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.kept_figures import (
    figures_folder,
    forget_all,
    forget_lost,
    kept_report,
)
from woz_tui.analysis.session_reading import NoSessionError, read_report

SAMPLE = Path(__file__).parents[2] / "recordings" / "sample.jsonl"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return figures_folder()


@pytest.fixture
def logs(tmp_path: Path) -> list[Path]:
    study(tmp_path / "logs")
    return sorted((tmp_path / "logs").glob("*.jsonl"))


def figures(log: Path, options: FigureOptions | None = None) -> SessionFigures:
    return (kept_report(log, options) if options else kept_report(log)).figures


def state(folder: Path) -> dict[str, tuple[int, int]]:
    """Which file is which: one that is written anew has another number."""
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in folder.iterdir()}


def test_what_was_kept_is_what_would_be_read(logs: list[Path]) -> None:
    shutil.copy(SAMPLE, logs[0].parent)
    for log in (*logs, logs[0].parent / SAMPLE.name):
        read = read_report(log).figures
        assert figures(log) == read
        assert figures(log) == read


def test_only_a_new_session_is_read(logs: list[Path], folder: Path) -> None:
    for log in logs[:3]:
        figures(log)
    before = state(folder)
    for log in logs:
        figures(log)
    after = state(folder)
    assert len(before) == 3
    assert len(after) == 4
    assert {name: after[name] for name in before} == before
    assert all(path.stat().st_mode & 0o777 == 0o600 for path in folder.iterdir())
    assert folder.stat().st_mode & 0o777 == 0o700


def test_a_log_that_changed_is_read_again_whatever_its_date(logs: list[Path]) -> None:
    before = figures(logs[0])
    about = logs[0].stat()
    logs[0].write_bytes(logs[0].read_bytes().replace(b'"W1"', b'"W2"'))
    os.utime(logs[0], ns=(about.st_atime_ns, about.st_mtime_ns))
    assert before.wizard == "W1"
    assert figures(logs[0]).wizard == "W2"


def test_each_way_of_counting_has_its_own(logs: list[Path], folder: Path) -> None:
    wide, narrow = figures(logs[0]), figures(logs[0], FigureOptions(window_us=1))
    assert (wide.window_us, narrow.window_us) == (10_000_000, 1)
    assert len(state(folder)) == 2


@pytest.mark.parametrize("damage", [b"", b"{}", b"\0" * 99, b'{"log":"x"', b"[" * 9999])
def test_what_is_damaged_is_made_anew(logs: list[Path], folder: Path, damage: bytes) -> None:
    read = figures(logs[0])
    [kept] = folder.iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(damage)
    assert figures(logs[0]) == read
    assert kept.read_bytes() == whole


def test_what_another_version_kept_is_made_anew(
    logs: list[Path], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figures(logs[0])
    before = state(folder)
    monkeypatch.setattr(kept_figures, "__version__", "0.0.1")
    kept_figures._program.cache_clear()
    figures(logs[0])
    monkeypatch.undo()
    kept_figures._program.cache_clear()
    assert state(folder).keys() == before.keys()
    assert state(folder) != before


def test_nothing_is_called_that_a_forged_file_names(
    logs: list[Path], folder: Path, tmp_path: Path
) -> None:
    class Forged:
        def __reduce__(self) -> tuple[Any, ...]:
            return os.mkdir, (str(tmp_path / "forged"),)

    read = figures(logs[0])
    [kept] = folder.iterdir()
    data = pickle.dumps(Forged())
    fields = msgspec.json.decode(kept.read_bytes(), type=kept_figures._Kept)
    fields.figures, fields.sum = data, hashlib.sha256(data).hexdigest()
    kept.write_bytes(msgspec.json.encode(fields))
    assert figures(logs[0]) == read
    assert not (tmp_path / "forged").exists()


def test_what_is_left_of_a_log_that_is_gone_is_removed(logs: list[Path], folder: Path) -> None:
    for log in logs:
        figures(log)
    (folder / ".x.figures.1234.tmp").write_bytes(b"half of a file")
    logs[0].unlink()
    forget_lost()
    assert len(state(folder)) == 3
    forget_all()
    assert state(folder) == {}


def test_where_nothing_can_be_kept_logs_are_read(
    logs: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert figures(logs[0]) == read_report(logs[0]).figures
    forget_lost()
    forget_all()


def test_what_is_no_session_is_told_as_ever(logs: list[Path], folder: Path) -> None:
    logs[0].write_bytes(b"rubbish\n")
    with pytest.raises(NoSessionError):
        figures(logs[0])
    with pytest.raises(FileNotFoundError):
        figures(logs[0].with_name("nowhere.jsonl"))
    assert not folder.exists()
