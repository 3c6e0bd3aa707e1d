"""ALAutonomousLife and what the robot does by itself under it."""

from __future__ import annotations

from typing import ClassVar

from naoqi_simulator.motion import MotionService
from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld

STATES = ("solitary", "interactive", "safeguard", "disabled")
#: What each state switches on; everything else it switches off (ref/life/
#: autonomous_abilities_management of NAOqi 2.8; in 2.4 a solitary robot did not blink).
_ALL = ("ALBasicAwareness", "ALAutonomousBlinking", "ALSpeakingMovement", "ALListeningMovement")
_ABILITIES = {
    "solitary": _ALL,
    "interactive": _ALL,
    "safeguard": (),
    "disabled": ("ALSpeakingMovement",),
}
#: How it engages from then on, by the same page.
_MODES = {"solitary": "Unengaged", "interactive": "FullyEngaged"}


class Ability(Service):
    """Something it does by itself that can be switched: blinking, moving while it listens ..."""

    def __init__(self, name: str, world: SimulatedWorld) -> None:
        super().__init__()
        self.name = name
        self._world = world
        self.on = False

    @offers("setEnabled(b)v")
    def set_enabled(self, on: bool) -> None:
        self.on = on

    @offers("isEnabled()b")
    def is_enabled(self) -> bool:
        """Whether it is switched on."""
        return self.on


class Awareness(Ability):
    """ALBasicAwareness: turns its head to people."""

    modes: ClassVar[tuple[str, ...]] = ("Unengaged", "FullyEngaged", "SemiEngaged")

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__("ALBasicAwareness", world)
        self.mode = "Unengaged"

    @offers("setEngagementMode(s)v")
    def set_engagement_mode(self, mode: str) -> None:
        """Unengaged, SemiEngaged or FullyEngaged."""
        if mode not in self.modes:
            raise CallRefusedError(f"ALBasicAwareness::setEngagementMode\n\tunknown mode {mode}")
        self.mode = mode

    @offers("getEngagementMode()s")
    def get_engagement_mode(self) -> str:
        """The mode set last."""
        return self.mode

    def follow(self) -> None:
        """Turn the head to whoever is there, unless something else moves it."""
        body, person = self._world.body, self._world.person()
        busy = self._world.going.of("joints", "animation", "posture")
        if self.on and body.awake and person and not busy:
            for joint, angle in (("HeadYaw", person.angle), ("HeadPitch", -0.1)):
                body.move_joint(joint, angle, body.seconds_to({joint: angle}, 0.2))


class AutonomousLife(Service):
    name = "ALAutonomousLife"

    def __init__(
        self, world: SimulatedWorld, motion: MotionService, abilities: dict[str, Ability]
    ) -> None:
        super().__init__()
        self._world, self._motion, self._abilities = world, motion, abilities
        self.state = "disabled"

    @offers("setState(s)v")
    async def set_state(self, state: str) -> None:
        """Solitary or interactive: it wakes up and does things by itself; disabled: it rests."""
        if state not in STATES:
            raise CallRefusedError(f"ALAutonomousLife::setState\n\t{state} is not a valid state")
        if (self.state, state) == ("interactive", "solitary"):
            # naoqi/interaction/autonomouslife-api of NAOqi 2.5: "manual change ... will fail".
            raise CallRefusedError(
                "ALAutonomousLife::setState\n\tinteractive to solitary is not allowed"
            )
        self.become(state)
        if state == "disabled":
            await self._motion.rest()
        elif state != "safeguard":
            await self._motion.wake_up()

    @offers("getState()s")
    def get_state(self) -> str:
        """The state now; it changes by itself, too."""
        return self.state

    def become(self, state: str) -> None:
        """Be in a state from now on, with all that it switches, and tell. Raises KeyError."""
        abilities = _ABILITIES[state]
        self.state = state
        for name, ability in self._abilities.items():
            ability.on = name in abilities
            if isinstance(ability, Awareness):
                ability.mode = _MODES.get(state, ability.mode)
        breathes = state in ("solitary", "interactive")
        self._world.body.breathing = dict.fromkeys(self._world.body.breathing, breathes)
        self._world.store.raise_event("AutonomousLife/State", state)

    def drift(self) -> str:
        """Change something of autonomy as the real robot does; return what it was."""
        draw = self._world.random
        what = draw.choice([*self._abilities, "state"])
        if what == "state":
            fits = [one for one in ("solitary", "interactive") if one != self.state]
            self.become(draw.choice(fits))
            return f"state is {self.state}"
        ability = self._abilities[what]
        ability.on = not ability.on
        return f"{what} is {'on' if ability.on else 'off'}"
