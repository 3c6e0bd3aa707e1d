"""`woz new FILE --from NAME`: examples with all that they need, and nothing overwritten."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui import cli
from woz_tui.cli.new_from import copy_example
from woz_tui.config.bundled_files import examples
from woz_tui.config.loading import load
from woz_tui.drivers import plugins

NAMES = examples()


def test_the_examples_are_listed_with_their_titles(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["new", "--examples"]) == 0
    told = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert set(told) == set(NAMES)
    assert told["demo"] == "Museum guide"


@pytest.mark.parametrize("name", NAMES)
def test_a_copy_means_the_same_and_needs_nothing_else(name: str, tmp_path: Path) -> None:
    copy = tmp_path / "lab" / "mine.yaml"
    assert copy_example(name, copy) == 0
    catalogue = plugins.installed()
    original, copied = load(NAMES[name], catalogue), load(copy, catalogue)
    assert copied.sha256 == original.sha256
    assert len(copied.warnings) == len(original.warnings)  # such as of files that are not there
    named = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert all(path.is_relative_to(tmp_path / "lab") for path in named)


def test_what_is_needed_comes_along_and_not_more(tmp_path: Path) -> None:
    assert copy_example("demo", tmp_path / "demo.yaml") == 0
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    media = {f"media/{name}" for name in ("map.svg", "whale.svg", "whale.wav", "gong.wav")}
    schema = "schema/experiment.schema.json"  # for editors
    assert files == {"demo.yaml", *media, schema}


def test_two_examples_share_what_both_need(tmp_path: Path) -> None:
    assert copy_example("eyepi", tmp_path / "eyepi.yaml") == 0
    assert copy_example("show", tmp_path / "show.yaml") == 0


def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "media").mkdir()
    gong = tmp_path / "media" / "gong.wav"
    gong.write_text("my own")
    assert copy_example("demo", tmp_path / "demo.yaml") == 1
    assert f"{gong} is there already" in capsys.readouterr().err
    assert gong.read_text() == "my own"
    assert not (tmp_path / "demo.yaml").exists()


def test_one_that_is_not_there_is_told_with_the_nearest(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["new", str(tmp_path / "x.yaml"), "--from", "demmo"]) == 1
    assert "did you mean 'demo'?" in capsys.readouterr().err
    assert cli.main(["new"]) == 2
    assert "a new experiment needs a name" in capsys.readouterr().err
