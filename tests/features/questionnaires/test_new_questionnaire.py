"""`woz new --questionnaire`: what can be copied, by its terms."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui import cli
from woz_tui.features.questionnaires.new_files import FOLDER, INSTRUMENTS


def test_all_are_listed_with_their_terms(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert cli.main(["new", "--questionnaire"]) == 0
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 80
    assert [each.name for each in INSTRUMENTS.files() if f"  {each.name} " not in said] == []
    assert "mini-ipip         20 items. Items of the International Personality Item" in said
    assert "bfi-10            template, 10 items. Copyright of its author" in said
    assert said.index("tlx ") < said.index("almere "), "templates come last"


def test_a_copy_says_how_it_is_named_in_the_experiment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["new", "--questionnaire", "tlx"]) == 0
    assert Path("tlx.yaml").read_bytes() == (FOLDER / "tlx.yaml").read_bytes()
    said = capsys.readouterr().out
    assert "questionnaires: [{file: tlx.yaml, when: end}]" in said
    assert "Cite: Hart" in said
    assert cli.main(["new", "--questionnaire", "tlx", "load.yaml"]) == 0
    assert "{file: load.yaml," in capsys.readouterr().out
    assert cli.main(["new", "--questionnaire", "tlx", "lab/asked/load.yaml"]) == 0
    assert Path("lab/asked/load.yaml").exists(), "the folder is made, as for an experiment"


def test_a_template_says_that_its_wording_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["new", "--questionnaire", "umux-lite"]) == 0
    assert "Its wording is missing: 4 times TO FILL" in capsys.readouterr().out


def test_what_is_there_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("sus.yaml").write_text("mine")
    assert cli.main(["new", "--questionnaire", "sus"]) == 1
    assert Path("sus.yaml").read_text() == "mine"
    assert cli.main(["new", "--questionnaire", "suss"]) == 1
    assert "did you mean 'sus'?" in capsys.readouterr().err


def test_an_experiment_needs_a_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["new"]) == 2
    assert "woz new guide.yaml" in capsys.readouterr().err
