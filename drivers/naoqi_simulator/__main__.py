"""`python -m naoqi_simulator`."""

import sys

from naoqi_simulator.process import main

sys.exit(main())
