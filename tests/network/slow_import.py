"""A driver whose module takes for ever to be imported anywhere but in the tests' process."""

from __future__ import annotations

import sys
import time

from tests.network.worker import Worker

if "pytest" not in sys.modules:
    time.sleep(1000)


class Slow(Worker):
    """Never comes so far."""
