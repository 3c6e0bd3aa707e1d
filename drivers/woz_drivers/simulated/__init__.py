"""A robot for the desk: write and rehearse an experiment without hardware.

It takes every common verb, needs the time a robot needs, moves joints with limits and speeds,
drives about, breaks down when told to, and can be visited by a simulated person.
`driver.py` is the driver; `body.py`, `faults.py` and `visitor.py` know nothing of it.
"""

from woz_drivers.simulated.driver import SimulatedRobot
from woz_drivers.simulated.settings import ScheduledFault, SimulatedJoint, SimulatedSettings

__all__ = ["ScheduledFault", "SimulatedJoint", "SimulatedRobot", "SimulatedSettings"]
