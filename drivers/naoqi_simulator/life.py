"""ALAutonomousLife and what the robot does by itself under it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import ClassVar

from naoqi_simulator.motion import MotionService
from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.visitor import SimulatedPerson
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

#: How its base follows people: near enough (m), the farthest way (m), speeds (m/s, rad/s), what
#: counts as facing somebody (rad), and how long it goes on by itself (s).
NEAR_M, MOST_M, FORWARD_M_S, TURN_RAD_S, FACING, BIT_S = 1.0, 0.3, 0.1, 0.2, 0.05, 0.3


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
    #: How it tracks: whether the base turns, whether it goes to somebody.
    tracking_modes: ClassVar[Mapping[str, tuple[bool, bool]]] = {
        "Head": (False, False),
        "BodyRotation": (True, False),
        "WholeBody": (True, False),
        "MoveContextually": (True, True),
    }

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__("ALBasicAwareness", world)
        self.mode = "Unengaged"
        self.tracking = "Head"
        self.paused = False
        self.stimuli = dict.fromkeys(("People", "Touch", "TabletTouch", "Sound", "Movement"), True)
        #: Whom it goes to: their number, the heading at which it faces them, metres left to go.
        self._goal: tuple[int, float, float] = (0, 0.0, 0.0)

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

    @offers("setTrackingMode(s)v")
    def set_tracking_mode(self, mode: str) -> None:
        """Head, BodyRotation, WholeBody or MoveContextually."""
        if mode not in self.tracking_modes:
            raise CallRefusedError(f"ALBasicAwareness::setTrackingMode\n\tunknown mode {mode}")
        self.tracking = mode
        self._goal = (0, 0.0, 0.0)

    @offers("getTrackingMode()s")
    def get_tracking_mode(self) -> str:
        """The mode set last."""
        return self.tracking

    @offers("setStimulusDetectionEnabled(sb)v")
    def set_stimulus_detection_enabled(self, stimulus: str, on: bool) -> None:
        """People, Touch, TabletTouch, Sound or Movement."""
        self.stimuli[self._stimulus("setStimulusDetectionEnabled", stimulus)] = on

    @offers("isStimulusDetectionEnabled(s)b")
    def is_stimulus_detection_enabled(self, stimulus: str) -> bool:
        """Whether it heeds that."""
        return self.stimuli[self._stimulus("isStimulusDetectionEnabled", stimulus)]

    def _stimulus(self, method: str, stimulus: str) -> str:
        if stimulus not in self.stimuli:
            raise CallRefusedError(f"ALBasicAwareness::{method}\n\tunknown stimulus {stimulus}")
        return stimulus

    @offers("pauseAwareness()v")
    def pause_awareness(self) -> None:
        """It follows nobody until it is resumed."""
        self.paused = True

    @offers("resumeAwareness()v")
    def resume_awareness(self) -> None:
        self.paused = False

    @offers("isAwarenessPaused()b")
    def is_awareness_paused(self) -> bool:
        """Whether it is paused."""
        return self.paused

    def follow(self) -> None:
        """Turn the head to whoever is there, and the base as the mode says, unless something else
        moves it. A drive of its own that was stopped begins anew at the next look.
        """
        body, person = self._world.body, self._world.person()
        sees = self.on and not self.paused and self.stimuli["People"] and body.awake
        busy = self._world.going.of("joints", "animation", "posture")
        if not sees or person is None or busy:
            return
        for joint, angle in (("HeadYaw", person.angle), ("HeadPitch", -0.1)):
            body.move_joint(joint, angle, body.seconds_to({joint: angle}, 0.2))
        turns, goes = self.tracking_modes[self.tracking]
        if turns and not self._world.going.of("move") and not any(body.velocity()):
            self._approach(person, goes=goes)

    def _approach(self, person: SimulatedPerson, *, goes: bool) -> None:
        """The base's next bit of the way."""
        body = self._world.body
        if self._goal[0] != person.number:
            to_go = min(MOST_M, max(0.0, person.distance - NEAR_M)) if goes else 0.0
            self._goal = (person.number, body.pose()[2] + person.angle, to_go)
        number, facing, to_go = self._goal
        turn = math.remainder(facing - body.pose()[2], math.tau)
        ahead = FORWARD_M_S if to_go > 0 else 0.0
        if ahead or abs(turn) > FACING:
            self._goal = (number, facing, max(0.0, to_go - ahead * BIT_S))
            swing = math.copysign(min(TURN_RAD_S, abs(turn) / BIT_S), turn)
            body.drive(ahead, 0.0, swing, BIT_S)


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
