"""`woz render`: what it computes is exact, safe, and the same every time."""

from __future__ import annotations

import argparse
import itertools
import json
import math
from pathlib import Path
from typing import Any

import pytest

from woz_tui.cli import main, render
from woz_tui.drivers import plugins

HERE = Path(__file__).parents[2]
EYEPI = HERE / "experiments/robots/eyepi.yaml"
FIVE = HERE / "experiments/robots/five-joints.yaml"
SPEEDS = {"pitch": 360.0, "middle": 250.0, "top": 320.0}

CALM = """
drivers:
  body:
    type: body
    joints:
      pitch: {axis: z, min: -90, max: 90, speed: 360}
      middle: {axis: -y, min: 0, max: 90, speed: 250, home: 45}
      top: {axis: y, min: 0, max: 90, speed: 320, home: 30}
    roles: {pan: {pitch: 1}, nod: {top: 1}, lean: {middle: 1}}
    face: {}
    personality: {breathing: 0, blink_rate: 0}
    poses: {shy: {top: 60}}
"""


@pytest.fixture
def calm(tmp_path: Path) -> Path:
    """A robot that neither breathes nor blinks."""
    file = tmp_path / "calm.yaml"
    file.write_text(CALM, encoding="utf-8")
    return file


def rendered(capsys: pytest.CaptureFixture[str], *words: str | Path) -> list[dict[str, Any]]:
    """The lines that `woz render` prints."""
    parser = argparse.ArgumentParser()
    render.add(parser)
    arguments = parser.parse_args([str(word) for word in words])
    assert render.render(arguments, plugins.installed()) == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


@pytest.mark.toolkit("M5", "L9", "P1")
@pytest.mark.parametrize("name", ["nod", "demo", "idle", "saccade"])
def test_the_same_call_gives_the_same_bytes(capsys: pytest.CaptureFixture[str], name: str) -> None:
    runs = []
    for _ in range(2):
        assert main(["render", str(EYEPI), name, "--seconds", "12"]) == 0
        runs.append(capsys.readouterr().out)
    assert runs[0] == runs[1]
    assert len(runs[0].splitlines()) == 601


@pytest.mark.toolkit("R2")
@pytest.mark.parametrize("rate", ["7", "37", "50", "400"])
@pytest.mark.parametrize("name", ["dance", "shake", "demo"])
def test_no_two_lines_differ_by_more_than_the_speed_allows(
    capsys: pytest.CaptureFixture[str], name: str, rate: str
) -> None:
    lines = rendered(capsys, EYEPI, name, "--rate", rate, "--seconds", "8")
    for before, after in itertools.pairwise(lines):
        dt = after["t"] - before["t"]
        for joint, speed in SPEEDS.items():
            assert abs(after["joints"][joint] - before["joints"][joint]) <= speed * dt + 1e-6


@pytest.mark.toolkit("R2")
def test_a_step_over_the_full_range_takes_its_time(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path
) -> None:
    script = tmp_path / "step.jsonl"
    script.write_text(
        '{"t":0,"input":"joints","joints":{"pitch":-90,"middle":0,"top":0}}\n'
        '{"t":2,"input":"joints","joints":{"pitch":90,"middle":90,"top":90}}\n',
        encoding="utf-8",
    )
    lines = rendered(capsys, calm, "idle", "--inputs", script, "--rate", "500", "--seconds", "4")
    for joint, least in (("pitch", 0.500), ("middle", 0.360), ("top", 0.281)):
        arrived = next(line["t"] for line in lines if line["joints"][joint] == 90)
        assert arrived - 2 >= least - 1e-9
        assert arrived - 2 < least + 0.1


@pytest.mark.toolkit("L7")
@pytest.mark.parametrize("name", ["nod", "shake", "dance"])
def test_moves_begin_and_end_at_the_pose_held(
    capsys: pytest.CaptureFixture[str], calm: Path, name: str
) -> None:
    lines = rendered(capsys, calm, name)
    held = {"pitch": 0.0, "middle": 45.0, "top": 30.0}
    assert lines[0]["joints"] == pytest.approx(held, abs=1e-6)
    assert lines[-1]["joints"] == pytest.approx(held, abs=0.05)
    assert any(line["joints"] != pytest.approx(held, abs=2) for line in lines)
    assert lines[10]["move"] == name
    assert "move" not in lines[-1]


@pytest.mark.toolkit("M5")
def test_the_demo_shows_its_emotions_in_order_and_returns_to_normal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    lines = rendered(capsys, EYEPI, "demo", "--rate", "25")
    shown = [emotion for emotion, _ in itertools.groupby(line["emotion"] for line in lines)]
    order = iter(shown)
    assert all(emotion in order for emotion in ("sleepy", "happy", "sad", "angry", "amazed"))
    played = [line["t"] for line in lines if line["mode"] == "demo"]
    assert 50 <= played[-1] - played[0] <= 70
    assert lines[-1]["mode"] == "normal"


@pytest.mark.toolkit("L4")
@pytest.mark.parametrize("rate", ["50", "330"])
def test_a_gaze_is_a_straight_line_that_is_complete_in_time(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path, rate: str
) -> None:
    script = tmp_path / "gaze.jsonl"
    script.write_text('{"t":0.25,"input":"pose","joints":{"pitch":60},"seconds":1.5}\n')
    lines = rendered(capsys, calm, "idle", "--inputs", script, "--rate", rate)
    for line in lines:
        share = min(1.0, max(0.0, (line["t"] - 0.25) / 1.5))
        assert line["joints"]["pitch"] == pytest.approx(60 * share, abs=math.degrees(1e-6))
    assert lines[-1]["joints"]["pitch"] == pytest.approx(60)


@pytest.mark.toolkit("L4")
@pytest.mark.parametrize("rate", ["37", "100", "1000"])
def test_a_fast_line_of_eyepi_is_straight_at_every_rate(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, rate: str
) -> None:
    script = tmp_path / "fast.jsonl"
    script.write_text('{"t":0.5,"input":"pose","joints":{"pitch":75},"seconds":0.25}\n')
    lines = rendered(capsys, EYEPI, "idle", "--inputs", script, "--rate", rate, "--seconds", "1")
    for line in lines:
        share = min(1.0, max(0.0, (line["t"] - 0.5) / 0.25))
        assert line["joints"]["pitch"] == pytest.approx(75 * share, abs=math.degrees(1e-6))


@pytest.mark.toolkit("R6")
@pytest.mark.parametrize("name", ["nod", "dance", "demo", "saccade"])
def test_another_body_renders_all_the_same(capsys: pytest.CaptureFixture[str], name: str) -> None:
    lines = rendered(capsys, FIVE, name, "--rate", "20", "--seconds", "15")
    assert len(lines[0]["joints"]) == 5


def test_a_named_pose_is_held_at_its_end(capsys: pytest.CaptureFixture[str], calm: Path) -> None:
    assert rendered(capsys, calm, "shy")[-1]["joints"]["top"] == pytest.approx(60)


def test_a_blink_is_rendered_to_its_end(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "e.yaml"
    experiment.write_text(
        "title: T\nrobot: calm.yaml\n"
        "panels: [{title: P, actions: [{key: w, label: Wink, blink: }]}]\n",
        encoding="utf-8",
    )
    faces = [line["face"] for line in rendered(capsys, experiment, "Wink")]
    assert faces[0] != min(faces, key=lambda face: sum(int(row, 16) for row in face.split()))
    assert faces[-1] == faces[0]


def test_an_action_is_rendered_with_its_steps_and_pauses(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path
) -> None:
    experiment = tmp_path / "e.yaml"
    experiment.write_text(
        "title: T\nrobot: calm.yaml\npanels:\n  - title: P\n    actions:\n"
        "      - label: Twice\n        steps:\n          - {pose: {pitch: 30}, seconds: 1}\n"
        "          - wait: 0.5\n          - {pose: {pitch: -30}, seconds: 1, mark: there}\n",
        encoding="utf-8",
    )
    parser = argparse.ArgumentParser()
    render.add(parser)
    assert render.render(parser.parse_args([str(experiment), "Twice"]), plugins.installed()) == 0
    out, err = capsys.readouterr()
    at = {line["t"]: line["joints"]["pitch"] for line in map(json.loads, out.splitlines())}
    assert at[1.0] == at[1.4] == pytest.approx(30)
    assert at[2.6] == pytest.approx(-30, abs=1)
    assert "left out, because body cannot do it: mark (session)" in err


@pytest.mark.toolkit("R1")
@pytest.mark.parametrize("angle", [-1000, -90.001, -90, 0, 90, 90.001, 1000])
def test_wild_angles_end_at_the_limits(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path, angle: float
) -> None:
    script = tmp_path / "wild.jsonl"
    joints = dict.fromkeys(SPEEDS, angle)
    script.write_text(json.dumps({"t": 0, "input": "joints", "joints": joints}) + "\n")
    lines = rendered(capsys, calm, "idle", "--inputs", script, "--seconds", "2")
    end = lines[-1]["joints"]
    assert end["pitch"] == max(-90, min(90, angle))
    assert end["middle"] == end["top"] == max(0, min(90, angle))
