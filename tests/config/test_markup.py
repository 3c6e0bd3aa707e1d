"""Markup in sentences, as `woz check` tells of it: what a robot's voice cannot do, at its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.config.loading import load
from woz_tui.drivers import plugins

TAGGED = r"^start(animations/Stand/Gestures/Hey_1) Hello \pau=500\ you \vol=50\ there"
BREAK = "<speak>Good <break time='1s'/> <emphasis>day</emphasis></speak>"
OWN = {
    "simulated": "simulated",
    "pepper": "{drivers: {robot: {type: pepper, robots: [simulated]}}}",
}


def warnings(folder: Path, text: str, own: str = "simulated", robot: str = "") -> list[str]:
    """Warnings about one utterance, which stands in line 4."""
    path = folder / "experiment.yaml"
    quoted = text.replace("'", "''")
    action = f"{{label: A, say: '{quoted}'}}"
    named = own if own.endswith(".yaml") else OWN[own]
    path.write_text(f"title: T\nrobot: {named}\npanels:\n  - {{title: P, actions: [{action}]}}\n")
    loaded = load(path, plugins.installed(), robot=robot)
    return [
        f"{problem.place.line}: {problem.message}"
        for problem in loaded.warnings
        if "does not know" in problem.message
    ]


def test_the_simulated_robot_hides_no_tag_that_its_voice_does_not_know(tmp_path: Path) -> None:
    assert warnings(tmp_path, TAGGED) == [
        "4: the voice of 'robot' does not know ^start(animations/Stand/Gestures/Hey_1),"
        r" \vol=50\: left out of the sentence"
    ]
    assert warnings(tmp_path, r"Hello \pau=500\ \rspd=80\ you") == []


@pytest.mark.parametrize(
    ("robot", "names"),
    [
        ("pepper", []),
        ("nao", []),
        ("servo-head", ["^start", "vol=50"]),
        ("reachy-mini", ["^start", "vol=50"]),
        ("furhat", ["^start", "vol=50"]),
        ("qtrobot", ["^start", "pau=500", "vol=50", "a pause is a comma"]),
    ],
)
def test_what_each_robot_that_comes_along_cannot_say(
    tmp_path: Path, robot: str, names: list[str]
) -> None:
    found = warnings(tmp_path, TAGGED, robot=robot, own="pepper")
    told = " ".join(dict.fromkeys(found))
    assert bool(told) == bool(names)
    assert [name for name in names if name not in told] == []
    assert ("pau=500" in told) == ("pau=500" in names)


def test_another_robot_speaks_of_tags_that_the_files_own_takes(tmp_path: Path) -> None:
    assert warnings(tmp_path, TAGGED, own="pepper") == []
    (found,) = warnings(tmp_path, TAGGED, own="pepper", robot="furhat")
    assert found.startswith("4: the voice of 'furhat' does not know ^start(")


def test_ssml_is_taken_out_for_a_pepper_but_for_what_it_has_tags_for(tmp_path: Path) -> None:
    (found,) = warnings(tmp_path, BREAK, own="pepper")
    assert found == "4: the voice of 'robot' does not know <emphasis>: left out of the sentence"


def test_a_robot_file_says_what_a_voice_behind_ros_can_do(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(
        "name: mine\ndrivers: {ros: {type: ros, address: simulated, verbs: {say: {publish: /tts,"
        " type: std_msgs/String, message: {data: '{text}'}, markup: [tags]}}}}"
    )
    (found,) = warnings(tmp_path, TAGGED, own="mine.yaml")
    assert "^start" in found and "pau=500" not in found


def test_each_condition_and_variant_is_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(
        """title: T
robot: simulated
conditions: [a, b]
panels:
  - title: P
    actions:
      - {label: A, say: {a: Hello, b: "^run(a/b) Hello"}}
"""
    )
    found = [one.message for one in load(path, plugins.installed()).warnings]
    assert found == ["the voice of 'robot' does not know ^run(a/b): left out of the sentence"]
