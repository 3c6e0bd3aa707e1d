"""A Pepper that needs no hardware: for rehearsals, demonstrations and tests. See `README.md`."""

from naoqi_simulator.pepper import Pepper
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.simulator_process import start
from naoqi_simulator.world import Options, World

__all__ = ["Options", "PacedTime", "Pepper", "World", "start"]
