"""The drivers of a session, made from what the experiment says of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Experiment
from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.feeds import Feeds
from woz_tui.drivers.plugins import PluginError
from woz_tui.session.driver_context import DriverRequestHandler, SessionDriverContext
from woz_tui.system.clock import Clock


def make_drivers(
    experiment: Experiment,
    catalogue: Mapping[str, type[Driver]],
    hub: Hub,
    clock: Clock,
    *,
    feeds: Feeds,
    asked: DriverRequestHandler,
    media: Callable[[], Path],
) -> dict[str, Driver]:
    """Every driver by its name, each with a context of its own.

    `asked` carries out what drivers ask for, `media` is the folder for sound and pictures. Raises
    `PluginError` if one cannot be made.
    """
    names, drivers = published_names(experiment.drivers), dict[str, Driver]()
    for spec in experiment.drivers:
        context = SessionDriverContext(
            spec.name,
            hub,
            clock,
            experiment.path.parent,
            names=names[spec.name],
            feeds=feeds,
            asked=asked,
            media=media,
        )
        try:
            drivers[spec.name] = catalogue[spec.type](spec.name, spec.settings, context)
        except (Exception, SystemExit) as error:
            raise PluginError(
                f"the driver {spec.name!r} cannot be created: {type(error).__name__}: {error}"
            ) from error
    return drivers
