"""`language` of an experiment, and the files of words."""

from __future__ import annotations

import string
from pathlib import Path

import msgspec
import pytest
import yaml

from tests.config.catalogue import CATALOGUE
from tests.config.reading import ROBOT, panel
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.languages import FOLDER, shipped
from woz_tui.config.loading import load
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.protocol.welcome import ENGLISH, QuestionnaireWords

FIELDS = QuestionnaireWords.__struct_fields__


def make_experiment(folder: Path, language: str) -> Experiment:
    text = panel("{label: A, say: a}", head=f"{ROBOT}\n{language}\n")
    (folder / "e.yaml").write_text(text, encoding="utf-8")
    return load(folder / "e.yaml", CATALOGUE)


def words_in(experiment: Experiment) -> QuestionnaireWords:
    return QUESTIONNAIRES.of(experiment).words


def words_of(code: str) -> dict[str, str]:
    content = yaml.safe_load((FOLDER / f"{code}.yaml").read_text(encoding="utf-8"))
    words: dict[str, str] = content["questionnaire"]
    return words


def filled_in(text: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


@pytest.mark.parametrize("code", ["en", "de", "fr", "es", "nl", "it", "sv", "ja"])
def test_a_language_that_comes_along_has_every_word(code: str) -> None:
    words = words_of(code)
    assert [*words] == [*FIELDS]
    for name in FIELDS:
        assert filled_in(words[name]) == filled_in(getattr(ENGLISH, name)), name
    assert len(words["stop_key"]) == len(words["go_on_key"]) == 1
    assert words["stop_key"] != words["go_on_key"]


def test_the_english_file_says_what_the_code_says() -> None:
    assert QuestionnaireWords(**words_of("en")) == ENGLISH
    assert {"en", "de"} <= {*shipped()}


def test_without_a_language_it_is_english(tmp_path: Path) -> None:
    assert (make_experiment(tmp_path, "").language, words_in(make_experiment(tmp_path, ""))) == (
        "en",
        ENGLISH,
    )


def test_a_language_that_comes_along(tmp_path: Path) -> None:
    assert words_in(make_experiment(tmp_path, "language: de")).wait == "Bitte warten."


def test_a_file_beside_the_experiment_adds_a_language_and_is_part_of_it(tmp_path: Path) -> None:
    own = tmp_path / "gsw.language.yaml"
    own.write_text("questionnaire: {wait: Bitte no chli warte.}\n", encoding="utf-8")
    experiment = make_experiment(tmp_path, "language: gsw")
    assert words_in(experiment) == msgspec.structs.replace(ENGLISH, wait="Bitte no chli warte.")
    assert own in experiment.files
    own.write_text("questionnaire: {wait: Bitte warte.}\n", encoding="utf-8")
    assert make_experiment(tmp_path, "language: gsw").sha256 != experiment.sha256


def test_a_file_beside_the_experiment_goes_before_ours(tmp_path: Path) -> None:
    (tmp_path / "de.language.yaml").write_text("questionnaire: {wait: Warte bitte.}\n")
    words = words_in(make_experiment(tmp_path, "language: de"))
    assert (words.wait, words.thanks) == ("Warte bitte.", "Vielen Dank!")


@pytest.mark.parametrize(
    ("language", "file", "said"),
    [
        ("dee", "", "e.yaml:7:1: language: 'dee' is not known; did you mean 'de'?"),
        ("../de", "", "language: '../de' is not known; there are: de, en,"),
        ("x", "questionnaire: {wate: W}", "wate: unknown; did you mean 'wait'?"),
        ("x", "questionnaire: {wait: '{who}'}", "between braces may stand here: nothing"),
        ("x", "questionnaire: {number: 'from {low'}", "may stand here: {high}, {low}"),
        ("x", "questionnaire: [a]", "expected words by their names"),
        ("x", "- a", "expected sections of words"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(
    tmp_path: Path, language: str, file: str, said: str
) -> None:
    if file:
        (tmp_path / "x.language.yaml").write_text(file)
    with pytest.raises(ExperimentError) as error:
        make_experiment(tmp_path, f"language: {language}")
    assert said in "\n".join(map(str, error.value.problems))
