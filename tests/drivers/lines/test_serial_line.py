"""A serial port that comes, goes and comes back, on real pseudo-terminals."""

from __future__ import annotations

import asyncio
import errno
import fcntl
import os
import termios
import threading
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import serial
from woz_drivers.lines.serial_line import (
    SerialLine,
    explain_port_error,
    holders,
    present_ports,
    reason_of,
)

from tests.drivers.published_messages import PATIENCE_S, until
from tests.fakes.rangefinder import PluggedSensor
from woz_tui.drivers.contract import DeviceLostError


class LineRig:
    """A line and what it told, as a list of words, bytes and troubles."""

    def __init__(self, port: Path) -> None:
        self.reports: asyncio.Queue[str | bytes | DeviceLostError] = asyncio.Queue()
        self.line = SerialLine(
            str(port),
            115200,
            on_open=lambda: self.reports.put_nowait("open"),
            on_bytes=self.reports.put_nowait,
            on_trouble=self.reports.put_nowait,
            poll_s=0.01,
        )

    async def next(self) -> str | bytes | DeviceLostError:
        return await asyncio.wait_for(self.reports.get(), PATIENCE_S)

    async def trouble(self) -> DeviceLostError:
        told = await self.next()
        assert isinstance(told, DeviceLostError)
        return told


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[LineRig]:
    one = LineRig(tmp_path / "port")
    yield one
    await one.line.close()


async def test_waits_for_a_missing_port_and_reads_it(rig: LineRig, tmp_path: Path) -> None:
    rig.line.start()
    assert (await rig.trouble()).what == f"{tmp_path}/port is not there"
    sensor = PluggedSensor(tmp_path / "port")
    assert await rig.next() == "open"
    assert rig.line.connected
    sensor.send(b"R100\r")
    assert await rig.next() == b"R100\r"
    sensor.unplug()


async def test_a_pulled_cable_is_told_once_and_the_port_opened_again(
    rig: LineRig, tmp_path: Path
) -> None:
    sensor = PluggedSensor(tmp_path / "port")
    rig.line.start()
    for _ in range(3):
        assert await rig.next() == "open"
        sensor.unplug()
        lost = await rig.trouble()
        assert lost.what.startswith(f"{tmp_path}/port was lost")
        assert not rig.line.connected
        assert (await rig.trouble()).what.endswith("is not there")
        sensor.plug()
    assert await rig.next() == "open"
    sensor.send(b"again")
    assert await rig.next() == b"again"
    sensor.unplug()


async def test_an_occupied_port_is_named_and_taken_when_it_is_free(
    rig: LineRig, tmp_path: Path
) -> None:
    sensor = PluggedSensor(tmp_path / "port")
    other = os.open(tmp_path / "port", os.O_RDWR | os.O_NOCTTY)
    fcntl.flock(other, fcntl.LOCK_EX)
    rig.line.start()
    busy = await rig.trouble()
    assert busy.what.startswith(f"{tmp_path}/port is in use by ")
    assert busy.what.endswith(f"({os.getpid()})")
    assert busy.remedy == "end the other program"
    os.close(other)
    assert await rig.next() == "open"
    with pytest.raises(serial.SerialException):
        serial.Serial(str(tmp_path / "port"), exclusive=True)
    sensor.unplug()


def test_who_holds_a_port_is_named_whatever_else_it_opens_and_closes(tmp_path: Path) -> None:
    with (tmp_path / "port").open("w") as file:  # behind all that comes and goes
        held = fcntl.fcntl(file, fcntl.F_DUPFD, 200)
    done = threading.Event()

    def busy() -> None:
        while not done.is_set():
            for number in [os.open(os.devnull, os.O_RDONLY) for _ in range(50)]:
                os.close(number)

    worker = threading.Thread(target=busy)
    worker.start()
    try:
        for _ in range(20):
            assert any(f"({os.getpid()})" in one for one in holders(str(tmp_path / "port")))
    finally:
        done.set()
        worker.join()
        os.close(held)


async def test_a_file_is_no_port(rig: LineRig, tmp_path: Path) -> None:
    (tmp_path / "port").write_text("")
    rig.line.start()
    assert (await rig.trouble()).what == f"{tmp_path}/port is not a serial port"


async def test_writing_arrives_whole_even_when_the_device_reads_slowly(
    rig: LineRig, tmp_path: Path
) -> None:
    sensor = PluggedSensor(tmp_path / "port")
    rig.line.start()
    assert await rig.next() == "open"
    data = bytes(range(256)) * 200
    rig.line.write(data)
    received = bytearray()

    def arrived() -> bool:
        received.extend(sensor.received())
        return len(received) >= len(data)

    await until(arrived)
    assert bytes(received) == data
    sensor.unplug()


async def test_a_device_that_never_reads_is_an_error_and_not_a_heap_of_memory(
    rig: LineRig, tmp_path: Path
) -> None:
    sensor = PluggedSensor(tmp_path / "port")
    rig.line.start()
    assert await rig.next() == "open"
    with pytest.raises(DeviceLostError, match="no more data"):
        for _ in range(1000):
            rig.line.write(bytes(1000))
    sensor.unplug()


async def test_writing_to_a_missing_port_is_lost_with_the_remedy(rig: LineRig) -> None:
    with pytest.raises(DeviceLostError, match="not open yet"):
        rig.line.write(b"x")
    rig.line.start()
    await rig.trouble()
    with pytest.raises(DeviceLostError, match="is not there") as raised:
        rig.line.write(b"x")
    assert raised.value.remedy


async def test_writing_to_a_line_that_has_just_broken_is_lost(rig: LineRig, tmp_path: Path) -> None:
    sensor = PluggedSensor(tmp_path / "port")
    rig.line.start()
    assert await rig.next() == "open"
    sensor.unplug()
    with pytest.raises(DeviceLostError, match="was lost") as raised:
        rig.line.write(b"x")
    assert raised.value.remedy


async def test_closing_lets_go_of_the_port(rig: LineRig, tmp_path: Path) -> None:
    sensor = PluggedSensor(tmp_path / "port")
    rig.line.start()
    assert await rig.next() == "open"
    await rig.line.close()
    assert not rig.line.connected
    serial.Serial(str(tmp_path / "port"), exclusive=True).close()
    sensor.unplug()


@pytest.mark.parametrize(
    ("code", "what", "remedy"),
    [
        (errno.ENOENT, "is not there", "plug the adapter in"),
        (errno.EACCES, "no permission", "usermod -aG dialout"),
        (errno.EBUSY, "is in use by another program", "fuser"),
        (errno.EIO, "cannot be opened: Input/output error", "plugged in"),
    ],
)
def test_every_refusal_has_a_remedy(code: int, what: str, remedy: str) -> None:
    trouble = explain_port_error("/dev/ttyUSB9", 9600, OSError(code, os.strerror(code)))
    assert what in trouble.what and "/dev/ttyUSB9" in trouble.what
    assert remedy in trouble.remedy


def test_no_permission_names_the_group() -> None:
    trouble = explain_port_error(
        "/dev/ttyUSB9", 9600, PermissionError(errno.EACCES, "Permission denied")
    )
    assert trouble.what == "no permission to open /dev/ttyUSB9"
    assert trouble.remedy.startswith("sudo usermod -aG dialout $USER")


def test_a_missing_port_lists_what_is_there(tmp_path: Path) -> None:
    missing = FileNotFoundError(errno.ENOENT, "No such file or directory")
    assert (
        "no serial device is plugged in"
        in explain_port_error("/dev/x", 9600, missing, tmp_path).remedy
    )
    (tmp_path / "usb-Arduino-if00").touch()
    assert (
        str(tmp_path / "usb-Arduino-if00")
        in explain_port_error("/dev/x", 9600, missing, tmp_path).remedy
    )
    assert present_ports(tmp_path / "nowhere") == []


def test_other_errors_keep_their_own_words() -> None:
    assert "300 baud" in explain_port_error("/dev/x", 300, ValueError("Invalid baud rate")).what
    assert "boom" in explain_port_error("/dev/null", 300, serial.SerialException("boom")).what
    assert reason_of(termios.error(5, "Input/output error")) == "Input/output error"
