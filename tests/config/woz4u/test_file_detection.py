"""Which files are taken for WoZ4U files, and how what is wrong with them is told."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.woz4u.reading import (
    CATALOGUE,
    keys,
    messages,
    panel,
    problems,
    read_experiment,
    titles,
)
from woz_tui.config.experiment_file import TOP_LEVEL
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.file_text import SourceFile
from woz_tui.config.loading import load
from woz_tui.config.problems import ProblemReport
from woz_tui.config.woz4u import recognised
from woz_tui.config.yaml_nodes import MappingNode, parse_yaml
from woz_tui.features.scripts.section import SCRIPT


@pytest.mark.parametrize(
    ("text", "theirs"),
    [
        ("pepper_ips: [10.0.0.2]", True),
        ("lock_gesture_section: 'false'", True),
        ("autonomous_life_config: {}\nkeyboard: de\ngestures: []", True),
        ("volume: 1\nvoice_speed: 100", False),
        ("title: T\ngestures: []", False),
        ("pepper_ips: []\nrobot: simulated", False),
        ("gestures: []\ncolors: []\npanels: []", False),
        ("title: T\nrobots: {a: simulated}\ncolors: []\ngestures: []", False),
        ("messages: [{short: Hello, full_text: Hello there}]", True),
        ("talk: [{title: Hello, string: Hello there}]", True),
        ("messages: [{short: Hello, full_text: Hello there}]\npanels: []", False),
        ("questionnaires: [{title: Hello, text: Hello there}]", False),
        ("name: head\ndrivers: {}", False),
        ("{}", False),
    ],
)
def test_what_is_taken_for_a_woz4u_file(text: str, theirs: bool) -> None:
    node = parse_yaml(SourceFile("x", Path("x"), b"", text), ProblemReport())
    assert isinstance(node, MappingNode)
    assert recognised(node, TOP_LEVEL) is theirs


def test_one_word_of_theirs_does_not_hide_what_is_wrong_with_a_file_of_ours(
    tmp_path: Path,
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("title: Mine\nrobot: simulated\ngestures: []\n", encoding="utf-8")
    with pytest.raises(ExperimentError) as caught:
        load(path, CATALOGUE)
    assert "panels: is missing" in str(caught.value)
    assert "gestures: unknown" in str(caught.value)


def test_the_title_names_the_file_unless_it_says_one(tmp_path: Path) -> None:
    assert read_experiment(tmp_path, "").title == "WoZ4U: config.yaml"
    assert read_experiment(tmp_path, "title: Museum\ngestures: []\n").title == "Museum"


def test_sections_of_ours_may_stand_in_the_file(tmp_path: Path) -> None:
    text = """animated_speech:
  - {title: Hello, string: Hello}
  - {title: Bye, string: Bye}
gestures: []
colors: []
conditions: [short, long]
script: [Hello, Bye]
participants: {pattern: 'V\\d\\d'}
"""
    experiment = read_experiment(tmp_path, text)
    assert experiment.conditions == ("short", "long")
    assert SCRIPT.of(experiment) == ("Hello", "Bye")
    assert experiment.participant_pattern == r"V\d\d"
    (problem,) = problems(tmp_path, text.replace("[Hello, Bye]", "[Hello, Buy]"))
    assert problem == "8:17: script[1]: there is no action 'Buy'; did you mean 'Bye'?"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("gestres: []", "gestres: this key is not used; did you mean 'gestures'?"),
        ("zzz: 1", "zzz: this key is not used"),
        ("images: []", "images: this key is now called 'tablet_items'; it is read as that"),
        (
            "steps: {head: 3}",
            "steps: a WoZ4U file has no such key; convert the file to change it (woz convert)",
        ),
        (
            "gestures: [{title: A, gesture: a/b, tool_tip: b}]",
            "gestures[0].tool_tip: this key is not used; did you mean 'tooltip'?",
        ),
        (
            "rasta_anim: {durations: 3}",
            "rasta_anim.durations: this key is not used; did you mean 'duration'?",
        ),
    ],
)
def test_keys_that_nothing_reads(tmp_path: Path, text: str, message: str) -> None:
    assert messages(tmp_path, f"{text}\n") == [f"warning: {message}"]


def test_of_two_equal_keys_the_last_one_counts_as_it_did_there(tmp_path: Path) -> None:
    text = "gestures:\n  - {title: A, gesture: a/b, title: B}\n"
    assert [
        action.label for action in panel(read_experiment(tmp_path, text), "Gestures").actions
    ] == ["B"]
    assert problems(tmp_path, text) == [
        "3:30: warning: gestures[0].title: 'title' appears twice (first in line 3)"
    ]


def test_missing_and_empty_sections(tmp_path: Path) -> None:
    empty = "".join(f"{name}:\n" for name in ("gestures", "colors", "rasta_anim", "volume"))
    text = f"{empty}animated_speech: []\ntablet_items: ~\ndefault_turn_deg: ''\n"
    assert titles(read_experiment(tmp_path, text)) == ["Movement", "Autonomy"]
    assert problems(tmp_path, text) == []


def test_what_the_decoder_finds_has_the_names_and_places_of_the_file(tmp_path: Path) -> None:
    """The tree that is decoded is of our own format; nobody who wrote this file has seen that."""
    text = """camera_save_dir: x
rotate_anim:
  duration: 3
gestures:
  - title: Wave
    gesture: a
keyboard: martian
"""
    (problem,) = problems(tmp_path, text)
    assert problem.startswith("8:1: keyboard: 'martian' is not known")
    path = tmp_path / "config.yaml"
    with pytest.raises(ExperimentError) as caught:
        load(path, {})
    assert f"{path}:1:1: robot.drivers.pepper.type: there is no driver of type 'pepper'" in str(
        caught.value
    )


def test_errors_of_both_readings_come_together_in_the_order_of_the_file(tmp_path: Path) -> None:
    text = "gestures: nothing\nconditions: 5\npepper_ips: [[]]\nkeyboard: martian\n"
    found = [problem.split(" ")[1] for problem in problems(tmp_path, text, start="")]
    assert found == ["gestures:", "conditions:", "pepper_ips[0]:", "keyboard:"]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("gestures:\n\t- title: A\n", "3:1"),
        ("gestures:\n  - title: 'A\n", "3:12"),
        ("gestures: [a: b: c]\n", "2:16"),
        ("volume: !!python/object:x 1\n", "2:9"),
    ],
)
def test_what_is_no_yaml_is_told_as_ever(tmp_path: Path, text: str, place: str) -> None:
    assert problems(tmp_path, text)[0].split(" ")[0] == f"{place}:"


def test_anchors_and_merges(tmp_path: Path) -> None:
    text = """gestures:
  - &base {title: Wave, gesture: a/Hey_1, key_comb: [w]}
  - <<: *base
    title: Wave again
  - *base
"""
    experiment = read_experiment(tmp_path, text)
    assert keys(experiment) == {"Wave": "w", "Wave again": "a", "Wave (Gestures)": "v"}
