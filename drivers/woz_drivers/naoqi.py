"""`python -m woz_drivers.naoqi`: what was the name of `python -m naoqi_simulator`."""

import sys

from naoqi_simulator.simulator_process import main

if __name__ == "__main__":
    sys.exit(main())
