"""`python -m naoqi_simulator`."""

import sys

from naoqi_simulator.simulator_process import main

sys.exit(main())
