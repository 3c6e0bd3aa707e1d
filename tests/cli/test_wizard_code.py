"""Who plays is asked once on a computer, and then known to every session."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from woz_tui.cli import main
from woz_tui.cli.wizard_code import remembered_wizard, wizard_code
from woz_tui.config.screen_language import use
from woz_tui.system.user_folders import WIZARD, state_folder


@pytest.fixture(autouse=True)
def never_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A user of this computer who has never been asked."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


def typing(*lines: str) -> Callable[[str], str]:
    """Somebody who types these lines, and is gone if asked once more."""
    left = list(lines)

    def answer(question: str) -> str:
        assert "W1" in question
        if not left:
            raise EOFError
        return left.pop(0)

    return answer


def nobody(question: str) -> str:
    raise AssertionError(question)


def test_the_wizard_is_asked_once() -> None:
    assert wizard_code("", typing("W1")) == "W1"
    assert wizard_code("", nobody) == "W1"


def test_another_wizard_of_the_same_account_gives_theirs() -> None:
    wizard_code("", typing("W1"))
    assert wizard_code("W2", nobody) == "W2"
    assert wizard_code("", nobody) == "W2"


def test_who_wants_no_code_is_not_asked_again() -> None:
    assert wizard_code("", typing("")) == ""
    assert wizard_code("", nobody) == ""


def test_who_goes_away_is_asked_the_next_time() -> None:
    assert wizard_code("", typing()) == ""
    assert wizard_code("", typing("W1")) == "W1"


@pytest.mark.parametrize("name", ["Anna", "Anna Bauer", "../W1", "\u00c4nne1"])
def test_a_name_is_neither_taken_nor_remembered(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert wizard_code("", typing(name)) == ""
    assert remembered_wizard() is None
    assert "code" in capsys.readouterr().out


def test_who_plays_is_asked_in_the_language_of_the_screen(
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked = list[str]()
    lines = iter(["Anna B", "Anna", "W1"])

    def answer(question: str) -> str:
        asked.append(question)
        return next(lines)

    use("de")
    try:
        assert wizard_code("", answer) == "W1"
    finally:
        use("en")
    assert asked[0] == "Ihr Code als Versuchsleitung, etwa W1, nicht Ihr Name (enter: kein Code): "
    said = capsys.readouterr().out.splitlines()
    assert [line.strip() for line in said] == [
        "'Anna B' ist kein gültiger Code: 1 bis 16 Buchstaben (a bis z) und Ziffern",
        "Ein Code hat eine Ziffer, etwa W1; ein Name gehört nicht in ein Protokoll.",
        "Auf diesem Rechner gemerkt; jemand anders gibt den eigenen mit --wizard an.",
    ]


def test_what_cannot_be_a_code_is_not_remembered_but_left_to_be_refused() -> None:
    assert wizard_code("Anna Bauer", nobody) == "Anna Bauer"
    assert remembered_wizard() is None


def test_a_file_that_was_damaged_or_cannot_be_written_is_no_reason_not_to_play() -> None:
    file = state_folder() / WIZARD
    file.parent.mkdir(parents=True)
    file.write_bytes(b"\xff\xfe")
    assert wizard_code("", typing("W1")) == "W1"
    file.unlink()
    file.mkdir()
    assert wizard_code("", typing("W1")) == "W1"


def test_a_training_asks_for_the_code_only_if_nobody_gave_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", str(tmp_path / "x.yaml")]) == 2
    assert "name the wizard's code" in capsys.readouterr().err
    wizard_code("W1", nobody)
    main(["train", str(tmp_path / "x.yaml")])
    assert "name the wizard's code" not in capsys.readouterr().err
