"""Every driver of ours keeps the contract, tried with the kit that strangers use."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from woz_drivers import simulated
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
from tests.drivers.hands.test_hands_driver import CONTROLS
from tests.drivers.servo_stand import head
from tests.fakes.led_face import PluggedFace
from tests.fakes.rangefinder import PluggedSensor
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.plugins import installed
from woz_tui.testing import Device, DriverTests, PlainJob, RecordingContext, check

NOWHERE = "/dev/no-such-port"
SILENT = SynthesisSettings(synthesise=("no-such-program",))
SETTINGS: list[tuple[str, Any]] = [
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
            settings = RangefinderSettings(str(sensor.port))
            yield Device(settings, sensor.unplug, sensor.plug)
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
            yield Device(settings, face.unplug, face.plug, command)
            face.unplug()


@pytest.mark.real_clock
@pytest.mark.safety
class TestDynamixel(DriverTests):
    driver = DynamixelServos
    settings = head(Path(NOWHERE))

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with TemporaryDirectory() as folder, ServoBus([11, 12, 13], Path(folder) / "port") as bus:
            command = PlainJob("pose", {"joints": {"pan": 80.0}, "seconds": 20.0})
            yield Device(head(bus.link, torque=True), bus.pull, bus.plug, command)
