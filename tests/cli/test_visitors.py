"""`woz visitors`: tables, JSON, changes, questions, and errors with a remedy."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from datetime import date
from pathlib import Path
from typing import Any

import pytest

from tests.fakes.terminal import FakeTerminal
from woz_tui.cli import main
from woz_tui.drivers.face_store import FaceStore, default_path
from woz_tui.sensing.visitor_store import VisitorStore
from woz_tui.system import files

ROOT = Path(__file__).parents[2]
DAY = date(2026, 3, 2)


@pytest.fixture(autouse=True)
def piped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Standard input is no terminal, and nobody says anything there."""
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "v.json"
    store = VisitorStore(path)
    store.add("Anna", on=DAY, age_group="adult", label="face-7")
    store.add("Bob", on=DAY, address="Herr")
    return path


def visitors(*words: str | Path, file: Path) -> int:
    return main(["visitors", *map(str, words), "--file", str(file)])


def names(file: Path) -> list[str]:
    return [visitor.name for visitor in VisitorStore(file).everybody()]


def test_the_list_is_a_table(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert visitors("list", file=file) == 0
    head, anna, bob = capsys.readouterr().out.splitlines()
    assert head.split("  ")[0] == "name" and "age group" in head and "face labels" in head
    assert anna.split() == ["Anna", "adult", "1", "2026-03-02", "2026-03-02", "face-7"]
    assert bob.split() == ["Bob", "Herr", "1", "2026-03-02", "2026-03-02"]


def test_it_lists_if_not_told_otherwise_and_takes_options_on_both_sides(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for words in (["--json"], ["list", "--json"], ["--json", "list"]):
        assert visitors(*words, file=file) == 0
        assert len(json.loads(capsys.readouterr().out)["visitors"]) == 2
    assert main(["visitors", "--file", str(file), "rename", "Bob", "B01", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "B01"


def test_nobody_is_no_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "v.json"
    assert visitors("list", file=file) == 0
    assert capsys.readouterr().out == f"{file}: nobody (the file does not exist yet)\n"
    assert visitors("list", "--json", file=file) == 0
    assert json.loads(capsys.readouterr().out) == {"file": str(file), "visitors": [], "faces": []}
    assert not file.exists()


def test_one_visitor_by_name_or_face(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("anna", "FACE-7"):
        assert visitors("show", name, file=file) == 0
        assert capsys.readouterr().out.splitlines() == [
            "Anna",
            "  age group: adult",
            "  address: -",
            "  meetings: 1",
            "  first met: 2026-03-02",
            "  last met: 2026-03-02",
            "  face labels: face-7",
        ]
    assert visitors("show", "bob", "--json", file=file) == 0
    shown: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert shown["address"] == "Herr" and shown["labels"] == []


def test_changes(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert visitors("add", "Carla", "--age-group", "child", file=file) == 0
    assert visitors("rename", "anna", "A01", file=file) == 0
    assert visitors("profile", "a01", "--age-group", "senior", "--address", "Frau", file=file) == 0
    assert capsys.readouterr().out.splitlines()[-4:] == [
        "Anna is now A01",
        "A01",
        "  age group: adult -> senior",
        "  address: - -> Frau",
    ]
    assert visitors("profile", "A01", "--address", "", "--label", "face-8", file=file) == 0
    assert capsys.readouterr().out.splitlines() == [
        "A01",
        "  address: Frau -> -",
        "  face labels: face-7 -> face-7, face-8",
    ]
    assert visitors("profile", "A01", "--age-group", "senior", file=file) == 0
    assert capsys.readouterr().out.splitlines() == ["A01", "  as it was"]
    assert visitors("rename", "Bob", "B01", "--json", file=file) == 0
    assert json.loads(capsys.readouterr().out)["was"] == "Bob"
    assert names(file) == ["A01", "B01", "Carla"]


def test_forgetting_with_a_yes(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert visitors("forget", "anna", "ANNA", "--yes", file=file) == 0
    told = capsys.readouterr()
    assert told.out == "forgotten: Anna\n"
    assert "recogniser still has face-7" in told.err
    assert names(file) == ["Bob"]
    assert visitors("forget", "--all", "--yes", "--json", file=file) == 0
    assert json.loads(capsys.readouterr().out) == {"forgotten": ["Bob"], "faces": []}
    assert visitors("forget", "--all", "--yes", file=file) == 0
    assert names(file) == []


def test_nobody_is_forgotten_who_was_not_confirmed(
    file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("y\n"))
    assert visitors("forget", "Anna", file=file) == 1
    assert "use --yes" in capsys.readouterr().err
    assert names(file) == ["Anna", "Bob"]


@pytest.mark.parametrize(("answer", "left"), [("y", ["Bob"]), ("n", ["Anna", "Bob"]), ("", None)])
def test_at_a_terminal_it_asks(file: Path, answer: str, left: list[str] | None) -> None:
    command = [sys.executable, "-m", "woz_tui", "visitors", "forget", "Anna", "--file", str(file)]
    with FakeTerminal(command) as terminal:
        screen = terminal.wait_text("Delete for ever? [y/N]")
        assert "Anna: met once, last on 2026-03-02" in screen
        terminal.send(f"{answer}\r")
        assert terminal.wait_exit() == (0 if answer == "y" else 1)
    assert names(file) == (left or ["Anna", "Bob"])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["show", "Ana"], 'there is no visitor "Ana"\ndid you mean Anna?'),
        (["show", "Zacharias"], "list all with: woz visitors list"),
        (["add", "ANNA"], 'the name "ANNA" is taken: there is a visitor "Anna"'),
        (["add", "Unknown"], "it is the word for a visitor without a name"),
        (["add", "x" * 65], "64 are allowed"),
        (["add", "An\x1bna"], "U+001B"),
        (["rename", "Bob", "anna"], "is taken"),
        (["profile", "Bob"], "give --age-group, --address or --label"),
        (["profile", "Bob", "--label", "face-7"], "the face label"),
        (["profile", "Bob", "--age-group", "x" * 40], "the age group has 40 characters"),
        (["forget"], "name visitors, or use --all"),
        (["forget", "Anna", "--all", "--yes"], "name visitors, or use --all"),
        (["forget", "Anna", "Carla", "--yes"], 'there is no visitor "Carla"'),
    ],
)
def test_errors_come_with_a_remedy_and_change_nothing(
    file: Path, words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = file.read_bytes()
    assert visitors(*words, file=file) == 1
    error = capsys.readouterr()
    assert told in error.err and not error.out
    assert len(error.err.splitlines()) == 2
    assert file.read_bytes() == before


def test_a_damaged_file_is_told_with_its_place(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file.write_text(file.read_text()[:100])
    before = file.read_bytes()
    for words in (["list"], ["add", "Carla"], ["forget", "--all", "--yes"]):
        assert visitors(*words, file=file) == 1
        assert f"{file}:" in capsys.readouterr().err
    assert file.read_bytes() == before


def test_what_cannot_be_written_is_not_said_to_be_done(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "link.json").symlink_to(tmp_path / "not" / "mounted.json")
    assert visitors("add", "Anna", file=tmp_path / "link.json") == 1
    told = capsys.readouterr()
    assert "cannot be written" in told.err and told.err.endswith("nothing was changed\n")
    assert not told.out


def test_a_face_that_is_gone_is_told_where_the_name_cannot_be_deleted(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    faces = FaceStore(default_path())
    faces.learn("Anna", b"template", "2026-03-01", "log")
    (file.parent / f".{file.name}.lock").unlink()
    (file.parent / f".{file.name}.lock").mkdir()  # so nothing can be written
    assert visitors("rename", "Anna", "A01", file=file) == 1
    assert capsys.readouterr().err.endswith("nothing was changed\n")
    assert visitors("forget", "Anna", "--yes", file=file) == 1
    told = capsys.readouterr()
    assert "deleted faces: Anna; still stored: Anna" in told.err
    assert "nothing was changed" not in told.err and not told.out
    assert (faces.faces(), names(file)) == ([], ["Anna", "Bob"])


def test_a_renamed_visitor_keeps_the_face_in_one_change(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No moment in which the recogniser's name leads to nobody."""
    FaceStore(default_path()).learn("Anna", b"template", "2026-03-01", "log")
    written: list[str] = []
    replace = files.replace

    def watched(path: Path, text: str, *, mode: int) -> None:
        written.append(text)
        replace(path, text, mode=mode)

    monkeypatch.setattr(files, "replace", watched)
    assert visitors("rename", "Anna", "A01", file=file) == 0
    assert len(written) == 1
    called = VisitorStore(file).called("Anna")
    assert called is not None and called.name == "A01"


def test_the_store_of_an_experiment_and_the_one_beside_the_logs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    panel = "panels: [{title: A, actions: [{key: h, label: Hi, say: hi}]}]\n"
    Path("plain.yaml").write_text(f"title: t\nrobot: simulated\n{panel}")
    Path("own.yaml").write_text(
        f"title: t\nrobot: simulated\nengagement: {{visitors: data/v.json}}\n{panel}"
    )
    assert main(["visitors", "add", "Anna"]) == 0
    assert main(["visitors", "add", "Bob", "--experiment", "own.yaml"]) == 0
    assert names(tmp_path / "recordings" / "visitors.json") == ["Anna"]
    assert names(tmp_path / "data" / "v.json") == ["Bob"]
    capsys.readouterr()
    assert main(["visitors", "list", "--experiment", "plain.yaml", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["visitors"][0]["name"] == "Anna"
    assert main(["visitors", "list", "--experiment", "none.yaml"]) == 1
    assert "none.yaml" in capsys.readouterr().err
    with pytest.raises(SystemExit) as usage:
        main(["visitors", "list", "--experiment", "own.yaml", "--file", "v.json"])
    assert usage.value.code == 2


def test_two_commands_at_once_lose_nothing(file: Path) -> None:
    command = [sys.executable, "-m", "woz_tui", "visitors"]
    changes = [["rename", "Anna", "A01"], ["profile", "Bob", "--age-group", "child"], ["add", "Cy"]]

    def start(words: list[str]) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [*command, *words, "--file", str(file)],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )

    for words, process in [(words, start(words)) for words in changes]:
        # A busy machine may keep one waiting for longer than a command waits.
        while b"wait for it" in (error := process.communicate(timeout=60)[1]):
            process = start(words)  # noqa: PLW2901
        assert (process.returncode, error) == (0, b"")
    store = VisitorStore(file)
    assert names(file) == ["A01", "Bob", "Cy"]
    bob = store.find("Bob")
    assert bob is not None and bob.about == {"age_group": "child", "address": "Herr"}
