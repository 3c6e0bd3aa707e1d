"""Whatever speaks ROS 1 or ROS 2, by rosbridge."""

from woz_drivers.ros.driver import Ros
from woz_drivers.ros.settings import RosSettings

__all__ = ["Ros", "RosSettings"]
