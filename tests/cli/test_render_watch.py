"""`woz render --keys --watch`: the frames of a move beside its curves, anew at each save."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.test_render import CALM
from woz_tui.cli import render
from woz_tui.cli.file_watch import watch
from woz_tui.drivers import plugins
from woz_tui.motion.render_target import RenderError

NOD = """
name: bow-down
frames:
  - {seconds: 0.5, nod: 20}
  - {seconds: 0.5, nod: 0}
"""
FAST = """
name: bow-down
frames:
  - {seconds: 0.1, nod: 50}
  - {seconds: 0.1, nod: 0}
layers:
  - name: eyes
    muted: true
    frames: [{seconds: 0.5, lid: 0.5}]
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    file = tmp_path / "calm.yaml"
    file.write_text(CALM, encoding="utf-8")
    return file


@pytest.fixture
def move(tmp_path: Path) -> Path:
    file = tmp_path / "bow.yaml"
    file.write_text(NOD, encoding="utf-8")
    return file


def run(*words: str | Path, wait: Callable[[], object] = lambda: None) -> int:
    parser = argparse.ArgumentParser()
    render.add(parser)
    arguments = parser.parse_args([str(word) for word in words])
    return render.render(arguments, plugins.installed(), wait)


def row(text: str, name: str) -> str:
    return next(line for line in text.splitlines() if line.startswith(name))


def test_frames_stand_at_their_times(
    capsys: pytest.CaptureFixture[str], robot: Path, move: Path
) -> None:
    assert run(move, "--robot", robot, "--keys") == 0
    out = capsys.readouterr().out
    assert row(out, "main").count("◆") == 2
    seconds = float(row(out, "bow-down:").split()[1])
    cells = row(out, "main").partition("┤")[2]
    assert cells.index("◆") == round(0.5 / seconds * (len(cells) - 1))
    assert "!" not in out


def test_what_joints_miss_is_marked_and_said(
    capsys: pytest.CaptureFixture[str], robot: Path, move: Path
) -> None:
    move.write_text(FAST, encoding="utf-8")
    run(move, "--robot", robot, "--keys")
    out = capsys.readouterr().out
    assert (row(out, "main").count("!"), row(out, "main").count("◆")) == (1, 1)
    assert row(out, "eyes").count("◇") == 1
    assert "main, frame 1: asks 750 deg/s of top (at most 320)" in out
    assert "dotted: what was wanted" in out


def test_a_move_of_a_robot_file_has_its_frames_too(
    capsys: pytest.CaptureFixture[str],
) -> None:
    eyepi = Path(__file__).parents[2] / "experiments/robots/eyepi.yaml"
    run(eyepi, "greet", "--keys")
    assert "◆" in row(capsys.readouterr().out, "main")


def test_it_is_drawn_again_when_the_file_is_saved_however_that_reads(
    capsys: pytest.CaptureFixture[str], robot: Path, move: Path
) -> None:
    drawn: list[tuple[str, str]] = []

    def saved(text: str) -> Callable[[], object]:
        return lambda: move.write_text(text, encoding="utf-8")

    def gone() -> None:
        move.rename(move.with_suffix(".bak"))

    def ended() -> None:
        raise KeyboardInterrupt

    steps = iter([saved(FAST), lambda: None, gone, saved("name: ["), saved(NOD), ended])

    def wait() -> None:
        out, err = capsys.readouterr()
        drawn.append((out, err))
        next(steps)()

    assert run(move, "--robot", robot, "--keys", "--watch", wait=wait) == 0
    first, second, nothing, missing, broken, last = drawn
    assert row(first[0], "main").count("◆") == 2
    assert row(second[0], "main").count("!") == 1
    assert nothing == ("", "")
    assert "bow.yaml" in missing[1]
    assert "bow.yaml" in broken[1]
    assert last == first


def test_a_save_while_it_is_drawn_is_not_missed(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.write_text("one")
    seen: list[str] = []

    def draw() -> None:
        seen.append(file.read_text())
        if len(seen) == 1:
            file.write_text("another")

    def wait() -> None:
        if len(seen) == 2:
            raise KeyboardInterrupt

    watch(draw, lambda: [file], wait)
    assert seen == ["one", "another"]


def test_a_move_file_needs_a_body(move: Path, robot: Path) -> None:
    with pytest.raises(RenderError, match="woz render MOVE --robot FILE"):
        run(move)
    with pytest.raises(RenderError, match="woz render MOVE --robot FILE"):
        run(move, "nod", "--robot", robot)
