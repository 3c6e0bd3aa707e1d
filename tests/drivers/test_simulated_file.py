"""The simulated robot as a robot file describes it, read through the front door."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.simulated import ScheduledFault, SimulatedJoint, SimulatedSettings

from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

FILE = """\
title: Rehearsal
robot:
  drivers:
    robot:
      type: simulated
      joints:
        neck: {low: -40, high: 40, speed: 90}
      yaw_joint: neck
      visitor: true
      seed: 3
      moves: {hop: 500 ms}
      modes: [calm, lively]
      faults:
        - {kind: disconnect, after: 1 min, seconds: 5 s}
panels:
  - title: All
    actions:
      - {key: a, label: Hop, play: hop, speed: 2}
      - {key: b, label: Turn, pose: {neck: 30}}
      - {key: c, label: Turns, poses: [{neck: 10, seconds: 0.5}, {neck: 0}]}
      - {key: d, label: Break, fault: hang, seconds: 2, part: voice}
      - {key: e, label: Look, gaze: {yaw: 20}}
      - {key: f, label: Calm, mode: calm}
"""


def test_every_kind_of_setting_can_stand_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "rehearsal.yaml"
    path.write_text(FILE)
    (robot,) = load(path, installed()).drivers
    assert robot.settings == SimulatedSettings(
        joints={"neck": SimulatedJoint(-40, 40, 90)},
        yaw_joint="neck",
        visitor=True,
        seed=3,
        moves={"hop": 0.5},
        modes=("calm", "lively"),
        faults=(ScheduledFault("disconnect", after=60.0, seconds=5.0),),
    )
    assert "joint.neck" in robot.offer.sensors


@pytest.mark.parametrize(
    ("right", "wrong", "place", "complaint"),
    [
        ("yaw_joint: neck", "yaw_joint: nek", "8:7", "there is no joint 'nek'"),
        ("low: -40", "low: 50", "7:9", "must rise in this order"),
        ("neck: 30", "neck: 300", "19:", "40"),
        ("play: hop", "play: hopp", "18:", "did you mean 'hop'?"),
        ("kind: disconnect", "kind: disconect", "14:", "did you mean 'disconnect'?"),
    ],
)
def test_mistakes_are_found_at_their_places(
    tmp_path: Path, right: str, wrong: str, place: str, complaint: str
) -> None:
    path = tmp_path / "rehearsal.yaml"
    assert right in FILE
    path.write_text(FILE.replace(right, wrong))
    with pytest.raises(ExperimentError) as caught:
        load(path, installed())
    (problem, *_) = caught.value.problems
    assert f"rehearsal.yaml:{place}" in str(problem)
    assert complaint in str(problem)
