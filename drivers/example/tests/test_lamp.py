"""The lamp's driver against a lamp on a wire."""

from __future__ import annotations

import asyncio
import contextlib
import tempfile
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from lamp_on_a_wire import LampOnAWire
from woz_driver_lamp import Lamp, LampSettings

from woz_tui.drivers.contract import DriverError, Health, Probe, RejectedError, Scope
from woz_tui.testing import Device, DriverTests, PlainJob, RecordingContext, until


class TestTheContract(DriverTests):
    driver = Lamp
    settings = LampSettings("/dev/no-such-port")

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with tempfile.TemporaryDirectory() as folder:
            wire = LampOnAWire(Path(folder) / "port")
            yield Device(
                LampSettings(str(wire.port)),
                unplug=wire.pull,
                plug=wire.plug,
                command=glow(seconds=20),
                still=wire.still,
                fail=wire.overheat,
                received=wire.received,
                senses=wire.press,
            )
            wire.pull()


class TestTheContractInAProcessOfItsOwn(TestTheContract):
    own_process = True


def glow(color: str = "#ff8000", seconds: float = 0.2) -> PlainJob:
    return PlainJob("glow", {"color": color, "seconds": seconds})


@pytest.fixture
async def wire(tmp_path: Path) -> AsyncIterator[LampOnAWire]:
    lamp = LampOnAWire(tmp_path / "port")
    yield lamp
    lamp.pull()


@pytest.fixture
def context() -> RecordingContext:
    return RecordingContext()


@pytest.fixture
async def lamp(wire: LampOnAWire, context: RecordingContext) -> AsyncIterator[Lamp]:
    driver = Lamp("lamp", LampSettings(str(wire.port)), context)
    await driver.open()
    await until(lambda: context.healths[-1][0] is Health.CONNECTED)
    yield driver
    await driver.close()


async def test_it_fades_to_the_colour_and_returns_what_was_sent(
    lamp: Lamp, wire: LampOnAWire
) -> None:
    job = glow()
    sent = await lamp.perform(job)
    assert wire.heard == ["HELLO", "COLOR 255 128 0 200"]
    assert sent == {"red": 255, "green": 128, "blue": 0, "seconds": 0.2}
    assert job.expected == [0.2]


async def test_nonsense_and_errors_of_the_lamp_are_told_apart(
    lamp: Lamp, wire: LampOnAWire
) -> None:
    with pytest.raises(RejectedError, match="no colour"):
        await lamp.perform(glow("orange"))
    wire.error = "too hot"
    with pytest.raises(DriverError, match="too hot"):
        await lamp.perform(glow())


async def test_the_button_is_a_sensor(
    lamp: Lamp, wire: LampOnAWire, context: RecordingContext
) -> None:
    wire.say("BUTTON 1")
    wire.say("BUTTON 0")
    await until(lambda: [reading.value for reading in context.of("button")] == [1.0, 0.0])


async def test_the_stop_and_a_cancellation_freeze_it(lamp: Lamp, wire: LampOnAWire) -> None:
    fading = asyncio.create_task(lamp.perform(glow(seconds=10)))
    await until(lambda: "COLOR 255 128 0 10000" in wire.heard)
    await lamp.stop(Scope.ALL)
    assert wire.heard[-1] == "FREEZE"
    assert wire.still()
    fading.cancel()
    await asyncio.wait([fading])
    assert fading.cancelled()
    await until(lambda: wire.heard[-2:] == ["FREEZE", "FREEZE"])


async def test_the_doctor_says_what_is_wrong(wire: LampOnAWire) -> None:
    for port, level in ((str(wire.port), "ok"), ("/dev/no-such-port", "error")):
        (finding,) = await Lamp.examine(Probe("lamp", LampSettings(port)))
        assert finding.level == level
    assert "not there" in finding.text
