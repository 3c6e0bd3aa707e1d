"""Whatever stands in a file, reading it ends with an experiment or with an `ExperimentError`."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.config.catalogue import CATALOGUE
from tests.config.golden import BROKEN
from woz_tui.config.annotated_decoder import names_of
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.file_text import SourceFile, decode_utf8
from woz_tui.config.loading import load
from woz_tui.config.problems import ProblemReport
from woz_tui.config.study import Study
from woz_tui.config.yaml_nodes import parse_yaml

GOOD, STUDY = (
    (Path(__file__).parent / "good" / f"{name}.yaml").read_text(encoding="utf-8")
    for name in ("everything", "study")
)
_ONE_FOLDER = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])

words = st.sampled_from(
    ["title", "robot", "robots", "simulated", "panels", "actions", "key", "label", "say", "steps",
     "wait", "pose", "poses", "pan", "on", "drivers", "type", "head", "voice", "joints", "script",
     "variables", "conditions", "participants", "pattern", "session", "dead_man", "keyboard", "<<",
     "engagement", "on_enter", "Wait", "toggle", "sense", "value", "gaze", "force", "{visitor}",
     "emotion", "happy", "set", "lock", "ctrl+3", "1e400", "-0", "0x10", "{a}", "{", "No", "~", ""]
)  # fmt: skip
nested = st.recursive(
    words | st.text(max_size=5) | st.integers().map(str) | st.floats().map(str),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words, inner, max_size=5),
    max_leaves=30,
)


def flow(value: object) -> str:
    """YAML text of nested data, every scalar in quotes or plain as chance has it."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{flow(k)}: {flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    text = str(value)
    if text.isalnum():
        return text
    return '"' + "".join(f"\\U{ord(c):08x}" if c in '"\\\n' else c for c in text) + '"'


def read_any(folder: Path, data: bytes) -> Experiment | None:
    path = folder / "e.yaml"
    path.write_bytes(data)
    try:
        return load(path, CATALOGUE)
    except ExperimentError as error:
        assert error.problems
        for problem in error.problems:
            assert problem.place.line >= 1
            assert problem.place.column >= 1
            assert problem.path
            assert problem.message
            assert "\n" not in str(problem)
        return None


@_ONE_FOLDER
@given(st.text(max_size=200))
@example("a: &a [*a]")
@example("? ? ? x")
@example("{" * 200)
@example("- " * 200)
@example("%TAG ! x")
@example("key: !<tag:yaml.org,2002:python/object/apply:os.system> [x]")
@example("\x85\u2028: \u2029")
def test_any_text(tmp_path: Path, text: str) -> None:
    read_any(tmp_path, text.encode("utf-8", "surrogatepass"))


@_ONE_FOLDER
@given(st.binary(max_size=200))
def test_any_bytes(tmp_path: Path, data: bytes) -> None:
    read_any(tmp_path, data)


@_ONE_FOLDER
@given(st.dictionaries(words, nested, max_size=6))
def test_any_data(tmp_path: Path, data: dict[str, object]) -> None:
    read_any(tmp_path, flow(data).encode("utf-8", "replace"))


@_ONE_FOLDER
@given(nested, st.sampled_from(["actions", "say", "key", "steps", "pose", "poses", "on", "set"]))
def test_any_data_in_an_action(tmp_path: Path, value: object, where: str) -> None:
    action = f"{{label: A, say: Hi, {where}: {flow(value)}}}".replace("say: Hi, say", "say")
    text = f"title: T\nrobot: simulated\npanels: [{{title: P, actions: [{action}]}}]\n"
    read_any(tmp_path, text.encode("utf-8", "replace"))


studied = st.recursive(
    st.sampled_from(
        ["name", "title", "items", "scale", "low", "high", "ends", "when", "end", "text", "yes",
         "order", "blocks", "block", "within", "blind", "warm", "cold", "trials", "seed", "cues",
         "cue", "question", "says", "answers", "A", "window", "speech", "floor", "jitter", "hide",
         "blur", "distance", "transcript", "1", "-3", "2 s", "optional", "introduction", ""]
    ),
    lambda inner: st.lists(inner, max_size=4)
    | st.dictionaries(st.sampled_from(["name", "title", "items", "scale", "low", "high", "ends",
        "when", "text", "question", "order", "within", "blind", "block", "warm", "cold", "cues",
        "cue", "says", "answers", "floor", "hide", "blur"]), inner, max_size=5),
    max_leaves=30,
)  # fmt: skip


@_ONE_FOLDER
@given(studied, st.sampled_from([*names_of(Study), "variables"]))
def test_any_data_in_a_section_of_the_study(tmp_path: Path, value: object, section: str) -> None:
    head = f"title: T\nrobot: simulated\nconditions: [warm, cold]\n{section}: {flow(value)}\n"
    text = f"{head}panels: [{{title: P, actions: [{{label: A, say: Hi}}]}}]\n"
    read_any(tmp_path, text.encode("utf-8", "replace"))


@_ONE_FOLDER
@given(nested)
def test_any_data_as_a_robot(tmp_path: Path, value: object) -> None:
    text = f"title: T\nrobot: {flow(value)}\npanels: [{{title: P, actions: []}}]\n"
    read_any(tmp_path, text.encode("utf-8", "replace"))


@_ONE_FOLDER
@given(nested)
def test_any_data_as_settings(tmp_path: Path, value: object) -> None:
    voice = f"{{voice: {{type: voice, extra: {flow(value)}, words: {flow(value)}}}}}"
    text = f"title: T\nrobot: {{drivers: {voice}}}\npanels: [{{title: P, actions: []}}]\n"
    read_any(tmp_path, text.encode("utf-8", "replace"))


@pytest.mark.parametrize("text", [GOOD, STUDY], ids=["everything", "study"])
@_ONE_FOLDER
@given(chance=st.randoms(use_true_random=False))
def test_a_right_file_with_a_part_cut_out_or_doubled(
    tmp_path: Path, chance: random.Random, text: str
) -> None:
    for _ in range(chance.randint(1, 4)):
        begin = chance.randrange(len(text))
        end = min(len(text), begin + chance.randint(0, 30))
        text = text[:begin] + chance.choice(["", text[begin:end] * 2, "\t", "'"]) + text[end:]
    read_any(tmp_path, text.encode())


@pytest.mark.parametrize("name", sorted(path.name for path in BROKEN.glob("*.yaml")))
def test_every_beginning_of_a_file_is_read_without_a_crash(tmp_path: Path, name: str) -> None:
    data = (BROKEN / name).read_bytes()
    for length in range(0, len(data), max(1, len(data) // 20)):
        read_any(tmp_path, data[:length])


@given(st.text(alphabet=st.characters(exclude_categories=["Cs"]), max_size=60))
def test_quoted_text_comes_back_as_it_was(text: str) -> None:
    quoted = '"' + "".join(f"\\U{ord(character):08x}" for character in text) + '"'
    report = ProblemReport()
    node = parse_yaml(SourceFile("f", Path("f"), b"", f"a: {quoted}"), report)
    assert not report.errors
    assert getattr(getattr(node, "entries", {})["a"], "text", None) == text


@given(st.binary(max_size=50))
def test_text_of_utf_8_is_what_python_reads(data: bytes) -> None:
    try:
        text = decode_utf8(data)
    except Exception as error:  # noqa: BLE001 - the class is what is asserted
        assert type(error).__name__ == "SourceFileError"
    else:
        assert text == data.decode("utf-8-sig")
