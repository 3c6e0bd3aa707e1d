"""The section `repairs`."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from tests.config.reading import HEAD, HELLO, errors, panel, read_experiment
from woz_tui.config.languages import FOLDER
from woz_tui.features.repairs.section import INTERRUPT, REPEAT, REWORD, SPOKEN

VARIED = "{key: v, label: V, say: {any: [One, Two]}}"


def repairs(folder: Path, section: str, *actions: str) -> dict[str, list[object]]:
    """Name of each repair -> what it says."""
    file = panel(*(actions or (HELLO,)), head=f"{HEAD}{section}")
    return {
        action.name: [call.args.get("text") for call in action.calls]
        for action in read_experiment(folder, file).beside_panels
    }


def test_a_file_without_the_section_gains_no_sentence(tmp_path: Path) -> None:
    assert repairs(tmp_path, "", HELLO, VARIED) == {REPEAT: [], INTERRUPT: []}


@pytest.mark.parametrize("language", ["en", "de", "fr", "es", "it", "nl", "sv", "ja"])
def test_each_language_has_all_sentences(tmp_path: Path, language: str) -> None:
    found = repairs(tmp_path, f"repairs: {{language: {language}}}\n")
    said = [found[f"repair {name}"] for name in SPOKEN]
    text = (FOLDER / f"{language}.yaml").read_text(encoding="utf-8")
    ours = yaml.load(text, yaml.BaseLoader)["repairs"]
    assert said == [[ours[name]] for name in SPOKEN]
    assert len({str(each) for each in said}) == len(SPOKEN)


def test_sentences_of_its_own_and_those_left_out(tmp_path: Path) -> None:
    section = "repairs: {yes: {say: Sure, mark: yes}, no: No, without: [filler]}\n"
    found = repairs(tmp_path, section, HELLO, VARIED)
    assert found["repair yes"] == ["Sure", "yes"]
    assert found["repair no"] == ["No"]
    assert "repair filler" not in found
    assert REWORD in found


def test_a_language_beside_the_experiment_has_sentences_too(tmp_path: Path) -> None:
    (tmp_path / "gsw.language.yaml").write_text("repairs: {yes: Jo.}\n")
    for section in ("language: gsw\nrepairs: {}\n", "repairs: {language: gsw}\n"):
        found = repairs(tmp_path, section)
        assert found["repair yes"] == ["Jo."]
        assert found["repair no"] == ["No."]  # what it leaves out is English


def test_other_words_are_offered_only_where_there_are_any(tmp_path: Path) -> None:
    assert REWORD not in repairs(tmp_path, "repairs: {language: en}\n")


def test_what_is_wrong_is_said_where_it_stands(tmp_path: Path) -> None:
    section = "repairs: {language: xx, maybe: Hm, without: [nope], yes: {any: []}}\n"
    found = errors(tmp_path, panel(HELLO, head=f"{HEAD}{section}"))
    assert {line.split(" ")[1].rstrip(":") for line in found} >= {
        "repairs.language",
        "repairs.maybe",
        "repairs.without[0]",
    }
