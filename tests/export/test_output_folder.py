"""An export is there as a whole or not at all, and never deletes anything but an earlier one."""

from __future__ import annotations

import errno
import os
import resource
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from tests.export.export_runs import export_logs
from tests.export.logs import visit, write
from woz_tui.export.export_run import FORMATS
from woz_tui.export.log_sources import ExportError
from woz_tui.export.output_folder import README, SIGN, new_folder


def test_a_folder_that_is_not_empty_is_left_alone(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    export_logs(log, "csv", tmp_path / "out")
    before = (tmp_path / "out" / "events.csv").stat().st_ino
    with pytest.raises(ExportError, match="--force"):
        export_logs(log, "csv", tmp_path / "out")
    assert (tmp_path / "out" / "events.csv").stat().st_ino == before


@pytest.mark.parametrize("to", FORMATS)
def test_force_replaces_an_earlier_export_of_any_format(tmp_path: Path, to: str) -> None:
    log = write(tmp_path / "recordings", visit())
    export_logs(log, to, tmp_path / "out")
    export_logs(log, "csv", tmp_path / "out", force=True)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert "events.csv" in names
    assert names == {path.name for path in (tmp_path / "out").iterdir() if path.is_file()}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "recordings"]


def test_force_deletes_nothing_else(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / README).write_text("# My thesis\n")
    with pytest.raises(ExportError, match="not an earlier export"):
        export_logs(log, "csv", tmp_path / "thesis", force=True)
    assert (tmp_path / "thesis" / README).read_text() == "# My thesis\n"


def test_force_does_not_delete_the_logs_it_reads(tmp_path: Path) -> None:
    export_logs(write(tmp_path / "recordings", visit()), "jsonl", tmp_path / "copies")
    with pytest.raises(ExportError, match="lies in"):
        export_logs(tmp_path / "copies", "csv", tmp_path / "copies", force=True)
    assert list((tmp_path / "copies").glob("*.jsonl"))


def test_neither_a_file_nor_a_link_is_replaced(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    (tmp_path / "file").touch()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "elsewhere")
    for name in ("file", "link"):
        with pytest.raises(ExportError, match="not a folder"):
            export_logs(log, "csv", tmp_path / name, force=True)


def test_an_empty_folder_is_as_good_as_none(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    (tmp_path / "a" / "empty").mkdir(parents=True)
    export_logs(log, "csv", tmp_path / "a" / "empty")
    export_logs(log, "csv", tmp_path / "b" / "new")
    assert (tmp_path / "a" / "empty" / README).is_file()
    assert (tmp_path / "b" / "new" / README).is_file()


@pytest.mark.parametrize("to", FORMATS)
def test_files_are_for_their_owner_only_and_the_readme_signs(tmp_path: Path, to: str) -> None:
    log = write(tmp_path / "recordings", visit())
    export_logs(log, to, tmp_path / "out", samples=True)
    for path in [tmp_path / "out", *(tmp_path / "out").rglob("*")]:
        assert stat.S_IMODE(path.stat().st_mode) == (0o700 if path.is_dir() else 0o600)
    assert (tmp_path / "out" / README).read_text(encoding="utf-8").startswith(SIGN)


def test_what_fails_in_the_middle_leaves_nothing(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(ZeroDivisionError), new_folder(out) as folder:
        folder.write("half.csv", "a")
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []


def test_what_fails_in_the_middle_leaves_the_earlier_export(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    export_logs(log, "csv", tmp_path / "out")
    with pytest.raises(OSError, match="gone") as error, new_folder(tmp_path / "out", force=True):
        raise OSError("gone")
    assert error.value.__notes__ == [f"nothing was exported; {tmp_path / 'out'} is unchanged"]
    assert (tmp_path / "out" / "events.csv").is_file()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "recordings"]


@pytest.mark.parametrize("to", FORMATS)
def test_a_disk_that_takes_no_more_is_told(tmp_path: Path, to: str) -> None:
    """The limit on the size of files stands for a full disk: the system's own write fails."""
    log = write(tmp_path / "recordings", visit())
    ran = subprocess.run(
        [sys.executable, "-m", "woz_tui", "export", str(log), "--to", to, "--out", "out"],
        cwd=tmp_path,
        # Python would write compiled modules up to the limit, and leave them cut off for others.
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200)),
    )
    assert ran.returncode == 1
    assert "nothing was exported" in ran.stderr
    assert "Traceback" not in ran.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["recordings"]


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match=os.strerror(errno.EEXIST)):
        export_logs(log, "csv", tmp_path / "file" / "out")
