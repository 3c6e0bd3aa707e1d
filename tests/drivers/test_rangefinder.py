"""The rangefinder driver over a pseudo-terminal, and its filter by itself."""

from __future__ import annotations

import asyncio
import fcntl
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.rangefinder import Rangefinder, RangefinderSettings, doctor
from woz_drivers.rangefinder.distance_filter import DistanceFilter, FilterLimits

from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.rangefinder import PluggedSensor, a02, maxbotix, tfmini
from woz_tui.drivers.contract import Driver, Probe, RejectedError, Scope
from woz_tui.protocol.messages import DriverConnected, DriverLost, Reading
from woz_tui.system.clock import ManualClock

GATES = FilterLimits(
    nearest=0.02, farthest=10.0, floor=None, ceiling=None, jump=0.5, confirm=3, median=3
)


@pytest.fixture
def sensor(tmp_path: Path) -> PluggedSensor:
    return PluggedSensor(tmp_path / "port")


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


Begin = Callable[..., Any]


@pytest.fixture
async def begin(tmp_path: Path, clock: ManualClock, sensor: PluggedSensor) -> AsyncIterator[Begin]:
    drivers: list[Driver] = []

    async def started(**settings: Any) -> PublishedMessages:
        published = PublishedMessages(tmp_path, clock)
        rangefinder_settings = RangefinderSettings(
            port=str(sensor.port), **{"framing": "tfmini", **settings}
        )
        driver: Driver = Rangefinder("it", rangefinder_settings, published.context)
        drivers.append(driver)
        await driver.open()
        return published

    yield started
    for driver in drivers:
        await driver.close()
    sensor.unplug()


async def test_publishes_metres_and_what_the_device_said(
    begin: Begin, sensor: PluggedSensor
) -> None:
    published = await begin()
    connected = await published.first(DriverConnected)
    assert connected.detail == f"{sensor.port}, tfmini, 115200 baud"
    sensor.send(tfmini(213))
    reading = await published.first(Reading)
    assert (reading.sensor, reading.value, reading.unit, reading.raw) == (
        "distance",
        pytest.approx(2.13),
        "m",
        213,
    )
    assert published.states("distance") == ["ok"]


async def test_unplugged_and_put_back(begin: Begin, sensor: PluggedSensor) -> None:
    published = await begin()
    await published.first(DriverConnected)
    sensor.send(tfmini(100))
    await published.state("distance", "ok")
    sensor.unplug()
    lost = await published.first(DriverLost)
    assert "was lost" in lost.detail
    assert lost.remedy
    stale = await published.state("distance", "stale")
    assert "was lost" in stale.why
    sensor.plug()
    await published.first(DriverConnected, after=1)
    sensor.send(tfmini(300))  # a new connection: no jump to confirm
    await published.state("distance", "ok")
    assert published.values("distance")[-1] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("sent", "why"),
    [
        (b"", "sends nothing"),
        (b"hello world, no frames here\r\n" + b"\x59\x59" + bytes(20), "what comes is not tfmini"),
        (tfmini(100, strength=3), "weak echo (strength 3)"),
        (tfmini(1), "0.01 m is out of range"),
    ],
)
async def test_staleness_says_why(
    begin: Begin, sensor: PluggedSensor, clock: ManualClock, sent: bytes, why: str
) -> None:
    published = await begin()
    await published.first(DriverConnected)
    sensor.send(tfmini(150))
    await published.state("distance", "ok")
    sensor.deliver(sent)
    await until(lambda: sensor.unread() == 0)
    clock.advance(1.0)
    assert why in (await published.state("distance", "stale")).why


async def test_counts_rate_and_bad_frames(
    begin: Begin, sensor: PluggedSensor, clock: ManualClock
) -> None:
    published = await begin(framing="maxbotix", unit="cm", farthest=5.0)
    await published.first(DriverConnected)
    sensor.send(b"noise\rR1\r" + maxbotix(100) + maxbotix(999) + maxbotix(101) * 4)
    await published.until(lambda: len(published.values("distance")) == 5)
    clock.advance(1.0)
    await published.until(lambda: bool(published.values("distance.bad")))
    assert published.values("distance.rate")[0] == pytest.approx(5.0)
    assert published.values("distance.bad")[0] == 3
    assert published.values("distance")[-1] == pytest.approx(1.01)


async def test_the_floor_is_published_as_itself(begin: Begin, sensor: PluggedSensor) -> None:
    published = await begin(framing="a02", floor=0.3)
    await published.first(DriverConnected)
    sensor.send(a02(120))
    reading = await published.first(Reading)
    assert (reading.value, reading.raw) == (0.3, 120)


async def test_it_has_no_verbs(tmp_path: Path, sensor: PluggedSensor) -> None:
    published = PublishedMessages(tmp_path)
    driver = Rangefinder("it", RangefinderSettings(port=str(sensor.port)), published.context)
    assert Rangefinder.offer(None).verbs == ()
    with pytest.raises(RejectedError):
        await driver.perform(BusJob("say"))
    await driver.stop(Scope.ALL)
    await driver.rest()
    await driver.close()
    sensor.unplug()


# -- preflight ---------------------------------------------------------------------------------


async def test_examine_says_what_it_hears(
    sensor: PluggedSensor, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = RangefinderSettings(port=str(sensor.port), framing="tfmini")
    monkeypatch.setattr(doctor, "_BEGINS_WITHIN_S", 0.5)
    (silent,) = await Rangefinder.examine(Probe("front", settings))
    assert (silent.level, silent.subject) == ("error", "front")
    assert "sends nothing" in silent.text
    monkeypatch.setattr(doctor, "_BEGINS_WITHIN_S", 40.0)  # such as a board that starts anew
    monkeypatch.setattr(doctor, "_LISTEN_S", 5.0)  # what is sent comes in time
    examined = asyncio.ensure_future(Rangefinder.examine(Probe("front", settings)))
    await until(lambda: _is_locked(sensor.port))
    sensor.send(tfmini(150) * 50)
    (hears,) = await examined
    assert (hears.level, hears.remedy) == ("ok", "")
    assert "1.50 m at 10 Hz, 0 bad frames" in hears.text
    sensor.unplug()
    (missing,) = await Rangefinder.examine(Probe("front", settings))
    assert (missing.level, missing.text) == ("error", f"{sensor.port} is not there")


def _is_locked(port: Path) -> bool:
    """Whether some program has the port for itself."""
    with port.open("rb", buffering=0) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        return False


# -- settings ----------------------------------------------------------------------------------


def test_maxbotix_needs_its_unit() -> None:
    ((setting, _),) = RangefinderSettings(port="x", framing="maxbotix").problems()
    assert setting == "unit"
    right = RangefinderSettings(port="x", framing="maxbotix", unit="in")
    assert (right.problems(), right.real_unit, right.real_baud) == ([], "in", 9600)


@pytest.mark.parametrize(
    "wrong", [{"nearest": 5.0, "farthest": 2.0}, {"floor": 0.01}, {"floor": 3.0, "ceiling": 2.0}]
)
def test_limits_in_the_wrong_order(wrong: dict[str, float]) -> None:
    ((setting, _),) = RangefinderSettings(port="x", **wrong).problems()  # type: ignore[arg-type]
    assert setting == "farthest"


# -- the filter --------------------------------------------------------------------------------


def judged_values(gates: FilterLimits, values: list[float]) -> list[float | None]:
    one = DistanceFilter(gates)
    return [one.judge(value).metres for value in values]


def test_a_single_stray_echo_changes_nothing() -> None:
    assert judged_values(GATES, [2.0, 2.0, 9.0, 2.1, 0.5, 2.1]) == [2.0, 2.0, None, 2.0, None, 2.1]


def test_somebody_who_steps_in_is_believed_at_the_third_value() -> None:
    assert judged_values(GATES, [3.0, 3.0, 1.0, 1.1, 1.05, 1.0]) == [
        3.0,
        3.0,
        None,
        None,
        1.05,
        1.05,
    ]


def test_after_a_confirmed_step_the_median_follows_at_once() -> None:
    gates = FilterLimits(0.02, 10.0, None, None, 0.5, 2, 5)
    assert judged_values(gates, [3.0] * 5 + [1.0, 1.0, 1.1])[-2:] == [1.0, 1.0]


def test_without_a_jump_limit_only_the_median_stands() -> None:
    gates = FilterLimits(0.02, 10.0, None, None, 0.0, 3, 3)
    assert judged_values(gates, [3.0, 1.0, 3.0]) == [3.0, 1.0, 3.0]


def test_floor_and_ceiling() -> None:
    gates = FilterLimits(0.02, 10.0, 0.3, 5.0, 0.0, 1, 1)
    assert judged_values(gates, [0.1, 0.3, 4.0, 5.0, 9.0, 10.1]) == [0.3, 0.3, 4.0, 5.0, 5.0, None]


@given(
    st.lists(st.floats(), max_size=60),
    st.floats(0, 2),
    st.integers(1, 5),
    st.integers(1, 7),
)
def test_whatever_comes_only_plausible_distances_leave(
    values: list[float], jump: float, confirm: int, median: int
) -> None:
    gates = FilterLimits(0.1, 8.0, 0.3, 6.0, jump, confirm, median)
    plausible = {min(max(value, 0.3), 6.0) for value in values if 0.1 <= value <= 8.0}
    for distance in judged_values(gates, values):
        assert distance is None or distance in plausible


@given(st.floats(0.1, 5), st.floats(0.1, 5), st.integers(1, 5), st.integers(1, 7))
def test_a_lasting_change_always_comes_through(
    before: float, after: float, confirm: int, median: int
) -> None:
    gates = FilterLimits(0.02, 10.0, None, None, 0.5, confirm, median)
    assert judged_values(gates, [before] * 9 + [after] * (confirm + median))[-1] == after


# -- session and doctor ------------------------------------------------------------------------


#: What a sensor sends, settings, and why that is no distance.
NO_DISTANCES: dict[str, tuple[bytes, dict[str, Any], str]] = {
    "nothing": (b"", {}, "sends nothing"),
    "zeros": (b"0\r\n", {}, "0.00 m is out of range (0.02 to 10 m): so sensors say"),
    "minus one": (b"-1\r\n", {}, "-0.01 m is out of range"),
    "timeout": (b"Distance: 3120 cm\r\n", {}, "31.20 m is out of range"),
    "39 m": (b"3900\r\n", {}, "39.00 m is out of range"),
    "R9999": (b"R9999\r", {"framing": "maxbotix", "unit": "mm"}, "nothing is in its range"),
    "R5000": (b"R5000\r", {"framing": "maxbotix", "unit": "mm"}, "nothing is in its range"),
    "R765": (b"R765\r", {"framing": "maxbotix", "unit": "cm"}, "nothing is in its range"),
    "two sensors": (b"150,52\r\n", {}, "may be two numbers, or one with a decimal comma"),
    "words": (b"Out of range\r\n", {}, "'Out of range' has no distance in it"),
    "microseconds": (b"7134 us\r\n", {}, "'7134 us' is no distance"),
    "no end of line": (b"123 ", {}, "println"),
    "another speed": (b"\x81\x00\xf7\x8f\r\n", {}, "check framing and baud"),
    "another framing": (b"123 cm\r\n", {"framing": "a02"}, "what comes is not a02 at 9600 baud"),
    "weak echo": (tfmini(300, strength=3), {"framing": "tfmini"}, "weak echo"),
    "no echo": (a02(0), {"framing": "a02"}, "no echo"),
}


# A thread reads the line: what it has taken may reach the driver after the clock was moved.
@pytest.mark.real_clock
@pytest.mark.parametrize("name", NO_DISTANCES)
async def test_the_doctor_refuses_what_a_session_refuses_in_the_same_words(
    begin: Begin,
    sensor: PluggedSensor,
    clock: ManualClock,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
) -> None:
    sent, settings, why = NO_DISTANCES[name]
    wanted = {"framing": "lines", **settings}
    monkeypatch.setattr(doctor, "_BEGINS_WITHIN_S", 40.0 if sent else 0.2)
    monkeypatch.setattr(doctor, "_LISTEN_S", 0.2)
    rangefinder_settings = RangefinderSettings(port=str(sensor.port), **wanted)
    examined = asyncio.ensure_future(Rangefinder.examine(Probe("it", rangefinder_settings)))
    await until(lambda: _is_locked(sensor.port))
    sensor.send(sent * 5)
    (finding,) = await examined
    assert finding.level == "error"

    published = await begin(**wanted)
    await published.first(DriverConnected)
    for _ in range(2):  # when it takes more, it has looked at what came before
        sensor.send(sent * 5)
        await until(lambda: sensor.unread() == 0)
    clock.advance(1.0)
    stale = await published.state("distance", "stale")
    assert why in stale.why
    assert stale.why.partition(";")[0] in finding.text
    assert finding.remedy in stale.why


async def test_a_ceiling_says_what_nothing_in_range_is_worth(
    begin: Begin, sensor: PluggedSensor
) -> None:
    published = await begin(framing="maxbotix", unit="mm", ceiling=4.5)
    await published.first(DriverConnected)
    sensor.send(b"R9999\r")
    assert (await published.first(Reading)).value == 4.5


async def test_the_doctor_warns_of_values_that_come_and_go(
    sensor: PluggedSensor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_BEGINS_WITHIN_S", 40.0)
    monkeypatch.setattr(doctor, "_LISTEN_S", 0.5)
    settings = RangefinderSettings(port=str(sensor.port))
    examined = asyncio.ensure_future(Rangefinder.examine(Probe("it", settings)))
    await until(lambda: _is_locked(sensor.port))
    sensor.send(b"\r\n152\r\n0\r\n0\r\n" * 5)
    (finding,) = await examined
    assert finding.level == "warning"
    assert "1.52 m" in finding.text
    assert "10 values refused; 0.00 m is out of range" in finding.text
