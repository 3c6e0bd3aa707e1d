"""The questionnaires that come with woz-tui, and files of questionnaires in general."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.config.reading import HEAD, HELLO, panel, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.languages import shipped
from woz_tui.features.questionnaires.new_files import FOLDER
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.features.questionnaires.to_fill import TO_FILL
from woz_tui.protocol.welcome import Questionnaire

NAMES = sorted(path.stem for path in FOLDER.glob("*.yaml"))
TEMPLATES = [n for n in NAMES if TO_FILL in (FOLDER / f"{n}.yaml").read_text(encoding="utf-8")]
WHOLE = [name for name in NAMES if name not in TEMPLATES]


def asked(folder: Path, entries: str, more: str = "") -> list[Questionnaire]:
    """What an experiment with these questionnaires asks."""
    return [*QUESTIONNAIRES.of(read(folder, entries, more)).questionnaires]


def read(folder: Path, entries: str, more: str = "") -> Experiment:
    return read_experiment(folder, panel(HELLO, head=f"{HEAD}{more}questionnaires: [{entries}]\n"))


def copied(folder: Path, name: str) -> str:
    """An instrument beside the experiment."""
    text = (FOLDER / f"{name}.yaml").read_text(encoding="utf-8")
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return text


def filled(folder: Path, name: str) -> Questionnaire:
    """A template in which each missing wording was written."""
    count = iter(range(1000))
    text = re.sub(TO_FILL, lambda _: f"words {next(count)}", copied(folder, name))
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    (found,) = asked(folder, f"{{file: {name}.yaml}}")
    return found


def test_which_come_with_their_wording() -> None:
    assert {*WHOLE} == {
        *("demographics", "mini-ipip", "sus", "sus-adapted", "suspicion", "tlx", "tlx-weighted"),
    }


@pytest.mark.parametrize("name", WHOLE)
def test_one_with_wording_can_be_asked_as_it_is(tmp_path: Path, name: str) -> None:
    copied(tmp_path, name)
    (found,) = asked(tmp_path, f"{{file: {name}.yaml}}")
    assert found.name == name
    assert all(item.question for item in found.items)


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_template_is_refused_until_it_is_filled(tmp_path: Path, name: str) -> None:
    text = copied(tmp_path, name)
    with pytest.raises(ExperimentError) as refused:
        read(tmp_path, f"{{file: {name}.yaml}}")
    (problem,) = refused.value.problems
    count = text.partition("\ninstrument:")[2].count(TO_FILL)
    assert f"{TO_FILL} stands here and {count - 1} times more" in problem.message
    assert problem.place.file.endswith(f"{name}.yaml")
    assert filled(tmp_path, name).name == name


@pytest.mark.parametrize("name", NAMES)
def test_each_says_its_source_and_terms(name: str) -> None:
    text = (FOLDER / f"{name}.yaml").read_text(encoding="utf-8")
    source = text.partition("\ninstrument:\n")[2].partition("\nname:")[0]
    keys = re.findall(r"^  (\w+):", source, re.MULTILINE)
    ours = "  citation: Our own" in source
    assert keys == ["citation", "terms"] if ours else ["citation", "link", "terms", "read"]
    assert ours or re.search(r'read: "\d{4}-\d\d-\d\d: ', source), "what was read, and when"


def items_of(found: Questionnaire) -> dict[str, tuple[str, ...]]:
    return {score.name: score.items for score in found.scores}


def test_keys_of_templates(tmp_path: Path) -> None:
    bfi = filled(tmp_path, "bfi-10")
    assert items_of(bfi)["extraversion"] == ("bfi-1", "bfi-6")
    assert [score.reverse for score in bfi.scores] == [
        *(("bfi-1",), ("bfi-7",), ("bfi-3",), ("bfi-4",), ("bfi-5",)),
    ]
    nars = filled(tmp_path, "nars")
    assert [(len(score.items), score.how) for score in nars.scores] == [
        *((6, "sum"), (5, "sum"), (3, "sum")),
    ]
    assert nars.scores[2].reverse == nars.scores[2].items == ("nars-3", "nars-5", "nars-6")
    godspeed = filled(tmp_path, "godspeed")
    assert [len(score.items) for score in godspeed.scores] == [5, 6, 5, 5, 3]
    assert not any(score.reverse for score in godspeed.scores)
    ueq = filled(tmp_path, "ueq-s")
    assert {(item.low, item.high, item.shift, item.numbers) for item in ueq.items} == {
        (-3, 3, 4, False)
    }
    almere = filled(tmp_path, "almere")
    assert (len(almere.items), len(almere.scores)) == (41, 12)
    assert filled(tmp_path, "umux-lite").scores[0].onto == (0, 100)
    mdmt = filled(tmp_path, "mdmt")
    assert all(item.does_not_apply for item in mdmt.items)
    assert {len(score.items) - score.missing for score in mdmt.scores} == {1}
    ux = filled(tmp_path, "ux-wicar")
    assert len({item.ends for item in ux.items}) == 10, "each topic has its own two ends"


def test_performance_of_tlx_is_not_reversed(tmp_path: Path) -> None:
    copied(tmp_path, "tlx")
    (tlx,) = asked(tmp_path, "{file: tlx.yaml, when: trial}")
    performance = tlx.items[3]
    assert (performance.ends, performance.step) == (("perfect", "failure"), 5)
    assert tlx.scores[0].reverse == ()
    assert tlx.when == "trial"


def test_weighted_tlx_compares_every_two_of_six(tmp_path: Path) -> None:
    copied(tmp_path, "tlx-weighted")
    (tlx,) = asked(tmp_path, "{file: tlx-weighted.yaml}")
    score = tlx.scores[0]
    compared = {
        tuple(each.value for each in item.choices) for item in tlx.items if item.asks == "choice"
    }
    assert compared == {(a, b) for a in range(1, 7) for b in range(a + 1, 7)}
    assert len(score.pairs) == 15


@pytest.mark.parametrize("language", shipped())
@pytest.mark.parametrize("name", ["suspicion", "demographics"])
def test_our_own_are_in_all_languages_of_the_console(
    tmp_path: Path, name: str, language: str
) -> None:
    copied(tmp_path, name)
    (found,) = asked(tmp_path, f"{{file: {name}.yaml}}", f"language: {language}\n")
    assert found.language == language
    assert {found.language, *(each.language for each in found.versions)} == {*shipped()}


def test_a_suspicion_check_is_the_last_one(tmp_path: Path) -> None:
    copied(tmp_path, "suspicion")
    found = asked(tmp_path, "{file: suspicion.yaml}, {name: a, items: [b]}, {name: c, items: [d]}")
    assert [each.name for each in found] == ["a", "c", "suspicion"]


def test_check_names_the_scores(tmp_path: Path) -> None:
    copied(tmp_path, "tlx")
    ((name, words),) = QUESTIONNAIRES.summary(read(tmp_path, "{file: tlx.yaml, when: trial}"))
    assert (name, words) == ("tlx", "after each trial: 6 items, 6 sliders, score workload")


# -- files in general ------------------------------------------------------------------------------

OWN = "name: own\ntitle: Ours\nscale: {low: 1, high: 3}\nitems: [a, b]\n"


def test_what_the_experiment_says_itself_holds(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(OWN)
    early, late = asked(
        tmp_path, "{file: own.yaml, name: early, when: trial}, {file: own.yaml, title: Late}"
    )
    assert (early.name, early.title, early.when) == ("early", "Ours", "trial")
    assert (late.name, late.title, late.when) == ("own", "Late", "end")
    assert early.items == late.items
    assert (early.items[0].low, early.items[0].high) == (1, 3)


def test_the_file_belongs_to_the_experiment(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(OWN)
    experiment = read(tmp_path, "{file: own.yaml}, {file: own.yaml, name: again}")
    assert [path.name for path in experiment.files].count("own.yaml") == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"when: trial\n{OWN}", "belongs in the experiment"),
        ("title: T\n", "'own.yaml' has no items"),
        ("items: [a]\n", "'own.yaml' has no title and no name"),
        ("- a\n", "expected a questionnaire"),
        (f"{OWN}wen: x\n", "did you mean"),
    ],
)
def test_what_is_wrong_with_a_file(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "own.yaml").write_text(text)
    with pytest.raises(ExperimentError) as refused:
        read(tmp_path, "{file: own.yaml}")
    (problem,) = refused.value.problems
    assert said in problem.message
