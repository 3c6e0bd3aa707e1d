"""`python -m woz_drivers.naoqi`."""

import sys

from woz_drivers.naoqi.process import main

sys.exit(main())
