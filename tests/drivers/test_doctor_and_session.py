"""What is wrong with a device is wrong to `woz doctor` and to a session, for the same reason.

Faults that one kind of device has alone are played through both beside its other tests.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from woz_drivers.camera import Camera
from woz_drivers.camera.settings import CameraSettings
from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, ServoSettings
from woz_drivers.furhat import Furhat, FurhatSettings
from woz_drivers.led_face import LedFace, LedFaceSettings
from woz_drivers.microphone import Microphone, MicrophoneSettings
from woz_drivers.midi import MidiPanel
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.rangefinder import Rangefinder, RangefinderSettings
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings
from woz_drivers.ros import Ros, RosSettings

from woz_tui.drivers.contract import Driver, Health, Probe
from woz_tui.testing import RecordingContext, until

NOWHERE = "./nowhere"
SAYS_WHY = ("sh", "-c", "echo no such device >&2; exit 1")
JOINTS = {"pan": ServoJointSettings(id=1, min=-9, max=9)}
#: Nobody listens at this port.
REFUSED = "127.0.0.1:9"
FAULTS: dict[str, tuple[type[Driver], Any, str]] = {
    "rangefinder unplugged": (Rangefinder, RangefinderSettings(NOWHERE), "nowhere is not there"),
    "face unplugged": (LedFace, LedFaceSettings(NOWHERE), "nowhere is not there"),
    "servos unplugged": (
        *(DynamixelServos, ServoSettings(port=NOWHERE, joints=JOINTS), "nowhere is not there"),
    ),
    "panel unplugged": (MidiPanel, MidiSettings(device=NOWHERE), "nowhere is not there"),
    "no recorder": (Microphone, MicrophoneSettings(command="./nothing"), "does not exist"),
    "recorder ends": (Microphone, MicrophoneSettings(command=SAYS_WHY), "ended: no such device"),
    "no camera": (Camera, CameraSettings(command="./nothing"), "does not exist"),
    "camera ends": (Camera, CameraSettings(command=SAYS_WHY), "ended: no such device"),
    "no rosbridge": (Ros, RosSettings(address=REFUSED), "Connection refused"),
    "no Furhat": (Furhat, FurhatSettings(address=REFUSED), "Connection refused"),
    "no Reachy Mini": (ReachyMini, ReachyMiniSettings(address=REFUSED), "Connection refused"),
}


@pytest.mark.parametrize("fault", FAULTS)
async def test_doctor_and_session_give_the_same_reason(fault: str, tmp_path: Path) -> None:
    kind, settings, why = FAULTS[fault]
    findings = await kind.examine(Probe("it", settings, tmp_path))
    context = RecordingContext(tmp_path)
    driver = kind("it", settings, context)
    await driver.open()
    try:
        await until(lambda: context.healths[-1][0] in (Health.LOST, Health.FAULTED))
    finally:
        await driver.close()
    told = [one for one in findings if one.level == "error" and why in one.text]
    lost = [each for each in context.healths if each[0] is Health.LOST and why in each[1]]
    assert len(told) == 1
    assert told[0].remedy
    assert lost
    assert lost[0][2]
