"""Move files are edited while a session plays them: the file is read again, and they count."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.drivers.body.test_body_session import KEY
from tests.session.rig import SessionRig
from tools.demo_session import catalogue
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity

CATALOGUE = catalogue()
ROBOT = """
drivers:
  body:
    type: body
    joints: {pan: {axis: z, min: -80, max: 80, speed: 300}}
    roles: {pan: {pan: 1}}
    personalities: {default: {breathing: 0}}
    moves: moves
"""
EXPERIMENT = """
title: T
robot: robot.yaml
panels: [{title: P, actions: [{key: a, label: Wave, play: MOVE}]}]
"""


def wave(degrees: int) -> str:
    return f"frames: [{{seconds: 0.5, pan: {degrees}}}, {{seconds: 0.5, pan: 0}}]\n"


def test_new_and_edited_moves_are_told_and_played(tmp_path: Path) -> None:
    file, moves = tmp_path / "e.yaml", tmp_path / "moves"
    moves.mkdir()
    (moves / "wave.yaml").write_text(wave(20))
    (moves / "old.yaml").write_text(wave(5))
    (tmp_path / "robot.yaml").write_text(ROBOT)
    file.write_text(EXPERIMENT.replace("MOVE", "wave"))

    async def scenario(rig: SessionRig) -> None:
        async def farthest() -> float:
            rig.lines.clear()
            rig.session.play("Wave", KEY)
            await asyncio.sleep(2)
            assert rig.of(m.ActionDone)
            return max(rig.values("setpoint.pan"))

        def reread(*, dry_run: bool) -> list[str]:
            experiment = load(file, CATALOGUE)
            changes = rig.session.reread(experiment, dry_run=dry_run)
            if not dry_run:
                rig.session.adopt(experiment, changes)
            return changes

        await asyncio.sleep(0.5)
        assert 15 < await farthest() < 25
        assert reread(dry_run=True) == []
        (moves / "wave.yaml").write_text(wave(60))
        (moves / "greet.yaml").write_text(wave(-40))
        (moves / "old.yaml").unlink()
        told = ["move 'greet' is new", "move 'wave' changed", "move 'old' was removed"]
        assert sorted(reread(dry_run=True)) == sorted(told)
        assert 15 < await farthest() < 25, "a look changes nothing"
        assert sorted(reread(dry_run=False)) == sorted(told)
        assert 55 < await farthest() < 65
        file.write_text(EXPERIMENT.replace("MOVE", "greet"))
        assert reread(dry_run=False) == []
        assert await farthest() < 1, "the new one goes the other way"

    made = load(file, CATALOGUE)
    SessionRig(tmp_path, (), SessionIdentity(), CATALOGUE, made).run(scenario)


def test_a_mistake_in_a_move_file_is_the_only_one_told(tmp_path: Path) -> None:
    """Whatever else the file says of the body that could not be read is not called unknown."""
    for folder in ("robots", "moves"):
        (tmp_path / folder).mkdir()
    (tmp_path / "robots" / "robot.yaml").write_text(
        ROBOT.replace("moves: moves", "moves: ../moves")
    )
    (tmp_path / "moves" / "wave.yaml").write_text(wave(20).replace("pan", "pam", 1))
    file = tmp_path / "e.yaml"
    profile = "profiles: {child: {panels: [P], controls: [pan], verbs: [gaze]}}\n"
    file.write_text(
        EXPERIMENT.replace("robot.yaml", "robots/robot.yaml").replace("MOVE", "wave") + profile
    )
    with pytest.raises(ExperimentError) as caught:
        load(file, CATALOGUE)
    place = tmp_path / "moves" / "wave.yaml"
    assert str(caught.value).splitlines() == [
        f"{place}:1:25: frames[0].pam: unknown; did you mean 'pan'?"
    ]
