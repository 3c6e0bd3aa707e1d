"""A Pepper or NAO without hardware, for rehearsals, demonstrations and tests. See `README.md`."""

from naoqi_simulator.robot import NaoqiSimulator
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.simulator_process import start
from naoqi_simulator.world import SimulatedWorld, SimulatorOptions

__all__ = ["NaoqiSimulator", "PacedTime", "SimulatedWorld", "SimulatorOptions", "start"]
