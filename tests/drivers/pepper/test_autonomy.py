"""What the robot does by itself: set in an order that works, read back, told where it differs."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.naoqi_robot.settings import AutonomySettings

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import SettingsShown

SWITCHES = {
    "awareness": "ALBasicAwareness",
    "blinking": "ALAutonomousBlinking",
    "listening_movement": "ALListeningMovement",
    "speaking_movement": "ALSpeakingMovement",
}
CHAINS = {"head_breathing": "Head", "arms_breathing": "Arms", "legs_breathing": "Legs"}


pytestmark = pytest.mark.asyncio(loop_scope="module")


@pytest.mark.naoqi("ALBasicAwareness.setEnabled", "ALBasicAwareness.isEnabled")
@pytest.mark.naoqi("ALAutonomousBlinking.setEnabled", "ALAutonomousBlinking.isEnabled")
@pytest.mark.naoqi("ALListeningMovement.setEnabled", "ALListeningMovement.isEnabled")
@pytest.mark.naoqi("ALSpeakingMovement.setEnabled", "ALSpeakingMovement.isEnabled")
@pytest.mark.naoqi("ALMotion.setBreathEnabled", "ALMotion.getBreathEnabled")
async def test_every_switch_is_set_and_read_back(robot_rig: RobotRig) -> None:
    for on in (False, True):
        for name, service in SWITCHES.items():
            assert await robot_rig.do("autonomy", **{name: on}) == {name: on}
            assert (await robot_rig.calls(f"{service}.setEnabled"))[-1] == (on,)
            await robot_rig.shows(**{name: on})
        for name, chain in CHAINS.items():
            await robot_rig.do("autonomy", **{name: on})
            assert (await robot_rig.calls("ALMotion.setBreathEnabled"))[-1] == (chain, on)
            await robot_rig.shows(**{name: on})
        await robot_rig.shows(body_breathing=on)


@pytest.mark.naoqi("ALAutonomousLife.setState", "ALAutonomousLife.getState")
@pytest.mark.naoqi("ALBasicAwareness.setEngagementMode", "ALBasicAwareness.getEngagementMode")
async def test_the_state_comes_first_since_it_changes_the_others(robot_rig: RobotRig) -> None:
    wanted: dict[str, Any] = {
        "speaking_movement": False,
        "head_breathing": True,
        "body_breathing": False,
        "engagement": "FullyEngaged",
        "awareness": False,
        "state": "interactive",
    }
    assert await robot_rig.do("autonomy", **wanted) == wanted
    called = [call.name for call in await robot_rig.robot.trace() if ".set" in call.name]
    assert called[0] == "ALAutonomousLife.setState"
    # One part of the body breathes again, so the body as a whole does not count as breathing.
    settings_shown = await robot_rig.shows(**wanted, legs_breathing=False, arms_breathing=False)
    assert not set(wanted) & set(settings_shown.wanted)


@pytest.mark.naoqi(
    "ALMotion.setTangentialSecurityDistance", "ALMotion.getTangentialSecurityDistance"
)
@pytest.mark.naoqi(
    "ALMotion.setOrthogonalSecurityDistance", "ALMotion.getOrthogonalSecurityDistance"
)
async def test_distances_are_set_and_read_back_and_small_ones_warned_of(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.do("collision", tangential=0.05, orthogonal=0.3)
    settings_shown = await robot_rig.shows(tangential=0.05, orthogonal=0.3)
    assert any("tangential security distance is 0.05 m" in one for one in settings_shown.conflicts)
    await robot_rig.do("collision", tangential=0.2)
    settings_shown = await robot_rig.shows(tangential=0.2, orthogonal=0.3)
    assert not any("security distance" in one for one in settings_shown.conflicts)


async def test_nothing_named_is_refused(robot_rig: RobotRig) -> None:
    for verb in ("autonomy", "collision"):
        with pytest.raises(RejectedError, match="no setting"):
            await robot_rig.do(verb)


async def test_what_the_robot_refuses_is_named_and_the_rest_is_set(robot_rig: RobotRig) -> None:
    await robot_rig.do("autonomy", blinking=True, awareness=True)
    await robot_rig.robot.fault("refuse:ALAutonomousBlinking.setEnabled=not now")
    with pytest.raises(DriverError, match=r"did not change blinking: .*not now.*awareness did"):
        await robot_rig.do("autonomy", blinking=False, awareness=False)
    settings_shown = await robot_rig.tells(
        lambda settings_shown: settings_shown.wanted.get("blinking") is False
    )
    assert settings_shown.values["blinking"] is True
    await robot_rig.tells(lambda settings_shown: "awareness" not in settings_shown.wanted)
    assert robot_rig.settings_shown.values["awareness"] is False


async def test_the_way_from_interactive_to_solitary_is_told(robot_rig: RobotRig) -> None:
    await robot_rig.do("autonomy", state="interactive")
    with pytest.raises(DriverError, match=r"did not change state: .*; awareness did") as raised:
        await robot_rig.do("autonomy", state="solitary", awareness=True)
    assert "by disabled" in raised.value.remedy
    await robot_rig.do("autonomy", state="disabled")
    await robot_rig.do("autonomy", state="solitary")
    await robot_rig.shows(state="solitary", engagement="Unengaged")


@pytest.mark.woz4u("autonomous_life_config")
async def test_the_file_is_applied_on_connect_and_what_it_leaves_out_is_left(
    tmp_path: Path,
) -> None:
    wants = AutonomySettings(
        state="interactive", awareness=False, head_breathing=False, orthogonal=0.25
    )
    async with connected_robot(tmp_path, autonomy=wants) as rig:
        settings_shown = await rig.shows(
            orthogonal=0.25,
            state="interactive",
            awareness=False,
            head_breathing=False,
            arms_breathing=True,
        )
        assert settings_shown.wanted == {}
        called = {call.name for call in await rig.robot.trace()}
        assert "ALMotion.setTangentialSecurityDistance" not in called
        assert "ALAutonomousBlinking.setEnabled" not in called


@pytest.mark.naoqi("ALAutonomousBlinking.isEnabled")
async def test_a_change_by_the_robot_itself_shows_against_what_was_asked_for(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.do("autonomy", blinking=False)
    await robot_rig.tells(
        lambda settings_shown: (
            settings_shown.values["blinking"] is False and "blinking" not in settings_shown.wanted
        )
    )
    # Another program, or the robot's own life.
    await robot_rig.do("naoqi", call="ALAutonomousBlinking.setEnabled", args="[true]")
    await robot_rig.tells(lambda settings_shown: settings_shown.values["blinking"] is True)
    assert robot_rig.settings_shown.wanted["blinking"] is False


async def test_one_unreadable_setting_hides_no_other(robot_rig: RobotRig) -> None:
    await robot_rig.robot.fault("refuse:ALAutonomousLife.getState=no")
    others = {"awareness", "volume", "tangential", "awake"}
    await robot_rig.tells(
        lambda settings_shown: (
            "state" not in settings_shown.values and others <= set(settings_shown.values)
        )
    )
    await robot_rig.robot.fault("none")
    await robot_rig.tells(lambda settings_shown: "state" in settings_shown.values)


async def test_settings_are_said_on_a_change_only(robot_rig: RobotRig) -> None:
    await robot_rig.robot.called("ALAutonomousLife.getState", 2)
    told = [
        (one.values, one.wanted, one.conflicts) for one in robot_rig.published.all(SettingsShown)
    ]
    assert all(one != two for one, two in pairwise(told))
