"""`woz record-move`: layers by script, out of a session's log and by keys."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest

from tests.fakes.terminal import FakeTerminal
from tests.motion.move_file_bodies import EYEPI
from woz_tui.cli import main
from woz_tui.motion.move_files import read_move

ROOT = Path(__file__).parents[2]
ROBOTS = ROOT / "experiments" / "robots"

SCRIPT = """
{"t": 0.2, "input": "joints", "joints": {"pitch": 10}}
{"t": 0.5, "input": "control", "control": "top", "by": 0.2}
{"t": 1.0, "input": "emotion", "emotion": "happy", "intensity": 0.6}
{"t": 1.2, "input": "joints", "joints": {"pitch": -20}}
"""


def command(*words: str | Path, robot: str = "eyepi") -> int:
    path = ROBOTS / f"{robot}.yaml"
    return main(["record-move", *map(str, words), "--robot", str(path)])


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "hand.jsonl"
    path.write_text(SCRIPT, encoding="utf-8")
    return path


def test_a_script_becomes_a_new_move(
    tmp_path: Path, script: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "act.yaml"
    assert command(file, "--inputs", script) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{file}: act, 1.12 s",
        "  recorded: 1.12 s, samples of pitch, top, 2 frames",
    ]
    move = read_move(file, EYEPI)
    assert move.name == "act"
    assert move.at(0).joints == {"pitch": 0, "top": 0}
    assert move.at(1.12).joints == {"pitch": -20, "top": 18}
    face = move.at(1.12).face
    assert face is not None and (face.emotion, face.intensity) == ("happy", 0.6)


@pytest.mark.toolkit("X2")
def test_the_same_script_gives_the_same_file(tmp_path: Path, script: Path) -> None:
    one, two = tmp_path / "one.yaml", tmp_path / "two.yaml"
    assert command(one, "act", "--inputs", script) == 0
    assert command(two, "act", "--inputs", script) == 0
    assert one.read_bytes() == two.read_bytes()


@pytest.mark.toolkit("X2")
def test_layers_are_added_redone_muted_blended_and_dropped(tmp_path: Path, script: Path) -> None:
    file = tmp_path / "greet.yaml"
    file.write_bytes((ROOT / "experiments/moves/greet.yaml").read_bytes())
    hand = read_move(file, EYEPI).layers[0]
    for layer in ("one", "two", "two"):
        assert command(file, "--inputs", script, "--layer", layer, "--rate", "10") == 0
    assert command(file, "--no-take", "--mute", "one", "--share", "two=0.25") == 0
    move = read_move(file, EYEPI)
    assert [layer.name for layer in move.layers] == ["main", "one", "two"]
    assert move.layers[0] == hand
    assert (move.layers[1].muted, move.layers[2].share) == (True, 0.25)
    assert move.layers[2].samples is not None and move.layers[2].samples.rate == 10
    assert command(file, "--no-take", "--unmute", "one", "--drop", "two") == 0
    assert [layer.muted for layer in read_move(file, EYEPI).layers] == [False, False]


@pytest.mark.toolkit("U1")
def test_what_a_session_s_hand_did_becomes_a_layer(tmp_path: Path) -> None:
    said = [
        {"verb": "control", "args": {"control": "pitch", "value": 0.75}, "t": 1_000_000},
        {"verb": "control", "args": {"control": "pitch", "value": 0.5}, "t": 5_000_000},
        {"verb": "control", "args": {"control": "pitch", "value": 0.6}, "t": 5_500_000},
    ]
    lines = [
        {"kind": "command.requested", "command": f"c{index}", "driver": "body", "source": "midi"}
        | command
        for index, command in enumerate(said)
    ]
    log = tmp_path / "session.jsonl"
    log.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    file = tmp_path / "act.yaml"
    assert command(file, "--inputs", log, "--from", "4", "--seconds", "3") == 0
    samples = read_move(file, EYEPI).layers[0].samples
    assert samples is not None
    assert min(samples.joints["pitch"]) == -45, "relative to where the take began"
    assert samples.joints["pitch"][-1] == -27


@pytest.mark.parametrize(
    "case",
    [
        (["act.yaml"], None, "there is no keyboard here; give the inputs with --inputs"),
        (["act.txt", "--inputs", "s"], None, "move files end in .yaml"),
        (["no/act.yaml", "--inputs", "s"], None, "this folder does not exist"),
        (["7.yaml", "--inputs", "s"], None, "'7' cannot be a move's name"),
        (["act.yaml", "--inputs", "none"], None, "no such file"),
        (["act.yaml", "--inputs", "empty"], None, "this take has no movement"),
        (["act.yaml", "--inputs", "s", "--seconds", "500"], None, "a take of 500 s is too long"),
        (["act.yaml", "--inputs", "s", "--drop", "x"], None, "act has no layer 'x'"),
        (["act.yaml", "--no-take"], None, "no layer left"),
        (["act.yaml", "you", "--inputs", "s"], "frames: [{seconds: 1}]", "holds the move 'act'"),
        (["act.yaml", "--inputs", "s"], "title: x", "act.yaml:1:1: title: unknown"),
        (["act.yaml", "--inputs", "wrong"], None, "wrong:1: no input is called 'jump'"),
    ],
)
def test_what_cannot_be_recorded_is_told_and_changes_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    case: tuple[list[str], str | None, str],
) -> None:
    words, text, said = case
    monkeypatch.chdir(tmp_path)
    Path("s").write_text(SCRIPT)
    Path("empty").write_text("")
    Path("wrong").write_text('{"t": 0, "input": "jump"}')
    if text is not None:
        Path("act.yaml").write_text(text)
    before = {path: path.read_text() for path in tmp_path.iterdir()}
    assert command(*words) == 1
    assert said in capsys.readouterr().err
    assert {path: path.read_text() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize("before", ['"input": "freeze"', '"input": "mode", "mode": "demo"'])
def test_a_take_that_cannot_begin_is_told(
    before: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, inputs = tmp_path / "act.yaml", tmp_path / "hand.jsonl"
    joint = '{"t": 2, "input": "joints", "joints": {"pitch": 10}}'
    inputs.write_text(f'{{"t": 0.5, {before}}}\n{joint}\n', encoding="utf-8")
    assert command(file, "--inputs", inputs, "--from", "1") == 1
    assert "cannot begin at 1 s" in capsys.readouterr().err
    assert not file.exists()


def test_an_input_that_stops_the_other_layers_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, script = tmp_path / "greet.yaml", tmp_path / "s"
    file.write_bytes((ROOT / "experiments/moves/greet.yaml").read_bytes())
    script.write_text(
        '{"t": 0.3, "input": "gaze", "yaw": 20}\n{"t": 0.5, "input": "gaze", "yaw": 999, "x": 1}\n'
    )
    assert command(file, "--inputs", script) == 0
    told = capsys.readouterr().err
    assert f"{script}:2: gaze refused" in told
    assert "an input stopped the other layers" in told


def test_on_a_real_terminal(tmp_path: Path) -> None:
    file = tmp_path / "act.yaml"
    words = ["record-move", str(file), "--robot", str(ROBOTS / "eyepi.yaml"), "--count-in", "0"]
    with FakeTerminal([sys.executable, "-m", "woz_tui", *words]) as terminal:
        terminal.wait_text("REC")
        terminal.send("\x1b[D")
        terminal.wait_text("pitch   +3.0")
        terminal.wait_for(lambda screen: re.search(r"REC +(0\.[2-9]|[1-9])", screen) is not None)
        terminal.send(" ")  # not within the first sample's time
        terminal.wait_text("recorded:")
        assert terminal.wait_exit() == 0
    samples = read_move(file, EYEPI).layers[0].samples
    assert samples is not None and samples.joints["pitch"][-1] == 3
