"""The emulated servos against independent masters, and as a process."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest
from dynamixel_sdk import PacketHandler, PortHandler
from hypothesis import given
from hypothesis import strategies as st

from tests.fakes import servo_codec as codec
from tests.fakes.servos import ServoBus

GOAL, PRESENT, WATCHDOG, TORQUE = 116, 132, 98, 64


def eventually(holds: Callable[[], bool]) -> None:
    limit = monotonic() + 20.0
    while not holds():
        assert monotonic() < limit, "not within 20 s"
        sleep(0.005)


@pytest.fixture
def bus(tmp_path: Path) -> Iterator[ServoBus]:
    with ServoBus([11, 12, 13], tmp_path / "servos") as servos:
        yield servos


@pytest.fixture
def sdk(bus: ServoBus, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Any, Any]]:
    """The maker's own port and packets, as they come, but with more patience."""
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 500)
    port = PortHandler(str(bus.link))
    assert port.setBaudRate(1_000_000)
    yield port, PacketHandler(2.0)
    port.closePort()


def test_rustypot_is_served_protocol_2(bus: ServoBus) -> None:
    rustypot = pytest.importorskip("rustypot")  # there is none for Python 3.14 yet
    master = rustypot.Xl330PyController(str(bus.link), 1_000_000, 5.0)
    assert master.ping(11) and master.ping(13)
    assert master.broadcast_scan() == {11: 1200, 12: 1200, 13: 1200}
    assert master.sync_read_raw_present_position([11, 12, 13]) == [2048, 2048, 2048]
    master.sync_write_torque_enable([11, 13], [True, True])
    master.sync_write_raw_goal_position([11, 12, 13], [1500, 1600, 2500])
    eventually(lambda: bus.servo(13).position == 2500 and bus.servo(11).position == 1500)
    # Without torque a goal is taken, but nothing moves.
    assert master.sync_read_raw_present_position([11, 12, 13]) == [1500, 2048, 2500]
    bus.servo(12).raise_alarm(0x20)
    assert list(master.read_hardware_error_status(12)) == [0x20]
    master.close()


def test_rustypot_is_served_protocol_1(tmp_path: Path) -> None:
    rustypot = pytest.importorskip("rustypot")  # there is none for Python 3.14 yet
    with ServoBus([1], tmp_path / "servos", model="MX-28") as bus:
        master = rustypot.MxPyController(str(bus.link), 1_000_000, 5.0)
        assert master.ping(1)
        assert list(master.read_raw_present_position(1)) == [2048]
        assert not bus.servo(1).torque
        master.write_raw_goal_position(1, 1000)
        assert bus.servo(1).torque  # this family switches itself on with a goal
        eventually(lambda: bus.servo(1).position == 1000)
        master.close()


def test_the_makers_sdk_is_served(bus: ServoBus, sdk: tuple[Any, Any]) -> None:
    port, packets = sdk
    found, result = packets.broadcastPing(port)
    assert result == 0
    assert found == {11: [1200, 52], 12: [1200, 52], 13: [1200, 52]}
    assert packets.read4ByteTxRx(port, 12, PRESENT) == (2048, 0, 0)
    # A write that is registered takes effect with the action, not before.
    assert packets.regWriteTxRx(port, 12, GOAL, 4, [0, 7, 0, 0]) == (0, 0)
    assert bus.servo(12).goal == 2048
    packets.action(port, 12)
    eventually(lambda: bus.servo(12).goal == 1792)


def test_refusals_carry_the_published_numbers(bus: ServoBus, sdk: tuple[Any, Any]) -> None:
    port, packets = sdk
    beyond, readonly, past = 6, 7, 5
    assert packets.write4ByteTxRx(port, 11, GOAL, 9999) == (0, beyond)
    assert packets.write4ByteTxRx(port, 11, PRESENT, 1) == (0, readonly)
    assert packets.write1ByteTxRx(port, 11, TORQUE, 1) == (0, 0)
    assert packets.write1ByteTxRx(port, 11, 11, 4) == (0, readonly)  # EEPROM under torque
    assert packets.readTxRx(port, 11, 250, 20)[1:] == (0, past)


def test_watchdog_bites_refuses_goals_and_is_cleared_by_0(
    bus: ServoBus, sdk: tuple[Any, Any]
) -> None:
    port, packets = sdk
    packets.write4ByteTxRx(port, 11, 112, 20)
    packets.write1ByteTxRx(port, 11, TORQUE, 1)
    packets.write1ByteTxRx(port, 11, WATCHDOG, 25)
    packets.write4ByteTxRx(port, 11, GOAL, 4000)
    eventually(lambda: bus.servo(11).watchdog == -1)
    here = bus.servo(11).position
    assert 2048 < here < 4000
    assert packets.read1ByteTxRx(port, 11, WATCHDOG) == (255, 0, 0)
    out_of_range = 4
    assert packets.write4ByteTxRx(port, 11, GOAL, 4000) == (0, out_of_range)
    assert bus.servo(11).position == here
    assert packets.write1ByteTxRx(port, 11, WATCHDOG, 0) == (0, 0)
    assert packets.write4ByteTxRx(port, 11, GOAL, 4000) == (0, 0)
    eventually(lambda: bus.servo(11).position > here)


def test_reboot_forgets_torque_and_alarm(bus: ServoBus, sdk: tuple[Any, Any]) -> None:
    port, packets = sdk
    packets.write1ByteTxRx(port, 11, TORQUE, 1)
    bus.servo(11).raise_alarm(0x20)
    alert, readonly = 0x80, 7
    assert packets.write1ByteTxRx(port, 11, TORQUE, 1) == (0, alert | readonly)
    packets.reboot(port, 11)
    eventually(lambda: packets.ping(port, 11)[1] == 0)
    assert packets.read1ByteTxRx(port, 11, 70) == (0, 0, 0)
    assert not bus.servo(11).torque


@given(st.integers(0, 252), st.binary(max_size=40))
def test_protocol_2_packets_round_trip(servo: int, params: bytes) -> None:
    packet = codec.packet_2(servo, codec.WRITE, params)
    # Cut anywhere, after noise: found whole, and no header inside.
    assert codec.HEADER_2[:3] not in packet[3:]
    reader = codec.Reader(2)
    found = reader.feed(b"\xff\x00\xff" + packet[:7]) + reader.feed(packet[7:])
    assert found == [codec.Instruction(servo, codec.WRITE, params)]


@given(st.integers(0, 252), st.binary(max_size=40), st.integers(0, 300))
def test_a_flipped_byte_is_noticed(servo: int, params: bytes, where: int) -> None:
    packet = bytearray(codec.packet_2(servo, codec.WRITE, params))
    place = 7 + where % (len(packet) - 7)
    packet[place] ^= 0x10
    found = codec.Reader(2).feed(bytes(packet))
    assert all(not instruction.intact for instruction in found)


def test_crc_of_the_published_example() -> None:
    # Protocol 2.0, CRC calculation: ping to id 1 is FF FF FD 00 01 03 00 01 19 4E.
    assert codec.packet_2(1, codec.PING, b"") == bytes.fromhex("fffffd0001030001194e")
    # Protocol 1.0: ping to id 1 is FF FF 01 02 01 FB.
    assert codec.packet_1(1, codec.PING, b"") == bytes.fromhex("ffff010201fb")


def test_as_a_process_it_journals_and_takes_orders(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 500)
    link, journal = tmp_path / "servos", tmp_path / "journal"
    command = [sys.executable, "-m", "tests.fakes.servos", "--link", str(link), "--ids", "11,12"]
    with subprocess.Popen(
        [*command, "--journal", str(journal), "--position", "12=1500"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdin is not None and process.stdout is not None
        assert process.stdout.readline() == f"ready {link}\n"
        port = PortHandler(str(link))
        assert port.setBaudRate(1_000_000)
        packets = PacketHandler(2.0)
        assert packets.read4ByteTxRx(port, 12, PRESENT) == (1500, 0, 0)
        assert packets.write4ByteTxRx(port, 11, GOAL, 2000) == (0, 0)
        port.closePort()
        process.stdin.write("pull\n")
        process.stdin.flush()
        eventually(lambda: not link.is_symlink())
        process.send_signal(signal.SIGTERM)
        process.wait(20)
    entries = [json.loads(line) for line in journal.read_text().splitlines()]
    assert [entry["event"] for entry in entries] == ["plugged", "write", "pulled"]
    assert entries[1] | {"t_ns": 0} == {
        "t_ns": 0,
        "event": "write",
        "id": 11,
        "address": GOAL,
        "data": [0xD0, 7, 0, 0],
        "value": 2000,
        "error": 0,
        "position": 2048.0,
    }
    times = [entry["t_ns"] for entry in entries]
    assert times == sorted(times)
