"""`python -m woz_drivers.ros HOST[:PORT]` prints a draft of a robot file for what runs there."""

from __future__ import annotations

import argparse
import asyncio
import socket
import sys
from urllib.parse import urlsplit

from woz_drivers.ros import doctor
from woz_drivers.ros.settings import RosSettings, url
from woz_tui.drivers.contract import DriverError


def main() -> int:
    """Print the draft; 1 if the robot cannot be had."""
    parser = argparse.ArgumentParser(prog="python -m woz_drivers.ros", description=__doc__)
    parser.add_argument("address", help="where rosbridge listens: robot.local:9090, or simulated")
    settings = RosSettings(address=parser.parse_args().address)
    wrong = settings.problems()
    try:
        if wrong:
            raise DriverError(wrong[0][1])
        _look_up(settings)
        sys.stdout.write(asyncio.run(doctor.draft(settings)))
    except DriverError as error:
        sys.stderr.write(f"{'; '.join(filter(None, (error.what, error.remedy)))}\n")
        return 1
    return 0


def _look_up(settings: RosSettings) -> None:
    """Raise `DriverError` if no host is called so."""
    host = urlsplit(url(settings.address)).hostname
    try:
        if host is not None:  # the simulated robot has none
            socket.getaddrinfo(host, None)
    except (socket.gaierror, UnicodeError):
        raise DriverError(
            f"no host is called {host}",
            "check the name, or write the robot's address in numbers, such as 192.168.1.20:9090",
        ) from None


if __name__ == "__main__":
    sys.exit(main())
