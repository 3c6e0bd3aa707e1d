"""Every driver of ours keeps the contract, tried with the kit that strangers use."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from woz_drivers import simulated
from woz_drivers.browser_screen import BrowserScreenSettings
from woz_drivers.camera.settings import CameraSettings
from woz_drivers.dynamixel import DynamixelServos
from woz_drivers.faces.settings import FacesSettings
from woz_drivers.furhat import FurhatSettings
from woz_drivers.hands.settings import HandsSettings
from woz_drivers.led_face import LedFace
from woz_drivers.led_face.settings import LedFaceSettings
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.rangefinder import Rangefinder, RangefinderSettings
from woz_drivers.reachy_mini import ReachyMiniSettings
from woz_drivers.ros.settings import RosSettings
from woz_drivers.speech.settings import SpeechSettings, SynthesisSettings

from tests.drivers.body.rig import robot
from tests.drivers.browser_screen import test_browser_screen
from tests.drivers.faces import test_faces
from tests.drivers.furhat import test_furhat_contract
from tests.drivers.hands.test_hands_driver import CONTROLS
from tests.drivers.nao import test_nao_contract
from tests.drivers.reachy_mini import test_reachy_mini
from tests.drivers.ros import test_contract as test_ros_contract
from tests.drivers.servo_rig import head
from tests.fakes.led_face import PluggedFace
from tests.fakes.rangefinder import PluggedSensor, a02
from tests.fakes.servo_motor import OVERLOAD
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.plugins import installed
from woz_tui.testing import Device, DriverTests, PlainJob, RecordingContext, check

NOWHERE = "/dev/no-such-port"
SILENT = SynthesisSettings(synthesise=("no-such-program",))
SETTINGS: list[tuple[str, Any]] = [
    ("browser-screen", BrowserScreenSettings("127.0.0.1:0")),
    ("camera", CameraSettings(command=("no-such-program",))),
    ("dynamixel", head(Path(NOWHERE), pan="pan", poses={"up": {"tilt": 10.0}})),
    ("faces", FacesSettings(command=("no-such-program",))),
    ("furhat", FurhatSettings(address="127.0.0.1:1")),
    ("led-face", LedFaceSettings(NOWHERE)),
    ("microphone", MicrophoneSettings(command=("no-such-program",))),
    ("midi", MidiSettings(device=NOWHERE)),
    ("hands", HandsSettings(controls=CONTROLS)),
    *(("pepper", PepperSettings(robots=robots)) for robots in [(), ("simulated",), ("a/b",)]),
    ("pepper", PepperSettings(robots=("tcp://127.0.0.1:1",))),
    *(("nao", NaoSettings(address=address)) for address in ("", "simulated", "a/b", "127.0.0.1:1")),
    ("rangefinder", RangefinderSettings(NOWHERE)),
    ("ros", RosSettings(address="127.0.0.1:1")),
    ("reachy-mini", ReachyMiniSettings("127.0.0.1:1", voice=SILENT)),
    ("reachy-mini", ReachyMiniSettings(follows="body", voice=SILENT)),
    ("simulated", simulated.SimulatedSettings()),
    ("simulated", simulated.SimulatedSettings(visitor=True)),
    ("simulated", simulated.SimulatedSettings(joints={})),
    ("simulated", simulated.SimulatedSettings(moves={"hop": 1})),
    ("speech", SpeechSettings(synthesise=("no-such-program",))),
    ("speech", SpeechSettings(synthesise=("no-such-program",), play=("no-such-program", "{wav}"))),
]


@pytest.mark.parametrize(("driver", "settings"), SETTINGS, ids=[name for name, _ in SETTINGS])
async def test_it_keeps_the_contract_without_hardware(
    driver: str, settings: Any, tmp_path: Path
) -> None:
    assert await check(installed()[driver], settings, tmp_path) == []


@pytest.mark.parametrize("name", ["eyepi", "five-joints"])
async def test_a_body_keeps_the_contract(name: str, tmp_path: Path) -> None:
    assert await check(installed()["body"], robot(name, tmp_path)) == []


def test_every_driver_of_ours_is_tried() -> None:
    assert {name for name, _ in SETTINGS} | {"body"} == set(installed())


class TestRangefinder(DriverTests):
    driver = Rangefinder
    settings = RangefinderSettings(NOWHERE)

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with TemporaryDirectory() as folder:
            sensor = PluggedSensor(Path(folder) / "port")

            def sense() -> dict[str, float]:
                sensor.send(a02(1234))
                return {"distance": 1.234}

            settings = RangefinderSettings(str(sensor.port), framing="a02")
            yield Device(settings, sensor.unplug, sensor.plug, senses=sense)
            sensor.unplug()


async def test_a_picture_that_is_not_there_is_rejected_without_lights() -> None:
    face = LedFace("lights", LedFaceSettings(NOWHERE), RecordingContext())
    with pytest.raises(RejectedError):
        await face.perform(PlainJob("pattern", {"picture": "no-such-picture", "seconds": 1.0}))


@pytest.mark.cpp
class TestLedFace(DriverTests):
    driver = LedFace
    settings = LedFaceSettings(NOWHERE)

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with TemporaryDirectory() as folder:
            face = PluggedFace(Path(folder) / "port")
            command = PlainJob("pattern", {"picture": "arrow", "seconds": 25.0})
            settings = LedFaceSettings(str(face.port))
            yield Device(settings, face.unplug, face.plug, command, fail=face.grow_strange)
            face.unplug()


@pytest.mark.real_clock
@pytest.mark.safety
class TestDynamixel(DriverTests):
    driver = DynamixelServos
    settings = head(Path(NOWHERE))

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with TemporaryDirectory() as folder, ServoBus([11, 12, 13], Path(folder) / "port") as bus:
            pan = bus.servo(11)
            pan.position += 30.0 / pan.degrees_per_count

            def still() -> bool:
                return not pan.torque or abs(pan.goal - pan.position) < 1

            def overload() -> None:
                pan.raise_alarm(OVERLOAD)

            def sense() -> dict[str, float]:
                degrees = (pan.position - pan.counts / 2) * pan.degrees_per_count
                return {"joint.pan": degrees}

            yield Device(
                head(bus.link, torque=True),
                bus.pull,
                bus.plug,
                PlainJob("pose", {"joints": {"pan": 80.0}, "seconds": 20.0}),
                still=still,
                senses=sense,
                fail=overload,
            )


#: Each runs `test_shows_what_its_facts_claim`, too.
WITH_A_DEVICE: tuple[type[DriverTests], ...] = (
    *(TestRangefinder, TestLedFace, TestDynamixel, test_faces.TestTheContract),
    *(
        test_furhat_contract.TestTheContract,
        test_nao_contract.TestNao,
        test_nao_contract.TestPepper,
    ),
    *(test_reachy_mini.TestTheContract, test_ros_contract.TestRos1, test_ros_contract.TestRos2),
    test_browser_screen.TestTheContract,
)


def test_only_drivers_that_are_tried_with_a_device_claim_anything() -> None:
    tried = {each.driver for each in WITH_A_DEVICE}
    claim = {driver for driver in installed().values() if driver.facts.shown}
    assert claim == tried
