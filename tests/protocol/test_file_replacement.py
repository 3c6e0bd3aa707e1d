"""Files that are written anew: the old one or the new one, whole, and nothing beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.system.files import replace, replacing, sweep


def test_a_file_that_cannot_be_written_leaves_the_old_one(tmp_path: Path) -> None:
    file = tmp_path / "map.yaml"
    replace(file, "old")
    with pytest.raises(UnicodeEncodeError):
        replace(file, "new \ud800")
    assert file.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_what_is_looked_at_and_found_wrong_does_not_take_the_place(tmp_path: Path) -> None:
    file = tmp_path / "map.yaml"
    replace(file, "old")
    with pytest.raises(LookupError), replacing(file, "new") as fresh:
        assert fresh.read_text(encoding="utf-8") == "new"
        assert file.read_text(encoding="utf-8") == "old"
        raise LookupError
    assert file.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_permissions_are_handed_on(tmp_path: Path) -> None:
    file = tmp_path / "map.yaml"
    replace(file, "old")
    file.chmod(0o640)
    replace(file, "new")
    assert (file.read_text(encoding="utf-8"), file.stat().st_mode & 0o777) == ("new", 0o640)


def test_a_private_file_is_private_from_its_first_byte(tmp_path: Path) -> None:
    file = tmp_path / "visitors.json"
    with replacing(file, "Anna", mode=0o600) as fresh:
        assert fresh.stat().st_mode & 0o777 == 0o600
    file.chmod(0o644)
    replace(file, "Bob", mode=0o600)
    assert (file.read_text(encoding="utf-8"), file.stat().st_mode & 0o777) == ("Bob", 0o600)


def test_what_a_killed_writer_left_behind_is_swept_and_nothing_else(tmp_path: Path) -> None:
    file = tmp_path / "a[b].json"
    replace(file, "old")
    left = tmp_path / ".a[b].json.0a1b2c3d.tmp"
    others = [tmp_path / ".ab.json.0a1b2c3d.tmp", tmp_path / ".a[b].json.lock"]
    for path in (left, *others):
        path.write_text("Anna", encoding="utf-8")
    sweep(file)
    assert sorted(tmp_path.iterdir()) == sorted([file, *others])
