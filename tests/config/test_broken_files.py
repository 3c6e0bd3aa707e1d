"""Golden files: what the writer of a broken experiment is told, to the letter."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.golden import BROKEN, names, sentences
from tests.config.reading import HEAD, errors, panel
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.config.problems import MAX_PROBLEMS
from woz_tui.config.screen_language import catalogue
from woz_tui.protocol.sentence import Sentence


@pytest.mark.parametrize("name", names())
def test_every_broken_file_says_exactly_what_its_golden_file_says(name: str) -> None:
    said = sentences(name)
    assert said, f"{name}.yaml was read without an error"
    assert said == (BROKEN / f"{name}.txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", names())
def test_every_problem_has_a_code_and_german_words(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(BROKEN)
    with pytest.raises(ExperimentError) as caught:
        load(Path(f"{name}.yaml"), CATALOGUE)
    german = catalogue("de")
    for problem in caught.value.problems:
        if isinstance(problem.message, Sentence):
            assert problem.message.code in german
        else:  # what a driver says of its settings
            assert "drivers." in problem.path, problem


def test_there_are_enough_broken_files() -> None:
    assert len(names()) >= 45


def test_errors_are_sorted_by_place_with_the_robot_file_last(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("drivers:\n  head: {type: nobody}\nx: 1\n")
    text = panel("{key: a, lable: A, say: 5}", head="title: T\nrobot: robot.yaml\nkeyboard: q\n")
    with pytest.raises(ExperimentError) as caught:
        path = tmp_path / "e.yaml"
        path.write_text(text)
        load(path, CATALOGUE)
    places = [
        (p.place.file != str(path), p.place.line, p.place.column) for p in caught.value.problems
    ]
    assert places == sorted(places)
    assert places[-1][0]


def test_a_file_full_of_errors_is_cut_and_the_rest_counted(tmp_path: Path) -> None:
    found = errors(tmp_path, panel(*[f"{{label: L{i}, sya: 1}}" for i in range(MAX_PROBLEMS + 5)]))
    assert len(found) == MAX_PROBLEMS + 1
    assert found[-1].endswith("and 5 more errors")


@pytest.mark.parametrize("kind", ["missing", "folder", "pipe", "endless", "huge"])
def test_what_is_no_file_is_refused_at_once(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "e.yaml"
    match kind:
        case "folder":
            path.mkdir()
        case "pipe":
            os.mkfifo(path)
        case "endless":
            path = Path("/dev/zero")
        case "huge":
            path.write_bytes(b"# " + b"x" * (2 << 20))
    with pytest.raises(ExperimentError) as caught:
        load(path, CATALOGUE)
    (problem,) = caught.value.problems
    expected = {
        "missing": "there is no such file",
        "folder": "this is a folder, not a file",
        "pipe": "this is not a file",
        "endless": "this is not a file",
        "huge": "the file is larger than 1 MiB; check that it is the right file",
    }
    assert problem.message == expected[kind]


def test_a_robot_driver_that_cannot_be_imported_is_an_error_with_a_place(tmp_path: Path) -> None:
    class Torn(dict[str, type]):
        def __getitem__(self, name: str) -> type:
            raise ImportError(f"no module for {name}")

    path = tmp_path / "e.yaml"
    path.write_text(panel("{label: A, say: Hi}"))
    with pytest.raises(ExperimentError, match=r"drivers.robot: no module for simulated"):
        load(path, Torn(CATALOGUE))


def test_the_same_mistake_through_an_alias_is_told_once_for_each_path(tmp_path: Path) -> None:
    text = panel("&a {key: a, label: A, sya: 1}", "{<<: *a, key: b, label: B}", head=HEAD)
    assert errors(tmp_path, text) == [
        "6:31: P > A > sya: unknown; did you mean 'say'?",
        "6:31: P > B > sya: unknown; did you mean 'say'?",
    ]
