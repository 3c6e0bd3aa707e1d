"""What the driver knows of a NAO without one: joints, animations, what is odd in a file."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.nao.driver import Nao
from woz_drivers.nao.model import NAO
from woz_drivers.nao.settings import NaoSettings

from woz_tui.drivers.contract import RejectedError, Written
from woz_tui.protocol.messages import Json

DEGREES = st.floats(-400, 400)


def test_the_known_animations_are_each_there_once_and_found_by_posture() -> None:
    names = NAO.animations
    assert len(set(names.moves)) == len(names.moves) > 350
    assert [path for path in names.moves if names.path_of(path) != path] == []
    assert names.path_of("Sad_1", "Sit") == "animations/Sit/Emotions/Negative/Sad_1"
    assert names.path_of("Sad_1", "Stand") == "animations/Stand/Emotions/Negative/Sad_1"
    with pytest.raises(RejectedError, match="NAO"):
        names.path_of("Hay_1")


def test_it_has_the_26_joints_of_an_h25() -> None:
    ranges = NAO.joints.ranges
    assert len(ranges) == 26
    assert str(ranges["LHipPitch"]) == "-88 to 27.73 deg"
    assert str(ranges["RAnkleRoll"]) == "-44.06 to 22.8 deg"


@given(DEGREES, DEGREES)
def test_the_nearest_direction_is_one_that_the_head_can_take(yaw: float, pitch: float) -> None:
    joints = NAO.joints
    turned, bent = joints.head(yaw, pitch)
    assert joints.ranges["HeadYaw"].contains(turned)
    assert joints.head_pitch(turned).contains(bent)
    assert joints.head(turned, bent) == (turned, bent)


@pytest.mark.parametrize(
    ("pose", "says"),
    [
        ({"HipPitch": 10}, "no joint 'HipPitch'"),
        ({"LKneePitch": 130}, "-5.29 to 121.04"),
        ({"HeadYaw": 90, "HeadPitch": 20}, "with the head turned by 90"),
    ],
)
def test_an_impossible_pose_is_refused(pose: Json, says: str) -> None:
    with pytest.raises(RejectedError, match=says):
        NAO.joints.checked(pose)


def test_a_written_pose_of_the_legs_is_warned_of(tmp_path: Path) -> None:
    written = Written("pose", {"joints": {"LKneePitch": 20, "HeadYaw": 5}}, tmp_path)
    (finding,) = Nao.remarks(NaoSettings(), written)
    assert (finding.level, finding.subject) == ("warning", "joints")
    assert "LKneePitch" in finding.text
