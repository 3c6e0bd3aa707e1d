"""What a robot file says of BML, and blocks on keys of an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import errors, panel, read_experiment
from woz_tui.config.bundled_files import robot_files
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load, load_robot_file
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.plugins import installed
from woz_tui.features.blocks.behaviour_calls import UnplayableError
from woz_tui.features.blocks.bml_block import Behaviour
from woz_tui.features.blocks.robot_tables import robot_calls
from woz_tui.features.blocks.section import BLOCKS, BlockReader

#: A file whose robot has the section `bml`.
HEAD = "title: T\nrobot: {drivers: {robot: {type: simulated}}, bml: %s}\n"
KEY = "{key: g, label: Greet, bml: greet.xml}"
TABLE = (
    "{head: {NOD: bow, WAVE: {play: wave, speed: 2}}, faceLexeme: {SMILE: {eyes: green}, "
    "NEUTRAL: {eyes: white}, FROWN: sad}, faceFacs: {12: {emotion: happy, intensity: 0.5}}, "
    "locomotion: {door: {drive: 2}}, targets: {door: [60, -5]}, posture: {SITTING: bow}}"
)


def calls(folder: Path, kind: str, table: str = TABLE, **attributes: str) -> list[str]:
    """What is done for a behaviour, in words."""
    path = folder / "experiment.yaml"
    path.write_text(panel("{key: h, label: H, say: Hi}", head=HEAD % table), encoding="utf-8")

    experiment = load(path, installed())
    robot = robot_calls(experiment.drivers, BLOCKS.of(experiment).tables, installed(), folder)
    return [call.words for call in robot.calls(Behaviour(kind, "x", attributes))]


@pytest.mark.parametrize(
    ("kind", "attributes", "done"),
    [
        ("head", {"lexeme": "NOD"}, ["play bow"]),
        ("head", {"lexeme": "SHAKE"}, ["play shake"]),
        ("head", {"lexeme": "nod", "repetition": "2"}, ["play bow", "play bow"]),
        ("gesture", {"lexeme": "WAVE"}, ["play wave, speed 2"]),
        ("faceLexeme", {"lexeme": "SMILE"}, ["eyes green", "eyes white"]),
        ("faceLexeme", {"lexeme": "JOY"}, ["eyes green", "eyes white"]),
        ("faceLexeme", {"lexeme": "FROWN"}, ["emotion sad", "eyes white"]),
        ("faceShift", {"lexeme": "SMILE"}, ["eyes green"]),
        ("faceFacs", {"au": "12"}, ["emotion happy, intensity 0.5", "eyes white"]),
        ("faceFacs", {"au": "AU4"}, ["emotion angry", "eyes white"]),
        ("locomotion", {"target": "door"}, ["drive x 2"]),
        ("locomotion", {"target": "0.5, -1"}, ["drive x 0.5, y -1"]),
        ("gazeShift", {"target": "Door"}, ["gaze yaw 60, pitch -5"]),
        ("pointing", {"target": "door"}, ["play point-left"]),
        ("posture", {"stance": "sitting"}, ["play bow"]),
    ],
)
def test_the_table_comes_before_what_is_usual(
    tmp_path: Path, kind: str, attributes: dict[str, str], done: list[str]
) -> None:
    assert calls(tmp_path, kind, **attributes) == done


@pytest.mark.parametrize("robot", ["simulated", "pepper", "nao", "furhat", "reachy-mini", "eyepi"])
def test_robots_play_the_core_without_a_word_about_it(robot: str) -> None:

    file = robot_files(None)[robot]
    read = load_robot_file(file, installed()).sections[BLOCKS]
    assert isinstance(read, BlockReader)
    own = read.calls("")
    for kind, attributes in (
        ("head", {"lexeme": "NOD"}),
        ("head", {"lexeme": "SHAKE"}),
        ("gesture", {"lexeme": "BEAT"}),
        ("gesture", {"lexeme": "WAVE"}),
        ("pointing", {"target": "left"}),
        ("gaze", {"target": "visitor"}),
        ("faceLexeme", {"lexeme": "SMILE"}),
        ("faceFacs", {"au": "15"}),
    ):
        assert own.calls(Behaviour(kind, "x", attributes)), (kind, attributes)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("{heads: {}}", "bml.heads: unknown; did you mean 'head'?"),
        ("{head: {NOD: nodd}}", "bml.head.NOD"),
        ("{head: {NOD: {plays: nod}}}", "did you mean 'play'?"),
        ("{faceLexeme: {SMILE: {eyes: green, secs: 3}}}", "secs"),
        ("{locomotion: {door: kitchen}}", "name another verb"),
        ("{targets: {door: [1]}}", "yaw and pitch"),
        ("{targets: {door: [400, 0]}}", "out of range"),
        ("nod", "expected a mapping"),
    ],
)
def test_mistakes_have_their_place_and_a_remedy(tmp_path: Path, table: str, said: str) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(panel("{key: h, label: H, say: Hi}", head=HEAD % table), encoding="utf-8")

    with pytest.raises(ExperimentError) as caught:
        load(path, installed())
    [problem] = caught.value.problems
    assert problem.place.line == 2
    assert said in str(problem)


# -- on keys ---------------------------------------------------------------------------------------


def with_block(folder: Path, block: str) -> str:
    """An experiment file with a key whose block this is."""
    (folder / "greet.xml").write_text(block, encoding="utf-8")
    return panel(KEY)


def test_a_block_on_a_key_is_read_with_the_experiment(tmp_path: Path) -> None:
    text = with_block(tmp_path, '<bml id="b"><speech id="s"><text>Hi</text></speech></bml>')
    experiment = read_experiment(tmp_path, text)
    assert not experiment.warnings
    assert tmp_path / "greet.xml" in experiment.files
    assert [*BLOCKS.of(experiment).texts] == ["greet.xml"]
    with_block(tmp_path, '<bml id="b"><speech id="s"><text>Ho</text></speech></bml>')
    after = read_experiment(tmp_path, text)
    assert compare(experiment, after).changes == ("block of BML 'greet.xml' changed",)


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ('<bml id="b">\n\n<speech', "line 3"),
        ("<bml/>", "has no id"),
        (
            '<bml id="b"><required><speech id="s" start="2" end="1"><text>Hi</text></speech>'
            "</required></bml>",
            "s: ",
        ),
    ],
)
def test_a_block_that_cannot_be_played_is_an_error(tmp_path: Path, block: str, said: str) -> None:
    [error] = errors(tmp_path, with_block(tmp_path, block))
    assert error.startswith("6:")
    assert "greet.xml: " in error
    assert said in error


def test_what_of_a_block_is_left_out_is_warned_of(tmp_path: Path) -> None:
    block = '<bml id="b"><gaze id="g" target="moon"/><head id="n" lexeme="JUMP"/></bml>'
    warnings = read_experiment(tmp_path, with_block(tmp_path, block)).warnings
    assert len(warnings) == 2
    assert all("greet.xml: " in each.message for each in warnings)


def test_a_key_needs_a_file_or_a_block(tmp_path: Path) -> None:
    [missing] = read_experiment(tmp_path, panel(KEY)).warnings
    assert "greet.xml" in missing.message
    [both] = errors(tmp_path, panel("{key: g, label: G, bml: {file: a.xml, block: b}}"))
    assert "either" in both
    experiment = read_experiment(
        tmp_path, panel("{key: g, label: G, bml: {block: '<bml id=\"b\"/>'}}")
    )
    assert not experiment.warnings


def test_several_robots_are_told_apart_by_the_character(tmp_path: Path) -> None:
    head = "title: T\nrobots: {left: simulated, right: simulated}\n"
    named = '<bml id="b" character="left"><speech id="s"><text>Hi</text></speech></bml>'
    (tmp_path / "greet.xml").write_text(named, encoding="utf-8")
    assert not read_experiment(tmp_path, panel(KEY, head=head)).warnings
    (tmp_path / "greet.xml").write_text(named.replace("left", "middle"), encoding="utf-8")
    [error] = errors(tmp_path, panel(KEY, head=head))
    assert "character" in error


def test_a_robot_without_a_table_has_what_is_usual() -> None:
    with pytest.raises(UnplayableError):
        robot_calls([], {}, CATALOGUE, Path()).calls(Behaviour("head", "n", {"lexeme": "NOD"}))
