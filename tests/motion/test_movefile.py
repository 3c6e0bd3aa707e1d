"""Files of moves: what they mean, and what is said about those that are wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from tests.motion.move_file_bodies import EYEPI, FIVE, HEADS
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, LayerSamples, MoveLayer
from woz_tui.motion.move_files import (
    MAIN,
    MoveFileError,
    read_folder,
    read_move,
    read_moves,
)
from woz_tui.motion.move_schema import move_schema
from woz_tui.motion.move_types import SoundCue

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "experiments" / "moves"


def write_move_file(folder: Path, text: str, name: str = "test.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def problems(path: Path) -> list[str]:
    """Every error and warning, as `line:column: path: message`."""
    move_folder = read_folder(path.parent, EYEPI)
    start = f"{path.parent}/"
    return [str(problem).replace(start, "") for problem in move_folder.problems]


def test_everything_a_file_can_say(tmp_path: Path) -> None:
    write_move_file(tmp_path, "", "gong.wav")
    path = write_move_file(
        tmp_path,
        """
name: greet
about: "hello: nods"
relative: no
beats: false
stays: on
frames:
  - {seconds: 0, top: 60}
  - {seconds: 250 ms, nod: 12, easing: linear, emotion: happy, intensity: 0.8,
     eyes: {x: 0.2, y: -1}, lid: 0.5, sound: gong.wav, volume: 0.4}
  - {at: 1, roles: {pan: 3}, joints: {middle: 50}}
layers:
  - {name: twitch, relative: true, share: 0.5, mix: replace, muted: yes,
     frames: [{seconds: 1, top: -3}]}
  - name: recorded
    rate: 2
    joints: {pitch: [0, 1.5, -2], top: 60 61 62}
    face: {lid: 1 0 1}
""",
    )
    assert read_move(path, EYEPI) == KeyframeMove(
        "greet",
        "hello: nods",
        (
            MoveLayer(
                MAIN,
                (
                    KeyFrame(0, joints={"top": 60}),
                    KeyFrame(
                        0.25, {"nod": 12}, easing="linear", emotion="happy", intensity=0.8,
                        x=0.2, y=-1, lid=0.5, sound=str(tmp_path / "gong.wav"), volume=0.4,
                    ),
                    KeyFrame(1, {"pan": 3}, {"middle": 50}),
                ),
                relative=False,
            ),
            MoveLayer(
                "twitch", (KeyFrame(1, joints={"top": -3}),), share=0.5, mix="replace", muted=True
            ),
            MoveLayer(
                "recorded",
                samples=LayerSamples(
                    2, joints={"pitch": (0, 1.5, -2), "top": (60, 61, 62)}, face={"lid": (1, 0, 1)}
                ),
                relative=False,
            ),
        ),
        stays=True,
    )  # fmt: skip


def test_without_a_name_it_is_called_as_its_file(tmp_path: Path) -> None:
    write_move_file(tmp_path, "frames: [{seconds: 1, nod: 3}]", "wink.yaml")
    write_move_file(tmp_path, "frames: [{seconds: 1, nod: 3}]", "blush.yml")
    write_move_file(tmp_path, "no move", "notes.txt")
    write_move_file(tmp_path, "no move", ".hidden.yaml")
    assert list(read_moves(tmp_path, EYEPI)) == ["blush", "wink"]


def test_beats_are_counted_in_beats(tmp_path: Path) -> None:
    move = read_move(write_move_file(tmp_path, "beats: true\nframes: [{beats: 2}, {at: 3}]"), EYEPI)
    assert move.beats and move.length == 3


def test_a_name_that_is_both_is_a_role_but_an_angle_of_a_joint_if_absolute(tmp_path: Path) -> None:
    five = read_move(write_move_file(tmp_path, "frames: [{seconds: 1, nod: 3, neck: 4}]"), FIVE)
    assert five.layers[0].frames[0].roles == {"nod": 3}
    assert five.layers[0].frames[0].joints == {"neck": 4}


def test_sounds_are_cues(tmp_path: Path) -> None:
    path = write_move_file(tmp_path, "frames: [{seconds: 1}, {seconds: 1, sound: /x/a.wav}]")
    assert read_move(path, EYEPI).cues == (SoundCue(2, "/x/a.wav"),)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "test.yaml:1:1: file: expected a move, such as name: greet, not nothing"),
        ("- a", "test.yaml:1:1: file: expected a move, such as name: greet, not a list"),
        ("name: greet", "test.yaml:1:1: frames: is missing (frames: [{seconds: 0.3, nod: 12}"),
        ("framse: []", "test.yaml:1:1: framse: unknown; did you mean 'frames'?"),
        ("frames: []", "test.yaml:1:1: frames: no frame stands here"),
        ("frames: [{seconds: 0}]", "test.yaml:1:1: frames: takes no time"),
        ("name: 2 left\nframes: [{seconds: 1}]", "test.yaml:1:1: name: '2 left' cannot be"),
        ("name: nod\nframes: [{seconds: 1}]", "warning: name: takes the place of the built-in"),
        ("frames: [{nod: 3}]", "test.yaml:1:10: frames[0].seconds: is missing (how long"),
        ("frames: [{seconds: -1}]", "frames[0].seconds: -1 is out of range"),
        ("frames: [{at: -1}]", "frames[0].at: -1 is out of range"),
        ("frames: [{seconds: 1}, {seconds: 0}]", "frames[1].seconds: must be more than 0"),
        ("frames: [{at: 2}, {at: 1.5}]", "frames[1].at: 1.5 is not after the frame before, which"),
        ("frames: [{at: 2, seconds: 1}]", "frames[0].at: write either seconds"),
        ("frames: [{beats: 2}]", "frames[0].beats: this move counts seconds (beats: false)"),
        ("beats: yes\nframes: [{seconds: 2}]", "frames[0].seconds: this move counts beats"),
        ("frames: [{seconds: 1000}]", "frames[0].seconds: 1000 is out of range"),
        ("frames: [{seconds: 130}]", "warning: frames: takes 130 s; play waits for 120 s at most"),
        ("frames: [{seconds: 1, nodd: 3}]", "frames[0].nodd: unknown; did you mean 'nod'?"),
        ("frames: [{seconds: 1, tpo: 3}]", "frames[0].tpo: unknown; did you mean 'top'?"),
        ("frames: [{seconds: 1, xyz: 3}]", "frames[0].xyz: unknown; settings here are: pan, nod"),
        ("frames: [{seconds: 1, joints: {nod: 3}}]", "frames[0].joints.nod: unknown"),
        ("frames: [{seconds: 1, roles: {top: 3}}]", "frames[0].roles.top: unknown"),
        ("frames: [{seconds: 1, nod: up}]", "frames[0].nod: expected a number"),
        ("frames: [{seconds: 1, nod: .nan}]", "frames[0].nod: expected a number"),
        ("frames: [{seconds: 1, nod: 400}]", "frames[0].nod: 400 is out of range; allowed is -360"),
        ("frames: [{seconds: 1, top: 95}]", "warning: frames[0].top: 95 degrees are more than"),
        (
            "relative: false\nframes: [{seconds: 1, top: 95}]",
            "test.yaml:2:23: frames[0].top: 95 lies outside the joint's range, 0 to 90 degrees",
        ),
        ("frames: [{seconds: 1, easing: sooth}]", "easing: 'sooth' is not known; did you mean 'sm"),
        ("frames: [{seconds: 1, emotion: hapy}]", "'hapy' is not known; did you mean 'happy'?"),
        ("frames: [{seconds: 1, intensity: 2}]", "frames[0].intensity: 2 is out of range"),
        ("frames: [{seconds: 1, eyes: {z: 1}}]", "eyes.z: unknown; settings here are: x, y"),
        ("frames: [{seconds: 1, sound: a.wav}]", "warning: frames[0].sound: there is no file 'a.w"),
        ("frames: [{seconds: 1, volume: 0.5}]", "warning: frames[0].volume: there is no sound"),
        ("layers: [{frames: [{seconds: 1}]}]", "layers[0].name: is missing"),
        ("layers: [{name: a}]", "layers[0]: has neither frames nor samples"),
        ("layers: [{name: a, rate: 5}]", "layers[0].rate: there are no samples"),
        ("layers: [{name: a, joints: {top: 1}}]", "layers[0].rate: is missing (samples each"),
        ("layers: [{name: a, rate: 0, joints: {top: 1}}]", "layers[0].rate: 0 is out of range"),
        ("layers: [{name: a, rate: 5, joints: {pitsh: 1}}]", "joints.pitsh: unknown; did you mean"),
        ("layers: [{name: a, rate: 5, joints: {top: 1 x}}]", "top: sample 2: 'x' is no number"),
        ("layers: [{name: a, rate: 5, roles: {nod: 1 999}}]", "nod: sample 2: '999' is out of"),
        ("layers: [{name: a, rate: 5, roles: {nod: []}}]", "roles.nod: no number stands here"),
        ("layers: [{name: a, rate: 5, face: {mouth: 1}}]", "face.mouth: unknown; samples of a"),
        (
            "relative: no\nlayers: [{name: a, rate: 5, joints: {top: 1 91}}]",
            "joints.top: 91 lies outside the joint's range",
        ),
        (
            "layers: [{name: a, rate: 5, joints: {top: 1 2}, frames: [{seconds: 1, top: 3}]}]",
            "layers[0]: top is in this layer's frames and in its samples; use two layers",
        ),
        (
            "frames: [{seconds: 1}]\nlayers: [{name: main, frames: [{seconds: 1}]}]",
            "test.yaml:2:10: layers[0]: there is a layer 'main' already",
        ),
        ("frames: [{seconds: 1}]\nlayers: 5", "test.yaml:2:1: layers: expected a list of layers"),
        ("name: [", "YAML:"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_its_place(tmp_path: Path, text: str, expected: str) -> None:
    found = problems(write_move_file(tmp_path, text))
    assert any(expected in problem for problem in found), found


def test_all_errors_of_all_files_at_once(tmp_path: Path) -> None:
    write_move_file(tmp_path, "frames: [{seconds: 1, nodd: 1}, {seconds: 1, easing: no}]", "a.yaml")
    write_move_file(tmp_path, "name: same\nframes: [{seconds: 1}]", "b.yaml")
    write_move_file(tmp_path, "name: same\nframes: [{seconds: 1}]", "c.yaml")
    (tmp_path / "d.yaml").write_bytes(b"\xff\xfe")
    with pytest.raises(MoveFileError) as caught:
        read_moves(tmp_path, EYEPI)
    lines = [str(problem).removeprefix(f"{tmp_path}/") for problem in caught.value.problems]
    assert [line.split(": ")[0] for line in lines] == [
        "a.yaml:1:23", "a.yaml:1:46", "c.yaml:1:1", "d.yaml:1:1",
    ]  # fmt: skip
    assert "'same' is the move of b.yaml" in lines[2]


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(MoveFileError, match="No such file"):
        read_moves(tmp_path / "nowhere", EYEPI)


# -- the examples -------------------------------------------------------------------------------


@pytest.mark.toolkit("R6")
@pytest.mark.parametrize("body", HEADS)
def test_the_examples_fit_any_body(body: str) -> None:
    move_folder = read_folder(EXAMPLES, HEADS[body])
    assert move_folder.problems == ()
    assert {"greet", "laugh", "think", "startle", "sigh"} <= move_folder.moves.keys()


@pytest.mark.toolkit("L7")
def test_the_examples_end_where_they_began() -> None:
    for move in read_moves(EXAMPLES, EYEPI).values():
        assert all(angle == 0 for angle in move.at(0).roles.values())
        assert all(angle == 0 for angle in move.at(move.length).roles.values())


# -- the schema ---------------------------------------------------------------------------------


def fits(data: Any) -> bool:
    return jsonschema.Draft202012Validator(move_schema()).is_valid(data)


def test_the_schema_is_one() -> None:
    jsonschema.Draft202012Validator.check_schema(move_schema())


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_examples_fit_the_schema(path: Path) -> None:
    assert fits(yaml.safe_load(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("frames: [{seconds: 1, top: 3, nod: 3}]", True),
        ("frames: [{seconds: 1, top: up}]", False),
        ("frames: [{seconds: 250 ms}]", True),
        ("frames: [{nod: 1}]", False),
        ("frames: [{seconds: 1, at: 1}]", False),
        ("frames: [{seconds: 1, emotion: hapy}]", False),
        ("layers: [{name: a, rate: 5, joints: {top: 1 2 3, pitch: [1, 2]}}]", True),
        ("layers: [{name: a, joints: {top: 1 2 3}}]", False),
        ("layers: [{name: a}]", False),
        ("name: greet", False),
    ],
)
def test_what_editors_are_told(text: str, expected: bool) -> None:
    assert fits(yaml.safe_load(text)) is expected
