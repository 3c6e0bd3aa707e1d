"""A driver in a process of its own, as a class that tests make drivers of."""

from __future__ import annotations

from typing import Any

from woz_tui.drivers.contract import Driver, DriverContext
from woz_tui.network.driver_process import DriverProcess, ProcessDriver
from woz_tui.network.driver_server import OfferedDriver

#: What a class says of itself, with its settings.
_SAYS = (
    *("verbs", "sensors", "lacks", "joints", "asks", "part", "outline", "remarks"),
    *("voices", "examine"),
)


def in_own_process(driver: type[Driver]) -> type[Driver]:
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
