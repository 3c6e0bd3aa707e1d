"""The drivers of a session, made from what the experiment says of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from woz_tui.experiment.sensors import published_names
from woz_tui.plugins import PluginError
from woz_tui.record.names import media_folder
from woz_tui.session.outlet import Asked, DriverOutlet

if TYPE_CHECKING:
    from woz_tui.session.session import Session


def make_drivers(session: Session, asked: Asked) -> None:
    """Make every driver, with an outlet of its own, and put it into `session.drivers`.

    `asked` carries out what drivers ask for. Raises `PluginError` if one cannot be made.
    """
    names = published_names(session.experiment.drivers)
    for spec in session.experiment.drivers:
        outlet = DriverOutlet(
            spec.name,
            session.hub,
            session.clock,
            session.experiment.path.parent,
            names=names[spec.name],
            feeds=session.feeds,
            asked=asked,
            media=lambda: media_folder(session.recorder.path),
        )
        try:
            driver = session.catalogue[spec.type](spec.name, spec.settings, outlet)
        except (Exception, SystemExit) as error:
            raise PluginError(
                f"the driver {spec.name!r} cannot be made: {type(error).__name__}: {error}"
            ) from error
        session.drivers[spec.name] = driver
