"""`python -m woz_drivers.ros HOST[:PORT]` prints a draft of a robot file for what runs there."""

from __future__ import annotations

import argparse
import asyncio
import sys

from woz_drivers.ros import doctor
from woz_drivers.ros.settings import RosSettings
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
        sys.stdout.write(asyncio.run(doctor.draft(settings)))
    except DriverError as error:
        sys.stderr.write(f"{error.what}; {error.remedy}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
