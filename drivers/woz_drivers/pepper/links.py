"""Opens a connection to a robot by whichever library there is."""

from __future__ import annotations

from woz_drivers.pepper import qi_link_library
from woz_drivers.pepper.address import Address
from woz_drivers.pepper.link import Link
from woz_drivers.pepper.links_trouble import Refused
from woz_drivers.pepper.own_link import open_own_link
from woz_drivers.pepper.qi_link import open_qi_link
from woz_drivers.pepper.secrets import password
from woz_drivers.pepper.settings import PepperSettings

#: An attempt is given up after so long, in seconds: short enough to meet a robot that has just come
#: back, long enough for a slow one and a line that has to be secured.
OPENS_WITHIN_S = 3.0


def chosen_client(address: Address, settings: PepperSettings) -> str:
    """`qi` or `own`. Raises `Refused` if what the settings want cannot be had."""
    pinned = bool(settings.trusted) and address.secure
    if settings.client == "own" or (settings.client == "auto" and (pinned or ":" in address.host)):
        return "own"
    if settings.client == "qi" and pinned:
        raise Refused(
            "the package qi cannot tell which certificate a robot shows",
            "set `client: own` (or auto) to use `trusted`",
        )
    if qi_link_library.usable():
        return "qi"
    if settings.client == "qi":
        raise Refused(
            "the package qi is not installed, or does not load",
            "pip install 'woz-tui[pepper]', or set `client: own`",
        )
    return "own"


async def open_link(
    address: Address, settings: PepperSettings, within: float = OPENS_WITHIN_S
) -> Link:
    """Connect. Raises `Lost`, or `Refused` where trying again is of no use.

    Args:
        address: A real one; for the simulated robot where that listens.
        settings: Which client, whose password, which certificate.
        within: Seconds for the whole attempt.
    """
    secret = password(settings.password)
    if chosen_client(address, settings) == "own":
        return await open_own_link(
            address, secret, settings.password, settings.trusted, within=within
        )
    return await open_qi_link(address, secret, settings.password, within)
