"""Whatever a WoZ4U file says: it and its conversion are the same experiment, and damage is told."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.config.woz4u.reading import CATALOGUE, converted_text, essence
from tests.example_counts import many
from woz_tui.config.experiment import Experiment
from woz_tui.config.experiment_file import TOP_LEVEL
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.file_text import read_source
from woz_tui.config.loading import load
from woz_tui.config.problems import ProblemReport
from woz_tui.config.woz4u import translate_file
from woz_tui.config.woz4u.woz4u_keys import AUTONOMY, LOCKS, STEPS, VOICE
from woz_tui.config.yaml_nodes import MappingNode, parse_yaml

EXAMPLE = Path(__file__).parents[3] / "experiments" / "woz4u" / "config.yaml"
_ONE_FOLDER = settings(
    deadline=None,
    max_examples=many(40),
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)

tricky = st.sampled_from(
    ["Yes", "no", "12:30", "007", "null", "~", "a: b", "x # y", "- a", "'", '"', "\\vct=50\\",
     "{x}", "{{", "}", "{participant}", "&apos;", "&foo;", "&#65;", "é ü", "日本", "🤖", " a ",
     "^run(a/b)", "a\nb", "tab\there", "\u00a0", "\u2028", "[a]", "*a", "!b", "%c", "@", "`", "|",
     "1e3", "0x1", "=", "<<", "true", "", "y", "a.txt", "../b.txt", "http://a.example/?q={x}&b=#c"]
)  # fmt: skip
words = tricky | st.text(
    st.characters(blacklist_categories=("Cs", "Cc", "Cn"), blacklist_characters="\ufeff"),
    max_size=20,
)
tokens = st.sampled_from(
    ["ctrl", "Control", "shift", "alt", "meta", "a", "b", "c", "r", "C", "1", 1, 2, "F1", "space",
     "ArrowUp", "escape", "/", "+", "plus", "é", "aw", "", " ", "c r", "ctrl+1"]
)  # fmt: skip
combs = st.lists(tokens, max_size=4) | tokens
figures = st.floats(-2, 300, allow_nan=False).map(lambda value: round(value, 3)) | st.just("")
flags = st.sampled_from([True, False, "true", "false", "True", "", None, "maybe"])


def item(**fields: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.fixed_dictionaries(
        {}, optional={"title": words, "tooltip": words, "key_comb": combs, **fields}
    )


def items(**fields: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.lists(item(**fields), max_size=5) | st.none()


animation = st.fixed_dictionaries({}, optional={"duration": figures, "key_comb": combs})
autonomy = st.fixed_dictionaries({}, optional=dict.fromkeys(AUTONOMY, flags | figures))
addresses = st.lists(st.sampled_from(["10.0.0.1", "pepper.local", "simulated"]), max_size=3)
files = st.fixed_dictionaries(
    {"pepper_ips": addresses},
    optional={
        "animated_speech": items(string=words),
        "gestures": items(gesture=words),
        "tablet_items": items(file_name=words, is_default_img=flags),
        "tablet_root_location": words,
        "audio_files": items(location=words),
        "colors": items(red=figures, green=figures, blue=figures, is_default=flags),
        "autonomous_life_config": autonomy,
        "camera_save_dir": words,
        "audio_save_dir": words,
        **dict.fromkeys(LOCKS, flags),
        **dict.fromkeys((*STEPS, *VOICE), figures),
        **dict.fromkeys(("rasta_anim", "random_anim", "rotate_anim"), animation),
        "keyboard": st.sampled_from(["us", "de", "fr"]),
        "zzz": words,
    },
)  # fmt: skip


def write_file(folder: Path, text: str) -> Path:
    path = folder / "config.yaml"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    return path


def same_after_conversion(path: Path) -> Experiment:
    """The experiment, after its conversion has been found to be the same."""
    experiment = load(path, CATALOGUE)
    text = converted_text(path)
    ours = path.with_name("ours.yaml")
    ours.write_text(text, encoding="utf-8")
    again = load(ours, CATALOGUE)
    assert essence(again) == essence(experiment)
    odd = {problem.message.partition(";")[0] for problem in experiment.warnings}
    assert not [
        problem
        for problem in again.warnings
        if problem.message.partition(";")[0] not in odd and "keyboard" not in problem.message
    ]
    return experiment


@_ONE_FOLDER
@given(files)
@example({"pepper_ips": [], "animated_speech": [{"string": "&#xD800; {a}\\"}]})
@example({"pepper_ips": [], "gestures": [{"gesture": "a", "title": "A", "key_comb": "f1 f1"}] * 90})
def test_a_file_that_was_legal_opens_and_its_conversion_is_the_same(
    tmp_path: Path, data: dict[str, Any]
) -> None:
    same_after_conversion(write_file(tmp_path, yaml.safe_dump(data, allow_unicode=True)))


@_ONE_FOLDER
@given(files)
def test_the_text_reads_as_the_very_tree(tmp_path: Path, data: dict[str, Any]) -> None:
    path = write_file(tmp_path, yaml.safe_dump(data, allow_unicode=True))
    made = translate_file(read_source(path, str(path)), TOP_LEVEL).root.node
    ours = tmp_path / "ours.yaml"
    ours.write_text(converted_text(path), encoding="utf-8")
    report = ProblemReport()
    again = parse_yaml(read_source(ours, "ours"), report)
    assert report.errors == []
    assert isinstance(made, MappingNode)
    assert isinstance(again, MappingNode)
    assert bare(again) == bare(made)


def bare(node: Any) -> Any:
    """A tree without places, spellings and quotes."""
    if isinstance(node, MappingNode):
        return {name: bare(value) for name, _, value in node.items()}
    return [bare(inner) for inner in node.nodes] if hasattr(node, "nodes") else node.text


nested = st.recursive(
    words | st.none() | st.booleans() | st.integers() | st.floats() | st.dates(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=8,
)
names = st.sampled_from(
    ["pepper_ips", "animated_speech", "gestures", "tablet_items", "audio_files", "colors", *LOCKS,
     *STEPS, *VOICE, "autonomous_life_config", "tablet_root_location", "rotate_anim", "title",
     "key_comb", "string", "panels", "robot", "script", "session", "variables", "engagement"]
)  # fmt: skip


def check_reading(path: Path) -> None:
    """Reading ends with an experiment, whose conversion is the same, or with problems."""
    try:
        same_after_conversion(path)
    except ExperimentError as error:
        assert error.problems
        for problem in error.problems:
            assert problem.place.line >= 1
            assert problem.path
            assert "\n" not in str(problem)
            assert str(path) in problem.place.file


@_ONE_FOLDER
@given(st.dictionaries(names, nested, max_size=6))
def test_any_data_under_its_keys(tmp_path: Path, data: dict[str, Any]) -> None:
    check_reading(
        write_file(tmp_path, yaml.safe_dump({"pepper_ips": [], **data}, allow_unicode=True))
    )


@pytest.mark.parametrize("seed", range(30))
def test_damaged_files(tmp_path: Path, seed: int) -> None:
    """Characters cut out, put in and swapped; lines dropped, doubled and moved."""
    chance = random.Random(seed)
    lines = EXAMPLE.read_text(encoding="utf-8").splitlines()
    for _ in range(chance.randint(1, 4)):
        at, to = chance.randrange(len(lines)), chance.randrange(len(lines))
        match chance.randrange(4):
            case 0:
                del lines[at]
            case 1:
                lines.insert(to, lines[at])
            case 2:
                lines[at] = lines[at][chance.randint(0, 4) :]
            case _:
                lines[at], lines[to] = lines[to], lines[at]
    text = "\n".join(lines)
    for _ in range(chance.randint(0, 6)):
        at = chance.randrange(len(text))
        text = text[:at] + chance.choice(["", ":", "[", '"', "{", "\t", "&", "\n"]) + text[at + 1 :]
    check_reading(write_file(tmp_path, text))
