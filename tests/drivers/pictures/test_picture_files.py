"""Pictures on the disk: read back by another library, whole or not at all, none over another."""

from __future__ import annotations

import io
import os
from datetime import UTC, datetime
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from woz_drivers.pictures import picture_files
from woz_drivers.pictures.picture_files import png, stamp

from woz_tui.drivers.contract import DriverError

DOT = b"of a picture"


def keep(folder: Path, name: str, content: bytes) -> Path:
    return picture_files.keep(folder, name, ".png", content)


@given(st.integers(1, 9), st.integers(1, 9), st.randoms(use_true_random=False))
def test_another_library_reads_the_same_pixels(width: int, height: int, chance: Random) -> None:
    rgb = chance.randbytes(3 * width * height)
    with Image.open(io.BytesIO(png(width, height, rgb))) as image:
        image.load()
        assert (image.mode, image.size, image.tobytes()) == ("RGB", (width, height), rgb)


@pytest.mark.parametrize(
    ("width", "height", "bytes_"), [(2, 1, 3), (0, 1, 0), (1, 0, 0), (1, 1, 4)]
)
def test_bytes_that_are_no_picture_are_refused(width: int, height: int, bytes_: int) -> None:
    with pytest.raises(ValueError, match="are no picture"):
        png(width, height, b"x" * bytes_)


def test_a_name_that_is_taken_is_left_alone(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    made = [keep(folder, "a", DOT).name for _ in range(3)]
    assert made == ["a.png", "a-2.png", "a-3.png"]
    (folder / "b.png").write_bytes(b"somebody's")
    assert keep(folder, "b", DOT).name == "b-2.png"
    assert (folder / "b.png").read_bytes() == b"somebody's"
    assert sorted(path.name for path in folder.iterdir()) == [
        *("a-2.png", "a-3.png", "a.png", "b-2.png", "b.png"),
    ]
    assert (folder / "a.png").stat().st_mode & 0o077 == 0


def test_a_disk_without_second_names_takes_pictures_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def link(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", link)
    assert [keep(tmp_path, "a", DOT).name for _ in range(2)] == ["a.png", "a-2.png"]
    assert len(list(tmp_path.iterdir())) == 2


def test_a_full_disk_is_told_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fsync(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(DriverError, match=r"could not be kept .*No space left") as raised:
        keep(tmp_path, "a", DOT)
    assert raised.value.remedy == "free some space on the disk"
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_a_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(DriverError, match="could not be kept") as raised:
        keep(tmp_path / "file" / "deeper", "a", DOT)
    assert "pictures" in raised.value.remedy


def test_a_moment_as_a_name_sorts_by_time() -> None:
    moment = datetime(2026, 3, 1, 10, 0, 0, 250_900, tzinfo=UTC)
    assert stamp(moment) == "20260301-100000-250"


def test_what_has_the_folders_name_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(DriverError, match="File exists") as raised:
        keep(tmp_path / "file", "a", DOT)
    assert "is no folder" in raised.value.remedy


def test_a_draft_that_was_left_behind_is_in_nobodys_way(tmp_path: Path) -> None:
    (tmp_path / f".a.{os.getpid()}.part").write_bytes(b"of a program that was killed")
    assert keep(tmp_path, "a", DOT).name == "a.png"
