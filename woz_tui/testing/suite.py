"""The driver contract as a class of tests for pytest."""

from __future__ import annotations

import asyncio
import unittest
from collections.abc import Coroutine
from contextlib import AbstractAsyncContextManager
from typing import Any, ClassVar

from woz_tui.drivers.contract import Driver, DriverContext, Finding
from woz_tui.network.driver_process import DriverProcess, ProcessDriver
from woz_tui.network.driver_server import OfferedDriver
from woz_tui.testing import contract_checks
from woz_tui.testing.device import Device

#: What a class says of itself, with its settings.
_SAYS = ("offer", "remarks", "voices", "examine")


class DriverTests:
    """Inherit from it in a class called `Test...`, and name the driver and its settings.

    Attributes:
        driver: The driver's class.
        settings: Settings with which it finds no hardware, or needs none.
        own_process: Whether it is tried in a process of its own, as sessions have drivers that did
            not come with woz-tui. A class that inherits from the tests of a driver and sets it has
            them run that way, too.
    """

    driver: ClassVar[type[Driver]]
    settings: ClassVar[Any]
    own_process: ClassVar[bool] = False

    def device(self) -> AbstractAsyncContextManager[Device]:
        """A stand-in for the hardware, made anew for each test and entered in its event loop.

        Without it whatever needs one is skipped, and by name what it cannot show.
        """
        raise unittest.SkipTest("define device() to test stop, loss and return of the hardware")

    def _tested(self) -> type[Driver]:
        return _in_own_process(self.driver) if self.own_process else self.driver

    def test_declares_what_a_file_can_name(self) -> None:
        """Settings, verbs and their arguments, remarks, findings of the doctor."""
        _passes(contract_checks.declared(self._tested(), self.settings))

    def test_opens_and_closes_without_hardware(self) -> None:
        """Prompt, whatever is missing; nothing is left behind and nothing published afterwards."""
        _passes(contract_checks.closes(self._tested(), self.settings))

    def test_opens_and_closes_with_its_device(self) -> None:
        """It finds the device, and lets go of it."""
        _passes(contract_checks.closes_with(self._tested(), self.device()))

    def test_stop_and_cancel_end_a_command(self) -> None:
        """While a command runs; what moves stands still then; the next one is carried out again."""
        _passes(contract_checks.stops(self._tested(), self.device()))

    def test_notices_a_lost_device(self) -> None:
        """In the middle of a command."""
        _passes(contract_checks.loses(self._tested(), self.device()))

    def test_finds_its_device_again(self) -> None:
        """It is plugged in again after that, and nothing moves by itself."""
        _passes(contract_checks.returns(self._tested(), self.device()))

    def test_an_error_of_the_device_ends_the_command(self) -> None:
        """It is not taken for done, nor waited for."""
        _passes(contract_checks.fails(self._tested(), self.device()))

    def test_numbers_are_in_the_units_of_the_contract(self) -> None:
        """Those that reach the device, and those that come from it."""
        _passes(contract_checks.measures(self._tested(), self.device()))

    def test_shows_what_its_facts_claim(self) -> None:
        """`woz robots` repeats them to a lab that chooses."""
        _passes(contract_checks.claimed(self._tested(), self.device()))


def _in_own_process(driver: type[Driver]) -> type[Driver]:
    """A class that offers what `driver` does, and does it in a process of its own. `driver` must be
    one that a module has under its name.
    """

    def begin(self: ProcessDriver, name: str, settings: Any, context: DriverContext) -> None:
        offer = OfferedDriver(name, driver.__name__, driver, settings)
        process = DriverProcess([offer], context.folder)
        ProcessDriver.__init__(
            *(self, name, settings, context),
            local=driver,
            kind=driver.__name__,
            process=process,
        )

    said = {name: staticmethod(getattr(driver, name)) for name in _SAYS}
    members = {
        "Settings": driver.Settings,
        "summary": driver.summary,
        "facts": driver.facts,
        "__init__": begin,
        **said,
    }
    return type(f"{driver.__name__}InItsProcess", (ProcessDriver,), members)


def _passes(findings: Coroutine[Any, Any, list[Finding]]) -> None:
    found = asyncio.run(findings)
    assert not found, "\n".join(
        f"{each.subject}: {each.text}{f' ({each.remedy})' if each.remedy else ''}" for each in found
    )
