"""The driver contract as a class of tests for pytest."""

from __future__ import annotations

import asyncio
import unittest
from collections.abc import Coroutine
from contextlib import AbstractAsyncContextManager
from typing import Any, ClassVar

from woz_tui.drivers.contract import Driver, Finding
from woz_tui.testing import contract_checks
from woz_tui.testing.contract_checks import Device


class DriverTests:
    """Inherit from it in a class called `Test...`, and name the driver and its settings.

    Attributes:
        driver: The driver's class.
        settings: Settings with which it finds no hardware, or needs none.
    """

    driver: ClassVar[type[Driver]]
    settings: ClassVar[Any]

    def device(self) -> AbstractAsyncContextManager[Device]:
        """A stand-in for the hardware, made anew for each test; without it three tests are skipped.

        Entered in the event loop in which the driver runs.
        """
        raise unittest.SkipTest("define device() to test stop, loss and return of the hardware")

    def test_declares_what_a_file_can_name(self) -> None:
        """Settings, verbs and their arguments, remarks, findings of the doctor."""
        _passes(contract_checks.declared(self.driver, self.settings))

    def test_opens_and_closes_without_hardware(self) -> None:
        """Prompt, whatever is missing; nothing is left behind and nothing published afterwards."""
        _passes(contract_checks.closes(self.driver, self.settings))

    def test_opens_and_closes_with_its_device(self) -> None:
        """It finds the device, and lets go of it."""
        _passes(contract_checks.closes_with(self.driver, self.device()))

    def test_stop_and_cancel_end_a_command(self) -> None:
        """While a command runs; the next one is carried out again."""
        _passes(contract_checks.stops(self.driver, self.device()))

    def test_notices_a_lost_device(self) -> None:
        """In the middle of a command; it finds the device again if that can be plugged in."""
        _passes(contract_checks.loses(self.driver, self.device()))


def _passes(findings: Coroutine[Any, Any, list[Finding]]) -> None:
    found = asyncio.run(findings)
    assert not found, "\n".join(
        f"{each.subject}: {each.text}{f' ({each.remedy})' if each.remedy else ''}" for each in found
    )
