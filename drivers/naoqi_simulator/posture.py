"""ALRobotPosture."""

from __future__ import annotations

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld

#: Getting up takes so much longer, in seconds.
GET_UP_S = 6.0


class RobotPosture(Service):
    """Named postures; the ways between them are not checked for balance. What lies gets up, too."""

    name = "ALRobotPosture"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world

    @offers("goToPosture(sf)b")
    async def go_to_posture(self, posture: str, fraction: float) -> bool:
        """Take a posture; False if it was not reached."""
        body = self._world.body
        if posture not in body.plan.postures:
            raise CallRefusedError(f"ALRobotPosture::goToPosture\n\tunknown posture {posture}")
        if not 0 < fraction <= 1:
            raise CallRefusedError("ALRobotPosture::goToPosture\n\tspeed must be within ]0, 1]")
        if not body.stiff or self._world.faults.active("says-no"):
            return False
        # As the real one it is never at its fastest: half a second at the least.
        seconds = max(0.5, body.seconds_to(body.plan.postures[posture], fraction))
        if self._world.falls.lies:
            seconds += GET_UP_S
        body.take(posture, seconds)
        reached = await self._world.going.last("posture", seconds, posture)
        if reached:
            body.posture, body.awake = posture, True
        return reached

    @offers("applyPosture(sf)b")
    async def apply_posture(self, posture: str, fraction: float) -> bool:
        """As goToPosture here."""
        return await self.go_to_posture(posture, fraction)

    @offers("stopMove()v")
    def stop_move(self) -> None:
        """Stay where it is."""
        if self._world.going.end("posture"):
            self._world.body.hold()

    @offers("getPosture()s")
    def get_posture(self) -> str:
        """The posture taken last."""
        return self._world.body.posture

    @offers("getPostureFamily()s")
    def get_posture_family(self) -> str:
        """Standing, Crouching; of a NAO also Sitting, LyingBack, LyingBelly."""
        return self._world.body.family

    @offers("getPostureList()[s]")
    def get_posture_list(self) -> list[str]:
        """All that goToPosture takes."""
        return sorted(self._world.body.plan.postures)
