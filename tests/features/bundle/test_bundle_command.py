"""`woz bundle` at the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.features.bundle.deposited import recorded
from woz_tui.cli import main


def test_it_says_what_it_wrote_and_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recordings, out = recorded(tmp_path / "r"), tmp_path / "osf"
    given = ["bundle", str(recordings), "--out", str(out)]
    assert main(given) == 0
    said = capsys.readouterr()
    assert said.out.startswith("3 sessions of 3 participants, ")
    assert "still to be done, see TODO.md" in said.err
    assert main(given) == 1
    assert "replace it with --force" in capsys.readouterr().err
    assert main([*given, "--force", "--strict"]) == 1


def test_a_wrong_about_file_is_told_with_its_places(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about = tmp_path / "about.yaml"
    about.write_text("licence: free for all\n")
    given = ["bundle", str(recorded(tmp_path / "r")), "--out", str(tmp_path / "osf")]
    assert main([*given, "--about", str(about)]) == 1
    assert f"{about}:1:1: licence: expected a licence's short name" in capsys.readouterr().err
