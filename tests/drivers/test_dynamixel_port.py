"""The line to servos as the system has it: what it takes, and when it counts as broken."""

from __future__ import annotations

import itertools
import os
import re
import time
import tty
from collections.abc import Iterator
from typing import Any

import pytest
from serial.serialutil import Timeout
from woz_drivers.dynamixel import port as module
from woz_drivers.dynamixel.port import ServoPort

from woz_tui.drivers.contract import DeviceLostError


@pytest.fixture
def line() -> Iterator[tuple[ServoPort, int]]:
    """An open port, and the other end of its line."""
    far, near = os.openpty()
    tty.setraw(near)
    port = ServoPort(os.ttyname(near), 1_000_000)
    port.open()
    yield port, far
    port.closePort()
    os.close(near)
    os.close(far)


def test_what_the_line_has_taken_is_sent_however_late_this_process_comes_back(
    line: tuple[ServoPort, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    port, far = line
    hours = itertools.count(0.0, 3600.0)
    monkeypatch.setattr(Timeout, "TIME", lambda: next(hours))
    assert port.writePort([0xFF, 0xFF, 0xFD, 0]) == 4
    assert os.read(far, 10) == b"\xff\xff\xfd\0"


def test_a_packet_that_does_not_fit_at_once_is_sent_whole(line: tuple[ServoPort, int]) -> None:
    port, far = line
    packet = [number % 251 for number in range(50_000)]
    came = bytearray()

    class Room:
        """The other end takes what there is whenever the line is full."""

        def poll(self, milliseconds: float) -> bool:
            came.extend(os.read(far, 65536))
            return True

    port._room = Room()  # type: ignore[assignment]
    assert port.writePort(packet) == len(packet)
    while len(came) < len(packet):
        came.extend(os.read(far, 65536))
    assert list(came) == packet


def test_an_answer_that_came_while_this_process_stood_still_is_read(
    line: tuple[ServoPort, int],
) -> None:
    port, far = line
    port.setPacketTimeout(6)
    os.write(far, b"answer")
    port.packet_start_time -= 1000.0
    assert port.readPort(6) == b"answer"


class LateTurns:
    """A clock, and a poll after which this process gets its turn so much later."""

    def __init__(self, poll: Any, late_ms: float) -> None:
        self._poll = poll
        self.late_ms = late_ms
        self._ahead_ns = 0

    def poll(self, timeout: float) -> Any:
        ready = self._poll.poll(timeout)
        self._ahead_ns += round(self.late_ms * 1e6)
        return ready

    def monotonic_ns(self) -> int:
        return time.monotonic_ns() + self._ahead_ns


@pytest.fixture
def late(line: tuple[ServoPort, int], monkeypatch: pytest.MonkeyPatch) -> LateTurns:
    port, _ = line
    turns = LateTurns(port._poll, late_ms=300.0)
    port._poll = turns  # type: ignore[assignment]
    monkeypatch.setattr(module, "time", turns)
    return turns


@pytest.mark.usefixtures("late")
def test_the_time_in_which_this_process_stood_still_is_nobodys_delay(
    line: tuple[ServoPort, int],
) -> None:
    port, far = line
    port.patience_ms = 100.0
    port.setPacketTimeout(6)
    os.write(far, b"ans")
    assert port.readPort(6) == b"ans"
    assert not port.isPacketTimeout()
    os.write(far, b"wer")
    assert port.readPort(3) == b"wer"
    assert port.longest_ms < 100.0


def test_a_silence_is_put_down_to_a_computer_that_was_late(
    line: tuple[ServoPort, int], late: LateTurns
) -> None:
    port, _ = line
    cable = ("does not answer", "check its cable")
    assert port.blame(*cable) == cable
    port.setPacketTimeout(6)
    assert port.readPort(6) == b""
    what, remedy = port.blame(*cable)
    # The machine of the test adds its own delays.
    assert re.search(
        r"this computer was too busy to listen \(it stood still for [3-9]\d\d ms", what
    )
    assert remedy.startswith("end other programs")
    late.late_ms = 0.0
    late._ahead_ns += 2_000_000_000
    assert port.blame(*cable) == cable


def test_a_line_that_never_falls_silent_is_given_up(line: tuple[ServoPort, int]) -> None:
    port, far = line
    os.write(far, b"x" * 1000)
    port.setPacketTimeout(6)
    port.packet_start_time -= 1000.0
    reads = [port.readPort(6) for _ in range(10)]
    assert b"" in reads
    assert set(reads[reads.index(b"") :]) == {b""}
    port.setPacketTimeout(6)
    assert port.readPort(6)


def test_a_line_that_takes_nothing_more_is_broken(
    line: tuple[ServoPort, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "STUCK_MS", 1.0)
    port, _ = line
    with pytest.raises(DeviceLostError, match="no more data"):
        port.writePort([0] * 100_000)


def test_a_line_whose_other_end_is_gone_is_broken(line: tuple[ServoPort, int]) -> None:
    port, _ = line
    port.closePort()
    with pytest.raises(DeviceLostError, match="broke"):
        port.writePort([0])


def test_delays_of_long_ago_are_forgotten_while_nobody_is_silent(
    line: tuple[ServoPort, int], late: LateTurns
) -> None:
    port, far = line
    late.late_ms = 400.0
    for _ in range(20):
        port.setPacketTimeout(6)
        os.write(far, b"answer")
        assert port.readPort(6) == b"answer"
    assert len(port._delays) <= 4
