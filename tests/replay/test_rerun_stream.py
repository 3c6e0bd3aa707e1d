"""In virtual time a re-run moves the simulated robot through every single setpoint once more."""

from __future__ import annotations

import asyncio
from pathlib import Path

from tests.replay.rerun_rig import KEY, NOWHERE, Scenario, player_of, rerun_over
from tests.session.rig import SessionRig
from tools.demo_session import catalogue
from woz_tui.config.experiment import Call
from woz_tui.config.loading import load
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import plan_of
from woz_tui.session.participant_identity import SessionIdentity

EXPERIMENT = """\
title: Body
robot: {name: it, drivers: {robot: {type: simulated, visitor: false}}}
panels:
  - title: Body
    actions:
      - {key: n, label: Nod, play: nod}
      - {key: l, label: Left, pose: {pan: 40, tilt: 10, seconds: 0.8}}
      - {key: r, label: Round, poses: [{pan: 50, seconds: 1}, {pan: -50, tilt: 5, seconds: 1.3}]}
      - {key: h, label: Home, home: 0.7}
"""


async def moves(rig: SessionRig) -> None:
    """Moves that follow each other, one that takes another one's place, and a stream of gazes."""
    await asyncio.sleep(1)
    for name, pause in (("Nod", 0.5), ("Left", 2.0), ("Round", 1.6)):
        rig.session.play(name, KEY)
        await asyncio.sleep(pause)
    rig.session.play("Home", KEY, "replace")
    await asyncio.sleep(1.2)
    for step in range(30):
        args: dict[str, m.Json] = {"yaw": step * 1.5, "pitch": -step / 2}
        rig.session.runner.send(Call("gaze", args, "robot", NOWHERE), KEY)
        await asyncio.sleep(0.04)
    await asyncio.sleep(2)


def rerun(log: Path) -> Scenario:
    async def play(rig: SessionRig) -> None:
        player = player_of(rig, plan_of(log))
        player.begin()
        await rerun_over(rig, player)
        await asyncio.sleep(2)

    return play


def course(rig: SessionRig) -> list[tuple[str, float | None]]:
    """Every setpoint of each joint that is another one than before, in order."""
    last: dict[str, float | None] = {}
    found = []
    for line in rig.of(m.Reading):
        joint, value = line.sensor, line.value
        if joint.startswith("setpoint.") and last.get(joint) != value:
            last[joint] = value
            found.append((joint, value))
    return found


def session_in(folder: Path, play: Scenario) -> SessionRig:
    """A session on the simulated robot, from its beginning to its end."""
    folder.mkdir()
    (folder / "body.yaml").write_text(EXPERIMENT, encoding="utf-8")
    drivers = catalogue()
    made = load(folder / "body.yaml", drivers)
    return SessionRig(folder, (), SessionIdentity(), drivers, made, rests=False).run(play)


def test_every_setpoint_comes_again_twice(tmp_path: Path) -> None:
    first = session_in(tmp_path / "a", moves)
    second = session_in(tmp_path / "b", rerun(first.recorder.path))
    third = session_in(tmp_path / "c", rerun(first.recorder.path))
    assert len(course(first)) > 90
    assert course(second) == course(third)
    assert course(second) == course(first)
