"""Files that are written anew: the old one or the new one, whole, and nothing beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.core.replacing import replace, replacing


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
