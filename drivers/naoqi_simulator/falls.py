"""A robot on legs falls: its fall manager lets go of all motors, and ALMemory tells of it."""

from __future__ import annotations

from naoqi_simulator.body import SimulatedBody
from naoqi_simulator.memory_store import MemoryStore
from naoqi_simulator.robot_time import Activities

#: When the reflex begins, and when it is over (naoqi/motion/reflexes-fall-manager of NAOqi 2.8).
FALLING, FALLEN = "ALMotion/RobotIsFalling", "robotHasFallen"
#: On which side it lies then, by the word of the fault `fall:back`.
SIDES = {"": "LyingBelly", "front": "LyingBelly", "back": "LyingBack"}


class SimulatedFalls:
    """Falls, and whether it lies."""

    def __init__(self, body: SimulatedBody, going: Activities, store: MemoryStore) -> None:
        self._body, self._going, self._store = body, going, store

    @property
    def lies(self) -> bool:
        """Whether it has to get up before it can do anything else."""
        return self._body.family.startswith("Lying")

    def fall(self, side: str = "") -> None:
        """Fall now. Raises KeyError for a side that there is not.

        The values stay in ALMemory: nothing on the robot takes them back.
        """
        posture = SIDES[side]
        self._store.raise_event(FALLING, True)
        self._body.halt()
        self._body.hold()
        self._body.relax()
        self._body.posture = posture
        self._going.end("move", "joints", "posture", "animation")
        self._store.raise_event(FALLEN, True)
