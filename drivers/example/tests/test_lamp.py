"""The lamp's driver against a lamp on a wire."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from lamp_on_a_wire import LampOnAWire
from woz_driver_lamp import Lamp, LampSettings

from woz_tui.core.clock import Clock, RealClock
from woz_tui.core.conformance import check
from woz_tui.core.driver import Ask, DriverError, Health, Lost, Probe, Rejected, Scope
from woz_tui.core.feeds import Feed
from woz_tui.core.messages import Json, Shown, Speech


@dataclass
class Told:
    """An outlet that remembers what the driver told."""

    folder: Path
    clock: Clock = field(default_factory=RealClock)
    healths: list[Health] = field(default_factory=list)
    readings: list[tuple[str, float | None]] = field(default_factory=list)

    @property
    def media(self) -> Path:
        return self.folder / "session.media"

    def t(self, clock_us: int) -> int:
        return clock_us

    def reading(
        self,
        sensor: str,
        value: float | None,
        *,
        text: str = "",
        unit: str = "",
        raw: float | None = None,
    ) -> None:
        self.readings.append((sensor, value))

    def sensor(self, sensor: str, state: str, why: str = "") -> None:
        return

    def health(self, health: Health, detail: str = "", remedy: str = "") -> None:
        self.healths.append(health)

    def mode(self, mode: str, why: str = "") -> None:
        return

    def notice(self, level: str, text: str, remedy: str = "") -> None:
        return

    def show(self, shown: Shown) -> None:
        return

    def tell(self, speech: Speech) -> None:
        return

    def feed(self, topic: str, of: str = "") -> Feed:
        return Feed()

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        return


@dataclass
class Command:
    """A job as the bus would give it, defaults filled in."""

    args: Mapping[str, Json]
    verb: str = "glow"
    command: str = "c1"
    expected: list[float] = field(default_factory=list)
    source: str = "key"

    def expects(self, seconds: float) -> None:
        self.expected.append(seconds)


@pytest.fixture
async def wire() -> AsyncIterator[LampOnAWire]:
    lamp = LampOnAWire()
    yield lamp
    lamp.pull()


@pytest.fixture
def told(tmp_path: Path) -> Told:
    return Told(tmp_path)


@pytest.fixture
async def lamp(wire: LampOnAWire, told: Told) -> AsyncIterator[Lamp]:
    driver = Lamp("lamp", LampSettings(wire.port), told)
    await driver.open()
    await until(lambda: told.healths[-1] is Health.CONNECTED)
    yield driver
    await driver.close()


async def until(true: Callable[[], bool]) -> None:
    """Wait for a condition, ten seconds at most."""
    async with asyncio.timeout(10):
        while not true():  # noqa: ASYNC110 - what the wire does sets no event
            await asyncio.sleep(0.005)


def glow(color: str = "#ff8000", seconds: float = 0.2) -> Command:
    return Command({"color": color, "seconds": seconds})


async def test_it_keeps_the_contract_with_and_without_a_lamp(wire: LampOnAWire) -> None:
    for port in (wire.port, "/dev/no-such-port"):
        findings = await check(Lamp, LampSettings(port))
        assert [finding.level for finding in findings] == ["ok"], findings


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
    with pytest.raises(Rejected, match="no colour"):
        await lamp.perform(glow("orange"))
    wire.error = "too hot"
    with pytest.raises(DriverError, match="too hot"):
        await lamp.perform(glow())


async def test_the_button_is_a_sensor(lamp: Lamp, wire: LampOnAWire, told: Told) -> None:
    wire.say("BUTTON 1")
    wire.say("BUTTON 0")
    await until(lambda: told.readings == [("button", 1.0), ("button", 0.0)])


async def test_the_stop_and_a_cancellation_freeze_it(lamp: Lamp, wire: LampOnAWire) -> None:
    wire.slow = True
    fading = asyncio.create_task(lamp.perform(glow(seconds=10)))
    await until(lambda: "COLOR 255 128 0 10000" in wire.heard)
    await lamp.stop(Scope.ALL)
    assert wire.heard[-1] == "FREEZE"
    fading.cancel()
    await asyncio.wait([fading])
    assert fading.cancelled()
    await until(lambda: wire.heard[-2:] == ["FREEZE", "FREEZE"])


async def test_a_pulled_cable_ends_what_is_under_way(
    lamp: Lamp, wire: LampOnAWire, told: Told
) -> None:
    wire.slow = True
    fading = asyncio.create_task(lamp.perform(glow(seconds=10)))
    await until(lambda: len(wire.heard) == 2)
    wire.pull()
    with pytest.raises(Lost):
        await fading
    assert told.healths[-1] is Health.LOST
    with pytest.raises(Lost):
        await lamp.perform(glow())


async def test_the_doctor_says_what_is_wrong(wire: LampOnAWire) -> None:
    for port, level in ((wire.port, "ok"), ("/dev/no-such-port", "error")):
        (finding,) = await Lamp.examine(Probe("lamp", LampSettings(port)))
        assert finding.level == level
    assert "not there" in finding.text
