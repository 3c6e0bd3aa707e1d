"""Tests for authors of drivers: whether a driver keeps the contract, with its hardware and without.

    from woz_tui.testing import DriverTests

    class TestLamp(DriverTests):
        driver = Lamp
        settings = LampSettings(port="/dev/no-such-port")

pytest runs it; `drivers/README.md` shows more. `MockTransport` stands in for hardware that is
reached through a class. For tests of one's own there are `RecordingContext`, which remembers what a
driver publishes, `PlainJob`, a command as the bus gives it, and `until`.
"""

from woz_tui.testing.contract_checks import check
from woz_tui.testing.device import Device
from woz_tui.testing.mock_transport import MockTransport
from woz_tui.testing.recording_context import PlainJob, RecordingContext, until
from woz_tui.testing.suite import DriverTests

__all__ = [
    "Device",
    "DriverTests",
    "MockTransport",
    "PlainJob",
    "RecordingContext",
    "check",
    "until",
]
