"""The SDK's serial port, made safe for a 50 Hz loop and for cables that come out.

The SDK's own port spins while it waits, counts its timeouts on the wall clock, lets two programs
share a port, and reports a pulled cable in four different ways. This one sleeps in `poll` for at
most 2 ms at a time, counts on the monotonic clock, locks the port, and raises `DeviceLostError`.
"""

from __future__ import annotations

import contextlib
import errno
import math
import os
import select
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import serial
from dynamixel_sdk import PortHandler

from woz_drivers.lines.answer_times import BUSY_REMEDY, TOO_BUSY
from woz_drivers.lines.serial_line import LOSSES, explain_port_error, reason_of
from woz_tui.drivers.contract import DeviceLostError

#: Longest sleep in one wait for bytes, in milliseconds.
WAIT_MS = 2.0
#: What an adapter takes to pass bytes on, in milliseconds, where the system does not say.
LATENCY_MS = 2.0
#: Ample time for an answer, in milliseconds: an FTDI adapter as delivered passes it on after 16.
AMPLE_MS = 100.0
#: A line that never falls silent is given up so long after the deadline, in milliseconds.
BABBLE_MS = 50.0
#: Where this process stood still for that long, what came meanwhile is taken in so many reads.
LATE_READS = 3
#: A wait that takes so much longer than it was told to is this process's own delay, in ms.
OWN_DELAY_MS = 2.0
#: Delays of its own that are together so long within so long explain a silence, in milliseconds.
BUSY_MS, BUSY_WITHIN_MS = 50.0, 1000.0
#: A line that takes nothing for so long is broken, in milliseconds.
STUCK_MS = 200.0
#: USB serial adapters as the kernel knows them.
SERIAL_DEVICES = Path("/sys/bus/usb-serial/devices")


class ServoPort(PortHandler):  # type: ignore[misc]  # the SDK has no types
    """A port of one opening: after `DeviceLostError` it is closed, and a new one has to be made.

    Attributes:
        waits: How often it slept for bytes, for tests and figures.
        patience_ms: How long it waits for an answer, beside the time its bytes take.
        longest_ms: The longest wait for bytes that came, since somebody set this to 0.
        own_delay_ms: How much of the wait for the present packet this process stood still itself:
            that counts as nobody's delay.
    """

    def __init__(self, path: str, baud: int, reply_timeout_ms: float | None = None) -> None:
        super().__init__(path)
        self.baudrate = baud
        self.is_open = False
        self.ser: serial.Serial | None = None
        self.waits = 0
        self.own_delay_ms = 0.0
        self._awake_at = float("-inf")
        #: Its own delays of late: when each ended, and how long it was.
        self._delays: deque[tuple[float, float]] = deque()
        self._late_reads = 0
        self.low_latency = False
        self.patience_ms = reply_timeout_ms or answer_timeout_ms(LATENCY_MS)
        self.longest_ms = 0.0
        self._by_adapter = reply_timeout_ms is None
        self._poll, self._room = select.poll(), select.poll()

    def open(self) -> None:
        """Open and lock the port; `DeviceLostError` says why not, and what to do."""
        try:
            self.setupPort(self.baudrate)
        except (*LOSSES, ValueError) as error:
            self.closePort()
            trouble = explain_port_error(self.port_name, self.baudrate, error)
            raise DeviceLostError(trouble.what, trouble.remedy) from error

    def setupPort(self, cflag_baud: int) -> bool:  # noqa: N802 - the SDK calls it so
        """Open the device; called by the SDK when the baud rate is set, too."""
        if self.is_open:
            self.closePort()
        self.ser = serial.Serial(
            self.port_name,
            baudrate=cflag_baud,
            timeout=0,
            exclusive=True,
        )
        try:
            self.ser.set_low_latency_mode(True)
            self.low_latency = True
        except (ValueError, OSError, NotImplementedError):
            self.low_latency = False  # pseudo-terminals and CDC adapters have no such switch
        self.is_open = True
        if self._by_adapter:
            self.patience_ms = answer_timeout_ms(latency_timer(self.port_name) or LATENCY_MS)
        # A byte on the wire has ten bits: start, eight of data, stop.
        self.tx_time_per_byte = 10_000.0 / self.baudrate
        self._poll, self._room = select.poll(), select.poll()
        self._poll.register(self.ser.fileno(), select.POLLIN)
        self._room.register(self.ser.fileno(), select.POLLOUT)
        return True

    def closePort(self) -> None:  # noqa: N802
        """Close it; never raises, whatever has become of the device."""
        self.is_open = False
        if self.ser is not None:
            with contextlib.suppress(*LOSSES):  # gone already, which is what was wanted
                self.ser.close()
            self.ser = None

    def clearPort(self) -> None:  # noqa: N802
        """Throw away what has come in and was not asked for."""
        with self._or_lost():
            self._open().reset_input_buffer()

    def writePort(self, packet: list[int]) -> int:  # noqa: N802
        """Send a packet; returns the number of bytes sent.

        Not by pyserial: it takes a line for broken that has taken everything, if this process
        comes back late from writing.
        """
        sent, whole = 0, bytes(packet)
        with self._or_lost():
            number = self._open().fileno()
            while sent < len(whole):
                try:
                    sent += os.write(number, whole[sent:])
                except BlockingIOError:
                    if not self._room.poll(STUCK_MS):
                        raise OSError(errno.ETIMEDOUT, "it accepts no more data") from None
        return sent

    def readPort(self, length: int) -> bytes:  # noqa: N802
        """At most `length` bytes; none if nothing came within 2 ms."""
        if length <= 0:
            return b""
        self._notice_delay()
        elapsed = self.getTimeSinceStart()
        if elapsed > self.packet_timeout + BABBLE_MS:
            self._late_reads += 1
            if self._late_reads > LATE_READS:
                return b""
        self.waits += 1
        with self._or_lost():
            ready = self._poll.poll(WAIT_MS)
            self._notice_delay()
            if not ready:
                return b""
            data = os.read(self._open().fileno(), length)
            if not data:
                raise OSError(errno.EIO, "the device is ready to read, but sends no data")
        self.longest_ms = max(self.longest_ms, self.getTimeSinceStart())
        return data

    def setPacketTimeout(self, packet_length: int) -> None:  # noqa: N802
        """Begin to wait for a packet of `packet_length` bytes."""
        self.setPacketTimeoutMillis(self.tx_time_per_byte * packet_length + self.patience_ms)

    def setPacketTimeoutMillis(self, msec: float) -> None:  # noqa: N802
        """Begin to wait for so many milliseconds."""
        super().setPacketTimeoutMillis(msec)
        self._late_reads = 0
        self.own_delay_ms, self._awake_at = 0.0, self.getCurrentTime()

    def getCurrentTime(self) -> float:  # noqa: N802
        """Milliseconds of the monotonic clock."""
        return time.monotonic_ns() / 1e6

    def getTimeSinceStart(self) -> float:  # noqa: N802
        """Milliseconds since the wait for a packet began, in which this process was awake."""
        return self.getCurrentTime() - float(self.packet_start_time) - self.own_delay_ms

    def _notice_delay(self) -> None:
        """Between two looks at the line pass 2 ms at the most, if this process gets its turn."""
        now = self.getCurrentTime()
        delay = now - self._awake_at - WAIT_MS
        self._awake_at = now
        if delay > OWN_DELAY_MS:
            self.own_delay_ms += delay
            self._forget_delays(now)
            self._delays.append((now, delay))

    def _forget_delays(self, now: float) -> None:
        while self._delays and now - self._delays[0][0] > BUSY_WITHIN_MS:
            self._delays.popleft()

    def _delayed_ms(self) -> float:
        """How long this process stood still itself within the last second."""
        self._forget_delays(self.getCurrentTime())
        return sum(delay for _, delay in self._delays)

    @property
    def is_late(self) -> bool:
        """Whether this process was itself too late lately to judge a silence."""
        return self._delayed_ms() >= BUSY_MS

    def blame(self, what: str, remedy: str) -> tuple[str, str]:
        """A silence and its remedy as they are told: a computer that was late blames itself."""
        if not self.is_late:
            return what, remedy
        late = f"it stood still for {self._delayed_ms():.0f} ms a moment ago"
        return (
            f"{what}, but {TOO_BUSY} ({late})",
            f"{BUSY_REMEDY}; if that does not help: {remedy}",
        )

    def _open(self) -> serial.Serial:
        if self.ser is None:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        return self.ser

    @contextlib.contextmanager
    def _or_lost(self) -> Iterator[None]:
        """An error of the line in here is `DeviceLostError`."""
        try:
            yield
        except LOSSES as error:
            raise DeviceLostError(
                f"the line to the servos broke ({self.port_name}: {reason_of(error)})",
                "check cable and adapter; the program connects again by itself",
            ) from error


def answer_timeout_ms(latency_ms: float) -> float:
    """How long to wait for an answer, by the time that it takes at least."""
    return latency_ms * 2.0 + 2.0


def slow_answers(path: str, longest_ms: float) -> tuple[str, str]:
    """What to say about answers that come later than the driver would wait, and the remedy."""
    timer = latency_file(path)
    how = f": echo 1 | sudo tee {timer}" if timer.exists() else ", if it has one"
    return (
        f"answers on {path} take up to {longest_ms:.0f} ms, so the joints get fewer setpoints",
        f"set the adapter's latency timer to 1 ms{how}; or set"
        f" `reply_timeout: {math.ceil(answer_timeout_ms(longest_ms))}`, and nothing is measured any"
        " more",
    )


def latency_file(path: str) -> Path:
    """Where the system keeps the latency timer of an FTDI adapter, if it is one."""
    return SERIAL_DEVICES / Path(path).resolve().name / "latency_timer"


def latency_timer(path: str) -> float | None:
    """The latency timer of an FTDI adapter in milliseconds; None for anything else."""
    try:
        return float(latency_file(path).read_text("ascii"))
    except (OSError, ValueError):
        return None
